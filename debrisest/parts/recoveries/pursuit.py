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

    dictionary_ratio: Annotated[float, Field(ge=1, le=1000)] = Field(
        2.0, description="atoms per sample; 1 is the plain transform"
    )
    penalty: Positive = Field(description="lambda of the lasso")
    joint: bool = Field(False, description="whether the components share their lines")
    splitting: Positive = Field(0.1, description="mu of the augmented Lagrangian, over the atoms")
    iterations: Count = 300
    relaxation: Annotated[float, Field(gt=0, lt=2)] = 1.6
    tolerance: NonNegative = 1e-3

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
