"""Wear over many revolutions, the contact computed anew as the flanks change; lapping is wear with its own coefficient.

Archard's law alone is not more than a law of proportion: the coefficient is the user's. It gathers lubrication,
materials and, in lapping, the compound. With step, stop and duty cycle it makes the wear law.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from ..cases.analysis_size import AnalysisSize
from ..cases.deflection_table import MisalignmentSource
from ..cases.schema.case_schema import Case
from ..cases.schema.usual_torques import TORQUE_LIMIT, TORQUE_MINIMUM, torque_range
from ..contact.archard_wear import Engagement, engagement, integral, on_flank, rolling_splines, touched
from ..contact.lines.flank_splines import FlankSplines
from ..contact.mesh_cycle import MeshCycle
from ..contact.solvers import Status
from ..core.arrays import Array, Bools
from ..core.attributes import labelled
from ..core.checks import instance, number, positive, whole
from ..core.errors import GeometryError, InputError, time_in_words
from ..geometry.deviation.deviated_flank import deviated_ease_off
from ..geometry.deviation.deviation import Deviation, Method
from ..geometry.pair.ease_off import rolling
from ..geometry.pair.gear_pair import MEMBERS, FlankName, PairGeometry, grid
from ..geometry.tooth.tooth_flanks import MemberName, named_member
from .analysis.contact_analysis import in_assembly_under_load
from .case_in_mesh import CaseInMesh, case_attributes, checked_case, deflection_attributes, prepared_pair
from .deviations import LOST_CONTACT_LIMIT, Source, flank_deviations, require_line_contact
from .progress import callback, shows_progress

WEAR_COEFFICIENT_LIMIT = 1e-3  # [mm^2/N]; more is a mistake of units
REVOLUTIONS_LIMIT = 1e15  # of the pinion; 2000 years at 1e6 1/min
WEAR_DEPTH_LIMIT = 1e4  # [um]; deeper than the teeth of usual gears are thick
USUAL_STEP_LIMIT = 1000


@dataclass(frozen=True)
class WearLaw:
    """Wear coefficients, step control and stop.

    Parameters
    ----------
    pinion_coefficient, gear_coefficient
        Depth per pressure and sliding way [mm^2/N]: Archard's dimensional coefficient. 1e-12 mm^2/N = 1e-18 m^2/N.
    revolutions
        Revolutions of the pinion after which to stop.
    largest_step
        Largest depth in one step [um]; between steps the contact is computed anew. The error is of first order in it.
    largest_depth
        Depth at which to stop before that [um]; none if left out.
    most_steps
        The most steps to take.

    Raises
    ------
    InputError
        If a number cannot be used.

    Examples
    --------
    >>> WearLaw(1e-12, 2e-12, revolutions=1e7).largest_step
    0.5
    """

    pinion_coefficient: float
    gear_coefficient: float
    revolutions: float
    largest_step: float = 0.5
    largest_depth: float | None = None
    most_steps: int = USUAL_STEP_LIMIT

    def __post_init__(self) -> None:
        for name in ("pinion_coefficient", "gear_coefficient"):
            value = positive(name, getattr(self, name), "mm^2/N", zero=True)
            if value > WEAR_COEFFICIENT_LIMIT:
                raise InputError(
                    f"{name} = {value:g}: must be at most {WEAR_COEFFICIENT_LIMIT:g} [mm^2/N]; 1e-12 is usual for a "
                    "well lubricated gear"
                )
        for name, unit, most in (
            ("revolutions", "1", REVOLUTIONS_LIMIT),
            ("largest_step", "um", WEAR_DEPTH_LIMIT),
            ("largest_depth", "um", WEAR_DEPTH_LIMIT),
        ):
            value = getattr(self, name)
            if value is not None and positive(name, value, unit) > most:
                words = "" if unit == "1" else f" [{unit}]"
                raise InputError(f"{name} = {value:g}: must be at most {most:g}{words}")
        whole("most_steps", self.most_steps, 1)

    def steps(self, fastest: float) -> float:
        """Number of steps if the flanks went on wearing as they do now; a whole number, or infinite.

        Parameters
        ----------
        fastest
            Greatest depth per revolution of the pinion [mm].
        """
        depth = 1e3 * fastest * self.revolutions
        if self.largest_depth is not None:
            depth = min(depth, self.largest_depth)
        count = depth / self.largest_step
        return float(max(math.ceil(count * (1.0 - 1e-12)), 1)) if math.isfinite(count) else math.inf

    def require_few_steps(self, fastest: float, problems: int, seconds: float) -> None:
        """Refuse to take more steps than are allowed, and tell what they would cost.

        Parameters
        ----------
        fastest
            As of ``steps``.
        problems
            Contact problems of a step.
        seconds
            Time that a step takes [s].

        Raises
        ------
        InputError
            With the smallest step for which the steps allowed are enough.
        """
        count = self.steps(fastest)
        if count <= self.most_steps:
            return
        least = float(f"{self.largest_step * count / self.most_steps:.1e}") * 1.1 if math.isfinite(count) else math.inf
        raise InputError(
            f"largest_step = {self.largest_step:g}: would take about {count:.3g} steps, in each of which {problems} "
            f"contact problems are solved, {time_in_words(seconds * count)} in all: must be "
            + (f"{least:.2g} [um] or more" if least <= WEAR_DEPTH_LIMIT else "greater")
            + f" for {self.most_steps} steps; most_steps (--most-steps) allows more, largest_depth ends it earlier"
        )


def duty_cycle(torque: float | Mapping[float, float]) -> dict[float, float]:
    """Torques with their shares of the revolutions, all positive and in sum one, or else InputError."""
    given = torque if isinstance(torque, Mapping) else {number("torque", torque, "N m"): 1.0}
    shares = {number("torque", one, "N m"): number("share of a torque", share) for one, share in given.items()}
    total = sum(shares.values())
    usable = bool(shares) and all(v > 0.0 for pair in shares.items() for v in pair)
    wrong = [one for one in shares if usable and not TORQUE_MINIMUM <= one < TORQUE_LIMIT]
    if wrong:
        raise InputError(f"torque = {wrong[0]:g}: must be {torque_range()}")
    if not usable or abs(total - 1.0) > 1e-6:
        entries = ", ".join(f"{t:g}: {share:g}" for t, share in shares.items())
        raise InputError(
            f"torque = {{{entries}}}: must be a torque above 0 [N m], or several with their shares of the revolutions, "
            f"above 0; the shares add up to {total:g}, not 1"
        )
    return {t: share / total for t, share in shares.items()}


WEAR_NODES = (49, 33)  # of either flank
CONTACT_LOST, NOT_SOLVED = "contact lost", "contact not solved"  # how the reason of a stop before its time begins


@shows_progress("wear", "revolution")
def wear(
    case: Case | str | Path,
    law: WearLaw,
    *,
    torque: float | Mapping[float, float],
    flank: FlankName = "drive",
    misalignment: MisalignmentSource | None = None,
    deviations: Mapping[MemberName, Source] | None = None,
    interpolation: Method = "spline",
    solver: str = "auto",
    progress: Callable[[float], None] | bool | None = None,
    stage: Callable[[str], None] | None = None,
) -> xr.Dataset:
    """Wear of both flanks of a pair, at one torque or a duty cycle.

    The contact is that on lines alone, whatever the case says of edges: an edge sweeps no flank, so that Archard's law
    has no depth for it. Peak to peak and pressure can differ from those of ``analyze`` by what its edges carry.

    Parameters
    ----------
    case
        A checked case, or what ``read_case`` takes.
    law
        Coefficients, step and stop.
    torque
        Torque at the pinion [N m]; or several, with the share of the revolutions at each: ``{100.0: 0.7, 300.0: 0.3}``.
    flank, misalignment, deviations, interpolation, solver
        As in ``analyze``; deviations are those at the start. Where the misalignment depends on the torque, either flank
        wears in all assemblies of its torques.
    progress
        ``True`` for a line that shows it; or a function, called after every step with the pinion's revolutions.
    stage
        Called with the name of what takes long before it begins: each elastic tooth, then the wear.

    Returns
    -------
    xr.Dataset
        ``wear_depth`` and the flank's whole ``deviation`` (step, member, lengthwise, profile) on either member's own
        flank, the latter continued where nothing touches, to go on from. Over ``step``, 0 at the start: revolutions,
        largest depths, removed volume by Archard's law and by integral of the depth, peak to peak and greatest pressure
        of the loaded contact at every torque. Attribute ``stop`` says why it ended, and ``completed`` is 1 if as
        ``law`` has it. If the worn flanks have no line contact any more, or their contact could not be solved, it is 0,
        ``stop`` begins with "contact lost" or "contact not solved", and the history ends before that; it is 0, too,
        if the flanks wear so much faster than at the start that ``most_steps`` are not enough ("most_steps ...").
        Attribute ``edge_contact`` is 0. ``position`` (member, lengthwise, profile, xyz) [mm] is the
        designed flank: what ``flank_deviations`` knows a file of it by.

    Raises
    ------
    InputError
        If an argument is out of range, the wear would take more than ``most_steps`` of the law, or a step needs more
        memory than is free.
    GeometryError
        If the flanks do not meet, or the contact to begin with cannot be solved.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 4, "segments_per_line": 9, "lengthwise_nodes": 11, "profile_nodes": 9}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> worn = wear(case, WearLaw(1e-12, 1e-12, revolutions=1e5), torque=100.0)
    >>> worn.attrs["stop"]
    'all revolutions done'
    """
    instance("law", law, WearLaw)
    checked, shares = checked_case(case), duty_cycle(torque)
    AnalysisSize.of(checked, len(shares)).require_memory()
    pair = prepared_pair(checked, flank, misalignment)
    start = flank_deviations(pair, deviations, interpolation)
    unloaded = CaseInMesh.of(checked, flank=flank, misalignment=misalignment, stage=stage)
    designed = in_assembly_under_load(unloaded, list(shares))
    if stage is not None:
        stage("wear")
    begin, report = time.perf_counter(), callback(progress)
    run = _Run(designed, law, shares, solver, start)
    positions = len(shares) * checked.contact.mesh_positions
    law.require_few_steps(run.fastest, positions, time.perf_counter() - begin)
    history, completed = [run.state()], True
    while run.stop is None:
        if len(history) > law.most_steps:
            run.stop = f"most_steps = {law.most_steps} taken: the flanks wear faster than at the start"
            completed = False
            break
        try:
            run.step()
        except GeometryError as error:
            run.stop, completed = str(error), False
            break
        history.append(run.state())
        if report is not None:
            report(run.revolutions)
    result = xr.concat(history, "step", combine_attrs="override").assign_coords(step=np.arange(len(history)))
    result["revolution_share"] = ("torque", list(run.shares.values()))
    dimensions = ("member", "lengthwise", "profile", "xyz")
    result["position"] = (dimensions, np.stack([run.positions[name] for name in MEMBERS]))
    result = result.assign_coords(xyz=list("xyz"))
    origin = case_attributes(checked, "wear")
    of_pair = {"pinion_teeth": pair.assembly.pinion_teeth, "gear_teeth": pair.assembly.gear_teeth}
    result.attrs = {
        "stop": run.stop,
        "completed": int(completed),
        **{key: origin[key] for key in ("title", "case_name", "easeoff_version") if key in origin},
        "flank": flank,
        **{key: value for key, value in unloaded.attributes.items() if key.startswith("misalignment_")},
        "edge_contact": 0,
        **of_pair,
        **deflection_attributes(designed.misalignment, flank, list(shares)),
        **_attributes(law),
    }
    return labelled(result)


def _attributes(law: WearLaw) -> dict[str, float]:
    names = {"revolutions": "", "largest_step": "_um", "largest_depth": "_um", "most_steps": ""}
    return {f"{n}{names.get(n, '_mm2_per_N')}": float(v) for n, v in vars(law).items() if v is not None}


def _motion(geometry: PairGeometry) -> FlankSplines:
    """Sliding and speeds of the contact line over the flanks of a pair in one assembly."""
    motion = {name: value.reshape(geometry.nodes) for name, value in vars(rolling(geometry.exact)).items()}
    return rolling_splines(geometry.ease_off, motion)


class _Run:
    """A pair that wears; what the next step starts from."""

    def __init__(
        self, designed: CaseInMesh, law: WearLaw, shares: dict[float, float], solver: str, start: dict[str, Deviation]
    ) -> None:
        self.pair, self.law, self.shares, self.solver, self.start = designed.pair, law, shares, solver, start
        self.assemblies = [
            (places, assembly.cycle, _motion(assembly.cycle.geometry))
            for places, assembly in designed.assemblies(list(shares))
        ]
        self.peak_to_peak, self.max_pressure = np.empty((2, len(shares)))
        self.t, self.h = grid(WEAR_NODES)
        flanks = {name: named_member(self.pair, name).flank(self.t, self.h) for name in MEMBERS}
        self.positions = {n: np.moveaxis(f.position.reshape(3, *WEAR_NODES), 0, -1) for n, f in flanks.items()}
        self.depth = {name: np.zeros(WEAR_NODES) for name in MEMBERS}
        self.volume = dict.fromkeys(MEMBERS, 0.0)
        self.revolutions = 0.0
        self.stop: str | None = None
        self.touched: dict[str, Bools] = {}
        self._solve()

    def _deviation(self, name: str) -> Deviation:
        """The flank as it is now."""
        section = named_member(self.pair, name).section
        t, h = np.meshgrid(self.t, self.h, indexing="ij")
        start = self.start[name].at(t, h) if name in self.start else 0.0
        axial, radial = section.points(t, h)
        return Deviation(section, axial, radial, start - self.depth[name])

    def _solve(self) -> None:
        """The contact of the flanks as they are now, and what an engagement takes off them."""
        now = {name: self._deviation(name) for name in MEMBERS}
        parts: list[tuple[float, Engagement]] = []
        reached: list[Engagement] = []
        for places, designed, motion in self.assemblies:
            ease_off = deviated_ease_off(designed.geometry, pinion=now["pinion"], gear=now["gear"])
            engagements = self._engaged(designed.with_ease_off(ease_off), places, motion, now)
            parts += zip([list(self.shares.values())[place] for place in places], engagements, strict=True)
            reached.append(engagements[0])
        if not self.touched:
            self.touched = {
                name: np.any([touched(once, name, self.t, self.h) for once in reached], axis=0) for name in MEMBERS
            }
        # A tooth of the gear meets the pinion once in a revolution of the gear.
        per_revolution = {
            "pinion": self.law.pinion_coefficient,
            "gear": self.law.gear_coefficient / self.pair.assembly.ratio,
        }
        self.rate: dict[str, Array] = {}
        self.volume_rate: dict[str, float] = {}
        for name, k in per_revolution.items():
            self.rate[name] = k * np.sum([s * on_flank(once, name, self.t, self.h) for s, once in parts], axis=0)
            self.volume_rate[name] = k * sum(s * once.work for s, once in parts)

    def _engaged(
        self, cycle: MeshCycle, places: tuple[int, ...], motion: FlankSplines, now: Mapping[str, Deviation]
    ) -> list[Engagement]:
        """Engagements of the flanks as they are now, in one assembly, at the torques of these numbers."""
        lost = cycle.lost_contact
        if self.revolutions == 0.0:  # what was measured or left from elsewhere, not worn here
            require_line_contact(lost, now)
        elif lost > LOST_CONTACT_LIMIT:
            raise GeometryError(
                f"{CONTACT_LOST}: at {100 * lost:.1f} % of the points of the contact lines the worn flanks bend over "
                "too short a way for a line contact"
            )
        torques = np.array(list(self.shares))[list(places)]
        loaded, _ = cycle.loaded(torques, edge_contact=False, solver=self.solver)
        bad = int(np.count_nonzero(loaded["status"].values != Status.CERTIFIED))
        if bad and self.revolutions > 0.0:
            raise GeometryError(f"{NOT_SOLVED}: {bad} of {loaded['status'].size} mesh positions of the worn flanks")
        self.peak_to_peak[list(places)] = loaded["peak_to_peak"].values
        self.max_pressure[list(places)] = loaded["max_pressure"].values
        known = loaded, motion, cycle.pinion_pitch, cycle.segments_per_line
        return [engagement(*known, torque) for torque in range(torques.size)]

    @property
    def fastest(self) -> float:
        """Greatest depth per revolution of the pinion [mm]."""
        return max(float(np.max(rate[self.touched[n]])) for n, rate in self.rate.items())

    def step(self) -> None:
        """Wear by as many revolutions as the step control allows."""
        law, fastest = self.law, self.fastest
        if fastest == 0.0:
            self.stop = "nothing wears"
            return
        revolutions = min(1e-3 * law.largest_step / fastest, law.revolutions - self.revolutions)
        if law.largest_depth is not None:
            left = min(self._until(1e-3 * law.largest_depth, name) for name in MEMBERS)
            if left <= revolutions:
                revolutions, self.stop = left, "largest depth reached"
        for name in MEMBERS:
            self.depth[name] = self.depth[name] + revolutions * self.rate[name]
            self.volume[name] += revolutions * self.volume_rate[name]
        self.revolutions += revolutions
        if self.stop is None and self.revolutions >= law.revolutions * (1.0 - 1e-12):
            self.stop = "all revolutions done"
        self._solve()

    def _until(self, depth: float, name: str) -> float:
        """Revolutions until a flank is as deep as this [mm], at the present rate."""
        where = self.touched[name] & (self.rate[name] > 0.0)
        left = (depth - self.depth[name][where]) / self.rate[name][where]
        return max(float(np.min(left, initial=np.inf)), 0.0)

    def state(self) -> xr.Dataset:
        """State of the wear."""
        dimensions = ("member", "lengthwise", "profile")
        # Beyond the contact lines the depth is continued for the sake of the splines; nothing wears there.
        depth = {name: np.where(self.touched[name], self.depth[name], 0.0) for name in MEMBERS}
        integrals = [integral(depth[n], self.positions[n], self.t, self.h) for n in MEMBERS]
        return xr.Dataset(
            {
                "wear_depth": (dimensions, 1e3 * np.stack([depth[n] for n in MEMBERS])),
                "deviation": (dimensions, 1e3 * np.stack([self._deviation(n).value for n in MEMBERS])),
                "revolutions": ((), self.revolutions),
                "largest_depth": ("member", [1e3 * float(depth[n].max()) for n in MEMBERS]),
                "removed_volume": ("member", [self.volume[n] for n in MEMBERS]),
                "depth_integral": ("member", integrals),
                "peak_to_peak": ("torque", self.peak_to_peak.copy()),
                "max_pressure": ("torque", self.max_pressure.copy()),
            },
            coords={"member": list(MEMBERS), "torque": list(self.shares), "lengthwise": self.t, "profile": self.h},
        )
