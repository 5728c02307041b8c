"""Families of declarations: a kind is found by being declared, wherever that is."""

from types import SimpleNamespace
from typing import Literal

import pytest

from insonify.scene import Scene, SceneError, base, edit, load_scene, scene_to_toml
from insonify.scene.base import Declaration, Family, models_of, parameter
from insonify.scene.seabed.materials import MATERIAL_MAPS, MaterialMap
from insonify.scene.targets import TARGETS, Posed, Target


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
    with pytest.raises(SceneError, match="'egg' is not a known kind"):
        edit(scene, {"targets.0.kind": "egg"})


def test_kinds_of_installed_packages_are_found_by_their_entry_points(monkeypatch: pytest.MonkeyPatch) -> None:
    family = Family("eggs")

    def load() -> None:
        class Quail(Declaration):
            """An egg of another package."""

            kind: Literal["quail"] = "quail"

        family.add(Quail)

    entries = {"insonify.eggs": [SimpleNamespace(load=load)]}
    monkeypatch.setattr(base, "announced", lambda group: entries[group])
    assert list(family.models(Declaration)) == ["quail"]


def test_kinds_stand_in_the_order_of_their_ranks_and_new_ones_last() -> None:
    # Kinds without a rank follow those with one, so that a new one needs no number.
    assert list(TARGETS.models(Target))[:5] == ["pipe", "sphere", "box", "cone", "mesh"]
    assert list(MATERIAL_MAPS.models(MaterialMap))[:5] == ["uniform", "patches", "fractal", "pattern", "image"]
