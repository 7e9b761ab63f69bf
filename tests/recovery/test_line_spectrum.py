"""Lines off the grid against linear least-squares theory, finite differences and closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import check_grad

from debrisest.recovery.basis_pursuit import basis_pursuit
from debrisest.recovery.line_fit import Signals, fit_lines, refine_lines
from debrisest.recovery.line_spectrum import LineStatus, line_spectrum

seeds = st.integers(0, 2**32 - 1)
TIME, COMPONENTS = 300, 3
FREQUENCY = 2 * np.pi / np.array([61.7, 23.31, 14.9])
NOISE = 0.05


def amplitudes(rng):
    """Of cosine and sine, by line and component: moduli from 0.3 to 1."""
    modulus = rng.uniform(0.3, 1.0, (len(FREQUENCY), COMPONENTS))
    return modulus * np.exp(2j * np.pi * rng.random(modulus.shape))


def sines(amplitude, frequency=FREQUENCY):
    """The signal (time, component), of the real parts of rotating amplitudes, and a constant."""
    turning = np.exp(1j * np.outer(np.arange(TIME), frequency))
    return np.real(turning @ amplitude) + np.array([0.3, 0.0, -1.0])


def with_gaps(rng):
    """About a fifth not observed, in five gaps."""
    observed = np.ones(TIME, bool)
    for begin in range(20, TIME, 60):
        observed[begin + rng.integers(0, 20) :][: rng.integers(8, 16)] = False
    return observed


def jacobian(amplitude):
    """Of the signal (time x component) with its unknowns, written out from the sum of sines."""
    t = np.arange(TIME)
    turning = np.exp(1j * np.outer(t, FREQUENCY))
    linear = np.concatenate([np.ones((TIME, 1)), turning.real, -turning.imag], axis=1)
    moved = np.real(1j * t[:, None, None] * turning[..., None] * amplitude)
    blocks = [np.kron(linear, np.eye(COMPONENTS)), np.swapaxes(moved, 1, 2).reshape(-1, 3)]
    return np.concatenate(blocks, axis=1)


def noisy_runs(seed, runs, deviation=NOISE):
    """Truth (time, component), its amplitudes, the epochs observed and samples of many runs."""
    rng = np.random.default_rng(seed)
    amplitude, observed = amplitudes(rng), with_gaps(rng)
    truth = sines(amplitude)
    noise = rng.standard_normal((runs, TIME, COMPONENTS)) * np.reshape(deviation, (-1, 1))
    return truth, amplitude, observed, np.where(observed[:, None], truth + noise, np.nan)


def within(values, expected, deviations=5.0):
    """Whether the mean of independent values is what is expected, as far as they can tell."""
    return abs(np.mean(values) - expected) < deviations * np.std(values) / len(values) ** 0.5


@pytest.mark.parametrize("seed", range(4))
def test_errors_are_those_of_least_squares_where_observed_and_in_the_gaps(seed):
    """sigma^2 tr(J (J^T J)^-1 J^T): as many sigma^2 as unknowns where observed, less is no luck."""
    truth, amplitude, observed, samples = noisy_runs(seed, 200)
    found = line_spectrum(samples)
    assert np.mean(np.isfinite(found.frequency).sum(axis=-1) == 3) > 0.97
    assert (found.status == LineStatus.COMPLETE).mean() > 0.97
    slopes = jacobian(amplitude).reshape(TIME, COMPONENTS, -1)
    seen, hidden = slopes[observed].reshape(-1, 24), slopes[~observed].reshape(-1, 24)
    covariance = np.linalg.inv(seen.T @ seen)
    error = (found.signal - truth) ** 2 / NOISE**2
    assert within(error[:, observed].sum(axis=(1, 2)), 24)
    in_gaps = np.trace(hidden @ covariance @ hidden.T)
    assert within(error[:, ~observed].sum(axis=(1, 2)), in_gaps)


def test_weights_reach_the_bound_of_unequal_noise_and_equal_ones_do_not():
    deviation = np.where(np.arange(TIME) % 3 == 0, 0.3, 0.02)
    truth, _, observed, samples = noisy_runs(7, 200, deviation)
    weight = np.broadcast_to(deviation**-2.0, (200, TIME))

    def error(signal):
        return np.sum((weight[..., None] * (signal - truth) ** 2)[:, observed], axis=(1, 2))

    assert within(error(line_spectrum(samples, weight).signal), 24)
    assert error(line_spectrum(samples).signal).mean() > 3 * 24


def test_a_signal_whose_frequency_drifts_says_that_it_is_no_sum_of_few_lines():
    """Mis-specified: the errors are far from the bound of the lines that were taken."""
    rng = np.random.default_rng(3)
    t = np.arange(TIME)
    drifting = np.cos(FREQUENCY * t[:, None] * (1 + t[:, None] / TIME))
    samples = drifting + NOISE * rng.standard_normal((20, TIME, COMPONENTS))
    found = line_spectrum(samples)
    assert (found.status == LineStatus.NOT_WHITE).all()
    assert "basis pursuit" in LineStatus(int(found.status[0])).sentence
    unknowns = 3 + 7 * np.isfinite(found.frequency).sum(axis=-1)
    assert (np.sum((found.signal - drifting) ** 2, axis=(1, 2)) > 10 * unknowns * NOISE**2).all()


def test_a_line_too_many_is_told():
    found = line_spectrum(noisy_runs(2, 5)[3], most=2)
    assert (found.status == LineStatus.LINE_LIMIT).all()
    assert "allow more" in LineStatus(int(found.status[0])).sentence


@given(seeds)
@settings(max_examples=20, deadline=None)
def test_without_noise_the_frequencies_are_exact(seed):
    rng = np.random.default_rng(seed)
    observed = with_gaps(rng)
    samples = np.where(observed[:, None], sines(amplitudes(rng)), np.nan)[None]
    signals = Signals(np.nan_to_num(samples), observed[None] * 1.0)
    near = FREQUENCY + rng.uniform(-1, 1, 3) * 0.6 / TIME
    fit = refine_lines(signals, near[None], iterations=40, tolerance=1e-9)
    np.testing.assert_allclose(fit.frequency[0], FREQUENCY, atol=1e-8)
    assert fit.cost[0] < 1e-10


def test_the_grid_of_basis_pursuit_leaves_more():
    truth, _, observed, samples = noisy_runs(11, 4)
    components = np.swapaxes(samples, 1, 2)
    grid = basis_pursuit(components, np.isfinite(components), 2 * TIME, 0.3).signal
    ours = np.abs(line_spectrum(samples).signal - truth)[:, ~observed]
    assert 3 * ours.max() < np.abs(np.swapaxes(grid, 1, 2) - truth)[:, ~observed].max()


@pytest.mark.parametrize("seed", range(3))
def test_descent_is_half_the_slope_of_the_projected_cost(seed):
    _, _, observed, samples = noisy_runs(seed, 1)
    weight = np.random.default_rng(seed).uniform(0.5, 2.0, (1, TIME)) * observed
    signals = Signals(np.nan_to_num(samples), weight)
    near = FREQUENCY + np.array([0.002, -0.003, 0.001])

    def cost(frequency):
        return fit_lines(signals, frequency[None]).cost[0]

    def slope(frequency):
        return -2 * fit_lines(signals, frequency[None]).descent[0]

    assert check_grad(cost, slope, near, epsilon=1e-7) < 1e-4 * np.linalg.norm(slope(near))


def test_curvature_is_that_of_the_cost_where_nothing_is_left():
    rng = np.random.default_rng(5)
    signals = Signals(sines(amplitudes(rng))[None], np.ones((1, TIME)))
    step = 1e-6 * np.eye(3)
    ahead, behind = (
        fit_lines(Signals(*(np.repeat(x, 3, axis=0) for x in signals)), FREQUENCY + s).descent
        for s in (step, -step)
    )
    curvature = fit_lines(signals, FREQUENCY[None]).curvature[0]
    np.testing.assert_allclose((behind - ahead) / 2e-6, curvature, rtol=1e-5, atol=1e-2)


def test_noise_alone_has_no_line():
    noise = np.random.default_rng(1).standard_normal((100, TIME, COMPONENTS))
    found = line_spectrum(noise)
    assert np.isnan(found.frequency).mean() > 0.99
    assert (found.status == LineStatus.COMPLETE).all()


def test_signals_without_samples_without_change_and_of_few_samples():
    samples = np.full((3, TIME, COMPONENTS), np.nan)
    samples[1] = 2.0
    samples[2, :3] = [[1.0], [2.0], [4.0]]
    found = line_spectrum(samples)
    ends = [LineStatus.NO_SAMPLE, LineStatus.COMPLETE, LineStatus.LINE_LIMIT]
    assert found.status.tolist() == ends
    assert (found.signal[0] == 0).all()
    np.testing.assert_allclose(found.signal[1], 2.0, rtol=1e-6)
    np.testing.assert_allclose(found.signal[2], 7 / 3, rtol=1e-6)


def test_a_run_does_not_depend_on_the_others():
    runs = np.concatenate([noisy_runs(seed, 2)[3] for seed in range(3)])
    together = line_spectrum(runs)
    for k in (0, 3, 5):
        alone = line_spectrum(runs[k : k + 1])
        np.testing.assert_allclose(alone.signal[0], together.signal[k], atol=1e-9)
        assert alone.status[0] == together.status[k]
