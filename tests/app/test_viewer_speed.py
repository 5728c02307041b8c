"""How quick the window is: printed, never asserted (run with -m bench -s)."""

# ruff: noqa: T201

import sys
import time
from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtTest import QTest

from insonify.scene import Scene, edit, load_scene
from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.record.record import pings_held
from insonify_viewer.record.record_image import blur_along_track
from insonify_viewer.state.history import Modelling
from insonify_viewer.viewer import Viewer
from insonify_viewer.work.ping_request import PingRequest
from insonify_viewer.work.simulator import Simulator
from soak.watch import Gaps

pytestmark = [pytest.mark.bench, pytest.mark.usefixtures("drawn_seabed")]
MOVES = 12
TURNS = 20
RATE = 60  # moves of a slider in a second


def seconds_of(act: Callable[..., object], *given: object) -> float:
    start = time.perf_counter()
    act(*given)
    return time.perf_counter() - start


@pytest.fixture(autouse=True)
def _threads_take_turns_as_in_the_program():
    before = sys.getswitchinterval()
    sys.setswitchinterval(0.001)
    yield
    sys.setswitchinterval(before)


def watch_gaps(viewer: Viewer) -> Gaps:
    """Gaps of the main thread, without what OpenGL takes of them."""
    gaps, canvas = Gaps(tick=1), viewer.seabed.view.canvas.plotter
    canvas.renderer.AddObserver("StartEvent", gaps.begin_drawing)
    canvas.renderer.AddObserver("EndEvent", gaps.end_drawing)
    canvas.aboutToCompose.connect(gaps.begin_drawing)
    canvas.frameSwapped.connect(gaps.end_drawing)
    return gaps


@pytest.fixture
def open_large(open_viewer, qtbot) -> Callable[[Scene], Viewer]:
    """Open a large viewer on a scene that is traced as in the program."""

    def open_one(scene: Scene) -> Viewer:
        viewer: Viewer = open_viewer(scene, prepare=None)
        viewer.window.resize(1480, 900)
        qtbot.wait(500)
        return viewer

    return open_one


GALLERY = (
    "default", "pipe-on-bed", "ripples", "wreck", "sediments", "targets", "ghosts", "rough-ground", "thermocline",
    "endless",
)  # fmt: skip
OF_DEFAULT = (
    ("seabed.relief.beta", 1.4), ("sonar.beam.width", 1.0), ("seabed.material.diffuse", 0.3), ("targets.0.radius", 0.5)
)  # fmt: skip


@pytest.mark.parametrize(
    ("name", "path", "value"), [*((name, "track", None) for name in GALLERY), *(("default", *at) for at in OF_DEFAULT)]
)
def test_a_preview_against_the_planned_record(qapp, name, path, value):
    """What a move of a slider costs, by default of altitude or depth, and how far both pictures are off.

    They are compared beyond 1.4 altitudes. The plan of a fine picture serves while the slider moves.
    """
    scene, simulator = load_scene(name), Simulator()
    if value is None:
        at = "depth" if scene.track.altitude is None else "altitude"
        path, value = f"track.{at}", getattr(scene.track, at)
    pings = np.arange(pings_held(scene) - 1, -1, -1, dtype=np.int64)
    list(simulator.trace(PingRequest(0, scene, Modelling(), pings, fine=True)))
    wall, busy, refined = [], [], []
    for number in range(1, MOVES + 1):
        moved = edit(scene, {path: value * (1.0 + 0.004 * number)})
        began, used, answers = time.perf_counter(), time.process_time(), []
        for answer in simulator.trace(PingRequest(number, moved, Modelling(), pings, fine=False)):
            if not answers:
                wall.append(time.perf_counter() - began)
                busy.append(time.process_time() - used)
            answers.append(answer)
        refined.append(time.process_time() - used)
    planned = list(simulator.trace(PingRequest(99, moved, Modelling(), pings, fine=True)))
    simulator.close()
    first, last = (_distance(answer, planned) for answer in (answers[0], answers[-1]))
    print(
        f"\n{name}, {path}: first picture in {1e3 * np.median(wall[1:]):.0f} ms, "
        f"processor {1e3 * np.median(busy[1:]):.0f} ms, {np.mean(~answers[0].between):.0%} of the pings traced, "
        f"{first:.1%} off; refined by processor {1e3 * np.median(refined[1:]):.0f} ms, {last:.1%} off"
    )


def _distance(answer, planned) -> float:
    """Mean difference of amplitudes, as they are shown, from the planned ones beyond 1.4 altitudes."""
    both = (np.concatenate([one.amplitude for one in planned]), answer.amplitude)
    wanted, found = (np.concatenate([one[:, 0, ::-1], one[:, 1]], axis=1) for one in both)
    arrays = answer.simulation.arrays
    if answer.reach is not None:
        found = blur_along_track(found, np.concatenate([answer.reach[::-1], answer.reach]))
    r = (np.arange(arrays.bins) + 0.5) * arrays.bin_length
    far = np.concatenate([r[::-1], r]) > 1.4 * np.nanmedian(answer.altitude)
    return float(np.abs(found - wanted)[:, far].sum() / wanted[:, far].sum())


SLIDERS = {
    "default": ("seabed.material.diffuse", "seabed.relief.beta", "track.altitude", "sonar.beam.width"),
    "figure-4a": ("seabed.relief.beta", "track.altitude"),
    "endless": ("seabed.relief.of.0.rms", "sonar.beam.width"),
}


@pytest.mark.parametrize(("name", "path"), [(name, path) for name, paths in SLIDERS.items() for path in paths])
def test_slider_at_60_hz(open_large, qtbot, name, path):
    """A slider that moves 60 times a second: delay of the pictures, and gaps of the main thread."""
    viewer = open_large(load_scene(name))
    row = viewer.panels["parameters"].view.row(path)
    moved = {}
    delays, traced = [], []

    def show(answer):
        if not answer.fine and (begun := moved.pop(answer.number, None)) is not None:
            delays.append(time.perf_counter() - begun)
            traced.append(answer.seconds)

    viewer.simulator.answered.connect(show)  # after the viewer, which has painted the record by then
    positions = iter(np.concatenate([np.linspace(200, 400, RATE), np.linspace(400, 200, RATE)]).astype(int))

    def move():
        position = next(positions, None)
        if position is None:
            timer.stop()
            return
        begun = time.perf_counter()
        row.slider.setValue(int(position))
        moved[viewer.number] = begun

    timer, gaps = QTimer(interval=1000 // RATE), watch_gaps(viewer)
    timer.timeout.connect(move)
    row.slider.setSliderDown(True)
    timer.start()
    qtbot.waitUntil(lambda: not timer.isActive())
    gaps.close()
    row.slider.setSliderDown(False)
    fine = seconds_of(qtbot.waitUntil, lambda: not viewer.missing().size)
    print(f"\n{name}, {path}: {len(delays)} pictures of {2 * RATE} moves; {gaps.in_words()}; fine after {fine:.3f} s")
    if delays:
        after, best, of_it = (1e3 * float(each) for each in (np.median(delays), min(delays), np.median(traced)))
        print(f"pictures {after:.0f} ms after their move (median; best {best:.0f}), of which {of_it:.0f} ms traced")


def test_live_tow(open_large, qtbot):
    viewer = open_large(load_scene("default"))
    viewer.tow.speed = 4.0
    viewer.tow.restart(1000)  # past the targets, before which it would pause
    viewer.run(True)
    qtbot.wait(500)
    gaps, before = watch_gaps(viewer), viewer.tow.newest
    qtbot.wait(3000)
    gaps.close()
    viewer.run(False)
    rate, drawing = (viewer.tow.newest - before) / 3.0, 1e3 * viewer.seabed.view.draw_time
    print(f"\n{rate:.0f} pings a second; 3-D drawing {drawing:.0f} ms")
    print(gaps.in_words())


def test_a_view_that_is_turned(open_large, qtbot):
    viewer = open_large(load_scene("default"))
    canvas = viewer.seabed.view.canvas.widget
    place, frames, seconds = canvas.rect().center(), [], []
    canvas.frameSwapped.connect(lambda: frames.append(time.perf_counter()))
    QTest.mousePress(canvas, Qt.MouseButton.LeftButton, pos=place)
    for turn in range(2 * TURNS):
        place += QPoint(6 if turn < TURNS else -6, (-1) ** turn)
        before = len(frames)
        QTest.mouseMove(canvas, place)
        seconds.append(seconds_of(qtbot.waitUntil, lambda before=before: len(frames) > before))
    QTest.mouseRelease(canvas, Qt.MouseButton.LeftButton, pos=place)
    size, rate = f"{canvas.width()} × {canvas.height()} px", 1 / np.mean(seconds)
    print(f"\n3-D view of {size} while turned: {rate:.1f} frames/s, median {1e3 * np.median(seconds):.0f} ms")


def test_a_target_that_is_dragged(open_large, qtbot):
    viewer = open_large(load_scene("default"))
    record, handles = viewer.window.waterfall, viewer.targets.handles.all
    number = next(k for k, handle in enumerate(handles) if handle.target == 1)
    place, gaps, coarse = record.handles.place(number), watch_gaps(viewer), []
    QTest.mousePress(record, Qt.MouseButton.LeftButton, pos=place)
    for _ in range(2 * MOVES):
        place += QPoint(3, -2)
        QTest.mouseMove(record, place)
        coarse.append(seconds_of(qtbot.waitUntil, lambda: not viewer.missing().size))
    QTest.mouseRelease(record, Qt.MouseButton.LeftButton, pos=place)
    gaps.close()
    print(f"\ntarget dragged in the record: coarse picture in {1e3 * np.median(coarse):.0f} ms (median)")
    print(gaps.in_words())


def test_panel_that_follows_a_slider(open_viewer):
    viewer = open_viewer(load_scene("default"))
    panel, seconds = viewer.panels["parameters"], []
    for altitude in np.linspace(5.0, 15.0, 3 * MOVES):
        viewer.session.drag({"track.altitude": float(altitude)})
        panel.view.soon.stop()
        seconds.append(seconds_of(panel._show))
    seconds = 1e3 * np.array(seconds[1:])
    print(f"\nall rows of the panel after a move: median {np.median(seconds):.1f} ms, worst {seconds.max():.1f} ms")


@pytest.mark.parametrize("pings", [512, 2048])
def test_a_and_b_change_places(open_large, qtbot, pings):
    viewer = open_large(edit(load_scene("default"), {"track.pings": pings}))
    kept = seconds_of(viewer.comparison.keep)
    viewer.session.settle({"sonar.beam.width": 2.0})
    qtbot.waitUntil(lambda: viewer.complete and bool(viewer.comparison.difference))
    view, flips = viewer.window.waterfall, []
    for turn in range(2 * TURNS):
        press = QTest.keyRelease if turn % 2 else QTest.keyPress
        flips.append(seconds_of(lambda press=press: (press(viewer.window, Qt.Key.Key_X), view.repaint())))
    size = f"{view.width()} × {view.height()} px"
    print(f"\n{pings} pings of 2 × 1000 bins in {size}: kept in {1e3 * kept:.1f} ms")
    print(f"A and B change places in {1e3 * np.median(flips):.1f} ms (median), {1e3 * max(flips):.1f} ms (worst)")
    for arrangement in (Arrangement.WIPED, Arrangement.DIFFERENCE):
        viewer.comparison.arrange(arrangement)
        frames = []
        for _ in range(TURNS):
            viewer.window.overlay._difference_of = None  # so that it is computed anew
            frames.append(seconds_of(view.repaint))
        print(f"{arrangement.value}: a frame in {1e3 * np.median(frames):.1f} ms (median), {1e3 * max(frames):.1f} ms")
    for arrangement in (Arrangement.ALONE, Arrangement.DIFFERENCE):
        viewer.comparison.arrange(arrangement)
        row, gaps = viewer.panels["parameters"].view.row("sonar.beam.width"), watch_gaps(viewer)
        row.slider.setSliderDown(True)
        for position in np.linspace(300, 600, MOVES).astype(int):
            row.slider.setValue(int(position))
            seconds_of(qtbot.waitUntil, lambda: not viewer.missing().size)
        gaps.close()
        row.slider.setSliderDown(False)
        print(f"slider with {arrangement.value}: {gaps.in_words()}")
