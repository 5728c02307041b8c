"""The record is shown by its display options; places of the plot lead to bins and back in every one of them."""

import math
from itertools import product

import numpy as np
import pytest
from controls import colours_of, drag, finish, picture_of, turn_wheel
from hypothesis import given, settings
from hypothesis import strategies as st
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from stand_in import StandIn

from insonify.display.display_options import DisplayOptions
from insonify.display.normalisation import LevelBed, normalise
from insonify.display.picture import choose_contrast, colour_rows
from insonify.display.range_axis import make_range_axis
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify_viewer.record.projection import Projection, Zoom, project_record, zoom_to_true_scale
from insonify_viewer.record.record import Record
from insonify_viewer.record.record_image import EMPTY, blur_along_track
from insonify_viewer.record.tone_map import make_tone_map
from insonify_viewer.record.waterfall_view import WaterfallView
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.painting import (
    HEADROOM,
    KNEE,
    colour_table,
    column_means,
    compress_highlights,
    round_steps,
    with_highlights,
)
from insonify_viewer.work.ping_request import PingRequest
from insonify_viewer.work.simulator import Simulator

PINGS, BINS, RANGE = 40, 200, 50.0
KINDS = ("slant", "bed", "ground")
SIDES = ("both", "port", "starboard")


@pytest.fixture
def record():
    """A record whose altitude changes from ping to ping, with one loud bin a side behind the first echo."""
    record, pings = Record(PINGS, BINS), np.arange(PINGS)
    altitude = 9.0 + 3.0 * np.sin(pings)
    amplitude = np.zeros((PINGS, 2, BINS), np.float32)
    amplitude[pings, :, (altitude / (RANGE / BINS)).astype(int) + 20] = 5.0
    record.put(pings, amplitude, 0, altitude)
    return record


def project(record: Record, kind: str, look: DisplayOptions, zoom: Zoom = Zoom()) -> Projection:  # noqa: B008
    axis = make_range_axis(kind, BINS, RANGE / BINS, record.lowest)
    assert axis is not None
    return project_record(look, record, axis, zoom, PINGS - 1)


@given(
    kind=st.sampled_from(KINDS),
    side=st.sampled_from(SIDES),
    newest_on_top=st.booleans(),
    centre=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
    factor=st.floats(1.0, 30.0),
    ping=st.integers(0, PINGS - 1),
    bin_=st.integers(0, BINS - 1),
    channel=st.integers(0, 1),
)
@settings(max_examples=400, deadline=None)
def test_a_bin_leads_to_its_place_and_back(kind, side, newest_on_top, centre, factor, ping, bin_, channel):
    record, pings = Record(PINGS, BINS), np.arange(PINGS)
    record.put(pings, np.zeros((PINGS, 2, BINS), np.float32), 0, 9.0 + 3.0 * np.sin(pings))
    look = DisplayOptions(side=side, newest_on_top=newest_on_top)
    projection = project(record, kind, look, Zoom().about(*centre, factor))
    u, v = projection.place_of(Mark(ping, channel, bin_))
    if 0.0 <= u < 1.0 and 0.0 <= v < 1.0:
        assert projection.mark_at(u, v) == Mark(ping, channel, bin_)
    elif projection.zoom.whole and side in ("both", SIDES[1 + channel]):
        altitude = float(record.altitude_of(np.array([ping]))[0])
        assert kind != "slant"
        assert (bin_ + 0.5) * RANGE / BINS < altitude, "only the water column may be left out"


@pytest.mark.parametrize(("kind", "side", "zoomed"), list(product(KINDS, SIDES, (False, True))))
def test_what_is_drawn_stands_where_it_is_read(record, kind, side, zoomed):
    zoom = Zoom().about(0.4, 0.5, 2.0) if zoomed else Zoom()
    projection = project(record, kind, DisplayOptions(side=side), zoom)
    columns = projection.columns(record.amplitude, record.altitude, 700)
    for row in range(PINGS):
        ping = int(record.ping[row])
        v = float(projection.down(np.array(ping - 0.5)))
        loud = np.flatnonzero(columns[row] > 2.5)
        assert loud.size or zoomed
        if 0.0 < v < 1.0:
            for column in loud:
                mark = projection.mark_at((column + 0.5) / 700.0, v)
                assert mark is not None
                assert record.amplitude_at(ping, mark.side, mark.bin) == 5.0
            assert (projection.loudest(record.amplitude[row], ping, 700)[loud] == 5.0).all()


def test_a_ground_range_is_that_of_a_level_bed(record):
    projection = project(record, "ground", DisplayOptions())
    for ping, bin_ in ((3, 100), (17, 199)):
        slant, altitude = (bin_ + 0.5) * RANGE / BINS, float(record.altitude_of(np.array([ping]))[0])
        u, _ = projection.place_of(Mark(ping, 1, bin_))
        first, last = projection.shown
        assert first + u * (last - first) == pytest.approx(np.sqrt(slant**2 - altitude**2))


def test_a_zoom_keeps_its_place_within_the_picture_and_one_to_true_scale_shows_the_newest_part_of_a_long_track():
    for newest_on_top, shown in ((True, Zoom(lower=pytest.approx(0.2))), (False, Zoom(upper=pytest.approx(0.8)))):
        assert zoom_to_true_scale(Zoom(), (400, 800), 100.0, 1000.0, newest_on_top=newest_on_top) == shown
    # On a short track, less of the range.
    cut = zoom_to_true_scale(Zoom(), (400, 800), 100.0, 100.0, newest_on_top=True)
    assert cut == Zoom(left=pytest.approx(0.25), right=pytest.approx(0.75))
    zoom = Zoom().about(0.25, 0.75, 4.0)
    assert zoom.left + 0.25 * (zoom.right - zoom.left) == pytest.approx(0.25)
    assert zoom.upper + 0.75 * (zoom.lower - zoom.upper) == pytest.approx(0.75)
    assert zoom.moved(-9.0, 9.0) == Zoom(0.0, pytest.approx(0.25), pytest.approx(0.75), pytest.approx(1.0))
    assert zoom.about(0.5, 0.5, 0.01).whole
    for place in np.linspace(0.0, 1.0, 101):
        moved = Zoom().about(place, 0.5, 1.2).moved(0.1 * place, 0.0)
        assert moved.about(place / 3.0, 0.5, 1.0 / 1.2).whole


def test_colours_linear_in_decibels_and_reversed():
    amplitude = np.array([0.01, 0.1, 1.0], np.float32)
    tones = make_tone_map(DisplayOptions(decibels=True, levels=(0.01, 1.0)), (0.0, 9.0)).tones(amplitude)
    np.testing.assert_allclose(tones, [0.0, 0.5, 1.0], atol=1e-6)
    brighter = make_tone_map(DisplayOptions(decibels=True, levels=(0.01, 1.0), gain=20.0), (0.0, 9.0))
    np.testing.assert_allclose(brighter.tones(amplitude), [0.5, 1.0, 1.0], atol=1e-6)
    looks = (DisplayOptions(palette="grey", reverse=reverse, levels=(0.0, 1.0)) for reverse in (False, True))
    ends = np.array([0.0, 100.0], np.float32)
    plain, turned = (make_tone_map(look, (0.0, 9.0)).colours(ends) for look in looks)
    assert (plain == turned[::-1]).all()
    assert colour_table(np.zeros((256, 3), np.uint8))[0] == 0xFF000000


@pytest.mark.parametrize(
    "options", [{}, {"ground_range": True}, {"side": "port", "side_gains": (3.0, -3.0)}, {"decibels": True}]
)
def test_rows_drawn_beside_the_window_are_those_that_it_draws_and_others_are_left(qtbot, record, options):
    view, pings, rng = WaterfallView(), np.arange(PINGS), np.random.default_rng(3)
    qtbot.addWidget(view)
    view.resize(400, 400)
    view.show_record(record, RANGE, 0.1)
    view.show_top(PINGS - 1)
    view.show_display(DisplayOptions(**options))
    amplitude, reach = rng.rayleigh(1.0, (PINGS, 2, BINS)).astype(np.float32), np.linspace(0.5, 6.0, BINS)
    altitude = record.altitude_of(pings)
    drawn = view.draw_rows(amplitude, altitude, reach)
    rows = record.put(pings, amplitude, 1, altitude)
    view.show_rows(rows, reach)
    expected = view.image.pixels.copy()
    view.show_rows(rows, None)
    assert (view.image.pixels != expected).any()
    view.show_rows(rows, None, drawn=drawn)
    np.testing.assert_array_equal(view.image.pixels, expected)
    for change in (lambda: view.show_zoom(Zoom().about(0.5, 0.5, 2.0)), lambda: view.show_levels((0.2, 0.7))):
        change()
        view.show_rows(rows, reach)
        expected = view.image.pixels.copy()
        view.show_rows(rows, reach, drawn=drawn)
        np.testing.assert_array_equal(view.image.pixels, expected)
    assert view.draw_rows(amplitude[..., 1:], altitude, None) is None, "of a record of other bins"


# In the window


@pytest.fixture
def viewer(open_viewer, small):
    return open_viewer(edit(small, {"sonar.bins": 400, "track.pings": 256}))


def test_pointing_clicking_and_scrubbing_stay_right(viewer, qtbot):
    pinned, marked, usual, view = [], [], viewer.session.display._asdict(), viewer.window.waterfall
    viewer.inspection.pinned.connect(pinned.append)
    view.hovered.connect(marked.append)
    for options in (
        {},
        {"ground_range": True},
        {"water_column": False, "newest_on_top": False},
        {"side": "port", "scale": "true"},
        {"side": "starboard", "ground_range": True, "newest_on_top": False, "scale": "fill"},
    ):
        finish(viewer, qtbot, viewer.go_to, 255)
        viewer.session.show(**(usual | options))
        side = int(options.get("side") != "port")
        for mark in (Mark(240, side, 350), Mark(230, side, 120)):
            steps = product((-1, 0, 1), repeat=2)
            near = [Mark(mark.ping + pings, side, mark.bin + bins) for pings, bins in steps]

            def is_marked(mark=mark, near=near):
                place = view.place_of(mark)  # anew: the panel that a click opens shrinks the view once it has its text
                assert view.plot_area.contains(place)
                QTest.mouseMove(view, place + QPoint(0, 1))
                QTest.mouseMove(view, place)
                return bool(marked) and marked[-1] in near

            qtbot.waitUntil(is_marked)
            place = view.place_of(mark)
            wanted = view.mark_at(place)
            QTest.mouseClick(view, Qt.MouseButton.LeftButton, pos=place)  # which opens a panel: the view shrinks
            assert pinned[-1] == wanted
        handle = view.handle
        drag(view, handle.place_of(view.top).toPoint(), handle.place_of(100).toPoint())
        assert abs(view.top - 100) <= 1
        newest, older = (view.place_of(Mark(view.top - pings, side, 350)) for pings in (0, 10))
        assert (newest.y() < older.y()) == options.get("newest_on_top", True)


def test_the_wheel_zooms_a_drag_moves_the_record_and_the_picture_follows_the_options(viewer, qtbot):
    view = viewer.window.waterfall
    place = view.place_of(Mark(200, 1, 300))
    before = view.mark_at(place)
    turn_wheel(view, place, 4, Qt.KeyboardModifier.ControlModifier)
    assert view.projection.zoom.right - view.projection.zoom.left == pytest.approx(1.25**-4)
    found = view.mark_at(place)
    assert abs(found.bin - before.bin) <= 1
    assert abs(found.ping - before.ping) <= 1
    drag(view, place, place + QPoint(-40, 30))
    moved = view.mark_at(place + QPoint(-40, 30))
    assert abs(moved.bin - found.bin) <= 2
    assert abs(moved.ping - found.ping) <= 2
    turn_wheel(view, place, -9, Qt.KeyboardModifier.ControlModifier)
    assert view.projection.zoom.whole
    # A drag beyond the record looks back.
    top, middle = view.top, view.plot_area.center()
    pings = 100 * view.record.pings / view.plot_area.height()
    drag(view, middle, middle - QPoint(0, 100))
    assert view.top == pytest.approx(top - pings, abs=2)
    drag(view, middle, middle + QPoint(0, 50))
    assert view.top == pytest.approx(top - pings / 2, abs=3)
    # The picture follows the options.
    finish(viewer, qtbot, viewer.go_to, 255)
    upright = picture_of(view).copy()
    viewer.session.show(side="port")
    port = picture_of(view)
    assert view.projection.extent[1] == 0.0
    viewer.session.show(side="both", reverse=True)
    assert (picture_of(view) != upright).any()
    viewer.session.show(reverse=False)
    assert (picture_of(view) == upright).all()
    assert port.shape[0] == upright.shape[0]
    viewer.session.show(ground_range=True)
    assert (picture_of(view)[:, 0] == EMPTY).all() or view.projection.axis.kind == "ground"
    viewer.session.show(ground_range=False, side_gains=(0.0, 12.0))
    half = upright.shape[1] // 2
    assert (picture_of(view)[:, : half - 2] == upright[:, : half - 2]).all()
    assert (picture_of(view)[:, half + 60 :] != upright[:, half + 60 :]).mean() > 0.5
    # Newest below is the picture upside down.
    viewer.session.show(scale="fill")
    viewer.look_back(37)  # so that the ring begins in its middle
    plot = view.plot_area
    area = plot.adjusted(8, 8, -8, -8)
    upright = view.grab(area).toImage()
    viewer.session.show(newest_on_top=False)
    turned = view.grab(area).toImage().flipped(Qt.Orientation.Vertical)
    a, b = (colours_of(each).view(np.uint8).astype(int) for each in (upright, turned))
    assert np.abs(a - b).mean() < 2.0
    # Options reach a recording.
    viewer.session.show(newest_on_top=True, scale="fill", side_gains=(0.0, 0.0))
    viewer.session.show(palette="grey", gain=6.0, ground_range=True)
    assert viewer.window.waterfall.look == viewer.window.record_a.look == viewer.session.display


@pytest.mark.parametrize("width", [1, 7, 100, 101, 350])
def test_display_columns_drop_no_echo(width):
    amplitude = np.zeros((1, 100), np.float32)
    for column in range(100):
        amplitude[:] = 0.0
        amplitude[0, column] = 1.0
        assert column_means(amplitude, width).max() > 0.0
    assert column_means(np.ones((2, 100), np.float32), width).tolist() == [[1.0] * width] * 2


def test_highlights_are_told_apart_and_the_bed_keeps_its_tones():
    tones = np.linspace(0.0, KNEE, 50, dtype=np.float32)
    np.testing.assert_allclose(compress_highlights(tones), tones, atol=1e-6)
    targets = compress_highlights(np.array([1.0, 2.0, 5.0, 10.0, HEADROOM], np.float32))
    assert (np.diff(targets) > 0.03).all()
    assert targets[-1] == pytest.approx(1.0)
    table = with_highlights(colour_table(np.repeat(np.arange(256, dtype=np.uint8)[:, None], 3, axis=1)))
    painted = colour_rows(np.array([[-1.0, 0.0, 0.5, 2.0, 5.0, 99.0]], np.float32), 0.0, 1.0, table)
    grey = [int(word) & 0xFF for word in painted[0]]
    assert grey[:3] == [0, 0, 127]
    assert grey[2] < grey[3] < grey[4] < grey[5] == 255


def test_the_target_of_a_scene_is_not_saturated():
    scene = edit(load_scene("pipe-on-bed"), {"track.pings": 32})
    simulation, pings = prepare(scene), np.arange(32)
    amplitude = LevelBed(simulation).amplitudes(pings)
    labels = simulation.truth(pings)
    low, high = choose_contrast(amplitude)
    tones = compress_highlights((amplitude - np.float32(low)) / np.float32(high - low))
    assert (tones[(labels.target_id == 0) & (labels.path == 0)] > 0.999).mean() < 0.05


def test_ticks_are_round_and_few():
    steps = {
        (0.0, 50.0, 3): [0.0, 20.0, 40.0], (0.0, 1.0, 1): [0.0, 1.0], (0.0, 40.0, 5): [0.0, 10.0, 20.0, 30.0, 40.0],
        (1498.4, 1521.0, 3): [1500.0, 1510.0, 1520.0],
    }  # fmt: skip
    assert {given: round_steps(*given) for given in steps} == steps
    assert round_steps(0.0, 0.7, 3) == pytest.approx([0.0, 0.5])
    assert len(round_steps(0.0, 450.0, 8)) <= 9
    for ends in ((1.0, 1.0), (2.0, 1.0), (0.0, math.nan), (-math.inf, 0.0)):
        assert round_steps(*ends, 3) == [], "there are none of no range"


def test_energies_are_averaged_over_what_the_beam_takes_in():
    columns = np.random.default_rng(1).uniform(0.0, 3.0, (9, 12)).astype(np.float32)
    reach = np.array([0.2, 0.9, 1.0, 1.7, 2.0, 31.4])
    found = blur_along_track(columns, np.concatenate([reach[::-1], reach]))
    for ping in range(9):
        for column in range(12):
            pings = max(reach[5 - column if column < 6 else column - 6], 1.0)
            # The mean over so many pings about this one, by small steps; the ends go on.
            places = ping + 0.5 + pings * ((np.arange(20000) + 0.5) / 20000 - 0.5)
            energy = columns[np.clip(np.floor(places).astype(int), 0, 8), column].astype(float) ** 2
            assert found[ping, column] == pytest.approx(np.sqrt(energy.mean()), rel=1e-3), (ping, column)
    # Silence stays silent, and loudness what it is.
    columns = np.zeros((200, 4), np.float32)
    columns[:100] = 7.0
    found = blur_along_track(columns, np.full(4, 10.3))
    assert (found[110:] < 1e-2).all()
    assert found[:90] == pytest.approx(7.0, rel=1e-5)
    assert (blur_along_track(columns[:1], np.full(4, 10.3)) == columns[:1]).all()


@pytest.mark.parametrize("width", [1.0, 2.5])
def test_a_drag_looks_like_what_it_leads_to(width):
    scene = edit(load_scene("default"), {"sonar.beam.width": width, "sonar.bins": 250, "track.pings": 160})
    pings = np.arange(159, -1, -1)
    simulator = Simulator()
    simulator.cost = 0.0  # as if pings cost nothing, none to be thinned out
    (coarse,) = simulator.trace(PingRequest(0, scene, Modelling(), pings, fine=False))
    simulator.close()
    # Three planes, which the default tolerance admits, are themselves apart from the mean over the beam.
    simulation = prepare(scene, tolerance=0.005)
    fine = normalise(simulation.intensity(pings), LevelBed(simulation).curves(pings))
    wanted, plane = (np.concatenate([one[:, 0, ::-1], one[:, 1]], axis=1) for one in (fine, coarse.amplitude))
    assert coarse.reach is not None
    blurred = blur_along_track(plane, np.concatenate([coarse.reach[::-1], coarse.reach]))
    assert apart(blurred, wanted) < 0.5 * apart(plane, wanted)


def apart(record: np.ndarray, wanted: np.ndarray) -> float:
    """Difference of energies beyond 1.4 altitudes, of pings whose beams lie within the record."""
    energy, right = (one[25:-25, np.r_[0:180, 320:500]] ** 2 for one in (record, wanted))
    return float(np.linalg.norm(energy - right) / np.linalg.norm(right))


def test_what_is_random_or_has_no_width_is_not_smeared(small):
    simulator = Simulator(StandIn)
    changes = {"sonar.beam": "knife", "receiver.speckle": "rayleigh", "receiver.noise": "ambient"}
    changes["receiver.recorder.dropped_pings"] = 0.1
    scenes = [edit(small, {path: value}) for path, value in changes.items()]
    requests = [PingRequest(0, scene, Modelling(), np.arange(3), fine=False) for scene in scenes]
    answers = [list(simulator.trace(request)) for request in requests]
    simulator.close()
    assert [answer.reach for (answer,) in answers] == [None] * 4
