"""Bundled scenes, their pictures, and scenes as TOML."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from insonify.files import bundled_meshes, bundled_picture
from insonify.scene import (
    SceneError,
    bundled_scenes,
    edit,
    load_scene,
    plain,
    read_setting,
    resources,
    scene_from_toml,
    scene_to_toml,
)


@pytest.mark.parametrize("name", bundled_scenes())
def test_every_bundled_scene_survives_a_round_trip(name):
    scene = load_scene(name)
    assert scene_from_toml(scene_to_toml(scene)) == scene == load_scene(bundled_scenes()[name])
    assert scene.title != "Untitled"
    assert len(scene.about.split()) >= 40, "a paragraph: what it shows, what to move"


def test_figures_are_there():
    figures = {"1", "2a", "2b", "3", "4a", "4b", "5-pattern", "5-relief", "6"}
    assert {f"figure-{number}" for number in figures} | {"default", "pipe-on-bed", "pipe-span"} <= set(bundled_scenes())


@pytest.mark.parametrize(
    ("names", "apart"), [(("figure-2a", "figure-2b"), {"sonar.law"}), (("figure-4a", "figure-4b"), {"sonar.beam"})]
)
def test_figures_that_are_compared_differ_in_one_thing(names, apart):
    scenes = [load_scene(name) for name in names]
    one, other = map(plain, scenes)
    differing = {
        f"{part}.{name}"
        for part in one
        if isinstance(one[part], dict)
        for name in one[part]
        if one[part][name] != other[part][name]
    }
    assert differing == apart
    assert one["targets"] == other["targets"]
    # Pings of figure 4 lie within 5 cm.
    assert "sonar.law" in apart or all(scene.track.speed / scene.sonar.ping_rate <= 0.05 for scene in scenes)


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
    recorded = '{ kind = "recorded", path = "tow.csv" }'
    for motion in (recorded, f'{{ kind = "sum", of = ["heave", {recorded}] }}'):
        (tmp_path / "scene.toml").write_text(
            f'[seabed]\nrelief = {{ kind = "dem", path = "bed.npy" }}\n[track]\nmotion = {motion}\n'
        )
        scene = load_scene(tmp_path / "scene.toml")
        assert scene.seabed.relief.path == str(tmp_path / "bed.npy")
        assert (scene.track.motion if motion is recorded else scene.track.motion.of[1]).path == str(
            tmp_path / "tow.csv"
        )


def test_a_scene_cannot_be_changed_in_place():
    with pytest.raises(ValueError, match="frozen"):
        load_scene("default").seed = 2


def test_a_missing_scene_names_those_there_are():
    with pytest.raises(
        SceneError, match=r"no such file; give a TOML file or one of breaks-beats, .*default, .*figure-1, figure-2a"
    ):
        load_scene("atlantis")


LARGEST, TOTAL = 6_000, 250_000  # bytes


@pytest.mark.parametrize("name", bundled_scenes())
def test_a_scene_has_a_small_picture(name: str) -> None:
    path = bundled_picture(bundled_scenes()[name])
    assert path.stat().st_size <= LARGEST
    with Image.open(path) as picture:
        assert picture.size == (150, 100)
        low, high = picture.convert("L").getextrema()
        assert high - low > 40, "it shows a record"
        edges = [picture.convert("L").getpixel(place) for place in ((0, 50), (149, 50), (75, 0), (75, 99))]
        assert min(edges) < 200, "the record fills it, without a page around"


def test_pictures_are_those_of_scenes_and_meshes_and_light() -> None:
    bundled = [*bundled_scenes().values(), *bundled_meshes().values()]
    files = [path for folder in ("scenes", "meshes") for path in (resources() / folder / "pictures").iterdir()]
    assert sorted(files) == sorted(map(bundled_picture, bundled))
    assert sum(path.stat().st_size for path in files) <= TOTAL
