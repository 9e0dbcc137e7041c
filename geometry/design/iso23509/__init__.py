"""Blanks of bevel and hypoid gears, clause by clause of ISO 23509:2016; ``design.blank`` joins them."""
