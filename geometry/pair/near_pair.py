"""Flanks and ease-off of a pair near one whose solution is known: no search for the tooth, the same flank parts."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cutting.generating_surface import GeneratingSurface
from ..cutting.surface_points import SurfacePoints, axial_and_radial, points_at
from ..flanks.flank import Flank
from ..flanks.flank_parts import on_parts, pick
from .ease_off import EaseOff, classified, conjugate_motion
from .gear_pair import GearPair, PairGeometry

Array = NDArray[Any]


@dataclass(frozen=True)
class NearPair:
    """A pair's flanks at the nodes of the gear flank.

    Parameters
    ----------
    pair
        The pair.
    gear
        Gear flank at the nodes (n).
    exact
        Ease-off there; its ``status`` and ``part``, and whose ``blade_distance`` it has, are those of the pair it began
        with.
    pinion_ends
        Where the pinion's blade ends nearer to the conjugate point than the gear's to the node (n).

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import Misalignment, pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> known = NearPair.of(geometry)
    >>> moved = known.at(geometry.pair.misaligned(Misalignment(offset=0.01)))
    >>> anew = geometry.misaligned(Misalignment(offset=0.01)).exact
    >>> bool(np.allclose(moved.exact.angle, anew.angle, rtol=0.0, atol=1e-12))
    True
    """

    pair: GearPair
    gear: Flank
    exact: EaseOff
    pinion_ends: NDArray[np.bool_]

    @classmethod
    def of(cls, geometry: PairGeometry) -> NearPair:
        """The pair whose solution is known."""
        exact = geometry.exact
        parts = exact.motion.surface.flank_parts
        distance = on_parts(parts, exact.part, exact.pinion_parameters, lambda s, p: s.evaluate(p)[2])
        return cls(geometry.pair, geometry.members.gear, exact, distance < geometry.members.gear.blade_distance)

    def at(self, pair: GearPair) -> NearPair:
        """Another pair on the same blanks, so near that Newton's method leads from here to its solution."""
        here = self
        if pair.pinion != self.pair.pinion or pair.assembly != self.pair.assembly:
            here = here._with_pinion(pair)
        if pair.gear != self.pair.gear:
            here = here._with_gear(pair.gear.loaded)
        return replace(here, pair=pair)

    def _with_pinion(self, pair: GearPair) -> NearPair:
        known, gear, section = self.exact, self.gear, pair.pinion.section
        target = np.stack([gear.position[2], np.hypot(gear.position[0], gear.position[1])])
        usable = np.all(np.isfinite(target), axis=0)
        middle = target[:, usable].mean(axis=1)
        target = np.where(usable, target, middle[:, None])
        motion = conjugate_motion(pair.pinion.loaded.on("profile"), section, pair.assembly, middle)
        found = []
        for number, part in enumerate(pair.pinion.loaded.flank_parts):
            on_part = replace(motion, surface=part)
            start = SurfacePoints.of(part, known.pinion_parameters)
            points, search = points_at(on_part.conjugate_place, part, start, target)
            own = np.isfinite(known.angle) & (known.part == number)
            side = float(np.sign(np.median(points.orientation[own]))) if np.any(own) else 1.0
            found.append(classified(on_part, section, gear, points, search.converged & usable, side))
        names = [f.name for f in fields(EaseOff) if f.name not in ("motion", "pinion_section", "status", "part")]
        picked = {name: pick([getattr(one, name) for one in found], known.part) for name in names}
        # Azimuths are known but for whole turns.
        apart = np.nanmedian(picked["angle"] - known.angle)
        picked["angle"] = picked["angle"] - 2.0 * np.pi * np.round(apart / (2.0 * np.pi))
        picked["blade_distance"] = np.where(self.pinion_ends, picked["blade_distance"], known.blade_distance)
        return replace(self, exact=replace(known, motion=motion, **picked))

    def _with_gear(self, surface: GeneratingSurface) -> NearPair:
        known, exact = self.gear, self.exact
        target = np.stack([known.position[2], np.hypot(known.position[0], known.position[1])])
        usable = np.all(np.isfinite(target), axis=0)
        target = np.where(usable, target, target[:, usable].mean(axis=1, keepdims=True))

        def found(part: GeneratingSurface, parameters: Array) -> Array:
            points, search = points_at(axial_and_radial, part, SurfacePoints.of(part, parameters), target)
            values = np.where(search.converged & usable, points.values, np.nan)
            return np.concatenate([values, points.parameters])

        values = on_parts(surface.flank_parts, known.part, known.parameters, found)
        position, normal = values[:3], values[3:6]
        gear = replace(
            known,
            surface=surface,
            parameters=values[7:],
            position=position,
            normal=normal,
            blade_distance=values[6],
        )
        x, y = known.position[:2]
        # The azimuth beyond that of the known flank, from the turned point, without jumps.
        ahead = np.arctan2(x * position[1] - y * position[0], x * position[0] + y * position[1])
        lever_arm = np.abs(position[0] * normal[1] - position[1] * normal[0])
        exact = replace(
            exact,
            angle=exact.angle - exact.motion.pinion_sense * ahead,
            lever_arm=np.where(np.isfinite(exact.angle), lever_arm, np.nan),
            blade_distance=np.where(self.pinion_ends, exact.blade_distance, gear.blade_distance),
        )
        return replace(self, gear=gear, exact=exact)
