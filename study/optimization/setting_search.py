"""Search for settings with elastic teeth that follow them, and the settings rounded at its end.

Teeth are held within a search and built anew at its end; if that changes what was found, a further search begins there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...cases.schema.case_schema import Case
from ...core.errors import EaseoffError, GeometryError
from ..case_in_mesh import CaseInMesh
from .aim import Judgement
from .analysed_settings import AnalysedSettings, Readings, Workshop, in_units
from .ease_off_form import EaseOffForm
from .step_programme import LocalModel, StepAnswer, StepProgramme
from .trust_region import FIRST_RADIUS, GAIN_TOLERANCE, Step, search

Array = NDArray[np.float64]

#: The most searches, each with teeth built anew.
ROUND_LIMIT = 3
#: A later search begins with at least this trust region [um].
LATER_RADIUS = 0.5


@dataclass(frozen=True, eq=False)
class Outcome:
    """What a search found.

    Parameters
    ----------
    values
        Settings found (n), in the units of the case file.
    rounded
        The same as they are set on the machine.
    case
        The case with these.
    point
        Its analyses, with its own teeth.
    steps
        All programmes, with the number of the search.
    converged
        Whether the last programme had nothing left to gain.
    last
        Answer of the last programme.
    """

    values: Array
    rounded: Array
    case: Case
    point: AnalysedSettings
    steps: tuple[tuple[int, Step], ...]
    converged: bool
    last: StepAnswer


class SettingSearch:
    """Searches of one case for several aims; programmes of one shape are compiled once.

    Parameters
    ----------
    workshop
        That analysed the start.
    start
        Analyses of the start.
    steps
        The most programmes for one aim.
    progress
        Called after every programme.
    stage
        Called with the name of what takes long.
    """

    def __init__(
        self,
        workshop: Workshop,
        start: Readings,
        *,
        steps: int,
        progress: Callable[[], None] | None = None,
        stage: Callable[[str], None] | None = None,
    ) -> None:
        self._workshop, self._start, self._steps = workshop, start, steps
        self._progress, self._stage = progress, stage
        self._programmes: dict[str, StepProgramme] = {}

    def begun(self, judgement: Judgement) -> AnalysedSettings:
        """The start under a judgement."""
        origin = self._workshop.space.start
        return AnalysedSettings(origin, np.zeros(origin.size), self._start, self._start, judgement, self._workshop)

    def anew(self, case: Case, values: Array, judgement: Judgement) -> AnalysedSettings:
        """Settings (n) of a case, analysed with their own teeth. Raises as ``contact_derivatives``."""
        states = {flank: CaseInMesh.of(case, flank=flank, stage=self._stage) for flank in self._workshop.states}
        if self._stage is not None:
            self._stage("search")
        workshop = self._workshop.with_teeth(states)
        changes = (values - workshop.space.start) / workshop.units
        return AnalysedSettings(values, changes, workshop.readings(case), self._start, judgement, workshop)

    def settled(self, judgement: Judgement, values: Array | None = None, *, steps: int | None = None) -> Outcome:
        """The best settings for a judgement, from the start or from other values (n), in at most so many programmes.

        Raises
        ------
        GeometryError
            If the settings found, rounded, have no certified analysis.
        """
        space, most = self._workshop.space, self._steps if steps is None else steps
        here = self.begun(judgement) if values is None else self.anew(space.case_at(values), values, judgement)
        done: list[tuple[int, Step]] = []
        radius = FIRST_RADIUS
        for number in range(ROUND_LIMIT):
            found = search(
                here,
                partial(self._programme, judgement),
                steps=most - len(done),
                radius=radius,
                progress=self._progress,
            )
            done += [(number, step) for step in found.steps]
            best: AnalysedSettings = found.point
            if best is here:
                break
            here = self.anew(space.case_at(best.values), best.values, judgement)
            if here.merit.total - best.merit.total <= GAIN_TOLERANCE or len(done) >= most:
                break
            radius = max(found.radius, LATER_RADIUS)
        case = space.case_at(here.values, rounded=True)
        rounded = space.values_of(case)
        try:
            point = self.anew(case, rounded, judgement)
        except EaseoffError as error:
            raise GeometryError(f"the settings found, rounded, cannot be analysed: {error}") from error
        return Outcome(here.values, rounded, case, point, tuple(done), found.converged, found.last)

    def _programme(self, judgement: Judgement, model: LocalModel) -> StepProgramme:
        weights = judgement.weights
        key = repr((model.shape, weights.tolist(), judgement.aim.form))
        if key not in self._programmes:
            self._programmes[key] = StepProgramme(model, weights, judgement.aim.form)
        return self._programmes[key]


def first_workshop(workshop: Workshop) -> tuple[Workshop, Readings]:
    """The workshop with units in which every setting changes the ease-off by one micrometre at most, and the start."""
    readings = workshop.readings(workshop.space.case)
    reach = np.max([np.abs(EaseOffForm.of(one).slopes).max(axis=0) for one in readings.values()], axis=0)
    units = 1.0 / np.maximum(reach, 1e-12)
    return replace(workshop, units=units), {key: in_units(one, units) for key, one in readings.items()}
