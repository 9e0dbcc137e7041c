"""The linear elastic, isotropic material of a gear member."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...core.checks import bounded, check_fields


@dataclass(frozen=True)
class Material:
    """A linear elastic, isotropic material.

    Parameters
    ----------
    elastic_modulus
        Young's modulus [MPa], positive.
    poisson_ratio
        Poisson's ratio [-], from 0 up to but not including 0.5.

    Raises
    ------
    InputError
        If a value is outside its range or not finite.

    Notes
    -----
    An incompressible material (0.5) is refused because the plane strain and Hertz formulas lose their strict convexity
    there; no gear is made of one.

    Examples
    --------
    >>> steel = Material(206000.0, 0.3)
    >>> round(steel.plane_strain_modulus), round(steel.shear_modulus)
    (226374, 79231)
    """

    elastic_modulus: float = field(metadata=bounded("MPa", above=0.0))
    poisson_ratio: float = field(metadata=bounded(least=0.0, below=0.5))

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def plane_strain_modulus(self) -> float:
        """Modulus of a body that cannot strain along the contact line, E / (1 - nu^2) [MPa]."""
        return self.elastic_modulus / (1.0 - self.poisson_ratio**2)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus, E / (2 (1 + nu)) [MPa]."""
        return self.elastic_modulus / (2.0 * (1.0 + self.poisson_ratio))
