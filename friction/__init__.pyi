from .coefficient import COEFFICIENTS as COEFFICIENTS, friction_coefficient as friction_coefficient
from .conditions import (
    FILM_FACTORS as FILM_FACTORS,
    FILMS as FILMS,
    THERMAL_FACTORS as THERMAL_FACTORS,
    ContactConditions as ContactConditions,
)
from .contact_temperature import (
    MatchedBand as MatchedBand,
    blok_flash_temperature as blok_flash_temperature,
    flash_temperature as flash_temperature,
    matched_band as matched_band,
)
from .efficiency import friction as friction, rolling_traction as rolling_traction
from .feedback import friction_feedback as friction_feedback
from .kolivand_formula import formula_flags as formula_flags
from .lubricants.lubricant import (
    Lubricant as Lubricant,
    OilState as OilState,
    available_lubricants as available_lubricants,
    data_sheet_lubricant as data_sheet_lubricant,
    lubricant as lubricant,
    write_lubricant as write_lubricant,
)
from .operation import FrictionModel as FrictionModel, Operation as Operation

__all__: list[str]
