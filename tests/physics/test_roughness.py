"""Kinds of roughness against their theory: spectra, crests, moments, autocorrelations, shares."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from insonify.scene import SceneError, build
from insonify.scene.seabed.reliefs.cascade import Cascade
from insonify.scene.seabed.reliefs.ripples import Ripples
from insonify.scene.seabed.reliefs.roughness import PowerLaw, VonKarman
from insonify.statistics.record_statistics import amplitude_exponent
from insonify.terrain import relief
from insonify.terrain.periodic_waves import WaveGrid
from insonify.terrain.random_heights import periodic_heights

SIDE, PERIOD = 512, 51.2


def seabed(**made):
    return build({"seabed": {"spacing": PERIOD / SIDE, "relief": {"period": PERIOD, **made}}}).seabed


def heights(seed=1, **made):
    return relief(seabed(**made), seed=seed)


def waves():
    """Frequencies in cycles a metre, as of ``rfft2``."""
    return np.fft.rfftfreq(SIDE, PERIOD / SIDE)[np.newaxis, :], np.fft.fftfreq(SIDE, PERIOD / SIDE)[:, np.newaxis]


def measured_density(z):
    return np.abs(np.fft.rfft2(z, norm="forward")) ** 2 * PERIOD**2


def banded(power, low=2.0, high=SIDE / 2, count=12):
    """Sums of power over rings from so many cycles per period on, the Nyquist frequencies left out."""
    fx, fy = waves()
    radius = np.hypot(fx, fy) * PERIOD
    edges = np.geomspace(low, high, count + 1)
    inside = (np.abs(fy) * PERIOD < SIDE / 2) & (fx * PERIOD < SIDE / 2)
    return np.array([power[inside & (radius >= a) & (radius < b)].sum() for a, b in pairwise(edges)])


@pytest.mark.parametrize(
    ("made", "density"),
    [
        ({"kind": "power_law", "strength": 0.0044, "exponent": 3.25}, PowerLaw.density),
        ({"kind": "von_karman", "across": 2.0, "along": 8.0, "heading": 30.0, "hurst": 0.7}, VonKarman.density),
    ],
)
def test_spectrum_is_the_declared_one(made, density):
    declared = density(seabed(**made).relief)(*waves())
    found = np.mean([measured_density(heights(seed, **made)) for seed in range(12)], axis=0)
    if made["kind"] == "von_karman":  # whose rms is that of the period
        declared = declared * (found.sum() / declared[declared < np.inf].sum())
    np.testing.assert_allclose(banded(found, low=8.0), banded(declared, low=8.0), rtol=0.08)


def test_power_law_has_the_variance_of_its_strength_and_its_exponent():
    # ∫ w₂ (h₀K)^−γ₂ d²K over the waves of the period, in closed form over whole rings.
    made = {"kind": "power_law", "strength": 0.0129, "exponent": 3.0}
    low, high = 8.0 / PERIOD, 0.5 * SIDE / PERIOD
    k0, k1 = 2 * math.pi * low / 100, 2 * math.pi * high / 100  # radians a centimetre
    variance = 1e-4 * 0.0129 * 2 * math.pi * (1 / k0 - 1 / k1)  # m²
    found = np.mean([2 * banded(measured_density(heights(seed, **made)), 8.0).sum() for seed in range(8)]) / PERIOD**2
    assert found == pytest.approx(variance, rel=0.05)
    fx, fy = waves()
    radius = np.hypot(fx, fy) * PERIOD
    inside = (radius >= 4) & (radius < SIDE / 2) & (fx > 0)
    power = measured_density(heights(kind="power_law", exponent=2.8))[inside]
    log_radius = np.log(radius[inside])

    def misfit(exponent):
        return np.log((power * np.exp(exponent * log_radius)).mean()) - exponent * log_radius.mean()

    # ±0.014 is one standard deviation of Whittle's estimate at this size.
    assert minimize_scalar(misfit, bounds=(1.0, 5.0), method="bounded").x == pytest.approx(2.8, abs=0.042)


def test_rms_is_realised_over_a_period_and_that_of_endless_ground_expected():
    for kind in ("von_karman", "cascade", "autocorrelation", "fractal"):
        assert heights(kind=kind, rms=0.07).std() == pytest.approx(0.07, rel=1e-12), kind
    for made in (
        {"kind": "fractal", "beta": 2.0, "period": 10.0, "clamp": "soft", "coefficients": "gaussian"},
        {"kind": "von_karman", "across": 2.0, "along": 3.0},
        {"kind": "autocorrelation", "function": {"kind": "exponential", "length": 1.0}},
    ):
        drawn = [heights(seed, rms=0.2, extent="endless", **made).std() for seed in range(4)]
        assert np.mean(drawn) == pytest.approx(0.2, rel=0.06), made


def test_von_karman_crests_lie_along_their_heading():
    power = measured_density(heights(kind="von_karman", across=1.0, along=6.0, heading=30.0))
    fx, fy = waves()
    # The principal axis of the spectrum stands at right angles to the crests.
    weight = power * (np.hypot(fx, fy) < 2.0)
    xx, yy, xy = (weight * fx**2).sum(), (weight * fy**2).sum(), (weight * fx * fy).sum()
    across = np.degrees(0.5 * np.arctan2(2 * xy, xx - yy))
    assert (across - 90.0) % 180.0 == pytest.approx(30.0, abs=2.0)


RIPPLES = {"kind": "ripples", "wavelength": 0.8, "height": 0.1, "heading": 20.0, "bandwidth": 0.05}


@pytest.mark.parametrize(
    ("extent", "length", "degrees", "off"), [("periodic", 0.02, 2.0, 0.1), ("endless", 0.03, 3.0, 0.15)]
)
def test_ripples_have_their_wavelength_and_heading_and_one_height_unlike_gaussian_waves(extent, length, degrees, off):
    z = heights(**RIPPLES, sharpness=0.0, extent=extent)
    power = measured_density(z[:SIDE, :SIDE])
    fx, fy = waves()
    weight = power * (np.hypot(fx, fy) < 1.6)  # the fundamental alone
    # fx is positive: the mean wave is that across the crests or its image.
    mean = [(weight * fx).sum() / weight.sum(), (weight * np.where(fx > 0, fy, 0.0)).sum() / weight.sum()]
    assert 1.0 / np.hypot(*mean) == pytest.approx(0.8, rel=length)
    assert (np.degrees(np.arctan2(mean[1], mean[0])) + 90.0) % 180.0 == pytest.approx(20.0, abs=degrees)
    assert z.max() <= 0.05
    assert z.max() - z.min() == pytest.approx(0.1, rel=0.02)
    kurtosis = np.mean(z**4) / np.mean(z**2) ** 2
    assert kurtosis == pytest.approx(1.5, abs=off)  # a sine has 1.5, Gaussian waves 3


@pytest.mark.parametrize(("sharpness", "skewness"), [(0.0, 0.0), (1.0, 0.639)])
def test_sharp_crests_stand_over_wide_troughs(sharpness, skewness):
    z = heights(**RIPPLES, sharpness=sharpness)
    # Of parabolic troughs: ⟨(u² − 1/3)³⟩ / ⟨(u² − 1/3)²⟩^1.5 with u even over [0, 1] is 0.639.
    assert np.mean(z**3) / np.mean(z**2) ** 1.5 == pytest.approx(skewness, abs=0.06)


def test_wider_bands_have_more_defects(monkeypatch):
    found, kept = [], Ripples.shape_waves

    def shape_waves(ripples, a, b, level):
        found.append(np.arctan2(b, a))
        return kept(ripples, a, b, level)

    monkeypatch.setattr(Ripples, "shape_waves", shape_waves)
    for bandwidth in (0.08, 0.16):
        found.clear()
        heights(kind="ripples", wavelength=0.8, bandwidth=bandwidth, bandwidth_along=bandwidth)
        phase = np.concatenate(found)  # row by row
        around = [np.roll(phase, shift, (0, 1)) for shift in ((0, 0), (0, -1), (-1, -1), (-1, 0), (0, 0))]
        turns = sum((step + np.pi) % (2 * np.pi) - np.pi for step in np.diff(around, axis=0)) / (2 * np.pi)
        # A Gaussian field with the spreads s of wave numbers along both axes has s²/2π of them a square metre,
        # with s in radians a metre (Berry and Dennis 2000, eq. 3.11).
        spread = 2 * np.pi * bandwidth / 0.8
        assert np.abs(np.rint(turns)).sum() == pytest.approx(PERIOD**2 * spread**2 / (2 * np.pi), rel=0.15)


def test_flux_of_a_cascade_has_the_moments_of_its_codimension():
    cascade, sides, found = Cascade(intermittency=0.15), np.array([4, 8, 16, 32, 64]), []
    for seed in range(12):
        waves = WaveGrid((SIDE, SIDE), seed, 1)
        fx, fy = waves.frequencies()
        squared = fx**2 + fy**2
        squared[0, 0] = np.inf
        log_flux = np.fft.irfft2(waves.noise() * np.sqrt(cascade.intermittency / (np.pi * squared)), norm="forward")
        flux = np.exp(log_flux)
        squares = ((flux / flux.mean()).reshape(SIDE // n, n, SIDE // n, n).mean(axis=(1, 3)) for n in sides)
        table = [[np.log(np.mean(each**q)) for q in (1.5, 2.0)] for each in squares]
        found.append(np.polyfit(np.log(SIDE / sides), np.array(table), 1)[0])
    k15, k2 = np.mean(found, axis=0)
    # K(q) = C₁(q² − q): 0.3 at 2, measured 0.29; 0.1125 at 1.5.
    assert k2 == pytest.approx(0.29, abs=0.05)
    assert k15 == pytest.approx(0.1125, abs=0.025)


def test_structure_functions_of_a_cascade_bend_and_those_of_a_fractal_do_not():
    lags = [2, 4, 8, 16, 32]

    def exponents(z):
        table = [[np.log(np.mean(np.abs(np.roll(z, lag, axis=1) - z) ** q)) for q in (1.0, 3.0)] for lag in lags]
        return np.polyfit(np.log(lags), np.array(table), 1)[0]

    bent = np.mean([exponents(heights(seed, kind="cascade", hurst=0.5)) for seed in range(6)], axis=0)
    straight = np.mean([exponents(heights(seed, kind="fractal", beta=1.5)) for seed in range(6)], axis=0)
    assert straight[1] == pytest.approx(3 * straight[0], rel=0.05)
    # ζ(q) = qH − K(q) falls behind a straight line by K(3) = 0.9, of 1.5.
    assert bent[1] < 2.2 * bent[0]
    fractal = heights(kind="cascade", intermittency=0.0, hurst=0.6)
    assert amplitude_exponent(fractal) == pytest.approx(1.6, abs=0.021), "without intermittency"


@pytest.mark.parametrize(
    ("of", "power"),
    [
        ({"kind": "exponential", "length": 1.5}, 1),
        ({"kind": "gaussian", "length": 1.5}, 2),
        ({"kind": "table", "points": [[0.1 * k, math.exp(-0.1 * k / 1.5)] for k in range(150)]}, 1),
    ],
)
def test_autocorrelation_is_recovered(of, power):
    found = np.fft.irfft2(np.abs(np.fft.rfft2(heights(kind="autocorrelation", function=of))) ** 2)
    lag = np.arange(100) * PERIOD / SIDE
    # What is missing are the mean, and waves beyond the Nyquist frequency.
    for line in (found[0, :100], found[:100, 0]):
        np.testing.assert_allclose(line / found[0, 0], np.exp(-((lag / 1.5) ** power)), atol=0.025)


def test_autocorrelation_of_endless_ground_is_recovered_and_a_table_has_the_transform_of_its_law():
    made = {"kind": "autocorrelation", "function": {"kind": "exponential", "length": 1.0}, "extent": "endless"}
    ground = [heights(seed, **made) for seed in range(4)]
    found = np.mean([[np.mean(z[:, : z.shape[1] - lag] * z[:, lag:]) for lag in range(40)] for z in ground], axis=0)
    np.testing.assert_allclose(found / found[0], np.exp(-0.1 * np.arange(40)), atol=0.05)
    of = {"kind": "table", "points": [[0.02 * k, math.exp(-0.02 * k)] for k in range(600)]}
    table = seabed(kind="autocorrelation", function=of).relief.density()
    law = seabed(kind="autocorrelation", function={"kind": "exponential", "length": 1.0}).relief.density()
    f, zero = np.geomspace(0.01, 4.0, 50), np.zeros(50)
    np.testing.assert_allclose(table(f, zero), law(f, zero), rtol=0.01)


@pytest.mark.parametrize(("extent", "size", "off"), [("periodic", 5.0, 1e-3), ("endless", 2.0, 0.05)])
@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_mask_covers_its_share(share, extent, size, off):
    mask = {"kind": "patches", "share": share, "size": size, "softness": 0.2}
    let_be = heights(kind="power_law", mask=mask, extent=extent) / heights(kind="power_law", extent=extent)
    assert let_be.min() >= 0.0
    assert let_be.max() <= 1.0
    assert (let_be > 0.5).mean() == pytest.approx(share, abs=off)
    assert (let_be == 0.0).mean() > 0.0
    # The borders are as wide as the softness says: their share is the length of contour times the width.
    assert ((let_be > 0.0) & (let_be < 1.0)).mean() < 0.4


@pytest.mark.parametrize(
    "made",
    [{"kind": kind} for kind in ("power_law", "von_karman", "ripples", "cascade", "autocorrelation")]
    + [{"kind": "ripples", "mask": "patches"}],
)
def test_relief_has_no_seam_where_it_repeats(made):
    z = heights(**made)
    steps = np.abs(np.diff(np.concatenate([z, z[:1]]), axis=0)).mean(axis=1)
    assert steps[-1] < 1.5 * steps.max()
    assert steps[-1] == pytest.approx(np.median(steps), rel=0.5)


@pytest.mark.parametrize("made", [{"kind": "power_law"}, {"kind": "autocorrelation"}, {"kind": "von_karman"}])
def test_every_grid_holds_the_same_landscape(made):
    bed = seabed(**made)
    fine, coarse = relief(bed), relief(bed, (256, 256))
    band = np.s_[:100, 1:100]
    a, b = (np.fft.rfft2(z, norm="forward")[band] for z in (fine, coarse))
    np.testing.assert_allclose(a, b, rtol=0, atol=1e-14)


def test_parts_of_a_sum_are_independent_and_add_up():
    one = {"kind": "power_law", "period": PERIOD}
    both = build({"seabed": {"spacing": PERIOD / SIDE, "relief": {"kind": "sum", "of": [one, one]}}}).seabed
    total, first = relief(both), heights(**one)
    second = total - first
    assert abs(np.corrcoef(first.ravel(), second.ravel())[0, 1]) < 0.2
    np.testing.assert_allclose(second.std(), first.std(), rtol=0.3)
    np.testing.assert_array_equal(periodic_heights(both.random_reliefs, (SIDE, SIDE), (SIDE, SIDE), 1), total)


BOX = {"kind": "table", "points": [[0.0, 1.0], [2.0, 1.0], [2.1, 0.0]]}
NO_SURFACE = {"kind": "autocorrelation", "function": BOX, "period": PERIOD}
MISTAKES = [
    ({"kind": "ripples", "wavelength": 0.2}, r"relief\.wavelength 0\.2 m spans fewer than 3 cells .*; lengthen"),
    ({"kind": "ripples", "wavelength": 60.0}, r"relief\.wavelength 60 m fits less than twice .*; shorten"),
    ({"kind": "power_law", "exponent": 4.5}, r"4\.5 is out of bounds; give a value below 4"),
    ({"kind": "fractal", "extent": "endless"}, r'set clamp = "soft" and coefficients = "gaussian"'),
    ({"kind": "autocorrelation", "function": {"kind": "table", "points": [[0, 0.9], [1, 0]]}}, r"start at \[0, 1\]"),
    ({"kind": "sum", "of": ["fractal", {"kind": "ripples", "period": 20.0}]}, r"give all the same period"),
    ({"kind": "sum", "of": ["cascade", {"kind": "ripples", "extent": "endless"}]}, r"give all the same extent"),
    ({"kind": "autocorrelation", "function": {"kind": "file", "path": "/none.csv"}}, r"does not exist; give a CSV"),
    (NO_SURFACE, r"^seabed\.relief\.function: .* would be negative, which no surface can have; let it"),
]


@pytest.mark.parametrize(("made", "message"), MISTAKES)
def test_mistakes_are_told_in_one_sentence(made, message):
    with pytest.raises(SceneError, match=message) as caught:
        relief(build({"seabed": {"spacing": 0.1, "relief": made}}).seabed)
    assert "\n" not in str(caught.value)
