from .half_space_cells import HalfSpaceCompliance as HalfSpaceCompliance
from .material import Material as Material
from .shell import Shell as Shell
from .shell_kinematics import ElasticFoundation as ElasticFoundation
from .tooth_dimensions import ToothDimensions as ToothDimensions

__all__: list[str]
