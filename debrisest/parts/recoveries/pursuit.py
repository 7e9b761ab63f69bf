"""The keys of basis pursuit, whatever the components of the signal are."""

from typing import Annotated

import numpy as np
from pydantic import Field

from debrisest.arrays import Array
from debrisest.recovery.basis_pursuit import Recovered, basis_pursuit
from debrisest.recovery.fourier import dictionary_length
from debrisest.roles import Keys, NonNegative, Positive

Count = Annotated[int, Field(ge=1)]


class PursuitKeys(Keys):
    """How a lasso on a Fourier dictionary is posed and solved."""

    dictionary_ratio: Annotated[float, Field(ge=1, le=1000)] = 2.0
    """Atoms per sample; 1 is the plain transform. Direction cosines have more lines than the
    quaternion: 4 is better."""
    penalty: Positive
    """Weight of the 1-norm in the lasso."""
    joint: bool = False
    """Whether the components share their lines: a line counts with the root of the sum of squares
    over the components; wants a penalty about twice as large."""
    splitting: Positive = 0.1
    """Parameter of the augmented Lagrangian, over the number of atoms."""
    iterations: Count = 300
    """Most iterations."""
    relaxation: Annotated[float, Field(gt=0, lt=2)] = 1.6
    """Over-relaxation; 1 is the plain iteration."""
    tolerance: NonNegative = 1e-3
    """Relative change at which the solver stops; 0: never."""

    def pursue(self, signal: Array) -> Recovered:
        """Return the recovery (run, component, time) of a signal (run, time, component)."""
        components = np.moveaxis(signal, -1, 1)
        return basis_pursuit(
            components,
            np.isfinite(components),
            dictionary_length(components.shape[-1], self.dictionary_ratio),
            self.penalty,
            self.splitting,
            self.iterations,
            relaxation=self.relaxation,
            tolerance=self.tolerance,
            joint=self.joint,
        )
