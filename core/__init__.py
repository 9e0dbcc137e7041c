"""Base of all stages: exceptions, argument checks, files, checkpoints and attributes of variables."""
