"""Echo and shadow edges of the bundled figures, against their closed forms."""

import math

import numpy as np
import pytest

from beds import pipe_edges
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.tracers import sweep

HEIGHT = 10.0  # m, of the sonar above the bed


def starboard(scene, ping: int) -> np.ndarray:
    # With and without targets a plan may keep other nodes of the level bed.
    return prepare(scene, forced={"spacing": "1"}).intensity(np.array([ping]))[0, 1]


@pytest.mark.parametrize(
    ("name", "gap", "printed"),
    [("pipe-on-bed", 0.0, [30.97, 31.46, 31.55, 34.88]), ("pipe-span", 1.0, [30.68, 31.18, 34.72, 38.89])],
)
def test_echo_and_shadow_lie_where_geometry_puts_them(name, gap, printed):
    scene = load_scene(name)
    step = scene.sonar.range / scene.sonar.bins
    near, tangent, begins, ends = pipe_edges(gap)
    np.testing.assert_allclose([near, tangent, begins, ends], printed, atol=0.006)
    for ping in (0, 100, 199):
        silent = np.flatnonzero(starboard(scene, ping)[int(20.0 / step) :] == 0.0) + int(20.0 / step)
        assert (np.diff(silent) == 1).all()
        assert silent[0] * step == pytest.approx(begins, abs=1.001 * step)
        assert (silent[-1] + 1) * step == pytest.approx(ends, abs=1.001 * step)
    bed = starboard(edit(scene, {"targets": []}), 100).astype(float)
    echo = np.flatnonzero(starboard(scene, 100) > 1.005 * bed)
    assert echo[0] * step == pytest.approx(near, abs=1.001 * step)
    assert (echo[-1] + 1) * step == pytest.approx(tangent, abs=1.001 * step)


@pytest.mark.parametrize(
    ("name", "apart"),
    [("figure-4a", {8.0: True, 22.0: True, 40.0: True}), ("figure-4b", {8.0: True, 22.0: False, 40.0: False})],
)
def test_a_fan_merges_what_a_knife_keeps_apart(name, apart):
    scene = load_scene(name)
    step = scene.sonar.range / scene.sonar.bins
    with_pair, without = (prepare(s, tolerance=0.003) for s in (scene, edit(scene, {"targets": []})))
    poses = with_pair.poses(np.arange(170, 231))  # about the middle of the pair
    # The same planes for both, so that the bed cancels exactly.
    with_pair, without = (sweep.trace(s.arrays, poses, planes=32)[:, 1] for s in (with_pair, without))
    for ground_range, separate in apart.items():
        near = math.hypot(ground_range, HEIGHT)
        bins = slice(int((near - 0.6) / step), int((near + 0.1) / step))
        # Energy of the pair, ping by ping.
        profile = np.maximum(with_pair[:, bins].astype(float) - without[:, bins], 0.0).sum(axis=1)
        between = profile[25:36].min() / profile.max()
        assert between == 0.0 if separate else between > 0.5


def heard_of_figure_3(pings, **changes):
    """Energy of figure 3 over a level bed of one material, port."""
    plain = {"seabed.relief": "flat", "seabed.material": "medium_sand", "sonar.pulse": "ideal"}
    return prepare(edit(load_scene("figure-3"), plain | changes)).intensity(np.array(pings))[:, 0]


def test_the_bed_of_figure_3_falls_silent_where_the_limiting_ray_touches_it():
    scene = load_scene("figure-3")
    height, speed, at_bed, gradient = 12.0, 1503.0, 1515.0, 1.0
    limit = math.sqrt(2.0 * at_bed / gradient * height - height**2)
    chord = math.hypot(limit, height)
    time = 2.0 / gradient * math.asinh(gradient * chord / (2.0 * math.sqrt(speed * at_bed)))
    heard = np.flatnonzero(heard_of_figure_3([0], targets=[])[0])
    step = scene.sonar.range / scene.sonar.bins
    # The last half metre is met within 0.02° of grazing, and what comes back of it is next to nothing.
    assert speed * time - 0.5 < (heard[-1] + 1) * step < speed * time + step


def test_of_what_lies_in_the_shadow_of_figure_3_the_post_alone_is_heard():
    scene = load_scene("figure-3")
    pings = [round(x / (scene.track.speed / scene.sonar.ping_rate)) for x in (40.0, 60.0, 80.0)]
    with_targets, without = heard_of_figure_3(pings), heard_of_figure_3(pings, targets=[])
    step = scene.sonar.range / scene.sonar.bins
    near, post, far = (slice(int(low / step), int(high / step)) for low, high in ((145, 152), (210, 217), (236, 245)))
    assert (with_targets[:, near].sum(axis=1) > 2.0 * without[:, near].sum(axis=1)).all()
    assert with_targets[1, post].sum() > 0.0
    assert with_targets[::2, post].sum() == 0.0
    assert with_targets[:, far].sum() == without[:, far].sum() == 0.0
