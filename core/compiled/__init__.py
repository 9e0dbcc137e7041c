"""Functions compiled by numba, and where they are used."""
