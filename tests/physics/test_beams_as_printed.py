"""Beams, along the track and vertical, against what is printed of them, and what they do to a record."""

import math

import numpy as np
import pytest

from beds import arrays_of, poses_of
from insonify.acoustics.beam_patterns import make_pattern
from insonify.kernels.beam.pattern import vertical_responses
from insonify.scene import edit, load_scene
from insonify.scene.sonar.beams import BeamConditions
from insonify.scene.sonar.beams.line_array import LineArray, taper_weights
from insonify.simulation import prepare, simulate
from insonify.tracers import sweep
from insonify.tracers.azimuth_fan import lay_planes

WAVELENGTH = 1500.0 / 400e3
LENGTH = 0.5
BARE = {"seabed.relief": "flat", "targets": [], "sonar.pulse": "ideal"}
LEVEL = edit(load_scene("default"), BARE | {"sonar.range": 48.0, "sonar.bins": 480, "water.sound_speed": 1500.0})


def width_at_half(extent, energy):
    """Full width between the outermost sines, within an extent, where the energy passes half its greatest value."""
    s, half = np.linspace(-extent, extent, energy.size), 0.5 * energy.max()
    first, last = np.flatnonzero(energy >= half)[[0, -1]]
    left = np.interp(half, energy[first - 1 : first + 1], s[first - 1 : first + 1])
    right = np.interp(-half, -energy[last : last + 2], s[last : last + 2])
    return right - left


def sidelobe(energy):
    """Greatest value beyond the first minimum on the bow's side, in dB below the axis."""
    half = energy[energy.size // 2 :]
    first_null = int(np.argmax(np.diff(half) > 0.0))
    return 10.0 * math.log10(half[first_null:].max() / half[0])


@pytest.mark.parametrize(
    ("taper", "one_way", "both_ways", "decibels"),
    [
        ("uniform", 0.886, 0.638, -13.26),
        ("cosine", 1.189, 0.851, -23.0),
        ("hamming", 1.304, 0.929, -42.7),
        ("taylor", 1.125, 0.804, -30.0),
    ],
)
def test_far_patterns_are_as_printed(taper, one_way, both_ways, decibels):
    for passes, width in ((1, one_way), (2, both_ways)):
        beam = LineArray(length=LENGTH, taper=taper, two_way=passes == 2)
        _, extent, energy, _ = beam.tabulate(BeamConditions(WAVELENGTH, 1.0, 1e5))
        assert width_at_half(extent[-1], energy[-1]) * LENGTH / WAVELENGTH == pytest.approx(width, abs=0.004)
        # Taylor's design of so few equal sidelobes comes out at -30.3 dB.
        assert sidelobe(energy[-1]) == pytest.approx(passes * decibels, abs=0.35 * passes)


@pytest.mark.parametrize("quarter", [0, 9, 20])
@pytest.mark.parametrize("taper", ["uniform", "taylor"])
def test_the_near_field_is_the_integral_over_the_array(taper, quarter):
    beam = LineArray(length=LENGTH, taper=taper, two_way=False)
    first_range, extent, energy, per_octave = beam.tabulate(BeamConditions(WAVELENGTH, 1.0, 400.0))
    r, row = first_range * 2.0 ** (quarter / 4.0), round(quarter * per_octave / 4.0)
    u = (np.arange(8192) + 0.5) / 8192 - 0.5
    weights = np.interp(u, (np.arange(1024) + 0.5) / 1024 - 0.5, taper_weights(taper))
    place, s = u * LENGTH, np.linspace(-extent[row], extent[row], energy.shape[1])[::16]
    phase = 2.0 * math.pi / WAVELENGTH * (place**2 / (2.0 * r) - s[:, None] * place)
    direct = np.abs((weights * np.exp(1j * phase)).sum(axis=1) / weights.sum()) ** 2
    # As near as r = L the phase turns by 0.4 rad from one of its 1024 elements to the next.
    np.testing.assert_allclose(energy[row, ::16], direct, atol=(1e-3 if quarter == 0 else 1e-4) * direct.max())


def test_the_cell_along_the_track_is_the_array_near_by_and_the_beam_far_away():
    far_off = BeamConditions(WAVELENGTH, 1.0, 4.0 * LENGTH**2 / WAVELENGTH)
    first_range, extent, energy, per_octave = LineArray(length=LENGTH, two_way=False).tabulate(far_off)
    ranges = first_range * 2.0 ** (np.arange(extent.size) / per_octave)
    ranges, extent, energy = (column[:: round(per_octave / 4.0)] for column in (ranges, extent, energy))
    cells = [r * width_at_half(e, b) for r, e, b in zip(ranges, extent, energy, strict=True)]
    far = ranges * 0.886 * WAVELENGTH / LENGTH
    ratio = np.array(cells) / np.maximum(LENGTH, far)
    # The widest lobe of Fresnel's fringes narrows to 0.36 of this, the focus of an unfocused array at r = 0.3 L²/λ.
    assert ratio.max() < 1.08
    assert ratio.min() > 0.35
    np.testing.assert_allclose(ratio[:8], 1.0, atol=0.125)
    np.testing.assert_allclose(ratio[ranges > 2.0 * LENGTH**2 / WAVELENGTH], 1.0, atol=0.02)


@pytest.mark.parametrize("taper", ["uniform", "cosine", "hamming", "taylor"])
def test_curvature_moves_energy_and_makes_none(taper):
    # Parseval: ∫ b ds = λ ∫ w² du / (∫ w du)² whatever the curvature; what lies beyond the table is under 1 %.
    beam = LineArray(length=LENGTH, taper=taper, two_way=False)
    _, extent, energy, _ = beam.tabulate(BeamConditions(WAVELENGTH, 1.0, 200.0))
    whole, weights = np.trapezoid(energy, axis=1) * 2.0 * extent / (energy.shape[1] - 1), taper_weights(taper)
    np.testing.assert_allclose(whole, WAVELENGTH / LENGTH * (weights**2).mean() / weights.mean() ** 2, rtol=0.01)


@pytest.mark.parametrize(("two_way", "times"), [(False, 1.0), (True, math.sqrt(0.5))])
def test_a_gaussian_is_as_wide_as_it_says(two_way, times):
    beam = {"kind": "gaussian", "width": 2.0, "two_way": two_way}
    _, pattern = make_pattern(edit(LEVEL, {"sonar.beam": beam}), 1500.0)
    width = width_at_half(pattern.extent[0], pattern.energy[0])
    assert width == pytest.approx(2.0 * math.sin(math.radians(1.0)) * times, rel=1e-3)


def test_a_top_hat_from_a_table_is_the_fan():
    # Planes lie elsewhere for a fan with a squint, be it ever so small; on a smooth bed that makes no odds.
    fan = edit(LEVEL, {"sonar.beam": {"kind": "fan", "width": 2.5}, "track.pings": 1})
    plain = simulate(fan).intensity.values
    tabled = simulate(edit(fan, {"sonar.beam.squint": 1e-6})).intensity.values
    np.testing.assert_allclose(tabled[..., 110:], plain[..., 110:], rtol=5e-3)


ALTITUDE = 4.0


def profile(simulation, slant, along, bodies, planes, across=0):
    """Energy of balls, by their places along the track and radii, on a bed all but black, by the fish's place."""
    x, given = math.sqrt(slant**2 - ALTITUDE**2), simulation.arrays
    solids, reflectivity = [((at, -x, 0.0), radius) for at, radius in bodies], [(1e-9, 0.0, 1.0), (1.0, 0.0, 1.0)]
    sonar = {name: getattr(given, name) for name in ("half_width", "pattern", "bins", "bin_length")}
    arrays = arrays_of(np.zeros((8, 8)), 16.0, periodic=True, solids=solids, reflectivity=reflectivity, **sonar)
    arrays = arrays._replace(solids=arrays.solids._replace(material=np.ones(len(bodies), np.int64)))
    record = sweep.trace(arrays, poses_of(along, 0.0, ALTITUDE), planes=planes, across=across)
    return record[:, 1].sum(axis=1, dtype=float)


def dip_between(simulation, slant):
    """Share by which the echo of two balls a metre apart falls between them, a ping every 5 cm to one side."""
    found = profile(simulation, slant, np.arange(15) * 0.05, [(-0.5, 0.15), (0.5, 0.15)], 256)
    return 1.0 - found[0] / found.max()


# A sinc² of 2.5 degrees to -3 dB at 1 MHz; its far field begins at 0.6 m.
SHORT = math.degrees(0.88589 * 1500.0 / 1e6) / 2.5


@pytest.mark.parametrize(
    ("beam", "merged", "no_dip"),
    [
        ({"kind": "fan", "width": 2.5}, 22.9, 22.9),
        ({"kind": "fan", "width": 2.5, "squint": 1e-6}, 22.9, 22.9),
        ({"kind": "gaussian", "width": 2.5, "two_way": False}, 26.5, 27.0),
        ({"kind": "gaussian", "width": 2.5}, 37.5, 38.2),
        ({"kind": "array", "length": SHORT, "two_way": False}, 24.2, 24.5),
        ({"kind": "array", "length": SHORT}, 35.3, 35.8),
    ],
)
def test_a_pair_merges_where_figure_4_has_it(beam, merged, no_dip):
    simulation = prepare(edit(LEVEL, {"sonar.beam": beam, "sonar.frequency": 1e6}))
    assert dip_between(simulation, 0.97 * merged) > 1e-3
    assert dip_between(simulation, 1.03 * merged) < 1e-3
    assert dip_between(simulation, 0.97 * no_dip) > 1e-3
    assert dip_between(simulation, 1.03 * no_dip) < 2e-4


def test_a_knife_never_merges_a_pair():
    simulation = prepare(edit(LEVEL, {"sonar.beam": "knife"}))
    for slant in (10.0, 30.0, 47.0):
        assert dip_between(simulation, slant) > 0.99


@pytest.mark.parametrize(("two_way", "decibels"), [(False, -13.26), (True, -26.52)])
def test_a_ball_is_heard_in_the_sidelobes_as_the_pattern_has_them(two_way, decibels):
    # A far-field array of 3 degrees, as many planes as its plan lays; the sidelobes pass the ball without a comb. Their
    # nulls, 30 dB below the main lobe, count in decibels here: a tolerance of 3 % of the energy leaves them 1.7 dB off.
    radius, slant, length, wavelength = 0.3, 30.0, 0.025, 1.5e-3
    changes = {"sonar.beam": {"kind": "array", "length": length, "two_way": two_way}, "sonar.frequency": 1e6}
    ball = {"kind": "sphere", "position": [0.0, -29.0], "radius": radius}
    model = prepare(edit(LEVEL, changes | {"targets": [ball]}), tolerance=0.005).plan.model
    along = np.arange(0.0, 8.0, 0.1)
    found = profile(prepare(edit(LEVEL, changes)), slant, along, [(0.0, radius)], model.planes, model.across)
    # A Lambert ball sends back (1 - (y/a)²)^1.5 along its own length.
    y = np.linspace(-radius, radius, 41)[1:-1]
    share = (1.0 - (y / radius) ** 2) ** 1.5
    place = along[:, None] + y
    pattern = np.sinc(length / wavelength * place / np.hypot(slant, place)) ** (4 if two_way else 2)
    expected = (pattern * share).sum(axis=1) / (pattern[0] * share).sum()
    heard = expected > 1e-3
    error = 10.0 * np.log10(found[heard] / found[0] / expected[heard])
    assert np.sqrt((error**2).mean()) < 0.5
    assert np.abs(error).max() < 2.0
    first_sidelobe = found[(along > 2.0) & (along < 3.5)].max() / found[0]
    assert 10.0 * math.log10(first_sidelobe) == pytest.approx(decibels, abs=0.7)


def test_targets_in_sidelobes_have_planes_of_their_own():
    ball = {"kind": "sphere", "position": [0.0, -29.0], "radius": 0.3}
    arrays = prepare(edit(LEVEL, {"sonar.beam": {"kind": "array", "length": 0.3}, "targets": [ball]})).arrays
    sidelobe = 1.43 * WAVELENGTH / 0.3  # the sine of the highest one
    poses = poses_of(-29.0 * sidelobe, 0.0, 10.0)
    alone, divided = (lay_planes(arrays, poses, 16, across=across).of(0) for across in (0, 4))
    filled = np.abs(divided.azimuth - math.atan(-sidelobe)) < 0.3 / 29.0
    assert alone.azimuth.size < 60
    assert filled.sum() >= 4
    few, many = (sweep.trace(arrays, poses, planes=planes, across=4)[0] for planes in (16, 256))
    assert np.linalg.norm(few - many) < 0.02 * np.linalg.norm(many)


DOWN = np.radians(np.linspace(0.0, 89.0, 300))  # depressions


def responses(vertical, down=DOWN, **changes):
    """Two-way response at depressions."""
    scene = edit(load_scene("default"), {"sonar.vertical": vertical} | changes)
    _, pattern = make_pattern(scene, 1500.0)
    out = np.empty(down.size)
    vertical_responses(pattern, -down, out)
    return out


@pytest.mark.parametrize("height", [0.005, 0.02, 0.2])
def test_a_uniform_array_has_its_lobes(height):
    # One way sin²(x)/x² with x = πh sin(angle)/λ, two ways its square (Urick 1983, ch. 3).
    exact = np.sinc(height / WAVELENGTH * np.sin(DOWN - math.radians(30.0))) ** 4
    np.testing.assert_allclose(responses({"kind": "array", "height": height, "tilt": 30.0}), exact, atol=4e-3)


def test_a_taper_lowers_the_sidelobes():
    far = np.abs(np.sin(DOWN - math.radians(30.0))) > 2.2 * WAVELENGTH / 0.02
    array = {"kind": "array", "height": 0.02, "tilt": 30.0}
    uniform, hamming = (responses(array | {"taper": taper})[far].max() for taper in ("uniform", "hamming"))
    assert hamming < 1e-3 * uniform


def test_a_table_is_what_was_measured_which_a_one_way_beam_takes_once():
    levels = [[-90.0, -40.0], [-20.0, -10.0], [0.0, 0.0], [40.0, -6.0]]
    table = {"kind": "table", "tilt": 25.0, "levels": levels}
    twice, once = responses(table), responses(table, **BEAMS[False])
    one_way = np.interp(np.degrees(DOWN) - 25.0, *np.array(levels).T)
    np.testing.assert_allclose(10.0 * np.log10(twice), 2.0 * one_way, atol=0.02)
    np.testing.assert_allclose(once**2, twice, rtol=1e-5)


BEAMS = {two_way: {"sonar.beam": {"kind": "gaussian", "width": 1.0, "two_way": two_way}} for two_way in (False, True)}
ROLL = {"track.motion": {"kind": "roll", "amplitude": 8.0, "period": 1e5, "phase": 90.0}}


def level_records(vertical, changes, method="sweep"):
    """Records of a level bed with a vertical beam and without, and depressions of their bins beyond 11 m."""
    level = BARE | {"seabed.material": {"diffuse": 0.5, "specular": 0.0}, "sonar.bins": 500, "track.pings": 1}
    scene = edit(load_scene("default"), level | {"track.altitude": 10.0} | changes)
    beams = (edit(scene, {"sonar.vertical": beam}) for beam in (vertical, "uniform"))
    shaded, plain = (simulate(beam, method=method, tolerance=0.01) for beam in beams)
    down = np.arcsin(10.0 / plain.slant_range.values[110:])
    return shaded.intensity.values[:, 0, 110:], plain.intensity.values[:, 0, 110:], down


@pytest.mark.parametrize("vertical", [{"kind": "array", "height": 0.012, "tilt": 20.0}, {"kind": "table"}])
@pytest.mark.parametrize("method", ["sweep", "rays"])
def test_a_level_bed_is_shaded_by_it(vertical, method):
    shaded, plain, down = level_records(vertical, {}, method)
    np.testing.assert_allclose(shaded[0] / plain[0], responses(vertical, down), atol=0.01)


def test_a_top_hat_hears_what_is_within_it_and_nothing_else():
    shaded, plain, down = level_records({"kind": "fan", "width": 30.0, "tilt": 30.0}, {})
    off = np.abs(np.degrees(down) - 30.0)
    assert not shaded[:, off > 16.0].any()
    np.testing.assert_allclose(shaded[:, off < 14.0], plain[:, off < 14.0], rtol=3e-3)


@pytest.mark.parametrize(
    ("changes", "passes", "tilts"),  # rolled with port up
    [(BEAMS[False], 1.0, (25.0, 25.0)), (BEAMS[True], 2.0, (25.0, 25.0)), (ROLL, 2.0, (17.0, 33.0))],
    ids=["one way", "two way", "rolled"],
)
def test_a_gaussian_weighs_a_level_bed_by_its_value(changes, passes, tilts):
    shaded, plain, down = level_records({"kind": "gaussian", "width": 40.0, "tilt": 25.0}, changes)
    off = np.sin(down - np.radians(tilts)[:, None]) / math.sin(math.radians(20.0))
    np.testing.assert_allclose((shaded / plain)[:, 10:], 2.0 ** (-passes * off**2)[:, 10:], rtol=0.01)
