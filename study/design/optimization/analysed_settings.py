"""Analysed settings: the contact on every side and in every assembly, with derivatives by the free settings.

The assemblies are the case's own, given ones, and samples of distributed errors. The distance of the blades' tips from
the root cones, at toe, middle and heel, has derivatives, too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
import xarray as xr

from ....cases.schema.case_schema import Case
from ....core.arrays import RealArray as Array
from ....core.attributes import ordered
from ....core.errors import EaseoffError, GeometryError
from ....geometry.design.synthesis import RootLine
from ....geometry.pair.assembly import Misalignment
from ....geometry.pair.gear_pair import FlankName, GearPair, Member
from ....geometry.pair.near_pair import PairSetting, is_angle
from ....geometry.tooth.tooth_surface import tooth_surface
from ...analysis.setting_derivatives import SIDES, SolvedContact
from ...case_in_mesh import CaseInMesh, prepared_pair
from .aim import ContactQuantity, EaseOffForm, Judgement, Load, Reading
from .free_setting import SettingSpace, pair_setting
from .step_programme import Composite, LocalModel
from .trust_region import Merit

#: Change of the root line that a search may make unless told otherwise, over the height of the flank.
USUAL_CHANGE_RATIO = 0.01
DIMENSIONS = ("member", "root_place")
MEMBERS, PLACES = ["pinion", "gear"], ["toe", "middle", "heel"]
#: Weight of the distances in a correction [um/mm]: a tenth of that of the ease-off.
TIP_WEIGHT = 100.0


def blade_tip_gaps(pair: GearPair) -> xr.DataArray:
    """Distances (member, root_place) of blade tips above root cones [mm]; negative below, NaN beyond the flank."""
    flanks = [(member.loaded.designed, member.section) for member in _both(pair)]
    gaps = [RootLine.of(surface, section).gap(surface)[0] for surface, section in flanks]
    return xr.DataArray(gaps, {"member": MEMBERS, "root_place": PLACES}, DIMENSIONS)


def blade_tip_slopes(pair: GearPair, settings: Sequence[tuple[str, PairSetting]]) -> xr.DataArray:
    """Derivatives (member, root_place, setting) of the distances by machine and cutter settings, per mm or degree."""
    change = np.zeros((len(MEMBERS), len(PLACES), len(settings)))
    for row, (name, member) in enumerate(zip(MEMBERS, _both(pair), strict=True)):
        surface = member.loaded.designed
        _, line = RootLine.of(surface, member.section).gap(surface)
        for column, (_, setting) in enumerate(settings):
            if setting.of == name:
                step = setting.scale
                behind, ahead = (_both(setting.moved(pair, sign * step))[row].loaded.designed for sign in (-1.0, 1.0))
                factor = math.radians(1.0) if is_angle(setting) else 1.0
                change[row, :, column] = factor * line.change(surface, behind, ahead) / (2.0 * step)
    over = {"member": MEMBERS, "root_place": PLACES, "setting": [name for name, _ in settings]}
    return xr.DataArray(change, over, (*DIMENSIONS, "setting"))


def _both(pair: GearPair) -> tuple[Member, Member]:
    return pair.pinion, pair.gear


@dataclass(frozen=True, eq=False)
class BladeTips:
    """Distances of blade tips (p) from the root cones, with derivatives by the settings (n), times ``TIP_WEIGHT``."""

    value: Array
    slopes: Array

    @classmethod
    def of(cls, reading: Reading) -> BladeTips:
        """Those of an analysis."""
        value = ordered(reading.values, "blade_tip_gap", *DIMENSIONS).ravel()
        slopes = ordered(reading.slopes, "blade_tip_gap", *DIMENSIONS, "setting").reshape(value.size, -1)
        return cls(TIP_WEIGHT * value, TIP_WEIGHT * slopes)

    def missed(self, pair: GearPair, step: Array) -> Array:
        """Distances after a step (n), to first order, less those of another pair (p); zero where either is unknown.

        GeometryError if a cutter meets no tooth.
        """
        distances = TIP_WEIGHT * ordered(blade_tip_gaps(pair).to_dataset(name="gap"), "gap", *DIMENSIONS).ravel()
        return np.nan_to_num(self.value + self.slopes @ step - distances)


def usual_root_line_change(pairs: Sequence[GearPair]) -> float:
    """Limit of the change of the root line [mm]: a share of the lower flank's height in its middle."""
    middles, ends = np.array([0.5, 0.5]), np.array([0.0, 1.0])
    lines = [member.section.points(middles, ends) for pair in pairs for member in _both(pair)]
    return USUAL_CHANGE_RATIO * min(math.hypot(z[1] - z[0], radius[1] - radius[0]) for z, radius in lines)


Readings = Mapping[tuple[FlankName, int], Reading]

#: Corrections of a step, and the least effect of a combination of settings, over the greatest, that takes part.
CORRECTION_COUNT, CORRECTED_PART = 2, 0.02
#: Change of a setting to either side for derivatives by differences, by its effect on the ease-off [um].
DIFFERENCE_REACH = 0.5
#: Nodes lengthwise, and up flank and fillet, on which a tooth must be whole.
TOOTH_NODES = (9, 5)


@dataclass(eq=False)
class Effort:
    """Cost of a search so far."""

    analyses: int = 0
    differentiated: int = 0
    teeth: int = 0


@dataclass(eq=False)
class Workshop:
    """Analyses of settings: the teeth are those of one case and held, the flanks are cut anew."""

    space: SettingSpace
    torques: tuple[float, ...]
    assemblies: tuple[Misalignment, ...]  # the first is the case's own
    states: Mapping[FlankName, CaseInMesh]
    units: Array  # change of each setting (n) that changes the ease-off by one micrometre at most
    unloaded: bool = True
    effort: Effort = field(default_factory=Effort)  # copies share it

    def readings(self, case: Case) -> dict[tuple[FlankName, int], Reading]:
        """Analyses of a case with held teeth. Raises as ``SolvedContact.of``."""
        readings: dict[tuple[FlankName, int], Reading] = {}
        for flank, kept_state in self.states.items():
            state = kept_state.recut(case)
            for number, misalignment in enumerate(self.assemblies):
                solved = self._solved(state, misalignment)
                ways = partial(self._differentiated, solved), partial(self.differences, solved)
                readings[flank, number] = Reading(solved, self._values(solved), *ways)
        return readings

    def require_whole_teeth(self, case: Case) -> None:
        """Refuse a case whose teeth could not be built. Raises GeometryError, as where they are undercut or pointed."""
        cut = {"pinion", *(key.partition(".")[0] for one in self.space.free for key in one.moves)}
        for flank in self.states:
            pair = prepared_pair(case, flank, self.assemblies[0])
            for member in sorted(cut):
                tooth_surface(pair, member, TOOTH_NODES, TOOTH_NODES[1])

    def with_teeth(self, case: Case, stage: Callable[[str], None] | None = None) -> Workshop:
        """The same with the teeth of a case; the effort is shared. Raises as ``CaseInMesh.of``."""
        states = {flank: CaseInMesh.of(case, flank=flank, stage=stage) for flank in self.states}
        self.effort.teeth += len(states)
        return replace(self, states=states)

    def _solved(self, state: CaseInMesh, misalignment: Misalignment) -> SolvedContact:
        at_home = misalignment == state.pair.assembly.misalignment
        solved = SolvedContact.of(state if at_home else state.misaligned(misalignment), list(self.torques))
        self.effort.analyses += 1
        return solved

    def _values(self, solved: SolvedContact) -> xr.Dataset:
        return solved.values(unloaded=self.unloaded).assign(blade_tip_gap=blade_tip_gaps(solved.state.pair))

    def differences(self, solved: SolvedContact) -> xr.Dataset:
        """Derivatives by the free settings, each moved a little to both sides; to one where the other has no analysis.

        Segments of several analyses are not the same: their quantities count with the greatest of a mesh position.
        GeometryError if neither side has an analysis.
        """
        state = solved.state
        settings, values = self.space.values_of(state.case), self._values(solved)
        columns: dict[str, list[Array]] = {str(name): [] for name in values.data_vars}
        for row, (one, unit) in enumerate(zip(self.space.free, self.units, strict=True)):
            ends, refusal = {0.0: values}, ""
            for side in (-DIFFERENCE_REACH, DIFFERENCE_REACH) if any(_acts(k, state.flank) for k in one.moves) else ():
                there = settings.copy()
                there[row] += side * unit
                try:
                    moved = self.states[state.flank].recut(self.space.case_at(there))
                    ends[side] = self._values(self._solved(moved, state.pair.assembly.misalignment))
                except EaseoffError as error:
                    refusal = str(error)
            low, high = min(ends), max(ends)
            if low == high and refusal:
                raise GeometryError(f"{one.name}: must have an analysis to one side at least: {refusal}")
            for name, column in columns.items():
                first, last = (_peaks(ends[side][name]) for side in (low, high))
                column.append(np.broadcast_to((last - first) / (high - low or 1.0), values[name].shape))
        data = {name: ((*values[name].dims, "setting"), np.stack(column, -1)) for name, column in columns.items()}
        return xr.Dataset(data).fillna(0.0)

    def _differentiated(self, solved: SolvedContact) -> xr.Dataset:
        """Derivatives by the free settings."""
        flank = solved.state.flank
        keys = sorted({key for one in self.space.free for key in one.moves if _acts(key, flank)})
        _, by_key = solved.differentiated(keys or ["E"], unloaded=self.unloaded)
        self.effort.differentiated += 1
        by_key["blade_tip_gap"] = blade_tip_slopes(solved.state.pair, [(key, pair_setting(key)) for key in keys])
        columns = np.zeros((len(self.space.free), by_key.sizes["setting"]))
        names = by_key["setting"].values.tolist()
        for row, (one, unit) in enumerate(zip(self.space.free, self.units, strict=True)):
            for key, factor in one.moves.items():
                if key in names:
                    columns[row, names.index(key)] += factor * unit
        return _times(by_key, columns)


def in_units(reading: Reading, workshop: Workshop, units: Array) -> Reading:
    """A reading with derivatives by the settings of a workshop in other units, so much (n) of the present ones each."""
    exact = reading.exact
    scaled = None if exact is None else lambda: _times(exact, np.diag(units))
    return replace(reading, differentiated=scaled, differences=partial(workshop.differences, reading.solved))


def _peaks(values: xr.DataArray) -> Array:
    """Values, of segments the greatest, in an array that broadcasts to them."""
    if "segment" not in values.dims:
        return np.asarray(values.values)
    known = values.fillna(-np.inf).max("segment")
    peaks = known.where(np.isfinite(known)).expand_dims("segment").transpose(*values.dims)
    return np.asarray(peaks.values)


def _acts(key: str, flank: FlankName) -> bool:
    member, side, *_ = key.split(".")
    return SIDES[flank][member] == side


def _times(slopes: xr.Dataset, columns: Array) -> xr.Dataset:
    """Derivatives by the free settings from those by keys."""
    last = {name: variable.transpose(..., "setting") for name, variable in slopes.data_vars.items()}
    return xr.Dataset({name: (one.dims, np.nan_to_num(one.values) @ columns.T) for name, one in last.items()})


@dataclass(frozen=True, eq=False)
class AnalysedSettings:
    """Settings with their analyses, a ``Point`` of the search."""

    values: Array  # (n) in the units of the case file
    settings: Array  # (n) their changes from the start, in micrometres of ease-off
    readings: Readings
    start: Readings
    judgement: Judgement
    workshop: Workshop

    def read(self, quantity: ContactQuantity, load: Load) -> Composite:
        """Value of a quantity at a load."""
        key = load.flank, load.assembly
        return quantity.composite(self.readings[key].values, None, load.torque, self.start[key].values)

    def _modelled(self, radius: float, quantity: ContactQuantity, load: Load) -> Composite:
        """A quantity at a load as the settings change it."""
        key = load.flank, load.assembly
        reading = self.readings[key]
        return quantity.composite(reading.values, reading.slopes, load.torque, self.start[key].values, radius)

    @cached_property
    def merit(self) -> Merit:
        """Objective and violation that they reach."""
        return self.judgement.merit(self.read)

    def judged_by(self, judgement: Judgement) -> AnalysedSettings:
        """The same analyses under another judgement."""
        return replace(self, judgement=judgement)

    @cached_property
    def forms(self) -> dict[FlankName, EaseOffForm]:
        """Ease-off in the case's own assembly by side."""
        return {flank: EaseOffForm.of(self.readings[flank, 0]) for flank in self.workshop.states}

    def ease_off_change(self, case: Case) -> float:
        """Greatest change of the ease-off to that of another case, a rotation left out [um]."""
        pairs = {flank: prepared_pair(case, flank, self.workshop.assemblies[0]) for flank in self.forms}
        changes = [form.missed(pairs[flank], 0.0 * self.settings) for flank, form in self.forms.items()]
        return float(np.max(np.abs(np.concatenate(changes))))

    def moved(self, step: Array) -> AnalysedSettings:
        """Other settings (n), analysed, with the ease-off of a step to first order; EaseoffError without analysis."""
        workshop = self.workshop
        settings = self.settings + step
        for _ in range(CORRECTION_COUNT):
            case = workshop.space.case_at(self._values(settings))
            settings = np.clip(settings + self._correction(case, step), *self._room(workshop.space.start))
        values = self._values(settings)
        case = workshop.space.case_at(values)
        workshop.require_whole_teeth(case)
        return replace(self, values=values, settings=settings, readings=workshop.readings(case))

    def by_differences(self) -> AnalysedSettings | None:
        """The same with derivatives by differences of analyses alone; ``None`` if it has no others."""
        if all(one.exact is None for one in self.readings.values()):
            return None
        readings = {k: r if r.exact is None else replace(r, differentiated=None) for k, r in self.readings.items()}
        return replace(self, readings=readings)

    def _values(self, settings: Array) -> Array:
        return np.asarray(self.workshop.space.start + self.workshop.units * settings)

    def _room(self, values: Array) -> tuple[Array, Array]:
        """Least and greatest change (n) of values (n) within the limits, in units of the settings."""
        free, units = self.workshop.space.free, self.workshop.units
        low, high = (np.array([getattr(one, end) for one in free]) for end in ("low", "high"))
        return (low - values) / units, (high - values) / units

    def _correction(self, case: Case, step: Array) -> Array:
        """Change of the settings (n) that takes ease-off and root line of a case to those that a step promises."""
        left, slopes = [], []
        for flank, form in self.forms.items():
            tips = BladeTips.of(self.readings[flank, 0])
            pair = prepared_pair(case, flank, self.workshop.assemblies[0])
            left += [form.missed(pair, step), tips.missed(pair, step)]
            slopes += [form.slopes, tips.slopes]
        return np.asarray(np.linalg.lstsq(np.concatenate(slopes), np.concatenate(left), rcond=CORRECTED_PART)[0])

    @cached_property
    def differentiable(self) -> bool:
        """True if there is a model."""
        try:
            return all(reading.slopes.sizes for reading in self.readings.values())
        except EaseoffError:
            return False

    def model(self, radius: float) -> LocalModel:
        """Model near them, within a trust region [um]."""
        ratios, limits = self.judgement.composites(partial(self._modelled, radius))
        reach = np.concatenate([form.slopes for form in self.forms.values()])
        rounding = 0.5 * self.workshop.space.steps / self.workshop.units
        return LocalModel(ratios, limits, reach, *self._room(self.values), rounding)
