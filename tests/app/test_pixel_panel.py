"""A pixel is clicked and explained; a place in three dimensions is clicked and its pixels light up."""

from dataclasses import replace

import numpy as np
import pytest
import pyvista as pv
from controls import colours_of, finish
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest

from insonify.explanation import compilation
from insonify.explanation.pixel import find_bin_errors
from insonify.scene import edit, load_scene
from insonify_viewer.panels.pixel.view import BED as GROUND
from insonify_viewer.panels.pixel.view import BLOCKED, HEARD, HIDDEN, WATER, heights_shown
from insonify_viewer.state.inspection import Mark
from insonify_viewer.state.quantities import format_share
from insonify_viewer.widgets.theme import ACCENT, MARK, Theme, apply_theme

PIPE = Mark(40, 1, 624)  # echo of the pipe, 31.2 m from the sonar
SHADOW = Mark(40, 1, 660)
BED = Mark(40, 1, 500)


@pytest.fixture
def viewer(open_viewer):
    return open_viewer(edit(load_scene("pipe-on-bed"), {"track.pings": 64, "sonar.bins": 1000}), prepare=None)


def click(viewer, mark: Mark, qtbot):
    """Click a pixel, and wait until it is explained: cold kernels take long to compile."""
    waterfall = viewer.window.waterfall
    QTest.mouseClick(waterfall, Qt.MouseButton.LeftButton, pos=waterfall.place_of(mark))
    qtbot.waitUntil(lambda: viewer.panels["pixel"].complete, timeout=240000)


def is_like(colour: QColor, name: str) -> bool:
    """Whether a colour is another one as far as a screen of 16 bits tells."""
    other = QColor(name)
    pairs = zip(colour.getRgb()[:3], other.getRgb()[:3])
    return all(abs(one - two) <= 12 for one, two in pairs)


def budget(viewer) -> dict[str, str]:
    return {name: level for name, level, _ in rows_of(viewer.panels["pixel"].view.budget)}


def rows_of(budget) -> list[tuple[str, str, str]]:
    return [row[:3] for head, rows in budget.groups for row in (head, *rows)]


def decibels(text: str) -> float:
    return float(text.removesuffix(" dB").replace("−", "-"))


def test_a_click_alone_pins_a_pixel_whose_terms_add_up_and_explains_a_shadow(viewer, qtbot):
    view = viewer.panels["pixel"].view
    assert not view.isVisible()
    assert "Click a pixel" in view.sentence.text()
    # A drag over the record and a click on the trace pin nothing.
    waterfall = viewer.window.waterfall
    place = waterfall.place_of(BED)
    QTest.mousePress(waterfall, Qt.MouseButton.LeftButton, pos=place)
    QTest.mouseRelease(waterfall, Qt.MouseButton.LeftButton, pos=place + QPoint(20, 0))
    assert viewer.inspection.mark is None
    # The echo trace is aligned with the record, which has its room without it.
    area = waterfall.trace_area()
    assert (area.left(), area.width()) == (waterfall.plot_area.left(), waterfall.plot_area.width())
    row = waterfall.record.amplitude[waterfall.record.rows(np.array([40]))[0]]
    loudest = int(np.argmax(waterfall.projection.loudest(row, 40, area.width())))
    assert abs(area.left() + loudest - waterfall.place_of(PIPE).x()) <= 3
    before = waterfall.plot_area.height()
    viewer.window.trace.trigger()
    assert waterfall.trace_area() is None
    assert waterfall.plot_area.height() >= before
    QTest.mouseClick(waterfall, Qt.MouseButton.LeftButton, pos=waterfall.trace_caption().center())
    assert waterfall.plot_area.height() == before
    QTest.mouseClick(waterfall, Qt.MouseButton.LeftButton, pos=waterfall.trace_caption().center())
    assert waterfall.trace_area() is None
    assert viewer.inspection.mark is None, "a click on the caption pins nothing"
    # A click pins a pixel whose terms add up.
    click(viewer, BED, qtbot)
    mark = viewer.inspection.mark
    assert abs(mark.bin - BED.bin) <= 3
    assert view.isVisible()
    assert "the sound meets medium sand at" in view.sentence.text()
    rows = budget(viewer)
    total = decibels(rows.pop("pixel"))
    terms = [decibels(level) for level in rows.values() if level.endswith("dB")]
    assert len(terms) == 7
    assert sum(terms) == pytest.approx(total, abs=0.05)
    assert rows["bed, medium sand"] == "100.0 %"
    recorded = viewer.answer.simulation.intensity(np.array([mark.ping]))[0, mark.side, mark.bin]
    assert total == pytest.approx(10.0 * np.log10(recorded), abs=0.01)
    # Its error is the one that is shown under the mouse.
    errors = find_bin_errors(viewer.answer.simulation, np.array([mark.ping]))
    assert rows["of this bin"] == format_share(errors[0, mark.side, mark.bin])
    waterfall.hovered.emit(mark)
    shown = viewer.panels["error"].widget
    qtbot.waitUntil(lambda: f"pixel {rows['of this bin']}, this ping" in shown.text())
    # A shadow is explained and drawn.
    sentence = view.sentence
    click(viewer, SHADOW, qtbot)
    assert sentence.text() == "Dark because the bed here lies in the shadow of pipe 1."
    assert "in the shadow of pipe 1" in view.summary.text()
    assert budget(viewer)["pipe 1"] == "100.0 %"
    assert budget(viewer)["pixel"] == "no echo"
    shown = {name: bool(actor.visibility) for name, actor in viewer.seabed.view.sound.actors.items()}
    assert shown == {"rays": False, "blocked": True, "echoing": False, "hidden": True}
    click(viewer, PIPE, qtbot)
    assert "right because the sound meets the steel of pipe 1 at" in sentence.text()
    assert "pipe 1" in view.summary.text()
    actors = viewer.seabed.view.sound.actors
    assert actors["rays"].visibility
    assert actors["echoing"].visibility
    rays = pv.wrap(actors["rays"].mapper.GetInput())
    ends = np.asarray(rays.points)[1::2]
    np.testing.assert_allclose(ends[:, 1], -29.8, atol=0.4)  # on the side of the pipe that faces the sonar


def project(viewer, place: tuple[float, float, float]) -> tuple[float, float]:
    """Pixel of the 3-D view, from its lower left corner, at which a place is drawn."""
    renderer = viewer.seabed.view.canvas.plotter.renderer
    viewer.seabed.draw_now()
    renderer.SetWorldPoint(*place, 1.0)
    renderer.WorldToDisplay()
    x, y, _ = renderer.GetDisplayPoint()
    return x, y


def test_the_pinned_pixel_is_ringed_cut_across_and_let_go_of_and_a_click_in_three_dimensions_lights_up(viewer, qtbot):
    waterfall, readout = viewer.window.waterfall, viewer.panels["readout"].widget
    click(viewer, SHADOW, qtbot)
    place = waterfall.place_of(viewer.inspection.mark)
    image = waterfall.grab().toImage()
    assert is_like(image.pixelColor(place + QPoint(7, 0)), MARK)
    section = viewer.panels["pixel"].view.section
    section.draw_now()
    seen = [QColor.fromRgb(int(colour)) for colour in np.unique(colours_of(section.grab().toImage()))]
    for name in (WATER, GROUND, HEARD, HIDDEN, BLOCKED):
        assert any(is_like(colour, name) for colour in seen), name
    # So is that of a fish below the bed, as of one that is towed at a depth beside a slope.
    explanation, cut = section.shown
    for raised in (50.0, 1e12):
        section.show_section(explanation, replace(cut, bed=np.add(cut.bed, [0.0, raised])))
        section.draw_now()
        low, high = heights_shown(section.shown[1], surfaced=False)
        assert low < float(cut.sonar.place[2]) < high
        section.grab()  # an exception would fail the test
    QTest.mouseClick(waterfall, Qt.MouseButton.LeftButton, pos=place)
    assert viewer.inspection.mark is None
    assert not any(actor.visibility for actor in viewer.seabed.view.sound.actors.values())
    assert rows_of(viewer.panels["pixel"].view.budget) == []
    # The readout tells the truth of the core.
    labels = viewer.answer.simulation.truth(np.array([40]))
    for words, found in (("pipe 1", labels.target_id == 0), ("shadow of pipe 1", labels.shadow > 0.9)):
        _, side, range_bin = np.argwhere(found)[0]
        waterfall.hovered.emit(Mark(40, int(side), int(range_bin)))
        qtbot.waitUntil(lambda words=words: words in readout.text())
    # A click in three dimensions lights up its pixels.
    picked, lit = [], []
    viewer.inspection.picked.connect(picked.append)
    viewer.inspection.lit.connect(lit.append)
    for place in ((6.0, 12.0, 0.0), (9.0, -29.7, 0.9)):
        lit.clear()
        viewer.seabed.view.look_at(*project(viewer, place))
        np.testing.assert_allclose(picked[-1], place, atol=0.3)
        qtbot.waitUntil(lambda: len(lit) > 1, timeout=240000)
        assert {mark.ping for mark in lit[-1]} >= {round(picked[-1][0] / 0.2)}
        away = np.linalg.norm(np.array(picked[-1][1:]) - [0.0, 10.0])
        assert all(abs((mark.bin + 0.5) * 0.05 - away) < 0.15 for mark in lit[-1])
        assert "from this place" in viewer.window.status.sentence.text()
    viewer.inspection.pick((6.0, -31.0, 0.0))
    qtbot.waitUntil(lambda: "no pixel" in viewer.window.status.sentence.text(), timeout=240000)
    # An edit explains the pinned pixel anew, and another scene lets go of it.
    click(viewer, SHADOW, qtbot)
    viewer.session.settle({"targets": []})
    view = viewer.panels["pixel"].view
    qtbot.waitUntil(lambda: viewer.complete and "bed, medium sand" in view.summary.text())
    assert "pipe 1" not in budget(viewer)
    assert viewer.inspection.mark is not None
    finish(viewer, qtbot, viewer.open, edit(viewer.session.scene, {"sonar.bins": 500}))
    assert viewer.inspection.mark is None


def test_rays_and_budget_share_their_room_and_a_small_window_stays_usable_and_elides_nothing(viewer, qtbot, qapp):
    window = viewer.window
    for name, other in (("pixel", "water"), ("water", "pixel"), ("pixel", "water")):
        window.open_panel(name)
        shown, behind = (viewer.panels[each].view for each in (name, other))
        qtbot.waitUntil(lambda shown=shown: shown.visibleRegion().boundingRect().height() > 100)
        assert shown.mapTo(window, shown.rect().center()).y() > window.height() // 2
        assert behind.visibleRegion().isEmpty()
    # A small window stays usable.
    viewer.window.resize(880, 600)
    click(viewer, BED, qtbot)
    qtbot.waitUntil(lambda: viewer.window.width() == 880)
    assert viewer.window.size().height() == 600
    view, waterfall = viewer.panels["pixel"].view, viewer.window.waterfall
    assert view.section.width() >= 160
    assert view.budget.height() >= 80
    assert waterfall.plot_area.height() >= 120
    assert viewer.seabed.view.height() >= 140
    # A narrow budget elides nothing, and takes the theme.
    viewer.window.resize(900, 540)
    viewer.window.open_panel("lessons")
    budget = viewer.panels["pixel"].view.budget
    qtbot.waitUntil(lambda: budget.document().size().width() <= budget.viewport().width())
    assert not budget.horizontalScrollBar().isVisible()
    shown = " ".join(budget.toPlainText().split())
    for row in rows_of(budget):
        for part in row:
            assert part in shown
    assert "█" in shown, "the greatest term has the longest bar"
    try:
        for theme in (Theme.LIGHT, Theme.DARK):
            apply_theme(qapp, theme)
            assert f"color:{ACCENT.name()}" in budget.toHtml()
    finally:
        apply_theme(qapp)


def test_kernels_of_the_first_click_are_compiled_once_for_a_set_of_effects(open_viewer, small, qtbot, monkeypatch):
    compiled = []
    monkeypatch.setattr(compilation, "compile_explanations", lambda simulation: compiled.append(simulation.scene))
    viewer = open_viewer(small)
    qtbot.waitUntil(lambda: compiled == [small])
    assert viewer.inspection.mark is None, "before anything is clicked"
    assert viewer.session.settle({"track.altitude": 8.0})
    qtbot.waitUntil(lambda: viewer.complete)
    qtbot.wait(100)
    assert compiled == [small], "the same effects need the same kernels"
    assert viewer.session.settle({"water": {"surface": "flat"}})
    qtbot.waitUntil(lambda: len(compiled) == 2)
