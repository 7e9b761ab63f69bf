"""Torque-free rotation against numerical integration, exact solutions and conserved quantities."""

from decimal import Decimal, localcontext

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics.torque_free import torque_free

# Principal moments and initial rates in deg/s; case 5 is flat, case 6 near its separatrix.
CASES = np.array(
    [
        [0.618, 0.707, 0.345, 7.200, 5.525, -1.624],
        [0.601, 0.446, 0.664, 8.400, -0.263, 2.860],
        [0.657, 0.489, 0.574, 7.200, 5.914, 6.023],
        [0.518, 0.461, 0.720, 6.000, 6.600, 4.440],
        [0.295, 0.781, 0.551, 7.200, 0.253, -13.198],
        [0.531, 0.473, 0.703, 8.400, 0.545, 0.458],
        [0.719, 0.658, 0.224, 6.600, 1.296, 9.557],
        [0.745, 0.512, 0.427, 6.000, -7.620, 12.000],
        [0.742, 0.521, 0.421, -3.000, 4.800, -2.700],
        [0.371, 0.743, 0.557, 3.000, -4.800, -2.100],
        [0.7014, 0.5762, 0.4196, 10.2, 0.72, -17.1],
    ]
)
GUARDED = {
    "sphere": ([1, 1, 1], [3, 4, 5]),
    "almost a sphere": ([1, 1 + 1e-9, 1 - 1e-9], [3, 4, 5]),
    "axisymmetric, third axis": ([1, 1, 0.3], [3, 4, 5]),
    "axisymmetric, first axis": ([0.3, 1, 1], [3, 4, 5]),
    "axisymmetric, second axis": ([1, 2, 1], [3, 4, 5]),
    "almost axisymmetric": ([1, 1 + 1e-12, 0.3], [3, 4, 5]),
    "axisymmetric, spin": ([1, 1, 0.3], [0, 0, 5]),
    "axisymmetric, flat spin": ([2, 1, 1], [0, 4, 3]),
    "axisymmetric, flat spin about an axis": ([2, 1, 1], [0, 0, -3]),
    "axisymmetric, almost flat spin": ([1, 1 + 1e-10, 0.3], [3, 4, 1e-8]),
    "spin about the major axis": ([3, 2, 1], [-5, 0, 0]),
    "spin about the intermediate axis": ([3, 2, 1], [0, 5, 0]),
    "spin about the minor axis": ([3, 2, 1], [0, 0, 5]),
    "almost a spin": ([1, 2, 3], [5, 1e-9, 1e-7]),
    "0.1 deg from the intermediate axis": ([2, 3, 1], [5, 0, 0.0087]),
    "0.01 deg from the intermediate axis": ([3, 2, 1], [8.7e-4, 5, 0]),
    "near the separatrix": ([6, 5, 3], [1 + 1e-6, 4, 1]),
    "at rest": ([3, 2, 1], [0, 0, 0]),
    "rod": ([1, 1, 1e-6], [0.1, 0.2, 5]),
    "large moments": ([3e5, 2e5, 1e5], [3, 4, -5]),
    "small moments": ([1e-5, 2e-5, 3e-5], [3, 4, -5]),
}
IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


def integrate(times: Array, q0: Array, rate0: Array, moments: Array) -> tuple[Array, Array]:
    """All bodies (body, ...) in one system of ordinary differential equations."""
    count = len(rate0)

    def derivative(_: float, state: Array) -> Array:
        q, w = np.split(state.reshape(count, 7), [4], axis=1)
        scalar, vector = q[:, :1], q[:, 1:]
        q_dot = 0.5 * np.hstack(
            [-np.sum(vector * w, axis=1, keepdims=True), scalar * w + np.cross(vector, w)]
        )
        return np.hstack([q_dot, np.cross(moments * w, w) / moments]).ravel()

    start = np.hstack([np.broadcast_to(q0, (count, 4)), rate0]).ravel()
    solution = solve_ivp(
        derivative, (0, times[-1]), start, "DOP853", t_eval=times, rtol=1e-12, atol=1e-15
    )
    states = np.moveaxis(solution.y.reshape(count, 7, -1), -1, 1)
    return states[..., :4], states[..., 4:]


def angles(p: Array, q: Array) -> Array:
    """Angles between attitudes, deg, by scipy."""
    first, second = (Rotation.from_quat(x.reshape(-1, 4), scalar_first=True) for x in (p, q))
    return np.degrees((first.inv() * second).magnitude())


def random_bodies(seed: int, count: int) -> tuple[Array, Array, Array]:
    rng = np.random.default_rng(seed)
    q0 = Rotation.random(count, rng=rng).as_quat(scalar_first=True)
    return q0, np.radians(rng.normal(size=(count, 3)) * 5.0), rng.uniform(0.3, 1.0, (count, 3))


def test_matches_integration() -> None:
    """Reference cases, random bodies in any order of moments, then the guarded ones."""
    times = np.sort(np.random.default_rng(2).uniform(0.0, 1500.0, 30))
    q0, rate0, moments = random_bodies(3, 15)
    edge_moments, edge_degrees = (np.array(list(x), dtype=float) for x in zip(*GUARDED.values()))
    q0 = np.concatenate([np.tile(IDENTITY, (len(CASES), 1)), q0, np.resize(q0, (len(GUARDED), 4))])
    rate0 = np.concatenate([np.radians(CASES[:, 3:]), rate0, np.radians(edge_degrees)])
    moments = np.concatenate([CASES[:, :3], moments, edge_moments])
    q, rate = torque_free(times, q0, rate0, moments)
    q_true, rate_true = integrate(times, q0, rate0, moments)
    rate_error = np.degrees(np.abs(rate - rate_true)).max(axis=(1, 2))
    angle_error = angles(q, q_true).reshape(len(moments), -1).max(axis=1)
    ordinary = len(CASES) + 15
    assert rate_error[:ordinary].max() < 1e-7
    assert angle_error[:ordinary].max() < 1e-5
    assert rate_error[ordinary:].max() < 1e-5
    assert angle_error[ordinary:].max() < 1e-4


def taylor(times: list[int], rate0: Array, moments: Array) -> Array:
    """Rates by Taylor series with 45 digits, in steps of 1/2 s."""
    with localcontext() as context:
        context.prec = 45
        a, b, c = (Decimal(float(x)) for x in moments)
        slope = ((b - c) / a, (c - a) / b, (a - b) / c)
        rate = [Decimal(float(x)) for x in rate0]
        found = []
        for step in range(2 * times[-1] + 1):
            if step in [2 * t for t in times]:
                found.append([float(x) for x in rate])
            series = [rate]
            for n in range(24):
                pairs = [(series[k], series[n - k]) for k in range(n + 1)]
                sums = [sum(p[i - 2] * q[i - 1] for p, q in pairs) for i in range(3)]
                series.append([slope[i] * sums[i] / (n + 1) for i in range(3)])
            rate = [sum(s[i] / 2**n for n, s in enumerate(series)) for i in range(3)]  # type: ignore[misc]
    return np.array(found)


@pytest.mark.parametrize("offset", [1e-6, 1e-9, 1e-14])
def test_keeps_all_digits_of_a_flip_of_the_intermediate_axis(offset: float) -> None:
    """Double precision integration is lost here: the flip waits for ``ln(1/offset)``."""
    moments, rate0 = np.array([1.0, 2.0, 3.0]), np.array([offset, 1.0, -2 * offset])
    times = [5, 25, 50, 60]
    _, rate = torque_free(np.array(times, dtype=float), IDENTITY, rate0, moments)
    np.testing.assert_allclose(rate, taylor(times, rate0, moments), rtol=1e-7, atol=1e-13)


@given(
    st.sampled_from([0.2, 0.9999999, 1.0, 1.0 + 1e-13, 1.8]),
    st.sampled_from([0, 1, 2]),
    st.floats(-0.3, 0.3),
    st.floats(-0.3, 0.3),
)
def test_axisymmetric_body_precesses_and_spins_uniformly(ratio, axis, along, across) -> None:
    """``R(t) = exp(h t / J_t) R(0) exp((1 - J_a / J_t) w_a t)``, exact at any time."""
    moments, rate0, spin = np.ones(3), np.zeros(3), np.zeros(3)
    moments[axis] = ratio
    rate0[axis], rate0[axis - 1] = along, across
    spin[axis] = (1.0 - ratio) * along
    times = np.array([-2e4, 0.0, 0.1, 7.0, 3e4])
    start = Rotation.from_quat([0.1, -0.7, 0.5, 0.5], scalar_first=True)
    momentum = start.apply(moments * rate0)
    expected = (
        Rotation.from_rotvec(np.outer(times, momentum))
        * start
        * Rotation.from_rotvec(np.outer(times, spin))
    )
    q, rate = torque_free(times, start.as_quat(scalar_first=True), rate0, moments)
    assert angles(q, expected.as_quat(scalar_first=True)).max() < 1e-8
    turned = Rotation.from_rotvec(np.outer(-times, spin)).apply(rate0)
    np.testing.assert_allclose(rate, turned, atol=1e-10)


sizes = st.one_of(st.sampled_from([1e-3, 0.5, 1.0, 1.0 + 1e-12, 2.0]), st.floats(0.01, 100.0))
components = st.one_of(
    st.sampled_from([0.0, 1e-200, 1e-30, -1e-12, 1e-5, 0.1]), st.floats(-0.5, 0.5)
)


@settings(max_examples=40, deadline=None)
@given(
    hnp.arrays(float, (12, 3), elements=sizes, fill=st.nothing()),
    hnp.arrays(float, (12, 3), elements=components, fill=st.nothing()),
)
def test_momentum_energy_and_orthonormality_of_any_body(moments: Array, rate0: Array) -> None:
    times = np.concatenate([np.linspace(0.0, 300.0, 30), [-1e4, 1e6]])
    q0 = np.array([0.1, -0.7, 0.5, 0.5])
    q, rate = torque_free(times, q0, rate0, moments)
    np.testing.assert_allclose(np.linalg.norm(q, axis=-1), 1.0, atol=1e-13)
    start = np.sum(moments * rate0**2, axis=-1)[:, None]
    energy = np.sum(moments[:, None] * rate**2, axis=-1)
    assert (np.abs(energy - start) <= 1e-11 * start).all()
    momentum = quaternion.rotate(q, moments[:, None] * rate)
    expected = Rotation.from_quat(q0, scalar_first=True).apply(moments * rate0)[:, None]
    scale = np.linalg.norm(expected, axis=-1)
    assert (np.linalg.norm(momentum - expected, axis=-1) <= 1e-11 * scale).all()


def test_orthonormal_as_the_modulus_goes_to_one() -> None:
    """Moments 6, 5, 3 put the separatrix exactly at equal outer rates."""
    steps = np.concatenate([[0.0], 10.0 ** np.arange(-16, 0)])
    rate0 = np.stack([0.1 * (1 + steps), np.full(17, 0.3), np.full(17, 0.1)], axis=-1)
    q, _ = torque_free(np.arange(0.0, 1500.0, 7.0), IDENTITY, rate0, np.array([6.0, 5.0, 3.0]))
    matrix = Rotation.from_quat(q.reshape(-1, 4), scalar_first=True).as_matrix()
    np.testing.assert_allclose(np.linalg.norm(q, axis=-1), 1.0, atol=1e-14)
    assert np.isfinite(matrix).all()


def test_times_may_have_any_step_order_and_sign() -> None:
    q0, rate0, moments = random_bodies(5, 4)
    times = np.array([4e4, 0.0, 1e5, 3.0, 4e4 + 1e-3])
    q, rate = torque_free(times, q0, rate0, moments)
    fine_q, fine_rate = torque_free(np.arange(1e5 + 1), q0, rate0, moments)
    whole = times[:4].astype(int)
    np.testing.assert_allclose(q[:, :4], fine_q[:, whole], atol=1e-14)
    np.testing.assert_allclose(rate[:, :4], fine_rate[:, whole], atol=1e-14)
    back_q, back_rate = torque_free(np.array([-4e4]), q[:, 0], rate[:, 0], moments)
    np.testing.assert_allclose(back_q[:, 0], q0, atol=1e-8)
    np.testing.assert_allclose(back_rate[:, 0], rate0, atol=1e-8)


@given(st.floats(1e-6, 1e6))
def test_scale_of_the_moments_does_not_matter(scale: float) -> None:
    q0, rate0, moments = random_bodies(6, 3)
    times = np.arange(0.0, 300.0, 20.0)
    for scaled, plain in zip(
        torque_free(times, q0, rate0, scale * moments), torque_free(times, q0, rate0, moments)
    ):
        np.testing.assert_allclose(scaled, plain, atol=1e-9)


def test_quaternion_is_continuous() -> None:
    q0, rate0, moments = random_bodies(8, 20)
    q, _ = torque_free(np.arange(0.0, 300.0, 0.5), q0, rate0, moments)
    assert np.sum(q[:, 1:] * q[:, :-1], axis=-1).min() > 0.9
    np.testing.assert_allclose(q[:, 0], q0, atol=1e-14)


def test_batch_axes_broadcast_and_a_bad_run_stays_alone() -> None:
    q0, rate0, moments = random_bodies(9, 5)
    rate0[3] = np.nan
    times = np.arange(7.0)
    q, rate = torque_free(times, np.tile(q0[:, None], (1, 2, 1))[:3, :1], rate0, moments)
    assert (q.shape, rate.shape) == ((3, 5, 7, 4), (3, 5, 7, 3))
    bad = np.isnan(q).any(axis=(0, 2, 3))
    np.testing.assert_array_equal(bad, [False, False, False, True, False])
    alone_q, alone_rate = torque_free(times, q0[2], rate0[4], moments[4])
    np.testing.assert_allclose(q[2, 4], alone_q, atol=1e-14)
    np.testing.assert_allclose(rate[2, 4], alone_rate, atol=1e-14)


def test_no_body_depends_on_those_beside_it() -> None:
    """Near the separatrix a body needs more terms than others, which keep every bit."""
    q0, rate0, moments = random_bodies(9, 40)
    rate0[7], moments[7] = (1e-9, 0.1, 1e-9), (1.0, 2.0, 3.0)
    times = np.linspace(-50.0, 80.0, 9)
    q, rate = torque_free(times, q0, rate0, moments)
    for i in range(40):
        alone = torque_free(times, q0[i : i + 1], rate0[i : i + 1], moments[i : i + 1])
        np.testing.assert_array_equal(q[i], alone[0][0])
        np.testing.assert_array_equal(rate[i], alone[1][0])
