"""Commented templates of input files, made from the schemas that check them."""
