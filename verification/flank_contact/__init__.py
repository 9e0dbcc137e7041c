"""Contact of two flanks without the split into bending and indentation, by pressures on cells of the flank."""
