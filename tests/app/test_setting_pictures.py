"""Pictures below the rows of beam, pulse and bed: they follow the scene, and a peak is dragged in one undo step."""

import threading
from typing import Any

import pytest
from PySide6.QtCore import QPoint, Qt

from insonify.display.scene_curves import beam_curve
from insonify.scene import edit
from insonify_viewer.panels.parameters.view import setting_pictures as registry
from insonify_viewer.panels.parameters.view.setting_pictures import CurvesPicture, SpectrumPicture


@pytest.fixture
def peaked(small):
    return edit(small, {"seabed.relief": {"kind": "fractal", "peaks": [[8.0, 20.0], [0.0, 0.0]], "rms": 0.05}})


def pictures_in(viewer, kind: type) -> list[Any]:
    """Find the pictures of a kind in the parameters panel."""
    return viewer.panels["parameters"].widget.findChildren(kind)


def into_view(viewer, picture):
    viewer.panels["parameters"].widget.ensureWidgetVisible(picture, 0, 0)


def test_a_peak_is_dragged_in_one_step(open_viewer, peaked, qtbot):
    viewer = open_viewer(peaked)
    picture = pictures_in(viewer, SpectrumPicture)[0]
    into_view(viewer, picture)
    reach = picture.spectrum.reach
    start = picture.place_of((8.0, 20.0)).toPoint()
    step = picture.area.width() / (2.0 * reach)
    end = start + QPoint(round(-16.0 * step), 0)
    qtbot.mousePress(picture, Qt.MouseButton.LeftButton, pos=start)
    qtbot.mouseMove(picture, start + QPoint(round(-8.0 * step), 0))
    qtbot.mouseMove(picture, end)
    qtbot.mouseRelease(picture, Qt.MouseButton.LeftButton, pos=end)
    moved, still = viewer.session.scene.seabed.relief.peaks
    assert moved == pytest.approx((-8.0, 20.0), abs=1.0)
    assert moved == tuple(float(round(wave)) for wave in moved)
    assert still == (0.0, 0.0)
    viewer.session.undo()
    assert viewer.session.scene.seabed.relief.peaks[0] == (8.0, 20.0)
    assert not viewer.session.undoable


def test_a_press_beside_the_peaks_moves_none(open_viewer, peaked, qtbot):
    viewer = open_viewer(peaked)
    picture = pictures_in(viewer, SpectrumPicture)[0]
    into_view(viewer, picture)
    away = picture.place_of((-20.0, -20.0)).toPoint()
    qtbot.mouseClick(picture, Qt.MouseButton.LeftButton, pos=away)
    assert viewer.session.scene == peaked


def test_curves_follow_the_scene(open_viewer, small, qtbot, monkeypatch):
    threads = set()

    def watched(scene):
        threads.add(threading.current_thread())
        return beam_curve(scene)

    monkeypatch.setattr(registry, "beam_curve", watched)
    viewer = open_viewer(small)
    picture = next(one for one in pictures_in(viewer, CurvesPicture) if watched in one._draws)
    into_view(viewer, picture)
    qtbot.waitUntil(lambda: bool(picture.curves))
    assert picture.curves[0].note.startswith("−3 dB: 1°")
    assert viewer.session.settle({"sonar.beam.width": 4.0})
    qtbot.waitUntil(lambda: picture.curves[0].note.startswith("−3 dB: 4°"))
    assert threading.main_thread() not in threads, "painting computes nothing"


def test_what_has_no_curve_takes_no_room(viewer):
    changes = {"sonar.beam": {"kind": "knife"}, "sonar.pulse": {"kind": "ideal"}, "seabed.material.diffuse": 0.2}
    assert viewer.session.settle(changes)
    assert not [one for one in pictures_in(viewer, CurvesPicture) if one.isVisible()]
