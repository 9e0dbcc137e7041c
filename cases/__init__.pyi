from .conversion import designed_blanks as designed_blanks, gear_pair as gear_pair
from .deflection_table import read_deflections as read_deflections
from .deflections import Deflections as Deflections
from .load_cases import read_load_cases as read_load_cases
from .reading import (
    case_text as case_text,
    design_text as design_text,
    parse_case as parse_case,
    parse_design as parse_design,
    read_case as read_case,
    read_design as read_design,
    read_supports as read_supports,
    with_supports as with_supports,
)
from .rexs.rexs_reading import read_rexs as read_rexs
from .rexs.rexs_writing import write_rexs as write_rexs
from .schema.case_schema import Case as Case
from .schema.design_schema import Design as Design
from .schema.load_case_table import LoadCase as LoadCase
from .schema.supports_table import SupportsTable as SupportsTable
from .session_script import read_session_script as read_session_script
from .shipped_files import (
    shipped_cases as shipped_cases,
    shipped_designs as shipped_designs,
    shipped_supports as shipped_supports,
)
from .support_conversion import support_system as support_system
from .writing import case_toml as case_toml, write_case as write_case

__all__: list[str]
