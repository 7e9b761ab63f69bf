"""What a filter adds to its covariance from step to step, as a scenario tells it."""

from debrisest.roles import Keys, NonNegative


class ProcessNoise(Keys):
    """What a filter adds per step, 1 sigma per axis."""

    velocity_m_s: NonNegative = 0.0
    """Standard deviation of each component of the velocity."""
    rate_rad_s: NonNegative = 0.0
    """Standard deviation of each component of the rate."""
