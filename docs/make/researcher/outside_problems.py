"""Problems from outside of gears that have the form of a contact problem, for the comparison of solvers and for tests.

min 1/2 F'CF + S'F with F >= 0 and r'F = T: C is a covariance, a kernel or a Gram matrix.
"""

from __future__ import annotations

import lzma
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from easeoff.contact import ContactProblem, write_problems

Array = NDArray[np.float64]

#: Numbers of unknowns of the problems in the comparison that are made here.
SIZES = (50, 150)
#: Their kinds, in the order of the file, and what they are.
KINDS = {
    "portfolio": "least variance without short sales, of fewer observations than assets: singular",
    "factor-portfolio": "least variance under factors and variances of single assets, with expected returns",
    "support-vectors": "dual of a support vector machine, Gaussian kernel, classes that overlap: T = 0, S = -1",
    "mixture": "non-negative least squares with a sum: shares of known spectra in a measured one",
    "maros-meszaros": "those of this form among the 138 of Maros and Meszaros (1999, doi 10.1080/10556789908805768)",
}
#: Names of the problems of the last kind and their least objectives as published with them, half of F'CF counted.
LEAST_OBJECTIVES = {"DUAL1": 3.5012966e-2, "DUAL2": 3.3733676e-2, "DUAL3": 1.3575584e-1, "DUAL4": 7.4609084e-1}


def portfolio(assets: int, observations: int, seed: int) -> ContactProblem:
    """Least variance without short sales: correlations from fewer observations than assets are singular."""
    rng = np.random.default_rng(seed)
    returns = rng.standard_normal((observations, 3)) @ rng.standard_normal((3, assets))
    returns += rng.standard_normal((observations, assets))
    correlation = np.corrcoef(returns.T)
    return ContactProblem(np.zeros(assets), np.ones(assets), 1.0, (correlation + correlation.T) / 2.0)


def factor_portfolio(assets: int, factors: int, seed: int) -> ContactProblem:
    """Variance of a factor model, as (d, V), against expected returns."""
    rng = np.random.default_rng(seed)
    loadings, variances = rng.standard_normal((assets, factors)), rng.uniform(0.2, 2.0, assets)
    expected = 0.3 * loadings[:, 0] + 0.2 * rng.standard_normal(assets)
    return ContactProblem(-expected, np.ones(assets), 1.0, (variances, loadings))


def support_vectors(points: Array, label: Array, kernel: Array) -> ContactProblem:
    """Dual of a support vector machine: no torque, lever arms of both signs; its rotation is the offset."""
    return ContactProblem(-np.ones(len(points)), label, 0.0, kernel * np.outer(label, label))


def overlapping_classes(count: int, seed: int) -> tuple[Array, Array, Array]:
    """Points (n, 3) of two classes that overlap, their labels (n) and Gaussian kernel (n, n), without a limit."""
    rng = np.random.default_rng(seed)
    points = rng.standard_normal((count, 3))
    label = np.where(points[:, 0] + 0.5 * rng.standard_normal(count) > 0.0, 1.0, -1.0)
    return points, label, np.exp(-0.5 * ((points[:, None] - points) ** 2).sum(axis=-1))


def mixture(spectra: int, wavelengths: int, seed: int) -> ContactProblem:
    """Shares of spectra in a measured one: |Ax - b|^2 with x >= 0 and the sum 1."""
    rng = np.random.default_rng(seed)
    known = rng.uniform(0.0, 1.0, (wavelengths, spectra))
    shares = rng.exponential(size=spectra) * (rng.uniform(size=spectra) < 0.2)
    measured = known @ (shares / shares.sum()) + 0.01 * rng.standard_normal(wavelengths)
    return ContactProblem(-known.T @ measured, np.ones(spectra), 1.0, known.T @ known)


def maros_meszaros() -> Iterator[tuple[str, ContactProblem]]:
    """Name and problem of DUAL1 to DUAL4: shares of 75 to 111 unknowns, whose limits of 1 never count.

    Their file has three lines a problem: name, S (n), and the lower triangle of C by rows. The fifth of this form, TAME
    of two unknowns, is a test.
    """
    text = lzma.decompress(Path(__file__).with_name("maros_meszaros.txt.xz").read_bytes()).decode("ascii")
    for name, linear, quadratic in zip(*[iter(text.splitlines())] * 3, strict=True):
        separation = np.array(linear.split(), dtype=float)
        compliance = np.zeros((separation.size, separation.size))
        compliance[np.tril_indices(separation.size)] = np.array(quadratic.split(), dtype=float)
        compliance += np.tril(compliance, -1).T
        yield name, ContactProblem(separation, np.ones(separation.size), 1.0, compliance)


def outside_problems() -> Iterator[tuple[str, str, ContactProblem]]:
    """Kind, name and problem: of each kind two of each size, then those of others."""
    makers: dict[str, Any] = {
        "portfolio": lambda size, seed: portfolio(size, size // 2, seed),
        "factor-portfolio": lambda size, seed: factor_portfolio(size, 10, seed),
        "support-vectors": lambda size, seed: support_vectors(*overlapping_classes(size, seed)),
        "mixture": lambda size, seed: mixture(size, 2 * size, seed),
    }
    for kind in makers:
        for size in SIZES:
            for seed in (1, 2):
                yield kind, f"{kind}-{size}-{seed}", makers[kind](size, seed)
    for name, problem in maros_meszaros():
        yield "maros-meszaros", name, problem


def write_outside(path: Path) -> None:
    """Write them to a file of problems, with names and kinds."""
    kinds, names, problems = zip(*outside_problems(), strict=True)
    write_problems(list(problems), path, {"name": list(names), "kind": list(kinds)})
