"""Commands that list, write and convert input files."""
