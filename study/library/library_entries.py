"""Library entries: the declaration of every problem of the library, by name, and its reference answer.

A problem is that of a ``Source``, an instant of a shipped case, or is made from it by a change of
``library_files.CHANGES``. If the problem behind a name changes or problems are added, the version of the library is
raised.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from importlib import resources

from ...geometry.pair.gear_pair import FlankName

LIBRARY_VERSION = 6
#: Table of the reference answers.
TABLE = "answers.csv"

#: Number of pinion rotations that divide one pitch; a source is at one of them.
MESH_POSITIONS = 32
#: Parts of the library, a file each, and what they hold.
PARTS = {
    "small": "single problems with up to 31 segments a line",
    "medium": "with up to 150",
    "large": "with up to 2000",
    "sequences": "problems in order, each a neighbour of the one before",
    "pairs": "many tooth pairs, coupled through the rotation alone",
    "huge": "with up to 10,001 segments a line",
    "giant": "with 33,335",
}
#: Parts that are made unless others are asked for.
USUAL_PARTS = ("small", "medium", "large")
#: Greatest number of segments a line of the parts that are divided by it.
SEGMENT_LIMITS = {"small": 31, "medium": 150, "large": 2000, "huge": 10_001, "giant": 33_335}

#: Kinds of problems, and their purpose.
KINDS = {
    "load": "each shipped case, drive and coast, under light, design and heavy load",
    "misaligned": "each shipped case at the design torque, misaligned both ways",
    "cycle": "one mesh cycle in sequence",
    "fine": "ever more segments a line: growth of time and memory",
    "weak": "the local compliance scaled down: nearly singular",
    "dense": "the compliance as a dense matrix",
    "degenerate": "ties, duplicates, the brink of contact, extremes, singular compliance",
    "full-cycle": "sequences: mesh cycles of every case, all 32 mesh positions",
    "ladder": "sequences: torque in 16 equal ratios, each case, drive and coast",
    "drift": "sequences: misalignment in 16 equal steps",
    "pairs": "several pinions on one gear: many blocks, up to a thousand columns",
}
#: Kinds whose problems are in a part of their own.
PART_OF_KIND = {"full-cycle": "sequences", "ladder": "sequences", "drift": "sequences", "pairs": "pairs"}

#: Torques at the pinion by case [N m]: light, design (a torque of the case file), heavy (twice its greatest).
TORQUES = {
    "nasa-12x36": (5.0, 150.0, 600.0),
    "fm-11x41": (5.0, 250.0, 1000.0),
    "fh-12x41-45": (5.0, 200.0, 1000.0),
    "fh-design-a": (5.0, 100.0, 1000.0),
    "fh-design-b": (5.0, 100.0, 1000.0),
}
#: Assembly errors E and P [mm] of ``fm-11x41``, and their opposites.
MISALIGNMENTS = ((-0.15, 0.12), (0.15, -0.12))
SEGMENTS_PER_LINE = (21, 51, 131, 333, 667, 1667, 3333, 10_001, 33_335)
SEQUENCE_STEPS = 16  # of a ladder or drift
PINIONS = (4, 8, 16)  # on one gear
PINION_LAG = 2e-5  # rotation of the gear by which each lies behind the one before [rad]
FLANKS: tuple[FlankName, ...] = ("drive", "coast")


@dataclass(frozen=True)
class Source:
    """Instant of a shipped case; its other assembly errors are zero, also where the case file has them."""

    case: str
    flank: FlankName
    torque: float  # at the pinion [N m]
    offset_error: float = 0.0  # E [mm]
    pinion_axial_error: float = 0.0  # P [mm]
    mesh_position: int = 0  # from 0 to ``MESH_POSITIONS`` - 1
    segments_per_line: int = 31


@dataclass(frozen=True)
class Entry:
    """Problem of the library.

    Parameters
    ----------
    name
        Name of the problem.
    kind
        Key of ``KINDS``.
    source
        Instant of a shipped case that the problem comes from.
    change
        Key of ``library_files.CHANGES``; empty for the problem of the source itself.
    amount
        Amount of the change; zero where it needs none.
    dense
        Whether the compliance is a matrix, not diagonal plus factor.
    sequence
        Name of the sequence to which the problem belongs; empty if to none.
    step
        Number of the problem in its sequence, from 0; -1 if it is in none.

    Examples
    --------
    >>> Entry("everyday", "load", Source("nasa-12x36", "drive", 150.0)).part
    'small'
    """

    name: str
    kind: str
    source: Source
    change: str = ""
    amount: float = 0.0
    dense: bool = False
    sequence: str = ""
    step: int = -1

    @property
    def part(self) -> str:
        """Part of the library that holds the problem."""
        size = self.source.segments_per_line
        return PART_OF_KIND.get(self.kind) or next(part for part, limit in SEGMENT_LIMITS.items() if size <= limit)


#: Two everyday instants from which problems are made: a spiral bevel pair, and a misaligned hypoid pair.
BASES = {
    "nasa-12x36": Source("nasa-12x36", "drive", 150.0, mesh_position=12),
    "fh-12x41-45": Source("fh-12x41-45", "coast", 200.0, *MISALIGNMENTS[0], mesh_position=3),
}


#: Change, amount and density of the compliance of the degenerate problems made from each of ``BASES``.
DEGENERATE = (
    ("zero_separation", 0.0, False),
    ("zero_separation", 0.0, True),
    ("tied_separations", 0.002, False),
    ("next_contact", 0.0, False),
    ("next_contact", 0.0, True),
    ("scaled_torque", 1e-9, False),
    ("scaled_torque", 1e6, False),
    ("remote_segment", 1e6, False),
    ("shifted_rotation", 1e3, False),
    ("twin_segments", 0.0, False),
    ("copied_segments", 0.0, True),
    ("copied_tooth_pairs", 0.0, False),
    ("copied_tooth_pairs", 0.0, True),
    ("rigid_segment", 0.0, False),
    ("rigid_half", 0.0, False),
    ("no_local_compliance", 0.0, False),
    ("single_segment", 0.0, False),
)


def entries() -> tuple[Entry, ...]:
    """Entries of the whole library, part by part, sequences together.

    Examples
    --------
    >>> len(entries()), entries()[0].name
    (510, 'nasa-12x36-drive-light')
    """
    single = [*_loads(), *_misaligned(), *_cycle(), *_fine(), *_weak(), *_dense(), *_degenerate()]
    library = [*single, *_full_cycles(), *_ladders(), *_drifts(), *_pairs()]
    return tuple(sorted(library, key=lambda entry: list(PARTS).index(entry.part)))


def _loads() -> Iterator[Entry]:
    for number, (case, torques) in enumerate(TORQUES.items()):
        for flank in FLANKS:
            for level, torque in zip(("light", "design", "heavy"), torques, strict=True):
                position = 5 * number % MESH_POSITIONS
                yield Entry(f"{case}-{flank}-{level}", "load", Source(case, flank, torque, mesh_position=position))


def _misaligned() -> Iterator[Entry]:
    for case, (_, torque, _) in TORQUES.items():
        for flank in FLANKS:
            for number, errors in enumerate(MISALIGNMENTS, start=1):
                source = Source(case, flank, torque, *errors, mesh_position=16)
                yield Entry(f"{case}-{flank}-misaligned-{number}", "misaligned", source)


def _cycle() -> Iterator[Entry]:
    sequence = "fh-design-a-cycle"
    for step, position in enumerate(range(0, MESH_POSITIONS, 2)):
        source = Source("fh-design-a", "drive", 100.0, mesh_position=position)
        yield Entry(f"{sequence}-{position:02d}", "cycle", source, sequence=sequence, step=step)


def _fine() -> Iterator[Entry]:
    for base, source in (*BASES.items(), ("fm-11x41", Source("fm-11x41", "drive", 250.0, mesh_position=20))):
        for count in SEGMENTS_PER_LINE:
            yield Entry(f"{base}-fine-{count}", "fine", replace(source, segments_per_line=count))


def _weak() -> Iterator[Entry]:
    for base, source in BASES.items():
        for count in (31, 131):
            for exponent in (-2, -4, -6, -8):
                name = f"{base}-weak-{count}-1e{exponent}"
                fine = replace(source, segments_per_line=count)
                yield Entry(name, "weak", fine, "scaled_local_compliance", 10.0**exponent)


def _dense() -> Iterator[Entry]:
    for case, (_, torque, _) in TORQUES.items():
        source = Source(case, "drive", torque, mesh_position=8)
        yield Entry(f"{case}-dense", "dense", source, dense=True)
    for base, source in BASES.items():
        yield Entry(f"{base}-dense-131", "dense", replace(source, segments_per_line=131), dense=True)
        yield Entry(f"{base}-dense-weak-1e-4", "dense", source, "scaled_local_compliance", 1e-4, dense=True)


def _degenerate() -> Iterator[Entry]:
    for base, source in BASES.items():
        for change, amount, dense in DEGENERATE:
            name = f"{base}-{change.replace('_', '-')}" + (f"-{amount:g}" if amount else "")
            yield Entry(name + ("-dense" if dense else ""), "degenerate", source, change, amount, dense)


def _full_cycles() -> Iterator[Entry]:
    for case, (_, torque, _) in TORQUES.items():
        sequence = f"{case}-full-cycle"
        for position in range(MESH_POSITIONS):
            source = Source(case, "coast" if case == "fh-design-a" else "drive", torque, mesh_position=position)
            yield Entry(f"{sequence}-{position:02d}", "full-cycle", source, sequence=sequence, step=position)


def _ladders() -> Iterator[Entry]:
    for case, (light, _, heavy) in TORQUES.items():
        for flank in FLANKS:
            sequence = f"{case}-{flank}-ladder"
            for step in range(SEQUENCE_STEPS):
                torque = light * (heavy / light) ** (step / (SEQUENCE_STEPS - 1))
                source = Source(case, flank, torque, mesh_position=8)
                yield Entry(f"{sequence}-{step:02d}", "ladder", source, sequence=sequence, step=step)


def _drifts() -> Iterator[Entry]:
    (offset, axial), (last_offset, last_axial) = MISALIGNMENTS
    for case in ("nasa-12x36", "fm-11x41"):
        sequence = f"{case}-drift"
        for step in range(SEQUENCE_STEPS):
            way = step / (SEQUENCE_STEPS - 1)
            errors = offset + way * (last_offset - offset), axial + way * (last_axial - axial)
            source = Source(case, "drive", TORQUES[case][1], *errors, mesh_position=16)
            yield Entry(f"{sequence}-{step:02d}", "drift", source, sequence=sequence, step=step)


def _pairs() -> Iterator[Entry]:
    for base, source in BASES.items():
        for count in PINIONS:
            yield Entry(f"{base}-pinions-{count}", "pairs", source, "several_pinions", float(count))


@dataclass(frozen=True)
class ReferenceAnswer:
    """Reference answer of a problem.

    Parameters
    ----------
    name
        Name of the problem.
    size
        Number of segments.
    elastic_rotation
        Rotation beyond first contact [rad].
    touching
        Number of segments that carry load; -1 where segments at the limit of contact or a singular compliance leave it
        open.
    condition_number
        Condition number of the compliance; infinite where its least eigenvalue is rounding.
    refined_difference, lemke_difference
        Relative difference between the native solver's rotation and that of the refinement and of Lemke's method; NaN
        where the method has no answer or was not tried.

    Examples
    --------
    >>> ReferenceAnswer("two", 2, 1e-4, 2, 10.0, 1e-15, 1e-15).touching
    2
    """

    name: str
    size: int
    elastic_rotation: float
    touching: int
    condition_number: float
    refined_difference: float
    lemke_difference: float


def reference_answers() -> dict[str, ReferenceAnswer]:
    """Shipped reference answers, by name of the problem.

    Examples
    --------
    >>> reference_answers()["nasa-12x36-drive-design"].size
    62
    """
    text = resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8")
    kinds = {field.name: {"str": str, "int": int, "float": float}[str(field.type)] for field in fields(ReferenceAnswer)}
    rows = csv.DictReader(text.splitlines())
    return {row["name"]: ReferenceAnswer(**{key: kinds[key](value) for key, value in row.items()}) for row in rows}
