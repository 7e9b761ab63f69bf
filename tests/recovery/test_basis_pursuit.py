"""The lasso against its optimality conditions, its dual and the recurrence of the paper.

The oracles know the dictionary as a full complex matrix, and nothing of half spectra.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from debrisest.recovery.basis_pursuit import RecoveryStatus, basis_pursuit
from debrisest.recovery.fourier import analyse

seeds = st.integers(0, 2**32 - 1)
TIGHT = {"iterations": 20_000, "tolerance": 1e-11}


def dictionary(samples, length):
    """Phi of Eq. 14, samples x atoms."""
    return np.exp(2j * np.pi * np.outer(np.arange(samples), np.arange(length)) / length)


def full_spectrum(half, length):
    """The Hermitian spectrum (length) of which `half` is the first half."""
    mirrored = [np.conj(half[length - u]) for u in range(length // 2 + 1, length)]
    return np.concatenate([half, mirrored])


def problem(seed, samples=24):
    """A noisy sum of two sines with about 70 % of the samples observed."""
    rng = np.random.default_rng(seed)
    t = np.arange(samples)
    frequency, phase = rng.uniform(0.02, 0.4, (2, 1)), rng.uniform(0, 2 * np.pi, (2, 1))
    signal = np.sin(2 * np.pi * frequency * t + phase).sum(axis=0)
    observed = rng.random(samples) < 0.7
    observed[0] = True
    noisy = signal + 0.05 * rng.standard_normal(samples)
    return np.where(observed, noisy, np.nan), observed


@settings(max_examples=20, deadline=None)
@given(seeds, st.sampled_from([24, 25, 48, 53]), st.floats(0.1, 3.0))
def test_optimality_conditions_of_the_lasso(seed, length, penalty):
    samples, observed = problem(seed)
    solution = basis_pursuit(samples, observed, length, penalty, **TIGHT)
    atoms = dictionary(24, length)[observed]
    v = full_spectrum(solution.coefficients, length)
    slope = atoms.conj().T @ (samples[observed] - atoms @ v)
    used = v != 0
    assert solution.status == RecoveryStatus.CONVERGED
    assert np.abs(slope).max() <= penalty * (1 + 1e-6)
    np.testing.assert_allclose(
        slope[used], penalty * v[used] / np.abs(v[used]), atol=1e-5 * penalty
    )
    misfit = np.linalg.norm(samples[observed] - atoms @ v)
    objective = 0.5 * misfit**2 + penalty * np.abs(v).sum()
    assert solution.objective == pytest.approx(objective, rel=1e-9)
    np.testing.assert_allclose(solution.signal, dictionary(24, length) @ v, atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_residual_solves_the_dual_problem(seed):
    """min |y - s| subject to |a_u* y| <= lambda for all atoms is solved by y = s - H Phi v."""
    samples, observed = problem(seed, 14)
    penalty, length = 0.8, 28
    s, atoms = samples[observed], dictionary(14, length)[observed][:, : length // 2 + 1]
    inside = {
        "type": "ineq",
        "fun": lambda y: penalty**2 - np.abs(atoms.conj().T @ y) ** 2,
        "jac": lambda y: -2 * np.real((atoms.conj().T @ y)[:, None] * atoms.T),
    }
    dual = minimize(
        lambda y: 0.5 * np.sum((y - s) ** 2),
        0 * s,
        jac=lambda y: y - s,
        constraints=[inside],
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 500},
    )
    solution = basis_pursuit(samples, observed, length, penalty, **TIGHT)
    np.testing.assert_allclose(s - solution.signal[observed], dual.x, atol=1e-5)
    assert solution.objective == pytest.approx(0.5 * np.sum(s**2) - dual.fun, rel=1e-6)


def salsa(samples, observed, length, penalty, mu, iterations, updated):
    """Eqs. 21-27 with matrices; `updated`: the step for c has the new u, not the old one."""
    tau, s, phi = observed * 1.0, np.where(observed, samples, 0.0), dictionary(24, length)
    u = c = dual = np.zeros(length, complex)

    def shrunk(z):
        return z * np.maximum(0.0, 1 - penalty / mu / np.maximum(np.abs(z), 1e-300))

    for _ in range(iterations):
        old, u = u, shrunk(c - dual) + dual
        base = u if updated else old
        c = base + phi.conj().T @ (s - tau * (phi @ base)) / (mu + length)
        dual = u - c
    return shrunk(c - dual)


@pytest.mark.parametrize("seed", range(3))
def test_unrelaxed_iterations_are_those_of_the_paper(seed):
    samples, observed = problem(seed)
    v = salsa(samples, observed, 48, 0.3, 4.8, 17, updated=True)
    solution = basis_pursuit(samples, observed, 48, 0.3, 0.1, 17, relaxation=1.0, tolerance=0.0)
    np.testing.assert_allclose(full_spectrum(solution.coefficients, 48), v, atol=1e-12)
    assert solution.iterations == 17


@pytest.mark.parametrize("seed", range(3))
def test_printed_listing_with_the_old_u_is_another_iteration(seed):
    samples, observed = problem(seed)
    printed = salsa(samples, observed, 48, 0.3, 4.8, 17, updated=False)
    meant = salsa(samples, observed, 48, 0.3, 4.8, 17, updated=True)
    assert np.abs(printed - meant).max() > 1e-4


def test_splitting_and_relaxation_change_the_way_but_not_the_solution():
    samples, observed = problem(5)
    ways = [(0.03, 1.0), (0.03, 1.6), (0.3, 1.6), (0.3, 1.9), (1.0, 1.0)]
    objective = [
        basis_pursuit(samples, observed, 48, 0.3, mu, relaxation=a, **TIGHT).objective
        for mu, a in ways
    ]
    np.testing.assert_allclose(objective, objective[0], rtol=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_warm_start_reaches_the_same_solution(seed):
    samples, observed = problem(seed)
    cold = basis_pursuit(samples, observed, 48, 0.3, **TIGHT)
    for start in (cold.coefficients, analyse(cold.signal, 48) / 48, np.ones(25)):
        warm = basis_pursuit(samples, observed, 48, 0.3, start=start, **TIGHT)
        assert warm.objective == pytest.approx(cold.objective, rel=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_a_few_iterations_get_further_from_a_good_start(seed):
    """A long signal of which the last part was not seen before."""
    samples, observed = problem(seed, 400)
    before = observed & (np.arange(400) < 380)
    start = basis_pursuit(samples, before, 800, 0.3).coefficients
    few = {"iterations": 5, "tolerance": 0.0}
    warm = basis_pursuit(samples, observed, 800, 0.3, start=start, **few)
    assert warm.objective < basis_pursuit(samples, observed, 800, 0.3, **few).objective


def test_values_at_epochs_not_observed_do_not_matter():
    samples, observed = problem(7)
    solution = basis_pursuit(samples, observed, 48, 0.3)
    for filler in (0.0, 1e9, np.inf):
        other = basis_pursuit(np.where(observed, samples, filler), observed, 48, 0.3)
        assert (other.coefficients == solution.coefficients).all()


def test_an_observed_sample_that_is_nan_is_not_observed():
    samples, observed = problem(8)
    everywhere = basis_pursuit(samples, np.ones(24, bool), 48, 0.3)
    assert everywhere.objective == basis_pursuit(samples, observed, 48, 0.3).objective


def test_a_penalty_above_all_correlations_leaves_nothing_and_converges():
    samples, observed = problem(10)
    largest = np.abs(analyse(np.where(observed, samples, 0.0), 48)).max()
    nothing = basis_pursuit(samples, observed, 48, 1.01 * largest)
    assert nothing.status == RecoveryStatus.CONVERGED
    assert (nothing.coefficients == 0).all()
    assert (basis_pursuit(samples, observed, 48, 0.9 * largest).coefficients != 0).any()
    silence = basis_pursuit(np.zeros(24), observed, 48, 0.3)
    assert silence.status == RecoveryStatus.CONVERGED


def test_a_signal_without_samples_is_zero_and_says_so():
    samples, observed = problem(9)
    both = basis_pursuit(
        np.stack([samples, samples]),
        np.stack([observed, 0 * observed]) > 0,
        48,
        0.3,
        start=np.ones(25),
    )
    assert both.status.tolist() == [RecoveryStatus.CONVERGED, RecoveryStatus.NO_SAMPLE]
    assert (both.signal[1] == 0).all()
    assert both.objective[1] == 0
    assert both.iterations[1] == 0


@pytest.mark.parametrize("count", [2, 3, 7])
def test_a_signal_does_not_depend_on_its_companions(count):
    """More signals than one block holds, with different masks and iteration counts."""
    samples, observed = (np.stack(x) for x in zip(*[problem(k, 400) for k in range(60)]))
    length, options = 800, {"penalty": 0.5, "tolerance": 1e-3}
    together = basis_pursuit(samples, observed, length, **options)
    assert len(set(together.iterations.tolist())) > 1
    few = basis_pursuit(samples[:count], observed[:count], length, **options)
    for k in range(count):
        alone = basis_pursuit(samples[k], observed[k], length, **options)
        for other in (together, few):
            assert alone.iterations == other.iterations[k]
            np.testing.assert_allclose(alone.signal, other.signal[k], atol=1e-13)
            assert alone.objective == pytest.approx(other.objective[k], rel=1e-13)


@pytest.mark.parametrize("joint", [False, True])
def test_single_precision_gives_the_same_to_its_digits(joint):
    samples, observed = joint_problem(3)
    fixed = {"iterations": 40, "tolerance": 0.0, "joint": joint}
    double = basis_pursuit(samples, observed, 48, 0.5, **fixed)
    single = basis_pursuit(samples, observed, 48, 0.5, **fixed, single=True)
    assert single.coefficients.dtype == np.complex64
    assert 0 < np.abs(single.signal - double.signal).max() < 1e-5
    np.testing.assert_allclose(single.objective, double.objective, rtol=1e-5)


def test_a_small_tolerance_is_met_in_double_precision():
    """The same optimum as by double precision from the beginning."""
    samples, observed = problem(5)
    short = basis_pursuit(samples, observed, 48, 0.5, iterations=3000, tolerance=1e-3)
    exact = basis_pursuit(samples, observed, 48, 0.5, iterations=3000, tolerance=0.0)
    tight = basis_pursuit(samples, observed, 48, 0.5, iterations=3000, tolerance=1e-12)
    assert short.coefficients.dtype == np.complex128
    assert short.iterations < tight.iterations < 3000
    np.testing.assert_allclose(tight.signal, exact.signal, atol=1e-11)
    np.testing.assert_allclose(short.signal, exact.signal, atol=1e-2)


def test_batch_axes_are_kept_and_masks_are_broadcast():
    samples = np.random.default_rng(0).standard_normal((2, 3, 24))
    observed = problem(1)[1]
    solution = basis_pursuit(samples, observed, 50, 0.3)
    assert solution.signal.shape == (2, 3, 24)
    assert solution.coefficients.shape == (2, 3, 26)
    assert solution.objective.shape == solution.iterations.shape == solution.status.shape == (2, 3)


def test_iteration_limit_is_told():
    samples, observed = problem(2)
    solution = basis_pursuit(samples, observed, 48, 0.3, iterations=13, tolerance=1e-14)
    assert solution.iterations == 13
    assert solution.status == RecoveryStatus.ITERATION_LIMIT
    assert "allow more iterations" in RecoveryStatus(int(solution.status)).sentence


@given(seeds)
@settings(max_examples=20, deadline=None)
def test_padding_recovers_a_line_between_those_of_the_plain_transform(seed):
    """Half a line off: one atom of the padded dictionary, and a leak over all plain ones."""
    rng = np.random.default_rng(seed)
    t = np.arange(200)
    line = rng.integers(3, 12) + 0.5
    signal = np.sin(2 * np.pi * line * t / 200 + rng.uniform(0, 2 * np.pi))
    begin = rng.integers(20, 150)
    observed = (t < begin) | (t >= begin + 25)
    plain, padded = (
        np.abs(basis_pursuit(signal, observed, n, 0.3).signal - signal)[~observed].max()
        for n in (200, 400)
    )
    assert padded < 0.05
    assert plain > 3 * padded


@pytest.mark.parametrize("wrong", [{"penalty": 0.0}, {"splitting": -1.0}, {"relaxation": 2.0}])
def test_parameters_out_of_range_are_refused(wrong):
    samples, observed = problem(3)
    with pytest.raises(ValueError, match="must be positive"):
        basis_pursuit(samples, observed, 48, **{"penalty": 0.3, **wrong})


def test_too_few_atoms_are_refused():
    samples, observed = problem(3)
    with pytest.raises(ValueError, match="23 atoms are too few for 24 samples"):
        basis_pursuit(samples, observed, 23, 0.3)


def joint_problem(seed):
    """Three noisy components with their lines in common, each with its own gaps."""
    parts = [problem(seed), problem(seed), problem(seed)]
    rng = np.random.default_rng(seed + 1)
    samples = np.stack([scale * part[0] for scale, part in zip((1.0, 0.3, -0.6), parts)])
    observed = np.stack([part[1] for part in parts]) & (rng.random((3, 24)) < 0.9)
    return samples + 0.05 * rng.standard_normal((3, 24)), observed


@settings(max_examples=10, deadline=None)
@given(seeds, st.sampled_from([24, 48, 53]), st.floats(0.3, 3.0))
def test_optimality_conditions_of_the_joint_lasso(seed, length, penalty):
    """A line is used by all components or by none; the group has the modulus that one line has."""
    samples, observed = joint_problem(seed)
    solution = basis_pursuit(samples, observed, length, penalty, joint=True, **TIGHT)
    v = np.stack([full_spectrum(half, length) for half in solution.coefficients])
    atoms = dictionary(24, length)
    misfit = np.where(observed, np.nan_to_num(samples) - np.real(v @ atoms.T), 0.0)
    slope = misfit @ atoms.conj()
    size = np.linalg.norm(v, axis=0)
    used = size > 0
    assert (solution.status == RecoveryStatus.CONVERGED).all()
    assert np.linalg.norm(slope, axis=0).max() <= penalty * (1 + 1e-6)
    np.testing.assert_allclose(
        slope[:, used], penalty * v[:, used] / size[used], atol=1e-4 * penalty
    )
    objective = 0.5 * np.sum(misfit**2) + penalty * size.sum()
    np.testing.assert_allclose(solution.objective, objective, rtol=1e-9)


def test_one_component_is_jointly_what_it_is_alone():
    samples, observed = problem(4)
    alone = basis_pursuit(samples, observed, 48, 0.3)
    jointly = basis_pursuit(samples[None], observed[None], 48, 0.3, joint=True)
    np.testing.assert_array_equal(jointly.coefficients[0], alone.coefficients)


def test_joint_groups_do_not_depend_on_each_other_and_keep_their_batch_axes():
    groups = [joint_problem(seed) for seed in range(6)]
    samples, observed = (np.stack(x).reshape(2, 3, 3, 24) for x in zip(*groups))
    together = basis_pursuit(samples, observed, 48, 0.6, joint=True)
    assert together.objective.shape == together.iterations.shape == (2, 3, 3)
    for group, (values, seen) in zip(np.ndindex(2, 3), groups):
        alone = basis_pursuit(values, seen, 48, 0.6, joint=True)
        np.testing.assert_allclose(together.signal[group], alone.signal, atol=1e-12)
        assert (together.iterations[group] == alone.iterations).all()
