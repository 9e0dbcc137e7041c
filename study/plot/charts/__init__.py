"""Charts of misalignment, root stress, changes of the ease-off, wear and sweeps."""
