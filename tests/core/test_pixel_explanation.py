"""The explanation of a pixel adds up to the record, whatever the scene, and tells where the sound went."""

import itertools
import math

import numpy as np
import pytest

from insonify.cli import main
from insonify.explanation import compilation
from insonify.explanation.cross_section import cut_cross_section
from insonify.explanation.listeners import find_listeners
from insonify.explanation.pixel import explain_pixel
from insonify.scene import Scene, SceneError, build, edit, load_scene
from insonify.simulation import prepare

CLOSE = 0.01  # dB by which a budget may miss its pixel
PIPE = {"kind": "pipe", "position": [10.0, 15.0], "radius": 0.5, "length": 8.0, "material": "steel"}
BALL = {"kind": "sphere", "position": [12.0, -14.0], "radius": 0.7, "material": "rock"}
ROUGH = {"kind": "fractal", "beta": 1.4, "period": 51.2, "rms": 0.2}
BASE = build(
    {
        "seabed": {"depth": 30.0, "spacing": 0.2, "relief": ROUGH, "material": "medium_sand"},
        "targets": [PIPE, BALL],
        "sonar": {"beam": {"kind": "fan", "width": 2.5}, "range": 40.0, "bins": 400, "pulse": "ideal"},
        "track": {"altitude": 10.0, "speed": 2.0, "pings": 120},
    }
)


def scene(**changes) -> Scene:
    """A small scene; changes are given by dotted paths with double underscores."""
    return edit(BASE, {path.replace("__", "."): value for path, value in changes.items()})


THERMOCLINE = {"kind": "profile", "depth": [0.0, 18.0, 22.0, 60.0], "sound_speed": [1510.0, 1510.0, 1498.0, 1498.0]}
SCENES = {
    "knife": {"sonar__beam": "knife"},
    "fan": {},
    "one plane for the whole fan": {"forced": {"planes": "1"}},
    "gaussian": {"sonar__beam": {"kind": "gaussian", "width": 1.5}},
    "array": {"sonar__beam": {"kind": "array", "length": 0.3}},
    "squint": {"sonar__beam": {"kind": "fan", "width": 2.0, "squint": 5.0}},
    "vertical beam": {"sonar__vertical": {"kind": "gaussian", "width": 40.0, "tilt": 20.0}},
    "tone": {"sonar__pulse": {"kind": "tone", "duration": 4e-4}},
    "chirp": {"sonar__pulse": {"kind": "chirp", "duration": 2e-3, "bandwidth": 2e4}},
    "law light": {"sonar__law": "light"},
    "law light through a beam": {"sonar__law": "light", "sonar__beam": {"kind": "gaussian", "width": 2.0}},
    "absorption": {"water__absorption": 120.0},
    "bent": {"water": THERMOCLINE},
    "bent knife": {"water": THERMOCLINE, "sonar__beam": "knife"},
    "ghosts": {"water__surface": "flat"},
    "ghosts of waves": {"water__surface": {"kind": "rough", "wind_speed": 5.0}},
    "patches": {"seabed__material": {"kind": "patches", "of": ["silt", "rock"]}},
    "rayleigh": {"receiver__speckle": "rayleigh"},
    "k": {"receiver__speckle": {"kind": "k", "shape": 2.0}},
    "noise": {"receiver__noise": {"kind": "ambient", "level": -95.0}},
    "noise and speckle": {"receiver__noise": {"kind": "ambient", "level": -95.0}, "receiver__speckle": "rayleigh"},
    "tvg": {"receiver__tvg": {"kind": "power", "spreading": 40.0}, "receiver__source_level": 200.0},
    "crosstalk": {"receiver__crosstalk": -30.0},
    "reverberation": {"receiver__reverberation": {"kind": "volume", "volume_strength": -70.0}},
    "fluctuation": {"receiver__fluctuation": {"kind": "lognormal"}},
    "recorder": {"receiver__recorder": {"bits": 16}},
    "motion": {"track__motion": {"kind": "roll", "amplitude": 5.0, "period": 4.0}},
    "oblique": {"track__heading": 37.0},
    "rays": {"method": "rays"},
}


def prepared(changes):
    how = {name: changes[name] for name in ("method", "forced") if name in changes}
    return prepare(scene(**{name: value for name, value in changes.items() if name not in how}), **how)


SWEPT = {(50, 0, 120), (50, 0, 187), (50, 1, 171), (50, 1, 300)}  # ping, side, bin


@pytest.mark.usefixtures("fixed_model")
@pytest.mark.parametrize("name", SCENES)
def test_the_terms_add_up_to_the_pixel_and_the_parts_are_those_of_the_sweep(name):
    simulation = prepared(SCENES[name])
    heard = 0
    for ping in (50, 60):  # abeam of the pipe and of the ball
        record = simulation.intensity(np.array([ping], dtype=np.int64))[0]
        for side, pixel in itertools.product(range(2), (30, 101, 120, 155, 171, 187, 260, 300, 399)):
            explained = explain_pixel(simulation, ping, side, pixel)
            assert np.float32(explained.value) == record[side, pixel]
            total = sum(term.decibels for term in explained.terms)
            if name != "rays" and (ping, side, pixel) in SWEPT:
                # No term is left over between the tracer and the parts.
                assert not [term for term in explained.terms if term.name == "tracing"]
            if record[side, pixel] == 0.0:
                assert not explained.terms or total == -math.inf
                continue
            heard += 1
            assert total == pytest.approx(10.0 * math.log10(record[side, pixel]), abs=CLOSE)
            assert not any(math.isnan(term.decibels) for term in explained.terms)
            if explained.contributions:
                assert sum(each.share for each in explained.contributions) == pytest.approx(1.0)
    assert heard > 20


@pytest.mark.usefixtures("fixed_model")
@pytest.mark.parametrize(
    ("name", "forced", "side", "pixels"),
    [("raw-record", {}, 1, (150, 400, 800)), ("double-image", {"planes": "1", "rays": "64000"}, 0, (1520,))],
    ids=["coherent speckle and endless ground", "folded refraction"],
)
def test_pixels_of_bundled_scenes_add_up(name, forced, side, pixels):
    simulation = prepare(edit(load_scene(name), {"track.pings": 64}), forced=forced)
    for pixel in pixels:
        explained = explain_pixel(simulation, 20, side, pixel)
        assert sum(term.decibels for term in explained.terms) == pytest.approx(explained.level, abs=CLOSE)
        # Folded refraction is explained ray by ray.
        assert (name == "double-image") == any("single rays" in said for said in explained.approximations)
        assert name != "double-image" or explained.contributions[0].rays


def flat(**changes):
    silt = {"name": "silt", "diffuse": 0.5, "specular": 0.0}
    level = {"seabed__relief": "flat", "targets": [], "seabed__material": silt}
    return prepare(scene(**level | changes), tolerance=0.003)


def term(explained, name):
    return next(each.decibels for each in explained.terms if each.name == name)


def test_terms_over_a_level_bed_are_the_sonar_equation_and_the_vertical_beam_one_of_its_own():
    explained = explain_pixel(flat(water__absorption=100.0, receiver__source_level=200.0), 10, 0, 250)
    r, length = 25.05, 0.1
    # A strip r Θ wide and Δr / cosθ long, θ the grazing angle.
    area = r * math.radians(2.5) * length / math.sqrt(1.0 - (10.0 / r) ** 2)
    for name, expected in {
        "source level": pytest.approx(200.0, abs=1e-4),
        "spreading": pytest.approx(-40.0 * math.log10(r), abs=1e-3),
        "absorption": pytest.approx(-2.0 * 0.1 * r, rel=1e-3),
        "material": pytest.approx(10.0 * math.log10(0.5 / math.pi), abs=1e-6),
        "incidence": pytest.approx(20.0 * math.log10(10.0 / r), abs=0.01),
        "area": pytest.approx(10.0 * math.log10(area), abs=0.02),
    }.items():
        assert term(explained, name) == expected, name
    assert explained.contributions[0].ground_range == pytest.approx(math.sqrt(r * r - 100.0), abs=0.02)
    assert explained.contributions[0].incidence == pytest.approx(math.degrees(math.acos(10.0 / r)), abs=0.1)
    beam = {"kind": "gaussian", "width": 40.0, "tilt": 20.0}
    explained = explain_pixel(flat(sonar__vertical=beam), 10, 0, 250)
    off = math.sin(math.asin(10.0 / 25.05) - math.radians(20.0)) / math.sin(math.radians(20.0))
    assert term(explained, "beam vertically") == pytest.approx(-2.0 * 10.0 * math.log10(2.0) * off * off, abs=0.05)


def test_a_target_off_the_axis_has_the_response_there():
    # A small ball over a dark bed: all that the bin holds lies at nearly the same azimuth.
    ball = {"kind": "sphere", "position": [10.3, -20.0, -25.0], "radius": 0.04, "material": "rock"}
    beam = {"kind": "gaussian", "width": 2.0}
    simulation = flat(targets=[ball], sonar__beam=beam, sonar__bins=800, seabed__material="silt")
    distance = math.hypot(0.3, 20.0, 5.0)
    explained = explain_pixel(simulation, 50, 1, int((distance - 0.04) / 0.05))
    assert explained.contributions[0].words == "sphere 1, rock"
    off = 0.3 / distance / math.sin(math.radians(1.0))
    assert term(explained, "beam along the track") == pytest.approx(-20.0 * math.log10(2.0) * off * off, abs=0.3)


@pytest.mark.usefixtures("fixed_model")
def test_places_and_rays_lie_where_the_slant_range_says():
    simulation = prepared({})
    ground = simulation.ground
    for pixel in (150, 260):
        explained = explain_pixel(simulation, 50, 0, pixel)
        sonar = explained.sonar.place
        for each in explained.contributions:
            if each.source == "bed":
                middle = each.places.mean(axis=1)
                np.testing.assert_allclose(middle[:, 2], ground.height_at(middle[:, 0], middle[:, 1]), atol=0.02)
                distance = np.linalg.norm(middle - sonar, axis=1)
                assert (abs(distance - explained.slant_range) < 0.06).all()
            for ray in each.rays:
                np.testing.assert_allclose(ray[0], sonar)
                assert (ray[:, 1] > 0.0).sum() == len(ray) - 1  # port is +y


HIDING = {"kind": "pipe", "position": [10.0, 15.0], "radius": 1.0, "length": 20.0, "material": "steel"}
# Ground range at which the tangent over that pipe meets the bed.
HIDDEN_TO = 10.0 / math.tan(math.atan2(9.0, 15.0) - math.asin(1.0 / math.hypot(9.0, 15.0)))


def test_a_pipe_hides_the_bed_behind_it():
    simulation = flat(targets=[HIDING])
    explained = explain_pixel(simulation, 50, 0, int(10.0 * (math.hypot(HIDDEN_TO, 10.0) - 0.5)))
    assert explained.summary.startswith("in the shadow of pipe 1")
    assert explained.obstructions[0].hider == "pipe 1"
    assert explained.obstructions[0].share == pytest.approx(1.0)
    after = explain_pixel(simulation, 50, 0, int(10.0 * (math.hypot(HIDDEN_TO, 10.0) + 0.3)))
    assert not after.obstructions
    assert after.summary.startswith("bed, silt")
    without = explain_pixel(flat(), 50, 0, explained.bin)
    assert explained.unhidden == pytest.approx(without.level, abs=0.01)
    assert not find_listeners(simulation, np.array([10.0, 18.0, 0.0]), np.arange(30, 70))


def test_the_cross_section_parts_the_bed_into_heard_and_hidden():
    section = cut_cross_section(flat(targets=[HIDING], sonar__beam="knife"), 50, 0)
    heard = np.diff(section.visible[:, :, 0], axis=1).sum()
    hidden = section.hidden[:, :, 0]
    assert heard + np.diff(hidden, axis=1).sum() == pytest.approx(math.sqrt(40.0**2 - 10.0**2), abs=0.5)
    assert hidden.max() == pytest.approx(HIDDEN_TO, abs=0.05)
    ((name, face),) = section.targets
    assert name == "pipe 1"
    np.testing.assert_allclose(np.hypot(face[..., 0] - 15.0, face[..., 1] - 1.0), 1.0, atol=1e-6)
    assert not section.horizon.size


def test_a_crest_of_the_bed_hides_what_lies_behind_it(tmp_path):
    heights = np.full((200, 200), -30.0)
    heights[84:88] = -28.0  # a ridge along the track, 2 m high, 12.25 to 13.75 m abeam
    np.save(tmp_path / "ridge.npy", heights)
    bed = {"kind": "dem", "path": str(tmp_path / "ridge.npy")}
    track = {"track__start": [-10.0, -20.0], "track__altitude": None, "track__depth": 20.0}
    simulation = prepare(scene(seabed__relief=bed, seabed__spacing=0.5, targets=[], **track))
    explained = explain_pixel(simulation, 50, 0, 188)
    assert explained.summary == "in the shadow of a crest of the bed at 13.8 m"
    np.testing.assert_allclose(explained.obstructions[0].place, [0.0, -6.25, 1.96], atol=0.01)
    assert explained.unhidden > -100.0
    assert explained.value == 0.0


def test_the_water_column_is_named_and_pixels_outside_the_record_are_refused():
    simulation = flat()
    explained = explain_pixel(simulation, 10, 1, 60)
    assert explained.summary == "water column: the first echo comes from 10.0 m"
    assert explained.terms == ()
    assert explained.value == 0.0
    for where, said in (((-1, 0, 5), "^ping: -1"), ((1, 2, 5), "^side: 2"), ((1, 0, 400), "^bin")):
        with pytest.raises(SceneError, match=said):
            explain_pixel(simulation, *where)


@pytest.mark.usefixtures("fixed_model")
def test_ghosts_go_by_the_surface_take_as_long_as_they_are_recorded_and_are_among_the_pixels_of_a_target():
    simulation = prepared(SCENES["ghosts"] | {"sonar__range": 70.0, "sonar__bins": 700})
    found = set()
    for pixel in range(300, 700, 13):
        explained = explain_pixel(simulation, 50, 0, pixel)
        ghosts = [each for each in explained.contributions if each.path not in ("direct", "surface")]
        found |= {each.path for each in ghosts}
        for ray in (ray for each in ghosts if each.path == "surface_bottom" for ray in each.rays):
            one_way = 0.5 * np.linalg.norm(np.diff(ray, axis=0), axis=1).sum()
            assert ray[:, 2].max() == pytest.approx(simulation.arrays.water.surface)
            assert one_way == pytest.approx(explained.slant_range, abs=0.35)
    assert "surface_bottom" in found
    listeners = find_listeners(simulation, np.array([12.0, -13.6, 1.1]), np.arange(40, 80))
    assert {"direct", "surface_bottom"} <= {each.path for each in listeners}
    ghost = next(each for each in listeners if each.path == "surface_bottom" and each.ping == 60)
    sources = {(each.source, each.path) for each in explain_pixel(simulation, 60, 1, ghost.bin).contributions}
    assert ("sphere 2", "surface_bottom") in sources


@pytest.mark.usefixtures("fixed_model")
def test_bent_rays_come_down_where_the_bed_returns_the_sound():
    simulation = prepared(SCENES["bent"])
    explained = explain_pixel(simulation, 10, 0, 300)
    bed = explained.contributions[0]
    for ray in bed.rays:
        assert len(ray) > 10
        assert np.linalg.norm(ray[-1] - ray[-2]) < 0.05  # the ray by its launch angle ends at the place
    middle = bed.places.mean(axis=1)
    ground = simulation.ground.height_at(middle[:, 0], middle[:, 1])
    np.testing.assert_allclose(middle[:, 2], ground, atol=0.03)


@pytest.mark.usefixtures("fixed_model")
def test_crests_of_the_cross_section_have_horizons_that_touch_what_they_hide():
    section = cut_cross_section(prepared({"seabed__relief": ROUGH | {"rms": 0.8}, "targets": []}), 50, 1)
    assert len(section.horizon) > 3
    crest, end = section.horizon[:, 0], section.horizon[:, 1]
    height = section.sonar.place[2]
    slope = (crest[:, 1] - height) / crest[:, 0], (end[:, 1] - height) / end[:, 0]
    # The hidden bed ends where the ray over the crest comes down, or at the next crest or the end of the range.
    assert (slope[1] <= slope[0] + 1e-3).all()
    assert (end[:, 0] > crest[:, 0]).all()


@pytest.mark.usefixtures("fixed_model")
@pytest.mark.parametrize("name", ["knife", "fan", "gaussian", "bent", "oblique", "vertical beam"])
def test_a_place_is_heard_by_the_pixels_that_it_contributes_to(name):
    simulation = prepared(SCENES[name] | {"targets": []})
    explained = explain_pixel(simulation, 50, 0, 260)
    place = explained.contributions[0].places.mean(axis=(0, 1))
    listeners = find_listeners(simulation, place, np.arange(30, 70))
    assert (50, 0) in [(each.ping, each.side) for each in listeners]
    own = next(each for each in listeners if each.ping == 50)
    assert abs(own.bin - 260) <= 1
    for each in listeners:
        again = explain_pixel(simulation, each.ping, 0, each.bin)
        if again.contributions:
            near = abs(again.contributions[0].ground_range - explained.contributions[0].ground_range)
            assert near < 0.6


def test_the_command_prints_the_terms_and_their_sum(capsys):
    assert main(["explain", "pipe-span", "--ping", "150", "--side", "starboard", "--range", "30"]) == 0
    printed = capsys.readouterr().out.splitlines()
    numbers = {line[:22].strip(): float(line[22:32]) for line in printed[2:] if " dB" in line}
    pixel = numbers.pop("pixel")
    assert sum(numbers.values()) == pytest.approx(pixel, abs=0.05)
    assert printed[0].startswith("ping 150, starboard, 30.0")


def test_the_pixels_that_compile_kernels_lie_abeam_of_every_target(monkeypatch: pytest.MonkeyPatch) -> None:
    explained = []
    monkeypatch.setattr(compilation, "explain_pixel", lambda *at: explained.append(at[1:3]) or explain_pixel(*at))
    compilation.compile_explanations(prepare(scene(sonar__ping_rate=10.0)))
    pings = {0, *(round(target["position"][0] / 0.2) for target in (PIPE, BALL))}
    assert set(explained) == {(ping, side) for ping in pings for side in (0, 1)}
    compilation.compile_explanations(prepare(scene(targets=[])))  # there may be none
