"""Random and degenerate contact problems, and the judgement of what is claimed about them, in rational numbers."""
