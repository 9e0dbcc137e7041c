"""Finite elements of generated teeth: cost, convergence, and the shell beside them. Prints Markdown tables.

``python benchmarks/finite_elements.py [cost] [shell] [body] [split] [figure] [reference]``: all of them if none is
named. The last one writes what ``tests/test_solid_shell.py`` compares with.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import resource
import sys
import time
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.polynomial import legendre
from scipy.sparse import csc_array
from tabulate import tabulate

from easeoff.cases import gear_pair, read_case
from easeoff.cases.conversion import elastic_model
from easeoff.contact.bending import STEEL, ElasticModel, shells
from easeoff.contact.compliance import ElasticFoundation, Shell, ToothDimensions
from easeoff.contact.compliance.finite_elements.body import ElasticBody, elastic_body, functionals
from easeoff.contact.compliance.finite_elements.condensed import (
    FlankCompliance,
    flank_loads,
    flank_shares,
    foot_displacements,
    square_root,
)
from easeoff.contact.compliance.finite_elements.members import solid_shell_size, solid_shell_tooth, usual_size
from easeoff.contact.compliance.finite_elements.solid_shell import SolidShell, solid_shell
from easeoff.contact.loaded import loaded_contact, loaded_fields
from easeoff.contact.segments import lines_in_mesh
from easeoff.core.files import whole_file
from easeoff.geometry import GearPair, pair_geometry
from easeoff.geometry.pair import bodies
from easeoff.geometry.tooth_flanks import named_member
from easeoff.geometry.tooth_lattice import LatticeSize, ToothLattice, tooth_lattice, usual_depth

CASES = ("fm-11x41", "fh-12x41-45")
MEMBERS = ("pinion", "gear")
REFERENCE = Path(__file__).parents[1] / "tests" / "data" / "finite_element_teeth.npz"
IMAGE = Path(__file__).parents[1] / "docs" / "images" / "free_edge.png"
PATCH = 2.0  # [mm]
# Of about the height and thickness that the deflections of figure 3.4 call for; length and radius are the thesis's.
SLIM = ToothDimensions(45.0, 114.3, 10.0, 12.0, 5.0, 6.0, 2.0, 2.0)
FORCE = 500.0  # [N]


@dataclass
class Tooth:
    """A solved tooth: compliance between patches, free-edge deflection of a force at mid face and mid height."""

    lattice: ToothLattice
    dofs: int
    matrix: np.ndarray
    edge: np.ndarray
    seconds: dict[str, float]
    begun: float


@cache
def pair_of(name: str) -> GearPair:
    """A shipped pair."""
    return gear_pair(read_case(name))


def patches(name: str, member: str, along: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Quadrature points (2, n, 9) of square patches on the flank, weights, and positions with normals (2, 3, n 9)."""
    one = named_member(pair_of(name), member)
    t, h = (a.ravel() for a in np.meshgrid(along, up, indexing="ij"))
    step = 1e-3

    def flank(t: np.ndarray, h: np.ndarray) -> np.ndarray:
        from easeoff.geometry.flank_surface import solve_flank

        found = solve_flank(one.loaded, one.section, *one.section.points(t, h))
        return np.stack([found.position, found.normal])

    here = flank(t, h)[0]
    sizes = [np.linalg.norm(flank(t + step * a, h + step * (1 - a))[0] - here, axis=0) / step for a in (1, 0)]
    x, w = np.polynomial.legendre.leggauss(3)
    a, b = (g.ravel() for g in np.meshgrid(x, x, indexing="ij"))
    points = np.stack(
        [t[:, None] + 0.5 * PATCH / sizes[0][:, None] * a, h[:, None] + 0.5 * PATCH / sizes[1][:, None] * b]
    )
    return points, np.outer(w, w).ravel() / 4.0, flank(points[0].ravel(), points[1].ravel())


GRID = (np.linspace(0.1, 0.9, 5), np.linspace(0.15, 0.85, 4))
MIDDLE = (np.array([0.5]), np.array([0.5]))


@cache
def tooth(name: str, member: str, size: LatticeSize | None = None, depth: float | None = None) -> Tooth:
    """Solve one tooth by finite elements."""
    pair = pair_of(name)
    start = time.process_time()
    lattice = tooth_lattice(pair, member, size or usual_size(pair, member), depth)
    made = time.process_time()
    body = elastic_body(lattice.nodes, lattice.cells, lattice.held, STEEL)
    solved = measured(name, member, lattice, body, foot_displacements(lattice), body.free.size)
    return replace(
        solved, seconds=solved.seconds | {"lattice": made - start, "assembly and factor": solved.begun - made}
    )


@cache
def reference(name: str, member: str) -> Tooth:
    """The tooth on the finest lattice."""
    usual = usual_size(pair_of(name), member)
    finest = replace(usual, upward=7, through=usual.through + 2, slot=3, lengthwise=usual.lengthwise + 8)
    return tooth(name, member, finest)


@cache
def solid_tooth(name: str, member: str, fineness: float = 1.0) -> Tooth:
    """Solve one tooth as a solid shell."""
    pair = pair_of(name)
    start = time.process_time()
    size, counts = solid_shell_size(pair, member, fineness)
    lattice = tooth_lattice(pair, member, size)
    made = time.process_time()
    shell = solid_shell(lattice, STEEL, counts)
    solved = measured(
        name, member, lattice, shell, foot_displacements(lattice, in_tooth=True), 3 * int(np.prod(counts))
    )
    return replace(
        solved, seconds=solved.seconds | {"lattice": made - start, "assembly and factor": solved.begun - made}
    )


def measured(
    name: str, member: str, lattice: ToothLattice, body: ElasticBody | SolidShell, feet: csc_array, unknowns: int
) -> Tooth:
    """What is compared, of a factored tooth."""
    begun = time.process_time()
    loads = flank_loads(lattice)
    factor = square_root(body.response(loads, feet))
    seconds = {"solves": time.process_time() - begun}

    def shares(which: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        points, weights, _ = patches(name, member, *which)
        result = np.zeros((lattice.profile.size, points.shape[1]))
        for k in range(points.shape[1]):
            nodes, share = flank_shares(lattice.lengthwise, lattice.profile, points[:, k])
            np.add.at(result[:, k], nodes.ravel(), (share * weights[:, None]).ravel())
        return result

    on_grid = factor @ shares(GRID)
    edge = FORCE * body.response(csc_array(loads @ csc_array(shares(MIDDLE))), free_edge(lattice))[:, 0]
    return Tooth(lattice, unknowns, on_grid.T @ on_grid, edge, seconds, begun)


def free_edge(lattice: ToothLattice) -> csc_array:
    """Displacement of the middle of the tip, across the tooth away from the load, at every section."""
    middle = lattice.column[:, lattice.column.shape[1] // 2]
    surface = lattice.nodes[middle]
    normal = np.cross(np.gradient(surface[:, -1], axis=0), surface[:, -1] - surface[:, -3])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    normal *= -np.sign(np.sum(normal * lattice.flank_normal[:, -1], axis=1))[:, None]
    return functionals(len(lattice.nodes), middle[:, -1:], np.ones((len(normal), 1)), normal)


def shell_of(name: str, member: str, model: ElasticModel, lengthwise: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compliance between the same patches, and deflection of the free edge, of the shell."""
    which = MEMBERS.index(member)
    body = bodies(pair_of(name))[which]
    shell = shells(pair_geometry(pair_of(name), (7, 7)).teeth, model)[which]

    def vectors(where: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        points, weights, flank = patches(name, member, *where)
        found, shape = body.shell_coordinates(*flank), points.shape[1:]
        arc = np.clip(found.arc, 0.0, body.trace_length).reshape(shape)
        direction = np.moveaxis(found.direction.reshape(3, *shape), 0, -1)
        return shell.whiten(shell.load_vectors(found.height.reshape(shape), arc, direction, weights))

    grid, middle = vectors(GRID), vectors(MIDDLE)
    arc = legendre.legval(2 * lengthwise - 1, body.trace_arc) - legendre.legval(-1.0, body.trace_arc)
    outward = np.zeros((arc.size, 3))
    outward[:, 2] = -1.0 if body.convex else 1.0
    edge = shell.whiten(shell.load_vectors(shell.dimensions.height(arc), np.clip(arc, 0, body.trace_length), outward))
    return grid.T @ grid, FORCE * (edge.T @ middle)[:, 0]


def difference(matrix: np.ndarray, edge: np.ndarray, other: Tooth) -> list[float]:
    """Peak of the free edge, whole matrix, uniform load [%]."""
    return [
        100.0 * (edge.max() / other.edge.max() - 1.0),
        100.0 * np.linalg.norm(matrix - other.matrix) / np.linalg.norm(other.matrix),
        100.0 * (matrix.sum() / other.matrix.sum() - 1.0),
    ]


HEAD = ("free edge %", "matrix %", "uniform load %")


def at_200_points(one: Tooth) -> float:
    """CPU time for 200 points of the flank [s]."""
    seconds = one.seconds
    return seconds["lattice"] + seconds["assembly and factor"] + seconds["solves"] * 200 / one.lattice.flank.size


def cost() -> None:
    """Convergence and cost."""
    rows = []
    for name in CASES:
        for member in MEMBERS:
            usual = usual_size(pair_of(name), member)
            for label, size in (("half", usual.finer(0.5)), ("0.7", usual.finer(0.7)), ("usual", usual)):
                one = tooth(name, member, size)
                numbers = difference(one.matrix, one.edge, reference(name, member))
                rows.append([name, member, label, one.dofs, one.lattice.flank.size, *numbers, at_200_points(one)])
            best = reference(name, member)
            rows.append([name, member, "reference", best.dofs, best.lattice.flank.size, 0, 0, 0, ""])
    print(tabulate(rows, ["case", "member", "bricks", "unknowns", "points", *HEAD, "CPU s for 200"], "github", ".1f"))
    print(f"largest memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB")


def shell() -> None:
    """The shell against finite elements, per tooth and choice."""
    models = {
        "Weber (default)": ElasticModel(),
        "Weber, fitted plate": ElasticModel(plate="fitted"),
        "0.8 O'Donnell, fitted plate": ElasticModel(plate="fitted", foundation=ElasticFoundation("odonnell", 0.8)),
        "0.8 O'Donnell": ElasticModel(foundation=ElasticFoundation("odonnell", 0.8)),
        "clamped": ElasticModel(foundation=None),
        "thesis form, clamped": ElasticModel(form="thesis", foundation=None),
    }
    rows = []
    for name in CASES:
        for member in MEMBERS:
            best = reference(name, member)
            for fineness in (0.7, 1.0, 1.4):
                one = solid_tooth(name, member, fineness)
                label = "solid shell" + ("" if fineness == 1.0 else f", fineness {fineness}")
                numbers = difference(one.matrix, one.edge, best)
                rows.append([name, member, label, one.dofs, *numbers, sum(one.seconds.values())])
            for label, model in models.items():
                teeth = pair_geometry(pair_of(name), (7, 7)).teeth
                start = time.process_time()
                shells(teeth, model)
                seconds = 0.5 * (time.process_time() - start)
                matrix, edge = shell_of(name, member, model, best.lattice.lengthwise)
                dofs = model.modes[0] * model.modes[1] * (3 if model.form == "thesis" else 5)
                rows.append([name, member, label, dofs, *difference(matrix, edge, best), seconds])
    print(tabulate(rows, ["case", "member", "shell", "unknowns", *HEAD, "CPU s"], "github", "+.1f"))


def write_reference() -> None:
    """Compliance between the patches and largest deflection of the free edge, of all teeth on the finest lattice."""
    arrays = {}
    for name in CASES:
        for member in MEMBERS:
            best = reference(name, member)
            of_grid, of_middle = (patches(name, member, *where)[:2] for where in (GRID, MIDDLE))
            found = {"matrix": best.matrix, "edge": best.edge.max(), "patches": of_grid[0], "middle": of_middle[0]}
            arrays |= {f"{name} {member} {key}": value for key, value in found.items()} | {"weights": of_grid[1]}
    with whole_file(REFERENCE) as temporary, open(temporary, "wb") as stream:
        np.savez_compressed(stream, **arrays)


def body() -> None:
    """What the depth of the body does, and where it ends beyond toe and heel."""
    rows = []
    for name in CASES:
        for member in MEMBERS:
            one = tooth(name, member)
            depth = usual_depth(named_member(pair_of(name), member).section)
            bodies_ = {f"{factor * depth:.1f} mm deep": (None, factor * depth) for factor in (0.5, 2.0)}
            bodies_["ends flush with the tooth"] = (replace(usual_size(pair_of(name), member), overhang=0), None)
            for label, (size, own_depth) in bodies_.items():
                other = tooth(name, member, size, own_depth)
                rows.append([name, member, label, *difference(other.matrix, other.edge, one)])
    print(tabulate(rows, ["case", "member", "body", *HEAD], "github", "+.1f"))


def split() -> None:
    """What the choices of the split do to the loaded contact."""
    rows = []
    for name in CASES:
        case, pair = read_case(name), pair_of(name)
        geometry = pair_geometry(pair, (case.contact.lengthwise_nodes, case.contact.profile_nodes))
        fields = loaded_fields(geometry.flanks, geometry.ease_off, geometry.teeth)
        mesh = lines_in_mesh(fields, pair.assembly.pinion_pitch, case.contact.mesh_positions)
        kernels: dict[str, list[FlankCompliance]] = {"foot": [], "same": [], "flank": []}
        for member in MEMBERS:
            lattice = tooth_lattice(pair, member, usual_size(pair, member))
            solved = elastic_body(lattice.nodes, lattice.cells, lattice.held, STEEL)
            loads, count = flank_loads(lattice), len(lattice.nodes)
            across = lattice.column[:, lattice.column.shape[1] // 2, lattice.root_row :].reshape(-1, 1)
            inward = -lattice.flank_normal.reshape(-1, 3)
            for label, wanted in (
                ("foot", foot_displacements(lattice)),
                ("same", functionals(count, across, np.ones(across.shape), inward)),
                ("flank", loads),
            ):
                factor = square_root(solved.response(loads, wanted))
                kernels[label].append(FlankCompliance(lattice.lengthwise, lattice.profile, factor))
            kernels.setdefault("solid", []).append(solid_shell_tooth(pair, member, STEEL).flank)
        base = elastic_model(case)
        same_height = geometry.teeth.copy(deep=True)
        same_height["shell_height"] = _own_height(pair, geometry)
        rim = ElasticFoundation("odonnell", 0.8)
        with_elements = {k: replace(base, condensed=tuple(v)) for k, v in kernels.items()}
        variants = [
            ("finite elements, foot of the normal", with_elements["foot"], None),
            ("the same + 0.14 q (1 - nu^2) / E", replace(with_elements["foot"], foot_correction=0.14), None),
            ("finite elements, straight across", with_elements["same"], None),
            ("finite elements, the flank itself (counts twice)", with_elements["flank"], None),
            ("solid shell, foot of the normal", with_elements["solid"], None),
            ("shell, foot of the normal (default)", base, None),
            ("shell, fitted plate", replace(base, plate="fitted"), None),
            ("shell, fitted plate, 0.8 O'Donnell", replace(base, plate="fitted", foundation=rim), None),
            ("shell, same height", base, same_height),
            ("shell, clamped", replace(base, foundation=None), None),
        ]
        for label, model, teeth in variants:
            splines = fields if teeth is None else loaded_fields(geometry.flanks, geometry.ease_off, teeth)
            loaded, _ = loaded_contact(
                splines,
                geometry.teeth,
                mesh,
                ratio=pair.assembly.ratio,
                torques=np.array(case.contact.torques),
                model=model,
                segments_per_line=case.contact.segments_per_line,
            )
            last = loaded.isel(torque=-1)
            numbers = [float(last[n]) for n in ("mean_level", "peak_to_peak", "max_pressure")]
            rows.append([name, float(last["torque"]), label, *numbers])
    print(tabulate(rows, ["case", "N m", "model", "mean urad", "peak to peak urad", "pressure MPa"], "github", ".1f"))


def _own_height(pair: GearPair, geometry: object) -> object:
    """Height of the contact points themselves above the root cone, as ``shell_height``."""
    teeth = geometry.teeth  # type: ignore[attr-defined]
    heights = teeth["shell_height"].copy(deep=True)
    grid = [g.ravel() for g in np.meshgrid(teeth["lengthwise"], teeth["profile"], indexing="ij")]
    gear = pair.gear.section
    heights.loc[{"member": "gear"}] = gear.height_above_root(*gear.points(*grid)).reshape(heights.shape[1:])
    ease_off = geometry.ease_off  # type: ignore[attr-defined]
    on_pinion = [ease_off[n].values.ravel() for n in ("pinion_lengthwise", "pinion_profile")]
    pinion = pair.pinion.section
    heights.loc[{"member": "pinion"}] = pinion.height_above_root(*pinion.points(*on_pinion)).reshape(heights.shape[1:])
    return heights


def slim_tooth(bricks: tuple[int, int, int] = (30, 8, 4)) -> tuple[np.ndarray, np.ndarray, float]:
    """Free edge of ``SLIM`` by finite elements, clamped, a radial force on 2 x 2 mm in the middle of its outer side.

    Returns places along the free edge from 0 to 1, deflections [mm], and CPU time [s].
    """
    start = time.process_time()
    places = [np.linspace(0.0, 1.0, 2 * n + 1) for n in bricks]
    t, up, through = np.meshgrid(*places, indexing="ij")
    y = t * SLIM.trace_length
    x = up * SLIM.height(y)
    radius = SLIM.trace_radius + (through - 0.5) * SLIM.thickness(x, y)
    turn = y / SLIM.trace_radius
    nodes = np.stack([radius * np.cos(turn), radius * np.sin(turn), x], axis=-1).reshape(-1, 3)
    number = np.arange(t.size).reshape(t.shape)
    cells = np.lib.stride_tricks.sliding_window_view(number, (3, 3, 3))[::2, ::2, ::2].reshape(-1, 3, 3, 3)
    if np.linalg.det(nodes[cells[0, [2, 0, 0], [0, 2, 0], [0, 0, 2]]] - nodes[cells[0, 0, 0, 0]]) < 0.0:
        cells = cells[:, ::-1]
    body = elastic_body(nodes, np.ascontiguousarray(cells), number[:, 0].ravel(), STEEL)
    outward = np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=-1)
    point, weight = np.polynomial.legendre.leggauss(5)
    length, height = SLIM.trace_length, float(SLIM.height(0.5 * SLIM.trace_length))
    patch = [0.5 + 0.5 * PATCH / size * point for size in (length, height)]
    points = np.stack([a.ravel() for a in np.meshgrid(*patch, indexing="ij")])
    known, share = flank_shares(places[0], np.tile(places[1], (places[0].size, 1)), points)
    share = share * np.outer(weight, weight).reshape(-1, 1) / 4.0
    side, normal = number[:, :, -1].ravel(), outward[:, :, -1].reshape(-1, 3)
    load = functionals(len(nodes), side[known].reshape(1, -1), share.reshape(1, -1), normal[known].reshape(1, -1, 3))
    tip, middle = number[:, -1, bricks[2]], outward[:, -1, bricks[2]]
    edge = FORCE * body.response(load, functionals(len(nodes), tip[:, None], np.ones((tip.size, 1)), middle))[:, 0]
    return places[0], edge, time.process_time() - start


def slim_shell(modes: tuple[int, int], along: np.ndarray) -> tuple[np.ndarray, float]:
    """Free edge [mm] of the same tooth as the dissertation's clamped shell, and CPU time [s]."""
    start = time.process_time()
    tooth_ = Shell(SLIM, STEEL, modes, form="thesis")
    point, weight = np.polynomial.legendre.leggauss(5)
    y = (0.5 * SLIM.trace_length + 0.5 * PATCH * point)[:, None]
    x = 0.5 * SLIM.height(y) + 0.5 * PATCH * point
    radial = np.array([0.0, 0.0, 1.0])
    y, weights = np.broadcast_to(y, x.shape).ravel(), np.outer(weight, weight).ravel() / 4.0
    load = tooth_.whiten(tooth_.load_vectors(x.ravel(), y, radial, weights)[None])
    arc = along * SLIM.trace_length
    edge = tooth_.whiten(tooth_.load_vectors(SLIM.height(arc), arc, radial))
    return FORCE * (edge.T @ load)[:, 0], time.process_time() - start


def figure() -> None:
    """The free edge of a tooth under one force, shell with more and more modes and finite elements (fig 3.4)."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, (slim, real) = plt.subplots(1, 2, figsize=(10, 3.6))
    rows: list[list[object]] = []

    def shown(axis: object, label: str, place: np.ndarray, edge: np.ndarray, seconds: float, style: str) -> None:
        axis.plot(place, 1e3 * edge, style, label=label)  # type: ignore[attr-defined]
        rows.append([label, f"{1e3 * edge.max():.3f}", edge.max(), f"{1e3 * edge.min():+.3f}", f"{seconds:.3f}"])

    def table(title: str) -> None:
        for row in rows:
            row[2] = f"{100.0 * float(row[2]) / float(rows[-1][2]):.1f}" if row is not rows[-1] else "100.0"
        print(title, tabulate(rows, ["teeth", "peak um", "of FE %", "lowest um", "CPU s"], "github"), sep="\n")
        rows.clear()

    place, best, seconds = slim_tooth()
    for modes in ((5, 3), (5, 5), (5, 9), (5, 15)):
        edge, own = slim_shell(modes, place)
        shown(slim, f"shell {modes[0]} x {modes[1]}", place, edge, own, "--")
    shown(slim, "finite elements", place, best, seconds, "k")
    table("slim tooth, clamped, thesis form")

    name, member = "fm-11x41", "gear"
    one = tooth(name, member)
    along = one.lattice.lengthwise
    for modes in ((5, 3), (5, 5), (5, 9), (5, 15)):
        start = time.process_time()
        model = ElasticModel(modes=modes, foundation=ElasticFoundation("odonnell", 0.8))
        _, edge = shell_of(name, member, model, along)
        shown(real, f"shell {modes[0]} x {modes[1]}", along, edge, time.process_time() - start, "--")
    solid = solid_tooth(name, member)
    shown(real, "solid shell", solid.lattice.lengthwise, solid.edge, sum(solid.seconds.values()), "-.")
    shown(real, "finite elements", along, one.edge, sum(one.seconds.values()), "k")
    table("generated gear tooth of fm-11x41 on its body")
    slim.set(xlabel="along the face", ylabel="free-edge deflection, um", title="slim tooth, clamped; thesis form")
    real.set(xlabel="along the face", title="gear of fm-11x41; root springs, body")
    for axis in (slim, real):
        axis.legend(fontsize=8)
    plt.tight_layout()
    plt.savefig(IMAGE, dpi=110)


if __name__ == "__main__":
    parts = {
        "cost": cost,
        "shell": shell,
        "body": body,
        "split": split,
        "figure": figure,
        "reference": write_reference,
    }
    for part in sys.argv[1:] or parts:
        parts[part]()
        print()
