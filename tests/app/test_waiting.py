"""What the window shows while it waits, and the record that comes with the package meanwhile."""

import threading
import time

import numpy as np
import pytest
from controls import finish, picture_of
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest
from stand_in import StandIn

from insonify import simulation
from insonify.compiler.progress import Compilation, report_progress
from insonify.packing.packed_scene import pack
from insonify.planning.selection import choose_model
from insonify.scene import DEFAULT_SCENE, edit, load_scene
from insonify_viewer.seabed import pv_meshes
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.painting import dimmed
from insonify_viewer.work.newest_wins import NewestWins
from insonify_viewer.work.ping_request import PingRequest
from insonify_viewer.work.simulator import Simulator
from insonify_viewer.work.waiting import DELAY, FEW, Waiting, WaitingWatch


def look(watch: WaitingWatch, now: float, missing: int, **given) -> Waiting | None:
    state = {"number": 1, "arrived": 0, "shown": 512, "running": False, "activity": Waiting()}
    return watch.look(now, missing=missing, **state | given)


def test_a_wait_is_told_after_a_moment_unless_a_record_follows_a_slider_or_a_tow_misses_a_few_pings():
    watch = WaitingWatch()
    assert look(watch, 0.0, 512) is None
    assert look(watch, DELAY / 2, 512) is None
    assert look(watch, DELAY, 384) == Waiting("simulating pings, 128 of 512", 0.25)
    assert look(watch, DELAY, 384, activity=Waiting("building the bed")) == Waiting("building the bed", None)
    assert look(watch, 1.0, 0) is None
    assert look(watch, 2.0, 512) is None, "the next wait begins anew"
    assert look(watch, 3.0, 128) == Waiting("simulating pings, 384 of 512", 0.75)
    assert look(watch, 3.1, 512, number=2) == Waiting("simulating pings, 0 of 512", 0.0), "and the wait goes on"
    watch = WaitingWatch()
    moves = range(40)
    assert [look(watch, 0.1 * k, 512, number=k + 1, arrived=k) for k in moves] == [None] * len(moves)
    assert look(watch, 4.0 + DELAY, 512, number=60, arrived=39) is not None, "but a slider that it does not follow is"
    watch = WaitingWatch()
    assert [look(watch, now, FEW, running=True) for now in (0.0, 1.0, 2.0)] == [None] * 3
    look(watch, 3.0, FEW + 1, running=True)
    assert look(watch, 4.0, FEW + 1, running=True) is not None


def test_a_bed_shows_before_its_first_ping_stale_rows_are_dimmed_and_compiling_is_told(open_viewer, small, qtbot):
    going = {small.seed: threading.Event(), 5: threading.Event()}

    class Awaited(StandIn):
        def intensity(self, pings):
            going[self.scene.seed].wait(120.0)
            return super().intensity(pings)

    viewer = open_viewer(small, prepare=Awaited, until=lambda viewer: viewer.seabed.complete)
    waterfall, parameters = viewer.window.waterfall, viewer.panels["parameters"].view
    qtbot.waitUntil(lambda: waterfall.waiting is not None)
    assert not parameters.isEnabled()
    assert (viewer.record.ping < 0).all()
    going[small.seed].set()
    qtbot.waitUntil(lambda: viewer.complete and waterfall.waiting is None)
    assert parameters.isEnabled()
    bright = picture_of(waterfall).copy()
    viewer.session.settle({"seed": 5})
    assert (picture_of(waterfall) == bright).all(), "a short wait changes nothing"
    # On a busy machine it may first wait for the plan.
    first = "simulating pings, 0 of 128"
    qtbot.waitUntil(lambda: waterfall.waiting is not None and waterfall.waiting.what.startswith(first))
    assert (picture_of(waterfall) == dimmed(bright)).all()
    assert dimmed(np.array([0xFF000000, 0xFFFF8008], np.uint32)).tolist() == [0xFF000000, 0xFF5E3003], "darker"
    plain = waterfall.grab().toImage().pixelColor(200, 26)
    going[5].set()
    qtbot.waitUntil(lambda: viewer.complete and waterfall.waiting is None)
    assert (picture_of(waterfall) == bright).all()
    assert waterfall.grab().toImage().pixelColor(200, 26) != plain
    # A new bed is shown while its first ping is awaited.
    finish(viewer, qtbot, viewer.session.undo)
    shown = viewer.seabed.view.bed.points.copy()
    viewer.simulator.ask = lambda request: None  # as if kernels were compiled for minutes
    viewer.session.settle({"seabed.relief.rms": 0.3, "track.start": [500.0, 0.0]})
    viewer.simulator.laid.emit(viewer.number, pack(viewer.session.scene))
    qtbot.waitUntil(lambda: viewer.seabed.complete)
    assert abs(viewer.seabed.view.bed.points[:, 0].mean() - shown[:, 0].mean()) > 400.0
    viewer.session.show(gain=3.0)
    qtbot.wait(50)
    assert abs(viewer.seabed.view.bed.points[:, 0].mean() - shown[:, 0].mean()) > 400.0, "the old bed stays away"
    # The bar tells what is compiled.
    viewer.session.settle({"seed": 5})
    report_progress(Compilation("bent rays", 0.4, 55.0))
    compiling = "compiling bent rays, once, about a minute left", 0.4
    qtbot.waitUntil(lambda: waterfall.waiting == compiling)
    report_progress(None)
    qtbot.waitUntil(lambda: waterfall.waiting.what.startswith("simulating pings"))
    viewer.window.close()
    report_progress(Compilation("bent rays", 0.5, 55.0))
    assert viewer.simulator.activity == Waiting(), "a closed window does not watch"


def test_water_is_not_black_the_last_bed_is_faded_and_one_that_fails_is_told(open_viewer, small, qtbot, monkeypatch):
    going = threading.Event()
    draw = pv_meshes.bed_patch

    def draw_slowly(ground, *rest):
        if ground is not first:
            going.wait(120.0)
        return draw(ground, *rest)

    viewer = open_viewer(small, prepare=None, solid=True)
    first = viewer.seabed._bed[0]
    monkeypatch.setattr(pv_meshes, "bed_patch", draw_slowly)

    def strongest_contrast():
        viewer.seabed.draw_now()
        image = viewer.seabed.view.grab().toImage()
        greys = [image.pixelColor(x, image.height() * 3 // 4).lightness() for x in range(20, image.width() - 20)]
        return float(np.std(greys))

    usual = strongest_contrast()
    image = viewer.seabed.view.grab().toImage()
    water = image.pixelColor(image.width() // 8, 8)
    assert water.blue() > water.red() > 40, "nothing is black above the bed"
    viewer.open(edit(small, {"seabed.relief.beta": 2.0}))
    qtbot.waitUntil(lambda: not viewer.missing().size, timeout=120000)
    assert not viewer.complete
    assert strongest_contrast() < 0.7 * usual
    finish(viewer, qtbot, going.set)
    assert strongest_contrast() > 0.7 * usual

    # A bed that cannot be drawn is told with details.
    def fail(*_):
        raise KeyError("no such thing")

    monkeypatch.setattr(pv_meshes, "bed_patch", fail)
    viewer.open(edit(small, {"seabed.relief.beta": 2.5}))
    qtbot.waitUntil(viewer.window.status.copy.isVisible, timeout=120000)
    assert "the picture of the bed failed (KeyError: 'no such thing')" in viewer.window.status.sentence.text()
    QTest.mouseClick(viewer.window.status.copy, Qt.MouseButton.LeftButton)
    assert "in fail" in QGuiApplication.clipboard().text()
    qtbot.waitUntil(lambda: viewer.complete, timeout=120000)


def test_the_new_bed_is_told_before_its_methods_are_chosen(small, qtbot):
    told = []
    going = threading.Event()

    def prepare(scene, *, packed, **how):
        going.wait(120.0)
        made = StandIn(scene, **how)
        made.ground = packed.ground
        return made

    simulator = Simulator(prepare, pack)
    ready = []
    simulator.laid.connect(lambda number, packed: told.append((going.is_set(), packed.scene)))
    try:
        scenes = (small, edit(small, {"sonar.range": 40.0}), edit(small, {"seabed.relief.beta": 2.0}))
        for scene, beds in zip(scenes, (1, 1, 2)):
            going.clear()
            simulator.prepare(scene, Modelling(), ready.append)
            qtbot.waitUntil(lambda: simulator.activity.what == "choosing the fastest method within the tolerance")
            qtbot.waitUntil(lambda beds=beds: len(told) >= beds)
            qtbot.wait(20)  # for one that is told twice
            going.set()
            qtbot.waitUntil(lambda: len(ready) > 0)
            ready.clear()
        assert [scene.seabed.relief.beta for _, scene in told] == [1.4, 2.0], "once for each bed"
        assert not any(prepared for prepared, _ in told)
        assert simulator.activity == Waiting()
    finally:
        simulator.close()


@pytest.mark.parametrize("waits", [False, True])
def test_a_coarse_picture_that_takes_long_is_cut_short_for_a_newer_request(small, waits):
    traced = []

    class Slow(StandIn):
        def intensity(self, pings):
            time.sleep(0.02 * len(pings))
            traced.extend(pings)
            return super().intensity(pings)

    simulator = Simulator(prepare=Slow)
    request = PingRequest(0, small, Modelling(), np.arange(40, dtype=np.int64), fine=False)
    with simulator.lane.changed:  # so that the worker lets it wait
        if waits:
            simulator.ask(request)
        answer = next(simulator.trace(request))
        count = len(traced)
    simulator.close()
    assert len(answer.pings) == len(answer.amplitude)
    assert np.count_nonzero(~answer.between) == count
    assert (len(answer.pings) < 40) == waits
    assert answer.pings.tolist() == list(range(len(answer.pings))), "the most urgent ones"


def test_pings_between_traced_ones_are_interpolated_then_traced_and_fewer_when_the_picture_waited_for_its_ground(small):
    simulator = Simulator(prepare=StandIn)
    simulator.cost = 8e-4
    assert [simulator._stride(512, passed) for passed in (0.0, 0.01, 0.48, 1.0)] == [8, 8, 2, 1]
    simulator.cost = 1.0  # as if a ping took a second
    pings = np.arange(39, -1, -1, dtype=np.int64)
    answers = list(simulator.trace(PingRequest(3, small, Modelling(), pings, fine=False)))
    simulator.close()
    first, last = answers[0], answers[-1]
    assert np.flatnonzero(~first.between).tolist() == [0, 16, 32]
    assert first.amplitude[4] == pytest.approx(0.75 * first.amplitude[0] + 0.25 * first.amplitude[16], rel=1e-5)
    assert (first.amplitude[39] == first.amplitude[32]).all(), "beyond the last one there is nothing between"
    assert (first.amplitude[32] == last.amplitude[32]).all()
    assert not last.between.any()
    assert (last.amplitude == last.level.amplitudes(pings)).all()
    assert first.stamps.max() == last.stamps.min() == first.stamps.min() + 1


@pytest.fixture
def kernels(monkeypatch):
    """Let plans wait for an event, as they do for kernels."""
    ready = threading.Event()
    monkeypatch.setattr(simulation, "choose_model", lambda *case: ready.wait(120.0) and choose_model(*case))
    yield ready
    ready.set()


def test_the_default_record_is_shown_before_its_kernels_are_compiled(open_viewer, kernels, qtbot):
    viewer = open_viewer(
        load_scene(DEFAULT_SCENE), prepare=None, until=lambda it: it.answer is not None and it.seabed.complete
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
    begun = viewer.tow.newest
    viewer.run(True)
    qtbot.wait(200)
    assert viewer.tow.newest == begun, "the tow waits for the kernels"
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
    viewer = open_viewer(load_scene(DEFAULT_SCENE), prepare=None, until=lambda it: it.answer is not None)
    waterfall = viewer.window.waterfall
    bright = picture_of(waterfall).copy()
    viewer.session.settle({"track.altitude": 12.0})
    qtbot.waitUntil(lambda: waterfall.waiting is not None and (picture_of(waterfall) != bright).mean() > 0.5)
    assert "example" not in waterfall.waiting.what
    finish(viewer, qtbot, kernels.set)
    assert viewer.answer.simulation.scene.track.altitude == 12.0


@pytest.mark.parametrize(("in_turn", "asked", "shown"), [(False, [1, 2, 3], [30]), (True, [1, 3], [10, 30])])
def test_a_question_is_asked_once_and_the_newest_answer_wins(in_turn, asked, shown):
    sent, seen, newest = [], [], [None]
    question = NewestWins(
        lambda: newest[0] and (newest[0],), lambda work, receive: sent.append((work, receive)), lambda n: 10 * n,
        seen.append, in_turn=in_turn,
    )  # fmt: skip
    assert not question.ask()
    assert question.complete, "nothing is wanted"
    for newest[0] in (1, 1, 2, 3, 3):
        question.ask()
    assert not question.complete
    found = []
    while sent:
        work, receive = sent.pop(0)
        found.append(work() // 10)
        receive(work())
    assert (found, seen) == (asked, shown)
    assert question.complete
    assert not question.ask(), "it is shown"
    question.forget()
    assert question.ask()
    newest[0] = None
    sent.pop()[1](30)
    assert seen == (shown if not in_turn else [*shown, 30]), "nothing is wanted by now"
