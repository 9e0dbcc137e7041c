"""Film of a lubricated contact in a steady state: between smooth surfaces, and with asperities that share the load."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from ...core import checks
from ...core.arrays import RealArray as Array, record
from ...core.attributes import labelled
from ...core.errors import InputError
from . import reynolds_equation as reynolds
from .asperities import Asperities
from .hierarchical_matrix import Deflection
from .lubricated_contact import LubricatedContact
from .reynolds_equation import Certificate, Outcome, Problem, State, States, Status

#: The inlet lies where the gap of the rigid surfaces is as many times the film.
INLET_GAP_RATIO = 120.0
#: The coarsest grid of the sequence that leads to the wanted one has at most twice as many nodes.
COARSEST_NODES = 96
FEWEST_NODES, DEFAULT_NODES, MOST_NODES = 65, 513, 16385
#: ``Film.resolution`` from which on a smooth film is within 4 % of that on a fine grid; at 0.5 it may be off by a half.
RESOLUTION_LIMIT = 1.0
#: Separation in rms heights at which statistical asperities hardly touch any more.
PARTED_SEPARATION = 4.0
#: Rolling velocities to start rough passages from, as factors of their own.
START_VELOCITY_FACTORS = (1.0, 2.0, 4.0, 8.0, 16.0)
#: Thicker and thinner films to start from on the coarsest grid, as factors of the estimate.
START_FILM_FACTORS = (1.0, 2.0, 0.5, 4.0, 8.0)


@record(frozen=True, eq=False)
class Film:
    """Pressure and film of a lubricated line contact.

    Parameters
    ----------
    contact
        Operating conditions.
    position
        Along the rolling direction, from the middle of the dry contact (n) [m].
    pressure
        Of lubricant and asperities together (n) [Pa].
    film
        Film thickness (n) [m]; between statistically rough surfaces the mean gap, beyond the end of the film the gap.
    state
        Values of ``State`` (n).
    status
        Only of ``CERTIFIED`` films the numbers mean anything.
    certificate
        Violations of each condition by the answer.
    iterations
        Of the Newton method on the finest grid.
    outcome
        The same in units of the Hertz contact, with the mass balance.
    problem
        The problem that was solved.
    asperity_pressure
        Part of the pressure on statistical asperities (n) [Pa]; zero between smooth surfaces.

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, smooth_film
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> film = smooth_film(contact, nodes=129)
    >>> film.certified, film.within_film.stop < film.position.size
    (True, True)
    """

    contact: LubricatedContact
    position: Array
    pressure: Array
    film: Array
    state: States
    status: Status
    certificate: Certificate
    iterations: int
    outcome: Outcome
    problem: Problem
    asperity_pressure: Array

    @property
    def asperity_share(self) -> float:
        """Part of the load that asperities carry [1]."""
        return float(self.asperity_pressure.sum() / self.pressure.sum())

    @property
    def certified(self) -> bool:
        """True if the answer is proved."""
        return self.status is Status.CERTIFIED

    @cached_property
    def within_film(self) -> slice:
        """Nodes from the inlet to the last before the film ruptures."""
        ruptured = np.flatnonzero(self.state[1:-1] == State.RUPTURED) + 1
        return slice(0, int(ruptured[0]) if ruptured.size else self.state.size)

    @property
    def minimum_film(self) -> float:
        """Smallest film thickness [m]."""
        return float(self.film[self.within_film].min())

    @property
    def resolution(self) -> float:
        """Smallest film over what the grid can tell apart between smooth surfaces [1], see ``RESOLUTION_LIMIT``.

        In units of the Hertz contact the smallest film over the node distance to the power of 3/2: as the gap of the
        dry contact opens from its edge.
        """
        spacing = float(self.position[1] - self.position[0]) / self.contact.half_width
        return float(self.minimum_film / self.contact.film_scale / spacing**1.5)

    @property
    def central_film(self) -> float:
        """Film thickness in the middle of the dry contact [m]."""
        return float(np.interp(0.0, self.position, self.film))

    @property
    def mass_flow(self) -> Array:
        """Mass flow between the nodes of the film, over the density at ambient pressure and the length [m^2/s]."""
        unit = self.contact.rolling_velocity * self.contact.film_scale
        last = self.within_film.stop - 1
        return unit * self.outcome.point.balance.flow[:last]

    @property
    def flow_variation(self) -> float:
        """Difference of the greatest and the smallest mass flow over its mean [1]."""
        flow = self.mass_flow
        return float(np.ptp(flow) / abs(flow.mean()))


def domain(contact: LubricatedContact, flooded: float = INLET_GAP_RATIO) -> tuple[float, float]:
    """Ends of the part of the contact that is solved for, in half widths; ``flooded`` is inlet gap over film.

    A short inlet thins the film by 0.3 % at 40 and 0.1 % at 120 for piezoviscous oils; an isoviscous film between rigid
    cylinders wants 600 for 0.5 %.
    """
    checks.instance("contact", contact, LubricatedContact)
    checks.number("flooded", flooded, above=1.0)
    film = contact.central_film_estimate() / contact.film_scale
    inlet = max(2.0, math.sqrt(2.0 * flooded * film) + 1.0)
    return -inlet, max(1.5, 1.2 + 1.5 * math.sqrt(film))


def smooth_film(
    contact: LubricatedContact,
    *,
    nodes: int | None = None,
    flooded: float = INLET_GAP_RATIO,
    span: tuple[float, float] | None = None,
) -> Film:
    """Solve for the film between smooth surfaces in a steady state.

    Parameters
    ----------
    contact
        Operating conditions.
    nodes
        Nodes of the uniform grid, from 65 to 16385. By default 513, or as many more as the film needs to be resolved.
    flooded
        See ``domain``.
    span
        Ends of the domain in half widths of the dry contact; ``domain`` chooses them if not given.

    Returns
    -------
    Film
        With a status and a certificate; never an exception for a solve that failed.

    Raises
    ------
    InputError
        If the number of nodes or the domain cannot be used.

    Notes
    -----
    The grid is refined by halves from about a hundred nodes on, each starting from the one before: the end of the film
    then moves by a node or two on each grid, and the number of Newton steps does not grow with the number of nodes.

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, smooth_film
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> film = smooth_film(contact, nodes=257)
    >>> print(f"{film.status.name}, {1e6 * film.minimum_film:.2f} um")
    CERTIFIED, 0.37 um
    """
    ends = domain(contact, flooded) if span is None else span
    if nodes is not None:
        return _refined(contact, nodes, ends, None)
    nodes = DEFAULT_NODES
    film = _refined(contact, nodes, ends, None)
    while not (film.certified and film.resolution >= RESOLUTION_LIMIT) and 2 * nodes - 1 <= MOST_NODES:
        nodes = 2 * nodes - 1
        film = _refined(contact, nodes, ends, None)
    return film


def mixed_film(
    contact: LubricatedContact,
    asperities: Asperities,
    *,
    nodes: int = 257,
    flooded: float = INLET_GAP_RATIO,
    span: tuple[float, float] | None = None,
) -> Film:
    """Solve for the mean film between rough surfaces whose asperities share the load, see ``Asperities``.

    Parameters
    ----------
    contact
        Operating conditions.
    asperities
        Both surfaces' roughness together.
    nodes, flooded, span
        As for ``smooth_film``.

    Returns
    -------
    Film
        With ``asperity_pressure``; otherwise as from ``smooth_film``.

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, Asperities
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> film = mixed_film(contact, Asperities(composite_roughness=0.4e-6, correlation_length=20e-6), nodes=129)
    >>> print(f"{film.status.name}, {100 * film.asperity_share:.0f} % of the load on asperities")
    CERTIFIED, 16 % of the load on asperities
    """
    checks.instance("asperities", asperities, Asperities)
    if span is None:
        start, end = domain(contact, flooded)
        # Far enough for the asperities to part.
        end = max(end, 1.2 + 1.5 * math.sqrt(PARTED_SEPARATION * asperities.composite_roughness / contact.film_scale))
        span = min(start, -end), end
    return _refined(contact, nodes, span, asperities)


def touching_start(contact: LubricatedContact, nodes: int, span: tuple[float, float], touching_film: float) -> Film:
    """Starting film of rough surfaces: smooth ones, touching where it would be thinner than ``touching_film`` [m].

    Above twice that it is ``smooth_film``; where neither can be found, on a coarse grid, the film of faster surfaces,
    which the first steps carry away.
    """
    for factor in START_VELOCITY_FACTORS:
        faster = replace(contact, rolling_velocity=factor * contact.rolling_velocity)
        film = _refined(faster, nodes, span, None)
        if film.certified and film.film.min() > 2.0 * touching_film:
            return film
        film = _refined(faster, nodes, span, None, touching_film / contact.film_scale)
        if film.certified:
            return film
    return film


def _refined(
    contact: LubricatedContact,
    nodes: int,
    span: tuple[float, float],
    asperities: Asperities | None,
    touching_film: float = -math.inf,
) -> Film:
    checks.instance("contact", contact, LubricatedContact)
    start, end = checks.array("span", span, "half widths", ndim=1, size=2)
    if not (start < -1.0 and end > 1.0):
        raise InputError(f"span = ({start:g}, {end:g}): must reach from below -1 to above 1 [half widths]")
    nodes = checks.whole("nodes", nodes, FEWEST_NODES, MOST_NODES)
    sizes = [nodes]
    while sizes[-1] > 2 * COARSEST_NODES:
        sizes.append((sizes[-1] + 1) // 2)
    grids = [np.linspace(start, end, size) for size in reversed(sizes)]
    for factor in START_FILM_FACTORS:
        film = _from_dry_contact(contact, grids, factor, asperities, touching_film)
        if film.certified:
            break
    return film


def _from_dry_contact(
    contact: LubricatedContact, grids: list[Array], factor: float, asperities: Asperities | None, touching_film: float
) -> Film:
    """Refine from the dry contact with a film of ``factor`` times the estimate in between."""
    x = grids[0]
    problem = _problem(contact, x, asperities, touching_film)
    paces = reynolds.SMOOTH if math.isinf(touching_film) else (*reynolds.SMOOTH, *reynolds.ROUGH)
    film = factor * contact.central_film_estimate() / contact.film_scale
    if asperities is not None:
        film = max(film, factor * asperities.composite_roughness / contact.film_scale)
    # A film that is thick against the flattening spreads the load over more than the dry contact.
    width = max(1.0, 1.5 * math.sqrt(film))
    pressure = np.sqrt(np.maximum(1.0 - (x / width) ** 2, 0.0)) / width
    approach = film - float((problem.profile + problem.deflection(pressure)).min())
    outcome = reynolds.solve(problem, pressure, approach, paces)
    for grid in grids[1:]:
        if not outcome.converged:
            break
        pressure = np.interp(grid, x, np.maximum(outcome.point.pressure, 0.0))
        x, problem = grid, _problem(contact, grid, asperities, touching_film)
        outcome = reynolds.solve(problem, pressure, outcome.point.approach, paces)
    return described(contact, x, problem, outcome)


def _problem(contact: LubricatedContact, x: Array, asperities: Asperities | None, touching_film: float) -> Problem:
    deflection = Deflection(x.size, float(x[1] - x[0]))
    return Problem(contact, deflection, 0.5 * x**2, touching_film, asperities=asperities)


def described(contact: LubricatedContact, x: Array, problem: Problem, outcome: Outcome) -> Film:
    """Certify an outcome on the positions x (half widths), and give it units."""
    point = outcome.point
    certificate = reynolds.certify(problem, point.pressure, point.approach)
    return Film(
        contact=contact,
        position=contact.half_width * x,
        pressure=contact.hertz_pressure * outcome.pressure,
        film=contact.film_scale * point.clearance,
        state=outcome.state,
        status=reynolds.judge(outcome.converged, certificate),
        certificate=certificate,
        iterations=outcome.iterations,
        outcome=outcome,
        problem=problem,
        asperity_pressure=contact.hertz_pressure * (point.pressure - point.fluid),
    )


def film_dataset(film: Film) -> xr.Dataset:
    """Pressure, asperities' part, film thickness and state by position, with the status and certificate of the answer.

    Returns
    -------
    xarray.Dataset
        Dimension ``rolling_position`` [um].

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, smooth_film
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> dict(film_dataset(smooth_film(contact, nodes=129)).sizes)
    {'rolling_position': 129}
    """
    checks.instance("film", film, Film)
    data: dict[str, Any] = {
        "film_pressure": ("rolling_position", 1e-6 * film.pressure),
        "asperity_pressure": ("rolling_position", 1e-6 * film.asperity_pressure),
        "film": ("rolling_position", 1e6 * film.film),
        "asperity_share": film.asperity_share,
        "node_state": ("rolling_position", film.state, State.flag_attributes()),
        "status": ((), np.int8(film.status), Status.flag_attributes()),
        "worst_residual": film.certificate.worst,
        "iterations": film.iterations,
    }
    return labelled(xr.Dataset(data, coords={"rolling_position": 1e6 * film.position}))
