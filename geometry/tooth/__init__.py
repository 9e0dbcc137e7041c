"""The whole tooth: both flanks, fillets and lands, and its lattice of bricks."""

from .tooth_surface import tooth

__all__ = ["tooth"]
