"""Whether an arc explains its data: chi-square, and slow errors far below the noise of an epoch.

The chi-square alone accepts wrong answers whose errors hide below the noise. So the epochs are put
in blocks and the mean offset of each is tested against zero, once in inertial axes and once in
those of the body: attitudes at the bound leave nothing that lasts.
"""

from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.batch.arc import UNKNOWNS, Arc, along
from debrisest.batch.evidence import Evidence, Told
from debrisest.batch.point_sums import KnownPoints

_BLOCKS = 20
_SIGMAS = 5.0  # of the chi-square distribution
LEAST_NOISE = 0.1  # chi2/dof below which what lasts is measured against the given noise
_NOISE_AS_SAID = 1.1  # chi2/dof, noise is seldom known better than to five per cent


class Fit(NamedTuple):
    """Tests of an arc against its data."""

    chi2: float
    dof: float
    blocks: Array
    """Chi-square of the mean offset of each block per degree of freedom, the worse of two."""
    block_times: Array
    """Limits of the blocks (block + 1), s."""
    offset: float
    """Of all blocks together, per degree of freedom, with the noise as it is found."""
    offset_limit: float

    @property
    def excess(self) -> float:
        """Chi2/dof: the variance of the noise in units of the one given."""
        return self.chi2 / self.dof

    @property
    def steady(self) -> bool:
        """Whether no block is off."""
        return self.offset < self.offset_limit

    @property
    def noise_below(self) -> bool:
        """Whether the residuals are at most as large as the given noise has them."""
        return bool(self.excess < _NOISE_AS_SAID + _SIGMAS * np.sqrt(2.0 / self.dof))


def tested(evidence: Evidence, arc: Arc) -> Fit:
    """Return the tests of an arc."""
    if isinstance(evidence, KnownPoints) and compiled.available():
        chi2, values, limits, measured = _by_loops(evidence, arc)
    else:
        chi2, values, limits, measured = _by_numpy(evidence, arc)
    fitted = UNKNOWNS - evidence.unknowns_fixed
    dof = max(float(measured) - fitted, 1.0)
    excess = max(chi2 / dof, 1e-12)
    worst = max(values, key=lambda value: float(value.sum())) / max(excess, LEAST_NOISE)
    dof_blocks = max(3.0 * len(worst) - fitted, 3.0)
    limit = 1.0 + _SIGMAS * np.sqrt(2.0 / dof_blocks)
    offset = float(worst.sum()) / dof_blocks
    return Fit(dof * excess, dof, worst / 3.0, limits, offset, float(limit))


def _by_numpy(evidence: Evidence, arc: Arc) -> tuple[float, Array, Array, float]:
    """Chi-square, that of the blocks' offsets in two frames, the blocks' limits, and all dof."""
    q, rate = along(arc, evidence.times)
    told = evidence.settled(q).told(q, rate)
    owner, limits = _blocks(evidence)
    turned = told if evidence.of_rate else _in_body(told, q)
    values = np.stack([_offsets(part, owner, owner.max() + 1) for part in (told, turned)])
    return float(told.chi2.sum()), values, limits, float(evidence.dof.sum())


def _by_loops(evidence: KnownPoints, arc: Arc) -> tuple[float, Array, Array, float]:
    """The same by compiled loops."""
    from debrisest.batch.window_loops import offsets

    q, _ = along(arc, evidence.times)
    return offsets(evidence.times, np.ascontiguousarray(q.T), evidence.loop_sums, _BLOCKS)


def _blocks(evidence: Evidence) -> tuple[IntArray, Array]:
    """Return the block of each epoch, equal shares of what is measured, and the blocks' limits."""
    share = np.cumsum(evidence.dof) / max(float(evidence.dof.sum()), 1.0)
    count = min(_BLOCKS, max(len(evidence.times) // 3, 1))
    owner = np.minimum((share * count * (1.0 - 1e-12)).astype(np.int64), count - 1)
    starts = np.searchsorted(owner, np.arange(count))
    ends = evidence.times[[*np.minimum(starts, len(owner) - 1), -1]]
    return owner, ends


def _offsets(told: Told, owner: IntArray, count: int) -> Array:
    """Chi-square (block,) of the blocks' mean offsets, three degrees of freedom each."""
    pull, hold = np.zeros((count, 3)), np.zeros((count, 3, 3))
    np.add.at(pull, owner, told.pull)
    np.add.at(hold, owner, told.hold)
    offset = np.linalg.pinv(hold, 1e-10, hermitian=True) @ pull[..., None]
    return np.asarray(np.sum(pull * offset[..., 0], axis=-1))


def _in_body(told: Told, q: Array) -> Told:
    attitude = quaternion.to_matrix(q)
    back = np.swapaxes(attitude, -1, -2)
    return Told(told.chi2, (back @ told.pull[..., None])[..., 0], back @ told.hold @ attitude)
