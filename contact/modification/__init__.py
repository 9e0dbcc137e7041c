"""Modifications of the ease-off that improve the loaded contact."""
