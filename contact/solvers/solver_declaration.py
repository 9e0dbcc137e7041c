"""Declaration of a solver of one's own: a function, the forms it takes, and what may be asked of it.

Whatever it returns that is no answer becomes a status with a reason. A solver is given as a declaration, a function,
``module:function``, or an entry point. A distribution announces its solvers in the entry-point group
``easeoff.solvers``, each by a name and the place of a function or a `Solver`. Nothing of it is imported before the
solver is used.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import importlib.metadata
import inspect
import math
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...core.arrays import RealArray as Array
from ...core.checks import bounded, check_fields, instance, one_of, shown
from ...core.errors import InputError
from ...core.foreign_code import IMPORT_TIME_LIMIT, ForeignCodeError, foreign_code
from ..problem.certificate import EXACT_TOLERANCE
from ..problem.programme_forms import eliminated_system, forces_and_rotation, lifted_programme
from ..problem.scaled_problem import ScaledProblem
from .backend import NoAnswerError, read_answer
from .solution import SOLVED, CallTimes, ScaledAnswer, Status
from .solver_table import SOLVERS, SolverSettings


def own_answer(returned: Any, problem: ScaledProblem, form: str, posed: Any) -> ScaledAnswer:
    """Answer of a function of one's own: a `qpsolvers.Solution`, a `ScaledAnswer`, or unknowns and rotation or not."""
    size = problem.separation.size
    if isinstance(returned, ScaledAnswer):
        force = _numbers(returned.force, "forces", (size,))
        turned = _rotation(returned.rotation, problem, force)
        gap = None if returned.gap is None else _numbers(returned.gap, "gaps", (size,))
        status: Any = returned.suspicion
        times: Any = returned.times
        if not isinstance(status, Status | None) or not isinstance(times, CallTimes | None):
            raise _refused("it returned a ScaledAnswer whose suspicion is no Status, or whose times are no CallTimes")
        return ScaledAnswer(force, turned, int(returned.iterations), str(returned.message), status, gap, times)
    if all(hasattr(returned, name) for name in ("x", "y", "z_box", "found")):
        return _of_solution(returned, problem, posed)
    if returned is None:
        raise NoAnswerError("it returned no answer", Status.SOLVER_FAILED)
    rotation = None
    if isinstance(returned, tuple):
        if len(returned) != 2:
            raise _refused(f"it returned {len(returned)} values: must be the unknowns, or these and the rotation")
        returned, rotation = returned
    if form == "lcp" and rotation is not None:
        raise _refused("it returned two values: must be z alone for the form lcp, which has the rotation in it")
    unknowns = _numbers(returned, "unknowns", (size,), *([(posed.q.size,)] if form == "lifted" else ()))
    if form == "lcp":
        return ScaledAnswer(*forces_and_rotation(problem, posed.eliminated, unknowns), -1)
    force = unknowns[:size].copy()
    return ScaledAnswer(force, _rotation(rotation, problem, force), -1)


def _of_solution(returned: Any, problem: ScaledProblem, posed: Any) -> ScaledAnswer:
    """The answer in a `qpsolvers.Solution`."""
    if returned.x is None:
        raise NoAnswerError("it found no answer", Status.SOLVER_FAILED)
    unknowns = _numbers(returned.x, "unknowns", (posed.q.size,))
    iterations = getattr(returned, "extras", {}).get("iter", -1)
    multiplier = None if returned.y is None or np.size(returned.y) == 0 else np.asarray(returned.y).ravel()[0]
    if multiplier is not None and math.isfinite(multiplier):
        return read_answer(returned, iterations=int(iterations))
    force = unknowns[: problem.separation.size].copy()
    words, claim = ("found", None) if returned.found else ("not found", Status.SOLVER_FAILED)
    return ScaledAnswer(force, _rotation(None, problem, force), int(iterations), words, claim)


def _rotation(given: Any, problem: ScaledProblem, force: Array) -> float:
    """The rotation, or where none was given that at which the torque does the work of the forces."""
    if given is None:
        if not problem.torque > 0.0:
            raise _refused("it returned no rotation, which does not follow from the forces without a torque")
        return float(force @ problem.deflection(force) + problem.separation @ force) / problem.torque
    if np.size(given) != 1 or np.asarray(given).dtype.kind not in "fiu":
        raise _refused(f"it returned the rotation {shown(given)}: must be a number")
    rotation = float(np.asarray(given).ravel()[0])
    if not math.isfinite(rotation):
        raise _refused(f"it returned the rotation {shown(rotation)}: must be finite")
    return rotation


def _numbers(returned: Any, what: str, *shapes: tuple[int, ...]) -> Array:
    """Finite numbers of one of some shapes; a column is a vector, too."""
    try:
        entries = np.asarray(returned)
    except (TypeError, ValueError) as error:
        raise _refused(f"it returned {what} of the type {type(returned).__name__}: must be an array") from error
    if entries.dtype.kind not in "fiu" or np.ma.is_masked(returned):
        raise _refused(
            f"it returned {what} of the type {type(returned).__name__}, {entries.dtype.name}: must be floats"
        )
    if entries.ndim == 2 and 1 in entries.shape:
        entries = entries.ravel()
    if entries.shape not in shapes:
        wanted = " or ".join(map(str, sorted(set(shapes))))
        raise _refused(f"it returned {what} of the shape {entries.shape}: must have {wanted}")
    numbers = entries.astype(np.float64)
    if wrong := np.count_nonzero(~np.isfinite(numbers)):
        raise _refused(f"{wrong} of {numbers.size} {what} are not finite")
    return numbers


def _refused(message: str) -> NoAnswerError:
    """The function said that it had solved the problem, and what it returned is no answer."""
    return NoAnswerError(message, Status.SOLVER_FAILED, claim=SOLVED)


#: Forms that a solver can declare, and what its function receives.
DECLARED_FORMS = {
    "dense": "qpsolvers.Problem with arrays",
    "sparse": "qpsolvers.Problem with matrices in compressed sparse columns",
    "lifted": "qpsolvers.Problem of forces and modal amplitudes, sparse; the compliance is diag(d) + V V^T",
    "lcp": "matrix M and vector q of the linear complementarity problem",
    "products": "qpsolvers.Problem whose P is a scipy.sparse.linalg.LinearOperator",
}


class ScaledLCP(NamedTuple):
    """Linear complementarity problem w = M z + q >= 0, z >= 0, w'z = 0, as `lcp` has it, in scaled numbers."""

    matrix: Array
    vector: Array
    eliminated: int  # segment whose entry of z is its gap


@dataclass(frozen=True, eq=False)
class Solver:
    """A solver of one's own, for ``solve``, ``analyze`` and ``compare``.

    Its function gets the contact problem in scaled numbers, in one of its forms, and keywords: ``tolerance``,
    ``time_limit``, ``max_iterations`` where they were given, ``initvals`` at a warm start, and the caller's settings.
    It returns a `qpsolvers.Solution`; or the unknowns and the rotation, which is minus the multiplier of the first
    equality; or the unknowns alone, for the form ``lcp`` z. It may raise, `TimeoutError` at its time limit. Its answer
    is scaled back, polished and certified as that of any other solver.

    Attributes
    ----------
    name
        In results and reports.
    function
        Called with the problem and keywords.
    forms
        Forms that it takes, the best one first: of ``dense``, ``sparse``, ``lifted``, ``lcp``, ``products``.
    warm_start
        Whether it takes ``initvals``, unknowns near the solution.
    definite
        Whether it needs a positive definite compliance.
    tolerance
        Certificate that its unpolished answers must reach, if the caller asks for no other.
    method
        Its method, in a few words.

    Raises
    ------
    InputError
        A value that is none of these.

    Examples
    --------
    >>> import numpy as np
    >>> import qpsolvers
    >>> from easeoff.contact import ContactProblem, solve
    >>> def by_splitting(problem, **settings):
    ...     return qpsolvers.solve_problem(problem, "osqp", **settings)
    >>> mine = Solver("mine", by_splitting, forms=("lifted", "sparse"), method="splitting")
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> solve(springs, mine, eps_abs=1e-8).force.tolist()
    [1000.0, 1000.0]
    """

    name: str
    function: Callable[..., Any]
    forms: tuple[str, ...] = ("dense",)
    warm_start: bool = False
    definite: bool = False
    tolerance: float = field(default=EXACT_TOLERANCE, metadata=bounded(above=0.0, below=1.0))
    method: str = ""

    def __post_init__(self) -> None:
        """Check the values."""
        name: Any = self.name
        if not isinstance(name, str) or not name.strip():
            raise InputError(f"name = {shown(name)}: must be a text")
        instance("function", self.function, Callable)
        given: Any = self.forms
        forms = (given,) if isinstance(given, str) else tuple(given) if isinstance(given, Sequence) else ()
        if not forms:
            raise InputError(f"forms = {shown(given)}: must be at least one of {', '.join(DECLARED_FORMS)}")
        for form in forms:
            one_of("forms", form, DECLARED_FORMS)
        object.__setattr__(self, "forms", forms)
        check_fields(self)

    @cached_property
    def _keywords(self) -> tuple[frozenset[str], bool]:
        """Names of the keywords that the function takes, and whether it takes any."""
        try:
            with foreign_code():
                parameters = list(inspect.signature(self.function).parameters.values())
        except ForeignCodeError:  # of a compiled function
            return frozenset(), True
        kinds = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
        named = [p.name for p in parameters[1:] if p.kind in kinds]
        return frozenset(named), any(p.kind is inspect.Parameter.VAR_KEYWORD for p in parameters)

    def takes(self, keyword: str) -> bool:
        """True if the function takes a keyword."""
        named, anything = self._keywords
        return anything or keyword in named

    def keywords(self, limits: Mapping[str, Any], settings: Mapping[str, Any]) -> dict[str, Any]:
        """Return what the function is called with.

        Parameters
        ----------
        limits
            ``tolerance``, ``time_limit`` and ``max_iterations``, None where not given. A tolerance that the function
            does not take is that of the certificate alone.
        settings
            The caller's own.

        Raises
        ------
        InputError
            A limit or setting that the function does not take.
        """
        given = {key: value for key, value in limits.items() if value is not None}
        for key, value in {**given, **settings}.items():
            if key != "tolerance" and not self.takes(key):
                raise InputError(f"{key} = {shown(value)}: must not be given, {self.name} takes no such keyword")
        return {key: value for key, value in {**given, **settings}.items() if self.takes(key)}

    def chosen_form(self, problem: ScaledProblem, form: str = "auto") -> str:
        """Return the form in which the function gets a problem: with ``auto`` the first that the problem has.

        Raises
        ------
        InputError
            A form that is not declared, or that the problem does not have.
        """
        if form != "auto":
            one_of("form", form, ("auto", *self.forms))
        able = [candidate for candidate in self.forms if candidate == form or form == "auto"]
        possible = [candidate for candidate in able if _has_form(problem, candidate)]
        if not possible:
            given = "dense matrix" if problem.has_matrix else "LinearOperator"
            wanted = "the pair (d, V)" if problem.has_matrix else "a matrix"
            raise InputError(
                f"compliance = {given}: must be {wanted} for {self.name}, which takes the forms {', '.join(able)}"
            )
        modal = problem.modal
        many = modal is not None and modal.mode_count >= problem.separation.size
        fewer = [candidate for candidate in possible if candidate != "lifted"] if many else possible
        return (fewer or possible)[0]

    def solve_scaled(self, problem: ScaledProblem, form: str, keywords: Mapping[str, Any]) -> ScaledAnswer:
        """Call the function with a scaled problem in one of its forms, and read what it returns."""
        posed = _posed(problem, form)
        chosen = dict(keywords)
        if chosen.get("initvals") is not None and form == "lifted":
            force = np.asarray(chosen["initvals"])
            chosen["initvals"] = np.concatenate([force, posed.A[1:, : force.size] @ force])
        return own_answer(self.function(posed, **chosen), problem, form, posed)


def _has_form(problem: ScaledProblem, form: str) -> bool:
    if form == "lifted":
        return problem.modal is not None
    return form == "products" or problem.has_matrix


def _posed(problem: ScaledProblem, form: str) -> Any:
    """The problem in a form, in arrays of its own: a function may write to them."""
    if form == "lcp":
        return ScaledLCP(*eliminated_system(problem))
    if form == "lifted":
        return lifted_programme(problem, compress=True)
    if form == "products":
        return problem.as_products()
    programme: Any = problem.as_qp(sparse=form == "sparse")
    programme.P, programme.A, programme.q = programme.P.copy(), programme.A.copy(), programme.q.copy()
    return programme


#: Group of entry points of distributions that bring solvers.
ENTRY_POINT_GROUP = "easeoff.solvers"


@dataclass(frozen=True)
class ChosenSolver:
    """A solver that can be used, of the table or one's own: what a user's choice stands for, see `chosen_solver`."""

    name: str
    declaration: Solver | None  # None: of the table
    asked: str  # as the user named it

    @property
    def is_native(self) -> bool:
        """True for the native solver."""
        return self.declaration is None and self.name == "native"

    @property
    def facts(self) -> Solver | SolverSettings:
        """Declared properties."""
        return self.declaration or SOLVERS[self.name]


#: What names a solver: a name, ``module:function``, a function, its declaration, or what was found for one of these.
SolverChoice = str | Solver | Callable[..., Any] | ChosenSolver


def declared_solver(solver: str | Solver | Callable[..., Any]) -> Solver | None:
    """Declaration of a solver of one's own; None for other names, such as those of the table.

    A `Solver`, a function, ``module:function``, or a name of the entry-point group ``easeoff.solvers``; the table's
    names come first.
    """
    if isinstance(solver, Solver):
        return solver
    if isinstance(solver, str) and (solver == "auto" or solver in SOLVERS):
        return None
    try:
        with foreign_code(IMPORT_TIME_LIMIT):
            if not isinstance(solver, str):
                if callable(solver):
                    return Solver(_name_of(solver), solver)
                what = shown(solver)
                raise InputError(
                    f"solver = {what}: must be the name of a solver, MODULE:FUNCTION, a function or a Solver"
                )
            return _solver_at(solver) if declares_place(solver) else _entry_point_solver(solver, tuple(sys.path))
    except ForeignCodeError as error:
        once = "; if only the first import takes long, import it in Python once" if error.is_time_limit else ""
        raise InputError(f"solver = {shown(solver)}: cannot be loaded: {error}{once}") from error


def entry_point_names() -> list[str]:
    """Names of the solvers that installed distributions bring, in order, without those of the table."""
    return sorted({point.name for point in _entry_points()} - {*SOLVERS, "auto"})


def entry_point(name: str) -> importlib.metadata.EntryPoint | None:
    """The entry point that brings a solver, with its distribution; None if none does."""
    return next((point for point in _entry_points() if point.name == name), None)


@contextlib.contextmanager
def current_folder_last() -> Iterator[None]:
    """Let modules be found in the current folder, too, which is searched last."""
    folder = os.getcwd()
    if folder in sys.path or "" in sys.path:
        yield
        return
    with contextlib.suppress(ImportError):
        importlib.import_module("qpsolvers")  # first, because it tries to import every solver it knows
    sys.path.append(folder)
    try:
        yield
    finally:
        with contextlib.suppress(ValueError):
            sys.path.remove(folder)


def _entry_points() -> list[importlib.metadata.EntryPoint]:
    return list(importlib.metadata.entry_points(group=ENTRY_POINT_GROUP))


@functools.lru_cache(maxsize=64)
def _entry_point_solver(name: str, _path: tuple[str, ...]) -> Solver | None:
    points = [point for point in _entry_points() if point.name == name]
    if not points:
        return None
    if len({point.value for point in points}) > 1:
        owners = ", ".join(sorted(str(point.dist.name) if point.dist else point.value for point in points))
        raise InputError(f"solver = {name!r}: must be brought by one distribution; {owners} bring it")
    return _named(name, points[0].load(), points[0].value)


def declares_place(text: str) -> bool:
    """True if a text is of the form ``module:function``; any other with a colon is refused."""
    module, colon, path = text.partition(":")
    if colon and not (module.replace(".", "a").isidentifier() and path.replace(".", "a").isidentifier()):
        raise InputError(f"solver = {text!r}: must be MODULE:FUNCTION")
    return bool(colon)


def _solver_at(text: str) -> Solver:
    module, _, path = text.partition(":")
    try:
        with current_folder_last():
            target: Any = importlib.import_module(module)
        for name in path.split("."):
            target = getattr(target, name)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{module}.".startswith(f"{error.name}."):
            raise
        raise InputError(f"solver = {text!r}: must be MODULE:FUNCTION; there is no module {error.name!r}") from error
    return _named(text, target, text)


def _named(name: str, value: Any, place: str) -> Solver:
    if isinstance(value, Solver):
        return replace(value, name=name)
    if not callable(value):
        raise InputError(f"solver = {name!r}: must be a function or a Solver, and {place} is {shown(value)}")
    return Solver(name, value)


def _name_of(function: Callable[..., Any]) -> str:
    name = getattr(function, "__name__", type(function).__name__)
    module = getattr(function, "__module__", None)
    return name if module in (None, "__main__") else f"{module}:{name}"
