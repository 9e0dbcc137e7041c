"""Surface patches as a STEP file: B-spline faces through every point, sewn along their common borders.

Patches are checked and turned so that all of them look outwards. A patch is an array (m, n, 3) [mm]. Neighbouring
patches share the points of their common border. The derivative along the first index times the derivative along the
second one is the patch's normal.
"""

from __future__ import annotations

import contextlib
import io
import os
from collections import defaultdict, deque
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

import numpy as np

from ...core.arrays import Array
from ...core.checks import array, file_path, instance, number, whole
from ...core.errors import InputError, MissingPackageError, how_to_install
from ...core.output_file import whole_file

COPY_COUNT_LIMIT = 1000  # of a tooth; no gear has more
NO_AREA = 1e-6  # [mm^2]
SAME_POINT = 1e-6  # [mm]; far below any tolerance of a drawing, far above rounding


def checked(patches: Mapping[str, Array]) -> dict[str, Array]:
    """Patches as float arrays; those that are no grid of finite points or have no area are refused."""
    instance("patches", patches, Mapping)
    if not patches:
        raise InputError("no surface patches to write")
    result = {}
    for name, points in patches.items():
        instance("name of a patch", name, str)
        grid = array(f"patch {name!r}", points, "mm", anything=True)
        if grid.ndim != 3 or grid.shape[2] != 3 or min(grid.shape[:2]) < 2:
            raise InputError(f"patch {name!r} has the shape {grid.shape}: must be (m, n, 3) with m and n at least 2")
        if not np.all(np.isfinite(grid)):
            raise InputError(f"patch {name!r} has points that are no finite numbers: a surface has no holes")
        diagonals = grid[1:, 1:] - grid[:-1, :-1], grid[1:, :-1] - grid[:-1, 1:]
        if 0.5 * np.sum(np.linalg.norm(np.cross(*diagonals), axis=-1)) < NO_AREA:
            raise InputError(f"patch {name!r} has no area: leave it out")
        result[name] = grid
    return result


def merged(points: Array) -> tuple[Array, Array]:
    """Different points (k, 3) [mm] of (n, 3), and the number (n) of the one that each point became."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(points).query_pairs(SAME_POINT, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points)))
    _, label = connected_components(graph, directed=False)
    _, first, numbers = np.unique(label, return_index=True, return_inverse=True)
    return points[first], numbers


def oriented(patches: Mapping[str, Array]) -> dict[str, Array]:
    """Patches whose normals agree across every common border; refused if they cannot.

    The first patch of every connected group is kept; others are turned by reversing their first index.
    """
    grids = checked(patches)
    _, numbers = merged(np.concatenate([grid.reshape(-1, 3) for grid in grids.values()]))
    # Who runs along which piece of border, and in which sense.
    users: dict[tuple[int, int], list[tuple[str, int]]] = defaultdict(list)
    start = 0
    for name, grid in grids.items():
        m, n = grid.shape[:2]
        border = _border(numbers[start : start + m * n].reshape(m, n))
        start += m * n
        for a, b in zip(border, np.roll(border, -1), strict=True):
            if a != b:
                users[(min(a, b), max(a, b))].append((name, 1 if a < b else -1))
    neighbours: dict[str, list[tuple[str, int]]] = defaultdict(list)
    for along in users.values():
        for (one, sense), (other, other_sense) in combinations(along, 2):
            neighbours[one].append((other, -sense * other_sense))
            neighbours[other].append((one, -sense * other_sense))
    turn: dict[str, int] = {}
    for name in grids:
        if name in turn:
            continue
        turn[name] = 1
        queue = deque([name])
        while queue:
            current = queue.popleft()
            for other, agreement in neighbours[current]:
                if other not in turn:
                    turn[other] = turn[current] * agreement
                    queue.append(other)
                elif turn[other] != turn[current] * agreement:
                    raise InputError(
                        f"patches {current!r} and {other!r} share a border, but cannot both look outwards: the surface "
                        "has one side only, or more than two patches meet there"
                    )
    return {name: grid if turn[name] > 0 else grid[::-1] for name, grid in grids.items()}


def rotations(teeth: int, pitch: float | None) -> Array:
    """Angles [rad] of the copies of a tooth about the axis; without a pitch [rad] spread over the whole turn."""
    count = whole("teeth", teeth, 1, COPY_COUNT_LIMIT)
    return np.arange(count) * (2.0 * np.pi / count if pitch is None else number("pitch", pitch, "rad"))


def _border(grid: Array) -> Array:
    """Numbers of the border's points, round once in the sense of the normal."""
    return np.concatenate([grid[:-1, 0], grid[-1, :-1], grid[:0:-1, -1], grid[0, :0:-1]])


SUFFIXES = (".step", ".stp")
SEWING_TOLERANCE = 1e-5  # [mm]; common borders are the same curve, so this only has to exceed rounding
DEGENERATE_LENGTH = 1e-7  # [mm]; a border shorter than this is a point


def write_step(
    patches: Mapping[str, Array],
    path: str | os.PathLike[str],
    *,
    teeth: int = 1,
    pitch: float | None = None,
    name: str = "tooth",
) -> None:
    """Write the patches of a tooth as B-spline faces (STEP AP214, mm).

    Each face goes through every point of its patch; between them it is the cubic spline in the point numbers, so that
    neighbouring patches have the same curve along their common border. Every face carries the name of its patch.
    Further teeth are references to the first one, turned about the z axis.

    Parameters
    ----------
    patches
        Points (m, n, 3) [mm] by name, smoothly spaced along both indices; the first patch of every connected group
        looks outwards, see ``patches``.
    path
        A ``.step`` or ``.stp`` file, replaced if it exists. It appears complete or not at all.
    teeth
        Number of copies of the tooth.
    pitch
        Angle between them [rad]; ``None`` to spread them over the whole turn.
    name
        Name of the product.

    Raises
    ------
    InputError
        If a patch is no grid of points, the suffix is another one, or the file cannot be written.
    MissingPackageError
        If OpenCASCADE is not installed.

    Examples
    --------
    The whole tooth of a gear, where OpenCASCADE is installed:

    >>> import tempfile
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import tooth_patches
    >>> patches = tooth_patches(gear_pair(read_case("nasa-12x36")), "gear", (5, 5))
    >>> with tempfile.TemporaryDirectory() as folder, contextlib.suppress(MissingPackageError):
    ...     write_step(patches, f"{folder}/gear.step")
    """
    if file_path("path", path).suffix.lower() not in SUFFIXES:
        raise InputError(f"path = {path}: must end in {' or '.join(SUFFIXES)}")
    instance("name", name, str)
    angles = rotations(teeth, pitch)
    surfaces = oriented(patches)
    require_opencascade()
    content = _step(surfaces, angles, name)
    with whole_file(path) as temporary:
        temporary.write_bytes(content)


def require_opencascade() -> None:
    """Refuse before any work a STEP file without a usable OpenCASCADE (MissingPackageError)."""
    try:
        import OCP.collections
        import OCP.STEPControl  # noqa: F401
    except ModuleNotFoundError as error:
        raise MissingPackageError(
            f"STEP files need OpenCASCADE with Python bindings of version 8: {how_to_install('easeoff[cad]')}"
        ) from error
    except ImportError as error:
        # An interrupted extension module says that its initialization failed, and keeps the reason as the cause.
        if isinstance(error.__cause__, KeyboardInterrupt):
            raise error.__cause__ from None
        raise MissingPackageError(
            f"STEP files need OpenCASCADE, which is installed but does not load: {error}"
        ) from error


def spline(points: Array) -> tuple[Array, list[Array], tuple[int, int]]:
    """Poles (m, n, 3) [mm], knots and degrees of the tensor-product spline through a grid (m, n, 3) [mm].

    Parameters are the point numbers; knots come with their repetitions (m + degree + 1) and (n + degree + 1); degrees
    are 3, or less where there are fewer than 4 points.
    """
    from scipy.interpolate import make_interp_spline

    poles, knots, degrees = points, [], []
    for axis in (0, 1):
        count = points.shape[axis]
        degree = min(3, count - 1)
        curve = make_interp_spline(np.linspace(0.0, 1.0, count), poles, k=degree, axis=axis)
        poles = np.moveaxis(curve.c, 0, axis)  # scipy keeps the spline's own axis first
        knots.append(curve.t)
        degrees.append(degree)
    return poles, knots, (degrees[0], degrees[1])


def _surface(points: Array) -> Any:
    from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    poles, knots, degrees = spline(points)
    m, n = points.shape[:2]
    net = Array2_gp_Pnt(1, m, 1, n)
    for i in range(m):
        for j in range(n):
            net.SetValue(i + 1, j + 1, gp_Pnt(*poles[i, j].tolist()))
    values, repetitions = [], []
    for sequence in knots:
        unique, counts = np.unique(sequence, return_counts=True)
        value, repetition = Array1_double(1, unique.size), Array1_int(1, unique.size)
        for i in range(unique.size):
            value.SetValue(i + 1, float(unique[i]))
            repetition.SetValue(i + 1, int(counts[i]))
        values.append(value)
        repetitions.append(repetition)
    return Geom_BSplineSurface(net, *values, *repetitions, *degrees)


def _step(patches: Mapping[str, Array], angles: Array, name: str) -> bytes:
    """The content of the file."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS_Compound

    sewing = BRepBuilderAPI_Sewing(SEWING_TOLERANCE)
    surfaces = {patch: _surface(points) for patch, points in patches.items()}
    faces = {patch: BRepBuilderAPI_MakeFace(s, DEGENERATE_LENGTH).Face() for patch, s in surfaces.items()}
    for face in faces.values():
        sewing.Add(face)
    sewing.Perform()
    tooth = sewing.SewedShape()
    shape, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(shape)
    for angle in angles:
        turn = gp_Trsf()
        turn.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), float(angle))
        # A turn by zero is a location of its own for OpenCASCADE, under which the faces are not found again.
        builder.Add(shape, tooth.Moved(TopLoc_Location(turn)) if angle != 0.0 else tooth)

    stream = io.BytesIO()
    with _silent():
        writer = STEPControl_Writer()
        if writer.Transfer(shape, STEPControl_AsIs) != IFSelect_RetDone:
            raise InputError("OpenCASCADE cannot make a STEP model of these patches: check that they are surfaces")
        sewn = {patch: sewing.Modified(face) if sewing.IsModified(face) else face for patch, face in faces.items()}
        _set_names(writer, sewn, name)
        if writer.WriteStream(stream) != IFSelect_RetDone:
            raise InputError("OpenCASCADE cannot write these patches as STEP")
    return stream.getvalue()


def _set_names(writer: Any, faces: Mapping[str, Any], name: str) -> None:
    """Name the product and the faces."""
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.StepBasic import StepBasic_Product
    from OCP.STEPConstruct import STEPConstruct
    from OCP.TCollection import TCollection_HAsciiString

    finder = writer.WS().TransferWriter().FinderProcess()
    for patch, face in faces.items():
        entity = STEPConstruct.FindEntity_s(finder, face)
        if entity is not None:
            entity.SetName(TCollection_HAsciiString(patch))
    model = writer.Model()
    for i in range(1, model.NbEntities() + 1):
        entity = model.Value(i)
        if isinstance(entity, StepBasic_Product):
            entity.SetId(TCollection_HAsciiString(name))
            entity.SetName(TCollection_HAsciiString(name))
    header = APIHeaderSection_MakeHeader(model)
    header.SetName(TCollection_HAsciiString(name))
    header.SetOriginatingSystem(TCollection_HAsciiString("easeoff"))


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Keep OpenCASCADE's progress messages off the standard output."""
    from OCP.Message import Message, Message_Gravity

    printers = list(Message.DefaultMessenger_s().Printers())
    levels = [printer.GetTraceLevel() for printer in printers]
    for printer in printers:
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    try:
        yield
    finally:
        for printer, level in zip(printers, levels, strict=True):
            printer.SetTraceLevel(level)
