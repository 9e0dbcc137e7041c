"""Derivative of the gap at fixed points of the gear flank: the normal motion of the flanks, in closed form.

Where a setting moves a flank along its normal, the gap closes or opens by as much; over the moment of the normal about
the gear axis that is a gear angle. By the envelope theorem it is the derivative of the ease-off as well, where the
pinion's rotation is that of conjugate contact, and of the unloaded transmission error, where the point is that of the
smallest gap: to first order neither moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cutting.generating_surface import GeneratingSurface
from ..flanks.flank import Flank
from ..flanks.flank_parts import on_parts
from ..vectors import dot
from .field_slopes import STEP_SHARE
from .gear_pair import GearPair, PairGeometry
from .near_pair import KnownPair, at_places, rate
from .pair_setting import PairSetting

Array = NDArray[Any]


def pinion_gap_slopes(
    geometry: PairGeometry,
    settings: Sequence[PairSetting],
    pinion_parameters: Array,
    pinion_part: NDArray[np.int8],
    rotation: Array,
) -> Array:
    """Derivatives of the gap of the flanks by how the pinion stands to the gear, as a gear rotation (n, j) [rad].

    Parameters
    ----------
    geometry
        The pair.
    settings
        By what to differentiate (j): zero for settings of the gear, and for a modification.
    pinion_parameters, pinion_part
        Pinion points (2, n), on parts of the pinion flank (n).
    rotation
        Of the pinion (n) [rad], counted as the roll angle; its zero follows the pinion's mean point.

    Examples
    --------
    At the nodes, in conjugate contact, that is the derivative of the ease-off but for its zero:

    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> from easeoff.geometry.pair.field_slopes import field_slopes
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> by_roll, exact = [PairSetting("pinion", "ratio_of_roll")], geometry.exact
    >>> closed = pinion_gap_slopes(geometry, by_roll, exact.pinion_parameters, exact.part, exact.roll_angle).ravel()
    >>> full = field_slopes(geometry, by_roll)["ease_off_angle"].ravel()
    >>> bool(np.ptp(closed - full) < 1e-8 * np.ptp(full))
    True
    """
    known = KnownPair(geometry)
    slopes = np.zeros((*rotation.shape, len(settings)))
    for number, setting in enumerate(settings):
        if setting.of not in ("modification", "gear"):
            step = STEP_SHARE * setting.scale
            pairs = at_places(setting, geometry.pair, step)
            slopes[..., number] = _of_pinion(known, pairs, step, pinion_parameters, pinion_part, rotation)
    return slopes


def gear_gap_slopes(geometry: PairGeometry, settings: Sequence[PairSetting], gear: Flank) -> Array:
    """Derivatives of the gap of the flanks by what moves the gear's, as a gear rotation (n, j) [rad].

    Parameters
    ----------
    geometry
        The pair.
    settings
        By what to differentiate (j): zero for all but those of the gear.
    gear
        Points of the gear flank (n).

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> settings = [PairSetting("gear", "radial_distance"), PairSetting("pinion", "radial_distance")]
    >>> np.any(gear_gap_slopes(geometry, settings, geometry.members.gear), axis=0)
    array([ True, False])
    """
    known = KnownPair(geometry)
    slopes = np.zeros((gear.part.size, len(settings)))
    for number, setting in enumerate(settings):
        if setting.of == "gear":
            step = STEP_SHARE * setting.scale
            pairs = at_places(setting, geometry.pair, step)
            slopes[:, number] = _of_gear(known, pairs, step, gear)
    return slopes


def held_point_slopes(
    geometry: PairGeometry,
    settings: Sequence[PairSetting],
    pinion_parameters: Array,
    pinion_part: NDArray[np.int8],
    rotation: Array,
) -> tuple[Array, Array]:
    """Derivatives of where pinion points of held parameters (n) stand.

    Parameters
    ----------
    geometry, settings, pinion_parameters, pinion_part, rotation
        As of ``pinion_gap_slopes``.

    Returns
    -------
    tuple
        Derivatives of axial and radial coordinate along the gear axis (2, n, j) [mm], and of lengthwise and profile
        fraction on the pinion (2, n, j).
    """
    known = KnownPair(geometry)
    section = geometry.exact.pinion_section
    found = np.zeros((4, *rotation.shape, len(settings)))

    def stand(pair: GearPair) -> Array:
        there = known.motion(pair)

        def both(surface: GeneratingSurface, p: Array) -> Array:
            return np.concatenate(surface.evaluate(p)[:2])

        own = on_parts(pair.pinion.loaded.flank_parts, pinion_part, pinion_parameters, both)
        position, _ = there.turned(*pair.assembly.pinion_to_global(own[:3], own[3:]), rotation + there.center)
        x, y, z = position - pair.assembly.gear_origin.reshape(3, 1)
        fractions = section.fractions(own[2], np.hypot(own[0], own[1]))
        return np.stack([z, np.hypot(x, y), *fractions])

    for number, setting in enumerate(settings):
        if setting.of not in ("modification", "gear"):
            step = STEP_SHARE * setting.scale
            pairs = at_places(setting, geometry.pair, step)
            found[..., number] = rate([stand(pair) for pair in pairs], step)
    return found[:2], found[2:]


def _of_gear(known: KnownPair, pairs: Sequence[GearPair], step: float, gear: Flank) -> Array:
    moved = rate([_positions(pair.gear.loaded, gear.part, gear.parameters) for pair in pairs], step)
    moment = gear.position[0] * gear.normal[1] - gear.position[1] * gear.normal[0]
    return np.asarray(-known.exact.motion.pinion_sense * dot(moved, gear.normal) / moment)


def _of_pinion(
    known: KnownPair, pairs: Sequence[GearPair], step: float, parameters: Array, part: NDArray[np.int8], rotation: Array
) -> Array:
    motion = known.exact.motion

    def from_gear(pair: GearPair) -> tuple[Array, Array, float]:
        """Points seen from the gear, which an error may move along its axis, their normals, and the zero's rotation."""
        there = known.motion(pair)

        def both(surface: GeneratingSurface, p: Array) -> Array:
            return np.concatenate(surface.evaluate(p)[:2])

        own = on_parts(pair.pinion.loaded.flank_parts, part, parameters, both)
        turned = there.turned(*pair.assembly.pinion_to_global(own[:3], own[3:]), rotation + there.center)
        return turned[0] - pair.assembly.gear_origin.reshape(3, 1), turned[1], there.center

    position, normal, _ = from_gear(known.geometry.pair)
    places, _, centers = zip(*(from_gear(pair) for pair in pairs), strict=True)
    moment = position[0] * normal[1] - position[1] * normal[0]
    turned = rate([np.asarray(center) for center in centers], step) / motion.assembly.ratio
    return np.asarray(motion.pinion_sense * dot(rate(places, step), normal) / moment + turned)


def _positions(surface: GeneratingSurface, part: NDArray[np.int8], parameters: Array) -> Array:
    return on_parts(surface.flank_parts, part, parameters, lambda own, p: own.evaluate(p)[0])
