"""Summary of a result, as text: what `easeoff show` prints."""
