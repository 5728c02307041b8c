"""The sweep through layered water: closed forms of one gradient, rays by brute force, targets, folds."""

from functools import partial

import numpy as np
import pytest

import bent
from beds import arrays_of, icosphere, mesh_of, poses_of
from insonify.compiler.jit import kernel
from insonify.kernels.bed.profile import empty_profile
from insonify.kernels.refraction.apparent_positions import apply_apparent_positions, look_up_position, prepare_table
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.tracers import sweep
from insonify.tracers.labels import trace_labels
from water import water_about

SONAR = 10.02
FLAT = np.zeros((4, 4))
over = partial(arrays_of, spacing=0.1, periodic=True, bins=500, bin_length=0.1)
flat = partial(over, FLAT)
WATERS = {
    "faster below": ([-200.0, 200.0], [1600.0, 1400.0]),
    "faster above": ([-200.0, 200.0], [1400.0, 1600.0]),
    "thermocline": ([-50.0, 2.0, 6.0, 50.0], [1490.0, 1490.0, 1500.0, 1500.0]),
    "around the sonar": ([-50.0, 6.0, 14.0, 50.0], [1490.0, 1490.0, 1500.0, 1500.0]),
    "upside down": ([-50.0, 2.0, 6.0, 50.0], [1500.0, 1500.0, 1490.0, 1490.0]),
}


def wet(arrays, name, sonar=SONAR):
    return arrays._replace(water=water_about(sonar, *WATERS[name]))


def one_gradient(gradient, sonar):
    """Empty bed, and water whose speed rises by so much a metre upwards and is 1500 m/s at the sonar."""
    speeds = [1500.0 - gradient * (200.0 + sonar), 1500.0 + gradient * (200.0 - sonar)]
    arrays = arrays_of(np.array([[-1.0, 1.0], [1.0, -1.0]]), bins=1000, bin_length=0.1)
    return arrays._replace(water=water_about(sonar, [-200.0, 200.0], speeds))


def travelled(gradient, x, z):
    """Slant range of places about the sonar, and the speed there: τ = (2/|g|) asinh(|g| D / (2 √(c0 c1)))."""
    c1 = 1500.0 + gradient * z
    return 3000.0 / abs(gradient) * np.arcsinh(abs(gradient) * np.hypot(x, z) / (2.0 * np.sqrt(1500.0 * c1))), c1


@kernel
def places(apparent, z, table, x, heights):
    """What a sonar at height z reads of places, (n, 4)."""
    sheet, out = prepare_table(apparent, z, table), np.zeros((x.size, 4))
    for k in range(x.size):
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = look_up_position(table, sheet, x[k], heights[k] - z)
    return out


def read(arrays, z, x, heights):
    apparent, folded = make_apparent_tables(arrays, poses_of(0.0, 0.0, z))
    assert not folded.any()
    return places(apparent, z, np.zeros(apparent.tables.shape[1:], np.float32), x, heights)


@pytest.mark.parametrize("gradient", [1.0, 0.1, -0.1, -1.0])
@pytest.mark.parametrize("sonar", [SONAR, 1.5])
def test_tables_of_one_gradient_hold_the_closed_forms(gradient, sonar):
    # tan θ0 = Δz/x + g D²/(2 x c0), q = x / cosθ0 (from dz/dθ0 there).
    arrays = one_gradient(gradient, sonar)
    rng = np.random.default_rng(1)
    x, heights = rng.uniform(0.0, 100.0, 500), rng.uniform(-1.0, 1.0, 500)
    level, rise, tube, turn = read(arrays, sonar, x, heights).T
    z = heights - sonar
    r, c1 = travelled(gradient, x, z)
    slope = z / x + gradient * (x**2 + z**2) / (2.0 * x * 1500.0)
    cosine = 1.0 / np.hypot(1.0, slope)
    np.testing.assert_allclose(x * (1.0 + level), r * cosine, atol=2e-4 * abs(gradient))
    np.testing.assert_allclose(z + rise, r * slope * cosine, atol=2e-4 * abs(gradient))
    np.testing.assert_allclose(1.0 + tube, x / cosine / r, rtol=1e-6)
    arrival = z / x - gradient * (x**2 + z**2) / (2.0 * x * c1)
    np.testing.assert_allclose(turn, np.arctan(arrival) - np.arctan(slope), atol=2e-6)


@kernel
def put(apparent, z, table, profile, count):
    """Put the knots of a profile at their apparent positions."""
    apply_apparent_positions(table, prepare_table(apparent, z, table), True, profile, count)


@pytest.mark.parametrize("gradient", [1.0, -1.0])
def test_a_rough_profile_has_the_ranges_and_incidences_of_the_closed_forms(gradient):
    knots = 901
    apparent, _ = make_apparent_tables(one_gradient(gradient, SONAR), poses_of(0.0, 0.0, SONAR))
    x = np.linspace(0.0, 90.0, knots)
    z = 0.9 * np.sin(0.7 * x) - SONAR
    slope = np.diff(z) / np.diff(x)
    area = 1.3 + slope**2
    profile = empty_profile(1024, np.float64)
    profile.x[:knots], profile.z[:knots], profile.slope[: knots - 1], profile.area[: knots - 1] = x, z, slope, area
    put(apparent, SONAR, np.zeros(apparent.tables.shape[1:], np.float32), profile, knots)
    seen_x, seen_z = profile.x[:knots], profile.z[:knots]
    np.testing.assert_allclose(np.hypot(seen_x, seen_z), travelled(gradient, x, z)[0], atol=2e-5)
    # The direction of arrival is that from the sonar, less the half angle that the arc spans.
    x, z, seen_x, seen_z = (0.5 * (values[1:] + values[:-1]) for values in (x, z, seen_x, seen_z))
    arrival = np.arctan(z / x - gradient * (x**2 + z**2) / (2.0 * x * (1500.0 + gradient * z)))
    cosine = np.maximum(slope * np.cos(arrival) - np.sin(arrival), 0.0) / np.sqrt(area)
    found = -profile.facing[: knots - 1] / np.hypot(seen_x, seen_z) / np.sqrt(profile.area[: knots - 1])
    np.testing.assert_allclose(found, cosine, atol=2e-5)


def test_water_that_hardly_bends_is_as_good_as_straight():
    arrays = over(profile(), solids=[((0.0, 20.0, 0.6), 0.5)])
    poses = poses_of([0.0, 0.3], 0.1, SONAR, 0.2)
    for changes in ({}, {"half_width": 0.01}, {"law": 0}, {"law": 0, "half_width": 0.01}):
        straight = sweep.trace(arrays._replace(**changes), poses)
        hardly = arrays._replace(water=water_about(SONAR, [-50.0, 50.0], [1500.0, 1500.00001]), **changes)
        # A step of the horizon or a part of a bin may fall to either side.
        assert np.linalg.norm(sweep.trace(hardly, poses) - straight) < 1e-4 * np.linalg.norm(straight)


def profile(seed=3, nodes=512, rms=0.3):
    """Heights that are the same all along the track, (nodes, 4)."""
    rng = np.random.default_rng(seed)
    f = np.fft.rfftfreq(nodes, 1.0 / nodes)
    amplitude = np.maximum(f, 4.0) ** -1.2
    amplitude[0] = 0.0
    z = np.fft.irfft(amplitude * np.exp(2j * np.pi * rng.random(f.size)), n=nodes)
    return np.repeat((z * (rms / z.std()))[:, None], 4, axis=1)


def in_decibels(a, b, group):
    """Levels of runs of bins against one another, both records 40 log r up, without what is nearer than 14 m."""
    gain = np.arange(a.size)[140:] ** 4.0
    whole = gain.size // group * group
    sums = [(record[140:] * gain)[:whole].reshape(-1, group).sum(axis=1) for record in (a, b)]
    heard = sums[1] > 0.01 * np.median(sums[1])
    return 10.0 * np.log10(sums[0][heard] / sums[1][heard])


@pytest.mark.parametrize(
    ("name", "z"),
    [*((name, SONAR) for name in WATERS), ("around the sonar", 10.0), ("around the sonar", 10.125)],  # between tables
)
def test_a_level_bed_echoes_as_fine_rays_say(name, z):
    arrays = wet(flat(spreading=True), name)
    record = sweep.trace(arrays, poses_of(0.0, 0.0, z))[0, 0].astype(float)
    twin = bent.knife(arrays, z, np.zeros_like, rays=4000, step=0.05)
    # The first bin of the bed may be touched by less than one of the twin's rays.
    assert abs(int(np.argmax(record > 0.0)) - int(np.argmax(twin > 0.0))) <= 1
    for group, bound in {20: 0.1, 40: 0.05, 360: 0.01}.items():
        assert abs(in_decibels(record, twin, group)).max() < bound


@pytest.mark.parametrize("name", ["faster below", "thermocline"])
def test_a_rough_bed_echoes_as_fine_rays_say(name):
    heights = profile()
    arrays = wet(over(heights, spreading=True), name)
    record = sweep.trace(arrays, poses_of(0.0, 0.0, SONAR))[0, 0].astype(float)
    column = heights[:, 0].astype(np.float32).astype(float)
    bed = partial(np.interp, xp=np.arange(column.size) * 0.1, fp=column, period=column.size * 0.1)
    twin = bent.knife(arrays, SONAR, bed, rays=8000)
    assert np.median(abs(in_decibels(record, twin, 5))) < 0.1
    assert abs(in_decibels(record, twin, 360)).max() < 0.05


@pytest.mark.parametrize("name", ["faster below", "faster above", "thermocline"])
@pytest.mark.parametrize(("at", "height"), [(12.0, 0.5), (32.0, 0.7), (40.0, 2.5)])
def test_a_target_and_its_shadow_lie_where_fine_rays_say(name, at, height):
    radius = 0.5
    pipe = ((-5.0, at, height), (5.0, at, height), radius)
    arrays = wet(flat(bins=2500, bin_length=0.02, solids=[pipe]), name)
    record = sweep.trace(arrays, poses_of(0.0, 0.0, SONAR))[0, 0].astype(float)
    twin = bent.knife(arrays, SONAR, np.zeros_like, [(at, height, radius)], rays=8000)
    edges = [np.flatnonzero(np.diff((r > 0.02 * np.median(r[r > 0.0])).astype(int))) for r in (record, twin)]
    assert len(edges[0]) == len(edges[1])
    assert abs(edges[0] - edges[1]).max() <= 1
    near, far = (int((np.hypot(at, SONAR - height) + off) / 0.02) for off in (-0.8, 0.5))
    assert record[near:far].sum() == pytest.approx(twin[near:far].sum(), rel=0.02)


def test_a_ball_of_triangles_is_heard_as_a_ball_and_labelled_where_it_is():
    centre, options = (0.0, 30.0, 0.9), {"half_width": 0.01, "spreading": True}
    ball = flat(solids=[(centre, 0.8)], **options)
    facets = flat(mesh=mesh_of(*icosphere(4, 0.8, centre)), **options)
    poses = poses_of(np.linspace(-0.6, 0.6, 7), 0.0, SONAR)
    one, other = (sweep.trace(wet(arrays, "thermocline"), poses) for arrays in (ball, facets))
    assert np.linalg.norm(other - one) < 0.02 * np.linalg.norm(one)
    truth = trace_labels(wet(ball._replace(half_width=0.0), "thermocline"), poses_of(0.0, 0.0, SONAR))
    hit = truth.target_id[0, 0] == 0
    assert 5 < hit.sum() < 15
    assert ((truth.ground_range[0, 0, hit] > 29.2) & (truth.ground_range[0, 0, hit] < 30.4)).all()


def test_a_fan_widens_with_the_azimuth_it_takes_in():
    # A knife's strip is 1 m wide; a narrow fan's, at x, x times the azimuths within its cone: w / cosθ0.
    half_width, poses = 0.002, poses_of(0.0, 0.0, SONAR)
    knife = flat(spreading=True)
    one = sweep.trace(wet(knife, "thermocline"), poses)[0, 0, 200:].astype(float)
    fan = wet(knife._replace(half_width=half_width), "thermocline")
    other = sweep.trace(fan, poses, planes=2)[0, 0, 200:].astype(float)
    x = np.linspace(5.0, 52.0, 2000)
    level, rise, _, _ = read(fan, SONAR, x, np.zeros_like(x)).T
    seen_x, seen_z = x * (1.0 + level), rise - SONAR
    r = np.hypot(seen_x, seen_z)
    width = np.interp((np.arange(200, 500) + 0.5) * 0.1, r, 2.0 * half_width * x * r / seen_x)
    np.testing.assert_allclose(other / one, width, rtol=2e-3)


@pytest.mark.parametrize("name", WATERS)
def test_truth_tells_true_ground_ranges_and_incidences(name):
    arrays = wet(flat(), name)
    truth = trace_labels(arrays, poses_of(0.0, 0.0, SONAR))
    x = np.linspace(0.01, 52.0, 4000)
    level, rise, _, turn = read(arrays, SONAR, x, np.zeros_like(x)).T
    seen_x, seen_z = x * (1.0 + level), rise - SONAR
    r, arrival = np.hypot(seen_x, seen_z), np.arctan2(seen_z, seen_x) + turn
    edges = np.interp(np.arange(120, 501) * 0.1, r, x)
    found = truth.ground_range[0, 0, 120:]
    assert ((edges[:-1] - 1e-3 <= found) & (found <= edges[1:] + 1e-3)).all()
    expected = 90.0 + np.degrees(np.interp(found, x, arrival))
    np.testing.assert_allclose(truth.incidence[0, 0, 120:], expected, atol=0.1)


@pytest.mark.parametrize(("gradient", "limit"), [(5.0, 111.36), (0.5, 346.99)])
def test_the_bed_is_unseen_beyond_the_limiting_range(gradient, limit):
    # Sound faster below, R = c_b / g: unseen beyond √(2Rh - h²).
    height, speed = 20.0, 1500.0
    speeds = [speed + gradient * 120.0, speed - gradient * 80.0]
    arrays = arrays_of(FLAT, 0.25, periodic=True, bins=400, bin_length=1.0)
    arrays = arrays._replace(water=water_about(height, [-100.0, 100.0], speeds))
    truth = trace_labels(arrays, poses_of(0.0, 0.0, height))
    # The very last of it is as faint as it is level with the sound.
    assert np.nanmax(truth.ground_range[0, 0]) == pytest.approx(limit, abs=1.5)
    assert (truth.target_id[0, 0, int(limit) + 3 : 380] == -2).all()


def test_tables_too_large_and_waters_in_which_places_echo_twice_are_left_to_rays():
    water = water_about(SONAR, [-200.0, 200.0], [1500.0, 1499.9], surface=3000.0)
    for high, left in ((1.0, False), (2000.0, True)):
        peak = arrays_of(high * np.eye(4), 0.5, periodic=True, bins=1000, bin_length=1.0)
        apparent, folded = make_apparent_tables(peak._replace(water=water), poses_of(0.0, 0.0, SONAR))
        assert folded.all() == left
        assert apparent.tables.nbytes < 2e6
    # A strong duct over the bed: rays launched upwards come back to it.
    arrays = arrays_of(FLAT, 0.5, periodic=True, bins=3000, bin_length=0.1)
    duct = arrays._replace(water=water_about(SONAR, [-50.0, 12.0, 16.0, 50.0], [1490.0, 1490.0, 1500.0, 1500.0]))
    _, folded = make_apparent_tables(duct, poses_of(0.0, 0.0, [SONAR, SONAR + 0.5]))
    assert folded.all()
    _, folded = make_apparent_tables(duct._replace(bins=500), poses_of(0.0, 0.0, SONAR))
    assert not folded.any()
    # Beneath a surface near by, the far bed is in its shadow.
    arrays = arrays._replace(water=water_about(SONAR, [-50.0, 50.0], [1450.0, 1550.0], surface=SONAR + 2.0))
    _, folded = make_apparent_tables(arrays, poses_of(0.0, 0.0, SONAR))
    assert folded.all()
