"""Analysis of a case over its load cases: each in its own misalignment, at its own torque and speed.

Means over the load cases of a duty cycle: power loss and efficiency by time, torques of equal damage.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..cases.analysis_size import AnalysisSize
from ..cases.deflection_table import MisalignmentSource
from ..cases.deflections import FLANKS, Deflections
from ..cases.load_cases import has_own_misalignment, load_case_misalignment, read_load_cases
from ..cases.schema.case_schema import Case
from ..cases.schema.load_case_table import LoadCase, named_load_cases
from ..contact.solvers import Status
from ..core.arrays import Array
from ..core.attributes import StoredStatus, labelled
from ..core.checks import array, distinct, instance, one_of, positive
from ..core.errors import EaseoffError, InputError
from ..geometry.deviation.deviation import Method
from ..geometry.pair.assembly import Misalignment
from ..geometry.pair.gear_pair import FlankName
from ..geometry.pair.modification import Modification
from ..geometry.tooth.tooth_flanks import MemberName
from .analysis.case_analysis import require_solver_options, with_friction
from .analysis.contact_analysis import contact_analysis
from .analysis.key_numbers import key_numbers
from .analysis.operating import Friction, FrictionConditions, Operating
from .case_in_mesh import CaseInMesh, FlanksInMesh, case_attributes, checked_case
from .deviations import Deviated, Source
from .progress import callback, shows_progress
from .result import RESULT_SCHEMA_VERSION

if TYPE_CHECKING:
    from ..friction import FrictionModel, Lubricant

#: Life factors of case-hardened steel, ISO 6336-2 and -3: at fewer cycles and at the knee. Pitting stress grows with
#: the root of the torque, root stress with the torque.
PITTING_LIFE, PITTING_CYCLES = (1.6, 1.0), (1e5, 5e7)
BENDING_LIFE, BENDING_CYCLES = (2.5, 1.0), (1e3, 3e6)


def _slope(life: tuple[float, float], cycles: tuple[float, float]) -> float:
    return math.log(cycles[1] / cycles[0]) / math.log(life[0] / life[1])


#: Exponents of the torque in the number of cycles to failure: pitting 6.61, bending of the root 8.74.
DAMAGE_EXPONENTS = (0.5 * _slope(PITTING_LIFE, PITTING_CYCLES), _slope(BENDING_LIFE, BENDING_CYCLES))
EXPONENT_LIMIT = 100.0


def equivalent_torque(torques: Array, cycles: Array, exponent: float) -> float:
    """Torque that does the same damage in the same number of cycles.

    By Palmgren and Miner's rule with a life of T^-p: (sum n T^p / sum n)^(1/p), ISO 6336-6.

    Parameters
    ----------
    torques
        Torques (n) [N m].
    cycles
        Numbers of cycles (n), or what is in proportion to them.
    exponent
        p.

    Raises
    ------
    InputError
        If a number is negative, or there is no torque above 0 or no cycle.

    Examples
    --------
    >>> round(equivalent_torque(np.array([100.0, 200.0]), np.array([3.0, 1.0]), 1.0), 9)
    125.0
    >>> round(equivalent_torque(np.array([100.0, 200.0]), np.array([1.0, 1.0]), 1000.0), 1)
    199.9
    """
    torques = array("torques", torques, "N m", ndim=1, fewest=1, least=0.0)
    cycles = array("cycles", cycles, ndim=1, size=torques.size, least=0.0)
    positive("sum of the cycles", cycles.sum())
    greatest = positive("greatest of the torques", torques.max(), "N m")
    mean = float(np.average((torques / greatest) ** positive("exponent", exponent), weights=cycles))
    return greatest * math.pow(mean, 1.0 / exponent)


def duty_means(numbers: xr.Dataset, exponents: Sequence[float] = DAMAGE_EXPONENTS) -> xr.Dataset:
    """Means of power loss and efficiency over load cases, equivalent torque of each flank, and shares of damage.

    Losses add up by share of time. Damage, of a life of T^-p, adds up in cycles, by share times speed, or by share if
    no load case has a speed. NaN if a load case has no value; other numbers, such as pressures, have no mean.
    """
    share, torque = numbers["share"].values / np.sum(numbers["share"].values), numbers["torque"].values
    sides = numbers["flank"].values.astype(str)
    known = [str(side) for side in ("drive", "coast") if side in sides]
    cycles = share * numbers["speed"].values if "speed" in numbers else share
    equivalent = np.empty((len(known), len(exponents)))
    damage = np.zeros((torque.size, len(exponents)))
    for row, side in enumerate(known):
        rows = sides == side
        for column, exponent in enumerate(exponents):
            equivalent[row, column] = equivalent_torque(torque[rows], cycles[rows], exponent)
            part = cycles[rows] * (torque[rows] / np.max(torque[rows])) ** exponent
            damage[rows, column] = part / np.sum(part)
    data: dict[str, Any] = {
        "equivalent_torque": (("flank", "damage_exponent"), equivalent),
        "damage_share": (("load_case", "damage_exponent"), damage),
    }
    if "mean_power_loss" in numbers:
        loss, power = (float(share @ numbers[name].values) for name in ("mean_power_loss", "input_power"))
        data |= {"duty_power_loss": loss, "duty_input_power": power, "duty_efficiency": 1.0 - loss / power}
    names = {str(name): numbers[name] for name in numbers.coords}
    return xr.Dataset(data, coords={"flank": known, "damage_exponent": list(exponents), **names})


SINGLE = ("torque", "speed", "temperature", "roughness")  # dimensions of which a load case has one value
COMMON = ("solver", "compliance_model", "edge_contact", "pinion_teeth", "gear_teeth", "pinion_hand")


class LoadCaseStatus(StoredStatus):
    """End of the analysis of a load case."""

    CERTIFIED = 0
    UNCERTIFIED = 1
    FAILED = 2


@shows_progress("load cases", "solve")
def analyze_load_cases(
    case: Case | str | Path,
    load_cases: Sequence[LoadCase] | str | Path | None = None,
    *,
    flank: FlankName = "drive",
    misalignment: MisalignmentSource | None = None,
    deviations: Mapping[MemberName, Source] | None = None,
    deviated: Deviated = "ease_off",
    interpolation: Method = "spline",
    modification: Modification | None = None,
    edge_contact: bool | None = None,
    marking: float | None = None,
    solver: str = "auto",
    temperature: float | None = None,
    roughness: float | tuple[float, float] | None = None,
    oil: str | Lubricant | None = None,
    friction_model: FrictionModel | None = None,
    friction_feedback: bool | None = None,
    damage_exponents: Sequence[float] = DAMAGE_EXPONENTS,
    progress: Callable[[], None] | bool | None = None,
    stage: Callable[[str], None] | None = None,
    **options: Any,
) -> xr.DataTree:
    """Analyse a case over load cases.

    Flanks and elastic teeth are computed once, ease-off and contact lines once a misalignment. A load case that cannot
    be analysed has a status and a reason; the others are analysed all the same.

    Parameters
    ----------
    case
        As of ``analyze``.
    load_cases
        Load cases, or the path of a table of them; those of the case if left out.
    flank
        Of load cases that name none.
    misalignment
        As of ``analyze``, of load cases without assembly errors of their own. What a load case gives takes the place of
        the same error at its torque.
    deviations, deviated, interpolation, modification, edge_contact, marking, solver
        As of ``analyze``.
    temperature, roughness, oil, friction_model, friction_feedback
        As of ``analyze``, with one value each; needed with a speed only. A load case with a speed, its own or that of
        the case, has friction.
    damage_exponents
        Exponents p of a life of T^-p, for the torques of equal damage.
    progress, stage, **options
        As of ``analyze``.

    Returns
    -------
    xr.DataTree
        Group ``load_cases``: every number of ``key_numbers`` over ``load_case``, with inputs and status; ``duty``:
        means over the shares, if the load cases have some; ``results/NAME``: the whole result of each load case, as of
        ``analyze``.

    Raises
    ------
    InputError
        If an argument is out of range, there are no load cases, or an analysis needs more memory than is free.
    EaseoffError
        If no load case can be analysed: why the first one cannot.
    MissingSolverError
        If the solver's package is not installed.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> rows = [LoadCase(torque=100.0, share=0.9), LoadCase(name="climb", torque=300.0, E=0.05, share=0.1)]
    >>> tree = analyze_load_cases(case, rows)
    >>> tree["load_cases/max_pressure"].dims, tree["results/climb/loaded"].sizes["torque"]
    (('load_case',), 1)
    """
    chosen = require_solver_options(options, solver, analyze_load_cases)
    case = checked_case(case)
    one_of("flank", flank, FLANKS)
    flanks = FlanksInMesh(flank, misalignment, deviations, deviated, interpolation, modification)
    conditions = FrictionConditions(None, temperature, roughness, oil, friction_model, friction_feedback)
    operating = Operating(flanks, None, edge_contact, marking, chosen, conditions)
    rows, given = _named(case, load_cases), flanks.errors(case)
    exponents = distinct("damage_exponents", damage_exponents, least=1.0, most=EXPONENT_LIMIT).tolist()
    AnalysisSize.of(case, 1).require_memory()
    runs: dict[str, _Run] = {}
    for name, row in rows.items():
        side = row.flank or flank
        errors = load_case_misalignment(row, case, given, side)
        runs[name] = _Run(row, side, errors, _friction(name, case, row, conditions))
    meshes = _Meshes(case, flanks, stage)
    failures: list[EaseoffError] = []
    for run in runs.values():
        try:
            # Without load a load case with deflections is in the assembly without torque, as in any analysis.
            state = meshes.at(run.flank, run.misalignment if has_own_misalignment(run.row) else given)
            torques = [run.row.torque]
            analysis = contact_analysis(state, torques, **operating.contact, progress=callback(progress), **options)
            run.tree = with_friction(analysis, run.friction, chosen, callback(progress)).tree
        except EaseoffError as error:
            run.reason = " ".join(str(error).split())
            failures.append(error)
    trees = {name: run.tree for name, run in runs.items() if run.tree is not None}
    if not trees:
        raise failures[0]
    numbers = _numbers(runs)
    groups = {"/": xr.Dataset(attrs=_provenance(case, next(iter(trees.values())).attrs)), "/load_cases": numbers}
    if "share" in numbers:
        groups["/duty"] = labelled(duty_means(numbers, exponents))
    tree = xr.DataTree.from_dict(groups)
    for name, result in trees.items():
        tree[f"results/{name}"] = result
    return tree


@dataclass
class _Run:
    """Analysis of a load case: its inputs, and what came of it."""

    row: LoadCase
    flank: FlankName
    misalignment: Misalignment
    friction: Friction | None
    tree: xr.DataTree | None = None
    reason: str = ""


class _Meshes:
    """The pair in mesh by flank and misalignment; what does not change with the misalignment is computed once."""

    def __init__(self, case: Case, flanks: FlanksInMesh, stage: Callable[[str], None] | None) -> None:
        self.case, self.flanks, self.stage = case, flanks, stage
        self.first: dict[str, CaseInMesh] = {}
        self.last: dict[str, tuple[Misalignment | Deflections, CaseInMesh]] = {}

    def at(self, flank: FlankName, misalignment: Misalignment | Deflections) -> CaseInMesh:
        """The pair in a misalignment; the last one of each flank is kept."""
        kept = self.last.get(flank)
        if kept is None or kept[0] != misalignment:
            if flank not in self.first:
                given = replace(self.flanks, flank=flank, misalignment=misalignment)
                self.first[flank] = CaseInMesh.meshed(self.case, given, self.stage)
                state = self.first[flank]
            else:
                state = self.first[flank].misaligned(misalignment)
            self.last[flank] = misalignment, state
        return self.last[flank][1]


def _named(case: Case, load_cases: Sequence[LoadCase] | str | Path | None) -> dict[str, LoadCase]:
    """Load cases by name, those of the case if none are given."""
    if isinstance(load_cases, str | Path):
        load_cases = read_load_cases(load_cases)
    rows = case.load_cases if load_cases is None else load_cases
    instance("load_cases", rows, Sequence)
    if not rows:
        raise InputError("load_cases: the case has none; give some, or tables [[load_cases]] in the case")
    for row in rows:
        if not isinstance(row, LoadCase):
            raise InputError(f"load_cases: {type(row).__name__}: must be a LoadCase")
    try:
        return named_load_cases(rows)
    except ValueError as error:
        raise InputError(str(error)) from error


def _friction(name: str, case: Case, row: LoadCase, conditions: FrictionConditions) -> Friction | None:
    """Friction of a load case; ``None`` if neither it nor the case has a speed."""
    if row.speed is None and case.friction is None:
        return None
    friction = replace(conditions, speed=row.speed).of_case(case)
    assert friction is not None  # one of both has a speed
    for what, count in zip(SINGLE[1:], friction.operation.shape, strict=True):
        if count != 1:
            raise InputError(f"load case {name!r}: {what} has {count} values: must be one, here or in [friction]")
    return friction


def _numbers(runs: Mapping[str, _Run]) -> xr.Dataset:
    """Inputs, status and key numbers of every load case, as one dataset."""
    datasets = {name: _single(key_numbers(run.tree)) for name, run in runs.items() if run.tree is not None}
    known: dict[str, xr.DataArray] = {}
    for dataset in datasets.values():
        known |= {str(name): variable for name, variable in dataset.data_vars.items() if str(name) not in known}
    data: dict[str, Any] = {}
    for variable, pattern in known.items():
        missing = np.full(pattern.shape, np.nan)
        values = np.array(
            [datasets[n][variable].values if n in datasets and variable in datasets[n] else missing for n in runs]
        )
        whole = values.dtype.kind == "f" and pattern.dtype.kind != "f"  # some have no value: no codes any more
        attributes = {} if whole else {key: v for key, v in pattern.attrs.items() if key.startswith("flag_")}
        data[variable] = (("load_case", *pattern.dims), values, attributes)
    data["torque"] = ("load_case", [run.row.torque for run in runs.values()])
    for key in ("offset", "pinion_axial", "gear_axial", "shaft_angle"):
        data[f"misalignment_{key}"] = ("load_case", [getattr(run.misalignment, key) for run in runs.values()])
    frictions = [run.friction for run in runs.values()]
    if any(frictions):
        speeds = [np.nan if one is None else float(np.ravel(one.operation.speed)[0]) for one in frictions]
        data["speed"] = ("load_case", speeds)
        data["input_power"] = ("load_case", data["torque"][1] * np.array(speeds) * np.pi / 30.0)
    shares = np.array([np.nan if run.row.share is None else run.row.share for run in runs.values()])
    if np.all(np.isfinite(shares)):
        data["share"] = ("load_case", shares / shares.sum())
    data["flank"] = ("load_case", [run.flank for run in runs.values()])
    status = [LoadCaseStatus.FAILED if run.tree is None else _status(run.tree) for run in runs.values()]
    meanings = LoadCaseStatus.flag_attributes() | {"long_name": "how the analysis of the load case ended"}
    data["status"] = ("load_case", np.array(status, dtype=np.int8), meanings)
    data["reason"] = ("load_case", [run.reason for run in runs.values()])
    return labelled(xr.Dataset(data, coords={"load_case": list(runs)}))


def _single(numbers: xr.Dataset) -> xr.Dataset:
    """Numbers without the dimensions of which a load case has one value."""
    single = numbers.isel({name: 0 for name in SINGLE if name in numbers.sizes}, drop=True)
    return single.drop_vars([name for name in single.coords if name not in single.sizes])


def _status(tree: xr.DataTree) -> LoadCaseStatus:
    solved = all(bool(np.all(tree[group]["status"].values == Status.CERTIFIED)) for group in ("light_load", "loaded"))
    return LoadCaseStatus.CERTIFIED if solved else LoadCaseStatus.UNCERTIFIED


def _provenance(case: Case, common: Mapping[Any, Any]) -> dict[str, Any]:
    """Origin of the results, as netCDF attributes; of a result those that all have in common."""
    return {
        **case_attributes(case, "analyze_load_cases"),
        "schema_version": RESULT_SCHEMA_VERSION,
        **{name: common[name] for name in COMMON if name in common},
    }
