"""Cases and pairs with teeth of another model: shells where teeth are not the point, few bricks where they are."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from easeoff.cases import Case
from easeoff.cases.schema.case_schema import ComplianceTable
from easeoff.contact import STEEL, ElasticModel
from easeoff.contact.compliance.finite_elements import finite_element_tooth as members
from easeoff.contact.compliance.finite_elements.tooth_ring import ToothBody
from easeoff.geometry import GearPair, LatticeSize

#: Of bricks and functions, by which a tooth takes a fifth of the usual time.
COARSE = 0.4
KEYS: dict[str, dict[str, Any]] = {
    "shell": {},
    "solid_shell": {"fineness": COARSE},
    "fe": {"fineness": COARSE, "neighbours": False},
}


def with_teeth(case: Case, model: str = "shell", **keys: Any) -> Case:
    """The same case with teeth of a model, coarse ones, and other keys of [compliance]."""
    table = ComplianceTable.model_validate({"model": model, **KEYS[model], **keys})
    return case.model_copy(update={"compliance": table})


def coarse_solid_shells(pair: GearPair, *, neighbours: bool = False) -> ElasticModel:
    """Solid shells of few bricks and functions."""
    pinion, gear = (
        members.solid_shell_tooth(pair, member, STEEL, fineness=COARSE, body=ToothBody(neighbours=neighbours)).flank
        for member in ("pinion", "gear")
    )
    return ElasticModel(condensed=(pinion, gear))


@contextmanager
def few_bricks() -> Iterator[None]:
    """Solid shells are of few bricks and functions within this context, those of the default too."""
    usual = members.solid_shell_size
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            members, "solid_shell_size", lambda pair, member, fineness=1.0: usual(pair, member, COARSE * fineness)
        )
        yield


FEW = LatticeSize(lengthwise=6, upward=4, through=2, slot=1, beside=1, deep=1, overhang=1)
