"""Mixed elastohydrodynamic lubrication of a line contact: film, rough surfaces, friction."""

from .certificate import Certificate, Status
from .complementarity import State
from .conditions import LineContact
from .inlet import film_factor, heated_inlet
from .labels import film_dataset, passage_dataset
from .load_sharing import Asperities
from .moving import Passage, rough_passage
from .oil import Oil
from .roughness import RoughProfile, asperity, generated_profile, measured_profile, wave
from .shear import Traction, traction
from .steady import Film, mixed_film, smooth_film

__all__ = [
    "Asperities",
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
    "film_factor",
    "generated_profile",
    "heated_inlet",
    "measured_profile",
    "mixed_film",
    "passage_dataset",
    "rough_passage",
    "smooth_film",
    "traction",
    "wave",
]
