"""What a scene says of its partner and of its own controls: fields to pin, and links in its description."""

from pathlib import Path

import pytest

from insonify.scene import (
    Scene,
    SceneError,
    bundled_scenes,
    edit,
    load_partner,
    load_scene,
    plain,
    scene_from_toml,
    scene_to_toml,
)
from insonify.scene.base import is_field
from insonify.scene.links import Link, plain_words, split_description

PAIRS = {"figure-2a": "figure-2b", "figure-4a": "figure-4b", "figure-5-pattern": "figure-5-relief"}


@pytest.mark.parametrize(("one", "other"), PAIRS.items())
def test_scenes_of_one_figure_name_each_other(one: str, other: str) -> None:
    assert load_partner(load_scene(one)) == load_scene(other)
    assert load_partner(load_scene(other)) == load_scene(one)


def test_every_bundled_partner_is_a_scene_or_the_same_with_other_settings() -> None:
    named = {name for name, path in bundled_scenes().items() if load_partner(load_scene(path)) is not None}
    assert named == {*PAIRS, *PAIRS.values(), "ghosts"}
    ghosts = load_scene("ghosts")
    assert load_partner(ghosts) == edit(ghosts, {"water.surface": "none"})
    assert load_partner(load_scene("default")) is None


def test_a_partner_lies_beside_the_file_that_names_it(tmp_path: Path) -> None:
    (tmp_path / "one.toml").write_text('title = "One"\npartner = ["other.toml", "seed=7"]\n')
    (tmp_path / "other.toml").write_text('title = "Other"\n')
    one = load_scene(tmp_path / "one.toml")
    partner = load_partner(one)
    assert partner is not None
    assert (partner.title, partner.seed) == ("Other", 7)
    assert load_partner(scene_from_toml(scene_to_toml(one))) == partner, "wherever the scene is saved"


@pytest.mark.parametrize(
    ("partner", "said"),
    [
        (["nowhere"], "no such file"),
        (["ghosts", "default"], "names 2 scenes"),
        (["sonar.width=2"], "sonar.width"),
        (["sonar.bins=-1"], "sonar.bins"),
    ],
)
def test_a_wrong_partner_is_one_sentence(partner: list[str], said: str) -> None:
    with pytest.raises(SceneError, match=said):
        load_partner(edit(load_scene("default"), {"partner": partner}))


def test_paths_of_fields_of_any_kind() -> None:
    fields = ("track.altitude", "seed", "sonar.beam.length", "targets.0.gap.3.1", "seabed.relief.of.1.mask.share")
    assert all(is_field(Scene, path) for path in fields)
    nowhere = ("", "0", "track.altitud", "sonar.beam.widht", "targets.0.nothing", "track..altitude")
    assert not any(is_field(Scene, path) for path in nowhere)


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
    (link,) = split_description("[a fan](sonar.beam={kind = 'fan', width = 3.0})")
    assert link == Link("a fan", "sonar.beam", {"kind": "fan", "width": 3.0})


def value_at(values: object, path: str) -> object:
    for step in path.split("."):
        values = values[int(step)] if isinstance(values, list) else values.get(step)  # type: ignore[attr-defined]
    return values


@pytest.mark.parametrize("name", bundled_scenes())
def test_every_bundled_scene_names_its_controls_and_every_link_changes_it(name: str) -> None:
    scene = load_scene(name)
    assert 3 <= len(scene.controls) <= 6
    assert len(set(scene.controls)) == len(scene.controls)
    for link in (part for part in split_description(scene.description) if isinstance(part, Link)):
        changed = edit(scene, {"sonar.ping_rate": 1e-3, link.path: link.value})
        assert value_at(plain(changed), link.path) != value_at(plain(scene), link.path), link
