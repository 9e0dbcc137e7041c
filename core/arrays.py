"""Types of arrays in annotations: of any numbers, or of double precision ones only."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
RealArray = NDArray[np.float64]
