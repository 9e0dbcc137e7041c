"""Where a result came from, as attributes of its file."""

from __future__ import annotations

import datetime
import json
from importlib.metadata import version
from typing import Any

from ..cases.schema.case_schema import Case
from ..geometry.pair.gear_pair import GearPair
from ..geometry.pair.modification import Modification

SCHEMA_VERSION = 1


def provenance(
    case: Case, pair: GearPair, flank: str, solver: str, modification: Modification | None, *, edge_contact: bool
) -> dict[str, Any]:
    """Where a result came from, as netCDF attributes."""
    now = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    own = version("easeoff")
    errors = pair.assembly.misalignment
    added = {} if modification is None else {"modification_um": json.dumps(dict(modification.coefficients))}
    return {
        "Conventions": "CF-1.11",
        "title": case.title,
        "history": f"{now} easeoff {own} analyze",
        "easeoff_version": own,
        "schema_version": SCHEMA_VERSION,
        "case": case.text or case.model_dump_json(),
        "solver": solver,
        "flank": flank,
        "edge_contact": int(edge_contact),
        "pinion_teeth": pair.assembly.pinion_teeth,
        "gear_teeth": pair.assembly.gear_teeth,
        "pinion_hand": pair.assembly.pinion_hand,
        "misalignment_offset_mm": errors.offset,
        "misalignment_pinion_axial_mm": errors.pinion_axial,
        "misalignment_gear_axial_mm": errors.gear_axial,
        "misalignment_shaft_angle_rad": errors.shaft_angle,
        "opposite_flanks": "given" if pair.pinion.opposite and pair.gear.opposite else "assumed from the loaded ones",
        **added,
    }
