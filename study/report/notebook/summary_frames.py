"""Key numbers of a result as tables of pandas, in the units in which people read them."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..key_numbers import key_numbers
from ..summary.deflection_report import misalignment_over_torque
from ..summary.supports_report import SHARES, bearing_loads

if TYPE_CHECKING:
    import pandas as pd

CONDITIONS = ("torque", "speed", "temperature", "roughness")
TORQUE = "torque [N m]"
#: Units of the data that nobody reads, and what they are shown in: unit and factor.
READ_UNITS = {
    "rad": ("deg", math.degrees(1.0)),
    "N mm": ("N m", 1e-3),
    "rpm": ("1/min", 1.0),
    "1": ("", 1.0),
    "": ("", 1.0),
}


def summary_frames(tree: xr.DataTree) -> dict[str, pd.DataFrame]:
    """Key numbers of a result as tables; a column bears the name of its variable and the unit.

    Parameters
    ----------
    tree
        A result.

    Returns
    -------
    dict of str to pandas.DataFrame
        ``unloaded``: one row. ``misalignment``, if it depends on the torque, and ``supports``, if there are some: means
        over the mesh cycle, a row a torque [N m], the rotations of the gear and the bearing loads. ``loaded``: a row a
        torque. ``friction``, if the result has it: a row an operating condition. Of load cases: ``load_cases`` with a
        row each. Wide ones are best read as ``frame.T``.

    Examples
    --------
    >>> import easeoff
    >>> frames = summary_frames(easeoff.analyze("nasa-12x36", torques=[100.0]))
    >>> list(frames), frames["loaded"].index.tolist(), round(frames["loaded"]["harmonic 1 [urad]"].iloc[0])
    (['unloaded', 'loaded'], [100.0], 115)
    """
    if "load_cases" in tree.children:
        return {"load_cases": frame_over(tree["load_cases"].to_dataset(), ("load_case",))}
    numbers = key_numbers(tree)
    parts: dict[str, list[str]] = {"unloaded": [], "loaded": [], "friction": []}
    for name, variable in numbers.data_vars.items():
        part = "friction" if "speed" in variable.dims else "loaded" if "torque" in variable.dims else "unloaded"
        parts[part].append(str(name))
    indices: dict[str, tuple[str, ...]] = {"unloaded": (), "loaded": CONDITIONS[:1], "friction": CONDITIONS}
    frames = {part: frame_over(numbers[names], indices[part]) for part, names in parts.items() if names}
    assembly = {"misalignment": _misalignment(tree), "supports": _supports(tree)}
    held = {part: frame for part, frame in assembly.items() if frame is not None}
    return {"unloaded": frames.pop("unloaded")} | held | frames


def _misalignment(tree: xr.DataTree) -> pd.DataFrame | None:
    """E, P, G and Sigma over the torque; ``None`` if they do not depend on it."""
    import pandas as pd

    found = misalignment_over_torque(tree)
    if found is None:
        return None
    means = found[1].mean(axis=1)
    means[:, 3] = np.degrees(means[:, 3])
    return pd.DataFrame(
        means, index=pd.Index(found[0], name=TORQUE), columns=["E [mm]", "P [mm]", "G [mm]", "Sigma [deg]"]
    )


def _supports(tree: xr.DataTree) -> pd.DataFrame | None:
    """Parts of the gear's rotation and bearing loads over the torque; ``None`` without supports."""
    import pandas as pd

    if "supports" not in tree.children:
        return None
    group = tree["supports"].to_dataset().sortby("torque")
    rotations = ("whole_rotation", *SHARES.values())
    columns = {f"{name} [urad]": group[name].mean("mesh_position").values for name in rotations}
    for name, radial, axial in zip(*bearing_loads(tree), strict=True):
        columns |= {f"{name}, radial [N]": radial.mean(axis=1), f"{name}, axial [N]": axial.mean(axis=1)}
    return pd.DataFrame(columns, index=pd.Index(group["torque"].values, name=TORQUE))


def frame_over(numbers: xr.Dataset, index: tuple[str, ...]) -> pd.DataFrame:
    """Variables as columns over some dimensions; one with further dimensions takes a column for each of theirs."""
    import pandas as pd

    columns: dict[str, Any] = {}
    for name, variable in numbers.data_vars.items():
        others = [str(dim) for dim in variable.dims if dim not in index]
        whole = variable.transpose(*index, *others)
        flat = whole.values.reshape(*whole.shape[: len(index)], -1)
        # A dimension without values of its own, such as the orders of harmonics, counts from 1.
        along = [numbers[dim].values if dim in numbers.coords else range(1, whole.sizes[dim] + 1) for dim in others]
        for number, place in enumerate(product(*along)):
            head, values = _read(" ".join([str(name), *map(str, place)]), variable, flat[..., number])
            columns[head] = np.ravel(values)
    if not index:
        return pd.DataFrame(columns)
    labels = [_read(name, numbers[name], numbers[name].values) for name in index]
    known = [pd.Index(values, name=head) for head, values in labels]
    return pd.DataFrame(columns, index=known[0] if len(known) == 1 else pd.MultiIndex.from_product(known))


def _read(name: str, variable: xr.DataArray, values: Any) -> tuple[str, Any]:
    """Head and values of a quantity in the unit in which people read it."""
    if "flag_meanings" in variable.attrs:
        words = {
            int(value): word.replace("_", " ")
            for value, word in zip(
                np.atleast_1d(variable.attrs["flag_values"]), str(variable.attrs["flag_meanings"]).split(), strict=True
            )
        }
        return name, np.vectorize(lambda value: words.get(int(value), ""), otypes=[object])(values)
    unit = str(variable.attrs.get("units", ""))
    told, factor = READ_UNITS.get(unit, (unit, 1.0))
    return (f"{name} [{told}]" if told else name), values if factor == 1.0 else factor * values
