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

The strip may be cut by the edge of a tooth, see ``pressed_strip``. Where the bodies come closest before the edge, by
the distance -e, the derivative above is integrated from b = -e on, with the half-width a of the cut strip in h / s:

    q delta' = integral of (2 e + 6 a) [artanh(u) - k u] da = 3 a^2 A - 3 nu / (1 - nu) h a^2 / (s + h)
               + 2 e [a A + (1 - k) h asinh(a / h)],    A = asinh(h / a),    k = 1 / (2 (1 - nu)),

in units of 2 q / (pi E* b^2).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.checks import frozen_arrays, number, positive, shown
from ...core.errors import InputError
from .material import Material
from .pressed_strip import PressedStrip

FloatArray = NDArray[np.float64]

FOOT_OF_NORMAL_CORRECTION = 0.14
"""Deflection that is missing where bending is taken at the foot of the contact normal on the mid-surface, in units of
q (1 - nu^2) / E per body: mean of plane strain finite elements of tapered teeth, which give 0.12 to 0.17."""


@frozen_arrays
@dataclass(frozen=True, eq=False)
class _Bodies:
    """The exact formula for both bodies at once (first axis), for positive line loads."""

    depth: FloatArray
    unit: FloatArray
    contraction: FloatArray
    width_squared: FloatArray
    overhang: FloatArray
    flexibility: float
    correction: FloatArray

    def strip(self, line_load: FloatArray) -> PressedStrip:
        """The pressed strip."""
        return PressedStrip.of(self.overhang, self.width_squared * line_load)

    def secant(self, line_load: FloatArray) -> FloatArray:
        """Deflection per line load [mm/(N/mm)]."""
        h, strip = self.depth, self.strip(line_load)
        share = h / (np.sqrt(h * h + strip.half_width**2) + h)
        per_body = self.unit * (np.arcsinh(h / strip.half_width) - self.contraction * share)
        per_body = np.where(self._before_edge(line_load), self._integrated(strip.half_width, line_load), per_body)
        return np.asarray(per_body.sum(axis=0) + self.correction + self.flexibility / math.pi * strip.cut)

    def tangent(self, line_load: FloatArray) -> FloatArray:
        """Slope of the deflection over the line load [mm/(N/mm)]."""
        h, strip = self.depth, self.strip(line_load)
        s = np.sqrt(h * h + strip.half_width**2)
        drop = h / (s + h) * (1.0 - strip.growth * (s - h) / s)
        per_body = self.unit * (np.arcsinh(h / strip.half_width) - strip.growth * h / s - self.contraction * drop)
        slope = self.unit * (np.arcsinh(h / strip.half_width) - 0.5 * (1.0 + self.contraction) * h / s)
        per_body = np.where(self._before_edge(line_load), slope, per_body)
        return np.asarray(per_body.sum(axis=0) + self.correction + self.flexibility / math.pi * strip.cut_slope)

    def _before_edge(self, line_load: FloatArray) -> NDArray[np.bool_]:
        """Whether an edge cuts the strip of bodies that come closest before it."""
        e = self.overhang
        return np.asarray((e < 0.0) & (e * e < self.width_squared * line_load))

    def _integrated(self, half_width: FloatArray, line_load: FloatArray) -> FloatArray:
        """Deflection of each body per line load where ``_before_edge``."""
        h, contraction, e = self.depth, self.contraction, np.minimum(self.overhang, 0.0)

        def primitive(a: FloatArray) -> FloatArray:
            spread = np.arcsinh(h / a)
            square = 3.0 * a * a * (spread - contraction * h / (np.sqrt(h * h + a * a) + h))
            return np.asarray(square + 2.0 * e * (a * spread + 0.5 * (1.0 - contraction) * h * np.arcsinh(a / h)))

        with np.errstate(divide="ignore", invalid="ignore"):
            whole = e * e * (np.arcsinh(h / -e) - contraction * h / (np.sqrt(h * h + e * e) + h))
            gained = primitive(half_width) - primitive(-e)
            return np.asarray(self.unit * (whole + gained) / (self.width_squared * line_load))

    def energy(self, line_load: FloatArray) -> FloatArray:
        """Energy per length of whole strips, the closed integral of the secant times the line load [N]."""
        h, squared = self.depth, self.width_squared * line_load
        s = np.sqrt(h * h + squared)
        rest = (s + 2.0 * h) / 6.0 - self.contraction * (2.0 * s + h) / 3.0
        per_body = self.unit * (0.5 * np.arcsinh(h / np.sqrt(squared)) + h * rest / (s + h) ** 2)
        return np.asarray((per_body.sum(axis=0) + 0.5 * self.correction) * line_load**2)


#: Arrays of a line contact with a value for every segment.
_OF_SEGMENTS = (
    *("length", "equivalent_radius", "depth_pinion", "depth_gear", "overhang"),
    *("_floor", "_start", "_bend", "_floor_energy"),
)


@frozen_arrays
@dataclass(frozen=True, eq=False)
class WeberLineContact:
    """Local compliance of line contact segments, one independent spring each.

    All arrays broadcast together to one shape, (n,) or any other; n may be zero.

    Parameters
    ----------
    length
        Length of the segments [mm].
    equivalent_radius
        Relative radius of curvature across the contact line, 1 / (1/R_1 + 1/R_2) with signed radii [mm].
    depth_pinion, depth_gear
        Distance along the contact normal from the contact to the mid-surface of each tooth [mm].
    material_pinion, material_gear
        Materials of the two members.
    foot_correction
        Added to the deflection, in units of q (1 - nu^2) / E per body [-]. Zero is Weber's formula; see
        ``FOOT_OF_NORMAL_CORRECTION``.
    floor_ratio
        Half-width over the mean depth below which the logarithm gives way to a quadratic [-]. At 1e-3 that is a line
        load of about 0.03 N/mm for ordinary steel teeth.
    overhang
        Distance beyond the edge of a tooth at which the bodies would come closest [mm], negative before it; NaN if no
        edge is near.

    Raises
    ------
    InputError
        If an array is not positive and finite (the overhang: finite or NaN), the shapes do not broadcast, or an option
        is out of range.

    Examples
    --------
    >>> from easeoff.contact import Material
    >>> steel = Material(206000.0, 0.3)
    >>> contact = WeberLineContact(np.array([1.0, 2.0]), 30.0, 3.0, 4.0, steel, steel)
    >>> contact.pressure([200.0, 400.0]).round()
    array([490., 490.])
    """

    length: FloatArray
    equivalent_radius: FloatArray
    depth_pinion: FloatArray
    depth_gear: FloatArray
    material_pinion: Material
    material_gear: Material
    foot_correction: float = 0.0
    floor_ratio: float = 1e-3
    overhang: FloatArray = field(default_factory=lambda: np.array(np.nan))
    _floor: FloatArray = field(init=False, repr=False)
    _start: FloatArray = field(init=False, repr=False)
    _bend: FloatArray = field(init=False, repr=False)
    _floor_energy: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        names = ("length", "equivalent_radius", "depth_pinion", "depth_gear", "overhang")
        arrays = [np.asarray(getattr(self, name), dtype=np.float64) for name in names]
        try:
            arrays = [np.array(array) for array in np.broadcast_arrays(*arrays)]
        except ValueError:
            shapes = ", ".join(f"{name} {array.shape}" for name, array in zip(names, arrays, strict=True))
            raise InputError(f"arrays of shapes {shapes}: must broadcast together") from None
        for name, array in zip(names, arrays, strict=True):
            if name == "overhang":
                allowed, bad = "finite or NaN [mm]", np.isinf(array)
            else:
                allowed, bad = "positive and finite [mm]", ~(np.isfinite(array) & (array > 0.0))
            if bad.any():
                raise InputError(f"{name} = {shown(array[bad][0])}: must be {allowed}")
            object.__setattr__(self, name, array)
        positive("foot_correction", self.foot_correction, zero=True)
        number("floor_ratio", self.floor_ratio, above=0.0, below=1.0)

        bodies = self._bodies
        floor = self.floor_ratio**2 * self.depth_pinion * self.depth_gear / bodies.width_squared
        secant, tangent = bodies.secant(floor), bodies.tangent(floor)
        # delta = start q + bend q^2 meets value and slope at the floor; start = 2 secant - tangent > 0, bend < 0.
        object.__setattr__(self, "_floor", floor)
        object.__setattr__(self, "_start", 2.0 * secant - tangent)
        object.__setattr__(self, "_bend", (tangent - secant) / floor)
        object.__setattr__(self, "_floor_energy", self._quadratic_energy(floor) - bodies.energy(floor))

    @classmethod
    def joined(cls, contacts: Sequence[WeberLineContact]) -> WeberLineContact:
        """Join line contacts of the same materials and options: their arrays (n) are concatenated."""
        joined = contacts[0]._with(
            {name: np.concatenate([getattr(contact, name) for contact in contacts]) for name in _OF_SEGMENTS}
        )
        joined.__dict__.pop("parameters", None)
        return joined

    def part(self, chosen: slice) -> WeberLineContact:
        """Some of the segments alone, of arrays (n)."""
        return self._with({name: getattr(self, name)[chosen] for name in (*_OF_SEGMENTS, "parameters")})

    def _with(self, arrays: Mapping[str, FloatArray]) -> WeberLineContact:
        """The same materials and options with other arrays by name, which are checked already."""
        own = copy(self)
        own.__dict__.update(arrays)  # frozen
        own.__dict__.pop("_bodies", None)
        return own

    @cached_property
    def _bodies(self) -> _Bodies:
        materials = (self.material_pinion, self.material_gear)
        one_per_body = (2, *([1] * self.length.ndim))
        poisson_ratio = np.reshape([material.poisson_ratio for material in materials], one_per_body)
        moduli = np.reshape([material.plane_strain_modulus for material in materials], one_per_body)
        return _Bodies(
            depth=np.stack([self.depth_pinion, self.depth_gear]),
            unit=2.0 / (math.pi * moduli),
            contraction=poisson_ratio / (1.0 - poisson_ratio),
            width_squared=self._width_squared,
            overhang=self.overhang,
            flexibility=self.flexibility,
            correction=self._correction,
        )

    @property
    def _width_squared(self) -> FloatArray:
        """Square of the half-width over the line load."""
        return np.asarray(4.0 / math.pi * self.flexibility * self.equivalent_radius)

    @property
    def _correction(self) -> FloatArray:
        """Deflection per line load beside that of half planes."""
        return np.full(self.length.shape, self.foot_correction * self.flexibility)

    @property
    def flexibility(self) -> float:
        """Sum over the bodies of (1 - nu^2) / E [1/MPa]."""
        return 1.0 / self.material_pinion.plane_strain_modulus + 1.0 / self.material_gear.plane_strain_modulus

    @cached_property
    def parameters(self) -> FloatArray:
        """The formula's numbers (n, 14), as the compiled contact solution reads them.

        Length; depths, deflections per line load over the logarithm and contractions of pinion and gear; square of the
        half-width per line load; overhang; the floor, and start and bend of the quadratic below it; what foot of the
        normal adds; what a cut adds.
        """
        bodies, table = self._bodies, np.empty((self.length.size, 14))
        columns = (
            self.length,
            *bodies.depth,
            *bodies.unit,
            *bodies.contraction,
            bodies.width_squared,
            self.overhang,
            self._floor,
            self._start,
            self._bend,
            bodies.correction,
            bodies.flexibility / math.pi,
        )
        for column, values in enumerate(columns):
            table[:, column] = values
        return table

    def _quadratic_energy(self, line_load: FloatArray) -> FloatArray:
        """Energy per length below the floor."""
        return np.asarray(line_load**2 * (0.5 * self._start + self._bend * np.maximum(line_load, 0.0) / 3.0))

    def _line_load(self, force: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Line load, and the line load raised to the floor."""
        line_load = np.asarray(force, dtype=np.float64) / self.length
        return line_load, np.maximum(line_load, self._floor)

    def secant(self, force: ArrayLike) -> FloatArray:
        """Secant compliance: deflection over force, at zero force its limit.

        Parameters
        ----------
        force
            Normal force on every segment [N].

        Returns
        -------
        Array
            Secant compliance [mm/N], positive.
        """
        line_load, raised = self._line_load(force)
        quadratic = self._start + self._bend * np.maximum(line_load, 0.0)
        above = self._bodies.secant(raised)
        return np.asarray(np.where(line_load < self._floor, quadratic, above) / self.length)

    def deflection(self, force: ArrayLike) -> FloatArray:
        """Approach of the two mid-surfaces by local deformation.

        Parameters
        ----------
        force
            Normal force on every segment [N].

        Returns
        -------
        Array
            Deflection along the contact normal [mm].
        """
        return np.asarray(self.secant(force) * np.asarray(force, dtype=np.float64))

    def tangent(self, force: ArrayLike) -> FloatArray:
        """Tangent compliance: derivative of the deflection by the force.

        Parameters
        ----------
        force
            Normal force on every segment [N].

        Returns
        -------
        Array
            Tangent compliance [mm/N], positive.
        """
        line_load, raised = self._line_load(force)
        quadratic = self._start + 2.0 * self._bend * np.maximum(line_load, 0.0)
        above = self._bodies.tangent(raised)
        return np.asarray(np.where(line_load < self._floor, quadratic, above) / self.length)

    def energy(self, force: ArrayLike) -> FloatArray:
        """Elastic energy of every segment, the integral of the deflection over the force.

        Parameters
        ----------
        force
            Normal force on every segment [N].

        Returns
        -------
        Array
            Energy [N mm], strictly convex in the force; NaN where an edge is near: it is not in closed form.
        """
        line_load, raised = self._line_load(force)
        above = self._bodies.energy(raised) + self._floor_energy
        energy = np.where(line_load < self._floor, self._quadratic_energy(line_load), above)
        return np.where(np.isnan(self.overhang), energy * self.length, np.nan)

    def half_width(self, force: ArrayLike) -> FloatArray:
        """Half-width of the pressed strip [mm]; zero where the force is not positive.

        Parameters
        ----------
        force
            Normal force on every segment [N].
        """
        line_load = np.asarray(force, dtype=np.float64) / self.length
        pressed = line_load > 0.0
        return np.where(pressed, self._bodies.strip(np.where(pressed, line_load, 1.0)).half_width, 0.0)

    def pressure(self, force: ArrayLike) -> FloatArray:
        """Largest Hertzian pressure, 2 q / (pi b) [MPa]; zero where the force is not positive.

        NaN where the bodies come closest on an edge: at a sharp edge the pressure has no limit. Where an edge cuts the
        side of a strip it is that of the whole strip.

        Parameters
        ----------
        force
            Normal force on every segment [N].
        """
        line_load = np.maximum(np.asarray(force, dtype=np.float64) / self.length, 0.0)
        whole = 2.0 / math.pi * np.sqrt(line_load / self._bodies.width_squared)
        return np.where(self.overhang >= 0.0, np.nan, whole)
