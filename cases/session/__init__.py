"""Session scripts of Transmission3D and HypoidFaceMilled."""
