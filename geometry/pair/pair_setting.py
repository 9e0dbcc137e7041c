"""What can be set or go wrong of a pair, one number at a time: settings, assembly errors, deviations of the flanks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, get_args

from ...core.checks import one_of
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import MODIFIED_ROLL_ORDERS, MOTION_PATTERN, get_setting, scale_of, with_settings
from .gear_pair import GearPair
from .modification import TERM_POWERS

#: Usual steps of the assembly errors, by their names in ``Misalignment`` [mm or rad].
ERROR_STEPS = {"offset": 0.3, "pinion_axial": 0.3, "gear_axial": 0.3, "shaft_angle": 0.003}


Origin = Literal["pinion", "gear", "assembly", "modification"]


@dataclass(frozen=True)
class PairSetting:
    """One number of a pair that can change.

    Parameters
    ----------
    of
        ``pinion`` or ``gear``: a setting of the loaded flank; ``assembly``: an assembly error; ``modification``: a term
        added to the ease-off, as a deviation of either flank.
    name
        Of the setting, see ``cutting.named_settings``; of the error, see ``Misalignment``; of the term, see
        ``Modification``.

    Raises
    ------
    InputError
        If there is no such setting.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> setting = PairSetting("pinion", "radial_distance")
    >>> round(setting.value(setting.moved(pair, 0.5)) - setting.value(pair), 12)
    0.5
    """

    of: Origin
    name: str

    def __post_init__(self) -> None:
        one_of("of", self.of, get_args(Origin))
        if self.of == "assembly":
            one_of("assembly error", self.name, ERROR_STEPS)
        elif self.of == "modification":
            one_of("modification term", self.name, TERM_POWERS)
        else:
            scale_of(self.name)

    @property
    def scale(self) -> float:
        """Usual step [mm, rad or per radian; um of a modification]."""
        if self.of == "modification":
            return 1.0
        return ERROR_STEPS[self.name] if self.of == "assembly" else scale_of(self.name)

    def value(self, pair: GearPair) -> float:
        """The number [mm, rad or per radian], of the pair itself."""
        if self.of == "assembly":
            return float(getattr(pair.assembly.misalignment, self.name))
        return get_setting(_designed(pair, self.of), self.name)

    def moved(self, pair: GearPair, step: float) -> GearPair:
        """The pair with the number greater by a step."""
        value = self.value(pair) + step
        if self.of == "assembly":
            return pair.misaligned(replace(pair.assembly.misalignment, **{self.name: value}))
        member = pair.pinion if self.of == "pinion" else pair.gear
        changed = replace(member, loaded=with_settings(member.loaded, {self.name: value}))
        return replace(pair, pinion=changed) if self.of == "pinion" else replace(pair, gear=changed)

    def acts_on(self, pair: GearPair) -> bool:
        """Whether the pair has it: a Formate flank has no roll and no motions, a face-milled one no rake and hook."""
        if self.of not in ("pinion", "gear"):
            return True
        surface = _designed(pair, self.of)
        rolling = (
            self.name == "ratio_of_roll" or self.name in MODIFIED_ROLL_ORDERS or MOTION_PATTERN.fullmatch(self.name)
        )
        if rolling and not surface.settings.generated:
            return False
        return not (self.name in ("rake_angle", "hook_angle") and surface.settings.indexing_ratio == 0.0)


def _designed(pair: GearPair, of: str) -> GeneratingSurface:
    return (pair.pinion if of == "pinion" else pair.gear).loaded.designed


def is_angle(setting: PairSetting) -> bool:
    """Whether the number is an angle, or the derivative of one by the cradle increment [rad]."""
    base = setting.name.rsplit("_motion_", 1)[0]
    return base.endswith(("_angle", "cutter_tilt", "cutter_swivel"))
