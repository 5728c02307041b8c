"""Surface multipath against the ranges as printed, integrals done by hand, single rays and grids of angles."""

import itertools
import math
from functools import lru_cache, partial

import numpy as np
import pytest

from beds import arrays_of, box_mesh, gaussian_pattern, mesh_of, poses_of, rough, tabulated_pattern
from brute_force import gaussian, solid
from insonify.kernels.common.types import GAUSSIAN, LIGHT, SONAR
from insonify.scene.water.surfaces import RoughSurface
from insonify.statistics.record_errors import compare_records
from insonify.tracers import march, rays, sweep
from sea_surfaces import bright_ball, image_heights, naive_ghost, naive_level_ghost, naive_target_ghost, under_sea

ALTITUDE, DEPTH = 20.0, 30.0
FLAT = np.zeros((4, 4))
BOTTOM_WAYS = ("surface_bottom", "surface_bottom_surface", "second_bottom")
TRACERS = {"sweep": sweep.trace, "rays": partial(rays.trace, rays=20_000)}


def ghost(trace, arrays, poses, surface, *ways, **options):
    """What the named ways add to a record without a sea."""
    return trace(under_sea(arrays, surface, *ways, **options), poses).astype(np.float64) - trace(arrays, poses)


@pytest.mark.parametrize("tracer", TRACERS)
def test_a_point_comes_back_at_the_ranges_as_printed(tracer):
    """Sonar at a depth of 30 m, 20 m above the bed and 75 m away: ghosts at 91.410 and 107.819 m."""
    step, radius, distance = 0.01, 0.02, math.sqrt(75.0**2 - ALTITUDE**2)
    arrays = arrays_of(FLAT, 0.5, periodic=True, bins=12_000, bin_length=step)
    arrays = bright_ball(arrays, (0.0, distance, 0.0), radius)
    sea = under_sea(arrays, ALTITUDE + DEPTH, "surface_bottom", "surface_bottom_surface")
    record = TRACERS[tracer](sea, poses_of(0.0, 0.0, ALTITUDE))
    heard = np.flatnonzero(record[0, 0]) * step
    for printed in (75.0, 91.410, 107.819):
        near = heard[np.abs(heard - printed) < 1.0]
        # The ball reaches out of the bed by its radius.
        assert near.min() == pytest.approx(printed - radius, abs=step)
        assert near.max() <= printed + step
        heard = heard[np.abs(heard - printed) >= 1.0]
    assert heard.size == 0
    assert not record[0, 1].any()


@pytest.mark.parametrize("tracer", TRACERS)
def test_the_surface_echoes_as_a_mirror_image_of_the_source(tracer):
    """1 / (2d)² in one bin, whatever the beam; a vertical beam hears what it has of it straight up."""
    options = {"periodic": True, "bins": 1000, "bin_length": 0.1, "spreading": True}
    for half_width in (0.0, 0.02):
        arrays = arrays_of(FLAT, 0.5, half_width=half_width, **options)
        added = ghost(TRACERS[tracer], arrays, poses_of(0.0, 0.0, ALTITUDE), ALTITUDE + DEPTH, "surface_echo")
        assert np.flatnonzero(added[0, 1]).tolist() == [300]
        assert added[0, 1, 300] == pytest.approx(1.0 / (2.0 * DEPTH) ** 2, rel=0.01)
    beam = gaussian_pattern(0.03, vertical=GAUSSIAN, tilt=-0.3, vertical_width=2.0)
    arrays = arrays_of(FLAT, 0.5, half_width=0.02, pattern=beam, **options)
    heard = ghost(TRACERS[tracer], arrays, poses_of(0.0, 0.0, ALTITUDE), ALTITUDE + DEPTH, "surface_echo")
    # Straight up lies cos(0.3 rad) / sin(1 rad) of the -3 dB width off the axis, both ways.
    off = math.cos(0.3) / math.sin(1.0)
    assert heard[0, 0, 300] / added[0, 0, 300] == pytest.approx(2.0 ** (-2.0 * off**2), rel=1e-3)


@pytest.mark.parametrize("way", BOTTOM_WAYS)
@pytest.mark.parametrize("law", [SONAR, LIGHT])
@pytest.mark.parametrize("tracer", TRACERS)
def test_a_level_bed_is_its_integral(way, law, tracer):
    options = {"periodic": True, "bins": 300, "bin_length": 0.2, "spreading": law == SONAR, "law": law}
    arrays = arrays_of(FLAT, 0.1, reflectivity=[(0.6, 0.3, 5.0)], **options)
    # No path begins near the border of a bin.
    altitude, depth = 8.07, 7.03
    added = ghost(TRACERS[tracer], arrays, poses_of(0.0, 0.0, altitude), altitude + depth, way)[0]
    expected = naive_ghost(under_sea(arrays, altitude + depth, way), 0.0, 0.0, altitude, way)
    first = int(0.5 * sum(image_heights(way, altitude, depth)[:2]) / 0.2)
    for record in (added, expected):
        assert (np.argmax(record > 0.0, axis=1) == first).all()
    assert np.abs(added[expected == 0.0]).max() == 0.0
    np.testing.assert_allclose(added[:, first + 2 :], expected[:, first + 2 :], rtol=0.03)
    assert added.sum() == pytest.approx(expected.sum(), rel=2e-3)


@pytest.mark.parametrize("way", BOTTOM_WAYS)
@pytest.mark.parametrize(
    ("is_table", "planes", "bias", "beyond_first", "most"),
    [(False, 16, 0.01, 0.4, 0.03), (True, 8, 2e-3, 0.1, 0.01), (True, 64, 1e-3, 0.1, 0.01)],
)
def test_a_fan_takes_in_what_both_cones_do(is_table, planes, bias, beyond_first, most, way):
    """Energy of a level bed heard by a fan: rings cut by the narrower of two cones about the track."""
    altitude, depth, half = 8.0, 7.0, math.radians(2.0)
    options = {"periodic": True, "bins": 300, "bin_length": 0.2, "spreading": True, "half_width": half}
    if is_table:
        options["pattern"] = tabulated_pattern(math.sin(half), [1.0, 1.0])
    arrays, trace = arrays_of(FLAT, 0.1, **options), partial(sweep.trace, planes=planes)
    added = ghost(trace, arrays, poses_of(0.0, 0.0, altitude), altitude + depth, way)[0, 0]
    one, other, share = image_heights(way, altitude, depth)
    x = (np.arange(600_000) + 0.5) * 1e-4
    r, s = np.hypot(x, one), np.hypot(x, other)
    azimuths = 2.0 * np.arcsin(np.minimum(math.sin(half) * np.minimum(r, s) / x, 1.0))
    energy = share * one * other / (r * s) ** 3 / math.pi * azimuths * x * 1e-4
    k = (0.5 * (r + s) / 0.2).astype(int)
    expected = np.bincount(k[k < 300], energy[k < 300], 300)
    assert added.sum() == pytest.approx(expected.sum(), rel=bias)
    beyond = slice(int(np.flatnonzero(expected)[0] * (1.0 + beyond_first)), 300)
    np.testing.assert_allclose(added[beyond], expected[beyond], rtol=most)


@pytest.mark.parametrize("way", BOTTOM_WAYS)
def test_the_twin_hears_a_rough_bed_alike(way):
    arrays = arrays_of(rough(64, 64, 0.3), 0.5, periodic=True, bins=300, bin_length=0.2, spreading=True)
    pose = (0.2, 0.1, 8.0)
    added = ghost(sweep.trace, arrays, poses_of(*pose), 15.0, way)[0]
    expected = naive_ghost(under_sea(arrays, 15.0, way), *pose, way)
    assert np.linalg.norm(added - expected) < 0.01 * np.linalg.norm(expected)
    assert added.sum() == pytest.approx(expected.sum(), rel=5e-3)


BODIES = [
    ((1.5, 9.0, 0.6), 0.6),
    ((-1.0, 14.0, 0.4), (4.0, 15.5, 0.4), 0.4),
    ((2.0, -12.0, 2.2), 0.8),
    ((3.0, -16.0, 0.0), (3.0, -16.0, 2.0), 1.0, 0.2),
]
BEAMS = {
    "knife": {},
    "fan": {"half_width": 0.02},
    "light": {"law": LIGHT},
    "pattern": {"half_width": 0.02, "pattern": gaussian_pattern(0.03, vertical=GAUSSIAN, tilt=0.5, vertical_width=1.2)},
    "one way": {"half_width": 0.02, "pattern": gaussian_pattern(0.03, two_way=False, near_width=0.06)},
}


def pairs(names, whole):
    """Pairs of a name and a way, of which those are slow that are not needed for each way once and the whole of one."""
    return [
        pytest.param(name, way, marks=[pytest.mark.slow] * (name != whole and way != BOTTOM_WAYS[number % 3]))
        for number, name in enumerate(names)
        for way in BOTTOM_WAYS
    ]


@pytest.mark.parametrize(("beam", "way"), pairs(BEAMS, "pattern"))  # which has the most of its own
def test_the_sweep_is_as_near_to_rays_as_it_is_said_to_be(beam, way):
    arrays = arrays_of(
        rough(256, 256, 0.1), 0.125, periodic=True, bins=200, bin_length=0.2, reflectivity=[(0.6, 0.3, 5.0)],
        spreading=True, solids=BODIES, mesh=box_mesh((0.0, 18.0, 0.0), (3.0, 20.0, 1.5), target=4), **BEAMS[beam],
    )  # fmt: skip
    poses = poses_of(1.6, 0.2, 7.0, 0.0, *((0.03, -0.1) if beam == "pattern" else (0.0, 0.0)))
    count = 1 << (20 if (beam, way) == ("fan", "second_bottom") else 18)
    fine = partial(sweep.trace, planes=64), partial(rays.trace, rays=count)
    ours, right = (ghost(trace, arrays, poses, 13.0, way).astype(np.float32) for trace in fine)
    errors = compare_records(arrays, poses, ours, right)
    assert errors.beyond < 0.015
    assert abs(errors.energy_bias) < 0.01


@pytest.mark.parametrize(
    ("way", "altitude", "surface"),
    [("", 16.0, 0.0), ("surface_bottom", 11.0, 14.0), ("surface_bottom_surface", 7.0, 12.0)],
)
def test_a_tall_target_is_met_where_the_bed_is_out_of_range(way, altitude, surface):
    """A patterned beam reaches as far as to the highest place: a box of 6 m, the bed being out of a path's range."""
    arrays = arrays_of(
        FLAT, 0.5, periodic=True, bins=140, bin_length=0.1, reflectivity=[(0.6, 0.3, 5.0)],
        mesh=box_mesh((-0.5, 7.0, 0.0), (0.5, 8.0, 6.0)), **BEAMS["pattern"],
    )  # fmt: skip
    poses = poses_of(0.0, 0.0, altitude)
    ours, right = (
        ghost(fine, arrays, poses, surface, way) if way else fine(arrays, poses).astype(np.float64)
        for fine in (partial(sweep.trace, planes=64), partial(rays.trace, rays=1 << 18))
    )
    assert right.sum() > 0.0
    assert ours.sum() == pytest.approx(right.sum(), rel=0.02)
    assert np.linalg.norm(ours - right) < 0.03 * np.linalg.norm(right)


@pytest.mark.parametrize("tracer", TRACERS)
def test_targets_hide_and_are_hidden_from_each_image_by_itself(tracer):
    """Behind a wall the sonar sees no bed, its image does from steeper above: the one ghost without the other."""
    wall = mesh_of([(-9.0, 10.0, 0.0), (9.0, 10.0, 0.0), (9.0, 10.0, 3.0), (-9.0, 10.0, 3.0)], [(0, 1, 2), (0, 2, 3)])
    arrays = arrays_of(FLAT, 0.5, periodic=True, bins=800, bin_length=0.05, mesh=wall)
    pose, surface = poses_of(0.0, 0.0, 8.0), 14.0
    # Shadows on the bed end where the line over the top of the wall comes down.
    straight, by_image = 10.0 * 8.0 / (8.0 - 3.0), 10.0 * 20.0 / (20.0 - 3.0)
    twice = ghost(TRACERS[tracer], arrays, pose, surface, "surface_bottom_surface")[0, 0]
    mixed = ghost(TRACERS[tracer], arrays, pose, surface, "surface_bottom")[0, 0]
    for record, end in ((twice, by_image), (mixed, straight)):
        near, far = math.hypot(10.05, 20.0), math.hypot(end, 20.0)
        if record is mixed:
            near, far = (0.5 * (r + math.hypot(x, 8.0)) for r, x in ((near, 10.05), (far, end)))
        assert not record[int(near / 0.05) + 1 : int(far / 0.05)].any()
        assert (record[int(far / 0.05) + 2 : int(far / 0.05) + 40] > 0.0).all()


def test_land_is_not_seen_through_the_surface():
    arrays = arrays_of(np.tile(np.linspace(-10.0, 10.0, 41)[:, None], (1, 9)), 1.0, x0=-4.0, y0=-20.0, bins=600)
    for trace in TRACERS.values():
        added = ghost(trace, arrays, poses_of(0.0, -12.0, 0.5), 2.0, "surface_bottom_surface")[0]
        # The shore lies 16 m from the sonar, 1.5 m above it.
        assert np.flatnonzero(added[0])[-1] * 0.05 == pytest.approx(math.hypot(16.0, 1.5), abs=0.3)


OPTIONS = {"periodic": True, "bins": 4500, "bin_length": 0.01}  # under a sea raised by the wind
POSE = poses_of(0.3, 0.0, 12.0)


@pytest.mark.parametrize("tracer", TRACERS)
@pytest.mark.parametrize("way", ["surface_bottom", "surface_bottom_surface"])
def test_energy_is_kept_and_comes_later_by_what_tilts_add(tracer, way):
    wind, depth, drop = 6.0, 6.0, 24.0
    ball = bright_ball(arrays_of(FLAT, 0.5, **OPTIONS), (0.3, 20.0, 0.0), 0.05)
    calm = ghost(TRACERS[tracer], ball, POSE, 18.0, way)[0, 0]
    blown = ghost(TRACERS[tracer], ball, POSE, 18.0, way, wind_speed=wind)[0, 0]
    assert blown.sum() == pytest.approx(calm.sum(), rel=1e-5)
    r = (np.arange(4500) + 0.5) * 0.01
    mean, spread = (lambda e: ((e * r).sum() / e.sum(), (e * r * r).sum() / e.sum()))(blown)
    first = (calm * r).sum() / calm.sum()
    # Legs of d and h + d, at the grazing angle to the image, 24 m above the ball.
    passes, far = (1 if way == "surface_bottom" else 2), math.hypot(20.0, drop)
    grazing, variance = drop / far, RoughSurface(wind_speed=wind).slope_variance
    r1, r2 = depth / grazing, (drop - depth) / grazing
    late = passes * variance * r1 * r2 / (r1 + r2)
    assert mean - first == pytest.approx(late, rel=0.02, abs=0.01)
    height = passes * RoughSurface(wind_speed=wind).rms_height * grazing
    tilts = late**2 * (2.0 if passes == 1 else 1.0)
    assert math.sqrt(spread - mean**2) == pytest.approx(math.sqrt(height**2 + tilts), rel=0.06)


def test_waves_are_as_high_and_as_steep_as_measured_and_the_surface_as_thick():
    """Significant height of a fully developed sea (Pierson and Moskowitz); slopes of Cox and Munk (1954)."""
    assert 4.0 * RoughSurface(wind_speed=10.0).rms_height == pytest.approx(0.0213 * 10.0**2, rel=0.01)
    for wind in (4.0, 5.0):
        assert 2.0 * RoughSurface(wind_speed=wind).slope_variance == pytest.approx(0.003 + 0.00512 * wind, rel=0.15)
    assert RoughSurface(wind_speed=0.0).slope_variance == 0.0
    assert RoughSurface(wind_speed=0.1).slope_variance < 1e-5
    arrays = arrays_of(FLAT, 0.5, **OPTIONS)
    calm = ghost(sweep.trace, arrays, POSE, 18.0, "surface_echo")[0, 0]
    blown = ghost(sweep.trace, arrays, POSE, 18.0, "surface_echo", wind_speed=6.0)[0, 0]
    r = (np.arange(4500) + 0.5) * 0.01
    mean = (blown * r).sum() / blown.sum()
    assert blown.sum() == pytest.approx(calm.sum(), rel=1e-5)
    high = RoughSurface(wind_speed=6.0).rms_height
    assert math.sqrt((blown * (r - mean) ** 2).sum() / blown.sum()) == pytest.approx(high, rel=0.15)


def test_wind_smears_sweep_and_rays_alike_and_a_breath_of_it_next_to_nothing():
    arrays = arrays_of(rough(64, 64, 0.1), 0.5, **OPTIONS)
    for way in BOTTOM_WAYS:
        calm = ghost(sweep.trace, arrays, POSE, 18.0, way)
        breath = ghost(sweep.trace, arrays, POSE, 18.0, way, wind_speed=0.05)
        assert np.abs(np.cumsum(breath - calm, axis=-1)).max() < 0.02 * calm.max()
        ours = ghost(sweep.trace, arrays, POSE, 18.0, way, wind_speed=6.0)
        right = ghost(TRACERS["rays"], arrays, POSE, 18.0, way, wind_speed=6.0)
        coarse = (1, 2, 90, 50)
        one, other = ours.reshape(coarse).sum(axis=-1), right.reshape(coarse).sum(axis=-1)
        assert np.linalg.norm(one - other) < 0.01 * np.linalg.norm(other)


def test_the_march_hears_the_same_ghosts_as_rays_and_no_tracer_any_by_ways_that_are_closed():
    arrays = arrays_of(rough(64, 64, 0.1), 0.5, periodic=True, bins=300, bin_length=0.1)
    marched, walked = (
        ghost(trace, arrays, poses_of(0.1, 0.2, 5.0), 9.0, "surface_bottom")
        for trace in (partial(march.trace, rays=4000, step=0.01), partial(rays.trace, rays=4000))
    )
    np.testing.assert_allclose(marched, walked, atol=1e-5 * walked.max())
    arrays, poses = arrays._replace(half_width=0.02), poses_of(0.1, 0.2, 7.0)
    for trace in (sweep.trace, rays.trace):
        np.testing.assert_array_equal(trace(under_sea(arrays, 13.0), poses), trace(arrays, poses))


@pytest.mark.parametrize(
    ("trace", "noise"), [(sweep.trace, 2e-3), (partial(rays.trace, rays=1 << 18), 0.03)], ids=["sweep", "rays"]
)
@pytest.mark.parametrize("way", BOTTOM_WAYS)
def test_waves_bring_echoes_into_the_record_from_beyond_its_end(way, trace, noise):
    """A record that ends where a path begins is the beginning of a longer one, and the sea's waves are in both."""
    first = {"surface_bottom": 50.0, "surface_bottom_surface": 80.0, "second_bottom": 70.0}[way]
    options = {"periodic": True, "bin_length": 0.1, "half_width": math.radians(0.5)}
    scenes = (arrays_of(FLAT, 0.1, bins=round(end / 0.1), **options) for end in (first + 0.1, first + 10.0))
    pose, surface = poses_of(0.0, 0.0, ALTITUDE), ALTITUDE + DEPTH
    short, long = (ghost(trace, arrays, pose, surface, way, wind_speed=4.0)[0, 0] for arrays in scenes)
    np.testing.assert_allclose(short, long[: short.size], rtol=noise, atol=noise * short.max())


@pytest.mark.parametrize(
    ("squint", "law"),
    [
        (0.0, SONAR),
        (-10.0, SONAR),
        (5.0, LIGHT),
        *(pytest.param(*each, marks=pytest.mark.slow) for each in ((5.0, SONAR), (0.0, LIGHT), (-10.0, LIGHT))),
    ],
)
@pytest.mark.parametrize("way", BOTTOM_WAYS)
def test_a_squinting_beam_takes_in_what_every_azimuth_does(way, squint, law):
    """One plane, many planes and rays of a patterned beam over a level bed, against its integral over azimuths.

    Out in one direction and back from another only the azimuths count at which the beam responds to both.
    """
    width, turned = math.radians(4.0), math.radians(squint)
    pattern = gaussian_pattern(width, squint=turned)
    options = {"periodic": True, "bins": 600, "bin_length": 0.1, "law": law}
    arrays = arrays_of(np.zeros((64, 64)), 0.5, half_width=width, pattern=pattern, **options)
    bell = gaussian(width)

    def respond(sine, slant_range):
        response, heard = np.zeros(np.broadcast_shapes(sine.shape, slant_range.shape)), np.abs(sine) < pattern.extent[0]
        response[heard] = bell(sine[heard], np.zeros(1))  # of any range
        return response

    right = naive_level_ghost(arrays, respond, 10.0, 12.0, way, turned)
    traces = *(partial(sweep.trace, planes=planes) for planes in (1, 256)), partial(rays.trace, rays=1 << 17)
    for trace, bound, bias in zip(traces, (0.012, 0.01, 0.05), (5e-4, 2e-3, 2e-3)):
        record = ghost(trace, arrays, poses_of(0.0, 0.0, 10.0), 22.0, way)[0, 0]
        assert np.linalg.norm(record - right) < bound * np.linalg.norm(right)
        assert record.sum() == pytest.approx(right.sum(), rel=bias)


# Round targets over a black bed, 8 m below the sonar, against launch angles and azimuths in plain NumPy.
ROUND_BODIES = {
    "ball": ((0.05, 12.0, 0.9), 0.6),
    "pipe": ((-4.0, 13.0, 0.5), (5.0, 12.5, 0.7), 0.3),
    "cone": ((0.3, 11.0, 0.2), (0.3, 11.0, 2.2), 1.0, 0.2),
    "lying cone": ((-1.5, 12.0, 1.2), (1.5, 13.0, 0.8), 0.9, 0.3),
}
DULL, SHINY, NARROW = (0.7, 0.0, 1.0), (0.5, 0.4, 20.0), (0.0, 1.0, 200.0)


def alone(name, material, law, half_width=0.0):
    """A round body over a black bed."""
    arrays = arrays_of(
        np.zeros((4, 4)), 0.5, periodic=True, bins=1200, bin_length=0.05, law=law, half_width=half_width,
        reflectivity=[material, (0.0, 0.0, 1.0)], solids=[ROUND_BODIES[name]],
    )  # fmt: skip
    return arrays._replace(bed=arrays.bed._replace(materials=np.ones_like(arrays.bed.materials)))


@lru_cache
def twin(name, way, law, material, across=1, up=20_000, half_width=0.0):
    arrays = alone(name, material, law, half_width)
    return naive_target_ghost(arrays, solid(arrays.solids, 0), material, 8.0, 7.0, way, across=across, up=up)


def compare(trace, name, way, law, material, half_width=0.0, **grid):
    right = twin(name, way, law, material, half_width=half_width, **grid)
    arrays = alone(name, material, law, half_width)
    record = ghost(trace, arrays, poses_of(0.0, 0.0, 8.0), 15.0, way)[0, 0]
    return np.linalg.norm(record - right) / np.linalg.norm(right), abs(record.sum() / right.sum() - 1.0)


@pytest.mark.parametrize(
    ("law", "material", "most", "bias"),
    [
        # The grid of angles resolves 0.06 % of the bins.
        (SONAR, SHINY, 0.003, 0.003),
        pytest.param(SONAR, DULL, 0.003, 0.003, marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize(("name", "way"), list(itertools.product(ROUND_BODIES, BOTTOM_WAYS)))
def test_a_knife_hears_a_round_body_as_a_grid_of_angles_does(name, way, law, material, most, bias):
    error, off = compare(sweep.trace, name, way, law, material)
    assert error < most
    assert off < bias


@pytest.mark.parametrize(("name", "way"), list(itertools.product(("ball", "pipe"), BOTTOM_WAYS)))
def test_a_narrow_lobe_of_a_round_body_has_its_energy(name, way):
    assert compare(sweep.trace, name, way, SONAR, NARROW)[1] < 0.001
