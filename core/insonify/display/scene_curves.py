"""Curves of beams, pulse and backscatter, and the spectrum of a bed, for small pictures beside their settings."""

import math
from typing import NamedTuple

import numpy as np

from insonify.acoustics.beam_patterns import vertical_energy
from insonify.acoustics.bed_materials import describe_limits, misfit
from insonify.acoustics.water import speed_at_sonar
from insonify.arrays import Floats
from insonify.scene import Scene
from insonify.scene.seabed.materials import Material
from insonify.scene.seabed.materials.sediments import LEAST_GRAZING, STEEPEST, scattering_strength
from insonify.scene.seabed.reliefs.fractal import Fractal, power_spectrum
from insonify.scene.sonar.beams import BeamConditions
from insonify.scene.sonar.pulses import PulseKind

FLOOR = -50.0  # dB, the least level of a curve
LOBES_SHOWN = 4.0  # half widths of the main lobe on either side of a beam's axis
PULSE_POINTS = 4096
SIDELOBES = 8.0  # resolutions before and after the echo of a compressed pulse
SPECTRAL_WIDTHS = 4.0  # over the pulse's resolution, the span of its spectrum
GRAZING_ANGLES = 161  # of a curve of backscatter
CELLS = 129  # of a spectrum's picture, a side
WIDEST_SPECTRUM, NARROWEST_SPECTRUM = 1.5, 8.0  # of the farthest peak; cycles a period


class Curve(NamedTuple):
    """A curve with its axes."""

    title: str  # quantity of the curve, and its main figure
    note: str
    x: Floats  # (n,)
    y: Floats
    x_unit: str  # the second is "dB" for levels, empty for amplitudes
    y_unit: str
    beside: Floats | None = None  # (n,) another curve to compare with


class ReliefSpectrum(NamedTuple):
    """Spectrum of a fractal bed over the plane of wave numbers."""

    decibels: Floats  # (n, n) power below the greatest; rows run with fy, columns with fx
    reach: float  # both wave numbers run from −reach to reach, in cycles per period
    peaks: tuple[tuple[float, float], ...]  # the declared peaks (fx, fy), in cycles per period


def beam_curve(scene: Scene) -> Curve | None:
    """Two-way level over the angle from the beam's axis along the track, at the range of the sonar."""
    beam = scene.sonar.beam
    if not beam.has_width:
        return None
    conditions = BeamConditions(speed_at_sonar(scene), scene.sonar.frequency, scene.sonar.range)
    table, half_width = beam.at_range(conditions), beam.half_width(conditions)
    reach = min(LOBES_SHOWN * half_width, 0.5 * math.pi)
    angle = np.linspace(-reach, reach, table.energy.shape[1])
    sines = np.linspace(-table.extent[0], table.extent[0], table.energy.shape[1])
    level = _decibels(np.interp(np.sin(angle), sines, table.energy[0], left=0.0, right=0.0))
    width = _width_at(angle, level)
    across = 2.0 * scene.sonar.range * math.tan(0.5 * width)
    note = f"−3 dB: {math.degrees(width):.3g}°, {across:.3g} m at {scene.sonar.range:g} m"
    return Curve(_ways("Beam along the track", beam.passes), note, np.degrees(angle), level, "°", "dB")


def vertical_beam_curve(scene: Scene) -> Curve | None:
    """Level of the vertical beam over the angle below the horizon; None for one that is uniform."""
    vertical = scene.sonar.vertical
    if not vertical.shades:
        return None
    wavelength = speed_at_sonar(scene) / scene.sonar.frequency
    depression = np.linspace(-math.pi / 6.0, math.pi / 2.0, 721)
    energy = vertical_energy(vertical, wavelength, scene.sonar.beam.passes, depression)
    level = _decibels(energy)
    peak = math.degrees(depression[int(np.argmax(level))])
    width = math.degrees(_width_at(depression, level))
    note = f"loudest {peak:.3g}° below the horizon, −3 dB: {width:.3g}°"
    return Curve(_ways("Vertical beam", scene.sonar.beam.passes), note, np.degrees(depression), level, "°", "dB")


def pulse_curve(scene: Scene) -> Curve | None:
    """Amplitude of a point's echo over time; None for a pulse shorter than any bin."""
    pulse = scene.sonar.pulse
    if pulse.length == 0.0:
        return None
    time = _times(pulse)
    cell = pulse.cell(speed_at_sonar(scene))
    note = f"resolves {cell:.3g} m"
    return Curve("Echo of a point", note, 1e3 * time, np.abs(pulse.envelope(time)), "ms", "")


def pulse_spectrum_curve(scene: Scene) -> Curve | None:
    """Level of the spectrum of a point's echo over frequency; None for a pulse shorter than any bin."""
    # The spectrum is the transform of the echo's envelope about the carrier.
    pulse = scene.sonar.pulse
    if pulse.length == 0.0:
        return None
    time = _times(pulse)
    step = time[1] - time[0]
    padded = 16 * time.size
    power = np.abs(np.fft.fftshift(np.fft.fft(pulse.envelope(time), padded))) ** 2
    away = np.fft.fftshift(np.fft.fftfreq(padded, step))
    shown = np.abs(away) <= 0.5 * SPECTRAL_WIDTHS / pulse.resolution
    level = _decibels(power[shown] / power.max())
    frequency = 1e-3 * (scene.sonar.frequency + away[shown])
    width = _width_at(frequency, level)
    return Curve("Spectrum of the echo", f"−3 dB: {width:.3g} kHz", frequency, level, "kHz", "dB")


def backscatter_curve(scene: Scene) -> Curve | None:
    """Backscattering strength of the bed's material over the grazing angle, beside its model; None without a model."""
    material, frequency = scene.seabed.material, scene.sonar.scattering_frequency
    if not has_backscatter_model(scene) or not isinstance(material, Material) or frequency is None:
        return None
    grazing = np.linspace(LEAST_GRAZING, STEEPEST, GRAZING_ANGLES)
    law = _decibels(scattering_strength(material.reflectivity_at(frequency), np.sin(grazing)))
    off = misfit(material, frequency, grazing)
    assert off is not None
    note = f"{off.min():+.1f} to {off.max():+.1f} dB over it".replace("-", "−")
    if any(describe_limits(scene)):
        note += ", outside its range"
    title = f"Backscatter at {frequency / 1e3:g} kHz, dashed: its model"
    return Curve(title, note, np.degrees(grazing), law, "°", "dB", law - off)


def has_backscatter_model(scene: Scene) -> bool:
    """Whether the bed is of one material, which follows a backscatter model."""
    material = scene.seabed.material
    return isinstance(material, Material) and material.model is not None and scene.sonar.law == "sonar"


def relief_spectrum(scene: Scene, reach: float | None = None) -> ReliefSpectrum | None:
    """Spectrum of a fractal bed; None for other reliefs."""
    relief = scene.seabed.relief
    if not isinstance(relief, Fractal):
        return None
    farthest = max(max(abs(fx), abs(fy)) for fx, fy in relief.peaks)
    reach = max(WIDEST_SPECTRUM * farthest, NARROWEST_SPECTRUM) if reach is None else reach
    axis = np.linspace(-reach, reach, CELLS)
    power = power_spectrum(relief, axis[None, :], axis[:, None])
    return ReliefSpectrum(_decibels(power / power.max()), reach, relief.peaks)


def _times(pulse: PulseKind) -> Floats:
    """Return times about the echo of a point that show all of it, or its first sidelobes."""
    if pulse.two_sided:
        reach = min(SIDELOBES * pulse.resolution, pulse.length)
        return np.linspace(-reach, reach, PULSE_POINTS)
    return np.linspace(-0.5 * pulse.length, 1.5 * pulse.length, PULSE_POINTS)


def _ways(title: str, passes: int) -> str:
    return f"{title}, {'two' if passes == 2 else 'one'} way"


def _decibels(energy: Floats) -> Floats:
    """Levels in dB, at least `FLOOR`."""
    return 10.0 * np.log10(np.maximum(energy, 10.0 ** (0.1 * FLOOR)))


def _width_at(x: Floats, level: Floats) -> float:
    """Width of a peak 3 dB below its top, with straight lines between points."""
    peak = int(np.argmax(level))
    below = level - level[peak] + 3.0
    return abs(_crossing(x[peak:], below[peak:]) - _crossing(x[peak::-1], below[peak::-1]))


def _crossing(x: Floats, height: Floats) -> float:
    """Place where a height that begins above zero first falls below it; the last place if it never does."""
    below = np.flatnonzero(height < 0.0)
    if below.size == 0:
        return float(x[-1])
    after = int(below[0])
    return float(np.interp(0.0, height[after - 1 : after + 1][::-1], x[after - 1 : after + 1][::-1]))
