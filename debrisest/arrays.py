"""Array types shared by all numerics.

Every numeric function takes arrays with leading batch axes: Monte Carlo runs, sigma points and
perturbed copies are leading axes of one call, and shapes are written as ``(..., 3)``.
"""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
BoolArray: TypeAlias = NDArray[np.bool_]
IntArray: TypeAlias = NDArray[np.int64]
ComplexArray: TypeAlias = NDArray[np.complex128]

Data: TypeAlias = dict[str, NDArray[Any]]
"""Named arrays as declared in the vocabulary, most of them with ``run`` as first axis."""
