"""Independent methods that check the product; the product imports nothing from here."""
