"""Results as text: summaries, notes, and reports of designs and corrections."""
