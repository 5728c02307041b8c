"""A new scene is put together from a bed, a sonar, a track and targets."""

import pytest

from insonify import simulate
from insonify.files import bundled_sonars
from insonify.scene import bundled_meshes, edit
from insonify_viewer.window.new_scene import BEDS, NewScene, compose_scene


@pytest.mark.parametrize(("bed", "sonar"), list(zip(BEDS.values(), [*bundled_sonars()][::2], strict=True)))
def test_every_bed_and_sonar_make_a_record_with_its_targets(bed, sonar):
    meshes = list(bundled_meshes())[:3]
    scene = compose_scene(bed, sonar, 60.0, 8.0, 24, meshes)
    assert [target.path for target in scene.targets] == meshes
    assert scene.track.altitude == 8.0
    assert scene.sonar.preset == sonar
    record = simulate(edit(scene, {"sonar.bins": 128, "track.pings": 4}), forced={"planes": "1"})
    assert (record.intensity.values > 0.0).any()


def test_the_dialog_opens_its_scene_without_a_file(viewer, qtbot, monkeypatch):
    def answer(dialog: NewScene) -> bool:
        dialog.beds.setCurrentRow(3)
        dialog.sonar.setCurrentIndex(dialog.sonar.findData("kayak-800"))
        assert dialog.altitude.value() == pytest.approx(2.5)
        dialog.pings.setValue(100)
        for row in (0, 2):
            dialog.targets.item(row).setSelected(True)
        return True

    monkeypatch.setattr(NewScene, "exec", answer)
    viewer.window.new_scene.trigger()
    scene = viewer.session.scene
    assert (scene.title, viewer.session.file, scene.track.pings) == ("Untitled", "", 100)
    names = list(bundled_meshes())
    assert [target.path for target in scene.targets] == [names[0], names[2]]
    (x, y), (further, across) = (target.position for target in scene.targets)
    assert (x < further, y * across < 0.0) == (True, True)
