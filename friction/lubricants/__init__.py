"""Lubricants: their properties over temperature, from files and data sheets; the shipped ones as TOML files.

To ship one: a TOML file in this folder with published numbers and their source, and a row in the table of
``docs/engineer/guides/friction.md``.
"""
