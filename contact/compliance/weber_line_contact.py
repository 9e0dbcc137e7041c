"""Local deflection of a line contact between two teeth, after Weber.

With the line load q = F / L, the half-width b = sqrt(4 q R (1/E1* + 1/E2*) / pi), E* = E / (1 - nu^2), and the depth h
from the contact to the tooth's mid-surface along the contact normal, the elliptic pressure indents each body by

    delta = 2 q / (pi E*) [ asinh(h / b) - nu / (1 - nu) h / (s + h) ],    s = sqrt(h^2 + b^2).

This is the exact integral of the axial strain down to depth h; for b << h it becomes the familiar
q / (pi E*) [ 2 ln(2 h / b) - nu / (1 - nu) ] (C. Weber 1949; K. L. Johnson, Contact Mechanics, 1985, section 5.6),
which turns negative for wide contacts near a thin tip. With u = h / s the derivative of the exact form is

    d(delta)/dq = 2 / (pi E*) [ artanh(u) - u / (2 (1 - nu)) ] > 0    for every load, as artanh(u) > u and nu < 1/2,

so its energy is strictly convex without any guard on b / h.

At vanishing load the compliance still grows as a logarithm. Below a floor, where b is a small fraction of the depth,
delta continues as the quadratic through zero with the value and slope of the floor: once differentiable, zero at zero,
with bounded stiffness and still a strictly convex energy. Below zero, which no solution reaches but an iteration may,
it is linear.

The strip may be cut by the edge of a tooth, see ``strip_half_width``. Where the bodies come closest before the edge, by
the distance -e, the derivative above is integrated from b = -e on, with the half-width a of the cut strip in h / s:

    q delta' = integral of (2 e + 6 a) [artanh(u) - k u] da = 3 a^2 A - 3 nu / (1 - nu) h a^2 / (s + h)
               + 2 e [a A + (1 - k) h asinh(a / h)],    A = asinh(h / a),    k = 1 / (2 (1 - nu)),

in units of 2 q / (pi E* b^2).

A whole strip has Hertz's half-width b. Where the bodies would come closest a distance e beyond an edge, the strip
reaches from the edge to where the pressure falls to zero. With both bodies half planes, Chebyshev's expansion of the
pressure, of which the root is singular at the edge and bounded at the other end, gives its half-width a:

    3 a^2 + 2 e a = b^2.

Counting the gap from the edge, the deflection of a body under the line load q is that of a whole strip with a for b in
the logarithm, and q / (pi E*) 2 e / (2 e + 3 a) more. Its derivative is that of a whole strip with a for b.

The width is the same where the bodies come closest before the edge, less than b from it: e is negative then, down to
-b, where the strip becomes whole. So is the derivative, and the deflection is its integral from the load at which the
strip reaches the edge.

That the body ends at the edge is left to the bending of the tooth: near its corner it gives way more than a half plane.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import RealArray as Array, record
from ...core.checks import number, positive, shown
from ...core.errors import InputError
from ...core.kernels import kernel
from .material import Material


def strip_half_width(overhang: Array, squared: Array) -> Array:
    """Half-widths of strips cut by an edge [mm]; ``squared`` are squares of the whole ones under the same line load.

    ``overhang`` is the distance of the strip's middle beyond the edge [mm], negative before it; NaN without an edge.
    """
    half = np.sqrt(squared)
    whole = ~(overhang > -half)
    e = np.where(whole, 0.0, overhang)
    return np.where(whole, half, squared / (np.sqrt(e * e + 3.0 * squared) + e))


deflections = kernel(".line_deflection", f"{__package__.rpartition('.')[0]}.solvers.compiled").deflections

FOOT_OF_NORMAL_CORRECTION = 0.14
"""Deflection that is missing where bending is taken at the foot of the contact normal on the mid-surface, in units of
q (1 - nu^2) / E per body: mean of plane strain finite elements of tapered teeth, which give 0.12 to 0.17."""


#: Arrays of a line contact with a value for every segment: those given, and all.
_GIVEN = ("length", "equivalent_radius", "depth_pinion", "depth_gear", "overhang")
_OF_SEGMENTS = (*_GIVEN, "_floor", "_start", "_bend", "_floor_energy")


@record(frozen=True, eq=False)
class WeberLineContact:
    """Local compliance of line contact segments, one independent spring each; all arrays broadcast to one shape.

    The relative radius is 1 / (1/R_1 + 1/R_2) with signed radii. Lengths, radii and depths must be positive.
    """

    length: Array
    equivalent_radius: Array  # across the contact line [mm]
    depth_pinion: Array  # along the contact normal to the mid-surface [mm]
    depth_gear: Array
    material_pinion: Material
    material_gear: Material
    foot_correction: float = 0.0  # in q (1 - nu^2) / E per body, added to Weber's
    floor_ratio: float = 1e-3  # half-width over mean depth, below it quadratic; 1e-3 is some 0.03 N/mm
    overhang: Array = field(default_factory=lambda: np.array(np.nan))  # beyond an edge [mm], NaN without one
    _floor: Array = field(init=False, repr=False)
    _start: Array = field(init=False, repr=False)
    _bend: Array = field(init=False, repr=False)
    _floor_energy: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        arrays = [np.asarray(getattr(self, name), dtype=np.float64) for name in _GIVEN]
        try:
            arrays = [np.array(array) for array in np.broadcast_arrays(*arrays)]
        except ValueError:
            shapes = ", ".join(f"{name} {array.shape}" for name, array in zip(_GIVEN, arrays, strict=True))
            raise InputError(f"arrays of shapes {shapes}: must broadcast together") from None
        for name, array in zip(_GIVEN, arrays, strict=True):
            if name == "overhang":
                allowed, bad = "finite or NaN [mm]", np.isinf(array)
            else:
                allowed, bad = "positive and finite [mm]", ~(np.isfinite(array) & (array > 0.0))
            if bad.any():
                raise InputError(f"{name} = {shown(array[bad][0])}: must be {allowed}")
            object.__setattr__(self, name, array)
        positive("foot_correction", self.foot_correction, zero=True)
        number("floor_ratio", self.floor_ratio, above=0.0, below=1.0)

        floor = self.floor_ratio**2 * self.depth_pinion * self.depth_gear / self._width_squared
        for name in ("_floor", "_start", "_bend"):
            object.__setattr__(self, name, np.zeros(self.length.shape))
        secant, tangent = self._by_load(floor)
        del self.__dict__["parameters"]
        # delta = start q + bend q^2 meets value and slope at the floor; start = 2 secant - tangent > 0, bend < 0.
        object.__setattr__(self, "_floor", floor)
        object.__setattr__(self, "_start", 2.0 * secant - tangent)
        object.__setattr__(self, "_bend", (tangent - secant) / floor)
        object.__setattr__(self, "_floor_energy", self._quadratic_energy(floor) - self._whole_energy(floor))

    @classmethod
    def joined(cls, contacts: Sequence[WeberLineContact]) -> WeberLineContact:
        """Join line contacts of the same materials and options: their arrays (n) are concatenated."""
        arrays = {name: np.concatenate([getattr(contact, name) for contact in contacts]) for name in _OF_SEGMENTS}
        joined = contacts[0]._with(arrays)
        joined.__dict__.pop("parameters", None)
        return joined

    def part(self, chosen: slice) -> WeberLineContact:
        """Some of the segments alone, of arrays (n)."""
        return self._with({name: getattr(self, name)[chosen] for name in (*_OF_SEGMENTS, "parameters")})

    def _with(self, arrays: Mapping[str, Array]) -> WeberLineContact:
        """The same materials and options with other arrays by name, which are checked already."""
        contact = copy(self)
        contact.__dict__.update(arrays)  # frozen
        return contact

    @property
    def _width_squared(self) -> Array:
        """Square of the half-width over the line load."""
        return np.asarray(4.0 / math.pi * self.flexibility * self.equivalent_radius)

    @property
    def flexibility(self) -> float:
        """Sum over the bodies of (1 - nu^2) / E [1/MPa]."""
        return 1.0 / self.material_pinion.plane_strain_modulus + 1.0 / self.material_gear.plane_strain_modulus

    @cached_property
    def parameters(self) -> Array:
        """The formula's numbers (n, 14), as the compiled contact solution reads them.

        Length; depths, deflections per line load over the logarithm, contractions of pinion and gear; squared
        half-width per line load; overhang; floor, start and bend of the quadratic below it; additions of foot and cut.
        """
        table, correction = np.empty((self.length.size, 14)), self.foot_correction * self.flexibility
        columns: list[ArrayLike] = [self.length, self.depth_pinion, self.depth_gear, *self._units, *self._contractions]
        columns += [self._width_squared, self.overhang, self._floor, self._start, self._bend]
        columns += [correction, self.flexibility / math.pi]
        for column, values in enumerate(columns):
            table[:, column] = np.ravel(values)
        return table

    @property
    def _units(self) -> list[float]:
        """Deflection of each body per line load over the logarithm."""
        return [2.0 / (math.pi * body.plane_strain_modulus) for body in (self.material_pinion, self.material_gear)]

    @property
    def _contractions(self) -> list[float]:
        """Poisson's ratio of each body over one less it."""
        ratios = self.material_pinion.poisson_ratio, self.material_gear.poisson_ratio
        return [ratio / (1.0 - ratio) for ratio in ratios]

    def _by_load(self, line_load: Array) -> Array:
        """Secant and tangent of the deflection over line loads (...), (2, ...) [mm/(N/mm)]."""
        places = np.arange(self.length.size).reshape(self.length.shape)
        segment = np.ravel(np.broadcast_to(places, line_load.shape))
        compliances = np.empty((2, line_load.size))
        deflections(self.parameters, segment, np.ravel(line_load), compliances)
        return compliances.reshape(2, *line_load.shape)

    def _whole_energy(self, line_load: Array) -> Array:
        """Energy per length of whole strips, the closed integral of the secant times the line load [N]."""
        squared = self._width_squared * line_load
        energy: Array = np.full(squared.shape, 0.5 * self.foot_correction * self.flexibility)
        depths = self.depth_pinion, self.depth_gear
        for h, unit, contraction in zip(depths, self._units, self._contractions, strict=True):
            s = np.sqrt(h * h + squared)
            rest = (s + 2.0 * h) / 6.0 - contraction * (2.0 * s + h) / 3.0
            energy = energy + unit * (0.5 * np.arcsinh(h / np.sqrt(squared)) + h * rest / (s + h) ** 2)
        return np.asarray(energy * line_load**2)

    def _quadratic_energy(self, line_load: Array) -> Array:
        """Energy per length below the floor."""
        return np.asarray(line_load**2 * (0.5 * self._start + self._bend * np.maximum(line_load, 0.0) / 3.0))

    def _line_load(self, force: ArrayLike) -> Array:
        """Line loads of forces."""
        return np.asarray(np.asarray(force, dtype=np.float64) / self.length)

    def secant(self, force: ArrayLike) -> Array:
        """Secant compliance [mm/N]: deflection over force [N], at zero force its limit."""
        return np.asarray(self._by_load(self._line_load(force))[0] / self.length)

    def deflection(self, force: ArrayLike) -> Array:
        """Approach of the two mid-surfaces by local deformation [mm], along the contact normal, under forces [N]."""
        return np.asarray(self.secant(force) * np.asarray(force, dtype=np.float64))

    def tangent(self, force: ArrayLike) -> Array:
        """Tangent compliance [mm/N]: derivative of the deflection by the force [N]."""
        return np.asarray(self._by_load(self._line_load(force))[1] / self.length)

    def energy(self, force: ArrayLike) -> Array:
        """Elastic energy [N mm], the deflection integrated over the force [N]; NaN near an edge: no closed form."""
        line_load = self._line_load(force)
        above = self._whole_energy(np.maximum(line_load, self._floor)) + self._floor_energy
        energy = np.where(line_load < self._floor, self._quadratic_energy(line_load), above)
        return np.where(np.isnan(self.overhang), energy * self.length, np.nan)

    def half_width(self, force: ArrayLike) -> Array:
        """Half-width of the pressed strip [mm] under forces [N]; zero where the force is not positive."""
        line_load = self._line_load(force)
        pressed = line_load > 0.0
        squared = self._width_squared * np.where(pressed, line_load, 1.0)
        return np.where(pressed, strip_half_width(self.overhang, squared), 0.0)

    def pressure(self, force: ArrayLike) -> Array:
        """Largest Hertzian pressure 2 q / (pi b) [MPa]; zero where the force [N] is not positive.

        NaN where the bodies come closest on an edge: at a sharp edge it has no limit. Where an edge cuts the side of a
        strip it is that of the whole strip.
        """
        whole = 2.0 / math.pi * np.sqrt(np.maximum(self._line_load(force), 0.0) / self._width_squared)
        return np.where(self.overhang >= 0.0, np.nan, whole)
