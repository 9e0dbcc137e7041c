"""Design: from targets of the ease-off to machine settings, and modifications of the ease-off."""
