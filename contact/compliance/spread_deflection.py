"""Deflection between flank and mid-surface that plane line contact leaves out, spread along the line.

Weber's formula integrates the strains of a half-plane down to the mid-surface. In a tooth, bent and with a free surface
on its other side, flank and foot of the normal approach by more: under an even line load q by 0.16 q (1 - nu^2) / E.
Under a load that varies along the line as cos(k s), this falls to a tenth at k h = 0.9, with the depth h to the
mid-surface. It is thus no local spring, but the load passed twice through a Gaussian of standard deviation 1.7 h:

    delta(s) = 0.16 (1 - nu^2) / E  integral of g(s - t) g(s' - t) q(s') over s' and t.

The Gaussians at a row of nodes t are unit loads like those of the bending modes, which they join: the compliance stays
symmetric and positive semidefinite. The two numbers are those of finite elements of tapered teeth, which they meet
within 0.05 in units of q (1 - nu^2) / E for flanks at 18 to 26 degrees to the tooth's axis; with less taper the
deflection falls off sooner.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ..lines.flank_splines import FlankSplines
from .material import Material

Array = NDArray[Any]

EVEN_LOAD_DEFLECTION = 0.16  # [q (1 - nu^2) / E], under an even line load
SPREAD_PER_DEPTH = 1.69  # standard deviation of the Gaussian over the depth of the mid-surface
NODE_SPACING = 0.6  # of the mean standard deviation
SMALLEST_SPREAD = 0.7  # standard deviation over the spacing of the nodes; a narrower Gaussian would fall between them
NODES_BEYOND = 2.5  # mean standard deviations beyond the flank
SAMPLES = np.linspace(0.0, 1.0, 9)  # of the flank in either direction, for means and limits


@frozen_arrays
@dataclass(frozen=True)
class SpreadDeflection:
    """Spread deflection of one member.

    Parameters
    ----------
    depth
        Name of the field with the depth of the member's mid-surface.
    flexibility
        (1 - nu^2) / E [1/MPa].
    direction
        Unit vector (3) along the contact lines in the middle of the flank.
    nodes
        Middles of the Gaussians (k) along it [mm], evenly spaced.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import STEEL
    >>> from easeoff.contact.loaded import loaded_splines
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    >>> spread = SpreadDeflection.of(fields, "gear", STEEL)
    >>> spread.loads(fields, middle := np.full((2, 4, 1), 0.5), middle, np.ones(1)).shape == (spread.nodes.size, 4)
    True
    """

    depth: str
    flexibility: float
    direction: Array
    nodes: Array

    @classmethod
    def of(cls, splines: FlankSplines, member: str, material: Material) -> SpreadDeflection:
        """The spread deflection of a member.

        Parameters
        ----------
        splines
            Splines from ``loaded_splines``.
        member
            ``"pinion"`` or ``"gear"``.
        material
            Its material.
        """
        middle = np.array([[0.5], [0.5]])
        roll = [splines("roll_angle", middle, d)[0] for d in ((1, 0), (0, 1))]
        tangents = [splines("position", middle, d)[:, 0] for d in ((1, 0), (0, 1))]
        direction = roll[1] * tangents[0] - roll[0] * tangents[1]
        direction = direction / np.linalg.norm(direction)
        everywhere = np.stack(np.meshgrid(SAMPLES, SAMPLES, indexing="ij"))
        along = np.einsum("x,x...->...", direction, splines("position", everywhere))
        depth = f"depth_{member}"
        spread = SPREAD_PER_DEPTH * float(np.maximum(splines(depth, everywhere), 0.0).mean())
        beyond = NODES_BEYOND * spread
        count = int(np.ceil((np.ptp(along) + 2.0 * beyond) / (NODE_SPACING * spread))) + 1
        nodes = np.linspace(along.min() - beyond, along.max() + beyond, count)
        return cls(depth, 1.0 / material.plane_strain_modulus, direction, nodes)

    def loads(self, splines: FlankSplines, points: Array, loaded: Array, weights: Array) -> Array:
        """Unit loads on segments: their inner products are the compliances.

        Parameters
        ----------
        splines
            Splines from ``loaded_splines``.
        points
            Quadrature points (2, n, g) of n segments, as fractions on the gear.
        loaded
            Where the member is loaded there (2, n, g), see ``opposite_points.pinion_points``.
        weights
            Quadrature weights (g), adding up to one.

        Returns
        -------
        Array
            Y (k, n) such that Y^T Y is the compliance between the segments [mm/N].
        """
        along = np.einsum("x,x...->...", self.direction, splines("position", points))
        spacing = self.nodes[1] - self.nodes[0]
        return gaussians(self.nodes, along, splines(self.depth, loaded), self.flexibility * spacing) @ weights


def gaussians(nodes: Array, along: Array, depth: Array, scale: float) -> Array:
    """Gaussians (k, ...) about nodes (k) at places (...) along a line, over depths (...) [mm].

    With nodes of even spacing d and a ``scale`` of (1 - nu^2) d / E, the sum of their products over the nodes is the
    compliance between two places [mm/N].
    """
    spacing = nodes[1] - nodes[0]
    spread = np.maximum(SPREAD_PER_DEPTH * depth, SMALLEST_SPREAD * spacing)
    factor = np.sqrt(EVEN_LOAD_DEFLECTION * scale / (2.0 * np.pi))
    values = np.reshape(nodes, (-1, *[1] * along.ndim)) - along
    values *= np.sqrt(0.5) / spread  # in place: the array is large
    values *= -values
    np.exp(values, out=values)
    values *= factor / spread
    return np.asarray(values)
