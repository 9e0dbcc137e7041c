"""Load capacity of the flanks and teeth: wear, and stress in the tooth root."""
