"""Random draws belong to seed, case, run and stream, and to nothing else."""

import zlib

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from debrisest.draws import Draws, Stream

names = st.text("abc123.,", min_size=1, max_size=6)
NOISE = Stream.MEASUREMENT_NOISE


@given(st.integers(0, 2**63), names, st.lists(st.integers(0, 10**6), min_size=1, max_size=5))
def test_a_run_draws_the_same_whatever_its_companions(
    seed: int, case: str, runs: list[int]
) -> None:
    together = Draws(seed, case, runs).normal(NOISE, (2, 3))
    for index, run in enumerate(runs):
        alone = Draws(seed, case, [run]).normal(NOISE, (2, 3))
        assert np.array_equal(together[index], alone[0])


@given(st.integers(0, 2**32), st.integers(0, 99))
def test_the_seed_sequence_is_the_published_one(seed: int, run: int) -> None:
    key = (zlib.crc32(b"case"), run, 1)
    expected = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
    drawn = Draws(seed, "case", [run]).normal(NOISE, (4,))
    assert np.array_equal(drawn[0], expected.standard_normal(4))


def test_the_streams_have_their_numbers() -> None:
    assert [s.value for s in Stream] == [0, 1, 2, 3]
    assert Stream.TRUTH == 0
    assert Stream.INITIAL_ERROR == 3


def test_seeds_cases_runs_and_streams_differ() -> None:
    drawn = [
        Draws(seed, case, [run]).normal(stream, (3,))[0].tobytes()
        for seed in (0, 1)
        for case in ("1", "2")
        for run in (0, 1)
        for stream in Stream
    ]
    assert len(set(drawn)) == 32


def test_streams_do_not_depend_on_the_order_of_use() -> None:
    first, second = Draws(5, "a", [0, 1]), Draws(5, "a", [0, 1])
    truth = first.normal(Stream.TRUTH, (3,))
    noise = first.normal(NOISE, (3,))
    assert np.array_equal(second.normal(NOISE, (3,)), noise)
    assert np.array_equal(second.normal(Stream.TRUTH, (3,)), truth)


def test_successive_draws_of_a_stream_differ() -> None:
    draws = Draws(5, "a", [0])
    assert not np.array_equal(draws.normal(NOISE, (3,)), draws.normal(NOISE, (3,)))


def test_draws_are_standard_normal_and_independent_between_runs() -> None:
    drawn = Draws(11, "a", range(40)).normal(NOISE, (2500,))
    assert abs(drawn.mean()) < 5 / np.sqrt(drawn.size)
    assert abs(drawn.var() - 1) < 5 * np.sqrt(2 / drawn.size)
    correlation = np.corrcoef(drawn)[np.triu_indices(40, 1)]
    assert np.abs(correlation).max() < 5.5 / np.sqrt(2500)
