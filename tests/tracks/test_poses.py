"""Poses and attitudes from CSV, and poses from the JSON lists of data sets."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from debrisest.arrays import Array
from debrisest.tracks.attitude import attitude_at, read_attitude
from debrisest.tracks.body_points import read_body_points
from debrisest.tracks.frames import read_times
from debrisest.tracks.read import read_measured
from debrisest.tracks.sheet import open_sheet
from debrisest.tracks.types import Poses
from tests.tracks.conftest import Write, refusal

TURN = Rotation.from_rotvec(0.1 * np.outer(np.arange(12), [0.6, 0.0, 0.8]) + [0.3, 0.1, 0.0])
Q = TURN.as_quat(scalar_first=True)


def text(q: Array, head: str = "time_s,q0,q1,q2,q3", tail: str = "") -> str:
    rows = (f"{n}," + ",".join(f"{x:.8f}" for x in row) + tail for n, row in enumerate(q))
    return "\n".join([head, *rows]) + "\n"


def read(path, **options: object) -> Poses:  # type: ignore[no-untyped-def]
    poses = read_measured(path, **options)  # type: ignore[arg-type]
    assert isinstance(poses, Poses)
    return poses


def test_poses_with_positions_and_sigma(write: Write) -> None:
    head = "time_s,q0,q1,q2,q3,x_m,y_m,z_m,sigma_deg"
    poses = read(write(text(Q * 1.0004, head, ",1,2,30,2.5")))
    np.testing.assert_allclose(poses.q, Q, atol=1e-7)
    np.testing.assert_array_equal(poses.position, np.tile([1, 2, 30], (12, 1)))
    np.testing.assert_allclose(poses.sigma_rad, np.pi / 72)
    np.testing.assert_array_equal(poses.lines, np.arange(2, 14))


def test_poses_out_of_order_and_repeated(write: Write) -> None:
    lines = text(Q).splitlines()
    poses = read(write("\n".join([lines[0], *lines[:0:-1], lines[3]]) + "\n"))
    np.testing.assert_allclose(poses.q, Q, atol=1e-8)
    assert any("sorted" in note for note in poses.notes)
    assert any("1 rows repeat" in note for note in poses.notes)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (text(Q * 1.01), "2: q0: norm 1.01, not 1 within 0.001"),
        (text(Q * 0), "2: q0: norm 0, not 1"),
        (text(Q) + "3,0,1,0,0\n", "contradicts"),
        (text(Q, "time_s,q0,q1,q2,q3,x_m,y_m,z_m", ",0,0,0"), "2: x_m: the position is 0, 0, 0"),
        (text(Q, "time_s,q0,q1,q2,q3,sigma_deg", ",-1"), "2: sigma_deg: must be positive"),
        (text(Q, "time_s,q0,q1,q2,q3,sigma_rad", ",1"), "1: unknown column sigma_rad: the unit is"),
        (text(Q, "time_s,qw,qx,qy,qz"), "1: unknown column qw; quaternions are q0 (the scalar)"),
        (text(Q, "time_s,q1,q2,q3,q4"), "1: unknown column 'q4'"),
    ],
)
def test_poses_refused(write: Write, content: str, said: str) -> None:
    path = write(content)
    assert said in refusal(lambda: read(path)).replace(f"{path}:", "", 1)


def test_rows_with_the_scalar_last_among_others_are_refused(write: Write) -> None:
    mixed = Q.copy()
    mixed[7:] = np.roll(mixed[7:], -1, axis=-1)
    path = write(text(mixed))
    said = refusal(lambda: read(path))
    assert said.startswith(f"{path}:9: q0: turns by") and "with the scalar last" in said


def test_the_turn_between_neighbours_cannot_tell_the_order_of_a_whole_file() -> None:
    """Why a whole file with the scalar last is read: no rotation angle of it differs."""
    last = np.roll(Q, -1, axis=-1)
    turns = [
        (Rotation.from_quat(q, scalar_first=True)[:-1].inv() * Rotation.from_quat(
            q, scalar_first=True)[1:]).magnitude()
        for q in (Q, last)
    ]  # fmt: skip
    np.testing.assert_allclose(turns[0], turns[1], atol=1e-12)


def test_a_start_upside_down_is_told(write: Write) -> None:
    small = Rotation.from_rotvec(0.01 * np.outer(np.arange(9), [1, 2, 3])).as_quat()
    assert any("is the scalar last" in note for note in read(write(text(small))).notes)
    assert not any("scalar last" in note for note in read(write(text(Q))).notes)


def test_a_row_that_jumps_is_told_with_its_line(write: Write) -> None:
    odd = Q.copy()
    odd[5, 1] *= -1
    notes = read(write(text(odd))).notes
    assert any("up to line 7" in note and "2 such jumps" in note for note in notes)
    assert not any("jumps" in note for note in read(write(text(Q))).notes)


def test_attitude_between_epochs_is_on_the_great_circle(write: Write) -> None:
    flipped = Q * np.where(np.arange(12) % 3 == 0, -1.0, 1.0)[:, None]
    attitude = read_attitude(open_sheet(write(text(flipped))))
    times = np.array([0.0, 0.3, 4.0, 7.75, 11.0])
    expected = Slerp(np.arange(12.0), TURN)(times)
    found = Rotation.from_quat(attitude_at(attitude, times), scalar_first=True)
    assert (found.inv() * expected).magnitude().max() < 1e-7
    said = refusal(lambda: attitude_at(attitude, np.array([5.0, 11.5])))
    assert "covers 0 to 11 s, not 11.5 s" in said


def test_body_points(write: Write) -> None:
    body = read_body_points(open_sheet(write("feature,x_m,y_m,z_m\nb,1,2,3\na,0,0,0\n")))
    assert body.features == ("b", "a")
    np.testing.assert_array_equal(body.points, [[1, 2, 3], [0, 0, 0]])
    path = write("feature,x_m,y_m,z_m\nb,1,2,3\nb,0,0,0\n")
    said = refusal(lambda: read_body_points(open_sheet(path)))
    assert said == f"{path}:3: feature: b is there twice, first in line 2"


def speed(**changes: object) -> list[dict[str, object]]:
    return [
        {"filename": f"img{n + 5:06d}.jpg", "q_vbs2tango_true": q.tolist()}
        | {"r_Vo2To_vbs_true": [0.1, -0.2, 6.0 + n]} | changes
        for n, q in enumerate(Q)
        if n != 4
    ]  # fmt: skip


def test_a_list_of_a_data_set_at_a_frame_rate(write: Write) -> None:
    poses = read(write(json.dumps(speed(), indent=1), "train.json"), rate_hz=5.0)
    kept = np.arange(12) != 4
    np.testing.assert_allclose(poses.times, np.flatnonzero(kept) / 5.0)
    np.testing.assert_allclose(poses.q, Q[kept], atol=1e-12)
    np.testing.assert_array_equal(poses.position[:, 2], 6.0 + np.flatnonzero(kept))


def test_times_of_images_from_a_table_or_the_entries(write: Write) -> None:
    names = [str(entry["filename"]) for entry in speed()]
    rows = "".join(f"{name},{2 * n}\n" for n, name in enumerate(names))
    times = read_times(open_sheet(write(f"filename,time_s\n{rows}", "times.csv")))
    poses = read(write(json.dumps(speed()), "train.json"), times=times)
    np.testing.assert_array_equal(poses.times, 2.0 * np.arange(11))
    stamped = [entry | {"time_s": 3 * n} for n, entry in enumerate(speed())]
    np.testing.assert_array_equal(read(write(json.dumps(stamped))).times, 3.0 * np.arange(11))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (json.dumps(speed())[:-9], "1:"),
        (json.dumps(speed()), "give a frame rate in Hz above zero"),
        ("[1, 2]", "expected an image with its pose, found '1'"),
        ("{}", "expected a list of images"),
        (json.dumps(speed(q_vbs2tango_true=[1, 0, 0])), "1: q_vbs2tango_true: expected 4 numbers"),
        (json.dumps(speed(q=[1, 0, 0, 0])), "q_vbs2tango_true and q are both there"),
        (json.dumps(speed(r_Vo2To_vbs_true=None)).replace("null", "NaN"), "NaN is not a number"),
        ('[{"filename": "a1", "filename": "a2"}]', "key 'filename' is there twice"),
        ("[" * 100_000, ""),
    ],
)
def test_lists_refused(write: Write, content: str, said: str) -> None:
    path = write(content, "train.json")
    refused = refusal(lambda: read(path))
    assert refused.startswith(str(path)) and said in refused


def test_a_bad_entry_is_at_its_line(write: Write) -> None:
    entries = speed()
    entries[3]["r_Vo2To_vbs_true"] = [1, 2, "x"]
    body = "[\n" + ",\n".join(json.dumps(entry) for entry in entries) + "\n]\n"
    path = write(body, "train.json")
    assert refusal(lambda: read(path, rate_hz=1.0)).startswith(f"{path}:5: r_Vo2To_vbs_true: ")
    entries[3] = entries[4] | {"q_vbs2tango_true": [2, 0, 0, 0]}
    path = write(json.dumps(entries, indent=1).replace("{\n", "{"), "train.json")
    said = refusal(lambda: read(path, rate_hz=1.0))
    line = path.read_text().splitlines().index("   2,")
    assert said.startswith(f"{path}:{line}: q0: norm 2, not 1 within 0.001")
