"""Every kind of water as kernels see it."""

import math

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from insonify.acoustics.water import (
    SoundSpeedField,
    make_sound_speed_field,
    make_water,
    recording_speed,
    speed_at_sonar,
)
from insonify.cli import main
from insonify.display.ray_diagram.tracing import trace_ray_diagram
from insonify.scene import SceneError, build, edit, load_scene, scene_from_toml, scene_to_toml
from insonify.scene.water.layered import HydrographyWater, ProfileWater, approximate_by_segments, thin_polyline
from insonify.scene.water.sound_speed import mackenzie
from insonify.simulation import prepare

DEPTHS, SPEEDS = (2.0, 8.0, 16.0, 60.0), (1520.0, 1519.0, 1501.0, 1500.0)


def scene_in(water, **changes):
    return edit(load_scene("figure-4a"), {"seabed.depth": 30.0, "water": water, **changes})


def profile(**changes):
    return {"kind": "profile", "depth": DEPTHS, "sound_speed": SPEEDS, **changes}


def test_heights_count_from_the_mean_bed_up_to_the_surface_and_the_reference_is_the_speed_at_the_sonar():
    water = make_water(scene_in(profile()), -30.0)
    assert (water.bent, water.surface, water.station.size) == (True, 30.0, 1)
    np.testing.assert_array_equal(water.height, [-30.0, 14.0, 22.0, 28.0])
    np.testing.assert_array_equal(water.speed, [[1500.0, 1501.0, 1519.0, 1520.0]])
    water = make_water(scene_in(profile(depth=[0.0, 8.0, 16.0, 60.0])), -30.0, -0.5)
    np.testing.assert_array_equal(water.height, [-0.5, 14.0, 22.0, 30.0])
    assert water.speed[0, 0] == np.interp(30.5, (16.0, 60.0), (1501.0, 1500.0))
    deep = make_water(scene_in(profile(depth=[40.0, 50.0, 60.0, 70.0])), -30.0, -0.5)
    assert (deep.bent, deep.reference) == (False, SPEEDS[0])
    scene = scene_in(profile(), **{"track.altitude": 18.0})
    assert make_water(scene, -30.0).reference == speed_at_sonar(scene) == np.interp(12.0, DEPTHS, SPEEDS)
    deep = edit(scene, {"track.altitude": None, "track.depth": 7.0})
    assert make_water(deep, -30.0).reference == np.interp(7.0, DEPTHS, SPEEDS)
    # A measured bed has a mean depth of its own.
    assert make_water(scene, -22.0).reference == np.interp(4.0, DEPTHS, SPEEDS)
    assert recording_speed(scene) == speed_at_sonar(scene)
    assert recording_speed(edit(scene, {"water.reference_speed": 1490.0})) == 1490.0


EVEN = {"kind": "profile", "depth": [0.0, 20.0], "sound_speed": [1480.0, 1480.0]}


def test_water_of_one_speed_bends_nothing_gives_the_same_record_and_leaves_echoes_their_time():
    section = {"kind": "section", "distance": [0.0, 9.0], "depth": [0.0, 20.0], "sound_speed": [[1480.0] * 2] * 2}
    for water in (EVEN, EVEN | {"interpolation": "pchip"}, section, {"kind": "uniform", "sound_speed": 1480.0}):
        made = make_water(scene_in(water), -30.0)
        assert (made.bent, made.reference) == (False, 1480.0), water
    records = [prepare(scene_in(water)).intensity(np.arange(2)) for water in (EVEN, {"sound_speed": 1480.0})]
    np.testing.assert_array_equal(*records)
    with pytest.raises(SceneError, match=r"sonar.ping_rate 15 Hz .* lower it to 14.8 Hz"):
        prepare(scene_in(EVEN, **{"sonar.ping_rate": 15.0, "sonar.range": 50.0}))


def test_a_smooth_profile_is_followed_never_overshoots_and_keeps_travel_times():
    layers = make_sound_speed_field(ProfileWater(depth=DEPTHS, sound_speed=SPEEDS, interpolation="pchip"))
    curve = PchipInterpolator(DEPTHS, SPEEDS)
    depth = np.linspace(0.0, 70.0, 20_001)
    speed = layers.speed_at(0.0, 0.0, depth)
    assert np.abs(speed - curve(np.clip(depth, DEPTHS[0], DEPTHS[-1]))).max() < 2e-3
    assert layers.depth.size < 150
    assert speed.min() >= 1500.0 - 1e-9
    assert speed.max() <= 1520.0 + 1e-9
    for angle in (0.0, 60.0, 80.0):
        # A straight way of 100 m, its depths about the thermocline.
        depth = np.linspace(5.0, 5.0 + 100.0 * np.cos(np.radians(angle)), 200_001)
        speeds = curve(np.clip(depth, DEPTHS[0], DEPTHS[-1])), layers.speed_at(0.0, 0.0, depth)
        times = [100.0 * np.trapezoid(1.0 / speed, dx=1.0 / 200_000) for speed in speeds]
        assert abs(times[0] - times[1]) < 1e-7


def test_hydrography_is_an_equation_of_straight_temperature_and_salinity():
    declared = HydrographyWater(depth=(0.0, 20.0, 50.0), temperature=(20.0, 8.0, 7.0), salinity=(34.0, 35.0, 35.0))
    water = declared.model_copy(update={"equation": "mackenzie"})
    depth = np.linspace(0.0, 50.0, 5001)
    temperature = np.interp(depth, declared.depth, declared.temperature)
    salinity = np.interp(depth, declared.depth, declared.salinity)
    speed = make_sound_speed_field(water).speed_at(0.0, 0.0, depth)
    assert np.abs(speed - mackenzie(temperature, salinity, depth)).max() < 2e-3
    # The speed curves between two depths; a straight line between their speeds would not do.
    assert abs(speed[1000] - 0.5 * (speed[0] + speed[2000])) > 1.5


def test_a_section_is_straight_between_its_profiles_and_even_beyond():
    speeds = [[1500.0, 1500.0], [1500.0, 1540.0], [1530.0, 1500.0]]
    section = {"kind": "section", "distance": [-10.0, 0.0, 30.0], "depth": [0.0, 40.0], "sound_speed": speeds}
    scene = scene_in(section | {"heading": 90.0})
    layers = make_sound_speed_field(scene.water)
    places = [(0.0, -99.0, 20.0), (7.0, -5.0, 40.0), (-3.0, 0.0, 40.0), (0.0, 15.0, 10.0), (0.0, 99.0, 80.0)]
    # The fourth lies above the diagonal from (0 m, top) to (30 m, bottom), along which nothing changes.
    expected = [1500.0, 1520.0, 1540.0, 1530.0 - 0.5 * 30.0 - 0.25 * 30.0, 1500.0]
    np.testing.assert_allclose(layers.speed_at(*np.array(places).T), expected, rtol=1e-12)
    assert layers.speed_at(0.0, 15.0, 10.0) == pytest.approx(expected[3])
    water = make_water(scene, -30.0)
    np.testing.assert_allclose([water.axis_x, water.axis_y], [0.0, 1.0], atol=1e-15)
    np.testing.assert_array_equal(water.station, section["distance"])
    found = [np.interp(10.0, water.height, speed) for speed in water.speed]
    np.testing.assert_allclose(found, [1500.0, 1520.0, 1515.0])


def test_a_section_is_the_same_water_over_every_bed():
    # Cells whose diagonal a point at the bed would turn: the speeds change crosswise.
    speeds = np.random.default_rng(5).uniform(1485.0, 1515.0, (4, 4)).tolist()
    section = {"kind": "section", "distance": [-15.0, 5.0, 25.0, 70.0], "depth": [3.0, 12.0, 30.0, 75.0]}
    scene = scene_in(section | {"sound_speed": speeds, "heading": 90.0})
    declared, rng = make_sound_speed_field(scene.water), np.random.default_rng(6)
    for depth in (2.0, 7.0, 12.0, 21.0, 30.0, 44.0, 75.0, 90.0):
        water = make_water(scene, -depth, 0.0)
        packed = SoundSpeedField(depth - water.height[::-1], water.station, water.speed[:, ::-1], math.radians(90.0))
        places = 0.0, rng.uniform(-30.0, 90.0, 500), rng.uniform(0.0, depth, 500)
        np.testing.assert_allclose(packed.speed_at(*places), declared.speed_at(*places), rtol=1e-12)
    # A ball over black beds: one echo, where an eigenray of the declared water leads.
    black, ball = {"diffuse": 0.0, "specular": 0.0}, {"kind": "sphere", "radius": 0.1, "position": [0.0, 60.0, -35.0]}
    setup = {"track.altitude": None, "track.depth": 15.0, "track.pings": 1, "track.start": [0.0, 0.0]}
    setup |= {"sonar.range": 70.0, "sonar.bins": 7000, "sonar.ping_rate": 1.0, "sonar.pulse": "ideal"}
    setup |= {"sonar.beam": {"kind": "fan", "width": 1.0}, "targets": [ball], "seabed.material": black}
    records = []
    for depth in (37.0, 46.0, 55.0):
        simulation = prepare(edit(scene, setup | {"seabed.depth": depth}), method="rays", forced={"rays": "256000"})
        records.append(simulation.intensity(np.arange(1))[0, 0])
        (ray,) = trace_ray_diagram(simulation.scene, target=(60.0, 35.0)).eigenrays
        first = np.flatnonzero(records[-1])[0] * 0.01
        assert first == pytest.approx(ray.slant_range - 0.1, abs=0.011), depth
    sums = [record.sum() for record in records]
    np.testing.assert_allclose(sums, sums[0], rtol=0.02)  # of some hundred rays that meet the ball


def test_polylines_keep_within_their_tolerance_and_drop_what_is_straight():
    x = np.linspace(0.0, 10.0, 1001)
    y = np.abs(x - 4.0) + 0.01 * np.sin(40.0 * x)
    kept = thin_polyline(x, y, 0.02)
    assert np.abs(np.interp(x, x[kept], y[kept]) - y).max() <= 0.02
    assert kept.size <= 5
    assert thin_polyline(x, 3.0 * x, 1e-9).tolist() == [0, 1000]
    places, values = approximate_by_segments(np.sin, np.array([0.0, 1.0, 7.0]), 1e-3)
    x = np.linspace(0.0, 7.0, 100_001)  # between the samples too
    assert np.abs(np.interp(x, places, values) - np.sin(x)).max() < 1e-3
    assert places.size < 90


def test_a_change_of_kind_takes_over_whole_tables_or_none():
    scene = scene_in({"kind": "uniform", "sound_speed": 1480.0, "absorption": 40.0})
    for kind in ("profile", "section", "hydrography", "profile", "uniform"):
        scene = edit(scene, {"water.kind": kind})
        assert scene.water == build({"water": {"kind": kind, "absorption": 40.0}}).water
        assert scene_from_toml(scene_to_toml(scene)) == scene
    # Fields of a new kind can be given with it.
    changes = {"water.depth": [0.0, 20.0], "water.sound_speed": [1510.0, 1500.0], "water.kind": "profile"}
    expected = ProfileWater(depth=(0.0, 20.0), sound_speed=(1510.0, 1500.0))
    assert edit(load_scene("default"), changes).water == expected


WARM = {"kind": "hydrography", "temperature": [31.0, 18.0, 11.0, 10.0], "equation": "mackenzie"}


@pytest.mark.parametrize(
    ("water", "told"),
    [
        (WARM, "temperature 31 °C"),
        ({"kind": "hydrography", "salinity": 20.0, "equation": "mackenzie"}, "salinity 20 "),
        ({"kind": "hydrography", "depth": [0.0, 5.0, 9.0, 1200.0], "equation": "paper"}, "depth 1200 m"),
        ({"kind": "uniform", "absorption": {"kind": "francois_garrison", "temperature": -2.0}}, "temperature -2 °C"),
        ({"kind": "uniform", "absorption": {"kind": "francois_garrison", "salinity": 8.0}}, "salinity 8 "),
        ({"kind": "uniform", "surface": {"kind": "rough", "wind_speed": 18.0}}, "wind 18 m/s"),
    ],
)
def test_values_outside_the_range_of_a_formula_are_described(water, told):
    scene = scene_in(water)
    (sentence,) = scene.describe_limits()
    assert sentence.startswith(told)
    assert " is outside the range of " in sentence
    assert trace_ray_diagram(scene).limits == (sentence,)


def test_a_frequency_outside_the_range_of_a_formula_is_described(capsys):
    sea = {"receiver.source_level": 220.0, "receiver.noise": {"kind": "sea", "wind": 15.0}}
    absorbing = {"water.absorption": "francois_garrison"}
    for changes, frequency, formulas in (
        (absorbing, 400e3, []),
        (absorbing, 1.2e6, ["Francois and Garrison"]),
        (sea, 90e3, []),
        (sea, 110e3, ["wind by Wenz"]),
        (sea, 400e3, []),  # the water's thermal noise is louder
    ):
        told = list(edit(load_scene("figure-4a"), {"sonar.frequency": frequency, **changes}).describe_limits())
        assert len(told) == len(formulas)
        assert all(formula in sentence for formula, sentence in zip(formulas, told))
    for command in ("plan", "budget"):
        words = ["--set", "sonar.frequency=1.2e6", "--set", "water.absorption=francois_garrison"]
        assert main([command, "figure-4a", *words]) == 0
        assert "Francois and Garrison, 0.4 to 1000 kHz" in capsys.readouterr().out
