"""Every mistake gives one sentence with the field, the value and the remedy."""

import math
from itertools import permutations
from typing import Any

import pytest

from field_changes import RELIEFS, with_relief
from insonify.scene import SceneError, edit, load_scene, plain, read_setting

BOX, BALL = ({"kind": kind, "position": [1.0, 2.0]} for kind in ("box", "sphere"))
PROFILE, SPEEDS = {"kind": "profile"}, [1520.0, 1519.0, 1501.0, 1500.0]
HEAVE, ENDLESS = {"kind": "heave"}, {"kind": "power_law", "extent": "endless"}
MIMIC, DULL, SPAN = {"kind": "mimic"}, {"specular": 0.0}, {"kind": "pipe", "gap": [[0.0, 0.0], [1.0, 1.0]]}
HIGH = {"track.altitude": 26.0}
OF_OTHERS = "belongs to kind 'pipe' or 'wreck' or 'aircraft' or 'person', not to 'sphere'"
TWICE, BACK = [[0.0, 1.0], [0.0, 2.0]], [[2.0, 1.0], [1.0, 2.0]]  # gains twice at one time, and at an earlier one

WRONG = [
    ({"sonar.range": -5}, ["sonar.range", "-5", "above 0"]),
    ({"sonar.range": float("nan")}, ["sonar.range", "nan", "finite number"]),
    ({"sonar.range": "far"}, ["sonar.range", "'far'", "plain number"]),
    ({"sonar.bins": 0}, ["sonar.bins", "0", "at least 1"]),
    ({"sonar.bins": 2.5}, ["sonar.bins", "2.5", "without a fraction"]),
    ({"sonar": 3}, ["sonar: 3", "not a table"]),
    ({"title": 3}, ["title: 3", "quotes"]),
    ({"title": "x" * 300}, ["title: 'xxx", "length 300", "at most 200"]),
    ({"controls": ["track.altitud"]}, ["controls: 'track.altitud' is not a field of a scene"]),
    ({"description": "[to](track.altitud=4)"}, ["description: links to 'track.altitud', which is not a field"]),
    ({"track.terrain_following": "maybe"}, ["track.terrain_following: 'maybe'", "true or false"]),
    ({"track.terrain_following": True, "track.altitude": None, "track.depth": 12.0}, ["give altitude instead"]),
    ({"track.start": 3}, ["track.start: 3", "not a list"]),
    ({"track.start": [1.0, 2.0, 3.0]}, ["track.start: [1.0, 2.0, 3.0]", "at most 2"]),
    ({"track.start": [1e300, 0.0]}, ["track.start.0: 1e+300", "at most 1e+08"]),
    ({"targets.1.position": [0.0, -1e300]}, ["targets.1.position.1: -1e+300", "at least -1e+08"]),
    ({"targets.1.position": [1.0, 2.0, 1e9]}, ["targets.1.position.2: 1000000000.0", "at most 20000"]),
    ({"targets.0.gap": [[0.0, 0.0], [1.0]]}, ["targets.0.gap.1.1", "missing"]),
    ({"track.motion": {"kind": "sum", "of": []}}, ["track.motion.of: []", "at least 1"]),
    ({"track.motion": HEAVE | {"amplitude": 50.0}}, ["track.motion: a heave of 50 m", "below 10 m"]),
    ({"track.motion": HEAVE | {"amplitude": 10.0}}, ["track.motion: a heave of 10 m", "its amplitude below"]),
    ({"track.motion": HEAVE | {"amplitude": 5.0}} | HIGH, ["track.motion: a heave of 5 m", "keep its amplitude below"]),
    ({"sonar.ping_rate": 16}, ["sonar.ping_rate", "16", "lower it to 15 Hz", "sonar.range"]),
    (
        {"seabed.relief": "flat", "seabed.spacing": 1e-3, "sonar.range": 1e4, "sonar.ping_rate": 0.05},
        ["sonar.range", "10000 m", "0.001 m", "shorten the range to 262.1 m"],
    ),
    ({"seabed.relief": ENDLESS, "seabed.spacing": 0.01}, ["sonar.range", "endless ground", "0.01 m", "4096 cells"]),
    (
        {"sonar.pulse.duration": 0.1, "sonar.range": 0.005},
        ["sonar.pulse.duration", "0.1 s", "100000 bins of 5e-06 m", "0.000667 s"],
    ),
    ({"sonar.pulse": {"kind": "chirp", "duration": 1e-3, "bandwidth": 500.0}}, ["raise it to 1000 Hz"]),
    ({"sonar.beam.width": 0}, ["sonar.beam.width", "0", "at least 0.001"]),
    ({"sonar.ping_rate": 1e-300}, ["sonar.ping_rate", "1e-300", "at least 0.001"]),
    ({"sonar.beam.kind": "laser"}, ["sonar.beam.kind", "'laser'", "knife, fan"]),
    ({"sonar.beam": "laser"}, ["sonar.beam.kind", "laser", "knife, fan"]),
    ({"sonar.vertical": {"kind": "table", "levels": BACK}}, ["sonar.vertical.levels", "increasing angle"]),
    ({"sonar.law": "radar"}, ["sonar.law", "'radar'", "'sonar' or 'light'"]),
    ({"sonar.rnage": 50}, ["sonar.rnage", "unknown key", "'range'"]),
    ({"sonar.pulse": {"kind": "tone", "tone": 1}}, ["sonar.pulse.tone: unknown key", "one of kind, duration"]),
    ({"sonar.pulse": {"kind": "tone", "bandwidth": 3e4}}, ["bandwidth", "belongs to kind 'chirp', not to 'tone'"]),
    ({"seabed.depth": -30}, ["seabed.depth", "-30", "above 0"]),
    ({"seabed.relief.beta": 5}, ["seabed.relief.beta", "5", "below 5"]),
    ({"seabed.relief.beta": -1}, ["seabed.relief.beta", "-1", "at least 0"]),
    ({"seabed.relief.beta_x": 1.0}, ["seabed.relief", "beta_x and beta_y"]),
    ({"seabed.relief.peaks": [[512.0, 0.0]]}, ["relief.peaks", "512", "Nyquist", "spacing"]),
    ({"seabed.relief.kind": "mountains"}, ["seabed.relief.kind", "'mountains'", "flat, fractal"]),
    ({"seabed.relief": MIMIC | {"of": {"of": ["silt", "rock"]}}}, ["seabed.relief: of has", "with a mirror lobe"]),
    (
        {"seabed.relief": MIMIC | {"of": {"of": [DULL, DULL], "shape": "checks"}}},
        ['relief: of must lie along the track; give it shape = "stripes" or "waves" and heading = 0'],
    ),
    ({"seabed.relief": MIMIC | {"reach": 1e4}}, ["seabed: relief.reach 10000 m", "makes 200000 cells", "shorten"]),
    (
        {"seabed.relief": "mimic", "seabed.material": {"kind": "patches", "of": ["silt", "rock"]}},
        ['seabed: relief "mimic" imitates a map by its shape; give the seabed a single material'],
    ),
    ({"seabed.material": "custard"}, ["seabed.material", "'custard'", "medium_sand"]),
    ({"seabed.material.diffuse": 0.9, "seabed.material.specular": 0.9}, ["seabed.material", "0.9", "lower one"]),
    ({"seabed.material.reflection": 1.2}, ["seabed.material.reflection: 1.2 is out of bounds", "at most 1"]),
    ({"seabed.material.speed_ratio": 0.0}, ["seabed.material.speed_ratio: 0.0 is out of bounds", "at least 0.1"]),
    ({"seabed.spacing": 0.001}, ["relief.period", "spacing", "shorten the period"]),
    ({"targets.0.radius": 0}, ["targets.0.radius", "0", "at least 0.001"]),
    ({"targets.0.kind": "whale"}, ["targets.0.kind", "'whale'", "pipe, sphere"]),
    ({"targets.7.radius": 1.0}, ["targets.7.radius", "'7'", "numbered from 0"]),
    ({"targets.0.gap": [[5.0, 0.0], [1.0, 0.0]]}, ["targets.0.gap", "sort"]),
    ({"targets": [BOX | {"size": [1.0, 0.0, 1.0]}]}, ["targets.0.size.1", "0.0", "at least 0.001"]),
    ({"targets": [BOX | {"size": [1.0, 2.0, 1001.0]}]}, ["targets.0.size.2", "1001", "at most 1000"]),
    ({"targets": [BOX | {"size": [1.0, 2.0]}]}, ["targets.0.size"]),
    ({"targets": [BOX | {"roll": 400}]}, ["targets.0.roll", "400", "at most 360"]),
    ({"targets": [BOX | {"gap": -101}]}, ["targets.0.gap", "-101", "at least -100"]),
    ({"targets": [BOX | {"position": [1.0, 2.0, -20.0], "gap": 1.0}]}, ["targets.0", "gap", "one of the two"]),
    ({"targets": [BALL | {"position": [1.0, 2.0, -20.0], "gap": 1.0}]}, ["targets.0", "gap", "one of the two"]),
    ({"targets": [BALL | {"length": 3.0}]}, ["targets.0.length", "unknown key", OF_OTHERS]),
    ({"targets": [BOX | {"kind": "cone", "height": 0}]}, ["targets.0.height", "0", "at least 0.001"]),
    ({"targets": [BOX | SPAN | {"pitch": 3.0}]}, ["targets.0", "pitch is straight", "leave pitch out"]),
    ({"targets": [BOX | {"kind": "mesh"}]}, ["targets.0.path", "is missing"]),
    ({"targets": [BOX | {"kind": "mesh", "path": "x.obj", "scale": 0}]}, ["targets.0.scale", "at least 1e-06"]),
    ({"track.altitude": 31}, ["track.altitude", "31", "above the surface"]),
    ({"track.depth": 5}, ["track", "altitude and depth", "one of the two"]),
    ({"track.depth": 40, "track.altitude": None}, ["track.depth", "40", "into the bed"]),
    ({"track.pings": 0}, ["track.pings", "0", "at least 1"]),
    ({"water.sound_speed": 15}, ["water.sound_speed", "15", "at least 1300"]),
    ({"water.absorption": "lots"}, ["water.absorption", "lots"]),
    ({"water": PROFILE | {"depth": [0.0, 10.0, 5.0]}}, ["water.depth", "from 10 back to 5 m", "sort"]),
    ({"water": PROFILE | {"depth": [0.0, 5.0, 5.0]}}, ["water.depth", "5 m twice"]),
    ({"water": PROFILE | {"depth": [5.0]}}, ["water.depth", "not 1", "uniform"]),
    ({"water": PROFILE | {"depth": [0.0, math.nan]}}, ["water.depth.1", "nan", "finite"]),
    ({"water": PROFILE | {"depth": [-1.0, 5.0]}}, ["water.depth.0", "-1", "at least 0"]),
    ({"water": PROFILE | {"sound_speed": [1500.0, 1510.0]}}, ["water", "2 numbers for 4 depths", "one for each"]),
    ({"water": PROFILE | {"sound_speed": [*SPEEDS[:2], 0.0, 1500.0]}}, ["water.sound_speed.2", "0", "at least 1300"]),
    ({"water": PROFILE | {"sound_speed": [*SPEEDS[:2], 1800, 1500.0]}}, ["water.sound_speed.2: 1800", "at most 1700"]),
    ({"water": PROFILE | {"interpolation": "spline"}}, ["water.interpolation", "'spline'", "'pchip'"]),
    ({"water.kind": "fizzy"}, ["water.kind", "'fizzy'", "uniform, profile, hydrography, cast, section"]),
    ({"water": {"kind": "hydrography", "salinity": 99.0}}, ["water.salinity", "99", "at most 45"]),
    ({"water": {"kind": "hydrography", "salinity": [35.0]}}, ["water", "salinity has 1 number for 4 depths"]),
    ({"water": {"kind": "hydrography", "equation": "guess"}}, ["water.equation", "'guess'", "'teos10'"]),
    ({"water": {"kind": "section", "distance": [0.0]}}, ["water.distance", "not 1", "profile"]),
    ({"water": {"kind": "section", "sound_speed": [SPEEDS]}}, ["water", "1 profiles for 2 distances"]),
    ({"water": {"kind": "section", "sound_speed": [SPEEDS, [1500.0]]}}, ["sound_speed.1", "1 number for 4 depths"]),
    ({"water": {"kind": "cast"}}, ["water.path", "missing"]),
    ({"receiver.speckle": "coherent", "sonar.law": "light"}, ["coherent", "light", "'sonar'"]),
    ({"receiver.speckle": "coherent", "sonar.beam": "knife"}, ["coherent", "knife", "fan"]),
    ({"receiver.speckle": {"kind": "k", "shape": 1e-300}}, ["receiver.speckle.shape", "1e-300", "at least 0.01"]),
    ({"receiver.speckle": "glitter"}, ["receiver.speckle", "glitter", "rayleigh"]),
    (
        {"receiver.reverberation": "volume", "sonar.law": "light"},
        ["reverberation 'volume'", "use law 'sonar' or remove"],
    ),
    ({"water.surface": "rough", "sonar.law": "light"}, ["water.surface 'rough' mirrors", "use law 'sonar' or remove"]),
    ({"water": PROFILE, "sonar.law": "light"}, ["water 'profile' bends", "use law 'sonar' or water of one speed"]),
    ({"sonar.bounces": 2, "sonar.law": "light"}, ["sonar.bounces 2", "use law 'sonar' or sonar.bounces 0"]),
    *(({"receiver.recorder.gain": gain}, ["receiver.recorder.gain"]) for gain in ([], TWICE, BACK, 300.0)),
    ({"receiver.recorder.bits": 12}, ["receiver.recorder.bits", "12"]),
    ({"receiver.tvg": {"kind": "table", "gains": BACK}}, ["receiver.tvg.gains", "increasing time or bin"]),
    ({"seed": -1}, ["seed", "-1", "at least 0"]),
    ({"wind": 3}, ["wind", "unknown key"]),
]


def is_one_sentence(text: str) -> bool:
    return "\n" not in text and 10 < len(text) < 400


@pytest.mark.parametrize(("changes", "words"), WRONG, ids=[str(next(iter(changes))) for changes, _ in WRONG])
def test_a_wrong_value_is_named(changes, words):
    with pytest.raises(SceneError) as caught:
        edit(load_scene("default"), changes)
    sentence = str(caught.value)
    assert is_one_sentence(sentence)
    for word in words:
        assert word in sentence


ODD = [None, True, -1e400, math.nan, 10**400, "x", "", b"\xff", [], [[1]], {}, {"a": 1}, object(), "y" * 9999]


def paths(values, seen, place=(), kinds=()):
    """One path within plain values to each field of a kind, and to one element of each list, that was not seen yet."""
    items = values.items() if isinstance(values, dict) else enumerate(values) if isinstance(values, list) else ()
    for key, value in items:
        field = (*kinds, key if isinstance(values, dict) else "element", isinstance(value, dict) and value.get("kind"))
        if field not in seen:
            yield ".".join(map(str, (*place, key)))
        seen.add(field)
        yield from paths(value, seen, (*place, key), field)


def test_odd_values_are_told_in_plain_words():
    seen, sentences = set(), {}
    for name in ("default", "raw-record", "rough-tow", "thermocline", "figure-5-relief"):
        scene = load_scene(name)
        for path in paths(plain(scene), seen):
            for number, value in enumerate(ODD):
                try:
                    edit(scene, {path: value})
                except SceneError as error:
                    sentences[path, number] = str(error)
    assert len(sentences) > 1000
    assert [said for said in sentences.items() if not is_one_sentence(said[1]) or "nput should" in said[1]] == []


@pytest.mark.parametrize("text", ["sonar.range", "=5", "", "  = 3"])
def test_a_setting_without_path_or_value_is_shown_how(text):
    with pytest.raises(SceneError, match=r"path\.to\.field=value; write for example sonar\.range=75"):
        read_setting(text)


NAMELESS = [
    '[water]\nkind = "cast"',
    '[seabed.relief]\nkind = "dem"',
    '[seabed.relief]\nkind = "autocorrelation"\n[seabed.relief.function]\nkind = "file"',
    '[seabed.material]\nkind = "image"\nof = ["silt", "rock"]',
    '[track.motion]\nkind = "recorded"',
    '[[targets]]\nkind = "mesh"\nposition = [1, 2]',
]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("seed = 1\ntitle = \n", r"is not valid TOML .*line 2"),
        (b"\xff\xfe\x00", "cannot be read"),
        *(
            (text, "is nested too deeply; write fewer tables")
            for text in (f"x = {'[' * 9999}", f"x = {'[' * 200}{']' * 200}")
        ),
        *(
            (text, "has a key of more than 100 parts; write fewer tables")
            for text in (
                f"[{'a.' * 200_000}a]",
                f"{'a . ' * 100}a = 1",
                "'.'." * 100 + "a = 1",
                'x = {y = """it"s""", ' + '"b".' * 100 + "b = 1}",
            )
        ),
        (f"[world]\ncrs = '''{'a.' * 200}'''  # {'a.' * 200}a\nseeed = 1", "world.seeed: unknown key"),
        (f"{'a' * 10**6} = 1", "has a key of 1000000 characters, 'a{20}…'; shorten it$"),
        *(
            (f"seed = {digits}", "has a whole number of hundreds of digits")
            for digits in ("9" * 5000, "0x" + "f" * 5000)
        ),
        *(
            (f'{table}\npath = "a\\u0000b"\n', r"[\w.]+path: contains a NUL character, .*; remove it$")
            for table in NAMELESS
        ),
        ("[sonar]\nrange = -1\n", r"sonar\.range: -1"),
    ],
)
def test_a_file_that_is_no_scene_is_named_with_its_fault(tmp_path, content, sentence):
    path = tmp_path / "scene.toml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(SceneError, match=rf"scene\.toml'?:? {sentence}"):
        load_scene(path)


def test_a_byte_order_mark_is_no_matter_and_a_folder_no_scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text('title = "Marked"', encoding="utf-8-sig")
    assert load_scene(path).title == "Marked"
    with pytest.raises(SceneError, match=r"cannot be read \(Is a directory\)"):
        load_scene(tmp_path)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("track.speed=3kn", 3.0 * 1852.0 / 3600.0),
        ("track.speed=3 kn", 3.0 * 1852.0 / 3600.0),
        ("track.speed=3", 3),
        ("sonar.frequency=455kHz", 455e3),
        ("sonar.pulse.duration=0.1ms", 1e-4),
        ("sonar.beam.width=2°", 2.0),
        ("track.start.0=0.2 km", 200.0),
        ("targets.0.radius=30cm", 0.3),
        ("title=3kn", "3kn"),
        ("water.absorption=francois_garrison", "francois_garrison"),
        ("sonar.range=75", 75),
        ("seabed.relief.peaks=[[8.0, 4.0]]", [[8.0, 4.0]]),
        ("sonar.law=light", "light"),
        ("title=a = b", "a = b"),
    ],
)
def test_a_setting_is_toml_a_bare_word_or_a_number_with_a_unit_where_its_field_has_one(text: str, value: Any) -> None:
    path, read = read_setting(text)
    assert (path, read) == (text.partition("=")[0], pytest.approx(value) if isinstance(value, float) else value)
    edit(load_scene("default"), {path: read})


def test_an_unknown_unit_stays_text() -> None:
    assert read_setting("track.speed=3furlongs") == ("track.speed", "3furlongs")
    assert read_setting("nowhere.at.all=3kn") == ("nowhere.at.all", "3kn")


@pytest.mark.parametrize(("first", "second"), list(permutations(RELIEFS, 2)))
def test_any_kind_follows_any_other(first, second):
    assert with_relief(with_relief(load_scene("default"), kind=first), kind=second).seabed.relief.kind == second


@pytest.mark.parametrize("first", ["fractal", "power_law", "von_karman", "ripples", "autocorrelation", "sum"])
@pytest.mark.parametrize("second", RELIEFS)
def test_any_kind_follows_an_endless_one(first, second):
    place = {"of__0__extent": "endless"} if first == "sum" else {"extent": "endless"}
    endless = with_relief(with_relief(load_scene("default"), kind=first), **place)
    assert endless.seabed.endless
    assert with_relief(endless, kind=second).seabed.relief.kind == second
