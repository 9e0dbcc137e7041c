"""Lubricants from their data sheets: viscosities at 40 and 100 degC, density, base oil.

Viscosities follow ASTM D341. Density and pressure-viscosity coefficient are those of ISO/TS 6336-22:2018 (Eq. 17 and 8
to 11), with T in kelvin and the viscosity eta [Pa s] at 38 degC:

    density = density at 15 degC - 0.7 (T - 289),    alpha = s eta^t [1 + 516 (1 / T - 1 / 311)]

The technical specification knows no esters. Theirs is alpha = s v^t, with the kinematic viscosity v at the same
temperature (Gold, Schmidt, Dicke, Loos and Assmann, Journal of Synthetic Lubrication 18, 2001, doi
10.1002/jsl.3000180105).
"""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
import tomli_w
from numpy.typing import NDArray

from ...core.arrays import Array
from ...core.checks import array, instance, number, one_of
from ...core.errors import InputError
from ...core.output_file import whole_file
from .lubricant import KELVIN, THERMAL_CONDUCTIVITY, WALTHER_VISCOSITY, Lubricant

#: s [1/Pa] and t of ISO/TS 6336-22, Eq. 9 to 11, with the viscosity in Pa s.
ISO_CONSTANTS = {"mineral": (2.657e-8, 0.1348), "pao": (1.466e-8, 0.0507), "pag": (1.392e-8, 0.1572)}
#: s [1/Pa] and t of Gold and others, with the viscosity in mm^2/s.
GOLD_CONSTANTS = {"ester": (6.605e-9, 0.136)}
BASE_OILS = (*ISO_CONSTANTS, *GOLD_CONSTANTS)
DATA_SHEET_TEMPERATURES = tuple(float(t) for t in range(20, 121, 10))  # [degC]
SHEET_TEMPERATURES = (40.0, 100.0)  # [degC] at which a data sheet gives the viscosity
REFERENCE_TEMPERATURE = 38.0  # [degC] of the coefficients of ISO/TS 6336-22


def data_sheet_lubricant(
    name: str,
    *,
    viscosity_40: float,
    viscosity_100: float,
    density: float,
    base_oil: str,
    title: str | None = None,
    source: str = "its data sheet",
    temperatures: Sequence[float] | NDArray[np.float64] = DATA_SHEET_TEMPERATURES,
    thermal_conductivity: float = THERMAL_CONDUCTIVITY,
) -> Lubricant:
    """Lubricant from the numbers of a data sheet.

    The pressure-viscosity coefficient is an estimate on the low side: those measured are 9 to 21 % higher for gear
    oils, up to 65 % for plain mineral oils. The film goes with its power of 0.57.

    Parameters
    ----------
    name
        Name of the oil.
    viscosity_40, viscosity_100
        Kinematic viscosity at 40 and 100 degC [mm^2/s].
    density
        At 15 degC [kg/m^3].
    base_oil
        ``mineral``, ``pao`` (polyalphaolefin), ``pag`` (polyalkylene glycol) or ``ester``.
    title, source
        What the lubricant's file says of it.
    temperatures
        Of the lubricant's table [degC], increasing. Far beyond 40 and 100 degC the viscosity is extrapolated.
    thermal_conductivity
        [W/(m K)].

    Raises
    ------
    InputError
        If a number is not possible, the oil is not thinner when hot, or the base oil unknown.

    Examples
    --------
    >>> oil = data_sheet_lubricant("vg220", viscosity_40=220, viscosity_100=19, density=895, base_oil="mineral")
    >>> state = oil.at(70.0)
    >>> print(f"{1e3 * state.viscosity:.1f} mPa s, {1e9 * state.pressure_viscosity:.1f} / GPa")
    44.3 mPa s, 18.3 / GPa
    """
    one_of("base_oil", base_oil, BASE_OILS)
    cold = number("viscosity_40", viscosity_40, "mm^2/s", least=2.0, most=1e5)
    hot = number("viscosity_100", viscosity_100, "mm^2/s", least=1.0, most=1e5)
    if hot >= cold:
        raise InputError(f"viscosity_100 = {hot:g}: must be below viscosity_40 = {cold:g} [mm^2/s]")
    weight = number("density", density, "kg/m^3", least=600.0, most=1500.0)
    celsius = array("temperatures", temperatures, "degC", ndim=1, fewest=2, least=-50.0, most=250.0)

    def kinematic(asked: Array) -> Array:
        nodes, logs = np.log(np.add(SHEET_TEMPERATURES, KELVIN)), np.log(np.log(np.add((cold, hot), WALTHER_VISCOSITY)))
        steepness = (logs[1] - logs[0]) / (nodes[1] - nodes[0])
        double_log = logs[0] + steepness * (np.log(asked + KELVIN) - nodes[0])
        return np.asarray(np.exp(np.exp(double_log)) - WALTHER_VISCOSITY)

    def dynamic(asked: Array) -> Array:
        return 1e-6 * kinematic(asked) * _density(weight, asked)

    if base_oil in ISO_CONSTANTS:
        scale, power = ISO_CONSTANTS[base_oil]
        pressure = scale * dynamic(np.asarray(REFERENCE_TEMPERATURE)) ** power
        pressure = pressure * (1.0 + 516.0 * (1.0 / (celsius + 273.0) - 1.0 / 311.0))
    else:
        scale, power = GOLD_CONSTANTS[base_oil]
        pressure = scale * kinematic(celsius) ** power
    return Lubricant(
        name,
        title if title is not None else f"{base_oil} oil, {cold:g} and {hot:g} mm2/s at 40 and 100 degC",
        f"{source}: {cold:g} and {hot:g} mm2/s at 40 and 100 degC, {weight:g} kg/m3 at 15 degC, base oil {base_oil}; "
        f"viscosity by ASTM D341, density by ISO/TS 6336-22, pressure-viscosity coefficient estimated by "
        + ("ISO/TS 6336-22" if base_oil in ISO_CONSTANTS else "Gold and others 2001"),
        celsius,
        dynamic(celsius),
        pressure,
        _density(weight, celsius),
        thermal_conductivity,
    )


def _density(weight: float, celsius: Array) -> Array:
    """Density [kg/m^3] at temperatures [degC], from that at 15 degC."""
    return np.asarray(weight - 0.7 * (celsius + 273.0 - 289.0))


def lubricant_toml(oil: Lubricant) -> str:
    """Text of a file that ``lubricant`` reads as the given one, to six digits."""

    def digits(values: Array) -> list[float]:
        return [float(f"{value:.6g}") for value in values]

    tables = {
        "temperature": (digits(oil.temperature), "degC"),
        "dynamic_viscosity": (digits(oil.dynamic_viscosity), "Pa s"),
        "pressure_viscosity": (digits(1e9 * oil.pressure_viscosity), "1/GPa"),
    }
    if oil.density is not None:
        tables["density"] = (digits(oil.density), "kg/m3")
    head = tomli_w.dumps({"title": oil.title, "source": oil.source})
    rows = [f"{name} = {values} # {unit}\n" for name, (values, unit) in tables.items()]
    return head + "".join(rows) + f"thermal_conductivity = {oil.thermal_conductivity} # W/(m K)\n"


def write_lubricant(oil: Lubricant, path: str | os.PathLike[str]) -> None:
    """Write a lubricant's file, whole or not at all.

    Parameters
    ----------
    oil
        The lubricant.
    path
        The file, which then can be given as an oil.

    Raises
    ------
    InputError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.friction import lubricant
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_lubricant(lubricant("pao-vg100"), f"{folder}/mine.toml")
    ...     print(lubricant(f"{folder}/mine.toml").name)
    mine
    """
    instance("oil", oil, Lubricant)
    with whole_file(path) as temporary:
        temporary.write_text(lubricant_toml(oil), encoding="utf-8")
