"""Speed of sound by three equations, against numbers in print."""

import numpy as np
import pytest

from insonify.scene.water.sound_speed import EQUATIONS, mackenzie, paper, teos10

AT_THE_SURFACE = {
    "paper": (1449.000, 1489.800, 1521.400),
    "mackenzie": (1448.960, 1489.803, 1521.463),
    "teos10": (1449.025, 1489.789, 1521.480),
}


@pytest.mark.parametrize("name", AT_THE_SURFACE)
def test_the_speed_at_the_surface_is_as_printed(name):
    np.testing.assert_allclose(EQUATIONS[name]([0.0, 10.0, 20.0], 35.0, 0.0), AT_THE_SURFACE[name], atol=5.1e-4)


def test_mackenzie_at_depth_is_as_printed():
    assert mackenzie(25.0, 35.0, 1000.0) == pytest.approx(1550.744, abs=5e-4)


def test_the_paper_at_50_m():
    np.testing.assert_allclose(paper([10.0, 20.0], 35.0, 50.0), [1490.62, 1522.22], atol=5e-3)


def test_the_paper_without_its_misprint_grows_with_temperature():
    t = np.linspace(0.0, 30.0, 61)
    assert (np.diff(paper(t, 35.0, 0.0)) > 0.0).all()
    misprinted = paper(t, 35.0, 0.0) + (0.055 - 0.55) * t**2
    assert misprinted[20] - paper(10.0, 35.0, 0.0) == pytest.approx(-49.5)
    assert np.diff(misprinted)[-1] < 0.0


def test_the_three_agree_over_the_sea():
    t, s, d = (axis.ravel() for axis in np.meshgrid([2.0, 12.0, 25.0], [30.0, 35.0, 38.0], [0.0, 100.0, 1000.0]))
    assert np.abs(paper(t, s, d) - teos10(t, s, d)).max() < 0.8
    assert np.abs(mackenzie(t, s, d) - teos10(t, s, d)).max() < 0.35
