"""What users do with an analysis: run it, show it, draw it, exchange it."""
