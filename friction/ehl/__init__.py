"""Mixed elastohydrodynamic lubrication of a line contact: film, rough surfaces, friction."""

from .certificate import Certificate, Status
from .complementarity import State
from .conditions import LineContact
from .labels import film_dataset, passage_dataset
from .moving import Passage, rough_passage
from .oil import Oil
from .roughness import RoughProfile, asperity, generated_profile, measured_profile, wave
from .shear import Traction, traction
from .steady import Film, smooth_film

__all__ = [
    "Certificate",
    "Film",
    "LineContact",
    "Oil",
    "Passage",
    "RoughProfile",
    "State",
    "Status",
    "Traction",
    "asperity",
    "film_dataset",
    "generated_profile",
    "measured_profile",
    "passage_dataset",
    "rough_passage",
    "smooth_film",
    "traction",
    "wave",
]
