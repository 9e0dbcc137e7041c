"""Provenance of a result: the attributes that say what was analysed, when, and by which version."""

from __future__ import annotations

import datetime
import json
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from .deviation_source import deviation_attributes

if TYPE_CHECKING:
    from ..cases import Case
    from .case_in_mesh import CaseInMesh


def case_attributes(case: Case, what: str) -> dict[str, Any]:
    """Attributes of every file: conventions, title, version, time and name of the computation, and the case.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case_attributes(read_case("fm-11x41"), "analyze")["title"][:15]
    'Face-milled hyp'
    """
    now, own = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%dT%H:%M:%SZ"), version("easeoff")
    return {
        "Conventions": "CF-1.11",
        "title": case.title,
        "history": f"{now} easeoff {own} {what}",
        "easeoff_version": own,
        "case": case.text or case.model_dump_json(),
    }


def mesh_attributes(state: CaseInMesh) -> dict[str, Any]:
    """Attributes of one pair in mesh: flank, teeth, assembly errors, modification and deviations."""
    assembly, added = state.pair.assembly, state.modification
    errors = assembly.misalignment
    return {
        "flank": state.flank,
        "pinion_teeth": assembly.pinion_teeth,
        "gear_teeth": assembly.gear_teeth,
        "pinion_hand": assembly.pinion_hand,
        "misalignment_offset_mm": errors.offset,
        "misalignment_pinion_axial_mm": errors.pinion_axial,
        "misalignment_gear_axial_mm": errors.gear_axial,
        "misalignment_shaft_angle_rad": errors.shaft_angle,
        **({} if added is None else {"modification_um": json.dumps(dict(added.coefficients))}),
        **deviation_attributes(state.deviations, state.deviated),
    }
