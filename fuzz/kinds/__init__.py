"""Kinds of inputs: what files a run gets, and the words of its command line."""
