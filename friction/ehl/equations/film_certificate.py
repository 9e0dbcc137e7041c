"""Certificate of an answer of the film model: violations of each condition by pressures and approach.

Everything is evaluated anew from pressures and approach, never taken from the iteration. All entries are dimensionless;
zero is perfect.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, fields

import numpy as np

from ....core.stored_status import StoredStatus
from .film_complementarity import HERTZ_LOAD, Problem, evaluate
from .reynolds_equation import THINNEST_FILM, Array

#: What each entry must reach.
CERTIFICATE_TOLERANCE = 1e-8


class Status(StoredStatus):
    """End of a solve.

    Examples
    --------
    >>> Status(0).name
    'CERTIFIED'
    """

    CERTIFIED = 0
    NOT_CONVERGED = 1
    NOT_CERTIFIED = 2
    FAILED = 3
    NOT_RUN = 4


@dataclass(frozen=True)
class Certificate:
    """Violations of the conditions by an answer.

    Parameters
    ----------
    load
        ``|integral of P - load| / load``.
    negative_pressure
        max(-P, 0) of the lubricant, in units of the Hertz pressure.
    negative_lack
        max(-V, 0) over the mean flow: more lubricant than the gap holds.
    negative_gap
        max(-g, 0), penetration, over the film left between touching asperities; 0 where none can touch.
    negative_film
        How far the film is below the thinnest that the mass balance tells from none, over that: smooth surfaces, which
        have no asperities to touch with, may not pass through one another either.
    complementarity
        Largest of ``min(P, |V|, g)``, each by its scale: somewhere a node is neither film, nor ruptured, nor touching.

    Examples
    --------
    >>> Certificate(1e-12, 0.0, 0.0, 0.0, 0.0, 1e-9).passes()
    True
    """

    load: float
    negative_pressure: float
    negative_lack: float
    negative_gap: float
    negative_film: float
    complementarity: float

    @property
    def worst(self) -> float:
        """The largest of all violations; infinite if one of them is not a number."""
        entries: tuple[float, ...] = astuple(self)
        return math.inf if any(map(math.isnan, entries)) else max(entries)

    def passes(self, tolerance: float = CERTIFICATE_TOLERANCE) -> bool:
        """Whether every violation is within the tolerance."""
        return self.worst <= tolerance


def certify(problem: Problem, pressure: Array, approach: float) -> Certificate:
    """Measure how well pressures and approach solve a problem.

    Parameters
    ----------
    problem
        The problem.
    pressure
        In units of the Hertz pressure (n).
    approach
        Of the surfaces, in units of the film thickness.

    Returns
    -------
    Certificate
        Infinite throughout where a number is not finite.
    """
    if not (np.isfinite(pressure).all() and math.isfinite(approach)):
        return Certificate(*(math.inf,) * len(fields(Certificate)))
    point = evaluate(problem, pressure, approach)
    inner = slice(1, -1)
    flow = float(np.abs(point.balance.flow).mean())
    lack = point.lack[inner] / flow
    can_touch = math.isfinite(problem.touching_film)
    gap = point.gap[inner] / problem.touching_film if can_touch else np.full_like(lack, math.inf)
    # Asperities also touch where they pass the ends of the domain, which carry no pressure.
    clearance = point.clearance[inner] if can_touch else point.clearance
    load = problem.deflection.spacing * float(pressure.sum())
    shared = np.minimum(np.minimum(point.fluid[inner], np.abs(lack)), np.abs(gap))
    return Certificate(
        load=abs(load - HERTZ_LOAD) / HERTZ_LOAD,
        negative_pressure=max(-float(point.fluid.min()), 0.0) + float(np.abs(point.fluid[[0, -1]]).max()),
        negative_lack=max(-float(lack.min()), 0.0),
        negative_gap=max(-float(gap.min()), 0.0),
        negative_film=max(1.0 - float(clearance.min()) / THINNEST_FILM, 0.0),
        complementarity=max(float(shared.max()), 0.0),
    )


def judge(converged: bool, certificate: Certificate) -> Status:
    """Status of an answer: the certificate alone decides whether it is one."""
    if certificate.passes():
        return Status.CERTIFIED
    return Status.NOT_CERTIFIED if converged else Status.NOT_CONVERGED
