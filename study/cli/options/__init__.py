"""Options of the commands and the reading of their values."""
