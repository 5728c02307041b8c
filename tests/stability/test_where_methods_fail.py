"""Where methods of this kind are known to fail: each test is a trigger and the right behaviour."""

import ast
import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import insonify
from beds import arrays_of, poses_of, rough
from insonify import kernels
from insonify.accuracy.stability.themes.water import exact_time
from insonify.acoustics.paths import eigenrays
from insonify.acoustics.rays import follow_paths, join_points
from insonify.compiler.jit import FAST
from insonify.kernels.common.types import BED, LIGHT, SONAR
from insonify.kernels.refraction.arcs import ENDLESS, GRAZING, HIGH, LOW, NODE, RANGE
from insonify.kernels.refraction.eigenray_search import ANGLE
from insonify.kernels.refraction.eigenrays import FOUND, NONE
from insonify.kernels.refraction.ray_paths import AT_RANGE, NOWHERE, TRAPPED, RayLimits
from insonify.scene import edit, load_scene
from insonify.scene.water.layered import ProfileWater
from insonify.simulation import simulate
from insonify.tracers import rays, sweep
from water import NO_CEILING, NO_FLOOR, downward, followed, joined, layers, shot, stepped, water_of

FAN = math.radians(1.25)
flat = partial(arrays_of, np.zeros((4, 4)), 0.1, periodic=True)


def test_range_factors_come_after_the_sum():
    arrays, poses = flat(bins=3000, spreading=True, half_width=FAN), poses_of(1.0, 1.0, 5.0)
    bare = arrays._replace(range_factor=np.ones(3000))  # weighed within bins all the same
    ours = sweep.trace(arrays, poses)[0, 0].astype(float)
    np.testing.assert_allclose(ours, sweep.trace(bare, poses)[0, 0] * arrays.range_factor, rtol=3e-7)


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_what_nothing_touches_is_exactly_zero_and_nothing_is_negative(law, half_width):
    solids = [((k * 3.0, 9.0 + 2.0 * k, 0.8), 0.7) for k in range(8)] + [((-40.0, 20.0, 4.0), (60.0, 20.0, 4.0), 1.5)]
    options = {"law": law, "half_width": half_width, "solids": solids, "spreading": law == SONAR}
    arrays = arrays_of(rough(256, 256, 0.4), 0.2, periodic=True, bins=2000, **options)
    record = sweep.trace(arrays, poses_of(np.arange(40) * 0.6, 0.3, 6.0))
    assert (record >= 0.0).all()
    assert np.isfinite(record).all()
    assert not record[:, :, : int(4.0 / 0.05)].any()
    # Between echoes there are silent bins, and many of them.
    assert (record[:, 0, 400:] == 0.0).mean() > 0.05


@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_large_coordinates_give_the_record_of_the_same_bed_moved(half_width):
    heights = rough(200, 200, 0.1)
    records = []
    for east, north in ((0.0, 0.0), (1e6, 4e6)):
        ball = ((east + 20.0, north + 30.0, 0.8), 0.7)
        arrays = arrays_of(heights, 0.25, x0=east, y0=north, bins=300, half_width=half_width, solids=[ball])
        records.append(sweep.trace(arrays, poses_of(east + np.arange(20.0, 24.0), north + 20.3, 5.0, 0.1)))
    assert np.linalg.norm(records[1].astype(float) - records[0]) < 1e-3 * np.linalg.norm(records[0])


@pytest.mark.parametrize("method", ["sweep", "rays"])
def test_a_track_that_starts_far_away_on_a_bed_without_end(method):
    changes = {"track.pings": 3, "targets": [], "sonar.beam": "knife", "sonar.pulse": "ideal", "sonar.bins": 300}
    places = ([0.7, 0.3], [0.7 + 102.4 * 10_000, 0.3])  # whole periods apart
    scenes = (edit(load_scene("default"), changes | {"track.start": place}) for place in places)
    near, far = (simulate(scene, method=method).intensity.values for scene in scenes)
    assert np.linalg.norm(far - near) < (1e-3 if method == "sweep" else 0.02) * np.linalg.norm(near)


def test_rays_at_nodes_and_edges_leak_nowhere():
    arrays = arrays_of(rough(32, 32, 0.3), 0.5, periodic=True)
    z = arrays.bed.heights.astype(float)
    origin = np.array([4.1, 6.3, 9.0])
    nodes = [(i * 0.5, j * 0.5, z[j, i]) for i in range(32) for j in range(32)]
    edges = [(i * 0.5 + 0.25, j * 0.5, 0.5 * (z[j, i] + z[j, (i + 1) % 32])) for i in range(32) for j in range(32)]
    directions = np.array(nodes + edges) - origin
    distance, what, _ = rays.cast(arrays, origin, directions)
    assert (what == BED).all()
    assert (distance <= np.linalg.norm(directions, axis=1) + 1e-5).all()


def test_bodies_that_touch_are_heard_once():
    # Two halves of one pipe, end to end, and one on top of itself: as loud as the pipe alone.
    poses = poses_of(np.linspace(-2.0, 2.0, 21), 0.0, 8.0)
    pipe, left, right = (((a, 12.0, 0.5), (b, 12.0, 0.5), 0.5) for a, b in ((-5.0, 5.0), (-5.0, 0.0), (0.0, 5.0)))
    scenes = (flat(solids=solids, half_width=FAN) for solids in ([pipe], [left, right], [pipe, pipe]))
    whole, *others = (sweep.trace(scene, poses) for scene in scenes)
    for other in others:
        assert np.linalg.norm(other - whole) < 2e-3 * np.linalg.norm(whole)


def test_a_body_sunk_into_the_bed_is_heard_by_its_top():
    # Half a ball: the bed hides its lower half, and a ball wholly beneath hides nothing.
    bodies = [((0.0, 20.0, 0.0), 1.0)], [((0.0, 20.0, -1.5), 1.0)], []
    scenes = (flat(solids=solids, bins=4000, bin_length=0.01) for solids in bodies)
    half, sunk, bare = (sweep.trace(scene, poses_of(0.0, 0.0, 10.0))[0, 0].astype(float) for scene in scenes)
    np.testing.assert_allclose(sunk, bare, rtol=0.02, atol=1e-4 * bare.max())
    assert sunk.sum() == pytest.approx(bare.sum(), rel=1e-4)
    reach = math.hypot(20.0, 10.0)
    # Its nearest point is above the bed, and its shadow ends with the ray over its top.
    changed = np.flatnonzero(abs(half - bare) > 0.05 * bare[1900:2300].max())
    assert changed[0] * 0.01 == pytest.approx(reach - 1.0, abs=0.02)
    ends = 10.0 / math.sin(math.atan2(10.0, 20.0) - math.asin(1.0 / reach))
    silent = np.flatnonzero(half[1100:] == 0.0) + 1100
    assert (silent[-1] + 1) * 0.01 == pytest.approx(ends, abs=0.011)


@pytest.mark.parametrize("half_width", [0.0, FAN])
@pytest.mark.parametrize("height", [0.5, 4.0])
def test_a_body_beneath_the_sonar_hides_nadir_on_both_sides(half_width, height):
    arrays = flat(solids=[((0.0, 0.0, height), 0.5)], half_width=half_width)
    port, starboard = sweep.trace(arrays, poses_of(0.0, 0.0, 8.0))[0].astype(float)
    np.testing.assert_allclose(port, starboard, rtol=1e-4, atol=1e-6 * port.max())
    assert np.flatnonzero(port)[0] == pytest.approx((7.5 - height) / 0.05, abs=1.001)
    # The bed begins where the ray past the body lands.
    if not half_width:
        lands = 8.0 / math.cos(math.asin(0.5 / (8.0 - height)))
        assert not port[math.ceil((8.0 - height) / 0.05) + 1 : int(lands / 0.05) - 1].any()
        assert port[int(lands / 0.05) + 1] > 0.0


@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_a_body_out_of_the_beam_or_range_changes_nothing_and_one_across_its_end_is_cut(half_width):
    balls = [[((x, y, 1.0), 1.0)] for x, y in ((0.0, -12.0), (12.0, 0.0), (0.0, 25.0), (0.0, 19.7))]
    scenes = (flat(half_width=half_width, bins=400, solids=solids) for solids in ([], *balls))
    bare, behind, ahead, beyond, across = (sweep.trace(scene, poses_of(0.0, 0.0, 8.0))[0] for scene in scenes)
    np.testing.assert_array_equal(behind[0], bare[0])
    assert not np.array_equal(behind[1], bare[1])
    np.testing.assert_array_equal(ahead, bare)
    np.testing.assert_array_equal(beyond, bare)
    assert across[0, -1] > 2.0 * bare[0, -1]


@pytest.mark.parametrize("altitude", [1e-3, 0.02, 1000.0])
@pytest.mark.parametrize("half_width", [0.0, 1e-3, math.radians(30.0)])
def test_a_fish_on_the_bed_or_far_above_it_makes_numbers(altitude, half_width):
    record = sweep.trace(flat(half_width=half_width, spreading=True), poses_of(0.03, 0.04, altitude))
    assert np.isfinite(record).all()
    assert (record >= 0.0).all()
    assert record.any() == (altitude < 50.0)


def test_kernels_raise_nothing_and_leave_threads_to_others():
    # Inside a parallel kernel an exception is swallowed and its result half filled.
    for source in sorted(Path(kernels.__file__).parent.rglob("*.py")):
        tree = ast.parse(source.read_text(encoding="utf-8"))
        assert not [node for node in ast.walk(tree) if isinstance(node, ast.Raise)], source.name
        assert "prange" not in {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}, source.name
    assert not FAST & {"nnan", "ninf", "fast"}, "guards against NaN"


@pytest.mark.parametrize("g", [0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-8])
def test_a_gradient_of_next_to_nothing_bends_next_to_nothing_and_two_points_are_joined(g):
    water, x = layers([0.0, 30.0, 100.0], [1500.0, 1500.0 + 30.0 * g, 1500.0 + 100.0 * g]), 9.0
    for degrees in (-80.0, -5.0, 0.0, 1e-7, 5.0, 60.0):
        angle = math.radians(degrees)
        status, ray = shot(water, 50.0, degrees, x_end=x)
        assert status == RANGE
        # The sagitta, which is there.
        bend = g * x**2 / (2.0 * 1500.0 * math.cos(angle) ** 2)
        length = x / math.cos(angle)
        assert -ray.z == pytest.approx(50.0 + x * math.tan(angle) - bend, abs=1e-9), degrees
        assert ray.time == pytest.approx(length / 1500.0, abs=1e-12 + g), degrees
        assert ray.q == pytest.approx(length, abs=1e-9 + 1e6 * g), degrees
    status, _, angle = joined(water, 50.0, 100.0, 70.0)
    assert status == FOUND
    assert angle == pytest.approx(math.degrees(math.atan2(20.0, 100.0)), abs=1e-8 + 1e3 * g)
    assert len(join_points(water_of(*water), -50.0, -70.0, 100.0, -100.0, 0.0, 0)) == 1


@pytest.mark.parametrize("water", [layers([0, 30, 60], [1520, 1490, 1510]), layers([0, 60], [1500, 1500])])
def test_a_vertical_ray_stays_at_range_0(water):
    status, ray = shot(water, 5.0, 90.0, bottom=60.0)
    height, speed = water
    assert status == LOW
    assert abs(ray.x) < 1e-12
    pieces = np.union1d(height[(height > -60.0) & (height < -5.0)], [-60.0, -5.0])
    ends = np.interp(pieces, height, speed)
    rates = np.diff(ends) / np.diff(pieces)
    slow = [math.log(b / a) / g if g else dz / a for a, b, g, dz in zip(ends, ends[1:], rates, np.diff(pieces))]
    assert ray.time == pytest.approx(sum(slow), rel=1e-13)
    status, plumb, _ = joined(water, 5.0, 0.0, 60.0)
    assert (status, plumb.cosine0, plumb.sine0) == (FOUND, 0.0, -1.0)
    assert plumb.time == pytest.approx(ray.time, rel=1e-14)


def test_a_vertical_ray_gets_down_along_a_station_and_ends_where_nothing_or_two_mirrors_stop_it():
    speed = [[1500.0, 1500.0], [1510.0, 1510.0], [1500.0, 1500.0]]
    for start in ((0.0, 50.0, 90.0), (-50.0, 0.0, 90.0), (-90.0, -50.0, 0.0)):
        points, ends = followed(water_of([-60.0, 0.0], speed, start), 5.0, 90.0, [10.0], bottom=60.0)
        assert ends[0] in (1, AT_RANGE)
        assert np.isfinite(points.time[0, 0])
    points, ends = followed(water_of(*layers([0, 30], [1530, 1500])), 10.0, 90.0, [0.0, 100.0])
    assert ends[0] == NOWHERE
    assert np.isfinite(points.x[0]).sum() == 1
    between, mirrored = water_of(*layers([0, 60], [1500, 1510])), RayLimits(100.0, -60.0, 0.0, True, True)
    _, ends = follow_paths(between, -20.0, np.radians([90.0, 80.0]), np.array([50.0]), mirrored)
    assert list(ends) == [TRAPPED, AT_RANGE]


# Speeds at 0, 20 and 40 m; the source is level on the node at 20 m.
@pytest.mark.parametrize(
    ("speeds", "sides"),
    [
        ((1510, 1500, 1490), [1.0]),  # faster above: down
        ((1490, 1500, 1510), [-1.0]),  # slower above: up
        ((1510, 1500, 1510), [0.0]),  # slowest here: along
        ((1500, 1500, 1510), [0.0]),  # even above, faster below: along
        ((1500, 1500, 1490), [1.0]),
        ((1490, 1500, 1500), [-1.0]),
        ((1490, 1500, 1490), [-1.0, 1.0]),  # fastest here: to one side, and it keeps to it
    ],
)
def test_a_level_ray_on_a_node_takes_the_side_it_bends_to(speeds, sides):
    status, ray = shot(layers([0, 20, 40], speeds), 20.0, 0.0, x_end=50.0)
    assert status == RANGE
    bent = 0.5 * 50.0**2 / (2.0 * 1500.0)
    assert min(abs(-ray.z - 20.0 - side * bent) for side in sides) < 1e-3
    assert ray.z == -20.0 or 0.0 not in sides


CRITICAL = math.degrees(math.acos(1500.0 / 1510.0))


@pytest.mark.parametrize("above", [0.0, 0.5, -0.5])
@pytest.mark.parametrize("off", [0.0, 1e-16, -1e-16, 1e-13, -1e-13, 1e-10, -1e-10, 1e-8])
def test_a_ray_whose_vertex_is_on_a_node_turns_or_goes_on_but_is_never_lost(above, off):
    """Launched so that it is level at 20 m, or as good as."""
    water = layers([0, 20, 40], [1510 + 20 * above, 1510, 1500])
    status, ray = shot(water, 40.0, -CRITICAL + off, x_end=400.0)
    assert status == RANGE
    assert all(map(math.isfinite, (ray.z, ray.time, ray.p, ray.q, ray.sine)))
    assert ray.cosine**2 + ray.sine**2 == pytest.approx(1.0, abs=1e-12)
    if above > 0.0:
        # Down again as it came, whether it has looked over the node or not.
        _, back = shot(water, 40.0, -CRITICAL + off, x_end=2.0 * 1500.0 * math.tan(math.radians(CRITICAL)) / 0.5)
        assert -back.z == pytest.approx(40.0, abs=1e-2)


def test_a_trapped_ray_ends():
    water, degrees = water_of(*layers([0, 30, 60], [1530, 1500, 1530])), np.array([0.0, 1e-9, 1e-3, 1.0, 5.0])
    points, ends = followed(water, 30.0, degrees, [0.0, 1e3, 1e5])
    assert ((ends == AT_RANGE) | (ends == TRAPPED) & np.isin(degrees, [1e-9, 1e-3])).all()
    assert np.isfinite(points.z[:, 0]).all()
    for x, least in ((500.0, 0), (100.0, 50)):  # rays without end, of which some are found
        found = join_points(water, -30.0, -30.0, x, -60.0, 0.0, 0)
        assert len(found) > least
        assert np.isfinite(found).all()
        assert (np.diff(found[:, ANGLE]) >= 0.0).all()


@pytest.mark.parametrize("degrees", [-30.0, -2.0, 2.0, 30.0])
@pytest.mark.parametrize("off", [0.0, 1e-15, -1e-15, 1e-12, -1e-12, 9e-10, -9e-10, 2e-9, -2e-9])
def test_a_source_next_to_a_node_is_a_source_on_it(degrees, off):
    water = layers([0, 20, 40], [1520, 1500, 1510])
    _, there = shot(water, 20.0, degrees, x_end=30.0)
    _, ray = shot(water, 20.0 + off, degrees, x_end=30.0)
    assert ray.z == pytest.approx(there.z, abs=1e-8)
    assert ray.time == pytest.approx(there.time, abs=1e-12)
    assert ray.q == pytest.approx(there.q, abs=1e-6)


@pytest.mark.parametrize("degrees", [-12.0, -3.0, 1.0, 20.0])
def test_a_ray_stopped_anywhere_goes_on_as_if_it_had_not_been(degrees):
    """Stops come to lie on nodes too, and within rounding of them."""
    water = layers([0, 12, 20, 33, 60], [1520, 1515, 1500, 1503, 1498])
    _, whole = shot(water, 20.0, degrees, x_end=180.0, bottom=60.0)
    stops, (status, ray) = list(np.linspace(1.0, 179.0, 200)), (NODE, downward(water, 20.0, degrees))
    while status == NODE:
        status, ray = stepped(*water, ray, 180.0, -60.0, NO_CEILING)
        stops += [ray.x + off for off in (-1e-11, 0.0, 1e-11) if status == NODE]
    ray = downward(water, 20.0, degrees)
    for x in [*sorted(stops), 180.0]:
        status = NODE
        while status == NODE:
            status, ray = stepped(*water, ray, x, -60.0, NO_CEILING)
    assert status in (RANGE, LOW)
    assert ray.z == pytest.approx(whole.z, abs=1e-8)
    assert ray.q == pytest.approx(whole.q, rel=1e-6)


def test_a_tube_at_a_jump_of_the_gradient_met_flatly_is_capped_and_said_to_be():
    water, offs = layers([0, 20, 40], [1530, 1510, 1500]), [*np.linspace(-3e-13, 3e-13, 201), 1e-3, -1e-3]
    met = [shot(water, 40.0, -CRITICAL + off, x_end=600.0)[1] for off in offs]
    assert all(math.isfinite(ray.q) and abs(ray.p) <= 1.0 / GRAZING for ray in met)
    assert any(ray.grazed for ray in met[:201])
    assert not any(ray.grazed for ray in met[201:])


def test_in_a_shadow_zone_there_is_no_ray():
    water = water_of(*layers([0, 40], [1500, 1480]))
    assert len(join_points(water, -10.0, -40.0, 800.0, -40.0, 0.0, 0)) == 0
    assert len(join_points(water, -10.0, -5.0, 740.0, -40.0, 0.0, 0)) == 0
    # Sound is fastest at 20 m and parts there: nothing comes to what lies level with the source but far.
    parted = layers([0, 20, 40], [1480, 1500, 1480])
    assert joined(parted, 19.0, 500.0, 21.0)[0] == NONE
    assert len(join_points(water_of(*parted), -19.0, -21.0, 500.0, NO_FLOOR, NO_CEILING, 0)) == 0


def test_outside_the_profile_speed_stays_what_it_is_at_its_ends():
    water = layers([20, 40], [1510, 1490])
    status, ray = shot(water, 5.0, -45.0, x_end=1000.0)
    assert (status, ray.speed) == (RANGE, 1510.0)
    assert ray.z == pytest.approx(995.0)
    status, ray = shot(water, 5.0, 45.0, bottom=9000.0)
    assert (status, ray.speed) == (LOW, 1490.0)
    assert shot(water, 5.0, -90.0)[0] == ENDLESS
    assert shot(water, 5.0, -90.0, surface=0.0)[0] == HIGH


@pytest.mark.parametrize("interpolation", ["linear", "pchip"])
def test_a_steep_thermocline_keeps_speeds_and_rays_in_bounds(interpolation):
    depth, speed = (0.0, 10.0, 10.2, 10.4, 60.0), (1530.0, 1530.0, 1512.0, 1500.0, 1500.0)
    water = ProfileWater(depth=depth, sound_speed=speed, interpolation=interpolation)
    angles = np.linspace(-89.0, 89.0, 357)
    paths = insonify.ray_paths(water, 20.0, angles, max_range=400.0, bottom=60.0)
    there = np.isfinite(paths.range.values)
    assert not (paths.end == "trapped").any()
    assert (paths.depth.values[there] >= -1e-9).all()
    # Snell's constant: a ray that comes back to its depth has its angle again.
    ray, point = np.nonzero(paths.depth.values > 10.4)
    grazing, launch = paths.grazing.values[ray, point], paths.angle.values[ray]
    np.testing.assert_allclose(np.cos(np.radians(grazing)), np.cos(np.radians(launch)), rtol=1e-9)
    rays = insonify.eigenrays(water, 20.0, 150.0, 25.0, bottom=60.0)
    assert rays.sizes["eigenray"] >= 1
    assert (rays.time * 1500.0 > 150.0).all()


@pytest.mark.parametrize(("depth", "to"), [(4000.0, 4100.0), (10.0, 110.0), (4100.0, 4000.0), (2000.0, 2000.0)])
def test_one_ray_comes_however_near_to_its_vertex(depth, to):
    water = ProfileWater(depth=(0.0, 8000.0), sound_speed=(1500.0, 1628.0))
    # It turns at the depth asked for if that lies some 4.4 km away, and short of it farther on.
    for across in np.concatenate([np.arange(4000.0, 6000.0, 100.0), 4422.0 + np.logspace(-3.0, 2.0, 11)]):
        found = eigenrays(water, depth, across, to)
        assert found.sizes["eigenray"] == 1, across
        assert float(found.time[0]) == pytest.approx(float(exact_time(across, (depth, to))), abs=1e-11)
