"""The free edge of a tooth under one force (Kolivand 2009, Fig. 3.4): a part of the benchmark of finite elements."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from finite_element_teeth import FORCE, MEMBERS, PATCH, Array, pair_of, shell_of, solid_tooth, tooth
from tabulate import tabulate

from easeoff.contact import STEEL, ElasticModel
from easeoff.contact.compliance.elastic_model import shells
from easeoff.contact import ElasticFoundation, Shell, ToothDimensions
from easeoff.contact.compliance.finite_elements.elastic_body import elastic_body, functionals
from easeoff.contact.compliance.finite_elements.flank_compliance import flank_shares
from easeoff.geometry import pair_geometry
from easeoff.geometry.tooth.tooth_flanks import MemberName

sys.path.append(str(Path(__file__).parents[1] / "tests" / "helpers"))
from thesis_shell import thesis_kinematics

IMAGE = Path(__file__).parents[1] / "docs" / "images" / "finite_elements" / "free_edge.png"
# Of about the height and thickness that the deflections of figure 3.4 call for; length and radius are the thesis's.
SLIM = ToothDimensions(45.0, 114.3, 10.0, 12.0, 5.0, 6.0, 2.0, 2.0)


def slim_tooth(bricks: tuple[int, int, int] = (30, 8, 4)) -> tuple[Array, Array, float]:
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


def slim_shell(modes: tuple[int, int], along: Array) -> tuple[Array, float]:
    """Free edge [mm] of the same tooth as the dissertation's clamped shell, and CPU time [s]."""
    start = time.process_time()
    tooth_ = Shell(SLIM, STEEL, modes, assumption=thesis_kinematics)
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
    rows: list[list[Any]] = []

    def shown(axis: Any, label: str, place: Array, edge: Array, seconds: float, style: str) -> None:
        axis.plot(place, 1e3 * edge, style, label=label)
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

    name = "fm-11x41"
    member: MemberName = "gear"
    one = tooth(name, member)
    along = one.lattice.lengthwise
    for modes in ((5, 3), (5, 5), (5, 9), (5, 15)):
        start = time.process_time()
        model = ElasticModel(modes=modes, foundation=ElasticFoundation("odonnell", 0.8))
        shell = shells(pair_geometry(pair_of(name), (7, 7)).teeth, model)[MEMBERS.index(member)]
        _, edge = shell_of(name, member, shell, along)
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
