from .parameter_sweep import sweep as sweep
from .reductions import percentiles as percentiles, sensitivities as sensitivities, worst_points as worst_points
from .sweep_file import read_sweep as read_sweep

__all__: list[str]
