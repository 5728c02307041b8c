"""Endless ground: its spectrum, and that it has no seam, no period and no history."""

import math
from itertools import pairwise

import numpy as np
import pytest

from insonify.scene.seabed.reliefs.fractal import Fractal, power_spectrum
from insonify.scene.seabed.reliefs.roughness import VonKarman
from insonify.terrain import endless_field
from insonify.terrain.endless_field import TILE, Band, EndlessField, Nodes, gather_tiles, lattice_noise
from insonify.terrain.random_heights import endless_heights

SOFT = {"extent": "endless", "clamp": "soft", "coefficients": "gaussian"}
SPACING = 0.1
PERIOD = 25.6
SPECTRA = {
    "round": Fractal(beta=1.4, period=PERIOD, **SOFT),
    "smooth": Fractal(beta=2.2, period=PERIOD, **SOFT),
    "peak": Fractal(beta=1.4, peaks=((20.0, 10.0),), period=PERIOD, **SOFT),
    "far peak": Fractal(beta=1.0, peaks=((100.0, 0.0),), period=PERIOD, **SOFT),
    "peaks": Fractal(beta=1.2, peaks=((20.0, 10.0), (0.0, 0.0)), quadrants=4, period=PERIOD, **SOFT),
    "elliptic": Fractal(beta_x=1.2, beta_y=1.8, decay="elliptic", period=PERIOD, **SOFT),
    "lineated": VonKarman(across=5.0, along=20.0, heading=25.0, extent="endless"),
}


def field_of(one, seed=3):
    bands = (Band(one.density(), 1.0 / 20.0),) if isinstance(one, VonKarman) else one.bands()
    return EndlessField(bands, SPACING, seed, 1)


def excess(one, seeds, tiles=2):
    """Decibels by which the mean power in bands of half an octave differs from the declared, and its standard error."""
    side = tiles * TILE
    taper = np.hanning(side + 1)[:side]
    taper = np.outer(taper, taper) / np.mean(taper**2)
    fx, fy = np.fft.rfftfreq(side, SPACING)[np.newaxis, :], np.fft.fftfreq(side, SPACING)[:, np.newaxis]
    is_fractal = isinstance(one, Fractal)
    declared = power_spectrum(one, fx * PERIOD, fy * PERIOD) if is_fractal else one.density()(fx, fy)
    # A taper spreads power by a step or two of frequency; so does this.
    lags = np.fft.irfft2(declared)
    window = np.fft.irfft2(np.abs(np.fft.rfft2(taper)) ** 2)
    declared = np.fft.rfft2(lags * window / window[0, 0]).real
    edges = np.geomspace(4.0 / (side * SPACING), 0.5 / SPACING, 16)
    radius = np.hypot(fx, fy)
    found = []
    for seed in seeds:
        field = field_of(one, seed)
        z = np.block([[field.values(Nodes.of_tile(j, i)) for i in range(tiles)] for j in range(-1, tiles - 1)])
        power = np.abs(np.fft.rfft2(z * taper)) ** 2 * SPACING**2 / side**2
        found.append([power[(radius >= a) & (radius < b)].sum() for a, b in pairwise(edges)])
    level = [declared[(radius >= a) & (radius < b)].sum() for a, b in pairwise(edges)]
    ratio = np.array(found) / level
    return 10.0 * np.log10(ratio.mean(axis=0)), 4.34 * ratio.std(axis=0, ddof=1) / math.sqrt(len(ratio))


@pytest.mark.parametrize(
    ("name", "seeds", "deviations", "bands"),
    [
        *((name, 5, 3.5, 4) for name in ("peak", "lineated")),
        pytest.param("round", 5, 3.5, 4, marks=pytest.mark.slow),
        *(pytest.param(name, 24, 4.0, 6, marks=pytest.mark.slow) for name in SPECTRA),
    ],
)
def test_spectrum_is_the_declared_one(name, seeds, deviations, bands):
    found, error = excess(SPECTRA[name], range(seeds))
    assert (np.abs(found) < 0.1 + deviations * error).all()
    assert np.abs(found[-bands:]).max() < 0.1  # where there are waves enough


@pytest.mark.parametrize("name", ["round", "peak"])
def test_tiles_are_what_one_shot_makes(name, monkeypatch):
    """Overlap and save over tiles against one transform of all, without the rounding of what is kept."""
    monkeypatch.setattr(endless_field, "KEPT", np.float64)
    made = []
    for side in (128, 256):
        monkeypatch.setattr(endless_field, "TILE", side)
        field = field_of(SPECTRA[name])
        made.append(np.block([[field.values(Nodes.of_tile(j, i)) for i in (-1, 0)] for j in (-1, 0)]))
    # Tiles of twice the side have their corners at a multiple of it.
    tiled, shot = made[0], made[1][128:384, 128:384]
    assert np.abs(tiled - shot).max() <= 1e-14 * np.abs(shot).max()


PLACES = Nodes(-700, 301, 260, 1000), Nodes(1021, -1023, 3, 2), Nodes(10**7 + 1, 5, 97, 31)


@pytest.mark.parametrize(
    ("name", "nodes"),
    [
        pytest.param(name, nodes, marks=[pytest.mark.slow] * (name != "peaks" and number != k % 3))
        for k, name in enumerate(SPECTRA)
        for number, nodes in enumerate(PLACES)
    ],
)
def test_a_rectangle_has_the_values_of_its_tiles(name, nodes):
    field = field_of(SPECTRA[name])
    tiled = gather_tiles(lambda *place: field.values(Nodes.of_tile(*place)), nodes.first, nodes.shape)
    assert np.abs(field.values(nodes) - tiled).max() <= 4e-7 * math.sqrt(field.variance)


@pytest.mark.parametrize("name", SPECTRA)
def test_what_is_kept_is_as_precise_as_heights(name, monkeypatch):
    """Heights are stored in 32 bits, which rounds them by 6e-8."""
    kept = field_of(SPECTRA[name]).values(Nodes.of_tile(2, -5))
    monkeypatch.setattr(endless_field, "KEPT", np.float64)
    exact = field_of(SPECTRA[name]).values(Nodes.of_tile(2, -5))
    assert np.abs(kept - exact).max() <= 1.2e-7 * np.abs(exact).max()


def test_a_tile_is_the_same_whatever_way_one_came_and_ground_does_not_repeat():
    straight, roundabout = (endless_heights((SPECTRA["round"],), SPACING, 1) for _ in range(2))
    one = straight(Nodes.of_tile(0, 0))
    for place in ((0, 1), (1, 0), (0, 1000), (-1, -1)):
        assert abs(np.corrcoef(one.ravel(), roundabout(Nodes.of_tile(*place)).ravel())[0, 1]) < 0.25
    np.testing.assert_array_equal(roundabout(Nodes.of_tile(0, 0)), one)


def test_half_the_spacing_shares_all_but_the_finest_waves():
    smooth = SPECTRA["smooth"].model_copy(update={"rms": 1.0})
    coarse, fine = (endless_heights((smooth,), spacing, 1)(Nodes.of_tile(0, 0)) for spacing in (SPACING, SPACING / 2))
    # The fine tile spans half of the coarse one: compare the same nodes.
    assert np.corrcoef(coarse[:256, :256].ravel(), fine[::2, ::2].ravel())[0, 1] > 0.999


def test_noise_is_white_and_a_hash_of_its_place():
    whole = range(-512, 512)
    noise = lattice_noise(1, 2, 0.1, whole, whole)
    assert noise.mean() == pytest.approx(0.0, abs=4e-3)
    assert noise.std() == pytest.approx(1.0, abs=3e-3)
    assert np.mean(noise**4) == pytest.approx(3.0, abs=0.03)
    for shifted in (noise[1:] * noise[:-1], noise[:, 1:] * noise[:, :-1]):
        assert shifted.mean() == pytest.approx(0.0, abs=4e-3)
    part = lattice_noise(1, 2, 0.1, range(-412, -402), range(-312, -292))
    np.testing.assert_array_equal(noise[100:110, 200:220], part)
    for other in (lattice_noise(2, 2, 0.1, whole, whole), lattice_noise(1, 3, 0.1, whole, whole)):
        assert np.corrcoef(noise.ravel(), other.ravel())[0, 1] == pytest.approx(0.0, abs=4e-3)
