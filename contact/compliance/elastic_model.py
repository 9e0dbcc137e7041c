"""Elastic model of a tooth pair, and its bending compliance under loads along the contact normals.

From unit loads on the segments of a mesh cycle follows the bending compliance at a mesh position, by modes of tooth
pairs. Segments on different tooth pairs are coupled through the bodies of pinion and gear alone, by modes that all
pairs of the position share.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
import xarray as xr

from ...core.arrays import Array, Integers, record
from ...core.attributes import ordered
from ...core.checks import bounded, check_fields, frozen, instances, two_whole
from ...geometry.pair.gear_pair import MEMBERS, GearPair
from ..lines.flank_splines import FlankSplines
from ..problem.modal_basis import ModalBasis, SharedModes, basis_of_blocks, compressed_block
from .finite_elements.finite_element_tooth import solid_shell_tooth
from .finite_elements.flank_compliance import FlankCompliance
from .finite_elements.tooth_ring import ToothBody
from .material import Material
from .shell import Shell
from .shell_kinematics import ElasticFoundation
from .tooth_dimensions import ToothDimensions

DROPPED_SHARE = 1e-8  # of the greatest eigenvalue: shared modes below, which change no digit of a result, are left out
EIGENVALUE_RATIO_LIMIT = 1e-12  # of the greatest: what is below is rounding


@record(frozen=True)
class BodyCoupling:
    """Compliance between tooth pairs through the bodies of the members."""

    members: tuple[tuple[Array, int], ...]  # modes by distance (N, q, q) [mm/N], pitches from pair to pair
    known: dict[tuple[int, ...], Array] = field(default_factory=dict, repr=False, compare=False)

    def compliance(self, pairs: Sequence[int] | Integers) -> Array:
        """Compliance (p, q, p, q) [mm/N] between the modes of tooth pairs (p), those of all members one by one."""
        numbers = np.asarray(pairs)
        distance = numbers[:, None] - numbers
        size = sum(coupling.shape[1] for coupling, _ in self.members)
        result = np.zeros((numbers.size, size, numbers.size, size))
        start = 0
        for coupling, pitches in self.members:
            modes = slice(start, start + coupling.shape[1])
            result[:, modes, :, modes] = np.moveaxis(coupling[np.mod(pitches * distance, len(coupling))], 1, 2)
            start = modes.stop
        return result

    def shared_modes(self, pairs: Sequence[int] | Integers, segments: Sequence[Integers], loads: Array) -> SharedModes:
        """Modes of the bodies that tooth pairs (p) share, with unit loads (n, q) on their segments in these modes."""
        root = self._root(tuple(int(pair) for pair in pairs))
        on_root = np.concatenate([loads[rows] @ pair_root for rows, pair_root in zip(segments, root, strict=True)])
        values, vectors = np.linalg.eigh(on_root.T @ on_root)
        return SharedModes(loads, root @ vectors[:, values > DROPPED_SHARE * values[-1]])

    def _root(self, pairs: tuple[int, ...]) -> Array:
        """Y (p, q, r) such that the compliance between the modes of tooth pairs is Y Y^T."""
        if pairs not in self.known:
            whole = self.compliance(pairs)
            values, vectors = np.linalg.eigh(whole.reshape(len(pairs) * whole.shape[1], -1))
            kept = values > EIGENVALUE_RATIO_LIMIT * values[-1]
            root = (vectors[:, kept] * np.sqrt(values[kept])).reshape(*whole.shape[:2], -1)
            self.known[pairs] = frozen(root)
        return self.known[pairs]


PlateName = Literal["even", "fitted"]
ElasticTooth = Shell | FlankCompliance
STEEL = Material(206000.0, 0.3)
DEFAULT_FOUNDATION = ElasticFoundation()
#: Pitches, from the loaded side through the tooth, from the tooth of one pair to that of the next, which is one pitch
#: behind it: the gear is pushed from its loaded side into its tooth, the pinion moves the other way.
PITCHES_PER_PAIR = (1, -1)


@dataclass(frozen=True)
class ElasticModel:
    """Elastic model of both teeth: shells on elastic roots, or solid shells or finite elements.

    Parameters
    ----------
    pinion, gear
        Materials.
    modes, shear_factor
        See ``Shell``.
    plate
        ``even``: a plate of even taper with parallel heights, as in the dissertation; ``fitted``: with the bulge and
        the fanning heights of the real tooth.
    foundation
        Springs along the root; ``None`` clamps it.
    condensed
        Pinion and gear as solid shells (``solid_shells``) or by finite elements, instead of the shells.
    foot_correction
        Added to the line contact, see ``WeberLineContact``.

    Examples
    --------
    >>> from easeoff.contact import ElasticFoundation
    >>> softer = ElasticModel(foundation=ElasticFoundation("odonnell", 0.8), plate="fitted")
    >>> softer.modes
    (5, 15)
    """

    pinion: Material = STEEL
    gear: Material = STEEL
    modes: tuple[int, int] = (5, 15)
    shear_factor: float = field(default=1.0, metadata=bounded(above=0.0))
    plate: PlateName = "even"
    foundation: ElasticFoundation | None = DEFAULT_FOUNDATION
    condensed: tuple[FlankCompliance, FlankCompliance] | None = None
    foot_correction: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        two_whole("modes", self.modes, 1)
        if self.condensed is not None:
            instances("condensed", self.condensed, FlankCompliance, 2)


def solid_shells(pair: GearPair, *, neighbours: bool = True) -> ElasticModel:
    """Elastic model of the teeth of a pair as solid shells of steel, made once and kept on disk.

    Deviations of the flanks and misalignment are left out; with ``neighbours`` the teeth of a member share their body.
    """
    of_pinion, of_gear = (replace(member, loaded=member.loaded.designed) for member in (pair.pinion, pair.gear))
    designed = replace(pair, pinion=of_pinion, gear=of_gear)
    body = ToothBody(neighbours=neighbours)
    of_pinion_tooth = solid_shell_tooth(designed, "pinion", STEEL, body=body)
    of_gear_tooth = solid_shell_tooth(designed, "gear", STEEL, body=body)
    return ElasticModel(condensed=(of_pinion_tooth.flank, of_gear_tooth.flank))


def tooth_dimensions(teeth: xr.Dataset, member: str, plate: PlateName = "even") -> ToothDimensions:
    """Dimensions of the plate that stands for one member's tooth, from the geometry's ``teeth``."""
    one = teeth.sel(member=member)
    fitted = plate == "fitted"
    height, thickness = one["tooth_height"], one["fitted_thickness" if fitted else "plate_thickness"]
    dimensions = {name: float(one[name]) for name in ("trace_length", "trace_radius", *(["fanning"] if fitted else []))}
    for end in ("toe", "heel"):
        dimensions[f"height_{end}"] = float(height.sel(tooth_end=end))
        for edge in ("root", "tip"):
            dimensions[f"{edge}_thickness_{end}"] = float(thickness.sel(tooth_end=end, plate_edge=edge))
        if fitted:
            dimensions[f"bulge_{end}"] = float(one["bulge"].sel(tooth_end=end))
    return ToothDimensions(**dimensions)


def shells(teeth: xr.Dataset, model: ElasticModel) -> tuple[Shell, Shell]:
    """Shells of pinion and gear."""
    pinion, gear = (
        Shell(tooth_dimensions(teeth, member, model.plate), material, model.modes, model.shear_factor, model.foundation)
        for member, material in zip(MEMBERS, (model.pinion, model.gear), strict=True)
    )
    return pinion, gear


def elastic_teeth(teeth: xr.Dataset, model: ElasticModel) -> tuple[ElasticTooth, ElasticTooth]:
    """Pinion and gear as the model has them, else as shells."""
    return shells(teeth, model) if model.condensed is None else model.condensed


@dataclass(frozen=True)
class ElasticTeeth:
    """Elastic teeth of a pair, built when they are first asked for: unloaded contact does without them."""

    plates: xr.Dataset
    given: ElasticModel | None
    pair: GearPair | None = None

    @cached_property
    def model(self) -> ElasticModel:
        """Elastic model of both."""
        if self.given is not None:
            return self.given
        assert self.pair is not None
        return solid_shells(self.pair)

    @property
    def solid(self) -> tuple[Material, Material] | None:
        """Materials of pinion and gear; ``None`` for plates, the dissertation's method, which know no more than it."""
        if self.given is None:
            return STEEL, STEEL  # as ``solid_shells``
        return None if self.given.condensed is None else (self.given.pinion, self.given.gear)

    @cached_property
    def both(self) -> tuple[ElasticTooth, ElasticTooth]:
        """Pinion and gear."""
        return elastic_teeth(self.plates, self.model)

    @cached_property
    def coupling(self) -> BodyCoupling | None:
        """Coupling of tooth pairs, the same in every assembly."""
        return body_coupling(self.both)


def tooth_fields(teeth: xr.Dataset) -> dict[str, Array]:
    """Fields (lengthwise, profile, ...) of the geometry's ``teeth`` that ``unit_loads`` needs, by name."""
    fields = {}
    for member in MEMBERS:
        one = int(np.flatnonzero(ordered(teeth, "member", "member") == member)[0])
        for name in ("shell_height", "shell_arc", "depth"):
            fields[f"{name}_{member}"] = ordered(teeth, name, "member", "lengthwise", "profile")[one]
        direction = ordered(teeth, "shell_direction", "member", "lengthwise", "profile", "shell_axis")
        fields[f"shell_direction_{member}"] = direction[one]
    return fields


def member_points(splines: FlankSplines, member: str, points: Array) -> Array:
    """Lengthwise and profile fractions (2, ...) on one member of points (2, ...) on the gear."""
    if member == "gear":
        return points
    return np.stack(list(splines.evaluate(["pinion_lengthwise", "pinion_profile"], points).values()))


def unit_loads(
    elastic: tuple[ElasticTooth, ElasticTooth], splines: FlankSplines, points: tuple[Array, Array], weights: Array
) -> tuple[list[Array], Array]:
    """Unit loads on segments: Y (n, k) of both members, and (n, q) in the modes of both bodies, the pinion's first.

    The sum of Y Y^T is the compliance [mm/N] on one tooth pair, but for the shared bodies (Kolivand 2009, Eq. 3.11).
    Points (2, n, g) are fractions on the gear; the weights (g) add up to one.
    """
    tooth_loads, on_bodies = [], []
    for member, tooth, at in zip(MEMBERS, elastic, points, strict=True):
        if isinstance(tooth, FlankCompliance):
            whitened, on_body = tooth.unit_loads(member_points(splines, member, at), weights)
            tooth_loads.append(whitened)
            on_bodies.append(on_body)
            continue
        names = [f"{name}_{member}" for name in ("shell_height", "shell_arc", "shell_direction")]
        height, arc, direction = splines.evaluate(names, at).values()
        # The foot of a normal near the end of the tooth can lie beyond it, where the trial functions mean nothing.
        arc = np.clip(arc, 0.0, tooth.dimensions.trace_length)
        tooth_loads.append(tooth.whitened_mid_surface_loads(height, arc, np.moveaxis(direction, 0, -1), weights))
    return tooth_loads, np.concatenate([np.empty((points[0].shape[1], 0)), *on_bodies], axis=1)


def body_coupling(elastic: tuple[ElasticTooth, ElasticTooth]) -> BodyCoupling | None:
    """Coupling of tooth pairs through the bodies of both members; ``None`` if every tooth has a body of its own."""
    bodies = [tooth.body if isinstance(tooth, FlankCompliance) else None for tooth in elastic]
    ways = zip(bodies, PITCHES_PER_PAIR, strict=True)
    known = [(body.coupling, pitches) for body, pitches in ways if body is not None]
    return BodyCoupling(tuple(known)) if known else None


@record(frozen=True)
class Loads:
    """Unit loads on segments (n).

    Inner products of the rows of ``on_teeth``, summed over its parts, are bending compliances on one tooth pair [mm/N].
    """

    on_teeth: tuple[Array, ...]  # (n, k) each; one array would take longer to fill than to use
    on_bodies: Array


@record(frozen=True)
class UnitLoads:
    """Unit loads on both teeth, and the bodies through which tooth pairs are coupled."""

    on_lines: Loads
    on_edges: Loads | None = None  # (m), numbered after the segments of lines
    coupling: BodyCoupling | None = None  # None if each tooth has a body of its own
    #: blocks of segments of lines by their numbers, for the next mesh
    known: dict[bytes, Array] = field(default_factory=dict, repr=False, compare=False)

    def with_edges(self, on_edges: Loads) -> UnitLoads:
        """The same contact lines with pieces of edges."""
        return replace(self, on_edges=on_edges)

    def bending(self, pairs: Integers, rows: Integers) -> ModalBasis:
        """Bending compliance of the segments (s) of a mesh position; ``rows`` number those on lines before edges."""
        numbers = np.unique(pairs)
        blocks = [np.flatnonzero(pairs == pair) for pair in numbers]
        shared = None
        if self.coupling is not None:
            shared = self.coupling.shared_modes(numbers, blocks, self._rows(rows, lambda loads: (loads.on_bodies,)))
        return basis_of_blocks(pairs.size, blocks, [self._compressed(rows[block]) for block in blocks], shared)

    def _compressed(self, rows: Integers) -> Array:
        """Modes of one tooth pair with the segments of given numbers (s)."""
        key = rows.tobytes()
        if key in self.known:
            return self.known[key]
        compressed = compressed_block(self._rows(rows, lambda loads: loads.on_teeth))
        if np.all(rows < len(self.on_lines.on_bodies)):
            self.known[key] = compressed
        return compressed

    def _rows(self, rows: Integers, parts: Callable[[Loads], tuple[Array, ...]]) -> Array:
        """Rows of given numbers (s), those on lines first, of parts of the loads side by side."""
        lines = parts(self.on_lines)
        count = int(np.count_nonzero(rows < len(lines[0])))
        result = np.empty((rows.size, sum(part.shape[1] for part in lines)))
        np.concatenate([part[rows[:count]] for part in lines], axis=1, out=result[:count])
        if count < rows.size:
            assert self.on_edges is not None
            beyond = rows[count:] - len(lines[0])
            np.concatenate([part[beyond] for part in parts(self.on_edges)], axis=1, out=result[count:])
        return result
