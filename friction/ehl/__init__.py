"""Mixed elastohydrodynamic lubrication of a line contact: film, rough surfaces, friction."""

from .film_certificate import Certificate, Status
from .film_complementarity import State
from .film_dataset import film_dataset, passage_dataset
from .film_oil import Oil
from .inlet_heating import film_factor, heated_inlet
from .line_contact_conditions import LineContact
from .load_sharing import Asperities
from .rough_passage import Passage, rough_passage
from .shear_traction import Traction, traction
from .steady_film import Film, mixed_film, smooth_film
from .surface_roughness import RoughProfile, asperity, generated_profile, measured_profile, wave

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
