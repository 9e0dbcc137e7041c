"""A second solver of the smooth line contact, to hold the package's against; it shares no code with it.

Dense Newton steps on a grid that is graded towards the end of the contact; linear elements of pressure, each with its
deflection in closed form; and a penalty on negative pressure in place of complementarity. Oils by Roelands, density by
Dowson and Higginson, in units of the Hertz contact.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PRESSURE, LOGARITHM = 1.98e8, 9.67
RISE, FALL = 2.266e-9, 1.683e-9
PENALTY = 1e6


def films(load: float, speed: float, material: float, modulus: float, viscosity: float) -> tuple[float, float]:
    """Smallest and central film over the radius, from W, U, G, E' [Pa] and the ambient viscosity [Pa s]."""
    hertz = modulus * math.sqrt(load / (2.0 * math.pi))
    scale = 8.0 * load / math.pi  # (a / R)^2
    # Film by Dowson and Higginson, and as much again up to the middle.
    film = 2.65 * speed**0.7 * material**0.54 * load**-0.13 / scale
    x = _graded(101)
    pressure = np.sqrt(np.maximum(1.0 - x**2, 0.0))
    approach = 1.2 * film - float((0.5 * x**2 + _deflection(x) @ pressure).min())
    for nodes in (101, 251, 601):
        finer = _graded(nodes)
        pressure, x = np.interp(finer, x, np.maximum(pressure, 0.0)), finer
        kernel = _deflection(x)
        pressure, approach = _newton(x, kernel, pressure, approach, hertz, load, speed, material, modulus, viscosity)
    gap = 0.5 * x**2 + kernel @ pressure + approach
    return scale * float(gap[np.abs(x) < 1.2].min()), scale * float(np.interp(0.0, x, gap))


def _graded(nodes: int, start: float = -8.0, end: float = 1.5) -> Array:
    x = np.linspace(start, end, 20001)
    density = 1.0 + 6.0 * (np.abs(x) < 1.15) + 10.0 * np.exp(-(((x - 0.93) / 0.12) ** 2))
    share = np.cumsum(density) - density[0]
    return np.interp(np.linspace(0.0, 1.0, nodes), share / share[-1], x)


def _deflection(x: Array) -> Array:
    """Matrix of -1/pi times the integral of P(s) ln|x - s| for P linear between the nodes."""
    away = x[None, :] - x[:, None]
    logarithm = np.log(np.abs(np.where(away == 0.0, 1.0, away)))
    constant, linear = np.diff(away * (logarithm - 1.0)), np.diff(0.5 * away**2 * (logarithm - 0.5))
    second = (linear - away[:, :-1] * constant) / np.diff(x)
    matrix = np.zeros((x.size, x.size))
    matrix[:, 1:] += second
    matrix[:, :-1] += constant - second
    return -matrix / math.pi


def _newton(
    x: Array,
    kernel: Array,
    pressure: Array,
    approach: float,
    hertz: float,
    load: float,
    speed: float,
    material: float,
    modulus: float,
    viscosity: float,
) -> tuple[Array, float]:
    n, step = x.size, np.diff(x)
    span = math.log(viscosity) + LOGARITHM
    exponent = material / modulus * PRESSURE / span
    group = 12.0 * speed * modulus / hertz / (4.0 * hertz / modulus) ** 3
    width = np.zeros(n)
    width[:-1] += 0.5 * step
    width[1:] += 0.5 * step
    face, up = np.arange(n - 1), np.maximum(np.arange(n - 1) - 1, 0)
    ahead = np.where(face > 0, 0.5 * step / step[up], 0.0)
    for _ in range(100):
        gap = 0.5 * x**2 + kernel @ pressure + approach
        p = hertz * np.maximum(pressure, 0.0)
        density = (1.0 + RISE * p) / (1.0 + FALL * p)
        denser = hertz * (RISE - FALL) / (1.0 + FALL * p) ** 2 * (pressure > 0.0)
        base = 1.0 + p / PRESSURE
        mobile = density * np.exp(-span * (base**exponent - 1.0))
        stiffer = span * exponent * base ** (exponent - 1.0) / PRESSURE * hertz * (pressure > 0.0)
        thinner = mobile * (denser / density - stiffer)
        # Flow through the middle of the elements; what the surfaces carry is extrapolated from upstream.
        mean, slope = 0.5 * (gap[1:] + gap[:-1]), np.diff(pressure) / step
        cube = 0.5 * mean**3 / group
        conducts = cube * (mobile[1:] + mobile[:-1])
        mass = density * gap
        flow = -conducts * slope + (1.0 + ahead) * mass[face] - ahead * mass[up]
        by_gap, by_pressure = np.zeros((n - 1, n)), np.zeros((n - 1, n))
        for node in (face, face + 1):
            by_gap[face, node] -= 1.5 * conducts / mean * slope
            by_pressure[face, node] -= cube * thinner[node] * slope
        by_gap[face, face] += (1.0 + ahead) * density[face]
        by_gap[face, up] -= ahead * density[up]
        by_pressure[face, face] += conducts / step + (1.0 + ahead) * denser[face] * gap[face]
        by_pressure[face, face + 1] -= conducts / step
        by_pressure[face, up] -= ahead * denser[up] * gap[up]
        # Mass balance of the nodes, the last row the load; no pressure at both ends.
        system, right = np.zeros((n + 1, n + 1)), np.zeros(n + 1)
        by_all = np.column_stack([by_pressure + by_gap @ kernel, by_gap.sum(axis=1)])
        system[1 : n - 1], right[1 : n - 1] = np.diff(by_all, axis=0), -np.diff(flow)
        inner = np.arange(1, n - 1)
        penalty = PENALTY * width * (pressure < 0.0)
        system[inner, inner] += penalty[inner]
        right[inner] -= (penalty * pressure)[inner]
        system[0, 0] = system[n - 1, n - 1] = 1.0
        system[n, :n], right[n] = width, 0.5 * math.pi - width @ pressure
        scale = 1.0 / np.abs(system).max(axis=1)
        change = np.linalg.solve(system * scale[:, None], right * scale)
        largest = float(np.abs(change[:n]).max())
        damping = min(1.0, 0.15 / largest)
        while damping > 1e-3 and (gap + damping * (kernel @ change[:n] + change[n])).min() <= 0.0:
            damping /= 2.0
        pressure, approach = pressure + damping * change[:n], approach + damping * float(change[n])
        if largest < 1e-8:
            return pressure, approach
    raise RuntimeError(f"no film in 100 Newton steps, last change {largest:g} of the Hertz pressure")
