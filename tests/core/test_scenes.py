"""Bundled scenes and sonars, their pictures, partners, controls and links, and scenes as TOML."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from insonify.files import bundled_meshes, bundled_picture, bundled_scenes, bundled_sonars, resources
from insonify.scene import Scene, SceneError, edit, load_partner, load_scene, plain, scene_from_toml, scene_to_toml
from insonify.scene.base import is_field
from insonify.scene.links import Link, split_description
from insonify.scene.sonar.presets import read_preset
from insonify.simulation import prepare


@pytest.mark.parametrize("name", bundled_scenes())
def test_every_bundled_scene_survives_a_round_trip_names_its_controls_and_is_changed_by_every_link(name):
    scene = load_scene(name)
    assert scene_from_toml(scene_to_toml(scene)) == scene == load_scene(bundled_scenes()[name])
    assert scene.title != "Untitled"
    assert len(scene.about.split()) >= 40, "a paragraph: what it shows, what to move"
    assert 3 <= len(set(scene.controls)) == len(scene.controls) <= 6
    for link in (part for part in split_description(scene.description) if isinstance(part, Link)):
        seldom = edit(scene, {"sonar.ping_rate": 1e-3})
        assert edit(seldom, {link.path: link.value}) != seldom, link


def test_figures_are_there_and_a_missing_scene_names_those_there_are():
    figures = {"1", "2a", "2b", "3", "4a", "4b", "5-pattern", "5-relief", "6"}
    assert {f"figure-{number}" for number in figures} | {"default", "pipe-on-bed", "pipe-span"} <= set(bundled_scenes())
    said = r"no such file; give a TOML file or one of breaks-beats, .*default, .*figure-1, figure-2a"
    with pytest.raises(SceneError, match=said):
        load_scene("atlantis")


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
    st.fixed_dictionaries(
        {
            "track.altitude": st.floats(0.1, 29.0),
            "seabed.relief.beta": st.floats(0.0, 4.9),
            "seabed.relief.peaks": st.tuples(st.floats(-40, 40), st.floats(-40, 40)).map(lambda peak: [list(peak)]),
            "sonar.beam.width": st.floats(0.01, 60.0),
            "seed": st.integers(0, 2**63 - 1),
            "title": st.text(st.characters(exclude_categories=["Cs"]), max_size=50),
        }
    )
)
def test_any_numbers_survive_a_round_trip(changes):
    scene = edit(load_scene("default"), changes)
    assert scene_from_toml(scene_to_toml(scene)) == scene


def test_changes_take_bare_names_for_tables_in_any_order_and_are_never_made_in_place():
    changes = {"sonar.beam.width": 3.0, "sonar.beam.kind": "fan", "track.depth": 12.0, "track.altitude": None}
    knife = edit(load_scene("default"), {"sonar.beam.kind": "knife"})
    backwards = dict(reversed(changes.items()))
    assert edit(knife, changes) == edit(knife, backwards)
    with pytest.raises(ValueError, match="frozen"):
        knife.seed = 2
    scene = edit(load_scene("default"), {"sonar.beam": "knife", "seabed.relief": "flat", "seabed.material": "rock"})
    assert plain(scene)["sonar"]["beam"] == {"kind": "knife"}
    assert plain(scene)["seabed"]["relief"] == {"kind": "flat"}
    assert plain(scene)["seabed"]["material"]["name"] == "rock"


def test_relative_paths_and_a_partner_are_taken_from_the_scene_that_names_them(tmp_path):
    tow = '{ kind = "recorded", path = "tow.csv" }'
    for motion in (tow, f'{{ kind = "sum", of = ["heave", {tow}] }}'):
        text = f'[seabed]\nrelief = {{ kind = "dem", path = "bed.npy" }}\n[track]\nmotion = {motion}\n'
        (tmp_path / "scene.toml").write_text(text)
        scene = load_scene(tmp_path / "scene.toml")
        recorded = scene.track.motion if motion is tow else scene.track.motion.of[1]
        assert (scene.seabed.relief.path, recorded.path) == (str(tmp_path / "bed.npy"), str(tmp_path / "tow.csv"))
    (tmp_path / "one.toml").write_text('title = "One"\npartner = ["other.toml", "seed=7"]\n')
    (tmp_path / "other.toml").write_text('title = "Other"\n')
    one = load_scene(tmp_path / "one.toml")
    partner = load_partner(one)
    assert partner is not None
    assert (partner.title, partner.seed) == ("Other", 7)
    assert load_partner(scene_from_toml(scene_to_toml(one))) == partner, "wherever the scene is saved"


def test_every_scene_has_a_small_picture_and_pictures_are_those_of_scenes_and_meshes_and_light() -> None:
    for path in map(bundled_picture, bundled_scenes().values()):
        assert path.stat().st_size <= 6_000, path
        with Image.open(path) as picture:
            assert picture.size == (150, 100), path
            low, high = picture.convert("L").getextrema()
            assert high - low > 40, f"{path} shows a record"
            edges = [picture.convert("L").getpixel(place) for place in ((0, 50), (149, 50), (75, 0), (75, 99))]
            assert min(edges) < 200, f"the record fills {path}, without a page around"
    bundled = [*bundled_scenes().values(), *bundled_meshes().values()]
    files = [path for folder in ("scenes", "meshes") for path in (resources() / folder / "pictures").iterdir()]
    assert sorted(files) == sorted(map(bundled_picture, bundled))
    assert sum(path.stat().st_size for path in files) <= 250_000


PAIRS = {"figure-2a": "figure-2b", "figure-4a": "figure-4b", "figure-5-pattern": "figure-5-relief"}


def test_scenes_of_one_figure_name_each_other_and_another_partner_is_the_same_with_other_settings() -> None:
    for one, other in PAIRS.items():
        assert load_partner(load_scene(one)) == load_scene(other)
        assert load_partner(load_scene(other)) == load_scene(one)
    named = {name for name, path in bundled_scenes().items() if load_partner(load_scene(path)) is not None}
    assert named == {*PAIRS, *PAIRS.values(), "ghosts"}
    ghosts = load_scene("ghosts")
    assert load_partner(ghosts) == edit(ghosts, {"water.surface": "none"})
    assert load_partner(load_scene("default")) is None


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
    assert Scene(description=text).about == "Move the altitude or take no beam; [1] (a=b) is text."
    (link,) = split_description("[a fan](sonar.beam={kind = 'fan', width = 3.0})")
    assert link == Link("a fan", "sonar.beam", {"kind": "fan", "width": 3.0})


BED = "[seabed]\ndepth = 60.0\nrelief = 'flat'\nspacing = 0.5\n[track]\naltitude = 10.0\n"


@pytest.mark.parametrize("name", bundled_sonars())
def test_a_preset_makes_a_record(name):
    scene = scene_from_toml(f"sonar = '{name}'\n{BED}")
    declared = read_preset(name)
    assert declared["title"]
    assert declared["source"]
    assert scene.sonar.frequency == declared["sonar"]["frequency"]
    assert scene.receiver.source_level == declared["receiver"]["source_level"]
    assert scene_from_toml(scene_to_toml(scene)) == scene
    record = prepare(scene, forced={"planes": "4"}).intensity(np.arange(1))
    assert np.isfinite(record).all()
    assert record.max() > 0.0


def test_there_is_one_from_kayak_to_deep_tow():
    frequencies = {read_preset(name)["sonar"]["frequency"] for name in bundled_sonars()}
    assert len(bundled_sonars()) >= 12
    assert {100e3, 400e3, 455e3, 500e3, 600e3, 800e3, 900e3, 1.6e6} <= frequencies


def test_fields_beside_a_preset_override_it_and_an_edit_replaces_it_or_keeps_its_numbers():
    table = "sonar = { preset = 'towfish-400', range = 75.0, beam = { width = 0.8 }, pulse = 'ideal' }\n"
    scene = scene_from_toml(f"{table}{BED}[receiver]\nsource_level = 200.0\n")
    assert (scene.sonar.range, scene.sonar.beam.kind, scene.sonar.beam.width) == (75.0, "gaussian", 0.8)
    assert (scene.sonar.pulse.kind, scene.sonar.frequency) == ("ideal", 400e3)
    assert (scene.receiver.source_level, scene.receiver.recorder.bits) == (200.0, 16)
    assert scene.sonar.ping_rate == pytest.approx(700.0 / 75.0, abs=1e-3)
    scene = scene_from_toml(f"sonar = 'towfish-400'\n{BED}")
    for path in ("sonar", "sonar.preset"):
        other = edit(scene, {path: "kayak-800"})
        assert other == scene_from_toml(f"sonar = 'kayak-800'\n{BED}")
    assert edit(scene, {"sonar.preset": "kayak-800", "sonar.range": 20.0}).sonar.range == 20.0
    assert edit(scene, {"sonar.range": 80.0}).sonar.preset == "towfish-400"
    own = edit(scene, {"sonar.preset": "none"})
    assert own.sonar == scene.sonar.model_copy(update={"preset": None})
    assert scene_from_toml(f"sonar = 'none'\n{BED}") == scene_from_toml(BED)
    with pytest.raises(SceneError, match=r"sonar\.preset: 'sputnik' is not a known sonar; choose one of auv-230"):
        edit(scene, {"sonar": "sputnik"})
