"""Heights of endless ground may take a second: the main thread never computes them."""

import threading

import numpy as np
import pytest

from insonify.array_cache import ARRAYS
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.terrain import build
from insonify.terrain.endless_ground import EndlessExcerpt
from insonify_viewer.state.inspection import Mark
from insonify_viewer.work.simulator import pack_beneath, thin_new_ground


def test_the_main_thread_never_sums_the_relief(open_viewer, qtbot, monkeypatch):
    summing, endless_heights = [], build.endless_heights  # names of the threads that sum the relief of some nodes

    def watched(*given):
        heights = endless_heights(*given)

        def made(nodes):
            summing.append(threading.current_thread().name)
            return heights(nodes)

        return made

    monkeypatch.setattr(build, "endless_heights", watched)
    for kept in (build._kept_relief, build._kept_squares):
        kept.cache_clear()
    few = {"sonar.bins": 100, "sonar.range": 25.0, "track.pings": 128, "seabed.spacing": 0.4}
    viewer = open_viewer(edit(load_scene("endless"), few | {"seed": 77}), prepare=prepare)
    qtbot.waitUntil(lambda: viewer.seabed.complete)
    ARRAYS.clear()  # as when other scenes were open meanwhile
    summing.append("looking back")
    viewer.go_to(40)
    qtbot.waitUntil(lambda: viewer.window.waterfall.top == 40)
    qtbot.waitUntil(lambda: summing[-1] != "looking back")
    ARRAYS.clear()
    summing.append("pointing")
    viewer.session.point_at(Mark(30, 0, 60))
    qtbot.waitUntil(lambda: summing[-1] != "pointing")
    assert threading.main_thread().name not in summing
    qtbot.waitUntil(lambda: viewer.marks._point is not None and viewer.marks._point.mark == Mark(30, 0, 60))


def test_new_ground_is_thinned_while_a_slider_moves(open_viewer, qtbot):
    few = {"sonar.bins": 100, "sonar.range": 20.0, "track.pings": 64, "seabed.spacing": 0.4}
    scene = edit(load_scene("endless"), few | {"seabed.relief.of.1.wavelength": 8.0, "seed": 78})
    viewer, answers = open_viewer(scene, prepare=None), []  # accuracy and ground of each
    viewer.simulator.answered.connect(lambda answer: answers.append((answer.fine, answer.simulation.ground)))

    def drag(path: str, value: float) -> None:
        """Drag a value and release it."""
        answers.clear()
        viewer.session.drag({path: value})
        qtbot.waitUntil(lambda: bool(answers))
        viewer.session.settle(None, "moved")
        qtbot.waitUntil(lambda: viewer.complete and answers[-1][0])

    drag("seabed.relief.of.0.rms", 0.1)
    (is_fine, coarse), *_, (_, fine) = answers
    assert (is_fine, coarse.spacing) == (False, pytest.approx(4 * scene.seabed.spacing))
    assert isinstance(coarse, EndlessExcerpt), "no more of it is made than the pings need"
    assert not isinstance(fine, EndlessExcerpt)
    assert fine.spacing == scene.seabed.spacing
    drag("sonar.beam.width", 1.5)
    assert {ground.spacing for _, ground in answers} == {scene.seabed.spacing}, "known ground is taken as it is"


def test_ground_is_thinned_as_far_as_its_waves_are_resolved_to_the_same_landscape():
    endless = load_scene("endless")
    moved = edit(endless, {"seed": 4})
    assert thin_new_ground(moved, endless).seabed.spacing == pytest.approx(0.4)
    short = edit(moved, {"seabed.relief.of.1.wavelength": 0.7})
    assert thin_new_ground(short, endless).seabed.spacing == pytest.approx(0.2)
    shortest = edit(moved, {"seabed.relief.of.1.wavelength": 0.4})
    assert thin_new_ground(shortest, endless) is shortest
    assert thin_new_ground(endless, endless) is endless
    assert thin_new_ground(load_scene("default"), None).seabed.spacing == load_scene("default").seabed.spacing
    fractal = edit(endless, {"seabed.relief.of.1.height": 0.0})
    one, other = (build.build_ground(scene) for scene in (fractal, thin_new_ground(fractal, None)))
    along = np.arange(0.0, 40.0, 0.8)
    x, y = np.meshgrid(along, along)
    whole, thinned = one.height_at(x, y), other.height_at(x, y)
    assert np.corrcoef(whole.ravel(), thinned.ravel())[0, 1] > 0.98


@pytest.mark.parametrize("heading", [0.0, 35.0])
def test_the_ground_beneath_pings_is_all_that_they_hear(heading):
    scene = edit(load_scene("endless"), {"seabed.spacing": 0.4, "track.heading": heading, "track.pings": 128})
    pings = np.arange(90, 128)
    over_tiles = prepare(scene, forced={"planes": "1"}).intensity(pings)
    beneath = prepare(scene, forced={"planes": "1"}, packed=pack_beneath(scene, pings)).intensity(pings)
    np.testing.assert_allclose(beneath, over_tiles, rtol=1e-3, atol=1e-4 * over_tiles.max())


def test_ground_of_a_fast_tow_is_made_in_tiles():
    """A rectangle about pings that lie kilometres apart would not fit into memory."""
    fast = edit(load_scene("endless"), {"seabed.spacing": 0.4, "track.speed": 50.0, "sonar.ping_rate": 0.5})
    assert not isinstance(pack_beneath(fast, np.arange(1024)).ground, EndlessExcerpt)
    assert isinstance(pack_beneath(fast, np.arange(4)).ground, EndlessExcerpt)
