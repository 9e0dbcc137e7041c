"""Sizes of an analysis, and the memory that it takes by them: known before it runs.

The analysis keeps every field over torques, mesh positions and segments, and what the teeth bend under a load on each
segment of the contact lines. Memory is in proportion to these numbers; ``tests/test_analysis_size.py`` compares it with
the greatest memory of processes that run.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..core.memory import require_memory
from .schema.case_schema import Case

BASE_SIZE = 60e6  # of an analysis of any size [byte]
GRID_NODE_SIZE = 9.2e3  # per node of the flanks, while the flanks and their ease-off are found [byte]
LINE_SEGMENT_SIZE = 11.5e3  # per segment of the contact lines [byte]
LOADED_SEGMENT_SIZE = 280.0  # per torque, mesh position and segment, with the copy that is written [byte]
FRICTION_VALUE_SIZE = 100.0  # per value of a field of friction [byte]
KEPT_VALUES_LIMIT = 3_000_000  # fields of friction over segments with more values are not kept
MEAN_LINES, MOST_LINES = 3.0, 4.5  # contact lines in mesh at once, on the mean of the positions and at most
EDGE_PIECES = 45  # of the edges of the teeth, at a mesh position


@dataclass(frozen=True)
class AnalysisSize:
    """Numbers that decide the memory of an analysis.

    Parameters
    ----------
    torques, mesh_positions, segments_per_line, lengthwise_nodes, profile_nodes
        As of ``[contact]`` in a case.
    speeds, temperatures, roughnesses
        Numbers of operating conditions; 0 without friction.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> size = AnalysisSize.of(read_case("nasa-12x36"))
    >>> size.mesh_positions, size.torques, size.memory < 0.5e9
    (32, 3, True)
    """

    torques: int
    mesh_positions: int
    segments_per_line: int
    lengthwise_nodes: int
    profile_nodes: int
    speeds: int = 0
    temperatures: int = 0
    roughnesses: int = 0

    @classmethod
    def of(cls, case: Case, torques: int | None = None, conditions: tuple[int, int, int] = (0, 0, 0)) -> AnalysisSize:
        """Sizes of the analysis of a case.

        Parameters
        ----------
        case
            The case.
        torques
            Number of torques; that of the case if left out.
        conditions
            Numbers of speeds, temperatures and roughnesses.
        """
        contact = case.contact
        return cls(
            len(contact.torques) if torques is None else torques,
            contact.mesh_positions,
            contact.segments_per_line,
            contact.lengthwise_nodes,
            contact.profile_nodes,
            *conditions,
        )

    @property
    def solved_positions(self) -> int:
        """Number of contact problems."""
        return self.torques * self.mesh_positions

    @property
    def parts(self) -> dict[tuple[str, ...], float]:
        """Memory of every part of the analysis [byte], by the numbers that decide it."""
        segments = self.segments_per_line * MOST_LINES + EDGE_PIECES
        conditions = self.solved_positions * self.speeds * self.temperatures * self.roughnesses
        kept = conditions * segments if conditions * segments <= KEPT_VALUES_LIMIT else 0.0
        velocities = self.mesh_positions * segments * self.speeds
        on_lines = self.mesh_positions * self.segments_per_line * MEAN_LINES
        return {
            ("lengthwise_nodes", "profile_nodes"): GRID_NODE_SIZE * self.lengthwise_nodes * self.profile_nodes,
            ("mesh_positions", "segments_per_line"): LINE_SEGMENT_SIZE * on_lines,
            ("torques", "mesh_positions", "segments_per_line"): LOADED_SEGMENT_SIZE * self.solved_positions * segments,
            ("speeds", "temperatures", "roughnesses"): FRICTION_VALUE_SIZE * (conditions + kept + velocities),
        }

    @property
    def memory(self) -> float:
        """Memory that the analysis takes beyond that of the process before it [byte], at least what it needs."""
        return BASE_SIZE + sum(self.parts.values())

    def require_memory(self) -> None:
        """Refuse an analysis that needs more memory than is free.

        Raises
        ------
        InputError
            With the numbers to lower, what is needed and what is free.
        """
        deciding = max(self.parts, key=lambda names: self.parts[names])
        numbers = " x ".join(f"{getattr(self, name)} {name}" for name in deciding)
        require_memory(numbers, self.memory, "the analysis")
