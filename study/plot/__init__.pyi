from .contact_pattern_chart import contact_pattern as contact_pattern
from .friction_charts import efficiency as efficiency, friction_maps as friction_maps
from .mesh_cycle_charts import (
    load_sharing as load_sharing,
    pressure as pressure,
    root_stress as root_stress,
    transmission_error as transmission_error,
)
from .study_charts import (
    front as front,
    load_cases as load_cases,
    misalignment as misalignment,
    vh_check as vh_check,
    wear as wear,
)
from .sweep_charts import sweep as sweep
from .topography_chart import (
    deviations as deviations,
    ease_off as ease_off,
    optimization as optimization,
    topography as topography,
)
from .written_pictures import pictures as pictures, write_pictures as write_pictures

__all__: list[str]
