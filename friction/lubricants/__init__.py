"""Lubricants: their properties over temperature, from files and data sheets; the shipped ones as TOML files."""
