"""Presentation of a comparison: report, tables and figures."""
