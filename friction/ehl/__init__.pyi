from .asperities import (
    Asperities as Asperities,
    RoughProfile as RoughProfile,
    asperity as asperity,
    generated_profile as generated_profile,
    measured_profile as measured_profile,
    wave as wave,
)
from .film import Film as Film, film_dataset as film_dataset, mixed_film as mixed_film, smooth_film as smooth_film
from .lubricated_contact import LubricatedContact as LubricatedContact, Oil as Oil, heated_inlet as heated_inlet
from .passage import RoughPassage as RoughPassage, passage_dataset as passage_dataset, rough_passage as rough_passage
from .reynolds_equation import Certificate as Certificate, State as State, Status as Status
from .shear_traction import Traction as Traction, traction as traction

__all__: list[str]
