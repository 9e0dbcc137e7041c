"""Measured and worn flanks: deviations, their effect on the ease-off, corrective settings."""
