"""Backscatter model of sediments against its limits in closed form and published numbers; the laws fitted to it."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import simpson
from scipy.special import j0

from insonify.acoustics.bed_materials import describe_limits, describe_materials, misfit
from insonify.cli import main
from insonify.scene import edit, load_scene
from insonify.scene.seabed.materials import Material
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify.scene.seabed.materials.sediments import (
    Sediment,
    diffraction_integral,
    fit_law,
    model_strength,
    scattering_strength,
)
from receptions import decibels

SEDIMENTS = [name for name in MATERIALS if MATERIALS[name].model is not None]
ANGLES = np.radians([10.0, 20.0, 30.0, 45.0, 60.0])
# Jackson model at 300 kHz: backscattering strength in dB at 10, 20, 30, 45 and 60° grazing.
PUBLISHED = {
    "silt": (-35.7, -31.8, -29.9, -28.3, -27.4),
    "fine_sand": (-34.5, -25.5, -23.5, -22.6, -20.4),
    "medium_sand": (-29.8, -21.6, -18.2, -18.7, -16.8),
    "coarse_sand": (-26.9, -18.6, -15.0, -15.1, -15.0),
    "sandy_gravel": (-19.1, -12.0, -11.2),
    "cobble": (-21.3, -12.4, -11.4),
}
SAND = Sediment(1.845, 1.1782, 0.01624, 0.002, 0.004446, 3.25)


def first_order(sediment, frequency, grazing):
    """Perturbation of first order of a rough fluid interface, written out (APL-UW TR 9407, section IV)."""
    k = 2.0 * math.pi * frequency / 1500.0
    rho, kappa, gamma = sediment.density, (1.0 + 1j * sediment.loss) / sediment.speed_ratio, sediment.spectral_exponent
    sine, cosine = np.sin(grazing), np.cos(grazing)
    contrast = (rho - 1.0) ** 2 * cosine**2 + rho**2 - kappa**2
    amplitude = contrast / (rho * sine + np.sqrt(kappa**2 - cosine**2)) ** 2
    w = sediment.spectral_strength * 1e-8 * (2.0 * k * cosine / 100.0) ** -gamma  # cm⁴ in m⁴, wave numbers in 1/cm
    return 4.0 * k**4 * sine**4 * np.abs(amplitude) ** 2 * w


def test_the_integral_against_its_closed_form_and_simpson_s_rule():
    q = np.array([1e-5, 1e-3, 0.05, 0.4, 3.0, 50.0])
    np.testing.assert_allclose(diffraction_integral(q, 0.5), q / (1.0 + q**2) ** 1.5, rtol=1e-6)
    for alpha, each in itertools.product((0.45, 0.625, 0.8), q[2:]):
        end = (36.0 / each) ** (0.5 / alpha)  # where the exponential is over
        u = np.linspace(0.0, end, 2 * int(20.0 * end + 2000.0) + 1)
        slow = simpson(u * j0(u) * np.exp(-each * u ** (2.0 * alpha)), x=u)
        assert diffraction_integral(np.array([each]), alpha) == pytest.approx(slow, rel=2e-4)


@pytest.mark.parametrize("name", PUBLISHED)
def test_it_returns_the_published_strengths(name):
    """Within 0.6 dB for silt and sands; gravel and cobble are rougher than the approximation of small slopes."""
    published = np.array(PUBLISHED[name])
    found = decibels(model_strength(MATERIALS[name].model, 300e3, ANGLES[: published.size]))
    smooth = name in ("silt", "fine_sand", "medium_sand", "coarse_sand")
    np.testing.assert_allclose(found[1:], published[1:], atol=0.6 if smooth else 2.8)
    assert found[0] == pytest.approx(published[0], abs=1.2 if smooth else 3.3)


def test_slightly_rough_interfaces_scatter_by_rayleigh_and_rice():
    """Of a rigid surface 4k⁴ (1 + cos²θ)² W, of a free one 4k⁴ sin⁴θ W."""
    smooth = SAND._replace(spectral_strength=1e-7, volume=0.0)
    angles = np.radians([5.0, 20.0, 40.0, 60.0, 75.0])
    found = model_strength(smooth, 100e3, angles)
    np.testing.assert_allclose(decibels(found), decibels(first_order(smooth, 100e3, angles)), atol=0.01)
    angles, k = np.radians([10.0, 30.0, 60.0]), 2.0 * math.pi * 100e3 / 1500.0
    spectrum = 1e-7 * 1e-8 * (2.0 * k * np.cos(angles) / 100.0) ** -3.25
    for density, amplitude in ((1e9, 1.0 + np.cos(angles) ** 2), (1e-9, 1.0 - np.cos(angles) ** 2)):
        found = model_strength(Sediment(density, 1.0, 1e-9, 0.0, 1e-7, 3.25), 100e3, angles)
        np.testing.assert_allclose(decibels(found), decibels(4.0 * k**4 * amplitude**2 * spectrum), atol=0.01)


def test_normal_incidence_is_kirchhoff_s_glint():
    """R²/8π Γ(1/α)/2α q^(−1/α), the density of facets that face the sonar (Jackson et al. 1986)."""
    sand, alpha, k = SAND._replace(volume=0.0), 0.625, 2.0 * math.pi * 300e3 / 1500.0
    w = SAND.spectral_strength * 100.0 ** (3.25 - 4.0)
    structure = 2.0 * math.pi * w * math.gamma(2.0 - alpha) * 2.0 ** (-2.0 * alpha)
    structure /= alpha * (1.0 - alpha) * math.gamma(1.0 + alpha)
    q = structure * 2.0 ** (1.0 - 2.0 * alpha) * k ** (2.0 * (1.0 - alpha))
    impedance = SAND.density * SAND.speed_ratio
    reflected = (impedance - 1.0) / (impedance + 1.0)
    exact = reflected**2 / (8.0 * math.pi) * math.gamma(1.0 / alpha) / (2.0 * alpha) * q ** (-1.0 / alpha)
    found = model_strength(sand, 300e3, np.radians([89.9]))
    assert decibels(found[0]) == pytest.approx(decibels(exact), abs=0.02)


def test_volumes_return_as_the_sine_at_any_frequency_and_roughness_rises_with_it():
    """All of the sound enters what has no contrast: σ₂ α_dB/(4kδ) sinθ = 5 σ₂ sinθ / ln 10."""
    angles = np.radians([10.0, 30.0, 60.0, 85.0])
    watery = Sediment(1.0, 1.0, 1e-4, 0.002, 1e-12, 3.25)
    exact = 5.0 * 0.002 * np.sin(angles) / math.log(10.0)
    np.testing.assert_allclose(model_strength(watery, 100e3, angles), exact, rtol=1e-3)
    # First order: k⁴ k^−γ, 0.75 of an octave's 3 dB; a fluid of silt scatters by its volume.
    rough = [decibels(model_strength(SAND._replace(volume=0.0), f, np.radians([15.0])))[0] for f in (20e3, 40e3)]
    assert rough[1] - rough[0] == pytest.approx(0.75 * decibels(2.0), abs=0.05)
    silt = [decibels(model_strength(MATERIALS["silt"].model, f, ANGLES[2:3]))[0] for f in (30e3, 900e3)]
    assert silt[1] - silt[0] == pytest.approx(0.0, abs=0.1)


def test_the_volume_is_the_sum_over_depth_of_what_enters_is_scattered_and_leaves():
    """σ_v = |1 + V|⁴/ρ² ∫ σ₂ a exp(−4 k Im P z) dz, with the attenuation a = (20/ln 10) k δ/ν in dB/m."""
    frequency, angles = 100e3, np.radians([15.0, 40.0, 70.0])
    k = 2.0 * math.pi * frequency / 1500.0
    for sand in (SAND, SAND._replace(density=1.2, speed_ratio=0.98, loss=0.004)):
        smooth = sand._replace(spectral_strength=1e-30)
        index = (1.0 + 1j * sand.loss) / sand.speed_ratio
        vertical = np.sqrt(index**2 - np.cos(angles) ** 2)
        reflected = (sand.density * np.sin(angles) - vertical) / (sand.density * np.sin(angles) + vertical)
        attenuation = 20.0 / math.log(10.0) * k * sand.loss / sand.speed_ratio
        depth = np.linspace(0.0, 40.0 / (4.0 * k * vertical.imag), 200001)
        way = simpson(np.exp(-4.0 * k * vertical.imag * depth), x=depth, axis=0)
        exact = sand.volume * attenuation * way * np.abs(1.0 + reflected) ** 4 / sand.density**2
        np.testing.assert_allclose(model_strength(smooth, frequency, angles), exact, rtol=1e-6)


def test_hardness_alone_makes_no_bed_brighter_at_flat_angles_and_shear_makes_rock_darker():
    """APL-UW TR 9407, table 2: rock as a fluid against cobble, and rough rock; published: elastic rock at 300 kHz."""
    rock = Sediment(2.5, 2.5, 0.01374, 0.002, 0.01862, 3.25)
    for frequency in (30e3, 100e3, 300e3):
        fluid, cobble = (model_strength(each, frequency, ANGLES[:3]) for each in (rock, MATERIALS["cobble"].model))
        assert np.abs(decibels(fluid / cobble)).max() < 0.7
    # The numbers of the material are the published ones of 30°, which lie 2 dB below those of the fluid.
    law = MATERIALS["rock"].reflectivity.diffuse / math.pi * math.sin(math.radians(30.0)) ** 2
    assert decibels(law) == pytest.approx(-13.5, abs=0.1)
    assert decibels(fluid[2] / law) == pytest.approx(2.1, abs=0.2)
    rough = model_strength(rock._replace(spectral_strength=0.20693), 30e3, ANGLES[:1])
    assert decibels(rough / model_strength(rock, 30e3, ANGLES[:1])) == pytest.approx(10.8, abs=0.3)


@pytest.mark.parametrize("name", SEDIMENTS)
def test_the_laws_follow_the_model(name):
    """As strong at 30°, as strong at normal incidence where the lobe counts, and never more than arrives."""
    model = MATERIALS[name].model
    for frequency in (12e3, 30e3, 100e3, 300e3, 455e3, 900e3, 1.6e6):
        fit = fit_law(model, frequency, 20.0)
        assert 0.0 <= fit.diffuse <= 1.0
        assert 0.0 <= fit.specular <= 1.0 - fit.diffuse
        at = np.radians([30.0, 89.9])
        law, exact = scattering_strength(fit, np.sin(at)), model_strength(model, frequency, at)
        assert fit.diffuse == 1.0 or decibels(law[0] / exact[0]) == pytest.approx(0.0, abs=1e-9)
        assert fit.specular == 0.0 or law[1] == pytest.approx(exact[1], rel=0.02) or sum(fit[:2]) == 1.0
        assert fit.specular > 0.0 or law[1] >= exact[1] * 0.999 or fit.diffuse == 1.0


@pytest.mark.parametrize("name", SEDIMENTS)
def test_levels_over_frequency_hardly_step(name):
    """Within 1 % of frequency by less than a decibel, of which the model itself takes up to 0.06."""
    frequencies, angles = np.geomspace(11e3, 500e3, 384), np.radians([15.0, 40.0, 55.0, 65.0, 75.0, 80.0, 86.0, 89.0])
    fits = [fit_law(MATERIALS[name].model, float(frequency), 20.0) for frequency in frequencies]
    levels = decibels(np.array([scattering_strength(fit, np.sin(angles)) for fit in fits]))
    assert np.abs(np.diff(levels, axis=0)).max() < 0.9


def test_misfits_of_sands_are_small_where_a_side_scan_looks():
    """From 10 to 45° grazing, at the frequencies with which the model was compared."""
    angles = np.radians(np.arange(10.0, 46.0, 5.0))
    for name in ("fine_sand", "medium_sand", "coarse_sand"):
        for frequency in (100e3, 200e3, 300e3):
            assert np.abs(misfit(Material(name=name), frequency, angles)).max() < 3.5, (name, frequency)


def test_given_numbers_and_the_law_of_light_keep_theirs():
    given = Material(name="medium_sand", diffuse=0.4, shininess=12.0)
    assert given.reflectivity_at(900e3) == given.reflectivity
    assert Material(name="steel").reflectivity_at(900e3) == MATERIALS["steel"].reflectivity
    shiny = Material(name="coarse_sand", specular=0.5).reflectivity_at(900e3)
    assert (shiny.diffuse, shiny.specular) == (0.5, 0.5)
    light = edit(load_scene("pipe-on-bed"), {"sonar.law": "light", "receiver.reverberation": "none"})
    assert light.seabed.material.rows(light.sonar.scattering_frequency)[1] == (MATERIALS["medium_sand"].reflectivity,)


def test_a_scene_is_told_of_misfits_and_limits(capsys):
    scene = edit(load_scene("pipe-on-bed"), {"sonar.frequency": 900e3, "sonar.range": 80.0, "sonar.ping_rate": 5.0})
    lines = list(describe_materials(scene))
    off = misfit(scene.seabed.material, 900e3, np.radians([10.0]))[0]
    assert lines[2].split()[:4] == ["medium_sand", "0.4383", "0.0000", "30"]
    assert f"{off:+.1f}" in lines[2]
    assert [line for line in lines if "outside the range" in line] == lines[3:4]
    assert lines[4].startswith("the record reaches down to 7.2° grazing")
    # Between the model's own growth, of roughness by 0.75 powers of frequency at 10 to 60°, and that of small grains.
    own = decibels(np.divide(*(model_strength(MATERIALS["medium_sand"].model, f, ANGLES[:4]) for f in (900e3, 300e3))))
    assert lines[3].endswith(
        f"by {own.max():+.1f} dB, grains may add up to {40.0 * math.log10(3.0) - own.min():.1f} dB"
    )
    low = list(describe_limits(edit(scene, {"sonar.frequency": 6e3, "sonar.range": 40.0, "sonar.pulse": "ideal"})))
    assert low[0].startswith("6 kHz is outside the range of the backscatter model, 10 to 300 kHz: extrapolated by -")
    near = edit(scene, {"sonar.frequency": 200e3, "sonar.range": 40.0})
    assert list(describe_limits(near)) == []
    assert list(describe_materials(edit(scene, {"seabed.material.diffuse": 0.2}))) == []
    assert "no model" in list(describe_materials(edit(scene, {"seabed.material": "rock"})))[2]
    assert main(["plan", "pipe-on-bed", "--set", "sonar.frequency=100e3"]) == 0
    assert "  medium_sand    0.08" in capsys.readouterr().out
