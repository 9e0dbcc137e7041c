"""The best machine settings of a case for objectives and limits, rounded and analysed."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Literal, get_args

import numpy as np
import xarray as xr

from ....cases.conversion import misalignment as case_misalignment
from ....cases.deflection_table import MisalignmentSource, misalignments_of
from ....cases.deflections import SYMBOLS, Deflections, with_errors
from ....cases.schema.case_schema import Case
from ....cases.writing import case_toml
from ....core.attributes import labelled
from ....core.checks import array, instance, number, one_of, shown, whole, words
from ....core.errors import EaseoffError, InputError, suggestion
from ....geometry.cutting.named_settings import USUAL_RESOLUTION, MachineResolution
from ....geometry.pair.assembly import Misalignment
from ....geometry.pair.gear_pair import FlankName, GearPair
from ...analysis.case_analysis import analyze
from ...analysis.contact_analysis import case_torques
from ...analysis.operating import operation_of
from ...case_in_mesh import CaseInMesh, checked_case, prepared_pair
from ...progress import callback, shows_progress
from ...sweep.sweep_plan import Distribution, sample_values
from .aim import NEEDED, Aim, ContactQuantity, Judgement, Objective, QuantityLimit
from .analysed_settings import Workshop, usual_root_line_change
from .free_setting import SettingSpace, free_settings, with_limits
from .front import FRONT_TOLERANCE, best_of, front, front_points, front_record, require_same_search, search_record
from .setting_search import Outcome, SettingSearch, first_workshop
from .step_programme import FORMS, Form
from .trust_region import USUAL_TOLERANCE

Flanks = Literal["drive", "coast", "both"]

STEP_LIMIT, POINT_LIMIT, USUAL_POINT_COUNT = 1000, 1000, 9
USUAL_OBJECTIVES = ("peak_to_peak", "max_pressure")


@shows_progress("optimisation", "programme")
def optimize(
    case: Case | str | Path,
    minimize: Sequence[str] = USUAL_OBJECTIVES,
    *,
    limits: Sequence[str] = (),
    form: Form = "worst",
    weights: Sequence[float] | None = None,
    points: int | None = None,
    flank: Flanks = "drive",
    torques: float | Sequence[float] | None = None,
    misalignments: Sequence[MisalignmentSource] = (),
    spread: Mapping[str, Distribution | str] | None = None,
    samples: int | None = None,
    seed: int = 0,
    free: Sequence[str] | None = None,
    limit_settings: Mapping[str, tuple[float, float]] | None = None,
    move: float = 100.0,
    resolution: MachineResolution | None = None,
    steps: int = 30,
    resume: xr.DataTree | None = None,
    progress: Callable[[], None] | bool | None = None,
    stage: Callable[[str], None] | None = None,
) -> xr.DataTree:
    """Search for the machine settings of a case that are best under load, and analyse the case with them.

    Convex programmes in a trust region propose the steps, certified analyses with exact derivatives judge them. What is
    found is a local optimum, rounded to the resolution of the machine and analysed rounded; where rounded settings
    cannot be analysed, as they were found or else as they were. See `Optimal settings
    <../engineer/guides/optimal_settings.html>`_.

    Parameters
    ----------
    case
        A checked case, or what ``read_case`` takes.
    minimize
        Quantities, as ``peak_to_peak``, ``harmonic_1`` or ``max_pressure``, see ``aim.NAMES``; with
        ``@TORQUE`` at one torque alone, with ``drive.`` or ``coast.`` on one side.
    limits
        Of the same quantities: ``max_pressure@250<=1500``. If ``root_line_change`` is not among them, it is limited to
        one percent of the height of the lower flank.
    form
        ``worst``: the greatest ratio to the start over objectives, torques and assemblies; ``weighted``: the weighted
        sum of the means of the ratios; ``pareto``: the front of two objectives.
    weights
        Of the objectives; one each if left out, and on a front.
    points
        Of a front; 9 if left out.
    flank
        ``drive``, ``coast`` or ``both``.
    torques
        Torques at the pinion [N m]; the case's own if left out.
    misalignments
        Further assemblies, see ``analyze``; each must be the same at all torques.
    spread
        Distributions of the assembly errors ``E``, ``P``, ``G``, ``Sigma`` [mm, degree], as in ``sweep``. Of a worst
        case bounded ones add the assemblies at their corners.
    samples, seed
        Of the assemblies drawn from them.
    free
        Keys of the settings that move, or patterns; see ``free_settings``.
    limit_settings
        Least and greatest value of settings by key or pattern [mm, degree].
    move
        Limit of the others: by how much one alone may change the ease-off [um].
    resolution
        Of the machine; the usual one if left out.
    steps
        The most programmes for one optimum.
    resume
        A result to go on from: of the same case and free settings, and for a front of the same objectives and limits.
    progress
        ``True`` for a line that shows it; or a function, called after every programme.
    stage
        Called with the name of what takes long before it begins.

    Returns
    -------
    xr.DataTree
        The analysis of the case with the settings found, with the groups ``optimal_settings`` (settings, objectives,
        limits and what they cost, programmes, assemblies) and, of a front, ``front``. The attribute ``case`` has the
        case with the settings.

    Raises
    ------
    InputError
        If an argument is out of range, or the case has what derivatives do not cover.
    GeometryError
        If the pair cannot be analysed as it is.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> tree = optimize(case, ["peak_to_peak"], torques=[100.0], steps=1)
    >>> bool(tree["optimal_settings/objective_ratio"].item() <= 1.0)
    True
    """
    checked = checked_case(case)
    one_of("form", form, FORMS)
    one_of("flank", flank, get_args(Flanks))
    sides: tuple[FlankName, ...] = get_args(FlankName) if flank == "both" else (flank,)
    instance("spread", spread, Mapping | None)
    instance("limit_settings", limit_settings, Mapping | None)
    instance("resolution", resolution, MachineResolution | None)
    instance("resume", resume, xr.DataTree | None)
    whole("steps", steps, 1, STEP_LIMIT)
    number("move", move, "um", above=0.0, most=1000.0)
    load = case_torques(checked, torques)
    distributions = dict(spread or {})
    further = misalignments_of(misalignments)
    case_assembly, *given = constant_assemblies([case_misalignment(checked.misalignment), *further])
    drawn = sampled_assemblies(case_assembly, distributions, samples, seed)
    corners = corner_assemblies(case_assembly, distributions) if form == "worst" else []
    assemblies = [case_assembly, *given, *corners, *drawn]
    pairs = [prepared_pair(checked, side, assemblies[0]) for side in sides]
    objectives, quantity_limits = _objectives(minimize, weights), _limits(limits, pairs)
    aim = Aim(objectives, quantity_limits, form, tuple(load.tolist()), sides, len(assemblies))
    count = _point_count(aim, points, weights)
    _require_known(aim, checked)
    losses = any(one.name == "mean_power_loss" for one in aim.quantities)
    searched = checked if losses else checked.model_copy(update={"friction": None})
    space = SettingSpace(searched, free_settings(checked, sides, free), resolution or USUAL_RESOLUTION)
    states = {side: CaseInMesh.of(searched, flank=side, stage=stage) for side in sides}
    if stage is not None:
        stage("search")
    unloaded = any(one.unloaded for one in aim.quantities)
    rough = Workshop(space, aim.torques, tuple(assemblies), states, space.scales, unloaded)
    workshop, readings = first_workshop(rough)
    bounded = with_limits(space.free, workshop.units, move, limit_settings or {})
    workshop = replace(workshop, space=replace(space, free=bounded))
    tolerance = FRONT_TOLERANCE if form == "pareto" else USUAL_TOLERANCE
    searching = SettingSearch(
        workshop, readings, steps=steps, tolerance=tolerance, progress=callback(progress), stage=stage
    )
    judgement = Judgement(aim, aim.references(searching.begun(Judgement(aim, ())).read))
    start = searching.begun(judgement)
    if resume is not None:
        require_same_search(resume, start, aim)
    if form == "pareto":
        optima = front(searching, judgement, count, [] if resume is None else front_points(resume))
        chosen = best_of(optima)
        outcome = optima[chosen].resumed(searching, judgement)
        done = [step for one in optima if one.outcome is not None for step in one.outcome.steps]
        record = search_record(start, outcome, judgement, done)
        front_group = front_record(optima, record, chosen)
    else:
        known = None if resume is None else np.asarray(resume["optimal_settings/setting_value"].values)
        outcome = searching.settled(judgement, None if known is None else searching.anew(known, judgement)[0])
        record = search_record(start, outcome, judgement, outcome.steps)
        front_group = None
    if drawn:
        record = record.merge(_fresh_samples(outcome, judgement, distributions, samples, seed))
    record.attrs |= {
        "analyses": workshop.effort.analyses,
        "differentiated_analyses": workshop.effort.differentiated,
        "teeth_built": workshop.effort.teeth,
        "largest_move_um": move,
        "seed": seed,
        "spread": ", ".join(
            f"{name}~{one if isinstance(one, str) else one.text}" for name, one in distributions.items()
        ),
    }
    best = outcome.case.model_copy(update={"friction": checked.friction})
    tree = analyze(best, flank=sides[0], torques=list(aim.torques))
    tree["optimal_settings"] = xr.DataTree(record)
    if front_group is not None:
        tree["front"] = xr.DataTree(front_group)
    tree.attrs["case"] = case_toml(best)
    return tree


def _require_known(aim: Aim, case: Case) -> None:
    """Refuse quantities that no analysis of the case has, before its teeth are built."""
    missing = {
        "root_stress_history": case.compliance.model != "fe",
        "mean_power_loss": operation_of(case.friction) is None,
    }
    for one in aim.quantities:
        if missing.get(one.meaning.variable, False):
            raise InputError(f"quantity = {shown(one.text)}: must be of a case with {NEEDED[one.meaning.variable]}")


def _point_count(aim: Aim, points: int | None, weights: Sequence[float] | None) -> int:
    """Number of points of a front, and whether what is given goes with the form."""
    if aim.form != "pareto":
        if points is not None:
            raise InputError(f"points = {points}: must go with form = 'pareto'")
        return 0
    if len(aim.objectives) != 2:
        quantities = ", ".join(one.quantity.text for one in aim.objectives)
        raise InputError(f"minimize = {quantities}: must be two quantities for the front of form = 'pareto'")
    if weights is not None:
        raise InputError("weights: must be left out for form = 'pareto', which has all of them")
    return whole("points", USUAL_POINT_COUNT if points is None else points, 2, POINT_LIMIT)


def _objectives(minimize: Sequence[str], weights: Sequence[float] | None) -> tuple[Objective, ...]:
    texts = words("minimize", minimize)
    factors = [1.0] * len(texts) if weights is None else array("weights", weights, ndim=1, above=0.0).tolist()
    if len(factors) != len(texts):
        raise InputError(f"weights = {factors}: must be as many as objectives, {len(texts)}")
    return tuple(Objective(ContactQuantity.parsed(text), weight) for text, weight in zip(texts, factors, strict=True))


def _limits(texts: Sequence[str], pairs: Sequence[GearPair]) -> tuple[QuantityLimit, ...]:
    """Limits that are given; the usual one of the root line, unless one is given."""
    given = tuple(limit for text in words("limits", texts) for limit in QuantityLimit.parsed(text))
    if any(limit.quantity.name == "root_line_change" for limit in given):
        return given
    return (*given, QuantityLimit(ContactQuantity("root_line_change"), usual_root_line_change(pairs)))


def sampled_assemblies(
    base: Misalignment, distributions: Mapping[str, Distribution | str], count: int | None, seed: int = 0
) -> list[Misalignment]:
    """Assemblies with errors drawn from distributions, the others being those of one assembly.

    Distributions are by ``E``, ``P``, ``G`` or ``Sigma`` [mm, degree], of the error itself; the seed is that of
    ``sweep``. InputError if samples are given without distributions or the other way round.
    """
    chosen = _distributions(distributions)
    if count is not None and not chosen:
        raise InputError(f"samples = {count}: must go with a distribution of an assembly error, as E~normal(0,0.03)")
    if count is None and chosen:
        raise InputError(f"samples: must be given with the distribution of {', '.join(chosen)}, such as 8")
    if count is None:
        return []
    values = sample_values(chosen, count, seed=seed)
    samples = [{name: float(drawn[number]) for name, drawn in values.items()} for number in range(count)]
    return [with_errors(base, sample) for sample in samples]


def corner_assemblies(base: Misalignment, distributions: Mapping[str, Distribution | str]) -> list[Misalignment]:
    """Assemblies with every bounded error at its least or greatest value, all of them together; none without bounds.

    A normal distribution has no bounds; its error is left as it is. Samples seldom reach the corners, where most
    quantities are greatest: without these a worst case over samples says little of others.
    """
    chosen = _distributions(distributions)
    ends = {name: (one.parameters[0], one.parameters[-1]) for name, one in chosen.items() if one.kind != "normal"}
    if not ends:
        return []
    return [with_errors(base, dict(zip(ends, corner, strict=True))) for corner in itertools.product(*ends.values())]


def _distributions(given: Mapping[str, Distribution | str]) -> dict[str, Distribution]:
    """Distributions by error, parsed; raises InputError if an error is unknown."""
    chosen: dict[str, Distribution] = {}
    for name, one in given.items():
        if name not in SYMBOLS:
            raise InputError(
                f"distribution of {name}: must be of one of {', '.join(SYMBOLS)}{suggestion(name, SYMBOLS)}"
            )
        chosen[name] = one if isinstance(one, Distribution) else Distribution.parsed(one)
    return chosen


def constant_assemblies(given: Sequence[Misalignment | Deflections]) -> list[Misalignment]:
    """The assemblies as given, or InputError if one depends on the torque."""
    assemblies = [one for one in given if isinstance(one, Misalignment)]
    if len(assemblies) < len(given):
        raise InputError(
            "misalignment: must be the same at all torques for a search of settings; give the assembly of the torque "
            "that matters"
        )
    return assemblies


def _fresh_samples(
    outcome: Outcome, judgement: Judgement, spread: Mapping[str, Distribution | str], samples: int | None, seed: int
) -> xr.Dataset:
    """Quantities of the settings in assemblies drawn anew, unknown to the search; NaN where one has no analysis."""
    point = outcome.point
    drawn = sampled_assemblies(point.workshop.assemblies[0], spread, samples, seed + 1)
    judgement = replace(judgement, aim=replace(judgement.aim, assemblies=1))
    ratios = np.full((len(judgement.aim.objectives), len(drawn)), np.nan)
    limited = np.full((len(judgement.aim.limits), len(drawn)), np.nan)
    for sample, assembly in enumerate(drawn):
        workshop = replace(point.workshop, assemblies=(assembly,))
        # The ease-off is compared with that of the start in the case's own assembly.
        start = {(flank, 0): point.start[flank, 0] for flank in workshop.states}
        with suppress(EaseoffError):
            fresh = replace(point, readings=workshop.readings(outcome.case), start=start, workshop=workshop)
            ratios[:, [sample]], limited[:, [sample]] = judgement.by_assembly(fresh.read)
    data = {
        "sample_ratio": (("objective", "sample"), ratios),
        "sample_limited": (("quantity_limit", "sample"), limited),
    }
    return labelled(xr.Dataset(data, coords={"sample": np.arange(len(drawn))}))
