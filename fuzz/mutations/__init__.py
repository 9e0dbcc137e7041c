"""Mutations by format, values of options and keys, and what may stand where a file is wanted."""
