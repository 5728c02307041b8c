"""Failures of the receiver and of scattering: gain on noise, lobes that return more than arrives."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, Measured, StabilityTheme
from insonify.accuracy.stability.drawing import common, curve, ours, panel
from insonify.accuracy.stability.level_scenes import make_level_scene
from insonify.kernels.common.scattering import bistatic_strength
from insonify.kernels.common.types import SONAR
from insonify.simulation import simulate

THEME = StabilityTheme("The receiver", 10)
Values = NDArray[np.float64]
ABSORPTION = 0.3  # dB/m, some 900 kHz
NOISY = {
    "sonar.range": 150.0, "sonar.bins": 1500, "sonar.ping_rate": 4.0, "track.pings": 24,
    "water.absorption": 1e3 * ABSORPTION, "receiver.noise": {"kind": "ambient", "level": -120.0},
}  # fmt: skip


@THEME.case(
    "Gain over noise",
    "Time-varied gain keeps rising where only noise is left.",
    "level of the last tenth of the record above the bed's",
    "dB",
    failing=Approach("Applies 40 log r + 2αr at every range.", 20.0),
    right=Approach("Holds the gain from the range where even a perfect bed is below the noise.", 3.0),
)
def _gain() -> Measured:
    tvg = {"receiver.tvg": {"kind": "power", "spreading": 40.0}}
    bare, gained = (simulate(make_level_scene(NOISY | more)) for more in ({}, tvg))
    r = bare.slant_range.values
    plain, own = (one.intensity.values.astype(np.float64).mean(axis=(0, 1)) for one in (bare, gained))
    plain = plain * 10.0 ** ((40.0 * np.log10(r) + 2.0 * ABSORPTION * r) / 10.0)
    return Measured.by(lambda one: 10.0 * np.log10(one[1350:].mean() / one[100:500].max()), plain, own, panel(
        common(r, 10.0 * np.log10(plain), "gain to the end of the range", linewidth=1.0),
        ours(r, 10.0 * np.log10(own), "gain held where noise exceeds any bed", linewidth=1.0),
        x="slant range (m)", y="level (dB)",
    ))  # fmt: skip


def _albedos(incidences: Values, shininess: float) -> tuple[Values, Values]:
    """Shares of the energy from incidences that leave in all directions: as light has the lobe, and normalised."""
    cosine = (np.arange(120) + 0.5) / 120.0
    around = (np.arange(120) + 0.5) / 120.0 * 2.0 * math.pi
    cosines, angles = (grid.ravel() for grid in np.meshgrid(cosine, around))
    solid_angle = np.full(cosines.size, 2.0 * math.pi / cosines.size)
    plain, own = [], []
    for incidence in incidences:
        mirrored = cosines * math.cos(incidence) - np.sqrt(1.0 - cosines**2) * np.cos(angles) * math.sin(incidence)
        # Lambert and Phong, k_d/π + k_s max(0, R·V)ⁿ with k_d = k_s = ½, times the cosine of what leaves.
        lobe = (0.5 / math.pi + 0.5 * np.maximum(mirrored, 0.0) ** shininess) * cosines
        plain.append(float((lobe * solid_angle).sum()))
        arrives = math.cos(incidence)
        leaves = [bistatic_strength(arrives, c, m, 0.5, 0.5, shininess, SONAR) for c, m in zip(cosines, mirrored)]
        own.append(float((np.array(leaves) * solid_angle).sum() / arrives))
    return np.array(plain), np.array(own)


@THEME.case(
    "A lobe without its norm",
    "Phong's lobe added to Lambert's law without a norm returns more energy than arrives.",
    "surplus over the incident energy",
    "",
    failing=Approach("Takes k_d/π + k_s cosⁿ with k_d + k_s = 1.", 0.3),
    right=Approach("Normalises the lobe by its integral: a factor (n + 2)/2π.", 0.002),
)
def _lobe() -> Measured:
    degrees, curves, albedos = np.arange(0.0, 81.0, 10.0), [], []
    for n, style in ((1.0, "-"), (4.0, "--")):
        plain, own = _albedos(np.radians(degrees), n)
        albedos.append((plain.max(), own.max()))
        curves += [common(degrees, plain, f"as light has it, n = {n:g}", style)]
        curves += [ours(degrees, own, f"normalised, n = {n:g}", style)]
    plain, own = np.array(albedos).T
    return Measured.by(lambda shares: max(*shares, 1.0) - 1.0, plain, own, panel(
        *curves, curve("black", None, 1.0, style=":", linewidth=0.8),
        x="incidence (°)", y="share that leaves", ylim=(0.0, 1.7),
    ))  # fmt: skip
