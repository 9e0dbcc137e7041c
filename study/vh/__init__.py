"""V-H check: displacements of the pinion that bring the unloaded pattern to toe, middle and heel."""
