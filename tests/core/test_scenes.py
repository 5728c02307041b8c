"""Bundled scenes, and scenes as TOML."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from insonify.scene import (
    SceneError,
    bundled_scenes,
    edit,
    load_scene,
    plain,
    read_setting,
    scene_from_toml,
    scene_to_toml,
)


@pytest.mark.parametrize("name", bundled_scenes())
def test_every_bundled_scene_survives_a_round_trip(name):
    scene = load_scene(name)
    assert scene_from_toml(scene_to_toml(scene)) == scene
    assert scene.title != "Untitled"
    assert len(scene.about.split()) >= 40, "a paragraph: what it shows, what to move"


@pytest.mark.parametrize("name", bundled_scenes())
def test_every_bundled_scene_loads_by_path(name):
    assert load_scene(bundled_scenes()[name]) == load_scene(name)


def test_figures_are_there():
    figures = {"1", "2a", "2b", "3", "4a", "4b", "5-pattern", "5-relief", "6"}
    assert {f"figure-{number}" for number in figures} | {"default", "pipe-on-bed", "pipe-span"} <= set(bundled_scenes())


@pytest.mark.parametrize(
    ("one", "other", "apart"),
    [("figure-2a", "figure-2b", {"sonar.law"}), ("figure-4a", "figure-4b", {"sonar.beam"})],
)
def test_figures_that_are_compared_differ_in_one_thing(one, other, apart):
    one, other = (plain(load_scene(name)) for name in (one, other))
    differing = {
        f"{part}.{name}"
        for part in one
        if isinstance(one[part], dict)
        for name in one[part]
        if one[part][name] != other[part][name]
    }
    assert differing == apart
    assert one["targets"] == other["targets"]


@settings(max_examples=40, deadline=None)
@given(
    altitude=st.floats(0.1, 29.0),
    beta=st.floats(0.0, 4.9),
    peak=st.tuples(st.floats(-40, 40), st.floats(-40, 40)),
    width=st.floats(0.01, 60.0),
    seed=st.integers(0, 2**63 - 1),
    title=st.text(st.characters(exclude_categories=["Cs"]), max_size=50),
)
def test_any_numbers_survive_a_round_trip(altitude, beta, peak, width, seed, title):
    scene = edit(
        load_scene("default"),
        {
            "track.altitude": altitude,
            "seabed.relief.beta": beta,
            "seabed.relief.peaks": [list(peak)],
            "sonar.beam.width": width,
            "seed": seed,
            "title": title,
        },
    )
    assert scene_from_toml(scene_to_toml(scene)) == scene


def test_a_bare_name_stands_for_its_table():
    scene = edit(load_scene("default"), {"sonar.beam": "knife", "seabed.relief": "flat", "seabed.material": "rock"})
    assert plain(scene)["sonar"]["beam"] == {"kind": "knife"}
    assert plain(scene)["seabed"]["relief"] == {"kind": "flat"}
    assert plain(scene)["seabed"]["material"]["name"] == "rock"


def test_changes_do_not_depend_on_their_order():
    changes = {"sonar.beam.width": 3.0, "sonar.beam.kind": "fan", "track.depth": 12.0, "track.altitude": None}
    knife = edit(load_scene("default"), {"sonar.beam.kind": "knife"})
    backwards = dict(reversed(changes.items()))
    assert edit(knife, changes) == edit(knife, backwards)


def test_settings_read_toml_and_bare_words():
    assert read_setting("sonar.range=75") == ("sonar.range", 75)
    assert read_setting("seabed.relief.peaks=[[8.0, 4.0]]") == ("seabed.relief.peaks", [[8.0, 4.0]])
    assert read_setting("sonar.law=light") == ("sonar.law", "light")
    assert read_setting("title=a = b") == ("title", "a = b")


def test_relative_paths_are_taken_from_the_scene(tmp_path):
    np.save(tmp_path / "bed.npy", np.zeros((4, 4)))
    (tmp_path / "scene.toml").write_text('[seabed]\nrelief = { kind = "dem", path = "bed.npy" }\n')
    assert load_scene(tmp_path / "scene.toml").seabed.relief.path == str(tmp_path / "bed.npy")


def test_paths_of_recorded_tows_are_taken_from_the_scene(tmp_path):
    recorded = '{ kind = "recorded", path = "tow.csv" }'
    (tmp_path / "one.toml").write_text(f"[track]\nmotion = {recorded}\n")
    (tmp_path / "two.toml").write_text(f'[track]\nmotion = {{ kind = "sum", of = ["heave", {recorded}] }}\n')
    assert load_scene(tmp_path / "one.toml").track.motion.path == str(tmp_path / "tow.csv")
    assert load_scene(tmp_path / "two.toml").track.motion.of[1].path == str(tmp_path / "tow.csv")


def test_a_scene_cannot_be_changed_in_place():
    with pytest.raises(ValueError, match="frozen"):
        load_scene("default").seed = 2


def test_pings_of_figure_4_lie_within_5_centimetres():
    for name in ("figure-4a", "figure-4b"):
        scene = load_scene(name)
        assert scene.track.speed / scene.sonar.ping_rate <= 0.05


def test_a_missing_scene_names_those_there_are():
    with pytest.raises(
        SceneError, match=r"no such file; give a TOML file or one of breaks-beats, .*default, .*figure-1, figure-2a"
    ):
        load_scene("atlantis")
