"""Rays along arcs over a bed and among targets: closed forms, integrals done by hand, a slow walk in tiny steps."""

import math

import numpy as np
import pytest

import bent
import naive
from beds import arrays_of, icosphere, mesh_of, poses_of, rough
from brute_force import strength
from insonify.kernels.common.types import BED, LIGHT, SONAR, still_water
from insonify.scene import SceneError
from insonify.scene.seabed.materials.catalogue import Reflectivity
from insonify.tracers import march, rays
from water import land, water_about, water_of

FLAT = np.zeros((8, 8))
FAN = math.radians(1.25)
MATERIAL = Reflectivity(0.6, 0.3, 5.0)
SURFACE = 100.0
# Heights and speeds of a steep thermocline above the bed, below a sonar at 20 m.
NODES = ([0.0, 6.0, 8.0, 11.0, 25.0], [1489.0, 1490.0, 1493.0, 1500.0, 1501.0])
THERMOCLINE = water_about(20.0, *NODES, SURFACE)


def gradient(g, z, c=1500.0, surface=SURFACE):
    """Water whose speed is c at height z and rises by g per metre from -5 m to the surface."""
    return water_of([-5.0, surface], [c + g * (-5.0 - z), c + g * (surface - z)], reference=c, surface=surface)


def flat(water, **options):
    return arrays_of(FLAT, 4.0, periodic=True, **options)._replace(water=water)


def downwards(angles, azimuth=0.3):
    angles = np.radians(angles)
    level = np.cos(angles)
    return np.column_stack([level * math.cos(azimuth), level * math.sin(azimuth), -np.sin(angles)])


@pytest.mark.parametrize("g", [-5.0, -0.5, -1e-9, 0.0, 1e-9, 0.5, 5.0])
def test_arcs_of_one_gradient_land_where_circles_do(g):
    arrays = flat(gradient(g, 10.0))
    angles = np.linspace(0.5, 89.5, 90)
    found, what, _ = rays.cast(arrays, (3.0, -2.0, 10.0), downwards(angles), reach=300.0)
    xi, s0, c1 = np.cos(np.radians(angles)) / 1500.0, np.sin(np.radians(angles)), 1500.0 - 10.0 * g
    square = s0**2 + xi**2 * g * 10.0 * (1500.0 + c1)  # physics: s1² = s0² − ξ² g Δz (c0 + c1)
    lands = square >= 0.0
    x = np.where(lands, xi * 10.0 * (1500.0 + c1) / (s0 + np.sqrt(np.maximum(square, 0.0))), 1e4)
    distance = np.hypot(x, 10.0)
    y = abs(g) * distance / (2.0 * math.sqrt(1500.0 * c1))
    expected = distance * math.sqrt(1500.0 / c1) * (np.arcsinh(y) / y if abs(g) > 1e-6 else 1.0)
    lands &= expected < 300.0
    assert (what == np.where(lands, BED, -2)).all()
    np.testing.assert_allclose(found[lands], expected[lands], atol=1e-5)


def test_layers_land_as_printed():
    # Depth 0, 10, 20 and 60 m, sonar at 5 m: range, time and width of the tube, by hand.
    water = water_about(55.0, [0.0, 40.0, 50.0, 60.0], [1498.0, 1500.0, 1520.0, 1520.0], 60.0)
    hits, arrivals = land(flat(water), (0.0, 0.0, 55.0), downwards([2.0, 10.0, 60.0]))
    np.testing.assert_allclose(hits.distance / 1520.0, [0.3179804118, 0.1632912097, 0.0421014320], atol=1e-9)
    x = arrivals.spread * np.cos(np.radians([2.0, 10.0, 60.0]))
    np.testing.assert_allclose(x, [475.430622, 239.228222, 31.281329], atol=1e-4)
    np.testing.assert_allclose(arrivals.tube, [863.1684, 211.6164, 62.3989], rtol=1e-6)


def test_water_that_hardly_bends_is_still_water():
    rng = np.random.default_rng(1)
    bodies = [((10.0, 3.0, 0.5), 1.0), ((5.0, -4.0, 0.2), (9.0, -6.0, 1.0), 0.4)]
    mesh = mesh_of(*icosphere(2, 1.0, (-8.0, 2.0, 0.5)))
    arrays = arrays_of(rough(64, 64), 0.5, periodic=True, solids=bodies, mesh=mesh)
    ways = rng.normal(size=(4000, 3))
    ways[:, 2] = -0.5 * np.abs(ways[:, 2])
    waters = still_water(1500.0, SURFACE), gradient(0.0, 5.0)
    one, other = (rays.cast(arrays._replace(water=water), (0.0, 0.0, 5.0), ways) for water in waters)
    assert (one[1] == other[1]).all()
    assert set(np.unique(one[1])) == {-2, BED, 0, 1}
    hit = one[1] != -2
    np.testing.assert_allclose(other[0][hit], one[0][hit], rtol=1e-13)
    np.testing.assert_allclose(other[2], one[2], atol=1e-9)


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_its_records_are_still_waters(law, half_width):
    arrays = flat(still_water(1500.0, SURFACE), law=law, half_width=half_width, reflectivity=[MATERIAL], bins=500)
    poses = poses_of(3.0, 5.0, 10.0, 0.7)
    still = rays.trace(arrays, poses, rays=200_000)
    bent = rays.trace(arrays._replace(water=gradient(0.0, 10.0)), poses, rays=200_000)
    np.testing.assert_allclose(bent[0, :, 210:].sum(), still[0, :, 210:].sum(), rtol=1e-4)
    # A bin of some four hundred rays has one more or less.
    np.testing.assert_allclose(bent[..., 210:], still[..., 210:], rtol=0.02)


@pytest.mark.parametrize(
    ("water", "height", "g", "farthest"),
    [
        # Faster below: a ray that comes down flatter turns before the bed.
        *[(gradient(-g, 20.0), 20.0, g, limit) for g, limit in ((0.05, 1095.63), (0.5, 346.99), (5.0, 111.36))],
        # Slower below, sonar 10 m below the surface: the ray that grazes it is the last, what passes it is gone.
        *[
            (water_about(30.0, [-5.0, 40.0], [1500.0 - 45.0 * g, 1500.0], 40.0), 30.0, g, limit)
            for g, limit in ((0.1, 1642.35), (0.5, 733.01))
        ],
    ],
)
def test_the_bed_is_unseen_beyond_the_limiting_range(water, height, g, farthest):
    record = rays.trace(flat(water, bins=4000, bin_length=0.5), poses_of(0.0, 0.0, height), rays=4000)[0, 0]
    c_bed = float(np.interp(0.0, water.height, water.speed[0]))
    time = math.acosh(1.0 + g * g * (farthest**2 + height**2) / (2.0 * water.reference * c_bed)) / g
    lit = np.flatnonzero(record)
    assert (lit[-1] + 1) * 0.5 == pytest.approx(water.reference * time, abs=0.5)
    assert record[int(2.0 * height) : lit[-1]].all()


def integrated(water, z, law, half_width, bins, bin_length, rays=6000, slabs=400):
    """A level bed's record by integrals over height, ray by ray: nothing of arcs or tubes."""
    step = 1e-6
    angles = np.arcsin(z / np.linspace(z * (1 + 1e-9), 1.2 * bins * bin_length, rays + 1))[::-1]
    middle = 0.5 * (angles[1:] + angles[:-1])
    heights = (np.arange(slabs) + 0.5) * z / slabs
    speeds = np.interp(heights, water.height, water.speed[0])
    c0, c1 = np.interp(z, water.height, water.speed[0]), np.interp(0.0, water.height, water.speed[0])

    def go(angle):
        x, time = np.zeros(angle.size), np.zeros(angle.size)
        for c in speeds:
            cosine = np.cos(angle) * c / c0
            sine = np.sqrt(1.0 - np.minimum(cosine**2, 1.0 - 1e-12))
            x += cosine / sine * z / slabs
            time += z / slabs / (c * sine)
        return x, time

    (x, time), (before, _), (after, _) = go(middle), go(middle - step), go(middle + step)
    cosine = np.cos(middle)
    sine = np.sqrt(1.0 - np.minimum((cosine * c1 / c0) ** 2, 1.0))
    q = np.abs(after - before) / (2.0 * step) * sine
    intensity, width = cosine / (x * q), 1.0
    r, value = water.reference * time, strength(sine, MATERIAL, law)
    ground = np.abs(after - before) / (2.0 * step) * np.diff(angles)
    if law == LIGHT:
        value *= water.reference / c1 * ground * cosine * c1 / c0 / bin_length
    else:
        if half_width > 0.0:
            width = 2.0 * np.arcsin(np.minimum(math.sin(half_width) / cosine, 1.0)) * x
        value *= ground * width * (intensity * r * r) ** 2
    nearest_first = np.argsort(r)
    r, value = r[nearest_first], value[nearest_first]
    return np.diff(np.interp(np.arange(bins + 1) * bin_length, r, np.cumsum(value) - 0.5 * value))


@pytest.mark.parametrize(
    ("law", "half_width", "water"),
    [
        *((SONAR, FAN, water) for water in (THERMOCLINE, gradient(-0.3, 20.0), gradient(0.5, 20.0))),
        *((law, 0.0, THERMOCLINE) for law in (SONAR, LIGHT)),
    ],
)
def test_levels_of_a_flat_bed_are_their_integrals(law, half_width, water):
    arrays = flat(water, law=law, half_width=half_width, reflectivity=[MATERIAL], bins=120, bin_length=0.5)
    record = rays.trace(arrays, poses_of(3.0, 5.0, 20.0, 0.7), rays=100_000)[0, 0]
    expected = integrated(water, 20.0, law, half_width, 120, 0.5)
    level = 10.0 * np.log10(record[42:] / expected[42:])
    assert np.abs(level).max() < 0.05
    assert abs(level.mean()) < 0.005


def test_first_hits_are_those_of_tiny_steps():
    height, speed = [-1.0, 1.0, 2.0, 4.0, 8.0], [1480.0, 1482.0, 1490.0, 1500.0, 1501.0]
    bodies = [((14.0, 0.5, 1.2), 1.0), ((22.0, -3.0, 0.6), (22.0, 3.0, 1.0), 0.7), ((30.0, 0.0, 3.0), 0.8)]
    arrays = arrays_of(rough(64, 64, rms=0.15), 0.5, periodic=True, solids=bodies)
    arrays = arrays._replace(water=water_of(height, speed, surface=SURFACE))
    start, azimuth, reach = (0.3, 0.2, 4.5), 0.02, 60.0
    angles = np.concatenate([np.linspace(1.0, 30.0, 30), np.linspace(-6.0, 1.0, 14)])

    def met(x, z):
        points = np.column_stack([start[0] + x * math.cos(azimuth), start[1] + x * math.sin(azimuth), z])
        return naive.inside(arrays, points)

    found, what, _ = rays.cast(arrays, start, downwards(angles, azimuth), reach=reach)
    (*_, time), hit = bent.follow(arrays.water, start[2], -np.radians(angles), met, reach, 0.02)
    expected = 1500.0 * time
    kinds = np.where(expected < reach, hit, -2)
    assert set(kinds) == {-2, BED, 0, 1, 2}
    assert (what == kinds).mean() > 0.97  # but for rays that just graze something
    same = (what == kinds) & (what != -2)
    # Where a ray comes in at a degree or two, a tenth of a millimetre of height is several of range.
    np.testing.assert_allclose(found[same], expected[same], atol=0.01)
    assert np.median(np.abs(found[same] - expected[same])) < 5e-4


def test_sound_goes_back_the_way_it_came():
    start = (1.0, 2.0, 20.0)
    bed = arrays_of(rough(64, 64, rms=0.1), 1.0, periodic=True, solids=[(start, 0.05)])
    arrays = bed._replace(water=THERMOCLINE)
    ways = downwards(np.linspace(8.0, 80.0, 30), azimuth=1.1)
    outside = np.array(start) + 0.051 * ways
    hits, arrivals = land(arrays, outside.T, ways, 300.0)
    assert (hits.body == BED).all()
    way = np.column_stack([arrivals.dx, arrivals.dy, arrivals.dz])
    x = arrivals.spread * np.hypot(ways[:, 0], ways[:, 1])
    places = outside + x[:, None] * np.array([math.cos(1.1), math.sin(1.1), 0.0])
    places[:, 2] = naive.heights(arrays.bed, *places[:, :2].T) + 1e-3
    back, what, _ = rays.cast(arrays, places, -way, reach=300.0)
    assert (what == 0).all()
    np.testing.assert_allclose(back, hits.distance, atol=0.02)


def test_a_mesh_is_met_as_the_ball_it_stands_for():
    centre = (40.0, 0.0, 8.0)
    ball = flat(THERMOCLINE, solids=[(centre, 2.0)])
    mesh = flat(THERMOCLINE, mesh=mesh_of(*icosphere(5, 2.0, centre)))
    ways = downwards(np.linspace(10.0, 24.0, 400), azimuth=0.0)
    one, other = rays.cast(ball, (0.0, 0.0, 20.0), ways), rays.cast(mesh, (0.0, 0.0, 20.0), ways)
    assert (one[1] == other[1]).mean() > 0.98
    both = (one[1] == 0) & (other[1] == 0)
    assert both.sum() > 50
    assert np.median(np.abs(one[0][both] - other[0][both])) < 0.005


@pytest.mark.parametrize("law", [LIGHT, SONAR])
def test_the_march_goes_along_the_same_arcs(law):
    arrays = flat(THERMOCLINE, law=law, half_width=FAN, bins=400, bin_length=0.2)
    poses = poses_of(1.0, 2.0, 20.0, 0.3)
    one, other = march.trace(arrays, poses, step=0.5, rays=8000), rays.trace(arrays, poses, rays=8000)
    # A level bed is linear along a chord: one interpolation finds it, and no bin has more than a ray too many.
    np.testing.assert_allclose(one, other, rtol=0.06)
    assert one.sum() == pytest.approx(other.sum(), rel=1e-4)


def test_what_is_inside_the_bed_meets_nothing():
    arrays = flat(gradient(0.5, 10.0))
    _, what, _ = rays.cast(arrays, (0.0, 0.0, -1.0), downwards([-80.0, -10.0, 0.0, 10.0, 80.0]))
    assert (what == -2).all()


def test_straight_down_is_a_straight_line():
    found, what, _ = rays.cast(flat(THERMOCLINE), (0.0, 0.0, 20.0), (0.0, 0.0, -1.0))
    height, speed = map(np.array, NODES)
    z = np.concatenate([height[height < 20.0], [20.0]])
    c = np.interp(z, height, speed)
    time = np.sum(np.diff(z) * np.log(c[1:] / c[:-1]) / np.diff(c))
    assert what[0] == BED
    assert found[0] == pytest.approx(THERMOCLINE.reference * time, abs=1e-9)


def test_a_section_that_is_the_same_everywhere_is_layers():
    stations = {"speed": np.tile(NODES[1], (3, 1)), "station": np.array([-20.0, 7.0, 31.0])}
    section = THERMOCLINE._replace(axis_x=math.cos(0.4), axis_y=math.sin(0.4), **stations)
    ball = ((30.0, 8.0, 2.0), 1.5)
    arrays = arrays_of(rough(64, 64), 1.0, periodic=True, solids=[ball], half_width=FAN, bins=200, bin_length=0.4)
    ways = downwards(np.concatenate([np.linspace(-3.0, 80.0, 300), np.linspace(20.0, 35.0, 100)]), azimuth=0.26)
    scenes = [arrays._replace(water=water) for water in (THERMOCLINE, section)]
    one, other = (rays.cast(scene, (0.0, 0.0, 20.0), ways) for scene in scenes)
    assert set(one[1]) == {-2, BED, 0}
    assert (one[1] == other[1]).all()
    hit = one[1] != -2
    np.testing.assert_allclose(other[0][hit], one[0][hit], atol=1e-3)
    layers, same = (rays.trace(scene, poses_of(0.0, 0.0, 20.0, 0.3), rays=2000) for scene in scenes)
    np.testing.assert_allclose(same.sum(), layers.sum(), rtol=1e-3)


def test_of_a_section_each_ray_feels_what_lies_in_its_plane():
    station, height = np.array([-300.0, -40.0, 25.0, 300.0]), np.array([-5.0, 3.0, 12.0, 100.0])
    gx, gz, azimuth = 0.3, 0.2, 0.9
    speed = 1500.0 + gx * station[:, None] + gz * height
    water = water_of(height, speed, station, reference=1504.0, surface=SURFACE)
    hits, arrivals = land(flat(water), (10.0, 5.0, 20.0), downwards(np.linspace(5.0, 85.0, 41), azimuth), 300.0)
    x = arrivals.spread * np.cos(np.radians(np.linspace(5.0, 85.0, 41)))
    # In the plane the gradient is even, and the time between two points is that along a circle.
    g = math.hypot(gx * math.cos(azimuth), gz)
    here, there = 1500.0 + gx * 10.0 + gz * 20.0, 1500.0 + gx * (10.0 + x * math.cos(azimuth))
    assert (hits.body == BED).all()
    time = np.arccosh(1.0 + g * g * (x**2 + 400.0) / (2.0 * here * there)) / g
    np.testing.assert_allclose(hits.distance, 1504.0 * time, atol=1e-6)


def test_bounces_are_refused():
    arrays = flat(THERMOCLINE)
    with pytest.raises(SceneError, match=r"sonar\.bounces: 2 bounces are traced along straight lines"):
        rays.trace(arrays._replace(bounces=2), poses_of(0.0, 0.0, 20.0))
    with pytest.raises(SceneError, match=r"sonar\.bounces"):
        rays.follow(arrays, (0.0, 0.0, 20.0), (0.0, 1.0, -1.0), 1)
