"""What an edit of a scene changes besides, so that the scene stays valid."""

from itertools import permutations

import pytest

from insonify.scene import Scene, edit, load_scene
from insonify.scene.base import kind_name, models_of
from insonify.scene.seabed import Seabed
from insonify.scene_edits import add_dependent_edits

KINDS = [kind_name(model) for model in models_of(Seabed, "relief") if kind_name(model) != "dem"]
ENDLESS = ["fractal", "power_law", "von_karman", "ripples", "autocorrelation", "sum"]


def changed(scene: Scene, **changes) -> Scene:
    named = {f"seabed.relief.{name.replace('__', '.')}": value for name, value in changes.items()}
    return edit(scene, add_dependent_edits(scene, named)[0])


@pytest.fixture
def scene() -> Scene:
    return load_scene("default")


@pytest.mark.parametrize(("first", "second"), list(permutations(KINDS, 2)))
def test_any_kind_follows_any_other(scene, first, second):
    assert changed(changed(scene, kind=first), kind=second).seabed.relief.kind == second


@pytest.mark.parametrize("first", ENDLESS)
@pytest.mark.parametrize("second", KINDS)
def test_any_kind_follows_an_endless_one(scene, first, second):
    before = changed(scene, kind=first)
    place = {"of__0__extent": "endless"} if first == "sum" else {"extent": "endless"}
    endless = changed(before, **place)
    assert endless.seabed.endless
    assert changed(endless, kind=second).seabed.relief.kind == second
