"""Families of declarations: a kind is found by being declared, wherever that is."""

from __future__ import annotations

from typing import Literal

import pytest

from insonify.scene import Scene, SceneError, edit, load_scene, scene_to_toml
from insonify.scene.base import parameter
from insonify.scene.kinds import models_of
from insonify.scene.targets import TARGETS, Posed


def test_a_kind_that_is_declared_late_is_a_kind_like_others_and_can_be_forgotten() -> None:
    scene = load_scene("targets")
    before = models_of(Scene, "targets")
    with TARGETS.without("egg"):

        class Egg(Posed):
            """An egg."""

            kind: Literal["egg"] = "egg"
            width: float = parameter(1.0, unit="m", description="widest", gt=0.0)

        assert models_of(Scene, "targets") == (*before, Egg)
        changed = edit(scene, {"targets.0.kind": "egg", "targets.0.width": 2.0})
        assert changed.targets[0].position == scene.targets[0].position
        assert 'kind = "egg"' in scene_to_toml(changed)
        with pytest.raises(SceneError, match=r"targets\.0\.width: -1\.0 is out of bounds"):
            edit(scene, {"targets.0.kind": "egg", "targets.0.width": -1.0})
    assert models_of(Scene, "targets") == before
    with pytest.raises(SceneError, match="'egg' is not a kind known here"):
        edit(scene, {"targets.0.kind": "egg"})
