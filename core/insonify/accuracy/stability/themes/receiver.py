"""Failures of the receiver and of scattering: gain on noise, lobes that return more than arrives."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel
from insonify.accuracy.stability.level_scenes import make_level_scene
from insonify.kernels.common.scattering import bistatic_strength
from insonify.kernels.common.types import SONAR
from insonify.simulation import simulate

Curve = NDArray[np.float64]
ABSORPTION = 0.3  # dB/m, some 900 kHz
NOISY = {
    "sonar.range": 150.0, "sonar.bins": 1500, "sonar.ping_rate": 4.0, "track.pings": 24,
    "water.absorption": 1e3 * ABSORPTION, "receiver.noise": {"kind": "ambient", "level": -120.0},
}  # fmt: skip


@lru_cache(maxsize=2)
def _mean_record(tvg: bool) -> tuple[Curve, Curve]:
    """Slant range and mean intensity of a noisy record, with the receiver's own gain or none."""
    changes = NOISY | ({"receiver.tvg": {"kind": "power", "spreading": 40.0}} if tvg else {})
    record = simulate(make_level_scene(changes))
    return record.slant_range.values, record.intensity.values.astype(np.float64).mean(axis=(0, 1))


def plain_gain(r: Curve) -> Curve:
    """40 log r + 2αr at every range, as a ratio of powers."""
    return np.asarray(10.0 ** ((40.0 * np.log10(r) + 2.0 * ABSORPTION * r) / 10.0))


def _raised() -> Curve:
    r, record = _mean_record(False)
    return record * plain_gain(r)


def _rise(record: Curve) -> float:
    """Decibels by which the last tenth of a record lies above its loudest part before 50 m."""
    return float(10.0 * np.log10(record[1350:].mean() / record[100:500].max()))


def _draw_gain(figure: Figure) -> None:
    r, own = _mean_record(True)
    axes = add_panel(figure, x="slant range (m)", y="level (dB)")
    axes.plot(r, 10.0 * np.log10(_raised()), color=WRONG, linewidth=1.0, label="gain to the end of the range")
    axes.plot(r, 10.0 * np.log10(own), color=RIGHT, linewidth=1.0, label="gain held where noise exceeds any bed")
    add_legend(axes)


def plain_lobe(cos_out: Curve, mirrored: Curve, diffuse: float, specular: float, shininess: float) -> Curve:
    """Lambert and Phong as light has them, k_d/π + k_s max(0, R·V)ⁿ, times the cosine of what leaves."""
    return np.asarray((diffuse / math.pi + specular * np.maximum(mirrored, 0.0) ** shininess) * cos_out)


def _directions() -> tuple[Curve, Curve, Curve, Curve]:
    """Directions over the half space and the solid angle of each."""
    cosine = (np.arange(120) + 0.5) / 120.0
    around = (np.arange(120) + 0.5) / 120.0 * 2.0 * math.pi
    cosines, angles = (grid.ravel() for grid in np.meshgrid(cosine, around))
    sines = np.sqrt(1.0 - cosines**2)
    return sines * np.cos(angles), sines * np.sin(angles), cosines, np.full(cosines.size, 2.0 * math.pi / cosines.size)


def _albedo(incidence: float, normalised: bool, diffuse: float, specular: float, shininess: float) -> float:
    """Share of what arrives at an incidence that leaves in all directions."""
    x, _, cosine, solid_angle = _directions()
    mirrored = cosine * math.cos(incidence) - x * math.sin(incidence)
    if not normalised:
        return float((plain_lobe(cosine, mirrored, diffuse, specular, shininess) * solid_angle).sum())
    arriving = math.cos(incidence)
    out = [bistatic_strength(arriving, c, m, diffuse, specular, shininess, SONAR) for c, m in zip(cosine, mirrored)]
    return float((np.array(out) * solid_angle).sum() / arriving)


@lru_cache(maxsize=4)
def _albedos(normalised: bool, shininess: float) -> Curve:
    return np.array([_albedo(a, normalised, 0.5, 0.5, shininess) for a in np.radians(INCIDENCES)])


INCIDENCES = np.arange(0.0, 81.0, 10.0)


def _excess(normalised: bool) -> float:
    return max(float(max(_albedos(normalised, n).max() for n in (1.0, 4.0))) - 1.0, 0.0)


def _draw_albedo(figure: Figure) -> None:
    axes = add_panel(figure, x="incidence (°)", y="share that leaves")
    for n, style in ((1.0, "-"), (4.0, "--")):
        axes.plot(INCIDENCES, _albedos(False, n), style, color=WRONG, label=f"as light has it, n = {n:g}")
        axes.plot(INCIDENCES, _albedos(True, n), style, color=RIGHT, label=f"normalised, n = {n:g}")
    axes.axhline(1.0, color="black", linewidth=0.8, linestyle=":")
    axes.set_ylim(0.0, 1.7)
    add_legend(axes)


THEME = StabilityTheme("The receiver", 10, (
    StabilityCase(
        "Gain over noise",
        "Time-varied gain keeps rising where only noise is left.",
        "level of the last tenth of the record above the bed's", "dB",
        Approach("Applies 40 log r + 2αr at every range.", lambda: _rise(_raised()), 20.0),
        Approach("Holds the gain from the range where even a perfect bed is below the noise.",
                 lambda: _rise(_mean_record(True)[1]),
            3.0),
        _draw_gain,
    ),
    StabilityCase(
        "A lobe without its norm",
        "Phong's lobe added to Lambert's law without a norm returns more energy than arrives.",
        "surplus over the incident energy", "",
        Approach("Takes k_d/π + k_s cosⁿ with k_d + k_s = 1.", lambda: _excess(False), 0.3),
        Approach("Normalises the lobe by its integral: a factor (n + 2)/2π.", lambda: _excess(True), 0.002),
        _draw_albedo,
    ),
))  # fmt: skip
