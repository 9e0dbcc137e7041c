"""Declaration of a solver of one's own: a function, the forms it takes, and what may be asked of it."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....core.checks import instance, number, one_of, shown, truth
from ....core.errors import InputError
from ....core.foreign_code import ForeignCodeError, foreign_code
from ...problem.certificate import EXACT_TOLERANCE
from ...problem.forms.complementarity_form import eliminated_system
from ...problem.forms.lifted_form import lifted_programme
from ...problem.scaled_problem import ScaledProblem
from ..scaled_answer import ScaledAnswer
from .own_answer import own_answer

#: Forms that a solver can declare, and what its function receives.
DECLARED_FORMS = {
    "dense": "qpsolvers.Problem with arrays",
    "sparse": "qpsolvers.Problem with matrices in compressed sparse columns",
    "lifted": "qpsolvers.Problem of forces and modal amplitudes, sparse; the compliance is diag(d) + V V^T",
    "lcp": "matrix M and vector q of the linear complementarity problem",
    "products": "qpsolvers.Problem whose P is a scipy.sparse.linalg.LinearOperator",
}


class ScaledLCP(NamedTuple):
    """Linear complementarity problem w = M z + q >= 0, z >= 0, w'z = 0, as `lcp` has it, in scaled numbers.

    Attributes
    ----------
    matrix
        M (n, n).
    vector
        q (n).
    eliminated
        The segment whose entry of z is its gap.
    """

    matrix: NDArray[np.float64]
    vector: NDArray[np.float64]
    eliminated: int


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
    tolerance: float = EXACT_TOLERANCE
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
        truth("warm_start", self.warm_start)
        truth("definite", self.definite)
        number("tolerance", self.tolerance, above=0.0, below=1.0)

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
        """Whether the function takes a keyword."""
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
        able = [own for own in self.forms if own == form or form == "auto"]
        possible = [own for own in able if _has_form(problem, own)]
        if not possible:
            given = "dense matrix" if problem.has_matrix else "LinearOperator"
            wanted = "the pair (d, V)" if problem.has_matrix else "a matrix"
            raise InputError(
                f"compliance = {given}: must be {wanted} for {self.name}, which takes the forms {', '.join(able)}"
            )
        modal = problem.modal
        many = modal is not None and modal.mode_count >= problem.separation.size
        fewer = [own for own in possible if own != "lifted"] if many else possible
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
