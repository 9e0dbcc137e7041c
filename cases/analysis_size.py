"""Sizes of an analysis, and the memory and time that it takes by them: known before it runs.

The analysis keeps every field over torques, mesh positions and segments, and what the teeth bend under a load on each
segment of the contact lines. Memory is in proportion to these numbers; ``test_analysis_size.py`` compares it with
the greatest memory of processes that run.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..core.memory import require_memory
from .schema.case_schema import Case

BASE_SIZE = 120e6  # of an analysis of any size, whose elastic teeth are made before [byte]
GRID_NODE_SIZE = 4e3  # per node of the flanks, while the flanks and their ease-off are found [byte]
LINE_SEGMENT_SIZE = 11.5e3  # per segment of the contact lines [byte]
LOADED_SEGMENT_SIZE = 280.0  # per torque, mesh position and segment, with the copy that is written [byte]
FRICTION_VALUE_SIZE = 100.0  # per value of a field of friction [byte]
BLOCK_FIELDS = 3  # times that size, of fields of one contact at all conditions
KEPT_VALUES_LIMIT = 3_000_000  # fields of friction over segments with more values are not kept
LEAST_LINES, MEAN_LINES, MOST_LINES = 2.0, 3.0, 4.5  # contact lines at once: the fewest, the mean, and the most
EDGE_PIECES = 45  # of the edges of the teeth, at a mesh position
#: Processor time of the start, and per node, mesh position, segment of the lines, contact problem, its segments, and
#: friction coefficient; of a core of 2024 [s].
START_TIME, NODE_TIME, POSITION_TIME, LINE_SEGMENT_TIME = 3.0, 9e-5, 0.012, 1.2e-4
PROBLEM_TIME, SEGMENT_TIME, FRICTION_TIME = 4e-4, 8e-6, 2e-7
#: Time to make both elastic teeth by their model [s], and the power of the fineness that it grows with.
TEETH_TIMES = {"solid_shell": (2.5, 5.5), "fe": (15.0, 6.0)}
FEEDBACK_ROUNDS = 10  # solutions of a contact problem with friction fed back


@dataclass(frozen=True)
class AnalysisSize:
    """Numbers that decide the memory of an analysis, as of ``[contact]`` in a case; no speeds without friction."""

    torques: int
    mesh_positions: int
    segments_per_line: int
    lengthwise_nodes: int
    profile_nodes: int
    speeds: int = 0
    temperatures: int = 0
    roughnesses: int = 0
    feedback: bool = False  # friction fed back to the forces: fields kept for every condition

    @classmethod
    def of(
        cls, case: Case, torques: int | None = None, counts: tuple[int, int, int] = (0, 0, 0), *, feedback: bool = False
    ) -> AnalysisSize:
        """Sizes of a case's analysis; counts are the numbers of speeds, temperatures and roughnesses."""
        contact = case.contact
        solved = len(contact.torques) if torques is None else torques
        grid = (contact.mesh_positions, contact.segments_per_line, contact.lengthwise_nodes, contact.profile_nodes)
        return cls(solved, *grid, *counts, feedback)

    @property
    def solved_positions(self) -> int:
        """Number of contact problems."""
        return self.torques * self.mesh_positions

    @property
    def segments(self) -> float:
        """Segments at a mesh position, at most."""
        return self.segments_per_line * MOST_LINES + EDGE_PIECES

    @property
    def line_segments(self) -> float:
        """Segments of the contact lines at all mesh positions."""
        return self.mesh_positions * self.segments_per_line * MEAN_LINES

    @property
    def parts(self) -> dict[tuple[str, ...], float]:
        """Memory of every part of the analysis [byte], by the numbers that decide it."""
        segments = self.segments
        conditions = self.speeds * self.temperatures * self.roughnesses
        fields = conditions * self.solved_positions * segments
        surely = conditions * self.solved_positions * self.segments_per_line * LEAST_LINES
        kept = fields if self.feedback else min(fields, KEPT_VALUES_LIMIT) if surely <= KEPT_VALUES_LIMIT else 0.0
        sums = conditions * (self.solved_positions + BLOCK_FIELDS)
        velocities = self.mesh_positions * segments * self.speeds
        return {
            ("lengthwise_nodes", "profile_nodes"): GRID_NODE_SIZE * self.lengthwise_nodes * self.profile_nodes,
            ("mesh_positions", "segments_per_line"): LINE_SEGMENT_SIZE * self.line_segments,
            ("torques", "mesh_positions", "segments_per_line"): LOADED_SEGMENT_SIZE * self.solved_positions * segments,
            ("speeds", "temperatures", "roughnesses"): FRICTION_VALUE_SIZE * (sums + kept + velocities),
        }

    @property
    def memory(self) -> float:
        """Memory that the analysis takes beyond that of the process before it [byte], at least what it needs."""
        return BASE_SIZE + sum(self.parts.values())

    @property
    def seconds(self) -> float:
        """Rough estimate of the time that the analysis takes with the native solver, without the elastic teeth [s]."""
        problem = PROBLEM_TIME + SEGMENT_TIME * self.segments
        conditions = self.speeds * self.temperatures * self.roughnesses
        rounds = FEEDBACK_ROUNDS * problem if self.feedback else FRICTION_TIME * self.segments
        return (
            START_TIME
            + NODE_TIME * self.lengthwise_nodes * self.profile_nodes
            + POSITION_TIME * self.mesh_positions
            + LINE_SEGMENT_TIME * self.line_segments
            + self.solved_positions * (problem + conditions * rounds)
        )

    @staticmethod
    def teeth_seconds(case: Case) -> float:
        """Rough time to make the elastic teeth of a case, which are then kept [s]."""
        usual, power = TEETH_TIMES.get(case.compliance.model, (0.0, 0.0))
        return float(usual * case.compliance.fineness**power)

    def require_memory(self) -> None:
        """Refuse an analysis that needs more memory than is free, with the numbers to lower."""
        deciding = max(self.parts, key=lambda names: self.parts[names])
        numbers = " x ".join(f"{getattr(self, name)} {name}" for name in deciding)
        require_memory(numbers, self.memory, "the analysis")
