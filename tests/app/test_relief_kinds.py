"""Every kind of relief can be chosen from every other, and turned by its sliders."""

import pytest

from insonify.scene import Scene, edit, load_scene
from insonify.scene.base import kind_name, models_of
from insonify.scene.seabed import Seabed
from insonify.scene_edits import add_dependent_edits
from insonify_viewer.panels.parameters.sections import sections_of
from insonify_viewer.state.fields import NumberField

KINDS = [kind_name(model) for model in models_of(Seabed, "relief") if kind_name(model) != "dem"]


def changed(scene, **changes) -> Scene:
    named = {f"seabed.relief.{name.replace('__', '.')}": value for name, value in changes.items()}
    return edit(scene, add_dependent_edits(scene, named)[0])


def shown(scene) -> dict:
    """Parameters of the relief by their path beneath it."""
    seabed = next(section for section in sections_of(scene) if section.key == "seabed")
    prefix = "seabed.relief."
    return {p.path.removeprefix(prefix): p for p in seabed.parameters if p.path.startswith(prefix)}


@pytest.fixture
def scene():
    return load_scene("default")


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in ("flat", "mimic")])
def test_every_slider_of_a_kind_may_be_pushed_to_either_end(scene, kind):
    chosen = changed(scene, kind=kind)
    sliders = {path: p for path, p in shown(chosen).items() if isinstance(p, NumberField) and p.slider is not None}
    assert sliders
    for path, number in sliders.items():
        for end in number.slider:
            if "peaks" not in path:
                changed(chosen, **{path.replace(".", "__"): end})


def test_what_all_relief_has_comes_last(scene):
    names = list(shown(changed(scene, kind="ripples")))
    assert names[:2] == ["kind", "wavelength"]
    assert names[-3:] == ["period", "extent", "mask.kind"]


def test_period_of_endless_ripples_is_not_asked_for(scene):
    ripples = changed(scene, kind="ripples")
    assert "period" not in shown(changed(ripples, extent="endless"))
    assert "period" in shown(changed(changed(scene, kind="power_law"), extent="endless"))


def test_mask_brings_its_sliders(scene):
    masked = changed(changed(scene, kind="ripples"), mask__kind="patches")
    assert {"mask.share", "mask.size", "mask.softness"} <= set(shown(masked))


def test_parts_of_a_sum_keep_one_period_and_their_headings(scene):
    both = changed(scene, kind="sum")
    assert [part.kind for part in both.seabed.relief.of] == ["fractal", "ripples"]
    assert both.seabed.relief.of[0] == scene.seabed.relief
    longer = changed(both, of__1__period=204.8)
    assert [part.period for part in longer.seabed.relief.of] == [204.8, 204.8]
    assert "of.1.heading" in shown(both)
