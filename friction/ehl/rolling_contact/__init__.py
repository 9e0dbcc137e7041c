"""The rolling contact: its oil, its operating conditions and its rough surfaces."""
