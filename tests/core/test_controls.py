"""What a scene says of its own controls: fields to pin, and links in its description."""

import pytest

from insonify.scene import Scene, bundled_scenes, edit, load_scene, plain
from insonify.scene.base import is_field
from insonify.scene.links import Link, plain_words, split_description


@pytest.mark.parametrize(
    "path", ["track.altitude", "seed", "sonar.beam.length", "targets.0.gap.3.1", "seabed.relief.of.1.mask.share"]
)
def test_paths_of_fields_of_any_kind(path: str) -> None:
    assert is_field(Scene, path)


@pytest.mark.parametrize("path", ["", "0", "track.altitud", "sonar.beam.widht", "targets.0.nothing", "track..altitude"])
def test_paths_that_lead_nowhere(path: str) -> None:
    assert not is_field(Scene, path)


def test_a_description_is_split_at_its_links() -> None:
    text = "Move\nthe [altitude](track.altitude=4.0) or take [no beam](sonar.beam=knife); [1] (a=b) is text."
    assert split_description(text) == (
        "Move the ",
        Link("altitude", "track.altitude", 4.0),
        " or take ",
        Link("no beam", "sonar.beam", "knife"),
        "; [1] (a=b) is text.",
    )
    assert plain_words(text) == "Move the altitude or take no beam; [1] (a=b) is text."


def test_a_link_may_set_a_table() -> None:
    (link,) = split_description("[a fan](sonar.beam={kind = 'fan', width = 3.0})")
    assert link == Link("a fan", "sonar.beam", {"kind": "fan", "width": 3.0})


def value_at(values: object, path: str) -> object:
    for step in path.split("."):
        values = values[int(step)] if isinstance(values, list) else values.get(step)  # type: ignore[attr-defined]
    return values


@pytest.mark.parametrize("name", bundled_scenes())
def test_every_bundled_scene_names_its_controls(name: str) -> None:
    scene = load_scene(name)
    assert 3 <= len(scene.controls) <= 6
    assert len(set(scene.controls)) == len(scene.controls)


@pytest.mark.parametrize("name", bundled_scenes())
def test_every_link_of_a_bundled_scene_changes_it(name: str) -> None:
    scene = load_scene(name)
    for link in (part for part in split_description(scene.description) if isinstance(part, Link)):
        changed = edit(scene, {"sonar.ping_rate": 1e-3, link.path: link.value})
        assert value_at(plain(changed), link.path) != value_at(plain(scene), link.path), link
