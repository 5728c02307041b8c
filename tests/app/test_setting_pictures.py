"""Pictures below the rows of beam, pulse and bed: they follow the scene, and a peak is dragged in one undo step."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from PySide6.QtCore import QPoint, Qt

from insonify.scene import Scene, edit
from insonify_viewer.viewer import Viewer
from insonify_viewer.views.setting_pictures.curves_picture import CurvesPicture
from insonify_viewer.views.setting_pictures.spectrum_picture import SpectrumPicture

Opener = Callable[..., Viewer]


@pytest.fixture
def peaked(small: Scene) -> Scene:
    return edit(small, {"seabed.relief": {"kind": "fractal", "peaks": [[8.0, 20.0], [0.0, 0.0]], "rms": 0.05}})


def picture_in(viewer: Viewer, kind: type, title: str = "") -> Any:
    """Find a picture in the parameters panel, by the title of its first curve if there are several."""
    found = viewer.panels["parameters"].widget.findChildren(kind)
    return next(one for one in found if not title or (one.curves and one.curves[0].title == title))


def into_view(viewer: Viewer, picture: Any) -> None:
    viewer.panels["parameters"].widget.ensureWidgetVisible(picture, 0, 0)


def test_a_peak_is_dragged_in_one_step(open_viewer: Opener, peaked: Scene, qtbot: Any) -> None:
    viewer = open_viewer(peaked)
    picture = picture_in(viewer, SpectrumPicture)
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
    assert not viewer.session.can_undo


def test_a_press_beside_the_peaks_moves_none(open_viewer: Opener, peaked: Scene, qtbot: Any) -> None:
    viewer = open_viewer(peaked)
    picture = picture_in(viewer, SpectrumPicture)
    into_view(viewer, picture)
    away = picture.place_of((-20.0, -20.0)).toPoint()
    qtbot.mouseClick(picture, Qt.MouseButton.LeftButton, pos=away)
    assert viewer.session.scene == peaked


def test_curves_follow_the_scene(open_viewer: Opener, small: Scene) -> None:
    viewer = open_viewer(small)
    before = picture_in(viewer, CurvesPicture, "Beam along the track, two way").curves[0].note
    assert viewer.session.settle({"sonar.beam.width": 4.0})
    after = picture_in(viewer, CurvesPicture, "Beam along the track, two way").curves[0].note
    assert before.startswith("−3 dB: 1°")
    assert after.startswith("−3 dB: 4°")


def test_what_has_no_curve_takes_no_room(open_viewer: Opener, small: Scene) -> None:
    viewer = open_viewer(small)
    assert viewer.session.settle({"sonar.beam": {"kind": "knife"}, "sonar.pulse": {"kind": "ideal"}})
    pictures = viewer.panels["parameters"].widget.findChildren(CurvesPicture)
    assert not [one for one in pictures if one.isVisible()]
