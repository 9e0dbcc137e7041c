"""Mixed elastohydrodynamic lubrication of a line contact: film, rough surfaces, friction."""

from .asperities import Asperities, RoughProfile, asperity, generated_profile, measured_profile, wave
from .film import Film, mixed_film, smooth_film
from .film_dataset import film_dataset, passage_dataset
from .lubricated_contact import LubricatedContact, Oil, heated_inlet
from .reynolds_equation import Certificate, State, Status
from .rough_passage import RoughPassage, rough_passage
from .shear_traction import Traction, traction

__all__ = [
    "Asperities",
    "Certificate",
    "Film",
    "LubricatedContact",
    "Oil",
    "RoughPassage",
    "RoughProfile",
    "State",
    "Status",
    "Traction",
    "asperity",
    "film_dataset",
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
