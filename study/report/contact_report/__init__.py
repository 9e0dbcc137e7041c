"""Contact report: one HTML file with tables, charts, flank pictures and turnable teeth, from one or several results."""
