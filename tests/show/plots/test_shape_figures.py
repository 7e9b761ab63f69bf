"""Figures of pose and shape on small made-up data."""

import numpy as np
from matplotlib.figure import Figure

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.show.plots.pose_errors import pose_errors
from debrisest.show.plots.relative_trajectory import relative_trajectory
from debrisest.show.plots.scene import in_first_image, scene
from debrisest.show.plots.shape import shape

TIMES = 5.0 * np.arange(60)
TURN = quaternion.to_matrix(quaternion.exp(np.array([0.0, 0.1, 0.0])))


def _shape() -> Data:
    true = np.random.default_rng(0).uniform(-1, 1, (12, 3))
    estimated = np.repeat((true @ TURN)[None], len(TIMES), axis=0)
    return {"time_s": TIMES, "reference_point_b": true, "point_b": estimated}


def _curves(figure: Figure) -> list[Array]:
    axes = figure.axes[1]
    return [
        np.stack([np.asarray(part, float) for part in line.get_data_3d()], -1)
        for line in axes.lines
    ]


def test_points_are_shown_as_they_are_and_after_the_best_rotation() -> None:
    data = _shape()
    figure = shape(data, "run 0")
    figure.draw_without_rendering()
    true, estimated, turned, *pairs = _curves(figure)
    assert np.allclose(true, data["reference_point_b"])
    assert np.allclose(estimated, data["point_b"][-1])
    assert np.allclose(turned, true)
    assert len(pairs) == 12


def test_a_point_that_was_lost_is_shown_where_it_was_last() -> None:
    data = _shape()
    data["point_b"][40:, 3] = np.nan
    data["point_b"][:, 5] = np.nan
    _, estimated, turned, *_ = _curves(shape(data, "run 0"))
    assert np.allclose(estimated[3], data["point_b"][39, 3])
    assert np.isnan(estimated[5]).all()
    assert np.isfinite(np.delete(turned, 5, axis=0)).all()


def test_the_path_and_its_target_are_to_scale() -> None:
    angle = 0.1 * TIMES
    true = np.stack([10 * np.sin(angle), 20 * np.cos(angle), 6 * np.sin(angle)], -1)
    data = {"time_s": TIMES, "chaser_position_h": true, "relative_position_h": true + 0.1}
    figure = relative_trajectory(data, "run 0")
    figure.draw_without_rendering()
    estimated, exact, target, start = _curves(figure)
    assert np.allclose(estimated - exact, 0.1)
    assert np.array_equal(target, [[0, 0, 0]])
    assert np.array_equal(start[0], true[0])
    axes = figure.axes[1]
    lengths = [np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
    assert np.allclose(np.asarray(axes._box_aspect) / lengths, axes._box_aspect[0] / lengths[0])


def test_a_run_that_diverged_at_once_can_be_drawn() -> None:
    nothing = np.full((len(TIMES), 3), np.nan)
    path = {"time_s": TIMES, "chaser_position_h": np.ones_like(nothing)}
    relative_trajectory(path | {"relative_position_h": nothing}, "run 0").draw_without_rendering()
    data = _shape()
    data["point_b"][:] = np.nan
    shape(data, "run 0").draw_without_rendering()


def test_a_tensors_errors_are_shown_element_by_element_with_their_bands() -> None:
    tensor = np.zeros((len(TIMES), 3, 3)) + np.arange(9.0).reshape(3, 3)
    data = {"time_s": TIMES, "inertia_error": tensor, "inertia_b_sigma": np.ones_like(tensor)}
    figure = pose_errors(data, "run 0")
    figure.draw_without_rendering()
    panels = [axis for axis in figure.axes if axis.lines]
    assert [float(np.asarray(axis.lines[0].get_ydata())[0]) for axis in panels] == [
        0,
        4,
        8,
        1,
        2,
        5,
    ]
    assert [axis.texts[-1].get_text() for axis in panels] == [
        "Ixx",
        "Iyy",
        "Izz",
        "Ixy",
        "Ixz",
        "Iyz",
    ]
    assert all(axis.collections for axis in panels)


def test_the_scene_has_every_point_where_its_first_pixel_is() -> None:
    """A camera 20 m behind, which looks along track, x to the right of a target that is turned."""
    rng = np.random.default_rng(4)
    points = rng.uniform(-1.0, 1.0, (5, 3))
    half = np.sqrt(0.5)
    data = {
        "true_point_b": points,
        "true_q_ib": np.tile([half, 0.0, 0.0, half], (2, 1)),
        "orbit_position": np.tile([7e6, 0.0, 0.0], (2, 1)),
        "orbit_velocity": np.tile([0.0, 7.5e3, 0.0], (2, 1)),
        "chaser_position_h": np.tile([0.0, -20.0, 0.0], (2, 1)),
        # The camera's z is along track, its x radial, its y against the orbit normal.
        "true_q_hc": np.tile([half, -half, 0.0, 0.0], (2, 1)),
        "measured_pixel": np.zeros((2, 1, 5, 2)),
    }
    # The body is turned by 90 deg about the normal: its x is along track, its y against the radius.
    expected = np.stack([-points[:, 1], -points[:, 2], points[:, 0]], axis=-1)
    assert np.allclose(in_first_image(data, points), expected)
    data["measured_pixel"][0, 0, 3] = np.nan
    figure = scene(data, "run 0")
    figure.draw_without_rendering()
    drawn = [line for line in figure.axes[1].get_lines() if line.get_marker() == "o"]
    assert np.allclose([np.ravel(line.get_data_3d()) for line in drawn], expected)
    filled = [line.get_markerfacecolor() != "white" for line in drawn]
    assert filled == [True, True, True, False, True]
