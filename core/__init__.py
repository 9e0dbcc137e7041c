"""What every stage shares: the exceptions and the table of variable attributes."""
