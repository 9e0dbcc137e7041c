from .problem_batch import ContactSolutions as ContactSolutions, solve_many as solve_many
from .registry import available_solvers as available_solvers, require_solver as require_solver, solve as solve
from .solution import ContactSolution as ContactSolution, Status as Status
from .solver_declaration import Solver as Solver, SolverChoice as SolverChoice
from .solver_table import SOLVERS as SOLVERS

__all__: list[str]
