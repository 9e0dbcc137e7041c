"""Two members in mesh: assembly, conjugate motion, ease-off, rolling."""
