"""The real tooth as a labelled dataset: points and normals of both sides from root land to tip, and its thickness."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.attributes import flag_attributes, labelled
from ..flanks.blank_section import BlankSection
from ..pair.gear_pair import GearPair
from .tooth_surface import ToothSide, ToothSurface, tooth_surface

THICKNESS_LEVELS = 21
REGION_FLAGS = flag_attributes({0: "fillet", 1: "flank"})


def tooth(pair: GearPair, member: str, nodes: tuple[int, int] = (31, 21)) -> xr.Dataset:
    """The real tooth of one member.

    Parameters
    ----------
    pair
        The gear pair.
    member
        ``"pinion"`` or ``"gear"``.
    nodes
        Nodes lengthwise and up the flank.

    Returns
    -------
    xr.Dataset
        ``position`` [mm] and ``normal`` over (side, lengthwise, upward, xyz), the first side loaded, both in the
        member's frame and where they belong around the tooth; ``region`` says which nodes are fillet; and
        ``transverse_thickness`` [mm] over (lengthwise, level), from the higher end of both fillets to the tip.

    Raises
    ------
    GeometryError
        As ``tooth_surface.tooth_surface``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> dict(tooth(pair, "gear", (5, 5))["position"].sizes)
    {'side': 2, 'lengthwise': 5, 'upward': 13, 'xyz': 3}
    """
    surface = tooth_surface(pair, member, nodes)
    section = (pair.pinion if member == "pinion" else pair.gear).section
    sides = (surface.loaded, surface.opposite)
    fillet_nodes, flank_nodes = sides[0].fillet.shape[2], sides[0].flank.shape[2]
    grid = ("side", "lengthwise", "upward", "xyz")
    lengthwise = np.linspace(0.0, 1.0, nodes[0])
    return labelled(
        xr.Dataset(
            {
                "position": (grid, np.stack([np.moveaxis(_upward(s.fillet, s.flank), 0, -1) for s in sides])),
                "normal": (
                    grid,
                    np.stack([np.moveaxis(_upward(s.fillet_normal, s.flank_normal), 0, -1) for s in sides]),
                ),
                "region": ("upward", np.repeat([0, 1], [fillet_nodes - 1, flank_nodes]).astype(np.int8), REGION_FLAGS),
                "transverse_thickness": (("lengthwise", "level"), transverse_thickness(surface, section)),
            },
            coords={
                "side": list(surface.names),
                "lengthwise": lengthwise,
                "level": np.linspace(0.0, 1.0, THICKNESS_LEVELS),
                "xyz": list("xyz"),
            },
            attrs={"member": member},
        )
    )


def _upward(fillet: Array, flank: Array) -> Array:
    return np.concatenate([fillet[:, :, :-1], flank], axis=2)


def transverse_thickness(surface: ToothSurface, section: BlankSection) -> Array:
    """Chord across the tooth at right angles to the member's axis (nt, levels) [mm]."""
    from scipy.interpolate import PchipInterpolator

    thickness = np.empty((surface.top_land.shape[1], THICKNESS_LEVELS))
    for index in range(thickness.shape[0]):
        heights, azimuths = zip(
            *(_profile(side, section, index) for side in (surface.loaded, surface.opposite)), strict=True
        )
        common = np.linspace(max(h[0] for h in heights), 1.0, THICKNESS_LEVELS)
        front, back = (PchipInterpolator(h, a)(common) for h, a in zip(heights, azimuths, strict=True))
        _, radius = section.points(np.full(THICKNESS_LEVELS, index / (thickness.shape[0] - 1)), common)
        thickness[index] = 2.0 * radius * np.abs(np.sin(0.5 * (back - front)))
    return thickness


def _profile(side: ToothSide, section: BlankSection, index: int) -> tuple[Array, Array]:
    """Profile fraction and azimuth [rad] of one line from root land to tip."""
    x, y, z = _upward(side.fillet, side.flank)[:, index]
    _, height = section.fractions(z, np.hypot(x, y))
    # A fillet without height, of a sharp Formate blade, gives one node many times over.
    rising = np.concatenate([[True], np.diff(height) > 1e-9])
    return height[rising], np.unwrap(np.arctan2(y, x))[rising]
