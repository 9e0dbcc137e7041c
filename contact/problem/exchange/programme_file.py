"""One contact problem as a NumPy file that qpsolvers reads as a quadratic programme, and this package without loss.

`qpsolvers.Problem.load(path)` gives the scaled programme, in the form chosen. Beside the arrays of qpsolvers, which
takes no notice of others, the file holds

- ``contact_separation``, ``contact_lever_arm``, ``contact_torque`` and ``contact_compliance``, or
  ``contact_compliance_diagonal`` and ``contact_compliance_factor``: the problem itself, in mm, N and N mm;
- ``scale_force`` [N], ``scale_rotation`` [rad], ``first_contact_rotation`` [rad]: with the unknowns F and theta of the
  programme, the forces are ``scale_force`` F and the rotation ``first_contact_rotation + scale_rotation`` theta.

In the dense and the lifted form F are the first n unknowns and theta is minus the multiplier of the first equality; in
the dual form F are the first n unknowns and theta is the last.
"""

from __future__ import annotations

import os
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.array_file import read_arrays
from ....core.checks import one_of, shown
from ....core.errors import InputError
from ....core.output_file import whole_file
from ..contact_problem import ContactProblem
from ..forms.dual_form import dual_qp
from ..forms.lifted_form import lifted_qp

#: Forms in which the programme can be written.
FORMS = ("dense", "lifted", "dual")
Arrays = Mapping[str, NDArray[Any] | None]


def write_npz(problem: ContactProblem, path: str | os.PathLike[str], *, form: str = "dense") -> None:
    """Write a contact problem as a quadratic programme of qpsolvers.

    Parameters
    ----------
    problem
        The contact problem.
    path
        The file, replaced if it exists; its name should end in ``.npz``. It appears complete or not at all.
    form
        ``"dense"``, the scaled programme of `ContactProblem.as_qp`; ``"lifted"`` or ``"dual"``, that of `lifted_qp` or
        `dual_qp`. All matrices are written dense: qpsolvers loses sparse constraint matrices in its own files.

    Raises
    ------
    InputError
        An unknown form, or one the problem cannot have; the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_npz(springs, Path(folder, "problem.npz"), form="dual")
    ...     sorted(np.load(Path(folder, "problem.npz")).files)[:2]
    ['A', 'G']
    """
    programme = _programme(problem, form)
    with whole_file(path) as temporary:
        with temporary.open("wb") as file:
            programme.save(file)
        with zipfile.ZipFile(temporary, "a") as archive:
            for name, values in _own_arrays(problem).items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                    np.lib.format.write_array(entry, np.asarray(values), allow_pickle=False)


def read_npz(path: str | os.PathLike[str]) -> ContactProblem:
    """Read a contact problem from a file of `write_npz`, or from another file of qpsolvers that holds one.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    ContactProblem
        Identical to the one written. From a file of another program, P, q, A and b are taken for C, S, r and T as they
        stand: in which units only its author knows.

    Raises
    ------
    InputError
        The file cannot be read, or its programme is no contact problem: one equality and F >= 0.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_npz(springs, Path(folder, "problem.npz"))
    ...     read_npz(Path(folder, "problem.npz")).identical(springs)
    True
    """
    arrays = read_arrays(path)
    try:
        return ContactProblem(*(_own_data(arrays) if "contact_separation" in arrays else _foreign_data(arrays)))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    except KeyError as error:
        raise InputError(f"{path} is incomplete: there is no array {error.args[0]!r}") from error


def _programme(problem: ContactProblem, form: str) -> Any:
    one_of("form", form, FORMS)
    if form == "dense":
        return problem.as_qp()
    programme: Any = (lifted_qp(problem) if form == "lifted" else dual_qp(problem)).programme
    for name in ("P", "G", "A"):
        matrix = getattr(programme, name)
        if matrix is not None and not isinstance(matrix, np.ndarray):
            setattr(programme, name, matrix.toarray())
    return programme


def _own_arrays(problem: ContactProblem) -> dict[str, Any]:
    arrays: dict[str, Any] = {
        "contact_separation": problem.separation,
        "contact_lever_arm": problem.lever_arm,
        "contact_torque": problem.torque,
        "scale_force": problem.scaling.force,
        "scale_rotation": problem.scaling.rotation,
        "first_contact_rotation": problem.first_contact_rotation,
    }
    if isinstance(problem.compliance, tuple):
        arrays["contact_compliance_diagonal"], arrays["contact_compliance_factor"] = problem.compliance
    else:
        arrays["contact_compliance"] = problem.dense_compliance
    return arrays


def _own_data(arrays: Arrays) -> tuple[Any, Any, Any, Any]:
    compliance: Any
    if "contact_compliance_factor" in arrays:
        compliance = (arrays["contact_compliance_diagonal"], arrays["contact_compliance_factor"])
    else:
        compliance = arrays["contact_compliance"]
    return arrays["contact_separation"], arrays["contact_lever_arm"], arrays["contact_torque"], compliance


def _foreign_data(arrays: Arrays) -> tuple[Any, Any, Any, Any]:
    """Separation, lever arm, torque and compliance from P, q, A and b; qpsolvers stores a missing one as an object."""
    matrix, linear = arrays["P"], arrays["q"]
    row, right = arrays.get("A"), arrays.get("b")
    if row is None or right is None:
        raise InputError("A = none: must be the balance of torque, the one equality A x = b")
    row, right = np.atleast_2d(row), np.atleast_1d(right)
    if row.shape[0] != 1 or right.shape != (1,):
        raise InputError(f"A = {shown(row)}: must be one equality, the balance of torque")
    lower, upper = arrays.get("lb"), arrays.get("ub")
    if lower is None or not _is_numeric(lower) or np.any(lower != 0.0):
        raise InputError(f"lb = {shown(lower)}: must be zero, the lower bounds of the normal forces")
    if arrays.get("G") is not None or (upper is not None and not (_is_numeric(upper) and np.all(upper == np.inf))):
        raise InputError("G, ub: must be left out, a contact problem has no inequalities and no upper bounds")
    return linear, row[0], right[0], matrix


def _is_numeric(array: NDArray[Any]) -> bool:
    return array.dtype.kind in "biuf"
