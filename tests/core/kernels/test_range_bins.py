"""Range bins: what is spread over them, and that none is ever negative."""

import numpy as np
import pytest

from insonify.kernels.common.range_bins import FIXED_POINT, accumulate_bins, spread_energy, step_density, tilt_density


def spread_over(pieces, count=20):
    bins, out = np.zeros(count + 2, dtype=np.int64), np.zeros(count, dtype=np.float32)
    for near, far, energy in pieces:
        spread_energy(bins, near, far, energy * FIXED_POINT, float(count))
    accumulate_bins(bins, np.ones(count), out)
    return out


def test_a_piece_of_rounding_below_zero_is_silence():
    assert not spread_over([(3.2, 3.6, -2.0 / FIXED_POINT)]).any()


def test_energy_goes_where_the_piece_lies():
    np.testing.assert_allclose(spread_over([(3.25, 5.75, 2.0)])[2:7], [0.0, 0.6, 0.8, 0.6, 0.0], atol=1e-10)
    np.testing.assert_allclose(spread_over([(5.75, 3.25, 2.0)]), spread_over([(3.25, 5.75, 2.0)]))


def test_a_piece_of_no_length_lies_in_its_bin():
    assert spread_over([(4.5, 4.5, 1.5)])[4] == pytest.approx(1.5)


@pytest.mark.parametrize("length", [1e-5, 2e-6, 1.1e-6])
def test_no_bin_is_negative_however_short_and_loud_its_piece(length):
    """A density beyond 2⁵³ is no longer a whole number of its own in float64."""
    rng = np.random.default_rng(1)
    for energy in rng.uniform(0.1, 4.0, 2000):
        near = np.nextafter(8.0, 0.0) if rng.random() < 0.5 else 8.0 - length * rng.random()
        out = spread_over([(near, near + length, energy)])
        assert out.min() >= 0.0
        assert out.sum() == pytest.approx(energy, rel=1e-5)


def test_faint_densities_that_change_within_a_bin_leave_none_below_zero():
    rng = np.random.default_rng(2)
    for _ in range(300):
        bins = np.zeros(22, dtype=np.int64)
        density = np.concatenate([[0], rng.integers(0, 4, 40), [0]])
        for position, change in zip(np.sort(rng.uniform(0.0, 20.0, 41)), np.diff(density)):
            step_density(bins, position, change, 20.0)
        total = np.cumsum(bins)
        assert total[:20].min() >= 0
        assert total[20:].tolist() == [0, 0]


@pytest.mark.parametrize(("near", "far"), [(3.2, 3.7), (3.2, 4.1), (3.0, 5.0), (2.6, 9.3), (17.5, 19.9)])
@pytest.mark.parametrize("change", [-1.9, -0.3, 0.0, 0.7, 2.0])
def test_a_tilted_density_is_the_integral_of_a_linear_one(near, far, change):
    density, bins, out = 0.8, np.zeros(22, dtype=np.int64), np.zeros(20)
    spread_energy(bins, near, far, density * (far - near) * FIXED_POINT, 20.0)
    tilt_density(bins, near, far, density * FIXED_POINT, change, 20.0)
    accumulate_bins(bins, np.ones(20), out)
    edges = np.clip(np.linspace(0.0, 20.0, 20 * 1000 + 1), near, far)
    middle = 0.5 * (edges[1:] + edges[:-1])
    linear = density * (1.0 + change * ((middle - near) / (far - near) - 0.5)) * np.diff(edges)
    np.testing.assert_allclose(out, linear.reshape(20, 1000).sum(axis=1), atol=1e-9)
    assert out.sum() == pytest.approx(density * (far - near))
