"""Scenes that name a partner to be compared with."""

from pathlib import Path

import pytest

from insonify.scene import SceneError, bundled_scenes, edit, load_partner, load_scene, scene_from_toml, scene_to_toml

PAIRS = {"figure-2a": "figure-2b", "figure-4a": "figure-4b", "figure-5-pattern": "figure-5-relief"}


@pytest.mark.parametrize(("one", "other"), PAIRS.items())
def test_scenes_of_one_figure_name_each_other(one: str, other: str) -> None:
    assert load_partner(load_scene(one)) == load_scene(other)
    assert load_partner(load_scene(other)) == load_scene(one)


def test_every_bundled_partner_is_a_scene() -> None:
    named = {name for name, path in bundled_scenes().items() if load_partner(load_scene(path)) is not None}
    assert named == {*PAIRS, *PAIRS.values(), "ghosts"}


def test_a_partner_may_be_the_scene_with_other_settings() -> None:
    ghosts = load_scene("ghosts")
    without = load_partner(ghosts)
    assert without == edit(ghosts, {"water.surface": "none"})
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
