"""Rays in water: diagrams, shadow zones, caustics and eigenrays against closed forms, and what is written of them."""

import csv
import math

import numpy as np
import pytest
from PIL import Image
from pydantic import TypeAdapter

import insonify
from insonify.acoustics.rays import follow_paths
from insonify.acoustics.water import make_water
from insonify.cli import main
from insonify.display.ray_diagram.figure import write_ray_diagram
from insonify.display.ray_diagram.tracing import CELLS, trace_ray_diagram
from insonify.kernels.refraction.ray_paths import RayLimits
from insonify.scene import SceneError, edit, load_scene
from insonify.scene.water import AnyWater

DUCT = {"kind": "profile", "depth": [0.0, 20.0, 40.0], "sound_speed": [1520.0, 1500.0, 1510.0]}
LIMIT = 346.9867  # m, of a bed 20 m below the sonar in 0.5 (m/s)/m


def scene_in(water, **changes):
    place = {"seabed.depth": 40.0, "track.altitude": 20.0, "sonar.range": 450.0, "sonar.ping_rate": 1.5}
    return edit(load_scene("default"), place | {"water": water} | changes)


@pytest.fixture(scope="module")
def diagram():
    return trace_ray_diagram(scene_in(DUCT), target=(400.0, 25.0))


def test_the_bed_is_dark_beyond_the_limiting_range_and_the_shadow_bounded_by_its_ray(diagram):
    ((begin, end),) = diagram.dark
    assert begin == pytest.approx(LIMIT, abs=0.01)
    assert end == 450.0
    # An arc of the radius c/g that touches the bed there.
    radius = 1510.0 / 0.5
    x = np.linspace(0.0, 450.0, diagram.shadow.shape[1])
    depth = 40.0 - (radius - np.sqrt(radius**2 - (x - LIMIT) ** 2))
    dark = diagram.shadow[CELLS // 2 :].sum(axis=0) * (40.0 / CELLS)
    beyond = x > LIMIT + 1.0
    assert np.abs(dark - (40.0 - depth))[beyond].max() < 2.0 * 40.0 / CELLS
    assert not diagram.shadow[CELLS // 2 :, x < LIMIT].any()


def test_rays_have_round_angles_and_end_at_the_ends_of_the_water_and_eigenrays_join_sonar_and_point(diagram):
    angles = [path.angle for path in diagram.rays]
    assert 0.0 in angles
    assert angles == sorted(angles)
    assert 20 < len(angles) <= 60
    for path in diagram.rays:
        assert (path.range[0], path.depth[0], path.time[0]) == (0.0, pytest.approx(20.0), 0.0)
        ends = (path.range[-1] - 450.0, path.depth[-1], path.depth[-1] - 40.0)
        assert min(map(abs, ends)) < 1e-9
        assert (np.diff(path.time) > 0.0).all()
    assert len(diagram.eigenrays) == 3
    for ray in diagram.eigenrays:
        assert (ray.range[-1], ray.depth[-1]) == (400.0, 25.0)
        # The last point is where the path leads by itself.
        slope = np.diff(ray.depth[-4:-1]) / np.diff(ray.range[-4:-1])
        assert ray.depth[-2] + slope[-1] * (400.0 - ray.range[-2]) == pytest.approx(25.0, abs=0.01)
        assert ray.slant_range == 1500.0 * ray.travel_time
        assert ray.travel_time < math.hypot(400.0, 5.0) / 1500.0
    angles = [ray.angle for ray in diagram.eigenrays]
    assert angles == sorted(angles)


def test_uniform_water_has_straight_rays_and_no_shadow():
    diagram = trace_ray_diagram(scene_in({"kind": "uniform"}), target=(100.0, 40.0))
    assert not diagram.shadow.any()
    assert diagram.dark.size == diagram.caustics.size == 0
    (ray,) = diagram.eigenrays
    assert ray.angle == pytest.approx(math.degrees(math.atan(0.2)))
    assert ray.slant_range == pytest.approx(math.hypot(100.0, 20.0))
    assert ray.level == pytest.approx(-20.0 * math.log10(ray.slant_range))


def test_a_shadow_opens_where_rays_part_at_the_fastest_depth():
    # Sound from above the fastest depth never comes right behind it: rays part there, up and down.
    fastest = {"kind": "profile", "depth": [0.0, 15.0, 40.0], "sound_speed": [1490.0, 1510.0, 1490.0]}
    diagram = trace_ray_diagram(scene_in(fastest, **{"track.altitude": 30.0}))
    x = np.linspace(0.0, 450.0, diagram.shadow.shape[1])
    cell = round(15.0 / 40.0 * CELLS)
    touches = math.sqrt(2.0 * 1510.0 * 5.0)  # about where the parting ray is level
    assert not diagram.shadow[cell, x < 0.9 * touches].any()
    assert diagram.shadow[cell, x > 1.2 * touches].all()


def test_caustics_are_where_neighbouring_rays_cross(diagram):
    water = make_water(scene_in(DUCT), -40.0)
    angles = np.linspace(-0.12, 0.12, 20_001)
    assert len(diagram.caustics) > 100
    for x, depth in diagram.caustics[np.argsort(diagram.caustics[:, 1])][-40::4]:
        points, _ = follow_paths(water, 20.0, angles, np.array([x]), RayLimits(x, 0.0, 40.0, False, False))
        depths = 40.0 - points.z[:, 0]
        turns = np.flatnonzero(np.diff(np.sign(np.diff(depths))) != 0)
        assert np.nanmin(np.abs(depths[turns + 1] - depth)) < 0.05
    one_way = {**DUCT, "sound_speed": [1500.0, 1510.0, 1520.0]}
    assert not trace_ray_diagram(scene_in(one_way)).caustics.size


def test_a_section_of_equal_profiles_is_that_profile(diagram):
    section = {**DUCT, "kind": "section", "distance": [0.0, 450.0], "sound_speed": [DUCT["sound_speed"]] * 2}
    other = trace_ray_diagram(scene_in(section), target=(400.0, 25.0))
    np.testing.assert_allclose(other.dark, diagram.dark, atol=0.02)
    assert (other.shadow != diagram.shadow).mean() < 1e-3
    times = ([ray.travel_time for ray in each.eigenrays] for each in (other, diagram))
    np.testing.assert_allclose(*times, rtol=1e-9)
    section = water(kind="section", distance=[-10, 70, 900], depth=LAYERED.depth, sound_speed=[LAYERED.sound_speed] * 3)
    for x, depth in ((80.0, 40.0), (300.0, 15.0), (30.0, 60.0)):
        ours, layered = (
            insonify.eigenrays(one, 5.0, x, depth, bottom=60.0, reflections=1) for one in (section, LAYERED)
        )
        assert ours.sizes == layered.sizes
        np.testing.assert_allclose(ours.angle, layered.angle, rtol=0, atol=1e-8)
        np.testing.assert_allclose(ours.time, layered.time, rtol=0, atol=1e-12)


def test_a_point_that_is_not_in_the_water_is_refused():
    for target in ((0.0, 10.0), (1e300, 10.0), (math.nan, 10.0), (-5.0, 10.0), (50.0, 41.0), (50.0, -1.0)):
        with pytest.raises(SceneError, match=r"target: .* is not in the water; give .* from 0 to 40 m"):
            trace_ray_diagram(scene_in(DUCT), target=target)


def test_the_table_holds_every_point_and_the_picture_shows_shadow_bed_and_eigenrays(diagram, tmp_path):
    write_ray_diagram(tmp_path / "rays.csv", diagram)
    with (tmp_path / "rays.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == sum(path.range.size for path in (*diagram.rays, *diagram.eigenrays))
    last = rows[-1]
    assert last["kind"] == "eigenray"
    assert (float(last["range"]), float(last["depth"])) == (400.0, 25.0)
    assert float(last["time"]) == pytest.approx(diagram.eigenrays[-1].travel_time, rel=1e-8)
    with pytest.raises(SceneError, match=r"end the name in \.png or \.csv"):
        write_ray_diagram(tmp_path / "rays.pdf", diagram)
    write_ray_diagram(tmp_path / "rays.png", diagram)
    picture = np.asarray(Image.open(tmp_path / "rays.png").convert("RGB")).astype(int)
    assert picture.shape[0] > 1000

    def share(colour, spread=12):
        return (np.abs(picture - np.array(colour)).max(axis=2) <= spread).mean()

    assert share((0xCB, 0xB6, 0x93)) > 0.02  # bed
    assert share((0xD1, 0x49, 0x5B)) > 5e-4  # first eigenray
    assert (picture.max(axis=2) < 140).mean() > 0.005  # shadow


def test_the_command_prints_the_eigenrays(tmp_path, capsys):
    out = tmp_path / "rays.csv"
    water = "water={kind='profile',depth=[0,20,40],sound_speed=[1520,1500,1510]}"
    settings = "sonar.range=400", "sonar.ping_rate=1", "track.altitude=10", water
    words = [word for setting in settings for word in ("--set", setting)]
    assert main(["rays", "default", "-o", str(out), "--target", "30", "25", *words]) == 0
    said = capsys.readouterr().out.splitlines()
    assert "slant range" in said[0]
    assert said[-1] == str(out)


def water(**fields):
    return TypeAdapter(AnyWater).validate_python(fields)


LAYERED = water(kind="profile", depth=[0, 10, 20, 60], sound_speed=[1520, 1520, 1500, 1498])


def test_a_hit_of_the_bed_is_a_rays_own_last_point():
    paths = insonify.ray_paths(LAYERED, 5.0, [2.0, 10.0, 60.0, -5.0, 90.0], max_range=500.0, bottom=60.0)
    assert paths.sizes["ray"] == 5
    hits = paths.hit.values
    np.testing.assert_array_equal(hits.sum(axis=1), [1, 1, 1, 0, 1])
    np.testing.assert_allclose(paths.range.values[hits], [475.430622, 239.228222, 31.281329, 0.0], atol=6e-7)
    np.testing.assert_allclose(paths.depth.values[hits], 60.0)
    np.testing.assert_allclose(paths.time.values[hits][:3], [0.3179804118, 0.1632912097, 0.0421014320], atol=6e-11)
    np.testing.assert_allclose(paths.tube.values[hits][:3], [863.1684, 211.6164, 62.3989], atol=6e-5)
    for row, k in zip(paths.depth.values, hits.argmax(axis=1)):
        assert k == 0 or np.isnan(row[k + 1 :]).all()
    assert list(paths.end.values) == ["bottom", "bottom", "bottom", "surface", "bottom"]


def test_points_lie_at_the_ranges_asked_for_and_uniform_water_bends_nothing_below_a_surface_that_reflects():
    paths = insonify.ray_paths(LAYERED, 5.0, 2.0, max_range=400.0, bottom=60.0, ranges=[0.0, 100.0, 333.0])
    np.testing.assert_array_equal(paths.range.values, [[0.0, 100.0, 333.0]])
    assert not paths.hit.any()
    assert paths.end.values[0] == "range"
    assert float(paths.grazing[0, 0]) == pytest.approx(2.0, abs=1e-12)
    paths = insonify.ray_paths(water(kind="uniform", sound_speed=1480.0), 3.0, [30.0], max_range=40.0)
    np.testing.assert_allclose(paths.depth[0], 3.0 + math.tan(math.radians(30.0)) * paths.range[0])
    np.testing.assert_allclose(paths.time[0] * 1480.0, paths.range[0] / math.cos(math.radians(30.0)))
    np.testing.assert_allclose(paths.tube[0], paths.range[0] / math.cos(math.radians(30.0)))
    calm = water(kind="uniform", sound_speed=1500.0, surface={"kind": "flat"})
    path = insonify.ray_paths(calm, 20.0, [-45.0], max_range=60.0, bottom=100.0, ranges=[20.0, 60.0]).isel(ray=0)
    np.testing.assert_allclose(path.depth.values, [0.0, 40.0], atol=1e-9)
    np.testing.assert_allclose(path.time.values[-1] * 1500.0, 60.0 * math.sqrt(2.0), rtol=1e-12)
    assert path.end == "range"


def test_eigenrays_are_told_by_launch_angle_with_their_intensity():
    even = water(kind="uniform", sound_speed=1500.0)
    rays = insonify.eigenrays(even, 30.0, 75.0, 50.0, bottom=50.0, reflections=2)
    expected = [math.hypot(75.0, height) for height in (20.0, 80.0, 120.0)]  # straight, by the surface, by both
    np.testing.assert_allclose(np.sort(rays.time * 1500.0), expected, rtol=1e-12)
    np.testing.assert_allclose(rays.intensity, (rays.time * 1500.0) ** -2.0, rtol=1e-9)
    assert (np.diff(rays.angle) > 0.0).all()
    assert sorted(zip(rays.by_surface.values.tolist(), rays.by_bottom.values.tolist())) == [(0, 0), (1, 0), (1, 1)]
    down = insonify.eigenrays(even, 10.0, 0.0, 40.0)  # one straight down spreads as any
    assert down.angle.values.tolist() == [90.0]
    assert float(down.intensity[0]) == pytest.approx(30.0**-2)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"angles": [[1.0, 2.0]]}, "angles: has 2 dimensions"),
        ({"angles": 95.0}, "angles: 95 must lie between -90 and 90 degrees"),
        ({"angles": [1.0, math.nan]}, "angles: nan"),
        ({"source_depth": -1.0}, "source_depth: -1"),
        ({"source_depth": 70.0}, "source_depth: 70 is not valid; the bed is at 60 m"),
        ({"bottom": 0.0}, "bottom: 0"),
        ({"max_range": 0.0}, "max_range: 0"),
        ({"max_range": math.inf}, "max_range: inf"),
        ({"ranges": [1.0, 101.0]}, "ranges: 101 must lie between 0 and max_range, 100 m"),
        ({"ranges": [1.0, 1.0]}, "ranges: must increase"),
    ],
)
def test_a_wrong_number_is_told_in_a_sentence(change, words):
    given = {"source_depth": 5.0, "angles": 10.0, "max_range": 100.0, "bottom": 60.0} | change
    with pytest.raises(SceneError, match=words):
        insonify.ray_paths(LAYERED, **given)
    with pytest.raises(SceneError, match="section"):  # which has no shadow zones
        insonify.shadow_zones(water(kind="section"), 5.0, 30.0, max_range=100.0)
