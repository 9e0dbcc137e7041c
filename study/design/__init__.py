"""Design of a case, and machine settings for a modification."""
