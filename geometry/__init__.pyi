from .cutting.blade import Blade as Blade, BladeSection as BladeSection
from .cutting.generating_surface import GeneratingSurface as GeneratingSurface, Hand as Hand
from .cutting.machine import MachineSettings as MachineSettings
from .cutting.named_settings import MachineResolution as MachineResolution, usual_settings as usual_settings
from .design.basic_settings import (
    conjugate_pinion as conjugate_pinion,
    formate_gear as formate_gear,
)
from .design.blank import (
    BlankDesign as BlankDesign,
    BlankDimensions as BlankDimensions,
    blank_dimensions as blank_dimensions,
    blank_section as blank_section,
)
from .design.synthesis import EaseOffTarget as EaseOffTarget, Synthesis as Synthesis, fit_pinion as fit_pinion
from .deviation.corrective_settings import Correction as Correction, corrective_settings as corrective_settings
from .deviation.deviated_flank import departure as departure
from .deviation.deviation import Deviation as Deviation, deviation_from_formula as deviation_from_formula
from .deviation.global_errors import (
    GlobalErrors as GlobalErrors,
    angle_errors as angle_errors,
    fit_global_errors as fit_global_errors,
)
from .flanks.blank_section import BlankSection as BlankSection
from .flanks.flank import Flank as Flank, principal_curvatures as principal_curvatures
from .pair.assembly import Assembly as Assembly, Misalignment as Misalignment
from .pair.gear_pair import (
    FlankName as FlankName,
    GearPair as GearPair,
    Member as Member,
    PairGeometry as PairGeometry,
    ease_off as ease_off,
    flank as flank,
    pair_geometry as pair_geometry,
    shares_set_up as shares_set_up,
)
from .pair.modification import Modification as Modification
from .tooth.tooth_flanks import tooth_angle as tooth_angle
from .tooth.tooth_lattice import (
    LatticeSize as LatticeSize,
    ToothLattice as ToothLattice,
    tooth_lattice as tooth_lattice,
)
from .tooth.tooth_surface import tooth_patches as tooth_patches

__all__: list[str]
