"""Reports on settings, as text: of designs, corrections, optimal modifications and searches."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict

import numpy as np
import xarray as xr

from ...core.arrays import Bools
from ...geometry.cutting.named_settings import get_setting, setting_step
from ...geometry.design.blank import BlankDimensions
from ...geometry.deviation.corrective_settings import EFFECT_LIMIT, CorrectedFlank, Correction
from ...geometry.deviation.deviation import zeroed
from ...geometry.deviation.global_errors import angle_errors, fit_global_errors
from ...geometry.pair.gear_pair import MEMBERS, FlankName
from ..case_correction import CaseCorrection
from ..design.design_check import DesignReport, SideReport
from ..design.optimization.trust_region import RADIUS_MINIMUM
from .assembly import ERRORS, deflection_notes
from .quantities import OPTIMIZED, TABLES
from .table import Table


def design_report(report: DesignReport) -> str:
    """Report of a design."""
    parts = [Table(("", "pinion", "gear"), list(_blank_rows(report.blank)), 3, "Blanks").text()]
    for side, item in report.sides.items():
        parts += [f"{side.capitalize()} side: {remaining_ease_off(item)}", _moved(item), _root(item)]
    if report.spaces is not None:
        head, *rows = report.spaces.rows()
        parts.append(Table(head, rows, title="Teeth and slots").text())
    if report.defaults:
        parts.append("\n".join(default_lines(report)))
    return "\n\n".join([*parts, *warning_lines(report)])


def summary_lines(report: DesignReport) -> list[str]:
    """Summary of a design: values taken, a line a side, and the warnings."""
    sides: dict[FlankName, SideReport] = dict(report.sides)
    lines = [*(f"{side}: {remaining_ease_off(item)}" for side, item in sides.items()), *warning_lines(report)]
    return [*default_lines(report), *lines]


def default_lines(report: DesignReport) -> list[str]:
    """Values taken for what the file leaves out, a line each under a heading; none if it leaves out nothing."""
    head = ["Taken for what the file leaves out:"] if report.defaults else []
    return head + [f"  {value}" for value in report.defaults]


def warning_lines(report: DesignReport) -> list[str]:
    """Warnings of a design, a line each."""
    return [f"Warning: {warning}" for warning in report.warnings]


def remaining_ease_off(item: SideReport) -> str:
    """Remaining ease-off of a side after the fit, in one line."""
    within = (
        f"ease-off within {1e3 * item.largest_residual:.2f} um of the target (rms {1e3 * item.rms_residual:.2f} um)"
    )
    common = f"{100 * item.common_flank:.0f} % of the gear flank"
    return f"{within}, up to {1e3 * item.largest_ease_off:.1f} um on the common flank, {common}"


def _root(item: SideReport) -> str:
    gaps = " / ".join(f"{gap:+.3f}" if math.isfinite(gap) else "no flank" for gap in item.root_gap)
    return (
        "Pinion's blade tip above the root cone in the positions that cut the fit's nodes near the root, "
        f"at toe / middle / heel: {gaps} mm"
    )


def _blank_rows(blank: BlankDimensions) -> Iterator[tuple[str, ...]]:
    for name in TABLES["lists"]["of_designs"]:
        unit, factor = ("deg", math.degrees(1.0)) if name.endswith("_angle") else ("mm", 1.0)
        values = (f"{factor * getattr(member, name):.4f}" for member in (blank.pinion, blank.gear))
        yield f"{name.replace('_', ' ')} [{unit}]", *values
    module = f"{blank.mean_normal_module:.4f}"
    yield "mean normal module [mm]", module, module
    for side in ("drive", "coast"):
        angle = f"{math.degrees(getattr(blank, f'generated_{side}_pressure_angle')):.4f}"
        yield f"{side} pressure angle [deg]", angle, angle


def unit_of(name: str) -> str:
    """Unit in which a free setting is printed; empty for a ratio."""
    if name == "blade_curvature":
        return "1/mm"
    return setting_step(name).unit.removeprefix("1")


def _moved(item: SideReport) -> str:
    rows = []
    for name, (start, end) in item.moved.items():
        unit = unit_of(name)
        factor = math.degrees(1.0) if unit.startswith("deg") else 1.0
        values = [f"{factor * value:.5f}" for value in (start, end, end - start)]
        rows.append((f"{name} [{unit}]" if unit else name, *values))
    return Table(("pinion setting", "start", "fitted", "change"), rows).text()


SMALL_GAIN = 0.7  # share of the deviation left above which a correction hardly pays
ROOT_SHARE = 0.2  # of the clearance, a move of the root from which on a warning is given
CONDITION_LIMIT = 1e3  # above which settings are told to do nearly the same


def correction_report(corrections: CaseCorrection) -> str:
    """Global errors of the flanks, settings to be set and predicted rest of every set-up of a case."""
    parts = [
        "\n".join(_set_up_lines(name, correction))
        for name in MEMBERS
        for correction in corrections.corrections.get(name, ())  # type: ignore[call-overload]
    ]
    return "\n\n".join(parts)


def _set_up_lines(name: str, correction: Correction) -> Iterator[str]:
    sides = [flank.side for flank in correction.flanks]
    together = ", one set-up" if len(correction.surfaces) > 1 else ""
    flanks = f"{' and '.join(sides)} flank{'s' if len(sides) > 1 else ''}"
    yield f"{name}, {flanks}{together}: global errors, um of metal at the edges of the flank"
    for flank in correction.flanks:
        yield from _error_lines(flank)
    yield ""
    yield "corrective settings"
    yield Table(("setting", "unit", "designed", "change", "to set"), list(_setting_rows(correction)), 2).text()
    sizes = [
        (flank.side, stage, *_sizes(getattr(flank, key)))
        for flank in correction.flanks
        for stage, key in (("measured", "before"), ("by derivatives", "linear"), ("cut anew", "after"))
    ]
    yield Table(("flank", "um", "rms", "least", "greatest", "sum of squares"), sizes, 2).text()
    yield (
        f"rms {1e3 * correction.rms_before:.2f} um, after the correction {1e3 * correction.rms:.2f} um, as predicted "
        "on flanks cut anew with the settings to set; a rotation of the tooth is left out"
    )
    for flank in correction.flanks:
        if np.any(np.abs(flank.root_change) >= 0.5e-3):
            moved = ", ".join(f"{1e3 * value:+.0f}" for value in flank.root_change)
            yield f"{flank.side} flank: the root moves by {moved} um at toe, middle, heel; negative is deeper"
    yield from (f"Warning: {warning}" for warning in root_warnings(correction))
    yield from _notes(correction)


def root_warnings(correction: Correction) -> Iterator[str]:
    """Warnings of flanks whose corrected settings move the root by ``ROOT_SHARE`` of the clearance or more."""
    free = list(dict.fromkeys(key.partition(".")[0] for key in correction.changes))
    if "point_radius" in free:
        advice = "name fewer settings by --free, or leave the root as it is told here"
    else:
        advice = f"a cutter of another radius holds the depth: --free {','.join([*free, 'point_radius'])}"
    for flank in correction.flanks:
        clearance = flank.member.section.clearance
        known = flank.root_change[np.isfinite(flank.root_change)]
        farthest = float(np.max(np.abs(known), initial=0.0))
        if farthest > 0.0 and farthest >= ROOT_SHARE * clearance:
            yield (
                f"the root of the {flank.side} flank moves by up to {farthest:.2f} mm, of a clearance of "
                f"{clearance:.2f} mm: check slot depth and tip clearance; {advice}"
            )


def _error_lines(flank: CorrectedFlank) -> Iterator[str]:
    turned = zeroed(flank.deviation, flank.member.loaded)
    if min(turned.value.shape) < 3:
        yield f"{flank.side}: too few rows or columns for global errors"
        return
    fit = fit_global_errors(turned)
    angles = dict(zip(("spiral_angle", "pressure_angle"), angle_errors(fit.errors, flank.member), strict=True))
    rows = [
        (key, f"{value:+.1f}", f"{60.0 * math.degrees(angles[key]):+.2f}" if key in angles else "")
        for key, value in asdict(fit.errors).items()
    ]
    yield Table((flank.side, "um", "minutes"), rows).text()
    yield f"rms {fit.rms_before:.2f} um, without these {fit.rms:.2f} um"


def _setting_rows(correction: Correction) -> Iterator[tuple[str, str, str, str, str]]:
    """Name, unit, designed, change and value to set of each free setting."""
    by_side = {flank.side: flank.member.loaded.designed for flank in correction.flanks}
    for key, change in correction.changes.items():
        name, _, which = key.partition(".")
        start = get_setting(by_side[which] if which else correction.flanks[0].member.loaded.designed, name)  # type: ignore[index]
        resolution = setting_step(name)
        written = [resolution.written(value) + 0.0 for value in (start, start + change)]
        digits = resolution.decimals + 3
        difference = f"{written[1] - written[0]:+.{digits}f}" if all(map(math.isfinite, written)) else ""
        designed = f"{written[0]:.{digits}f}" if math.isfinite(written[0]) else resolution.text(start)
        yield key, resolution.unit, designed, difference, resolution.text(start + change)


def _sizes(values: np.ndarray) -> tuple[str, ...]:
    """Root mean square, extremes and sum of squares of deviations [mm], in um."""
    um = 1e3 * values[np.isfinite(values)]
    return f"{np.sqrt(np.mean(um**2)):.2f}", f"{um.min():+.1f}", f"{um.max():+.1f}", f"{np.sum(um**2):.1f}"


def _notes(correction: Correction) -> Iterator[str]:
    for flank in correction.flanks:
        if np.any(flank.missing):
            column, row = np.argwhere(flank.missing)[0] + 1
            yield (
                f"Note: {flank.side} flank: {np.sum(flank.missing)} of {flank.missing.size} points, the first in row "
                f"{row}, column {column}, are left out: the flank with the errors found does not reach them."
            )
    if correction.nothing:
        yield (
            "Note: nothing to correct: no change of these settings by steps of the machine's resolution lessens the "
            "deviation."
        )
        return
    if correction.rms > SMALL_GAIN * correction.rms_before:
        yield (
            "Note: most of the deviation is no error of these settings; the changes hardly pay. Free others, or fewer."
        )
    if len(correction.surfaces) > len(correction.flanks):
        other = next(which for which in correction.surfaces if which != correction.flanks[0].side)
        yield f"Note: the {other} flank is cut in the same set-up and changes, too; it was not measured."
    if correction.loose:
        words = "; ".join(", ".join(combination.settings) for combination in correction.loose)
        count = f"{len(correction.loose)} combination{'s' if len(correction.loose) > 1 else ''}"
        yield (
            f"Note: no measurement tells {count} of settings ({words}), less than {1e3 * EFFECT_LIMIT:g} um rms a "
            "usual step: taken so that the root moves least; to choose otherwise, free fewer."
        )
    if correction.condition > CONDITION_LIMIT:
        yield (
            f"Note: condition {correction.condition:.2g}: some of these settings do nearly the same, and measuring "
            "errors move them far; free fewer."
        )


def modification_report(tree: xr.DataTree) -> str:
    """Report of an optimal modification, from a result of ``modify``."""
    record, surface = tree["optimization"].to_dataset(), tree["modification"].to_dataset()
    extent = np.abs(surface["modification"].values).max()
    parts = [Table(("term", "um"), terms(surface), title=f"Modification, up to {extent:.1f} um").text()]
    torques = [f"{torque:g}" for torque in record["torque"].values]
    for number in range(record.sizes["assembly"]):
        assembly = record.isel(assembly=number)
        rows = [(label.replace("µ", "u"), *changes) for _, label, changes in assembly_rows(assembly)]
        title = f"Before -> after, {assembly_title(assembly, number)}"
        parts.append(Table(("torque [N m]", *torques), rows, title=title).text())
    parts.append("Contact on lines alone, without tooth edges: 'easeoff run' shows what edges carry")
    return "\n\n".join([*parts, *notes(tree)])


def terms(surface: xr.Dataset) -> list[tuple[str, str]]:
    """Terms of a modification and their coefficients [um]."""
    pairs = zip(surface["term"].values, surface["coefficient"].values, strict=True)
    return [(str(name), f"{value:+.2f}") for name, value in pairs]


def assembly_title(group: xr.Dataset, number: int) -> str:
    """Name of an assembly of an optimization."""
    return "case's own assembly" if number == 0 else f"assembly {number}: {_errors(group)}"


def assembly_rows(group: xr.Dataset, arrow: str = " -> ") -> list[tuple[str, str, list[str]]]:
    """Variable, name and both values at each torque of what an optimization records of one assembly."""
    torques = range(group.sizes["torque"])
    return [
        (name, quantity.head, [arrow.join(map(quantity.written, group[name].values[:, t])) for t in torques])
        for name, quantity in OPTIMIZED.items()
    ]


def notes(tree: xr.DataTree) -> list[str]:
    """Warnings and notes: exceeded limits, a search that did not converge, extrapolated deflections."""
    record = tree["optimization"].to_dataset()
    after = record.sel(stage="after").max("assembly")
    lines = []
    ripple, limit = after["peak_to_peak"].values, record.attrs["transmission_error_limit_urad"]
    if np.any(ripple > limit):
        lines.append(
            f"Warning: the transmission error is {ripple.max():.2f} urad peak to peak, above its limit of {limit:g} "
            "urad: raise the limit or the order of the terms"
        )
    ends, most = after["max_end_load"].values, np.atleast_1d(record.attrs["end_load_limit_N_per_mm"])
    if np.any(ends > most):
        worst = int(np.argmax(ends - most))
        lines.append(
            f"Warning: the line load at the edges is {ends[worst]:.0f} N/mm at {after['torque'].values[worst]:g} N m, "
            f"above its limit of {most[worst]:.0f} N/mm"
        )
    if not record.attrs["converged"]:
        lines.append("Note: the search has not converged; more programmes may improve the result")
    greatest = record.attrs["largest_modification_um"]
    if np.abs(tree["modification"].to_dataset()["modification"].values).max() > 0.999 * greatest:
        lines.append(f"Note: the modification reaches its limit of {greatest:g} um")
    return [*lines, *deflection_notes(tree)]


def _errors(group: xr.Dataset) -> str:
    values = {error: error.factor * group[f"{error.name}_error"].item() for error in ERRORS}
    errors = [error.words(value) for error, value in values.items() if value]
    over_torque = "depends_on_torque" in group and bool(group["depends_on_torque"].item())  # older results lack it
    return ", ".join([*errors, *(["deflections over the torque"] if over_torque else [])]) or "none"


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
    """Report of a search for settings, from a result of ``optimize``."""
    record = tree["optimal_settings"].to_dataset()
    parts = [_settings(record), _objectives(record)]
    if record.sizes["quantity_limit"]:
        parts.append(_limits(record))
    if "front" in tree.children:
        parts.append(_front(tree))
    return "\n\n".join([*parts, *_search_notes(record)])


def _settings(record: xr.Dataset) -> str:
    rows, limit_flags = [], _at_limit(record)
    for number, name in enumerate(record["setting"].values.tolist()):
        one = record.isel(setting=number)
        start, value = float(one["setting_start"]), float(one["setting_value"])
        unit = str(one["setting_units"].item())
        reach = abs(value - start) * float(one["ease_off_per_setting"])
        at = "at its limit" if limit_flags[number] else ""
        rows.append((name, unit, f"{start:.6g}", f"{value:.7g}", f"{value - start:+.4g}", f"{reach:.0f}", at))
    return Table(("setting", "unit", "before", "after", "change", "alone [um]", ""), rows, 2, "Settings").text()


def _objectives(record: xr.Dataset) -> str:
    rows = [
        (name, _number(one["objective_start"]), _number(one["objective_value"]), f"{float(one['objective_ratio']):.3f}")
        for number, name in enumerate(record["objective"].values.tolist())
        for one in (record.isel(objective=number),)
    ]
    title = f"Objectives, form {record.attrs['form']}"
    return Table(("greatest", "before", "after", "worst ratio"), rows, title=title).text()


def _limits(record: xr.Dataset) -> str:
    rows = []
    for number, name in enumerate(record["quantity_limit"].values.tolist()):
        one = record.isel(quantity_limit=number)
        cost = float(one["limit_multiplier"])
        gain = f"{cost:.3g}" if cost > MULTIPLIER_MINIMUM else "-"
        rows.append((name, _number(one["limited_start"]), _number(one["limited_value"]), gain))
    return Table(("limit", "before", "after", "gain per unit wider"), rows, title="Limits").text()


def _front(tree: xr.DataTree) -> str:
    front = tree["front"].to_dataset()
    names = front["objective"].values.tolist()
    rows = [
        (str(point), *(_number(value) for value in front["front_value"].values[point]))
        for point in range(front.sizes["point"])
    ]
    return Table(("point", *names), rows, 0, f"Front; the result holds point {front.attrs['chosen_point']}").text()


def _search_notes(record: xr.Dataset) -> list[str]:
    attributes = record.attrs
    lines = []
    if attributes["form"] == "weighted":
        whole = float(record["objective_weight"].sum())
        lines.append(f"Weighted sum of mean ratios: {attributes['objective_total']:.4g}, at the start {whole:.4g}")
    if unrounded := attributes.get("unrounded"):
        exact = np.array_equal(record["setting_value"], record["setting_found"])
        words = "as they are" if exact else "only in 'setting_found': they cannot be analysed, those before are"
        lines.append(f"Note: the settings found cannot be rounded: {unrounded}; the result has them {words}")
    else:
        lines.append(
            f"Rounded: the ease-off changes by up to {attributes['rounding_change_um']:.2g} um, the objective by "
            f"{attributes['rounding_loss']:+.1g}"
        )
    lines += [
        f"{attributes['analyses']} analyses, {attributes['differentiated_analyses']} of them with derivatives; "
        f"{record.sizes['programme']} programmes; teeth built {attributes['teeth_built']} times"
    ]
    if attributes["violation"] > 0.0:
        lines.append(
            f"Warning: limits are passed by {100.0 * attributes['violation']:.2g} % in all: widen limits, free more "
            "settings, or allow more --move"
        )
    lines += _proposals(record)
    names = [str(name) for name in record["setting"].values[_at_limit(record)]]
    if names:
        lines.append(f"Note: at the end of its range is {', '.join(names)}; --move or --limit-setting gives it more")
    lines.append(ENDS[attributes["ended"]])
    if not attributes["edge_contact"]:
        lines.append("The search knows contact on lines alone; the analysis in the result is as the case says of edges")
    if "sample_ratio" in record:
        samples, known = record["sample_ratio"].values, np.max(record["ratio_by_assembly"].values)
        analysed = np.isfinite(samples).all(axis=0)
        lost, worst = np.count_nonzero(~analysed), np.max(samples[:, analysed], initial=0.0)
        lines.append(
            f"In {np.count_nonzero(analysed)} assemblies drawn anew the worst ratio is {worst:.3f}; in those of the "
            f"search {known:.3f}" + f"; {lost} more could not be analysed" * bool(lost)
        )
    return lines


def _proposals(record: xr.Dataset) -> list[str]:
    """Lines on proposed settings: reasons of refusals, and if none was better than the start."""
    reasons, counts = np.unique([one for one in record["refusal"].values.tolist() if one], return_counts=True)
    count, refused = record.sizes["programme"], int(counts.sum())
    lines = [
        f"Refused, not analysed: {number} of {count} proposals: {reason}"
        for reason, number in zip(reasons.tolist(), counts.tolist(), strict=True)
    ]
    if refused == count > 0:
        lines.append("No proposal could be analysed: whether there is something better than the start is not known")
    elif count and not record["accepted"].values.any():
        lines.append(f"None of the {count - refused} proposals that were analysed is better than the start")
    return lines


def _at_limit(record: xr.Dataset) -> Bools:
    """True for the settings (n) at the end of their range."""
    low, value, high = (record[f"setting_{name}"].values for name in ("low", "value", "high"))
    return np.asarray(np.minimum(value - low, high - value) < LIMIT_SHARE * (high - low))


def _number(value: object) -> str:
    return f"{float(np.asarray(value)):.5g}"
