"""From the supports of a case to those of the contact: matrices, and shafts on bearings in the pair's frame."""

from __future__ import annotations

from typing import get_args

import numpy as np

from ..contact.compliance.material import Material
from ..contact.supports.shaft import Bearing, Shaft, ShaftSection, ShaftSupport, ShaftSupports, StiffnessCurve
from ..contact.supports.support import LoadedSupports, MemberAxis, Support, Supports, member_axes
from ..core.checks import instance
from ..core.errors import errors_about
from ..geometry.flanks.blank_section import BlankSection
from ..geometry.pair.assembly import Assembly
from ..geometry.tooth.tooth_flanks import MemberName
from .conversion import case_assembly, sections
from .schema.case_schema import Case
from .schema.supports_table import BearingTable, HousingTable, MemberSupportTable, ShaftTable


def support_system(case: Case) -> LoadedSupports | None:
    """The supports of a case in the frame of its pair without misalignment, or ``None`` if it has none.

    Parameters
    ----------
    case
        A checked case.

    Raises
    ------
    InputError
        If a matrix is none of a support, or a shaft does not hold the member; the message names table and key.

    Examples
    --------
    >>> from easeoff.cases import read_case, with_supports
    >>> case = with_supports(read_case("fm-11x41"), "axle-fm-11x41")
    >>> unloaded = support_system(case).at(np.zeros(6), np.zeros(6))
    >>> [bearing.name for bearing in unloaded.gear.bearings]
    ['flange side', 'far side']
    """
    instance("case", case, Case)
    table = case.supports
    if table is None:
        return None
    assembly = case_assembly(case)
    axes = member_axes(assembly)
    if table.housing is not None:
        return _housing(table.housing, axes, table.wind_up)
    blanks = sections(case)
    pinion, gear = (
        _member(member_table, name, assembly, axis, blank, wind_up=table.wind_up and name == "pinion")
        for member_table, name, axis, blank in zip(
            (table.pinion, table.gear), get_args(MemberName), axes, blanks, strict=True
        )
    )
    both = ShaftSupports(pinion, gear, wind_up=table.wind_up)
    return both.at(np.zeros(6), np.zeros(6)) if both.is_linear else both


def _housing(table: HousingTable, axes: tuple[MemberAxis, MemberAxis], wind_up: bool) -> Supports:
    with errors_about("[supports.housing]"):
        references = (table.pinion_reference, table.gear_reference)
        return Supports.of_matrix(
            references, compliance=table.compliance, stiffness=table.stiffness, axes=axes, wind_up=wind_up
        )


def _member(
    table: MemberSupportTable | None,
    name: MemberName,
    assembly: Assembly,
    axis: MemberAxis,
    blank: BlankSection,
    *,
    wind_up: bool,
) -> ShaftSupport | Support:
    if table is None:
        return Support.rigid()
    with errors_about(f"[supports.{name}]"):
        if table.shaft is not None:
            middle = blank.points(np.array(0.5), np.array(0.5))
            support = ShaftSupport.of(_shaft(table.shaft, table.bearings, float(middle[0])), assembly, name)
            support.at(np.zeros(6))
            return support
        assert table.reference is not None  # the schema sees to it
        if table.compliance is not None:
            return Support(table.reference, table.compliance)
        assert table.stiffness is not None
        return Support.of_stiffness(table.reference, table.stiffness, None if wind_up else axis)


def _shaft(table: ShaftTable, bearings: tuple[BearingTable, ...], reference: float) -> Shaft:
    shaft_sections = []
    for at, section in enumerate(table.sections, start=1):
        with errors_about(f"section {at}:"):
            shaft_sections.append(ShaftSection(**section.model_dump()))
    return Shaft(
        tuple(shaft_sections),
        tuple(_bearing(bearing) for bearing in bearings),
        reference,
        table.seat,
        table.torque_position,
        Material(table.elastic_modulus, table.poisson_ratio),
    )


def _bearing(table: BearingTable) -> Bearing:
    with errors_about(f"bearing {table.name}:"):
        radial, axial, tilting = (
            _stiffness(getattr(table, f"{name}_stiffness"), getattr(table, f"{name}_displacement"))
            for name in ("radial", "axial", "tilting")
        )
        return Bearing(table.name, table.position, radial, axial, tilting)


def _stiffness(
    stiffness: float | tuple[tuple[float, float], ...] | None, displacement: tuple[tuple[float, float], ...] | None
) -> float | StiffnessCurve:
    if displacement is not None:
        loads, values = zip(*displacement, strict=True)
        return StiffnessCurve(loads, values)
    return StiffnessCurve.of_stiffness(stiffness) if isinstance(stiffness, tuple) else float(stiffness or 0.0)
