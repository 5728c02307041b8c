"""Fractal relief against the closed form of its spectrum."""

import numpy as np
import pytest

from insonify.kernels.common.streams import RELIEF
from insonify.scene import SceneError
from insonify.scene.seabed import Seabed
from insonify.scene.seabed.reliefs.fractal import Fractal, power_spectrum
from insonify.statistics.record_statistics import amplitude_exponent
from insonify.terrain import relief
from insonify.terrain.periodic_waves import WaveGrid, frequencies
from insonify.terrain.random_heights import unmasked_heights

FIGURE_6 = Fractal(beta=1.4, peaks=((8.0, 4.0),), period=25.6)
SMALL = (64, 64)


def measured_power(heights):
    """Power per wave of both signs, from the heights alone."""
    power = np.abs(np.fft.rfft2(heights, norm="forward")) ** 2
    power[:, 1:] *= 2.0  # the Nyquist column is empty
    return power


def test_heights_have_the_exponent_exactly_by_random_phases_and_in_the_mean_by_gaussian_coefficients():
    for beta in (0.0, 0.7, 1.4, 2.3, 4.9):
        heights = unmasked_heights(Fractal(beta=beta), (256, 256), (256, 256), 3)
        assert amplitude_exponent(heights) == pytest.approx(beta, abs=1e-4)
    for seed in (1, 2, 3):
        heights = unmasked_heights(Fractal(beta=1.4, coefficients="gaussian"), (512, 512), (512, 512), seed)
        # Physics: ±0.014 on 2β at 512², one standard deviation; three of them here.
        assert amplitude_exponent(heights) == pytest.approx(1.4, abs=0.021), seed
    sentence = r"^heights: \(32, 64\) samples hold too few waves .*; give at least 40 a side$"
    with pytest.raises(SceneError, match=sentence):
        amplitude_exponent(np.zeros((32, 64)))


def test_figure_6_has_its_peak_its_crests_and_44_percent_of_the_variance_in_five_clamped_waves():
    power = measured_power(unmasked_heights(FIGURE_6, (256, 256), (256, 256), 1))
    fx, fy = frequencies((256, 256))
    near = np.hypot(fx - 8, fy - 4) <= 2.0
    weight = power[near] / power[near].sum()
    radius, direction = np.hypot(fx, fy)[near], np.degrees(np.arctan2(fy, fx))[near]
    assert weight @ radius == pytest.approx(8.99, abs=0.26)
    assert weight @ direction == pytest.approx(26.4, abs=1.4)
    clamped = np.hypot(fx - 8, fy - 4) <= 1.0
    assert clamped.sum() == 5
    assert power[clamped].sum() / power.sum() == pytest.approx(0.44, abs=0.005)


def test_model_3_falls_with_its_own_exponent_along_each_axis():
    fx, fy, zero = np.array([400.0]), np.array([800.0]), np.zeros(1)
    for decay in ("rotated", "elliptic", "separable"):
        fractal = Fractal(beta_x=1.2, beta_y=1.6, decay=decay)
        along_x = power_spectrum(fractal, 2 * fx, zero) / power_spectrum(fractal, fx, zero)
        along_y = power_spectrum(fractal, zero, 2 * fy) / power_spectrum(fractal, zero, fy)
        assert -np.log2(along_x[0]) == pytest.approx(2.4, abs=1e-3), decay
        assert -np.log2(along_y[0]) == pytest.approx(3.2, abs=1e-3), decay
    # So do rows and columns of the heights of the separable one.
    power = measured_power(unmasked_heights(fractal, (256, 256), (256, 256), 1))
    waves = np.log(np.arange(4, 127))
    rows, columns = power[1:127, 4:127].sum(axis=0), power[4:127, 1:127].sum(axis=1)
    assert np.polyfit(waves, np.log(rows), 1)[0] == pytest.approx(-2.4, abs=1e-6)
    assert np.polyfit(waves, np.log(columns), 1)[0] == pytest.approx(-3.2, abs=1e-6)


def test_decays_are_their_closed_forms():
    # Rotated, a decay follows the line from the peak to zero frequency.
    fractal = Fractal(beta_x=2.0, beta_y=1.0, decay="rotated", peaks=((30.0, 40.0),), combine="max")
    step = 100.0
    along = power_spectrum(fractal, np.array([30 + 0.6 * step]), np.array([40 + 0.8 * step]))[0]
    across = power_spectrum(fractal, np.array([30 - 0.8 * step]), np.array([40 + 0.6 * step]))[0]
    assert along == pytest.approx(step**-4.0)
    assert across == pytest.approx(step**-2.0)
    # Elliptic, it is isotropic when its exponents are equal.
    even = Fractal(beta_x=1.4, beta_y=1.4, decay="elliptic", clamp="soft", peaks=((8.0, 4.0),))
    round_one = Fractal(beta=1.4, clamp="soft", peaks=((8.0, 4.0),))
    axes = frequencies(SMALL)
    np.testing.assert_allclose(power_spectrum(even, *axes), power_spectrum(round_one, *axes), rtol=1e-12)
    soft = Fractal(beta=1.4, clamp="soft", combine="max")
    power = power_spectrum(soft, np.array([0.0, 3.0]), np.array([0.0, 4.0]))
    np.testing.assert_allclose(power, [1.0, 26.0**-1.4])


@pytest.mark.parametrize("shape", [(64, 64), (64, 63), (31, 64), (1, 64), (64, 1)])
@pytest.mark.parametrize("coefficient", ["phase", "gaussian"])
def test_rms_is_realised_on_the_reference_grid(shape, coefficient):
    fractal = Fractal(beta=1.4, rms=0.3, coefficients=coefficient)
    heights = unmasked_heights(fractal, shape, shape, 5)
    assert heights.shape == shape
    assert np.sqrt(np.mean(heights**2)) == pytest.approx(0.3, rel=1e-12)
    assert abs(heights.mean()) < 1e-15


def test_coefficients_are_conjugate_symmetric_and_those_of_mean_and_nyquist_waves_zero():
    grid = WaveGrid(SMALL, 7, RELIEF)
    waves = Fractal(beta=1.0).filtered_noise(grid)
    first = waves[1:, 0]
    np.testing.assert_array_equal(first, first[::-1].conj())
    heights = np.fft.irfft2(waves, s=SMALL, norm="forward")
    assert heights.var() == pytest.approx(grid.variance(waves), rel=1e-12), "no variance is lost"
    waves = Fractal(beta=0.0).filtered_noise(WaveGrid((64, 32), 1, RELIEF))
    assert waves[0, 0] == 0
    assert not waves[32].any()
    assert not waves[:, 16].any()
    assert np.count_nonzero(waves) == 63 * 16 - 1


def test_every_grid_holds_the_same_landscape():
    for coefficients in ("phase", "gaussian"):
        fractal, reference = FIGURE_6.model_copy(update={"coefficients": coefficients}), (256, 256)
        coarse, *others = (
            np.fft.rfft2(unmasked_heights(fractal, shape, reference, 1), norm="forward")[np.r_[0:100, -100:0], :100]
            for shape in (reference, (512, 512), (1024, 256), (250, 300))
        )
        for other in others:
            np.testing.assert_allclose(other, coarse, rtol=0, atol=3e-15)
    # Seabeds of two spacings differ by one factor.
    relief_ = {"kind": "fractal", "beta": 1.4, "peaks": [[8, 4]], "period": 25.6, "rms": 0.05}
    fine = relief(Seabed(spacing=0.05, relief=relief_))
    coarse = relief(Seabed(spacing=0.1, relief=relief_))
    assert fine.std() == pytest.approx(0.05, rel=1e-12)
    assert coarse.std() == pytest.approx(0.05, rel=1e-12)
    ratio = np.fft.rfft2(fine, norm="forward")[:100, 1:100] / np.fft.rfft2(coarse, norm="forward")[:100, 1:100]
    np.testing.assert_allclose(ratio, ratio[0, 0], rtol=1e-10)


def test_four_quadrants_mirror_every_peak_and_peaks_combine_by_mean_square_or_by_the_larger():
    power = power_spectrum(Fractal(peaks=((8.0, 4.0),), quadrants=4), np.array([8.0, 8.0]), np.array([4.0, -4.0]))
    assert power[0] == pytest.approx(power[1], rel=1e-12)
    alone = power_spectrum(Fractal(peaks=((8.0, 4.0),)), np.array([8.0, 8.0]), np.array([4.0, -4.0]))
    assert alone[1] < 0.01 * alone[0]
    peaks = ((8.0, 4.0), (20.0, 10.0))
    place = np.array([13.0]), np.array([-2.0])
    each = [(13 - s * x) ** 2 + (-2 - s * y) ** 2 for x, y in peaks for s in (1, -1)]
    squares = np.array(each, dtype=float) ** -1.4
    assert power_spectrum(Fractal(peaks=peaks), *place)[0] == pytest.approx(squares.sum())
    assert power_spectrum(Fractal(peaks=peaks, combine="max"), *place)[0] == pytest.approx(squares.max())
