"""Speckle that scatterers make by themselves: its mean, its distribution and how far it keeps together."""

import itertools
import math

import numpy as np
import pytest
from scipy import stats

from beds import arrays_of, gaussian_pattern, icosphere, mesh_of, poses_of, rough, solids_of
from insonify.acoustics.pulses import envelope, pulse_taps
from insonify.kernels.common.hashing import hash_integers, splitmix64
from insonify.kernels.common.streams import BED_SCATTERERS
from insonify.kernels.receiver.pulse import convolve_pulse
from insonify.kernels.speckle.scatterers import LOT, Scatterers
from insonify.packing.surface_patches import make_surface_patches
from insonify.scene import SceneError, edit, load_scene
from insonify.scene.sonar.pulses import Chirp, Ideal, Tone
from insonify.simulation import prepare
from insonify.tow.poses import take_poses
from insonify.tracers import rays, sweep
from insonify.tracers.scatterers import ScattererTracer, make_tracer, sample_pulse
from receptions import RAYLEIGH, correlation, field_correlation, variation

SPEED, FREQUENCY = 1500.0, 400e3
WAVELENGTH = SPEED / FREQUENCY
BINS, BIN_LENGTH, HEIGHT = 400, 0.05, 5.0
HALF_WIDTH = math.radians(0.5)
TONE, CHIRP = Tone(kind="tone", duration=1e-4), Chirp(duration=5e-4, bandwidth=2e4)  # of 1.5 and of 0.75 bins
SONAR = {"periodic": True, "bins": BINS, "bin_length": BIN_LENGTH}
EVEN = arrays_of(np.zeros((4, 4)), half_width=HALF_WIDTH, **SONAR)


def interference(arrays, *, density=1000.0, pulse=TONE, seed=1):
    scatterers = Scatterers(seed, density, 2.0 / WAVELENGTH, make_surface_patches(arrays.solids, arrays.mesh))
    return ScattererTracer(scatterers, sample_pulse(pulse, SPEED, arrays.bin_length))


def record(arrays, poses, *, planes=8, **settings):
    """Intensities as float64, (n, 2, bins)."""
    return interference(arrays, **settings).trace(arrays, poses, planes=planes).astype(float)


def mean_record(arrays, poses, pulse=TONE, *, by_rays=False):
    traced = rays.trace(arrays, poses, rays=4000) if by_rays else sweep.trace(arrays, poses, planes=64)
    taps = pulse_taps(pulse, SPEED, arrays.bin_length)
    out = np.zeros_like(traced)
    convolve_pulse(traced, taps.weights.astype(np.float32), taps.before, out)
    return out.astype(float)


def far_apart(count):
    """Pings that share no scatterer."""
    return poses_of(1.7 * np.arange(count), 0.0, HEIGHT)


def cells(bins, length=0.075):
    """Areas that those bins hear of a level bed, m²."""
    r = (bins + 0.5) * BIN_LENGTH - 0.5 * length
    return 2.0 * math.sin(HALF_WIDTH) * r * length * r / np.sqrt(r**2 - HEIGHT**2)


def normalised(bins, pings=400, pulse=TONE, **settings):
    """Intensities over their mean, (pings, 2, bins)."""
    found = record(EVEN, far_apart(pings), pulse=pulse, **settings)
    return found[:, :, bins] / mean_record(EVEN, far_apart(1), pulse)[:, :, bins]


FAR, FARTHER = np.arange(120, BINS), slice(140, BINS)


def test_many_scatterers_make_it_exponential():
    intensity = normalised(FAR[::4], pings=250, density=4000.0)  # 100 and more in a cell
    n = intensity.size
    assert intensity.mean() == pytest.approx(1.0, abs=3.0 / math.sqrt(n))
    # The estimate scatters by 0.47/√n, and 150 scatterers still add 0.4 %.
    assert variation(intensity) == pytest.approx(RAYLEIGH, abs=0.002 + 3 * 0.47 / n**0.5)
    assert stats.kstest(intensity[::4, :, ::2].ravel(), "expon").statistic < 1.95 / math.sqrt(n / 8)


@pytest.mark.parametrize("density", [30.0, 100.0, 400.0])
def test_few_scatterers_make_it_spikier_as_k_speckle_of_their_number(density):
    # Of Poisson numbers N of Gaussian amplitudes, E I² = 2 (1 + 1/⟨N⟩): var/mean² is that of K speckle of shape ⟨N⟩.
    bins = FAR[::4]
    intensity, number = normalised(bins, density=density), density * cells(bins)
    expected = 1.0 + 2.0 / number
    found = intensity.var(axis=(0, 1))
    # The squares scatter as those of K speckle do; E I⁴ = 24 (1 + 1/ν)(1 + 2/ν)(1 + 3/ν).
    fourth = 24.0 * (1.0 + 1.0 / number) * (1.0 + 2.0 / number) * (1.0 + 3.0 / number)
    sigma = math.sqrt(((fourth - (expected + 1.0) ** 2) / (expected + 1.0) ** 2).mean() / intensity.size)
    assert ((found + 1.0) / (expected + 1.0)).mean() == pytest.approx(1.0, abs=3.5 * sigma)


@pytest.mark.parametrize("pulse", [Tone(duration=2e-4), Chirp(duration=1e-3, bandwidth=6e3)])
def test_neighbouring_bins_correlate_as_the_pulse_covers_both(pulse):
    intensity = normalised(FARTHER, 150, pulse, density=2000.0)
    fine = 200
    shape = envelope(pulse, np.arange(-20 * fine, 20 * fine) * BIN_LENGTH / fine, SPEED)
    n = intensity.size / 3.0
    for lag in range(1, 5):
        # The envelope's own correlation.
        expected = ((shape[lag * fine :] * shape[: -lag * fine]).sum() / (shape**2).sum()) ** 2
        # A cell of the line is an eighth of the pulse's resolution.
        assert correlation(intensity, lag, 2) == pytest.approx(expected, abs=0.02 + 4.0 / math.sqrt(n))


def test_bins_of_an_ideal_pulse_are_independent():
    intensity = normalised(FARTHER, 150, Ideal(), density=2000.0)
    assert intensity.mean() == pytest.approx(1.0, abs=3.0 / math.sqrt(intensity.size))
    assert abs(correlation(intensity, 1, 2)) < 4.0 / math.sqrt(intensity.size)


def test_a_bin_longer_than_the_pulse_averages_looks_and_keeps_the_mean():
    # 3/8 of a bin: three samples.
    intensity = normalised(FARTHER, 150, Tone(duration=2.5e-5), density=6000.0)
    n = intensity.size
    assert intensity.mean() == pytest.approx(1.0, abs=3.0 / math.sqrt(3.0 * n))
    # Samples a third of a bin apart share 1/9 of a pulse: (1 + 2 · (2/3)(1/9)²)/3; and few scatterers add 2/N a sample.
    number = 6000.0 * cells(np.arange(140, BINS), 0.0375 / 2.0).mean()
    assert intensity.var() == pytest.approx((1.0 + 4.0 / 243.0 + 2.0 / number) / 3.0, rel=0.03)


@pytest.mark.parametrize(("frequency", "length", "two_way"), [(700e3, 0.7, True), (300e3, 0.4, False)])
def test_near_an_array_pings_keep_together_as_its_field_does(frequency, length, two_way):
    step, pings, bins = 0.04, 400, 120
    beam = {"kind": "array", "length": length, "two_way": two_way}
    changes = {"seabed.relief": "flat", "targets": [], "sonar.frequency": frequency, "sonar.beam": beam}
    changes |= {"sonar.range": 18.0, "sonar.bins": bins, "track.altitude": 4.0}
    scene = edit(load_scene("default"), changes | {"receiver": {"speckle": {"kind": "coherent", "density": 100.0}}})
    arrays = prepare(scene).arrays
    tracer, poses = make_tracer(scene, arrays), poses_of(step * np.arange(pings), 0.0, arrays.bed.high + 4.0)
    waves = tracer.trace_waves(arrays, poses, planes=2).reshape(pings, 2, bins, -1)
    for r in (8.0, 16.0):
        part = waves[:, :, abs((np.arange(bins) + 0.5) * 18.0 / bins - r) < 1.0]
        lags = np.arange(math.ceil(length / step))
        wanted = field_correlation(1500.0 / frequency, length, "uniform", 1 + two_way, r, step * lags)
        found = np.array([abs((part[lag:] * part[: pings - lag].conj()).mean()) for lag in lags])
        np.testing.assert_allclose(found / found[0], wanted, atol=0.08)


@pytest.mark.parametrize(("half_width", "heading"), [(HALF_WIDTH, 0.0), (HALF_WIDTH, 0.7), (0.5 * HALF_WIDTH, 0.0)])
def test_pings_decorrelate_as_van_cittert_and_zernike_have_it(half_width, heading):
    # Pings d apart hear a scatterer at an angle φ with phases 2kdφ apart, if it is in the beams of both: of angles in
    # all θ they share θ − d/r, so that ρ = (1 − d/rθ) sinc(2d(θ − d/r)/λ). How many there are has no phase: of N in a
    # cell, the covariance 2/N goes as what is shared.
    step = 0.01
    along = step * np.arange(600)
    poses = poses_of(along * math.cos(heading), along * math.sin(heading), HEIGHT, heading)
    arrays = EVEN._replace(half_width=half_width)
    mean = mean_record(arrays, poses_of(0.0, 0.0, HEIGHT, heading))
    intensity = (record(arrays, poses, density=1000.0) / np.maximum(mean, 1e-30))[:, :, 240:]
    theta, r = 2.0 * math.sin(half_width), (np.arange(240, BINS) + 0.5) * BIN_LENGTH - 0.0375
    number = 1000.0 * cells(np.arange(240, BINS)) * theta / (2.0 * math.sin(HALF_WIDTH))
    n = intensity.size / (0.5 * WAVELENGTH / theta / step) / 1.3
    for lag in (1, 4, 7, 10, 15, 20, 30):
        d = lag * step
        shared = np.maximum(1.0 - d / (r * theta), 0.0)
        waves = (shared * np.sinc(2.0 * d * theta * shared / WAVELENGTH)) ** 2
        expected = (waves + 2.0 * shared / number).mean() / (1.0 + 2.0 / number).mean()
        assert correlation(intensity, lag, 0) == pytest.approx(expected, abs=3.0 / math.sqrt(n)), lag


def scene(**changes):
    """A rough bed with a sphere, a leaning pipe and a mesh, some of them in another's shadow."""
    solids = [((3.0, 8.0, 0.6), 0.8), ((4.0, 11.0, 0.3), (9.0, 13.0, 1.2), 0.5)]
    bodies = {"solids": solids, "mesh": mesh_of(*icosphere(2, 0.6, (6.0, -9.0, 0.5)), target=2)}
    sonar = SONAR | {"half_width": 3.0 * HALF_WIDTH, "spreading": True} | changes
    return arrays_of(rough(64, 64, 0.15), 0.25, reflectivity=[(0.3, 0.2, 6.0)], **bodies, **sonar)


def pass_by(count=30, **changes):
    """Pings past it all, oblique to the grid."""
    along = np.linspace(-1.0, 12.0, count)
    return poses_of(along, 0.05 * along, HEIGHT, 0.05, **changes)


SQUINTING = gaussian_pattern(0.04, squint=0.15, vertical=2, tilt=0.5, vertical_width=0.9)
TURNED = {"pattern": SQUINTING, "half_width": 0.08}, {"pitch": 0.05, "roll": -0.2}


@pytest.mark.parametrize(
    ("pulse", "beam", "turned"),
    [(TONE, {}, {}), (CHIRP, {}, {}), (TONE, *TURNED)],
    ids=["tone", "chirp", "squinting pattern of a pitched and rolled fish"],
)
def test_its_mean_over_all_scatterers_is_the_record(pulse, beam, turned):
    """That of the sweep, or of rays: in all and stretch by stretch of half a metre."""
    arrays, poses = scene(**beam), pass_by(**turned)
    options = {"planes": 64, "density": 200.0, "pulse": pulse}
    found = np.mean([record(arrays, poses, seed=seed, **options) for seed in range(10)], axis=0)
    means = found, mean_record(arrays, poses, pulse, by_rays=bool(beam))
    found, wanted = (values[:, :, 100:].reshape(poses.x.size, 2, 30, 10).sum(axis=3) for values in means)
    assert found.sum() / wanted.sum() == pytest.approx(1.0, abs=0.03)
    loud = wanted > 1e-3 * wanted.max()
    ratio = found[loud] / wanted[loud]
    # Some seven samples a stretch, ten seeds: 12 % each, and more where a shadow's edge is.
    assert np.median(ratio) == pytest.approx(1.0, abs=0.03)
    assert np.quantile(abs(ratio - 1.0), 0.9) < 0.3


def test_shadows_are_dark():
    arrays, poses = scene(), pass_by(12)
    lit = mean_record(arrays, poses, Ideal())
    # Dark with their neighbours, over which the planes and the scatterers themselves may disagree.
    dark = np.stack([np.roll(lit, k, axis=2) for k in range(-3, 4)]).max(axis=0) == 0.0
    dark[:, :, :110] = False
    assert dark.sum() > 200
    found = record(arrays, poses, pulse=Ideal(), planes=64)
    assert found[dark].sum() < 1e-4 * found[lit > 0.0].mean() * dark.sum()


@pytest.mark.parametrize("changes", [{}, {"pattern": gaussian_pattern(0.03, near_width=0.3)}], ids=["fan", "pattern"])
def test_every_ping_is_a_function_of_its_pose_alone(changes):
    arrays, poses = scene(**changes), pass_by(10)
    poses.z[5:] += 1.5
    waves = interference(arrays)
    whole = waves.trace(arrays, poses, planes=8, threads=2)
    backwards = type(poses)(*(column[::-1].copy() for column in poses))
    np.testing.assert_array_equal(waves.trace(arrays, backwards, planes=8, threads=1)[::-1], whole)
    np.testing.assert_array_equal(waves.trace(arrays, take_poses(poses, slice(5, 8)), planes=8), whole[5:8])


def test_a_longer_record_begins_as_a_shorter_one():
    short = EVEN._replace(bins=200, range_factor=EVEN.range_factor[:200])
    for pulse in (TONE, CHIRP):
        one, other = (record(arrays, far_apart(4), pulse=pulse) for arrays in (EVEN, short))
        np.testing.assert_allclose(other, one[:, :, :200], rtol=1e-6, atol=1e-12)


def test_the_track_may_lie_anywhere_on_a_bed_that_ends():
    arrays = arrays_of(np.zeros((5, 30)), 1.0, bins=200, bin_length=0.1, half_width=HALF_WIDTH)
    beside = record(arrays, poses_of([-40.0, 15.0, 15.0], [2.0, -6.0, 2.0], HEIGHT))
    assert not beside[0].any()
    assert not beside[1, 1].any()  # to starboard there is nothing
    first, last = math.hypot(6.0, HEIGHT), math.hypot(10.0, HEIGHT)
    heard = np.flatnonzero(beside[1, 0]) * 0.1
    assert first - 0.15 < heard.min() < first + 0.3
    assert last - 0.3 < heard.max() < last + 0.2


@pytest.mark.parametrize(
    "body",
    [
        {"solids": [((0.0, 12.0, 20.0), 1.5)]},
        {"solids": [((-3.0, 10.0, 20.0), (3.0, 12.0, 21.0), 0.8)]},
        {"solids": [((0.0, 10.0, 19.0), (0.5, 12.0, 21.0), 1.5, 0.2)]},
        {"mesh": mesh_of(*icosphere(1, 1.5, (0.0, 12.0, 20.0)))},
    ],
    ids=["sphere", "cylinder", "cone", "mesh"],
)
def test_a_body_alone_echoes_as_loud_as_the_sweep_has_it(body):
    # High over a bed out of range.
    arrays = arrays_of(np.full((4, 4), -100.0), 10.0, half_width=2.0 * HALF_WIDTH, **body, **SONAR)
    poses = poses_of(np.linspace(-0.6, 0.6, 5), 0.0, 22.0)
    wanted = mean_record(arrays, poses).sum()
    found = np.mean([record(arrays, poses, seed=seed, density=150.0).sum() for seed in range(60)])
    # 10 to 20 samples of range a ping, 300 pings of which neighbours share some.
    assert found / wanted == pytest.approx(1.0, abs=0.06)


def test_skin_has_the_area_of_the_bodies():
    ball, pipe = ((0.0, 0.0, 0.0), 2.0), ((0.0, 0.0, 0.0), (3.0, 4.0, 0.0), 0.5)
    cone = ((0.0, 0.0, 0.0), (0.0, 0.0, 4.0), 3.0, 0.0)
    triangle = mesh_of([[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 6.0, 0.0]], [[0, 1, 2]], target=3)
    skin = make_surface_patches(solids_of([ball, pipe, cone]), triangle)
    areas = [skin.area[skin.target == target].sum() for target in range(4)]
    pi = math.pi
    np.testing.assert_allclose(areas, [16.0 * pi, 5.0 * pi + 0.5 * pi, 15.0 * pi + 9.0 * pi, 24.0])
    assert [np.sort(skin.number[skin.target == t]).tolist() == list(range((skin.target == t).sum())) for t in range(4)]


BOX = {"kind": "box", "position": [10.0, 30.0], "size": [900.0, 900.0, 5.0]}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"targets": [BOX]}, r"^receiver\.speckle: 'coherent' keeps .* patches .* smaller boxes"),
        ({"receiver.speckle.density": 1e6}, r"^receiver\.speckle\.density: 1e\+06 scatterers .* lower it to "),
    ],
    ids=["patches", "scatterers"],
)
def test_more_than_can_be_kept_or_heard_is_refused(changes, sentence):
    declared = edit(load_scene("default"), {"receiver.speckle": "coherent", "track.pings": 1} | changes)
    with pytest.raises(SceneError, match=sentence):
        prepare(declared).intensity(np.arange(1))


def test_the_rest_of_the_receiver_goes_on_as_for_other_speckle():
    changes = {"targets": [], "seabed.relief": "flat", "receiver.tvg": "power", "track.speed": 8.0}
    changes["receiver.reverberation"] = {"kind": "volume", "volume_strength": -40.0}
    changes["receiver.fluctuation"] = {"kind": "lognormal", "level": 1.0}
    changes["receiver.noise"] = {"kind": "ambient", "level": -110.0}
    scenes = (edit(load_scene("default"), changes | {"receiver.speckle": kind}) for kind in ("coherent", "rayleigh"))
    pings, alike = np.arange(0, 1200, 8), {"planes": "8", "spacing": "1"}
    coherent, rayleigh = (prepare(scene, forced=alike).intensity(pings).astype(float) for scene in scenes)
    # Water alone, bed in water, noise: the same means stretch by stretch.
    stretches = [values.mean(axis=(0, 1)).reshape(20, 50).mean(axis=1) for values in (coherent, rayleigh)]
    np.testing.assert_allclose(stretches[0], stretches[1], rtol=0.1)
    # Where the water is heard alone its waves are the very same.
    np.testing.assert_allclose(coherent[:, :, 40:180], rayleigh[:, :, 40:180], rtol=1e-5)


def test_it_is_what_a_slow_obvious_sum_of_waves_gives():
    # A level bed of perfect Lambert strength under a fish at an angle; every scatterer of every square, one by one.
    x, y, heading, density, seed = 3.3, -1.7, 0.3, 60.0, 5
    arrays = EVEN._replace(bins=160, range_factor=np.linspace(1.0, 2.0, 160))
    found = record(arrays, poses_of(x, y, HEIGHT, heading), density=density, pulse=Ideal(), seed=seed)[0]
    pitch, waves = math.sqrt(LOT / density), np.zeros((2, 160), complex)
    middle, around = np.floor(np.array([x, y]) / pitch).astype(int), math.ceil(8.0 / pitch)
    for row, column in itertools.product(range(-around, around + 1), repeat=2):
        i, j = column + int(middle[0]), row + int(middle[1])
        key = int(hash_integers(seed, BED_SCATTERERS, i, j, 0))
        for member in range(int(stats.poisson.ppf((key >> 32) / 2**32, LOT))):
            place = int(splitmix64(np.uint64(key ^ (member + 1))))
            wave = int(splitmix64(np.uint64(place)))
            dx, dy = (i + (place >> 32) / 2**32) * pitch - x, (j + (place % 2**32) / 2**32) * pitch - y
            ahead = dx * math.cos(heading) + dy * math.sin(heading)
            abeam = dy * math.cos(heading) - dx * math.sin(heading)
            r = math.sqrt(dx * dx + dy * dy + HEIGHT**2)
            k = int(r / BIN_LENGTH)
            if k < 160 and abs(ahead / r) <= math.sin(HALF_WIDTH):
                energy = (HEIGHT / r) ** 2 / math.pi / density * arrays.range_factor[k]
                modulus = math.sqrt(-energy * math.log((wave >> 32) / 2**32 + 0.5 / 2**32))
                phase = 2.0 * math.pi * (2.0 * r / WAVELENGTH + (wave % 2**32) / 2**32)
                waves[0 if abeam >= 0.0 else 1, k] += modulus * complex(math.cos(phase), math.sin(phase))
    assert (np.abs(waves) > 0.0).sum() > 40
    np.testing.assert_allclose(found, np.abs(waves) ** 2, rtol=1e-4, atol=1e-9)
