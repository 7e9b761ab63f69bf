"""Random linear systems, and the textbook Kalman filter on them."""

import numpy as np

from debrisest.filters.model import Model


class System:
    """A random linear system that changes at every epoch."""

    def __init__(self, rng, n, m, epochs):
        self.transition = np.linalg.qr(rng.normal(size=(epochs, n, n)))[0]
        self.observation = rng.normal(size=(epochs, m, n))
        self.q, self.r = spread(rng, n), spread(rng, m)

    def model(self, rows=slice(None), jacobians=False):
        model = Model(
            process=lambda x, k: x @ self.transition[k].T,
            measurement=lambda x, k: x @ self.observation[k, rows].T,
            process_noise=self.q,
            measurement_noise=self.r[rows][:, rows],
            error_names=tuple(f"x{i}" for i in range(len(self.q))),
        )
        if not jacobians:
            return model
        return model._replace(
            process_jacobian=lambda _, k: self.transition[k],
            measurement_jacobian=lambda _, k: self.observation[k, rows],
        )

    def kalman(self, x, p, measurements):
        """Information form; the rows of missing components are cut out of the matrices."""
        for k, y in enumerate(measurements):
            if k > 0:
                f = self.transition[k - 1]
                x, p = f @ x, f @ p @ f.T + self.q
            rows = ~np.isnan(y)
            h, r = self.observation[k, rows], self.r[np.ix_(rows, rows)]
            nu, s = y[rows] - h @ x, h @ p @ h.T + r
            weighted = h.T @ np.linalg.inv(r)
            p = np.linalg.inv(np.linalg.inv(p) + weighted @ h)
            x = x + p @ weighted @ nu
            yield x, p, nu @ np.linalg.inv(s) @ nu


def spread(rng, n):
    root = rng.normal(size=(n, n))
    return root @ root.T / n + 0.1 * np.eye(n)


def problem(seed, n, m, runs=3, epochs=8, missing=0.3):
    """A system, a start with its covariance, and measurements (run, epoch, m)."""
    rng = np.random.default_rng(seed)
    system = System(rng, n, m, epochs)
    y = rng.normal(size=(runs, epochs, m))
    y[rng.random(y.shape) < missing] = np.nan
    start = rng.normal(size=(runs, n))
    covariance = np.stack([spread(rng, n) for _ in range(runs)])
    return system, start, covariance, y


def assert_kalman(history, system, start, covariance, y):
    """Estimates of all epochs, kept, are those of the textbook filter."""
    for run in range(len(y)):
        for k, (x, p, nis) in enumerate(system.kalman(start[run], covariance[run], y[run])):
            np.testing.assert_allclose(history.state[run, k], x, rtol=1e-10, atol=1e-10)
            np.testing.assert_allclose(history.covariance[run, k], p, rtol=1e-10, atol=1e-10)
            np.testing.assert_allclose(history.nis[run, k], nis, rtol=1e-8, atol=1e-10)
            np.testing.assert_allclose(history.sigma[run, k], np.sqrt(np.diagonal(p)), rtol=1e-7)
    assert np.array_equal(history.nis_dof, np.isfinite(y).sum(-1))
