from .contact_figures import (
    contact_pattern as contact_pattern,
    deviations as deviations,
    ease_off as ease_off,
    efficiency as efficiency,
    friction_maps as friction_maps,
    load_sharing as load_sharing,
    misalignment as misalignment,
    pressure as pressure,
    root_stress as root_stress,
    topography as topography,
    transmission_error as transmission_error,
)
from .study_figures import (
    front as front,
    load_cases as load_cases,
    optimization as optimization,
    sweep as sweep,
    vh_check as vh_check,
    wear as wear,
)
from .written_pictures import pictures as pictures, write_pictures as write_pictures

__all__: list[str]
