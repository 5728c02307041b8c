"""A recording is opened beside the simulated record, scrolls, tells where the sonar was, and is measured."""

import threading
from pathlib import Path

import numpy as np
import pytest
from controls import bring_to_front, choose, drag, drop, finish, move_mouse, picture_of
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog

from insonify import simulate
from insonify.cli import main
from insonify.io.records import read_record, write_record
from insonify.io.records import recording as io_recording
from insonify.scene import edit, load_scene
from insonify.statistics.record_statistics import measure_statistics
from insonify_viewer.record.comparison import recording as recording_module
from insonify_viewer.record.comparison import recording_player
from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.record.comparison.recording import (
    MAX_PINGS,
    Recording,
    compass_heading,
    describe_point,
    explain_point,
)
from insonify_viewer.state.inspection import Mark
from insonify_viewer.state.tow_clock import SPEEDS
from insonify_viewer.window.uncaught_errors import reported_warnings
from insonify_viewer.work.jobs import State

REAL = Path("../shared/data/xtf/scotsman-iver2.xtf")
PINGS, BINS, RANGE, STEP = 400, 300, 60.0, 0.2
SETTINGS = {"track.pings": PINGS, "sonar.bins": BINS, "sonar.range": RANGE}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with one record as XTF and as netCDF."""
    made, record = tmp_path_factory.mktemp("records"), simulate(edit(load_scene("default"), SETTINGS))
    for name in ("record.xtf", "record.nc"):
        write_record(made / name, [record])
    return made


@pytest.fixture
def viewer(open_viewer, small):
    # As in the program, warnings are reported before any thread begins: one that leaves `catch_warnings`, which
    # Numba's compiler enters, restores the filters of the time when it entered.
    opened = []
    with reported_warnings(lambda sentence: opened[0].simulator.executor.call_later(opened[0].window.say, sentence)):
        opened.append(open_viewer(edit(small, {"track.pings": 256})))
        yield opened[0]


def open_recording(viewer, path, qtbot):
    finish(viewer, qtbot, viewer.recordings.open, str(path))
    return viewer.recordings.recording


def test_any_ping_is_reached_the_last_file_wins_and_a_broken_one_is_told(viewer, folder, tmp_path, qtbot, monkeypatch):
    broken = tmp_path / "broken.xtf"
    broken.write_bytes(b"no recording" * 200)
    viewer.recordings.open(str(broken))
    qtbot.waitUntil(lambda: "not an XTF file" in viewer.window.status.sentence.text())
    assert not viewer.window.record_a.isVisible()
    recording = open_recording(viewer, folder / "record.xtf", qtbot)
    viewer.recordings.open(str(broken))
    qtbot.waitUntil(lambda: "not an XTF file" in viewer.window.status.sentence.text())
    assert viewer.recordings.recording is recording
    assert viewer.window.record_a.isVisible()
    assert viewer.window.record_a.waiting is None
    viewer.run(True)
    viewer.window.record_a.scrubbed.emit(100)
    assert not viewer.tow.running
    assert viewer.window.record_a.top == viewer.recordings.top == 100
    viewer.window.record_a.scrolled.emit(16)
    assert viewer.window.record_a.top == 84
    viewer.window.record_a.scrolled.emit(-1000)
    assert viewer.window.record_a.top == recording.pings - 1
    for ping in (0, 57, recording.pings - 1):
        viewer.window.record_a.scrubbed.emit(ping)
        row = viewer.window.record_a.record.rows(np.array([ping]))[0]
        expected = np.concatenate([recording.amplitude[ping, 0, ::-1], recording.amplitude[ping, 1]])
        np.testing.assert_array_equal(viewer.window.record_a.record.amplitude[row], expected)
    # What a cut recording lacks is said.
    cut = tmp_path / "cut.xtf"
    cut.write_bytes((folder / "record.xtf").read_bytes()[:-100])
    assert open_recording(viewer, cut, qtbot).pings == PINGS - 1
    assert "cut.xtf: ends within the packet at byte" in viewer.window.status.sentence.text()
    # Reading shows a bar, and the last file wins.
    load, go_on = recording_player.load_recording, threading.Event()

    def load_slowly(path, frequency):
        if path.endswith(".xtf"):
            go_on.wait(120.0)
        return load(path, frequency)

    monkeypatch.setattr(recording_player, "load_recording", load_slowly)
    viewer.recordings.open(str(folder / "record.xtf"))
    assert viewer.window.record_a.waiting.what.startswith("reading record.xtf, ")
    assert not viewer.complete
    viewer.recordings.open(str(folder / "record.nc"))
    qtbot.waitUntil(lambda: viewer.recordings.recording.path.suffix == ".nc")
    finish(viewer, qtbot, go_on.set)
    assert viewer.recordings.recording.path.suffix == ".nc"
    assert viewer.window.record_a.waiting is None
    # In a narrow window the records take the room.
    window = viewer.window
    window.resize(1600, 900)
    open_recording(viewer, folder / "record.xtf", qtbot)
    qtbot.waitUntil(lambda: window.views.sizes()[0] > 250)
    window.resize(880, 600)
    qtbot.waitUntil(lambda: window.views.sizes()[0] == 0)
    _, recorded, simulated = window.views.sizes()
    assert abs(simulated - recorded) <= 2
    assert window.record_a.geometry().right() < window.waterfall.geometry().left()
    window.resize(1600, 900)
    qtbot.waitUntil(lambda: window.views.sizes()[0] > 250)


def test_a_recording_is_opened_by_a_drop_and_the_menu_and_tells_its_navigation(viewer, folder, qtbot, monkeypatch):
    for name in ("record.xtf", "record.nc"):
        monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, name=name: (str(folder / name), ""))
        for way in (lambda name=name: drop(viewer.window, folder / name), viewer.window.open_recording.trigger):
            before = viewer.recordings.recording
            way()
            qtbot.waitUntil(lambda before=before: viewer.recordings.recording is not before)
            assert viewer.recordings.recording.path.name == name
            qtbot.waitUntil(lambda: viewer.complete, timeout=120000)
    # A point tells navigation.
    recording = viewer.recordings.recording
    view = viewer.window.record_a
    mark = Mark(250, 1, 200)
    QTest.mouseMove(view, view.place_of(mark))
    qtbot.waitUntil(lambda: "slant range" in viewer.panels["comparison"].view.point.rows)
    told = {name: values[0] for name, values in viewer.panels["comparison"].view.point.rows.items()}
    ping = int(told["ping"].split()[0])
    assert abs(ping - mark.ping) <= 2
    altitude = recording.dataset["platform_altitude"].values[ping]
    known = {"ping": f"{ping} of {PINGS}", "position": f"x {ping * STEP:.1f} m, y 0.0 m"}
    known |= {"altitude": f"{altitude:.2f} m", "heading": "90.0°", "time": f"{ping / 10.0:.2f} s"}  # +x is east
    assert known.items() <= told.items()
    assert told["slant range"].endswith(" m, starboard")
    assert float(told["slant range"].split()[0]) == pytest.approx(200.5 * RANGE / BINS, abs=3 * RANGE / BINS)
    assert told["level"].endswith("dB re median")
    line = viewer.panels["readout"].widget.text()
    assert line.startswith(f"recorded ping {ping}  ·  slant {told['slant range']}")
    assert "heading 90.0°" in line
    QTest.mouseMove(view, QPoint(2, view.height() // 2))
    qtbot.waitUntil(lambda: viewer.panels["readout"].widget.text() == "")


def test_a_mosaic_is_offered_the_recording_that_is_open(viewer, folder, qtbot, monkeypatch):
    view, offered = viewer.panels["jobs"].widget, []
    monkeypatch.setattr(QFileDialog, "getOpenFileNames", lambda *asked: (offered.append(asked[2]), ([], ""))[1])
    view.mosaic.click()
    open_recording(viewer, folder / "record.xtf", qtbot)
    view.mosaic.click()
    assert offered == ["", str((folder / "record.xtf").resolve())]


def test_a_click_into_a_recording_tells_of_its_pixel_and_explains_none_of_the_simulated_record(viewer, folder, qtbot):
    recording = open_recording(viewer, folder / "record.xtf", qtbot)
    pixel, view = viewer.panels["pixel"].view, viewer.window.record_a
    viewer.inspection.pin(Mark(200, 0, 50))
    mark = Mark(250, 1, 200)
    QTest.mouseClick(view, Qt.MouseButton.LeftButton, pos=view.place_of(mark))
    assert viewer.inspection.mark is None
    assert pixel.isVisible()
    said = pixel.summary.text()
    found = view.mark_at(view.place_of(mark))
    slant, altitude = recording.slant_range_of(found.bin), float(recording.altitude[found.ping])
    assert said.startswith(f"recorded ping {found.ping}, {slant:.2f} m, starboard, altitude {altitude:.2f} m: flat bed")
    ground = np.sqrt(slant**2 - altitude**2)
    assert f"at {ground:.2f} m ground range, grazing angle {np.degrees(np.arcsin(altitude / slant)):.1f}°" in said
    assert "dB re median at its range" in pixel.sentence.text()
    assert "in the water column" in explain_point(recording, Mark(250, 0, 2))[1]
    # The same place of the simulated record is one click away.
    live, links = viewer.window.waterfall, viewer.comparison.links
    assert pixel.same_place.isVisible()
    pixel.same_place.click()
    same = links.find_place(view, live, found)
    assert viewer.inspection.mark == same
    assert same is not None
    assert not pixel.same_place.isVisible()
    # Where it is wiped over the live record, too.
    live, overlay = viewer.window.waterfall, viewer.window.overlay
    narrow = live.width()
    choose(viewer.panels["comparison"].view.arrangement, list(Arrangement).index(Arrangement.WIPED))
    qtbot.waitUntil(lambda: live.width() > narrow)
    pixel.show_nothing()
    live.grab()
    place = QPoint(overlay.split - 40, live.plot_area.center().y())
    QTest.mouseClick(overlay, Qt.MouseButton.LeftButton, pos=place)
    assert viewer.inspection.mark is None
    assert pixel.summary.text().startswith("recorded ping")
    viewer.recordings.close()
    assert not pixel.summary.isVisible()


def test_closing_withdraws_a_file_that_is_being_read(viewer, folder, qtbot, monkeypatch):
    load, go_on = recording_player.load_recording, threading.Event()

    def load_late(path, frequency):
        go_on.wait(120.0)
        return load(path, frequency)

    monkeypatch.setattr(recording_player, "load_recording", load_late)
    opened = []
    viewer.recordings.opened.connect(opened.append)
    for leave in (viewer.recordings.close, viewer.comparison.leave, viewer.comparison.keep):
        viewer.recordings.open(str(folder / "record.xtf"))
        leave()
        assert viewer.window.record_a.waiting is None or viewer.comparison.kept is not None
    kept = viewer.comparison.kept
    assert kept is not None
    finish(viewer, qtbot, go_on.set)
    assert viewer.comparison.a is kept
    assert viewer.recordings.recording is None
    assert not any(opened)


def test_it_plays_and_pauses_with_the_tow_whatever_targets_leave_and_begins_anew_at_its_end(viewer, folder, qtbot):
    viewer.tow.speed = 16.0
    viewer.run(True)
    qtbot.waitUntil(lambda: not viewer.tow.running)
    stopped = viewer.tow.newest
    assert "before the targets scroll out" in viewer.window.status.sentence.text()
    viewer.tow.restart(255)
    open_recording(viewer, folder / "record.xtf", qtbot)
    viewer.run(True)
    qtbot.waitUntil(lambda: viewer.tow.newest > stopped + 50)
    assert viewer.tow.running
    # It is opened paused, and plays.
    open_recording(viewer, folder / "record.xtf", qtbot)
    assert not viewer.tow.running, "a recording is opened paused"
    assert viewer.recordings.top == PINGS - 1
    choose(viewer.window.speed, SPEEDS.index(4.0))
    viewer.run(True)
    qtbot.waitUntil(lambda: 5 <= viewer.recordings.top < PINGS - 1)
    assert viewer.window.record_a.top == viewer.recordings.top
    shown = viewer.panels["comparison"].view.point.rows["ping"][0]
    assert shown == f"{viewer.recordings.top} of {PINGS}", "the panel follows the ping on top"
    viewer.run(False)
    qtbot.wait(60)
    at = viewer.recordings.top
    qtbot.wait(120)
    assert viewer.recordings.top == at
    viewer.recordings.go_to(PINGS - 3)
    viewer.run(True)
    qtbot.waitUntil(lambda: viewer.recordings.top == PINGS - 1)
    # Rows below its first ping are empty, and the point behind a tab follows.
    viewer.run(False)
    viewer.window.record_a.show_marks(cross=None)
    viewer.recordings.go_to(PINGS // 2)
    view = viewer.window.record_a
    image = view.grab().toImage()
    place = view.place_of(Mark(0, 1, BINS // 2))
    below = [image.pixelColor(place.x(), place.y() + step).getRgb()[:3] for step in range(8, 80)]
    np.testing.assert_allclose(below, [(0x0B, 0x11, 0x18)] * len(below), atol=8)  # a screen may have 16 bits
    shown = viewer.panels["comparison"].view.point
    bring_to_front(viewer.window, "parameters")
    viewer.recordings.go_to(57)
    bring_to_front(viewer.window, "comparison")
    assert shown.rows["ping"] == (f"57 of {PINGS}",)


def test_numbers_are_those_of_compare(open_viewer, folder, qtbot):
    viewer = open_viewer(edit(load_scene("default"), SETTINGS), prepare=None)
    recording = open_recording(viewer, folder / "record.nc", qtbot)
    rows = viewer.panels["comparison"].view.statistics.rows
    expected = measure_statistics(read_record(folder / "record.nc")).described()
    assert rows.pop("") == ("recorded", "simulated")
    # The recording is the record of the scene.
    assert rows == {name: (text, text) for name, text in expected.items()}
    finish(viewer, qtbot, viewer.session.settle, {"receiver.speckle": "rayleigh"})
    recorded, simulated = viewer.panels["comparison"].view.statistics.rows["variation"]
    assert recorded == expected["variation"]
    assert float(simulated.split()[0]) == pytest.approx(0.52, abs=0.06)
    assert viewer.recordings.recording is recording


def test_a_recording_is_shown_beside_the_simulated_record_or_wiped_over_it_at_the_same_scale(viewer, folder, qtbot):
    panel, view, overlay = viewer.panels["comparison"].view, viewer.window.waterfall, viewer.window.overlay
    beside = viewer.window.record_a
    assert not beside.isVisible()
    open_recording(viewer, folder / "record.xtf", qtbot)
    viewer.recordings.close()
    assert not beside.isVisible()
    assert viewer.complete
    recording = open_recording(viewer, folder / "record.xtf", qtbot)
    assert beside.isVisible()
    assert view.isVisible()
    assert picture_of(beside).shape[0] == recording.pings == PINGS
    np.testing.assert_allclose(beside.extent(), (PINGS * STEP, 2.0 * RANGE), rtol=2e-3)
    assert len(np.unique(picture_of(beside))) > 50
    assert panel.title.text() == "record.xtf\n400 pings of 2 × 300 bins  ·  60 m  ·  400 kHz"
    # Wiped it covers the left at the same scale.
    alone = view.grab().toImage()
    choose(panel.arrangement, list(Arrangement).index(Arrangement.WIPED))
    qtbot.waitUntil(lambda: view.width() > alone.width())
    assert not viewer.window.record_a.isVisible()
    # 400 pings of 0.2 m within ±60 m, over 256 of 0.2 m within ±50 m.
    plot, place = view.plot_area, overlay.place_of_a()
    assert place.width() / plot.width() == pytest.approx(60.0 / 50.0, rel=2e-3)
    assert place.height() / plot.height() == pytest.approx(PINGS / 256.0, rel=2e-3)
    pointed = []
    viewer.recordings.pointed.connect(pointed.append)
    move_mouse(overlay, QPoint(overlay.split - 20, plot.center().y()))
    # Ping 128 from the top, some metres to port.
    expected = (19.5 / plot.width()) * 100.0 / (60.0 / recording.bins)
    assert pointed[-1].side == 0
    assert abs(pointed[-1].bin + 0.5 - expected) <= 1.5
    assert abs(pointed[-1].ping - (viewer.recordings.top - 128)) <= 1
    assert not overlay.covers(QPoint(overlay.split + 20, plot.center().y()))
    middle = QPoint(overlay.split, plot.center().y())
    drag(overlay, middle, QPoint(plot.left() + plot.width() // 4, middle.y()))
    assert overlay.split == pytest.approx(plot.left() + plot.width() // 4, abs=2)
    view.grab()
    assert picture_of(viewer.window.record_a).shape[1] == view.plot_area.width(), "as fine as the live record"
    panel.arrangement.activated.emit(list(Arrangement).index(Arrangement.BESIDE))
    assert viewer.window.record_a.isVisible()
    # A kept record takes its place.
    viewer.window.comparison.toggled.emit(Arrangement.DIFFERENCE)
    viewer.window.waterfall.grab()
    assert viewer.window.overlay.difference.pixels.shape[0] == 256
    viewer.comparison.keep()
    assert viewer.recordings.recording is None
    assert viewer.comparison.kept is not None
    assert viewer.panels["comparison"].view.title.text().startswith("A: ")
    recording = open_recording(viewer, folder / "record.xtf", qtbot)
    assert viewer.comparison.a is recording
    viewer.comparison.leave()
    assert viewer.comparison.a is None


def test_a_long_recording_is_played_from_its_file_until_that_is_gone(viewer, folder, tmp_path, qtbot, monkeypatch):
    whole = recording_module.load_recording(str(folder / "record.xtf"))
    monkeypatch.setattr(recording_module, "MOST_IN_MEMORY", 0)
    monkeypatch.setattr(io_recording, "FEW_ECHOES", 0)
    path = tmp_path / "record.xtf"
    path.write_bytes((folder / "record.xtf").read_bytes())
    recording = open_recording(viewer, path, qtbot)
    np.testing.assert_array_equal(recording.overview, whole.overview)
    for ping in (PINGS - 1, 31):
        viewer.window.record_a.scrubbed.emit(ping)
        row = viewer.window.record_a.record.rows(np.array([ping]))[0]
        expected = np.concatenate([whole.amplitude[ping, 0, ::-1], whole.amplitude[ping, 1]])
        np.testing.assert_array_equal(viewer.window.record_a.record.amplitude[row], expected)
    assert describe_point(recording, Mark(20, 1, 200)) == describe_point(whole, Mark(20, 1, 200))
    path.unlink()
    assert describe_point(recording, Mark(20, 1, 200))["level"] == "its file is gone"


def test_a_long_recording_is_held_in_part_and_headings_are_those_of_the_compass(folder):
    recording = Recording(folder, read_record(folder / "record.nc"), np.zeros((5000, 2, 8), np.float32), np.zeros(5000))
    assert recording.held == MAX_PINGS
    compass = {0.0: 90.0, 90.0: 0.0, -45.0: 135.0, 180.0: 270.0, 113.3: 336.7}
    assert {own: compass_heading(own) for own in compass} == pytest.approx(compass)


@pytest.mark.skipif(not REAL.exists(), reason="needs the recording of a real sonar")
def test_a_recording_of_a_real_sonar_is_shown_with_its_navigation(viewer, qtbot):
    recording = open_recording(viewer, REAL, qtbot)
    assert (recording.pings, recording.bins) == (461, 1024)
    told = describe_point(recording, Mark(460, 0, 1023))
    navigation = {"position": "48.44586° N, 68.82834° W", "heading": "336.7°", "altitude": "2.68 m"}
    assert (navigation | {"slant range": "29.97 m, port"}).items() <= told.items()
    assert told["time"].startswith("2013-09-10 21:14:00")
    rows = viewer.panels["comparison"].view.statistics.rows
    assert rows["shadows"][0] == "24.5 dB deep"
    assert len(np.unique(picture_of(viewer.window.record_a))) > 100


def test_a_scene_is_learned_unless_that_is_stopped_or_has_too_little_bed(viewer, folder, tmp_path, qtbot, monkeypatch):
    named, path = tmp_path / "learned.toml", tmp_path / "short.nc"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(named), ""))
    panel, scene = viewer.panels["comparison"].view, viewer.session.scene
    # A record with too little bed says so, and why it cannot be learned.
    assert main(["render", "default", "--set", "track.pings=20", "--set", "sonar.bins=60", "-o", str(path)]) == 0
    open_recording(viewer, path, qtbot)
    assert "too little bed" in panel.statistics.said
    QTest.mouseClick(panel.learn, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: viewer.complete, timeout=240000)
    assert "pings" in viewer.window.status.sentence.text()
    # One that is stopped leaves nothing.
    recording = open_recording(viewer, folder / "record.nc", qtbot)
    QTest.mouseClick(panel.learn, Qt.MouseButton.LeftButton)
    viewer.window.open_panel("jobs")
    QTest.mouseClick(viewer.panels["jobs"].view.rows[-1].stop, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not viewer.jobs.running)
    assert viewer.jobs.jobs[-1].state is State.STOPPED
    assert panel.learn.isEnabled()
    assert viewer.session.scene is scene
    assert list(tmp_path.iterdir()) == [path]
    QTest.mouseClick(panel.learn, Qt.MouseButton.LeftButton)
    assert not panel.learn.isEnabled()
    assert viewer.window.record_a.waiting.what.startswith("learning a scene like ")
    job = viewer.jobs.jobs[-1]
    assert (job.title, job.arguments[0]) == ("scene like record.nc", "learn")
    qtbot.waitUntil(lambda: job.seconds_left is not None, timeout=240000)
    assert viewer.window.jobs.isVisible()
    assert viewer.window.record_a.waiting.share == job.stage.share
    qtbot.waitUntil(lambda: viewer.complete, timeout=240000)
    assert job.state is State.DONE
    assert viewer.session.scene == load_scene(named)
    assert viewer.session.scene.title.startswith("Learned from")
    assert not viewer.session.unsaved
    assert job.sentence.startswith(f"{named}: its record ")
    assert viewer.window.status.sentence.text() == job.sentence
    assert panel.learn.isEnabled()
    assert viewer.recordings.recording is recording
