"""Potential contact lines of a pair, their segments, and tooth edges."""
