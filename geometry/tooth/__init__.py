"""The whole tooth: both flanks, fillets and lands, and its lattice of bricks."""

from .tooth_dataset import tooth

__all__ = ["tooth"]
