"""The whole analysis of a case as one tree: contact, friction, and several assemblies joined along the torque."""
