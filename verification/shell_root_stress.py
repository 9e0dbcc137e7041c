"""Estimate of the root stress from the shell: section forces in its root springs, times a notch factor.

The springs along the root line carry moment M, shear force V and axial force N per length of it. The nominal stress of
the plate's section on the loaded side is 6 M / t^2 + N / t; the fillet raises it by the factor of Dolan and Broghamer
(1942), in the form of AGMA 908-B89,

    K = H + (t / r)^L (t / h)^M,  h = M / V,  H = 0.331 - 0.436 a,  L = 0.324 - 0.492 a,  M = 0.261 + 0.545 a,

with the radius r of the fillet, taken as the cutter's edge radius, and the pressure angle a [rad].
"""

from __future__ import annotations

import math

import numpy as np

from ..contact.compliance import Shell, shell_kinematics as kinematics
from ..contact.compliance.shell import root_shapes
from ..core.arrays import Array
from ..core.checks import array, instance, number, positive
from ..core.errors import InputError


def root_section_forces(shell: Shell, arc: Array, load_vectors: Array) -> Array:
    """Forces and moments of the root springs, per length of the root line (5, s, n) [N/mm and N].

    At arc lengths from the toe (s) [mm], in the order of ``shell_kinematics``; a clamped root is refused.
    """
    if shell.foundation is None:
        raise InputError("foundation = None: must be springs, a clamped root has none whose forces could be read")
    functions = shell.functions
    along = functions.along_trace(arc)[0]
    vectors = root_shapes(shell.kinematics, functions)[:, None, :, :, None] * along[:, None, None, :]
    motion = shell.whiten(vectors.reshape(-1, shell.size)).T @ shell.whiten(load_vectors)
    springs = shell.foundation.stiffness(shell.dimensions.thickness(0.0, arc), shell.material)
    motion = motion.reshape(kinematics.NUMBER_OF_ROOT_QUANTITIES, arc.size, -1)
    return np.asarray(np.einsum("sab,bsn->asn", springs, motion))


def notch_factor(thickness: Array, radius: float, height: Array, pressure_angle: float) -> Array:
    """Dolan and Broghamer's factor on the nominal stress, from lengths [mm] and an angle [rad]."""
    base, by_radius, by_height = (a + b * pressure_angle for a, b in ((0.331, -0.436), (0.324, -0.492), (0.261, 0.545)))
    return np.asarray(base + (thickness / radius) ** by_radius * (thickness / height) ** by_height)


def shell_root_stress(
    shell: Shell, arc: Array, load_vectors: Array, fillet_radius: float, pressure_angle: float
) -> Array:
    """Estimated tensile stress (s, n) [MPa] in the root of the loaded side.

    Parameters
    ----------
    shell, arc, load_vectors
        As ``root_section_forces``.
    fillet_radius
        [mm].
    pressure_angle
        Of the loaded flank [rad].

    Raises
    ------
    InputError
        If the root is clamped or the fillet has no radius.

    Examples
    --------
    >>> from easeoff.contact import STEEL, ElasticFoundation, Shell, ToothDimensions
    >>> tooth = ToothDimensions(30.0, 90.0, 10.0, 10.0, 4.0, 4.0, 4.0, 4.0)
    >>> shell = Shell(tooth, STEEL, foundation=ElasticFoundation())
    >>> load = shell.load_vectors(np.array([8.0]), np.array([15.0]), (0.0, 0.0, 1.0))
    >>> stress = shell_root_stress(shell, np.array([5.0, 15.0]), 1000.0 * load, 1.0, pressure_angle=0.35)
    >>> bool(stress[1, 0] > stress[0, 0] > 0.0)
    True
    """
    instance("shell", shell, Shell)
    arc = array("arc", arc, "mm", ndim=1, fewest=1)
    load_vectors = array("load_vectors", load_vectors, ndim=2)
    positive("fillet_radius", fillet_radius, "mm")
    number("pressure_angle", pressure_angle, "rad", above=-0.5 * math.pi, below=0.5 * math.pi)
    forces = root_section_forces(shell, arc, load_vectors)
    thickness = shell.dimensions.thickness(0.0, arc)[:, None]
    moment, shear = np.abs(forces[kinematics.ROOT_ROTATION]), np.abs(forces[kinematics.ROOT_DEFLECTION])
    height = np.maximum(moment, 1e-12) / np.maximum(shear, 1e-12)
    # Far from the load moment and shear lose touch; heights above the tooth's own, or none, make no notch.
    height = np.clip(height, 0.2 * shell.dimensions.largest_height, shell.dimensions.largest_height)
    nominal = 6.0 * moment / thickness**2 + forces[kinematics.ROOT_HEIGHT_SHIFT] / thickness
    return np.asarray(notch_factor(thickness, fillet_radius, height, pressure_angle) * np.maximum(nominal, 0.0))
