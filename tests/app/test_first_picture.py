"""The record that comes with the package, in a window that still compiles its kernels."""

import threading

import numpy as np
import pytest
from controls import picture_of

from insonify import simulation
from insonify.planning.selection import choose_model
from insonify.scene import load_scene
from insonify_viewer.state.inspection import Mark


@pytest.fixture
def kernels(monkeypatch):
    """Let plans wait for an event, as they do for kernels."""
    ready = threading.Event()
    monkeypatch.setattr(simulation, "choose_model", lambda *case: ready.wait(120.0) and choose_model(*case))
    yield ready
    ready.set()


def test_the_default_record_is_shown_before_its_kernels_are_compiled(open_viewer, kernels, qtbot):
    viewer = open_viewer(
        load_scene("default"), prepare=None, until=lambda viewer: viewer._answer is not None and viewer.seabed.complete
    )
    waterfall = viewer.window.waterfall
    qtbot.waitUntil(lambda: waterfall.waiting is not None)
    assert waterfall.waiting.what.startswith("example; ")
    assert not viewer.complete
    drawn, mark, seen = picture_of(waterfall).copy(), Mark(300, 1, 400), []
    assert np.unique(drawn).size > 100
    viewer.panels.point_marked.connect(seen.append)
    viewer.session.point_at(mark)
    qtbot.waitUntil(lambda: bool(seen) and seen[-1] is not None)
    assert seen[-1].mark == mark
    assert seen[-1].intensity > 0.0
    viewer.run(True)
    qtbot.wait(200)
    assert viewer.tow.newest == 511, "the tow waits for the kernels"
    viewer.run(False)
    viewer.session.show(palette="grey")
    assert (picture_of(waterfall) != drawn).any()
    viewer.session.show(palette="copper")
    assert (picture_of(waterfall) == drawn).all()
    kernels.set()
    qtbot.waitUntil(lambda: viewer.complete and waterfall.waiting is None)
    assert (picture_of(waterfall) == drawn).mean() > 0.99
    assert seen[-1].mark == mark


def test_an_edit_dims_the_example_until_its_own_record_is_traced(open_viewer, kernels, qtbot):
    viewer = open_viewer(load_scene("default"), prepare=None, until=lambda viewer: viewer._answer is not None)
    waterfall = viewer.window.waterfall
    bright = picture_of(waterfall).copy()
    viewer.session.settle({"track.altitude": 12.0})
    qtbot.waitUntil(lambda: waterfall.waiting is not None and (picture_of(waterfall) != bright).mean() > 0.5)
    assert "example" not in waterfall.waiting.what
    kernels.set()
    qtbot.waitUntil(lambda: viewer.complete)
    assert viewer._answer.simulation.scene.track.altitude == 12.0
