"""Report of optimal settings: settings, objectives and limits before and after, multipliers, front, as text."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from tabulate import tabulate

from ..design.optimization.trust_region import RADIUS_MINIMUM

#: Least multiplier that is shown: a smaller one is rounding.
MULTIPLIER_MINIMUM = 1e-6
#: Why a search ended, see ``trust_region.Search``; another end is that of an earlier search.
ENDS = {
    "converged": "A local optimum: nothing nearby is better",
    "steps": "Note: the search ended after its --steps, not converged; go on with --resume, or allow more --steps",
    "no_gain": "Note: the search ended, not converged, where no step gained, down to changes of the ease-off by "
    f"{RADIUS_MINIMUM:g} um and with derivatives by differences; start elsewhere, or free other settings",
    "": "Note: the search, an earlier one, has not converged",
}
#: Share of a setting's range within which it is at the end of it.
LIMIT_SHARE = 1e-3


def setting_report(tree: xr.DataTree) -> str:
    """Report of a search for settings.

    Parameters
    ----------
    tree
        A result of ``optimize``.
    """
    record = tree["optimal_settings"].to_dataset()
    parts = ["Settings", _settings(record), f"Objectives, form {record.attrs['form']}", _objectives(record)]
    if record.sizes["quantity_limit"]:
        parts += ["Limits", _limits(record)]
    if "front" in tree.children:
        parts += [f"Front; the result holds point {tree['front'].attrs['chosen_point']}", _front(tree)]
    return "\n\n".join([*parts, *_notes(record)])


def _settings(record: xr.Dataset) -> str:
    rows, held = [], _at_limit(record)
    for number, name in enumerate(record["setting"].values.tolist()):
        one = record.isel(setting=number)
        start, value = float(one["setting_start"]), float(one["setting_value"])
        unit = str(one["setting_units"].item())
        reach = abs(value - start) * float(one["ease_off_per_setting"])
        at = "at its limit" if held[number] else ""
        rows.append((name, unit, f"{start:.6g}", f"{value:.7g}", f"{value - start:+.4g}", f"{reach:.0f}", at))
    headers = ("setting", "unit", "before", "after", "change", "alone [um]", "")
    return tabulate(rows, headers=headers, disable_numparse=True, colalign=("left", "left", *["right"] * 4, "left"))


def _objectives(record: xr.Dataset) -> str:
    rows = [
        (name, _number(one["objective_start"]), _number(one["objective_value"]), f"{float(one['objective_ratio']):.3f}")
        for number, name in enumerate(record["objective"].values.tolist())
        for one in (record.isel(objective=number),)
    ]
    headers = ("greatest", "before", "after", "worst ratio")
    return tabulate(rows, headers=headers, disable_numparse=True, colalign=("left", *["right"] * 3))


def _limits(record: xr.Dataset) -> str:
    rows = []
    for number, name in enumerate(record["quantity_limit"].values.tolist()):
        one = record.isel(quantity_limit=number)
        cost = float(one["limit_multiplier"])
        told = f"{cost:.3g}" if cost > MULTIPLIER_MINIMUM else "-"
        rows.append((name, _number(one["limited_start"]), _number(one["limited_value"]), told))
    headers = ("limit", "before", "after", "gain per unit wider")
    return tabulate(rows, headers=headers, disable_numparse=True, colalign=("left", *["right"] * 3))


def _front(tree: xr.DataTree) -> str:
    front = tree["front"].to_dataset()
    names = front["objective"].values.tolist()
    rows = [
        (str(point), *(_number(value) for value in front["front_value"].values[point]))
        for point in range(front.sizes["point"])
    ]
    return tabulate(rows, headers=("point", *names), disable_numparse=True, colalign=("right", "right", "right"))


def _notes(record: xr.Dataset) -> list[str]:
    attributes = record.attrs
    found = []
    if attributes["form"] == "weighted":
        whole = float(record["objective_weight"].sum())
        found.append(f"Weighted sum of mean ratios: {attributes['objective_total']:.4g}, at the start {whole:.4g}")
    if unrounded := attributes.get("unrounded"):
        exact = np.array_equal(record["setting_value"], record["setting_found"])
        told = "as they are" if exact else "only in 'setting_found': they cannot be analysed, those before are"
        found.append(f"Note: the settings found cannot be rounded: {unrounded}; the result has them {told}")
    else:
        found.append(
            f"Rounded: the ease-off changes by up to {attributes['rounding_change_um']:.2g} um, the objective by "
            f"{attributes['rounding_loss']:+.1g}"
        )
    found += [
        f"{attributes['analyses']} analyses, {attributes['differentiated_analyses']} of them with derivatives; "
        f"{record.sizes['programme']} programmes; teeth built {attributes['teeth_built']} times",
    ]
    if attributes["violation"] > 0.0:
        found.append(
            f"Warning: limits are passed by {100.0 * attributes['violation']:.2g} % in all: widen limits, free more "
            "settings, or allow more --move"
        )
    found += _proposals(record)
    held = [str(name) for name in record["setting"].values[_at_limit(record)]]
    if held:
        found.append(f"Note: at the end of its range is {', '.join(held)}; --move or --limit-setting gives it more")
    found.append(ENDS[attributes["ended"]])
    if not attributes["edge_contact"]:
        found.append("The search knows contact on lines alone; the analysis in the result is as the case says of edges")
    if "sample_ratio" in record:
        samples, known = record["sample_ratio"].values, np.max(record["ratio_by_assembly"].values)
        analysed = np.isfinite(samples).all(axis=0)
        lost, worst = np.count_nonzero(~analysed), np.max(samples[:, analysed], initial=0.0)
        found.append(
            f"In {np.count_nonzero(analysed)} assemblies drawn anew the worst ratio is {worst:.3f}; in those of the "
            f"search {known:.3f}" + f"; {lost} more could not be analysed" * bool(lost)
        )
    return found


def _proposals(record: xr.Dataset) -> list[str]:
    """What became of the settings that programmes proposed."""
    reasons, counts = np.unique([one for one in record["refusal"].values.tolist() if one], return_counts=True)
    count, refused = record.sizes["programme"], int(counts.sum())
    found = [
        f"Refused, not analysed: {number} of {count} proposals: {reason}"
        for reason, number in zip(reasons.tolist(), counts.tolist(), strict=True)
    ]
    if refused == count > 0:
        found.append("No proposal could be analysed: whether there is something better than the start is not known")
    elif count and not record["accepted"].values.any():
        found.append(f"None of the {count - refused} proposals that were analysed is better than the start")
    return found


def _at_limit(record: xr.Dataset) -> NDArray[np.bool_]:
    """Which settings (n) are at the end of their range."""
    low, value, high = (record[f"setting_{name}"].values for name in ("low", "value", "high"))
    return np.asarray(np.minimum(value - low, high - value) < LIMIT_SHARE * (high - low))


def _number(value: object) -> str:
    return f"{float(np.asarray(value)):.5g}"
