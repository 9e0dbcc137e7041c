"""Lubricants: viscosity, pressure-viscosity coefficient and density against temperature, from tables in TOML files.

Between the temperatures of a table the kinematic viscosity v [mm^2/s] follows Walther's law as in ASTM D341,

    log10 log10 (v + 0.7) = A - B log10 T,

with T the absolute temperature and A and B of the two neighbours: two temperatures are enough, and a table of more is
met at each.

From a data sheet, with viscosities at 40 and 100 degC, density and base oil, viscosities follow ASTM D341. Density and
pressure-viscosity coefficient are those of ISO/TS 6336-22:2018 (Eq. 17 and 8 to 11), with T in kelvin and the viscosity
eta [Pa s] at 38 degC:

    density = density at 15 degC - 0.7 (T - 289),    alpha = s eta^t [1 + 516 (1 / T - 1 / 311)]

The technical specification knows no esters. Theirs is alpha = s v^t, with the kinematic viscosity v at the same
temperature (Gold, Schmidt, Dicke, Loos and Assmann, Journal of Synthetic Lubrication 18, 2001, doi
10.1002/jsl.3000180105).
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import tomli_w
from numpy.typing import NDArray

from ...core.arrays import Array, Bools, record
from ...core.checks import array, instance, number, one_of, shown
from ...core.errors import InputError, suggestion
from ...core.output_file import whole_file
from ...core.regular_file import TOML_SIZE_LIMIT, named, read_text
from ...core.toml_text import toml_tables

Interpolation = Literal["walther", "log_linear"]
OutOfRange = Literal["error", "clamp"]
LUBRICANTS_FOLDER = Path(__file__).parent
THERMAL_CONDUCTIVITY = 0.14  # [W/(m K)], usual for oils; only the thermal factor of the rolling traction asks for it
# Factor, unit, least and greatest value, to find values in another unit.
PLAUSIBLE_RANGES = {
    "temperature": (1.0, "degC", -100.0, 400.0),
    "dynamic_viscosity": (1.0, "Pa s", 1e-5, 1e4),
    "pressure_viscosity": (1e9, "1/GPa", 1.0, 100.0),
    "density": (1.0, "kg/m^3", 300.0, 3000.0),
    "thermal_conductivity": (1.0, "W/(m K)", 0.01, 10.0),
}
WARM_VISCOSITY_LIMIT = 1.0  # [Pa s] at the warmest temperature of a table
#: [kg/m^3] Of an oil of unknown density, for its kinematic viscosity between the temperatures of its table: 100 kg/m^3
#: more or less change the viscosity there by 0.6 % at most.
ASSUMED_DENSITY = 850.0
WALTHER_VISCOSITY = 0.7  # [mm^2/s] added to the kinematic viscosity
WALTHER_MINIMUM = 0.5  # [mm^2/s] below which Walther's law is not used; its double logarithm ends at 0.3
KELVIN = 273.15  # of 0 degC
KEYS = {"title", "source", "temperature", "dynamic_viscosity", "pressure_viscosity", "density", "thermal_conductivity"}


@record(frozen=True)
class OilState:
    """A lubricant at temperatures (...).

    Parameters
    ----------
    viscosity
        Dynamic viscosity at ambient pressure [Pa s].
    pressure_viscosity
        Pressure-viscosity coefficient [1/Pa].
    temperature_viscosity
        Fall of the viscosity's logarithm with temperature [1/K].
    density
        [kg/m^3]; NaN if the lubricant's source gives none.
    thermal_conductivity
        [W/(m K)].
    clamped
        Whether the temperature lies outside the lubricant's table and its end was taken instead.

    Examples
    --------
    >>> state = lubricant("75w90").at([60.0, 120.0], out_of_range="clamp")
    >>> state.viscosity.round(4), state.clamped
    (array([0.0341, 0.0106]), array([False,  True]))
    """

    viscosity: Array
    pressure_viscosity: Array
    temperature_viscosity: Array
    density: Array
    thermal_conductivity: float
    clamped: Bools


@record(frozen=True)
class Lubricant:
    """A lubricant's properties at some temperatures (n).

    Parameters
    ----------
    name, title, source
        Kind of oil, and source of the numbers.
    temperature
        [degC], increasing.
    dynamic_viscosity
        [Pa s].
    pressure_viscosity
        [1/Pa].
    density
        [kg/m^3], or ``None`` if not known; no friction model asks for it.
    thermal_conductivity
        [W/(m K)].

    Raises
    ------
    InputError
        If the temperatures do not increase, or an array has another length, values that are not positive, or
        values that no oil has.

    Examples
    --------
    >>> oil = Lubricant("own", "An oil", "its data sheet", [40.0, 100.0], [0.08, 0.01], [2e-8, 1.5e-8])
    >>> print(f"{oil.at(70.0).viscosity:.4f} Pa s")
    0.0235 Pa s
    """

    name: str
    title: str
    source: str
    temperature: Array
    dynamic_viscosity: Array
    pressure_viscosity: Array
    density: Array | None = None
    thermal_conductivity: float = THERMAL_CONDUCTIVITY

    def __post_init__(self) -> None:
        for key in ("name", "title", "source"):
            instance(key, getattr(self, key), str)
        size = None
        for key, (factor, unit, low, high) in PLAUSIBLE_RANGES.items():
            values, name = getattr(self, key), f"{key} of lubricant {self.name}"
            if key == "thermal_conductivity":
                number(name, values, unit, least=low, most=high)
            elif values is not None or key != "density":
                values = array(name, values, ndim=1, size=size, fewest=2, infinite=True)
                array(name, factor * values, unit, least=low, most=high)
                object.__setattr__(self, key, values)
                size = values.size
        if not np.all(np.diff(self.temperature) > 0.0):
            given = shown(self.temperature.tolist())
            raise InputError(f"temperature of lubricant {self.name} = {given}: must increase")
        rising = np.flatnonzero(np.diff(self.dynamic_viscosity) > 0.0)
        if rising.size:
            both = [shown(self.dynamic_viscosity[rising[0] + k]) for k in (0, 1)]
            raise InputError(
                f"dynamic_viscosity of lubricant {self.name} = {both[0]}, {both[1]}: must fall as the temperature rises"
            )
        least = np.min(self.dynamic_viscosity)
        if least > WARM_VISCOSITY_LIMIT:
            raise InputError(
                f"dynamic_viscosity of lubricant {self.name} = {least:g}: must be up to {WARM_VISCOSITY_LIMIT:g} "
                "[Pa s] where the oil is warm; 1 mPa s is 0.001 Pa s"
            )

    def at(
        self, temperature: Any, *, interpolation: Interpolation = "walther", out_of_range: OutOfRange = "error"
    ) -> OilState:
        """The lubricant at temperatures (...) [degC].

        Parameters
        ----------
        temperature
            [degC].
        interpolation
            Of the viscosity between the table's temperatures. ``walther``: ASTM D341. ``log_linear``: its logarithm is
            linear, which is too thick between distant temperatures; so it is in any case if the table goes below 0.5
            mm^2/s, where ASTM D341 ends. The pressure-viscosity coefficient and the density are linear.
        out_of_range
            What to do outside of the table: ``error``, or ``clamp`` to its end and say so in the result.

        Raises
        ------
        InputError
            If a temperature is out of range and not to be clamped, or an option is unknown.
        """
        one_of("out_of_range", out_of_range, get_args(OutOfRange))
        one_of("interpolation", interpolation, get_args(Interpolation))
        asked = array("temperature", temperature, "degC", fewest=1, anything=True)
        low, high = self.temperature_range
        clamped = ~((asked >= low) & (asked <= high))
        if np.any(np.isnan(asked)) or (out_of_range == "error" and np.any(clamped)):
            raise InputError(
                f"temperature = {asked[clamped].flat[0]:g}: must be from {low:g} to {high:g} [degC], the data of "
                f"lubricant {self.name}; or clamp it to the end with out_of_range='clamp' (--clamp-temperature)"
            )
        temperatures = np.clip(asked, low, high)
        by_law = interpolation == "walther" and bool(np.all(self._kinematic > WALTHER_MINIMUM))
        viscosity, slope = self._walther(temperatures) if by_law else self._log_linear(temperatures)
        density = np.full(self.temperature.shape, np.nan) if self.density is None else self.density
        return OilState(
            viscosity=np.asarray(viscosity),
            pressure_viscosity=np.asarray(np.interp(temperatures, self.temperature, self.pressure_viscosity)),
            temperature_viscosity=np.asarray(slope),
            density=np.asarray(np.interp(temperatures, self.temperature, density)),
            thermal_conductivity=self.thermal_conductivity,
            clamped=np.asarray(clamped),
        )

    @property
    def temperature_range(self) -> tuple[float, float]:
        """Ends of the table [degC]."""
        return float(self.temperature[0]), float(self.temperature[-1])

    @property
    def _kinematic(self) -> Array:
        """Kinematic viscosity at the table's temperatures [mm^2/s]."""
        density = ASSUMED_DENSITY if self.density is None else self.density
        return np.asarray(1e6 * self.dynamic_viscosity / density)

    def _log_linear(self, degrees: Array) -> tuple[Array, Array]:
        """Viscosity [Pa s] whose logarithm is linear between the table's temperatures, and its fall [1/K]."""
        logarithms = np.log(self.dynamic_viscosity)
        # Slopes belong to the middles of the intervals; between those they change linearly, beyond they stay.
        slope = -np.diff(logarithms) / np.diff(self.temperature)
        viscosity = np.exp(np.interp(degrees, self.temperature, logarithms))
        return viscosity, np.interp(degrees, _middles(self.temperature), slope)

    def _walther(self, degrees: Array) -> tuple[Array, Array]:
        """Viscosity [Pa s] by ASTM D341, and the fall of its logarithm [1/K]."""
        density = np.full_like(self.temperature, ASSUMED_DENSITY) if self.density is None else self.density
        kelvin, nodes = np.log(degrees + KELVIN), np.log(self.temperature + KELVIN)
        double_logs = np.log(np.log(self._kinematic + WALTHER_VISCOSITY))
        grown = np.exp(np.exp(np.interp(kelvin, nodes, double_logs)))  # v + 0.7
        viscosity = 1e-6 * np.interp(degrees, self.temperature, density) * (grown - WALTHER_VISCOSITY)
        # The slope of the law is that of an interval in its middle, and changes linearly from one middle to the next.
        steepness = np.interp(kelvin, _middles(nodes), -np.diff(double_logs) / np.diff(nodes))
        thinning = steepness * grown * np.log(grown) / (grown - WALTHER_VISCOSITY) / (degrees + KELVIN)
        slope = -np.diff(np.log(density)) / np.diff(self.temperature)
        expansion = np.interp(degrees, _middles(self.temperature), slope)
        return viscosity, thinning + expansion


def _middles(nodes: Array) -> Array:
    return np.asarray(0.5 * (nodes[1:] + nodes[:-1]))


def available_lubricants() -> list[str]:
    """Names of the lubricants that come with the package.

    Examples
    --------
    >>> available_lubricants()
    ['75w90', 'heavy-mineral', 'mineral-vg100', 'pao-vg100']
    """
    return sorted(path.stem for path in LUBRICANTS_FOLDER.glob("*.toml"))


def is_shipped(name: str) -> bool:
    """True if a lubricant of this name, in any case of its letters, comes with the package."""
    return name.lower() in available_lubricants()


def lubricant(name: str | os.PathLike[str] | Lubricant, folder: str | os.PathLike[str] | None = None) -> Lubricant:
    """A lubricant by name, in any case, or from a TOML file of one's own.

    Parameters
    ----------
    name
        One of ``available_lubricants``, or the path of a TOML file with the same keys: ``title``, ``source``,
        ``temperature`` [degC], ``dynamic_viscosity`` [Pa s], ``pressure_viscosity`` [1/GPa], and if known ``density``
        [kg/m^3] and ``thermal_conductivity`` [W/(m K)].
    folder
        Where a relative path starts; the working folder if left out.

    Raises
    ------
    InputError
        If there is no such lubricant or file, or the file has other keys or values that cannot be.

    Examples
    --------
    >>> print(lubricant("75W90").title)
    75W90 axle oil
    """
    if isinstance(name, Lubricant):
        return name
    if not isinstance(name, str | os.PathLike):
        raise InputError(f"oil = {shown(name)}: must be the name of a lubricant, the path of its file, or a Lubricant")
    text = os.fspath(name)
    path = LUBRICANTS_FOLDER / f"{text.lower()}.toml" if is_shipped(text) else Path(folder or "", text)
    if not os.path.isfile(path):  # unlike Path.is_file it takes a name of any length
        start = "the working folder" if folder is None else "the folder of the case"
        raise InputError(
            f"oil = {text!r}: neither one of {', '.join(available_lubricants())} nor the path of a TOML file: there is "
            f"no {path.absolute()}; a relative path starts from {start}{suggestion(text, available_lubricants())}"
        )
    try:
        content = read_text(path, TOML_SIZE_LIMIT)
    except InputError as error:
        raise InputError(f"oil = {text!r}: {error}") from error
    return _from_table(path, toml_tables(content, named(path)))


def _from_table(path: Path, data: Mapping[str, Any]) -> Lubricant:
    """A lubricant from the contents of its file."""
    unknown, missing = set(data) - KEYS, KEYS - set(data) - {"density", "thermal_conductivity"}
    if unknown or missing:
        what = [f"unknown key {key}" for key in sorted(unknown)] + [f"no key {key}" for key in sorted(missing)]
        raise InputError(f"{path}: {', '.join(what)}; a lubricant has the keys {', '.join(sorted(KEYS))}")
    try:
        values: dict[str, Any] = {
            key: np.array(data[key], dtype=float)
            for key in ("temperature", "dynamic_viscosity", "pressure_viscosity", "density")
            if key in data
        }
        values["thermal_conductivity"] = float(data.get("thermal_conductivity", THERMAL_CONDUCTIVITY))
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{path}: temperature and properties must be lists of numbers: {error}") from error
    values["pressure_viscosity"] = 1e-9 * values["pressure_viscosity"]
    return Lubricant(path.stem, str(data["title"]), str(data["source"]), **values)


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
    tables = {
        "temperature": (oil.temperature, "degC"),
        "dynamic_viscosity": (oil.dynamic_viscosity, "Pa s"),
        "pressure_viscosity": (1e9 * oil.pressure_viscosity, "1/GPa"),
        **({} if oil.density is None else {"density": (oil.density, "kg/m3")}),
    }
    head = tomli_w.dumps({"title": oil.title, "source": oil.source})
    rows = [f"{name} = {[float(f'{v:.6g}') for v in values]} # {unit}\n" for name, (values, unit) in tables.items()]
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
