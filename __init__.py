"""Contact of spiral bevel and hypoid gears, from machine settings to certified loaded contact."""
