"""Presets of sonars: every one simulates, fields beside it override it, and an edit replaces one by another."""

import numpy as np
import pytest

from insonify.files import bundled_sonars
from insonify.scene import SceneError, edit, load_scene, scene_from_toml, scene_to_toml
from insonify.scene.sonar.presets import read_preset
from insonify.simulation import prepare

BED = "[seabed]\ndepth = 60.0\nrelief = 'flat'\nspacing = 0.5\n[track]\naltitude = 10.0\n"


@pytest.mark.parametrize("name", bundled_sonars())
def test_a_preset_makes_a_record(name):
    scene = scene_from_toml(f"sonar = '{name}'\n{BED}")
    declared = read_preset(name)
    assert declared["title"]
    assert declared["source"]
    assert scene.sonar.frequency == declared["sonar"]["frequency"]
    assert scene.receiver.source_level == declared["receiver"]["source_level"]
    assert scene_from_toml(scene_to_toml(scene)) == scene
    record = prepare(scene, forced={"planes": "4"}).intensity(np.arange(1))
    assert np.isfinite(record).all()
    assert record.max() > 0.0


def test_there_is_one_from_kayak_to_deep_tow():
    frequencies = {read_preset(name)["sonar"]["frequency"] for name in bundled_sonars()}
    assert len(bundled_sonars()) >= 12
    assert {100e3, 400e3, 455e3, 500e3, 600e3, 800e3, 900e3, 1.6e6} <= frequencies


def test_fields_beside_a_preset_override_it():
    table = "sonar = { preset = 'towfish-400', range = 75.0, beam = { width = 0.8 }, pulse = 'ideal' }\n"
    scene = scene_from_toml(f"{table}{BED}[receiver]\nsource_level = 200.0\n")
    assert (scene.sonar.range, scene.sonar.beam.kind, scene.sonar.beam.width) == (75.0, "gaussian", 0.8)
    assert (scene.sonar.pulse.kind, scene.sonar.frequency) == ("ideal", 400e3)
    assert (scene.receiver.source_level, scene.receiver.recorder.bits) == (200.0, 16)
    assert scene.sonar.ping_rate == pytest.approx(700.0 / 75.0, abs=1e-3)


def test_an_edit_replaces_one_sonar_by_another():
    scene = scene_from_toml(f"sonar = 'towfish-400'\n{BED}")
    for path in ("sonar", "sonar.preset"):
        other = edit(scene, {path: "kayak-800"})
        assert other == scene_from_toml(f"sonar = 'kayak-800'\n{BED}")
    assert edit(scene, {"sonar.preset": "kayak-800", "sonar.range": 20.0}).sonar.range == 20.0
    assert edit(scene, {"sonar.range": 80.0}).sonar.preset == "towfish-400"


def test_without_a_preset_its_numbers_stay():
    scene = scene_from_toml(f"sonar = 'towfish-400'\n{BED}")
    own = edit(scene, {"sonar.preset": "none"})
    assert own.sonar == scene.sonar.model_copy(update={"preset": None})
    assert scene_from_toml(f"sonar = 'none'\n{BED}") == scene_from_toml(BED)


def test_an_unknown_preset_is_refused():
    with pytest.raises(SceneError, match=r"sonar\.preset: 'sputnik' is not a known sonar; choose one of auv-230"):
        edit(load_scene("default"), {"sonar": "sputnik"})
