"""The dissertation's own method for the pages that redraw it: teeth as shells, contact on lines alone."""

from __future__ import annotations

import easeoff
from easeoff.cases import Case


def by_its_method(name: str) -> Case:
    """A shipped case with shells for teeth and without contact of tooth edges; both are options, not the default."""
    case = easeoff.read_case(name)
    shells = case.compliance.model_copy(update={"model": "shell"})
    lines = case.contact.model_copy(update={"edge_contact": False})
    return case.model_copy(update={"compliance": shells, "contact": lines})
