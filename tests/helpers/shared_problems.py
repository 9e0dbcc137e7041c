"""Random contact problems whose tooth pairs share modes, as those of shafts, housing and the body between the teeth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from easeoff.contact import STEEL, ContactProblem, Material, ModalBasis, with_shared_modes
from easeoff.contact.compliance.weber_line_contact import WeberLineContact
from easeoff.contact.problem.certificate import Certificate, violations
from easeoff.contact.problem.modal_basis import basis_of_blocks
from easeoff.contact.solvers.compiled.proof_kernel import certificate

Array = NDArray[np.float64]

#: Local compliance of a segment [mm/N], order of magnitude; that of modes is some times as large.
LOCAL = 1e-6


def shared_problem(
    seed: int,
    *,
    pairs: int | None = None,
    columns: int | None = None,
    modes: int | None = None,
    softness: float = 1.0,
    signs: bool = False,
    alike: bool = False,
    longest: int = 31,
    torque: float | None = None,
) -> ContactProblem:
    """Return a problem of tooth pairs of different sizes.

    Parameters
    ----------
    seed
        Of all that is random.
    pairs, columns, modes
        Numbers p of tooth pairs, q of shared columns, s of shared modes; up to 8, 6 and 24 by chance.
    softness
        Compliance of the shared modes over that of the teeth.
    signs
        Whether some lever arms are negative.
    alike
        Whether the mixing is the same for all tooth pairs, as that of supports.
    longest
        Segments of the longest pair, at most; of every pair if negative.
    torque
        [N mm], by chance 1e3 to 1e7.
    """
    rng = np.random.default_rng([20, seed])
    p = int(rng.integers(1, 9)) if pairs is None else pairs
    q = int(rng.integers(1, 7)) if columns is None else columns
    s = int(rng.integers(0, 25)) if modes is None else modes
    sizes = np.full(p, -longest) if longest < 0 else rng.integers(1, longest + 1, p)
    size = int(sizes.sum())
    rows = np.split(np.arange(size), np.cumsum(sizes)[:-1])
    separation, arm, wrench = np.empty(size), np.empty(size), np.empty((size, q))
    own = []
    for row in rows:
        x = np.linspace(-1.0, 1.0, row.size) if row.size > 1 else np.zeros(1)
        count = int(rng.integers(0, min(row.size, 20) + 1))
        table = np.polynomial.legendre.legvander(x, max(count, 1) - 1)[:, :count]
        own.append(np.sqrt(LOCAL) * rng.uniform(0.3, 1.5, count) / (1.0 + np.arange(count)) * table)
        separation[row] = 0.01 * (x - rng.uniform(-0.5, 0.5)) ** 2 + 0.01 * rng.random() + 1e-3 * rng.random(row.size)
        arm[row] = 40.0 + 5.0 * x + rng.random()
        smooth = np.stack([np.ones(row.size), x, x**2, np.cos(x + row[0]), np.sin(2.0 * x), np.exp(x)], axis=1)
        wrench[row] = (smooth @ rng.standard_normal((6, 6)))[:, :q]
    if signs:
        arm *= rng.choice([-1.0, 1.0, 1.0, 1.0], size)
        arm[0] = 40.0
    mixing = np.sqrt(softness * LOCAL / max(s, 1)) * rng.standard_normal((1 if alike else p, q, s))
    basis = with_shared_modes(basis_of_blocks(size, rows, own), wrench, np.repeat(mixing, p if alike else 1, axis=0))
    load = float(10.0 ** rng.uniform(3.0, 7.0)) if torque is None else torque
    return ContactProblem.of_modes(separation, arm, load, LOCAL * rng.uniform(0.5, 1.5, size), basis)


def dense(problem: ContactProblem) -> ContactProblem:
    """The problem with its compliance as one matrix, summed here."""
    local, factor = problem.compliance
    whole = np.diag(local) + factor @ factor.T
    return ContactProblem(problem.separation, problem.lever_arm, problem.torque, 0.5 * (whole + whole.T))


def as_array(problem: ContactProblem) -> ContactProblem:
    """The problem with its modes as one array, as read from a file."""
    local, factor = problem.compliance
    return ContactProblem(problem.separation, problem.lever_arm, problem.torque, (local, np.array(factor)))


def basis_of(problem: ContactProblem) -> ModalBasis:
    """Its modes."""
    assert problem.modal_basis is not None
    return problem.modal_basis


def line_contact_of(size: int, seed: int, *, edges: bool = True) -> WeberLineContact:
    """Line contacts of a number of segments, some beyond an edge unless there are none."""
    rng = np.random.default_rng([21, seed])
    overhang = np.where(edges & (rng.random(size) < 0.2), rng.uniform(-0.3, 0.1, size), np.nan)
    length, radius = rng.uniform(0.5, 1.5, size), rng.uniform(20.0, 80.0, size)
    pinion, gear = rng.uniform(1.0, 4.0, (2, size))
    bronze = Material(110000.0, 0.25)
    return WeberLineContact(length, radius, pinion, gear, STEEL, bronze, 0.14, overhang=overhang)


def three_segments() -> tuple[tuple[Array, Array, float, tuple[Array, Array]], WeberLineContact]:
    """Separation, lever arms, torque and bending compliance of three segments, and their line contact."""
    length, radius, pinion, gear = (np.full(3, value) for value in (1.5, 30.0, 3.0, 3.0))
    data = (np.array([0.01, 0.0, 0.01]), np.full(3, 40.0), 1.2e5, (np.zeros(3), np.full((3, 1), 1e-3)))
    return data, WeberLineContact(length, radius, pinion, gear, STEEL, STEEL)


def compiled_certificate(problem: ContactProblem, force: Array, elastic: float) -> tuple[Array, Certificate]:
    """What the compiled certificate says of an answer: violations and their bounds (7), and the plain ones."""
    deflection = problem.deflection(force)
    shifted, whole = problem.separation_at_first_contact, problem.compliance_diagonal
    gap = deflection + shifted - elastic * problem.lever_arm
    numbers = np.array([0.0, elastic, *[np.nan] * 7])
    terms = problem.size + basis_of(problem).factor.shape[1] + 10.0
    arguments = (force, deflection, gap, np.array(shifted), problem.lever_arm, np.array(whole))
    certificate(*arguments, problem.torque, terms, 0.0, numbers)
    return numbers[2:], violations(problem, force, elastic, deflection, gap)
