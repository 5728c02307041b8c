"""Echo and shadow edges of the bundled figures, against their closed forms."""

import numpy as np
import pytest

from beds import pipe_edges
from insonify.scene import edit, load_scene
from insonify.simulation import prepare


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


def test_of_what_lies_in_the_shadow_of_figure_3_the_post_alone_is_heard():
    plain = {"seabed.relief": "flat", "seabed.material": "medium_sand", "sonar.pulse": "ideal"}
    scene = edit(load_scene("figure-3"), plain)
    pings = np.array([round(x / (scene.track.speed / scene.sonar.ping_rate)) for x in (40.0, 60.0, 80.0)])
    with_targets, without = (prepare(s).intensity(pings)[:, 0] for s in (scene, edit(scene, {"targets": []})))
    step = scene.sonar.range / scene.sonar.bins
    near, post, far = (slice(int(low / step), int(high / step)) for low, high in ((145, 152), (210, 217), (236, 245)))
    assert (with_targets[:, near].sum(axis=1) > 2.0 * without[:, near].sum(axis=1)).all()
    assert with_targets[1, post].sum() > 0.0
    assert with_targets[::2, post].sum() == 0.0
    assert with_targets[:, far].sum() == without[:, far].sum() == 0.0
