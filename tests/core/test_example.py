"""The record of the default scene that comes with the package."""

import numpy as np

from insonify.display import example
from insonify.display.normalisation import LevelBed
from insonify.scene import edit, load_scene
from insonify.simulation import prepare

TOLERANCE = 3e-6  # by which processors may differ
LARGEST = 2_000_000  # bytes


def test_the_example_is_the_record_of_the_default_scene_as_it_is_traced():
    scene = load_scene("default")
    shipped, pings = example.read_example(scene), np.arange(scene.track.pings)
    assert shipped is not None, "run python docs/make example"
    traced = LevelBed(prepare(scene)).amplitudes(pings)
    assert shipped.shape == traced.shape
    assert shipped.dtype == traced.dtype
    assert np.linalg.norm(shipped - traced, axis=(1, 2)).max() <= TOLERANCE * np.linalg.norm(traced, axis=(1, 2)).min()
    assert ((shipped == 0.0) == (traced == 0.0)).all()
    assert example.FILE.stat().st_size <= LARGEST


def test_the_example_stands_for_no_other_scene_or_version(monkeypatch):
    scene = load_scene("default")
    assert example.read_example(edit(scene, {"seed": scene.seed + 1})) is None
    monkeypatch.setattr(example, "version", lambda _: "0.0")
    assert example.read_example(scene) is None
