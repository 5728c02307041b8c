"""Curves of beams, pulses and beds beside their settings, against closed forms and the tracers' own tables."""

import math

import numpy as np
import pytest

from insonify.acoustics.beam_patterns import make_pattern
from insonify.display.scene_curves import (
    FLOOR,
    backscatter_curve,
    beam_curve,
    pulse_curve,
    pulse_spectrum_curve,
    relief_spectrum,
    vertical_beam_curve,
)
from insonify.kernels.beam.pattern import vertical_responses
from insonify.scene import bundled_scenes, edit, load_scene

SPEED = 1500.0
DEFAULT = edit(load_scene("default"), {"water": {"kind": "uniform", "sound_speed": SPEED}})
FAR = {"sonar.range": 5000.0, "sonar.ping_rate": 0.1}
VERTICALS = [
    {"kind": "fan", "width": 40.0, "tilt": 35.0},
    {"kind": "gaussian", "width": 30.0, "tilt": 20.0},
    {"kind": "array", "height": 0.01, "tilt": 25.0},
    {"kind": "table"},
]


def test_beams_have_their_declared_width_and_line_arrays_their_near_and_far_field() -> None:
    curve = beam_curve(edit(DEFAULT, {"sonar.beam": {"kind": "gaussian", "width": 2.0, "two_way": False}}))
    above = curve.x[curve.y >= -3.0103]
    assert np.ptp(above) == pytest.approx(2.0, abs=2.0 * (curve.x[1] - curve.x[0]))
    assert curve.note == "−3 dB: 2°, 1.74 m at 50 m"
    scene = edit(DEFAULT, {"sonar.beam": {"kind": "array", "length": 2.0}, "sonar.frequency": 1e6, "sonar.range": 10.0})
    near = beam_curve(scene)
    assert near.y.max() < -3.0, "no direction is within 3 dB of the far field's axis"
    assert float(near.note.split()[2].rstrip("°,")) > 0.0
    length, frequency = 0.3, 400e3
    spec = {"kind": "array", "length": length, "two_way": False}
    curve = beam_curve(edit(DEFAULT, {"sonar.beam": spec, "sonar.frequency": frequency, **FAR}))
    expected = 20.0 * np.log10(np.abs(np.sinc(length * frequency / SPEED * np.sin(np.radians(curve.x)))))
    loud = expected > -15.0
    np.testing.assert_allclose(curve.y[loud], expected[loud], atol=0.05)


@pytest.mark.parametrize("vertical", VERTICALS, ids=lambda spec: spec["kind"])
@pytest.mark.parametrize("two_way", [True, False])
def test_vertical_beam_is_that_of_the_tracers(vertical: dict[str, object], two_way: bool) -> None:
    beam = {"kind": "gaussian", "width": 1.0, "two_way": two_way}
    scene = edit(DEFAULT, {"sonar.beam": beam, "sonar.vertical": vertical})
    curve, pattern = vertical_beam_curve(scene), make_pattern(scene, SPEED)[1]
    angle = np.radians(curve.x)
    traced = np.empty(angle.size)
    vertical_responses(pattern, -angle, traced)
    np.testing.assert_allclose(curve.y, np.maximum(10.0 * np.log10(np.maximum(traced, 1e-9)), FLOOR), atol=1e-6)


def test_a_tone_lasts_as_long_as_it_is_and_a_chirp_is_compressed_to_a_point_each_with_its_spectrum() -> None:
    duration, frequency = 2e-4, 300e3
    scene = edit(DEFAULT, {"sonar.pulse": {"kind": "tone", "duration": duration}, "sonar.frequency": frequency})
    curve = pulse_spectrum_curve(scene)
    expected = 20.0 * np.log10(np.maximum(np.abs(np.sinc(duration * (1e3 * curve.x - frequency))), 1e-9))
    loud = expected > -25.0
    np.testing.assert_allclose(curve.y[loud], expected[loud], atol=0.05)
    assert float(curve.note.split()[2]) == pytest.approx(0.886e-3 / duration, rel=0.01)
    echo = pulse_curve(scene)
    assert np.ptp(echo.x[echo.y > 0.5]) == pytest.approx(0.2, rel=2e-3)
    assert echo.note == "resolves 0.15 m"
    spec = {"kind": "chirp", "duration": 5e-3, "bandwidth": 40e3, "window": "uniform"}
    curve = pulse_spectrum_curve(edit(DEFAULT, {"sonar.pulse": spec, "sonar.frequency": 100e3}))
    assert np.median(curve.y[np.abs(curve.x - 100.0) < 15.0]) == pytest.approx(0.0, abs=1.0)
    assert curve.y[np.abs(curve.x - 100.0) > 25.0].max() < -20.0
    chirp = pulse_curve(edit(DEFAULT, {"sonar.pulse": {"kind": "chirp", "bandwidth": 30e3}}))
    assert chirp.x[np.argmax(chirp.y)] == pytest.approx(0.0, abs=1e-3)


def test_spectrum_of_a_bed_is_greatest_at_its_peaks_and_their_images() -> None:
    relief = {"kind": "fractal", "beta": 1.6, "peaks": [[12.0, 5.0]], "clamp": "soft"}
    spectrum = relief_spectrum(edit(DEFAULT, {"seabed.relief": relief}))
    axis = np.linspace(-spectrum.reach, spectrum.reach, len(spectrum.decibels))
    row, column = np.unravel_index(int(np.argmax(spectrum.decibels)), spectrum.decibels.shape)
    assert abs(abs(axis[column]) - 12.0) < 0.5
    assert math.copysign(1.0, axis[column]) * axis[row] == pytest.approx(5.0, abs=0.5)
    np.testing.assert_allclose(spectrum.decibels, spectrum.decibels[::-1, ::-1])


CURVES = beam_curve, vertical_beam_curve, pulse_curve, pulse_spectrum_curve


def test_what_has_no_shape_has_no_curve() -> None:
    none = {"sonar.beam": "knife", "sonar.vertical": "uniform", "sonar.pulse": "ideal", "seabed.relief": "flat"}
    assert [draw(edit(DEFAULT, none)) for draw in (*CURVES, relief_spectrum)] == [None] * 5


@pytest.mark.parametrize("name", sorted(bundled_scenes()))
def test_curves_of_every_scene_are_finite(name: str) -> None:
    scene = load_scene(name)
    for curve in filter(None, (draw(scene) for draw in CURVES)):
        assert curve.x.size > 1
        assert np.isfinite([curve.x, curve.y]).all()
    spectrum = relief_spectrum(scene)
    assert spectrum is None or np.isfinite(spectrum.decibels).all()


def test_backscatter_is_shown_beside_its_model():
    scene = edit(load_scene("default"), {"sonar.frequency": 200e3, "sonar.range": 50.0})
    curve = backscatter_curve(scene)
    assert curve.title == "Backscatter at 200 kHz, dashed: its model"
    at = np.argmin(np.abs(curve.x - 30.0))
    assert curve.y[at] == pytest.approx(curve.beside[at], abs=0.05)
    off = curve.y - curve.beside
    assert curve.note == f"{off.min():+.1f} to {off.max():+.1f} dB over it".replace("-", "−")
    assert backscatter_curve(edit(scene, {"sonar.frequency": 900e3})).note.endswith("outside its range")
    for changes in ({"seabed.material": "rock"}, {"seabed.material.diffuse": 0.2}, {"sonar.law": "light"}):
        assert backscatter_curve(edit(scene, changes)) is None
