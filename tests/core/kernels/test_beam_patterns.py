"""Beams with patterns on a fish that pitches and rolls: against dense sums over a level bed."""

import itertools
import math

import numpy as np
import pytest

from beds import arrays_of, gaussian_pattern, poses_of, rough, tabulated_pattern
from insonify.acoustics.beam_patterns import make_pattern
from insonify.compiler.jit import kernel
from insonify.kernels.beam.azimuth_sector import AzimuthSector, sector_weight
from insonify.kernels.beam.knot_weights import weigh_knots
from insonify.kernels.beam.pattern import integrated_response
from insonify.kernels.beam.pattern_samples import FINE_SINE, ROOM, SampleRoom, sample_pattern
from insonify.kernels.common.types import EVERY_GRAZING, GAUSSIAN, LIGHT, SONAR, TABLE, TOP_HAT
from insonify.scene import edit, load_scene
from insonify.scene.sonar.beams import BeamConditions
from insonify.scene.sonar.beams.line_array import LineArray
from insonify.tracers import rays

FLAT = np.zeros((8, 8))
HEIGHT = 8.0


def top_hat(half_width, columns=65):
    """The top-hat of a level fan, as a table."""
    return tabulated_pattern(math.sin(half_width), np.ones(columns))


def axes(heading, pitch, roll):
    """Unit vectors of the fish: ahead, port, up."""
    ch, sh, cp, sp = math.cos(heading), math.sin(heading), math.cos(pitch), math.sin(pitch)
    ahead, port, up = np.array([cp * ch, cp * sh, sp]), np.array([-sh, ch, 0.0]), np.array([-sp * ch, -sp * sh, cp])
    return ahead, math.cos(roll) * port + math.sin(roll) * up, math.cos(roll) * up - math.sin(roll) * port


def heard(pattern, fish, side, direction, r):
    """Sensitivity in directions (n, 3) at slant ranges (n,): (along the track, vertical)."""
    ahead, port, up = fish
    rows = pattern.extent.size
    place = np.clip(np.log2(r / pattern.first_range) * pattern.per_octave, 0.0, rows - 1.0)
    share = np.linspace(-1, 1, pattern.energy.shape[1])
    sines = pattern.centre + pattern.extent[:, None] * share
    columns = [np.interp(direction @ ahead, sines[k], pattern.energy[k], left=0.0, right=0.0) for k in range(rows)]
    along = sum(column * np.maximum(1.0 - np.abs(place - k), 0.0) for k, column in enumerate(columns))
    own = direction @ port * (1.0 if side == 0 else -1.0)
    w = (direction @ up) * math.cos(pattern.tilt) + own * math.sin(pattern.tilt)
    if pattern.vertical == TOP_HAT:
        return along, 1.0 * (np.abs(w) <= pattern.s_vertical)
    if pattern.vertical == GAUSSIAN:
        return along, 2.0 ** (-((w / pattern.s_vertical) ** 2) * (2 if pattern.two_way else 1))
    if pattern.vertical == TABLE:
        return along, np.interp(w, np.linspace(-1.0, 1.0, pattern.vertical_energy.size), pattern.vertical_energy)
    return along, np.ones_like(r)


def level_bed(arrays, heading, pitch, roll):
    """Record of a Lambert bed by a dense sum over slant range and azimuth, (2, bins)."""
    fish = axes(heading, pitch, roll)
    # Finer below the fish, where a beam opens from all azimuths to a few within centimetres.
    near, far = np.linspace(HEIGHT, 9.0, 257), np.linspace(9.0, arrays.bins * arrays.bin_length, 497)
    edges = np.concatenate([near, far[1:]])
    r, dr = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    out = np.zeros((2, arrays.bins))
    azimuth = (np.arange(3000) + 0.5) / 3000 * math.pi - math.pi / 2  # from athwart
    for side in (0, 1):
        turned = heading + (math.pi / 2 - azimuth if side == 0 else azimuth - math.pi / 2)
        for k in range(r.size):
            c = math.sqrt(1.0 - (HEIGHT / r[k]) ** 2)
            direction = np.column_stack([c * np.cos(turned), c * np.sin(turned), np.full(3000, -HEIGHT / r[k])])
            along, vertical = heard(arrays.pattern, fish, side, direction, np.full(3000, r[k]))
            if arrays.law == LIGHT:
                # Averaged along the track, weighted by the vertical beam.
                value = HEIGHT / r[k] * (along * vertical).sum() / max(along.sum(), 1e-300) * dr[k] / arrays.bin_length
            else:
                # dA = r dr dφ, σ = cos²α / π.
                value = (HEIGHT / r[k]) ** 2 / math.pi * (along * vertical).sum() * math.pi / 3000 * r[k] * dr[k]
            out[side, int(r[k] / arrays.bin_length)] += value
    return out


LOBES = np.sinc(1.5 * np.linspace(-1.0, 1.0, 1025)) ** 4
TABULATED = gaussian_pattern(0.05, vertical=TABLE, tilt=0.3, vertical_width=np.pi)
CASES = {
    "vertical lobes": (TABULATED._replace(vertical_energy=LOBES), (0.0, -0.1)),
    "narrow": (gaussian_pattern(0.02), (0.0, 0.0)),
    "wide": (gaussian_pattern(0.3, two_way=False), (0.0, 0.0)),
    "squint": (gaussian_pattern(0.05, squint=0.4), (0.0, 0.0)),
    "near field": (gaussian_pattern(0.02, near_width=0.2), (0.0, 0.0)),
    "pitched": (gaussian_pattern(0.05), (0.15, 0.0)),
    "tilted fan": (gaussian_pattern(0.05, vertical=TOP_HAT, tilt=0.4, vertical_width=0.5), (0.0, 0.0)),
    "tilted, rolled": (gaussian_pattern(0.05, vertical=GAUSSIAN, tilt=0.4, vertical_width=0.6), (0.0, 0.2)),
    "all": (gaussian_pattern(0.08, squint=-0.1, vertical=GAUSSIAN, tilt=0.3, two_way=False), (-0.1, -0.15)),
}


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("case", CASES)
def test_a_level_bed_is_the_sum_over_it(case, law):
    pattern, (pitch, roll) = CASES[case]
    arrays = arrays_of(FLAT, 4.0, periodic=True, law=law, half_width=0.03, pattern=pattern, bins=80, bin_length=0.5)
    record = rays.trace(arrays, poses_of(1.0, 2.0, HEIGHT, 0.3, pitch, roll), rays=1 << 16)[0]
    truth = level_bed(arrays, 0.3, pitch, roll)
    # A hard edge of the vertical beam falls within a bin, which the sum resolves to an eighth.
    bound = 0.02 if pattern.vertical == TOP_HAT else 0.003
    assert np.linalg.norm(record[:, 18:] - truth[:, 18:]) < bound * np.linalg.norm(truth[:, 18:])
    assert np.abs(record[:, :18].sum(axis=1) - truth[:, :18].sum(axis=1)).max() < 0.004 * truth.sum(axis=1).max()


@pytest.mark.parametrize("law", [LIGHT, SONAR])
def test_a_top_hat_from_a_table_is_the_top_hat(law):
    half_width = math.radians(1.5)
    options = {"periodic": True, "law": law, "half_width": half_width, "bins": 120, "bin_length": 0.3}
    heights, ball = rough(64, 64, 0.15), ((3.0, 12.0, 0.6), 0.5)
    plain = arrays_of(heights, 0.5, solids=[ball], **options)
    tabulated = plain._replace(pattern=top_hat(half_width))
    one, other = (rays.trace(arrays, poses_of(3.0, 1.0, 6.0, 0.1), rays=1 << 17) for arrays in (tabulated, plain))
    assert np.linalg.norm(one - other) < 0.01 * np.linalg.norm(other)


@pytest.mark.parametrize("law", [LIGHT, SONAR])
def test_a_knife_knows_its_vertical_beam(law):
    pattern = gaussian_pattern(0.02, vertical=GAUSSIAN, tilt=0.5, vertical_width=0.4)
    plain = arrays_of(FLAT, 4.0, periodic=True, law=law, bins=150, bin_length=0.2)
    scenes, pose = (plain._replace(pattern=pattern), plain), poses_of(0.0, 0.0, HEIGHT, roll=0.1)
    record, bare = (rays.trace(arrays, pose, rays=8000)[0, 0] for arrays in scenes)
    theta = np.arcsin(HEIGHT / ((np.arange(45, 150) + 0.5) * 0.2))
    # Port up: the axis lies at 0.5 - 0.1 below the horizon, on the athwart plane itself.
    weight = 2.0 ** (-2.0 * (np.sin(theta - 0.4) / math.sin(0.2)) ** 2)
    # The middle of a bin stands for all of it.
    np.testing.assert_allclose(record[45:], bare[45:] * weight, rtol=0.01, atol=1e-3 * record.max())


def test_the_mixture_of_azimuths_converges_on_sidelobes_too():
    # A narrow lobe on a floor 30 dB down that spans half the sphere: both halves of the energy come out.
    energy = np.maximum(2.0 ** (-2.0 * (np.linspace(-0.9, 0.9, 4001) / 0.005) ** 2), 1e-3)
    pattern = tabulated_pattern(0.9, energy)
    arrays = arrays_of(FLAT, 4.0, periodic=True, half_width=0.005, pattern=pattern, bins=80, bin_length=0.5)
    truth = level_bed(arrays, 0.0, 0.0, 0.0)
    errors = []
    for count in (1 << 12, 1 << 14, 1 << 16):
        record = rays.trace(arrays, poses_of(0.0, 0.0, HEIGHT), rays=count)[0]
        errors.append(np.linalg.norm(record[:, 18:] - truth[:, 18:]) / np.linalg.norm(truth[:, 18:]))
    assert errors[2] < 0.01
    assert errors[2] < 0.5 * errors[0]


def test_attitude_matters_only_to_patterns():
    arrays = arrays_of(rough(64, 64, 0.15), 0.5, periodic=True, half_width=0.02)
    still, swung = (rays.trace(arrays, poses_of(0.0, 0.0, 8.0, 0.2, *a), rays=500) for a in ((0, 0), (0.1, 0.2)))
    np.testing.assert_array_equal(still, swung)


@pytest.mark.parametrize(("length", "distance"), [(0.3, 5.0), (1.0, 10.0), (1.0, 30.0), (2.0, 20.0), (2.0, 50.0)])
def test_the_near_field_between_two_rows_is_that_of_the_array(length, distance):
    """The exact sum over the array, element by element, without Fresnel's approximation."""
    wavelength = 1500.0 / 400e3
    table = LineArray(length=length, two_way=True).tabulate(BeamConditions(wavelength, 1.0, 200.0))
    s = np.linspace(-1.0, 1.0, 801) * (0.6 * length / distance + 3.0 * wavelength / length)
    place = ((np.arange(2048) + 0.5) / 2048 - 0.5)[:, None] * length
    way = np.sqrt(distance**2 - 2.0 * distance * s * place + place**2)
    right = np.abs(np.exp(2j * np.pi / wavelength * way).mean(axis=0)) ** 4
    row, share = divmod(math.log2(distance / table.first_range) * table.per_octave, 1.0)
    one, other = (
        np.interp(s, np.linspace(-table.extent[k], table.extent[k], table.energy.shape[1]), table.energy[k])
        for k in (int(row), int(row) + 1)
    )
    found = one + share * (other - one)
    assert np.linalg.norm(found - right) < 0.02 * np.linalg.norm(right)


@kernel
def integrate_along(pattern, x, z, r, sector, room, many, single):
    parts = pattern.centre, pattern.extent, pattern.integral, pattern.first_range, pattern.per_octave
    sample_pattern(x, z, r, sector, pattern, FINE_SINE, room, many)
    for i in range(x.size):
        level, tip = sector.ahead_level * x[i] / r[i], sector.ahead_up * z[i] / r[i]
        single[i] = integrated_response(*parts, level * sector.s_low + tip, level * sector.s_high + tip, r[i])


@kernel
def weigh(pattern, x, z, r, sector, law, room, weights, each):
    weigh_knots(x, z, r, sector, pattern, law, FINE_SINE, room, weights)
    for i in range(x.size):
        each[i] = sector_weight(x[i], z[i], r[i], sector, pattern, law) if x[i] > 0.0 else 0.0


def sample_room(knots):
    return SampleRoom(np.empty(knots + ROOM, np.int32), *np.empty((4, knots + ROOM)))


def sector_between(s_low, s_high, pitch, main):
    angle = math.asin(s_high) - math.asin(s_low)
    return AzimuthSector(
        s_low, s_high, angle, 0.0, math.inf, main, 2.0 * main, True, False,
        math.cos(pitch), math.sin(pitch), 1.0, 0.0, 0.0, 1.0,
    )  # fmt: skip


@pytest.mark.parametrize("rows", [1, 2, 61])
def test_integrals_at_one_place_are_those_of_the_table(rows):
    rng = np.random.default_rng(rows)
    extent = np.linspace(0.9, 0.3, rows)
    energy = rng.uniform(0.0, 1.0, (rows, 129))
    pattern = tabulated_pattern(extent, energy, centre=0.05, first_range=2.0, per_octave=8.0)
    x, z = np.linspace(0.0, 400.0, 501), rng.uniform(-12.0, -8.0, 501)
    many, single = np.empty((2, 501))
    sector = sector_between(-0.3, 0.4, 0.2, 0.1)
    integrate_along(pattern, x, z, np.hypot(x, z), sector, sample_room(x.size), many, single)
    place = np.clip(np.log2(np.hypot(x, z) / 2.0) * 8.0, 0.0, rows - 1.0)
    level, tip = sector.ahead_level * x / np.hypot(x, z), sector.ahead_up * z / np.hypot(x, z)
    expected = np.zeros(501)
    for k in range(rows):
        columns = 0.05 + extent[k] * np.linspace(-1.0, 1.0, 129)
        low, high = (np.interp(level * border + tip, columns, pattern.integral[k]) for border in (-0.3, 0.4))
        expected += (high - low) * np.maximum(1.0 - np.abs(place - k), 0.0)
    np.testing.assert_allclose(single, expected, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("knots", [0, 1, 2, 3, 8, 9, 10, 17, 130, 1001])
@pytest.mark.parametrize("rows", [1, 61])
def test_every_knot_of_a_profile_of_any_length_is_weighed(knots, rows):
    """From nadir, where all knots are read, to far ranges, where few are; no other entry is touched."""
    extent = np.linspace(0.3, 0.1, rows)
    energy = np.sinc(np.linspace(-1.0, 1.0, 2049) * extent[:, None] / 0.02) ** 4
    pattern = tabulated_pattern(extent, energy, first_range=2.0, per_octave=8.0)
    x, z = np.arange(knots) * 0.1, np.full(knots, -10.0)
    many, single = np.full((2, knots + 8), 7.0)
    sector = sector_between(0.004, 0.011, 0.0, 0.02)
    integrate_along(pattern, x, z, np.hypot(x, z), sector, sample_room(knots), many[:knots], single[:knots])
    found, exact = many[:knots], single[:knots]
    np.testing.assert_allclose(found, exact, rtol=1e-2, atol=1e-9 + 1e-3 * exact.max(initial=0.0))
    assert np.all(many[knots:] == 7.0)


@pytest.mark.parametrize("pitch", [0.0, 0.05])
@pytest.mark.parametrize("squint", [0.0, 0.08])
@pytest.mark.parametrize("law", [SONAR, LIGHT])
def test_a_pattern_between_the_knots_where_it_is_read_is_that_of_each_knot(pitch, squint, law):
    """Over a rough bed with a hole: the weights of every sector, and their sum."""
    rng, main = np.random.default_rng(5), 0.014
    pattern = tabulated_pattern(0.08, np.sinc(np.linspace(-0.08, 0.08, 2049) / (0.9 * main)) ** 4, centre=squint)
    x = np.linspace(0.0, 50.0, 501)
    z = -10.0 + np.convolve(rng.normal(0.0, 0.25, 505), np.ones(5) / 5.0, "valid")
    z[200] = np.nan
    r, known = np.hypot(x, z), np.isfinite(z) & (x > 0.0)
    found, exact = np.zeros((2, 501))
    for s_low, s_high in itertools.pairwise(math.sin(math.asin(squint) + k * main / 4.0) for k in range(-12, 13)):
        sector = sector_between(s_low, s_high, pitch, main)
        weights, each = np.empty(501), np.empty(501)
        weigh(pattern, x, z, r, sector, law, sample_room(501), weights, each)
        # A sector of the main lobe has a fourth of half its width, and about a fifth of the beam.
        of_axis = 0.25 * main * r if law == SONAR else 0.2
        off = np.abs((weights - each) / of_axis)[known]
        # Turned away from athwart, a sector's place in the beam moves with every bump of the bed.
        assert off.max() < (0.1 if squint or pitch else 0.002)
        assert np.sqrt(np.mean(off**2)) < (0.01 if squint or pitch else 0.0002)
        found, exact = found + weights, exact + each
    assert abs(found[known].sum() / exact[known].sum() - 1.0) < 2e-4


@pytest.mark.parametrize("planes", [8, 64, 512])
def test_no_sector_crosses_a_squinting_top_hat_between_two_knots_where_it_is_read(planes):
    """Near nadir planes far off the axis are in the beam for some knots alone; narrow ones enter within one."""
    pattern = top_hat(0.04)._replace(centre=0.165)
    x = np.arange(0.0, 15.0, 0.1)
    z = np.full(x.size, -3.5)
    r = np.hypot(x, z)
    borders = np.linspace(0.0, 1.0, planes + 1)
    summed, expected = np.zeros((2, x.size))
    for low, high in itertools.pairwise(borders):
        many, single = np.empty((2, x.size))
        integrate_along(pattern, x, z, r, sector_between(low, high, 0.0, 0.04), sample_room(x.size), many, single)
        np.testing.assert_allclose(many, single, atol=0.02 * max(single.max(), 1e-9))
        summed, expected = summed + many, expected + single
    np.testing.assert_allclose(summed, expected, atol=2e-3 * expected.max())


@pytest.mark.parametrize("pitch", [0.0, 0.05])
@pytest.mark.parametrize("squint", [0.0, 0.08])
@pytest.mark.parametrize("vertical", [EVERY_GRAZING, GAUSSIAN])
def test_a_top_hat_of_two_columns_has_the_exact_weight_at_every_knot(pitch, squint, vertical):
    """Over a rough bed with a hole, by a table of many columns at every single knot."""
    many, two = (
        top_hat(0.014, columns)._replace(centre=squint, vertical=vertical, tilt=0.5, s_vertical=0.6)
        for columns in (65, 2)
    )
    x = np.linspace(0.0, 50.0, 501)
    z = -10.0 + np.random.default_rng(5).normal(0.0, 0.1, 501)
    z[200] = np.nan
    r, known, heard_of = np.hypot(x, z), np.isfinite(z), 0
    for s_low, s_high in itertools.pairwise(math.sin(math.asin(squint) + 0.0035 * k) for k in range(-12, 13)):
        sector = sector_between(s_low, s_high, pitch, 0.014)
        found, expected = np.empty((2, 501))
        weigh(two, x, z, r, sector, SONAR, sample_room(501), found, np.empty(501))
        weigh(many, x, z, r, sector, SONAR, sample_room(501), np.empty(501), expected)
        np.testing.assert_allclose(found[known], expected[known], rtol=1e-9, atol=1e-12)
        heard_of += np.count_nonzero(found[known])
    assert heard_of > 1000


def test_a_top_hat_is_packed_as_two_columns_and_an_array_as_many():
    scene = edit(load_scene("default"), {"sonar.vertical": "fan"})
    _, fan = make_pattern(scene, 1500.0)
    _, array = make_pattern(edit(scene, {"sonar.beam": "array"}), 1500.0)
    assert fan.energy.shape == fan.integral.shape == (1, 2)
    assert array.integral.shape[1] > 2
