"""Assemblies that a search protects: the case's own, given ones, and samples of distributed errors."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from ....cases.deflections import Deflections
from ....core.errors import InputError, suggestion
from ....geometry.pair.assembly import Misalignment
from ...sweep.distribution import Distribution, sample_values

#: Fields of ``Misalignment`` by the names of assembly errors.
ERROR_FIELDS = {"E": "offset", "P": "pinion_axial", "G": "gear_axial", "Sigma": "shaft_angle"}


def sampled_assemblies(
    own: Misalignment, distributions: Mapping[str, Distribution | str], count: int | None, seed: int = 0
) -> list[Misalignment]:
    """Assemblies with errors drawn from distributions, the others being those of one assembly.

    Parameters
    ----------
    own
        The assembly without the distributed errors.
    distributions
        By ``E``, ``P``, ``G`` or ``Sigma`` [mm, degree], of the error itself.
    count
        Number of samples; ``None`` if nothing is distributed.
    seed
        As of ``sweep``.

    Raises
    ------
    InputError
        If an error is unknown, or samples are given without distributions or the other way round.

    Examples
    --------
    >>> found = sampled_assemblies(Misalignment(gear_axial=0.1), {"E": "uniform(-0.02, 0.02)"}, 4)
    >>> len(found), found[0].gear_axial, max(abs(one.offset) for one in found) < 0.02
    (4, 0.1, True)
    """
    chosen = _distributions(distributions)
    if count is not None and not chosen:
        raise InputError(f"samples = {count}: must go with a distribution of an assembly error, as E~normal(0,0.03)")
    if count is None and chosen:
        raise InputError(f"samples: must be given with the distribution of {', '.join(chosen)}, such as 8")
    if count is None:
        return []
    values = sample_values(chosen, count, seed=seed)
    return [_with_errors(own, {name: drawn[number] for name, drawn in values.items()}) for number in range(count)]


def corner_assemblies(own: Misalignment, distributions: Mapping[str, Distribution | str]) -> list[Misalignment]:
    """Assemblies with every bounded error at its least or greatest value, all of them together; none without bounds.

    Samples seldom reach the corners, where most quantities are greatest: without these a worst case over samples says
    little of others.

    Parameters
    ----------
    own, distributions
        As of ``sampled_assemblies``. A normal distribution has no bounds; its error is left as it is.

    Examples
    --------
    >>> spread = {"E": "uniform(-0.02, 0.02)", "P": "uniform(0.0, 0.1)", "G": "normal(0, 0.1)"}
    >>> [(one.offset, one.pinion_axial) for one in corner_assemblies(Misalignment(), spread)]
    [(-0.02, 0.0), (-0.02, 0.1), (0.02, 0.0), (0.02, 0.1)]
    """
    chosen = _distributions(distributions)
    ends = {name: (one.parameters[0], one.parameters[-1]) for name, one in chosen.items() if one.kind != "normal"}
    if not ends:
        return []
    return [_with_errors(own, dict(zip(ends, corner, strict=True))) for corner in itertools.product(*ends.values())]


def _distributions(given: Mapping[str, Distribution | str]) -> dict[str, Distribution]:
    """Distributions by error, parsed; raises InputError if an error is unknown."""
    chosen: dict[str, Distribution] = {}
    for name, one in given.items():
        if name not in ERROR_FIELDS:
            raise InputError(
                f"distribution of {name}: must be of one of {', '.join(ERROR_FIELDS)}{suggestion(name, ERROR_FIELDS)}"
            )
        chosen[name] = one if isinstance(one, Distribution) else Distribution.parsed(one)
    return chosen


def _with_errors(own: Misalignment, errors: Mapping[str, float]) -> Misalignment:
    """The assembly with other errors by name [mm, degree]."""
    fields = {ERROR_FIELDS[name]: float(value) for name, value in errors.items()}
    if "shaft_angle" in fields:
        fields["shaft_angle"] = math.radians(fields["shaft_angle"])
    return replace(own, **fields)


def constant_assemblies(given: Sequence[Misalignment | Deflections]) -> list[Misalignment]:
    """Assemblies, refused where they depend on the torque.

    Raises
    ------
    InputError
        If one depends on the torque.
    """
    found = []
    for one in given:
        if isinstance(one, Deflections):
            raise InputError(
                "misalignment: must be the same at all torques for a search of settings; give the assembly of the "
                "torque that matters"
            )
        found.append(one)
    return found
