"""The fan in three dimensions ends at what the sound meets, and has gaps where something shades it."""

import numpy as np
import pytest
import pyvista as pv

from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify_viewer.seabed.fan_sheet import STEP, fan_sheet


def far_ends(triangles: np.ndarray) -> np.ndarray:
    """Corners of the triangles but for the sonar, (2n, 3)."""
    return triangles[:, 1:].reshape(-1, 3)


def test_the_fan_ends_at_the_pipe_and_leaves_its_shadow_out():
    simulation = prepare(edit(load_scene("pipe-on-bed"), {"track.pings": 64}))
    triangles = fan_sheet(simulation, 40)
    sonar = simulation.poses(np.array([40]))
    np.testing.assert_allclose(triangles[:, 0], [[sonar.x[0], sonar.y[0], sonar.z[0]]] * len(triangles))
    ends = far_ends(triangles)
    np.testing.assert_allclose(ends[:, 0], sonar.x[0], atol=1e-9)  # a knife
    on_pipe = ends[ends[:, 2] > 0.05]
    np.testing.assert_allclose(np.hypot(on_pipe[:, 1] + 30.0, on_pipe[:, 2] - 0.5), 0.5, atol=1e-6)
    # The ray that grazes the pipe comes down at 33.4 m: none of the bed between has a triangle.
    assert not ((ends[:, 1] < -30.6) & (ends[:, 1] > -33.3)).any()
    assert (ends[:, 1] < -33.3).any()
    assert ends[:, 1].max() > 48.0
    # No triangle spans the shadow.
    one, other = triangles[:, 1, 1], triangles[:, 2, 1]
    assert not ((np.minimum(one, other) < -33.3) & (np.maximum(one, other) > -30.6)).any()


def test_triangles_are_few_and_narrow():
    simulation = prepare(edit(load_scene("default"), {"track.pings": 64}))
    triangles = fan_sheet(simulation, 40)
    ends = far_ends(triangles).reshape(-1, 2, 3) - triangles[:, :1]
    unit = ends / np.linalg.norm(ends, axis=2, keepdims=True)
    angle = np.arccos(np.clip((unit[:, 0] * unit[:, 1]).sum(axis=1), -1.0, 1.0))
    assert angle.max() < 3.0 * STEP
    assert len(triangles) < 2000
    ground = simulation.ground.height_at(far_ends(triangles)[:, 0], far_ends(triangles)[:, 1])
    assert (far_ends(triangles)[:, 2] >= ground - 0.02).all()


def test_the_window_shows_the_fan_that_is_cut(open_viewer, qtbot):
    viewer = open_viewer(edit(load_scene("pipe-on-bed"), {"track.pings": 64, "sonar.bins": 500}), prepare=None)
    viewer.go_to(40)
    view = viewer.seabed.view
    expected = fan_sheet(viewer._answer.simulation, 40)

    def shown():
        points = np.asarray(pv.wrap(view._sheet_actor.mapper.GetInput()).points)
        return points.shape == (3 * len(expected), 3) and bool(np.allclose(points, expected.reshape(-1, 3), atol=1e-3))

    qtbot.waitUntil(shown, timeout=60000)


@pytest.mark.parametrize("name", ["double-image", "endless"])
def test_a_fan_without_a_section_is_drawn_whole(name):
    simulation = prepare(edit(load_scene(name), {"track.pings": 32}), forced={"planes": "1"})
    triangles = fan_sheet(simulation, 10)
    assert triangles.shape[1:] == (3, 3)
    assert np.isfinite(triangles).all()
