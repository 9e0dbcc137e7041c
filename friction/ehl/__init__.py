"""Mixed elastohydrodynamic lubrication of a line contact: film, rough surfaces, friction."""

from .equations.film_certificate import Certificate, Status
from .equations.film_complementarity import State
from .film import Film, mixed_film, smooth_film
from .film_dataset import film_dataset, passage_dataset
from .rolling_contact.asperities import Asperities
from .rolling_contact.inlet_heating import heated_inlet
from .rolling_contact.lubricated_contact import LubricatedContact
from .rolling_contact.oil import Oil
from .rolling_contact.surface_roughness import RoughProfile, asperity, generated_profile, measured_profile, wave
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
