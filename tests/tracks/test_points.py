"""Tracks from long and wide tables: what is read, what is told, what is refused."""

import numpy as np
import pytest

from debrisest.tracks.read import read_measured
from debrisest.tracks.types import Tracks
from tests.tracks.conftest import Write, long_text, motion, refusal

HEAD = "time_s,feature,x_m,y_m,z_m\n"
ROWS = ["0,p1,1,0,2", "0,p2,0,1,2", "0,p3,0,0,3", "1,p1,1,0.1,2", "1,p2,-0.1,1,2", "1,p3,0,0,3.1"]


def read(path) -> Tracks:  # type: ignore[no-untyped-def]
    tracks = read_measured(path)
    assert isinstance(tracks, Tracks)
    return tracks


def text(*rows: str, head: str = HEAD) -> str:
    return head + "\n".join(rows) + "\n"


def test_points_by_hand(write: Write) -> None:
    tracks = read(write(text(*ROWS)))
    assert tracks.features == ("p1", "p2", "p3")
    np.testing.assert_array_equal(tracks.times, [0.0, 1.0])
    np.testing.assert_array_equal(tracks.lines, [2, 5])
    np.testing.assert_array_equal(tracks.points[1], [[1, 0.1, 2], [-0.1, 1, 2], [0, 0, 3.1]])
    assert tracks.pixels is None and tracks.ranges is None and tracks.point_sigma is None


def test_a_missing_row_is_not_seen_and_so_is_an_empty_one(write: Write) -> None:
    dropped, empty = ROWS[:4] + ROWS[5:], [*ROWS[:4], "1,p2,,,", *ROWS[5:]]
    for rows in (dropped, empty):
        points = read(write(text(*rows))).points
        assert np.isnan(points[1, 1]).all() and np.isnan(points).sum() == 3


def test_any_order_and_repeated_rows_are_read_and_told(write: Write) -> None:
    plain = read(write(text(*ROWS)))
    mixed = read(write(text(*ROWS[::-1], ROWS[2])))
    np.testing.assert_array_equal(mixed.points, plain.points)
    assert any(
        "rows sorted by time: they go back 1 times, first in line 5" in n for n in mixed.notes
    )
    assert any("1 rows repeat another one" in n and "first line 8" in n for n in mixed.notes)


def test_contradicting_rows_are_refused_with_both_lines(write: Write) -> None:
    path = write(text(*ROWS, "1,p1,1,0.2,2"))
    said = refusal(lambda: read(path))
    assert said.startswith(f"{path}:8: x_m: 1, 0.2, 2 contradicts 1, 0.1, 2 in line 5")


def test_times_that_differ_by_rounding_are_one_epoch(write: Write) -> None:
    rows = [*ROWS[:4], ROWS[4].replace("1,", "1.0000000004,", 1), ROWS[5]]
    tracks = read(write(text(*rows)))
    np.testing.assert_array_equal(tracks.times, [0.0, 1.0])
    assert any("are the same epoch" in note for note in tracks.notes)


def test_times_since_1970_and_a_long_gap_keep_their_epochs(write: Write) -> None:
    start = 1.7e9
    times = start + np.array([0.0, 0.1, 0.2, 0.3, 50000.0, 50000.1])
    rows = [f"{t:.3f},p{f},{f + 1},{t - start:.3f},1" for t in times for f in range(3)]
    np.testing.assert_allclose(read(write(text(*rows))).times, times, rtol=0, atol=1e-6)


def test_near_epochs_are_kept_and_told(write: Write) -> None:
    rows = [f"{t},p{f},{f + 1},{t},1" for t in (0, 1, 2, 2.0001, 3) for f in range(3)]
    tracks = read(write(text(*rows)))
    assert len(tracks.times) == 5
    assert any("less than a thousandth of a step apart, first at 2 s" in n for n in tracks.notes)


def test_sigmas_one_for_all_axes_or_three(write: Write) -> None:
    one = read(
        write(text(*(f"{r},0.1" for r in ROWS), head="time_s,feature,x_m,y_m,z_m,sigma_m\n"))
    )
    np.testing.assert_array_equal(one.point_sigma, np.full((2, 3, 3), 0.1))
    assert any("sigma is 0.1 m for all points" in note for note in one.notes)
    head = "time_s,feature,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m\n"
    three = read(write(text(*(f"{r},0.1,0.2,0.3" for r in ROWS), head=head)))
    np.testing.assert_array_equal(three.point_sigma[1, 2], [0.1, 0.2, 0.3])


def test_pixels_of_two_cameras_and_a_range(write: Write) -> None:
    head = "time_s,feature,camera,u_px,v_px,range_m\n"
    rows = [
        "0,a,left,10,20,",
        "0,a,right,5,20,",
        "0,b,left,30,40,",
        "0,,,,,12.5",
        "1,a,left,11,21,",
    ]
    tracks = read(write(text(*rows, head=head)))
    assert tracks.cameras == ("left", "right")
    np.testing.assert_array_equal(tracks.pixels[0, :, 0], [[10, 20], [5, 20]])
    assert np.isnan(tracks.pixels[1, 1]).all() and np.isnan(tracks.pixels[0, 1, 1]).all()
    np.testing.assert_array_equal(tracks.ranges, [12.5, np.nan])


def test_a_range_on_every_row_is_that_of_the_target_if_it_is_the_same(write: Write) -> None:
    head = "time_s,feature,u_px,v_px,range_m\n"
    same = ["0,a,1,2,9", "0,b,3,4,9", "1,a,1,2,8", "1,b,3,4,8"]
    np.testing.assert_array_equal(read(write(text(*same, head=head))).ranges, [9, 8])
    other = [*same[:3], "1,b,3,4,8.1"]
    ranges = read(write(text(*other, head=head))).ranges
    np.testing.assert_array_equal(ranges, [[9, 9], [8, 8.1]])


def test_features_are_in_natural_order(write: Write) -> None:
    rows = [f"{t},p{f},{f},{t},1" for t in (0, 1) for f in (10, 2, 1)]
    assert read(write(text(*rows))).features == ("p1", "p2", "p10")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (text(*ROWS, "2,p1,0,0,0"), "8: x_m, y_m, z_m are all 0, often written for not seen"),
        (text(*ROWS, "2,p1,1,,0"), "8: give all of x_m, y_m, z_m, or none"),
        (text(*ROWS, "2,,1,2,3"), "8: feature: empty; only a range can do without"),
        (text("0,a,1,2", head="time_s,feature,x_m,y_m\n"), "1: x_m, y_m without z_m: give all"),
        (text("0,a,,,", "1,a,,,"), "2: nothing was observed, in this row and all others"),
        (text("0,a", head="time_s,feature\n"), "1: nothing measured: give x_m, y_m, z_m or u_px"),
        (text("0,a,1,2,3,mm", head=HEAD.replace("\n", ",unit\n")), "1: unknown column 'unit'"),
        (
            text("0,a,1,2,3", head=HEAD.replace("x_m", "x_mm")),
            "1: unknown column x_mm: the unit is",
        ),
        (text("0,a,1,2,3", head=HEAD.replace("time_s", "t")), "1: unknown column 't'"),
        (
            text("0,a,-1,-1", "0,b,3,4", head="time_s,feature,u_px,v_px\n"),
            "2: u_px, v_px are all -1, often written for not seen",
        ),
        (
            text("0,a,,3,4", "0,b,l,3,4", head="time_s,feature,camera,u_px,v_px\n"),
            "2: camera: of which camera is this pixel?",
        ),
        (
            text(*(f"{r},0" for r in ROWS), head=HEAD.replace("\n", ",sigma_m\n")),
            "2: sigma_m: must be given and positive",
        ),
        (text("0,a,-4", "1,a,4", head="time_s,feature,range_m\n"), "2: range_m: must be positive"),
        (
            text("0.1,a,1,2,3", "0.2,b,1,2,4", "0.3,c,2,2,3"),
            "2: time_s: no two features share a time; is another column in its place?",
        ),
    ],
)
def test_refused_with_the_line(write: Write, content: str, said: str) -> None:
    path = write(content)
    assert f"{path}:{said}" in refusal(lambda: read(path))


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (["0,a,1,2,3", "0,b,2,2,3", "1,a,1,2,3", "1,b,2,2,3"], "2 features only"),
        (["0,a,1,2,3", "0,b,2,2,3", "0,c,2,3,3"], "one epoch only"),
        ([*ROWS, "1,P1,1,2,3"], "features p1 and P1 differ in capitals or accents only"),
        ([*ROWS, "1,q1,1,2,3"], "seen in one row only: q1"),
    ],
)
def test_told_but_read(write: Write, rows: list[str], said: str) -> None:
    notes = " ".join(read(write(text(*rows))).notes).replace("P1 and p1", "p1 and P1")
    assert said in notes


def test_wide_and_long_hold_the_same(write: Write) -> None:
    times, points = motion(epochs=4)
    long = read(write(long_text(times, points)))
    names = [f"p{f}_{a}" for f in range(1, 6) for a in ("x_m", "y_m", "z_m", "sigma_m")]
    lines = [",".join(["time_s", *names])]
    for n, time in enumerate(times):
        cells = [f"{x:.6f},{y:.6f},{z:.6f},0.01" for x, y, z in points[n]]
        lines.append(",".join([f"{time:.3f}", *cells]))
    wide = read(write("\n".join(lines) + "\n"))
    assert wide.features == long.features
    np.testing.assert_array_equal(wide.points, long.points)
    np.testing.assert_array_equal(wide.point_sigma, long.point_sigma)
    np.testing.assert_array_equal(wide.lines, [2, 3, 4, 5])


def test_wide_pixels_of_cameras_and_one_range(write: Write) -> None:
    head = (
        "time_s,a@left_u_px,a@left_v_px,a@right_u_px,a@right_v_px,b@left_u_px,b@left_v_px,range_m"
    )
    tracks = read(write(f"{head}\n0,1,2,3,4,5,6,9\n1,1,2,,,5,6,\n"))
    assert (tracks.features, tracks.cameras) == (("a", "b"), ("left", "right"))
    np.testing.assert_array_equal(tracks.pixels[0, :, 0], [[1, 2], [3, 4]])
    assert np.isnan(tracks.pixels[1, 1]).all()
    np.testing.assert_array_equal(tracks.ranges, [9, np.nan])


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("time_s,a_x_m,a_y_m", "1: a: x_m, y_m without z_m: give all of them, or none"),
        ("time_s,a_x_m,a_y_m,a_z_mm", "1: unknown column a_z_mm: the unit is in the name"),
        ("t_s,a_x_m,a_y_m,a_z_m", "1: unknown column 't_s'"),
        ("time_s,a_u_px,a_v_px,a_sigma_m", "1: a: a sigma without points"),
    ],
)
def test_wide_headers_refused(write: Write, head: str, said: str) -> None:
    path = write(f"{head}\n{','.join('1' for _ in head.split(','))}\n")
    assert f"{path}:{said}" in refusal(lambda: read(path))


def test_what_a_file_is_not(write: Write, tmp_path) -> None:  # type: ignore[no-untyped-def]
    said = refusal(lambda: read_measured(write("a,b\n1,2\n")))
    assert "not known from its header 'a, b'; accepted are" in said and "COLMAP" in said
    assert "no COLMAP text model; accepted are" in refusal(lambda: read_measured(tmp_path))
    body = write("feature,x_m,y_m,z_m\na,1,2,3\n")
    assert "the known geometry, not tracks" in refusal(lambda: read_measured(body))
