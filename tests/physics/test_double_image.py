"""Things heard along several bent paths: where their images are, and how loud."""

import math

import numpy as np
import pytest

from beds import arrays_of, poses_of, rough
from insonify.acoustics.rays import join_points
from insonify.kernels.refraction.eigenray_search import TIME
from insonify.packing.packed_scene import without_targets
from insonify.tracers import ray_sheets, rays, sweep
from insonify.tracers.labels import trace_labels
from water import land, water_of

SONAR_HEIGHT, SURFACE, REFERENCE = 25.0, 54.0, 1489.0
# Warm water on cold: what goes up flatter than 13 degrees is bent down again.
WATER = water_of([0.0, 40.0, 42.0, 54.0], [1487.5, 1490.0, 1532.0, 1532.0], reference=REFERENCE, surface=SURFACE)
BIN, BINS = 0.1, 2900
SLANT = (np.arange(BINS) + 0.5) * BIN
FLAT = np.zeros((8, 8))


def arrays(**options):
    return arrays_of(FLAT, 8.0, periodic=True, bins=BINS, bin_length=BIN, **options)._replace(water=WATER)


def record(scene, count=40_000):
    return rays.trace(scene, poses_of(0.0, 0.0, SONAR_HEIGHT), rays=count)[0, 0].astype(float)


def image_ranges(x, z):
    """Slant ranges of a place by the direct path, out by it and back by the one that is bent down, and by that one."""
    found = join_points(WATER, SONAR_HEIGHT, z, x, -math.inf, SURFACE, 0)
    direct, bent = REFERENCE * np.sort(found[:, TIME])[[0, -1]]
    return np.array([direct, 0.5 * (direct + bent), bent])


@pytest.mark.parametrize("half_width", [0.0, math.radians(0.5)])
def test_a_ball_shows_three_times(half_width):
    ball = ((0.0, 255.0, 3.0), 0.3)
    echo = record(arrays(half_width=half_width, solids=[ball])) - record(arrays(half_width=half_width))
    images = image_ranges(255.0, 3.0)
    assert images[2] - images[0] > 4.0
    loud = SLANT[np.flatnonzero(echo > 0.2 * echo.max())]
    near = np.abs(loud[:, None] - images) < 0.6
    assert near.any(axis=1).all()
    for k, image in enumerate(images):  # an echo begins at the ball's near side
        assert loud[near[:, k]].min() == pytest.approx(image - 0.3, abs=1.5 * BIN)
    # Twice what either alone would leave between them, in intensity their geometric mean.
    energy = [echo[np.abs(SLANT - image) < 0.6].sum() for image in images]
    assert energy[1] == pytest.approx(2.0 * math.sqrt(energy[0] * energy[2]), rel=0.05)


def landings(up):
    """Where rays come down on the bed, by range: the sine there, one-way intensity and slant range."""
    angles = np.radians(np.linspace(11.6, 12.9, 2000) if up else np.linspace(-5.6, -4.5, 2000))
    ways = np.column_stack([np.zeros(angles.size), np.cos(angles), np.sin(angles)])
    hits, there = land(arrays(), (0.0, 0.0, SONAR_HEIGHT), ways, 400.0)
    columns = (there.x, -there.dz, 1.0 / (there.tube * there.spread), hits.distance)
    return [column[np.argsort(there.x)] for column in columns]


FIRST, LAST = 2790, 2880


def integral_over_the_bed():
    """Energy per bin from FIRST on: σ I² along each path, and twice σ I I' out by one and back by the other."""
    x = np.linspace(270.0, 288.0, 400_001)
    step = x[1] - x[0]
    one, other = ([np.interp(x, c[0], values) for values in c[1:]] for c in (landings(False), landings(True)))
    slant = [one[2], 0.5 * (one[2] + other[2]), other[2]]
    loud = [(one[0] * one[1]) ** 2, 2.0 * one[0] * one[1] * other[0] * other[1], (other[0] * other[1]) ** 2]
    energy = [s * r**4 * step / math.pi for s, r in zip(loud, slant)]
    edges = SLANT[FIRST:LAST] - 0.5 * BIN
    return sum(np.histogram(r, edges, weights=e)[0] for r, e in zip(slant, energy))


def test_a_level_bed_is_heard_by_both_paths_and_by_one_after_the_other():
    whole, right = record(arrays()), integral_over_the_bed()
    assert whole[FIRST : LAST - 1].sum() == pytest.approx(right.sum(), rel=0.01)
    shorter = record(arrays()._replace(bins=2800, range_factor=np.ones(2800)))
    late = slice(2760, 2795)  # pairs of paths of which one comes after the last bin
    assert shorter[late].sum() == pytest.approx(whole[late].sum(), rel=0.01)
    by_sheets = ray_sheets.trace(arrays(), poses_of(0.0, 0.0, SONAR_HEIGHT), sheets=1, rays=4096)[0, 0]
    np.testing.assert_allclose(by_sheets[FIRST : LAST - 1], right, rtol=5e-3)  # every bin of a sheet of rays


def test_a_rough_bed_heard_along_two_paths_is_as_by_many_single_rays():
    bed = arrays_of(rough(512, 512, rms=0.08, seed=23), 0.25, periodic=True, bins=BINS, bin_length=BIN)
    scene = bed._replace(water=WATER)
    poses = poses_of(0.0, 0.0, SONAR_HEIGHT)
    twice, many = slice(2380, 2890), rays.trace(scene, poses, rays=1 << 19)[0]
    for count, limit in ((1 << 12, 1e-2), (1 << 14, 2e-3)):
        off = ray_sheets.trace(scene, poses, sheets=1, rays=count)[0, :, twice] - many[:, twice]
        assert np.linalg.norm(off) < limit * np.linalg.norm(many[:, twice])


def test_truth_names_the_ball_in_all_its_images():
    scene = arrays(solids=[((0.0, 255.0, 3.0), 0.3)], half_width=math.radians(0.5))
    poses = poses_of(0.0, 0.0, SONAR_HEIGHT)
    truth, heard = trace_labels(scene, poses, rays=40_000), sweep.trace(scene, poses, rays=40_000)
    assert ((truth.target_id != -2) == (heard > 0.0)).all()
    for image in image_ranges(255.0, 3.0):
        k = int((image - 0.3) / BIN)
        port, starboard = (truth.target_id[0, side, k : k + 3] for side in range(2))
        assert (port == 0).any()
        assert (starboard == -1).all()
        np.testing.assert_allclose(truth.ground_range[0, 0, k : k + 3][port == 0], 255.0, atol=0.35)
    np.testing.assert_allclose(truth.ground_range[0, 1, 1000], math.sqrt(100.05**2 - 25.0**2), atol=0.2)
    np.testing.assert_allclose(truth.incidence[0, 1, 1000], math.degrees(math.acos(25.0 / 100.05)), atol=0.2)
    assert not truth.shadow[0, :, :249].any()


def test_truth_flags_a_caustic_where_its_rays_come_down():
    """Through even water 55 m up and down again, and g = 5 1/s above: x = 55 / tan θ + (2c/g) tan θ is least there."""
    c, g, even = 1490.0, 5.0, 55.0
    water = water_of([0.0, 40.0, 55.0], [c, c, c + 15.0 * g], reference=c, surface=SURFACE)
    slope = math.sqrt(even * g / (2.0 * c))
    sine = slope / math.sqrt(1.0 + slope * slope)
    scene = arrays_of(FLAT, 8.0, periodic=True, bins=4000, bin_length=BIN)
    scene = scene._replace(water=water._replace(wavelength=c / 400e3))
    truth = trace_labels(scene, poses_of(0.0, 0.0, SONAR_HEIGHT), rays=100_000)
    flagged = (np.flatnonzero(truth.caustic[0, 0]) + 0.5) * BIN
    assert flagged.size
    np.testing.assert_allclose(flagged, even / sine + c * (2.0 / g) * math.atanh(sine), atol=1.0)
    assert (truth.target_id[truth.caustic] == -1).all()


def test_a_ball_shades_the_bed_on_each_path_by_itself():
    """What mute balls take from a record of rays: all of the bed behind, or that of one path and of the mixed ones."""
    ball, poses = ((0.0, 255.0, 2.0), 2.0), poses_of(0.0, 0.0, SONAR_HEIGHT)
    scene = arrays(solids=[ball], half_width=0.005, reflectivity=[(1.0, 0.0, 1.0), (0.0, 0.0, 1.0)])
    found = trace_labels(scene, poses, rays=20_000)
    mute = scene._replace(solids=scene.solids._replace(material=np.array([1])))
    shaded, bare = (rays.trace(each, poses, rays=100_000) for each in (mute, without_targets(scene)))
    shares = 1.0 - shaded[0, 0, FIRST:] / bare[0, 0, FIRST:]
    assert (found.shadow[0, 0] == 1.0).sum() > 100
    assert ((found.shadow[0, 0] > 0.3) & (found.shadow[0, 0] < 0.7)).sum() > 80
    assert (found.shadow_id[0, 0] == np.where(found.shadow[0, 0] > 0.0, 0, -2)).all()
    assert np.sqrt(np.mean((found.shadow[0, 0, FIRST:] - shares) ** 2)) < 0.05
    assert abs(np.mean(found.shadow[0, 0, FIRST:] - shares)) < 0.01
