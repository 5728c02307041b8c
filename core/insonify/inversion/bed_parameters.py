"""Parameters of a learned bed, and the seabed and receiver of a scene that has them."""

import math
from dataclasses import dataclass, replace
from functools import cache
from statistics import NormalDist
from typing import Any, NamedTuple, Self

import numpy as np
from scipy.fft import next_fast_len

from insonify.scene import Scene
from insonify.scene.edit import edit, plain
from insonify.scene.receiver.speckles import K, NoSpeckle, Rayleigh, SpeckleKind
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify.scene.seabed.reliefs.fractal import Fractal, power_spectrum

MOST_CELLS = 2048  # of a period of the bed
LONGEST_PERIOD = 2.0  # swaths of both sides after which the bed repeats, at least
BANDS = 12  # of patches of material
SEDIMENTS = ("silt", "fine_sand", "medium_sand", "coarse_sand", "sandy_gravel")
USUAL_SPEED = 1500.0  # m/s, where the water has several
MOST_LOOKS = 32
SPIKY = 1.5  # times the variance of one look, beyond which the bed itself is spiky; steep relief adds nearly as much
SPIKIEST, SMOOTHEST = 0.05, 100.0  # shapes of K speckle
LEAST_RMS = 1e-6  # m


class PowerLaw(NamedTuple):
    """Spectral density A f^−2β of a field on the bed, of both signs of the frequency f in cycles a metre."""

    log_level: float  # ln A and β; A in m² times the unit of the field squared, at one cycle a metre
    exponent: float


@dataclass(frozen=True)
class BedParameters:
    """Parameters of a bed that are learned."""

    relief: PowerLaw | None  # heights in metres; None for a level bed
    patches: PowerLaw | None  # logarithm of the backscatter; None for an even material
    speckle: float  # variance of the relative amplitude by speckle
    diffuse: float  # Lambert's share of the material, in the middle of its patches
    mirrors: bool  # whether the material has a mirror lobe: that of the sediment nearest in level

    def scaled(self, decibels: float) -> Self:
        """Material with its backscatter scaled by a gain, limited so that the albedo stays at most 1."""
        return replace(self, diffuse=min(self.diffuse * 10.0 ** (decibels / 10.0), 1.0))


def set_bed(scene: Scene, bed: BedParameters) -> Scene:
    """Give a scene a bed and speckle of some parameters, on a grid as fine as the record resolves."""
    period, spacing = choose_grid(scene)
    values = plain(scene)
    relief: dict[str, Any] = {"kind": "flat"}
    if bed.relief is not None and (rms := realised_rms(bed.relief, period, spacing)) >= LEAST_RMS:
        beta, rms = _rounded(bed.relief.exponent), _rounded(rms)
        relief = {"kind": "fractal", "beta": beta, "rms": rms, "period": period}
    seabed = {
        "depth": scene.seabed.depth,
        "spacing": spacing,
        "relief": relief,
        "material": _material(bed, period, spacing, scene.sonar.scattering_frequency),
    }
    speckle = choose_speckle(bed.speckle).model_dump(mode="json", exclude_none=True)
    return edit(scene, {"seabed": seabed, "receiver": values["receiver"] | {"speckle": speckle}})


def choose_grid(scene: Scene) -> tuple[float, float]:
    """Period and spacing of a bed in metres: two swaths long, and as fine as the resolution in range."""
    # A period has 2048 nodes at most.
    sonar = scene.sonar
    cell = max(sonar.range / sonar.bins, sonar.pulse.cell(scene.water.only_speed or USUAL_SPEED))
    swath = LONGEST_PERIOD * sonar.range
    spacing = float(f"{max(cell, swath / MOST_CELLS):.2g}")
    cells = min(next_fast_len(math.ceil(swath / spacing), real=True), MOST_CELLS)
    return round(cells * spacing, 9), spacing


def realised_rms(law: PowerLaw, period: float, spacing: float) -> float:
    """Root mean square over one period of a field with a spectral density, on a grid."""
    log_level, exponent = law
    half = round(period / spacing) // 2
    x, y = np.arange(1.0 - half, half)[:, None], np.arange(0.0, half)
    power = power_spectrum(Fractal(beta=exponent), x, y)
    power[half - 1, 0] = 0.0
    both = 2.0 * float(power.sum()) - float(power[:, 0].sum())  # of both signs of y
    peak = float(power_spectrum(Fractal(beta=exponent), np.ones(1), np.zeros(1))[0])
    return math.sqrt(math.exp(log_level) * period ** (2.0 * exponent - 2.0) * both / peak)


def slope_above(scene: Scene, shortest: float) -> float:
    """Root mean square slope along one direction, of the waves of a scene's fractal relief above a wavelength (m)."""
    relief = scene.seabed.relief
    if not isinstance(relief, Fractal):
        return 0.0
    half = round(relief.period / scene.seabed.spacing) // 2
    x, y = np.arange(1.0 - half, half)[:, None], np.arange(1.0 - half, half)
    power = power_spectrum(relief, x, y)
    power[half - 1, half - 1] = 0.0
    steep = (2.0 * np.pi / relief.period * x) ** 2 * (np.hypot(x, y) <= relief.period / shortest)
    return relief.rms * math.sqrt(float((power * steep).sum()) / float(power.sum()))


def _material(bed: BedParameters, period: float, spacing: float, frequency: float | None) -> dict[str, Any]:
    """Plain values of one material, or of a fractal map of one at several levels."""
    if bed.patches is None:
        return _at_level(bed, 0.0, frequency)
    spread = realised_rms(bed.patches, period, spacing) * 10.0 / math.log(10.0)  # dB
    levels = [spread * NormalDist().inv_cdf((number + 0.5) / BANDS) for number in range(BANDS)]
    return {
        "kind": "fractal",
        "beta": _rounded(bed.patches.exponent),
        "of": [_at_level(bed, level, frequency) for level in levels],
    }


def _at_level(bed: BedParameters, decibels: float, frequency: float | None) -> dict[str, Any]:
    """Plain values of the sediment nearest in level to the bed plus some decibels, with its level set to that."""
    diffuse = _rounded(bed.scaled(decibels).diffuse)
    named = {name: MATERIALS[name].reflectivity_at(frequency) for name in SEDIMENTS}
    name = min(SEDIMENTS, key=lambda one: abs(math.log(named[one].diffuse / max(diffuse, 1e-12))))
    specular = min(named[name].specular, 1.0 - diffuse) if bed.mirrors else 0.0
    lobe = {"shininess": _rounded(named[name].shininess)} if specular > 0.0 else {}
    return {"name": name, "diffuse": diffuse, "specular": _rounded(specular)} | lobe


def _rounded(value: float) -> float:
    """Round to five digits, more than a record determines, so that the last bits of sums have no effect."""
    return float(f"{value:.5g}")


@cache
def variance_of_looks(looks: float) -> float:
    """Variance of amplitude over squared mean, of the mean intensity of independent looks: n Γ(n)² / Γ(n + ½)² − 1."""
    return looks * math.exp(2.0 * (math.lgamma(looks) - math.lgamma(looks + 0.5))) - 1.0


def choose_speckle(variance: float) -> SpeckleKind:
    """Speckle with a given variance of its relative amplitude."""
    # Below half the variance of 32 looks there is none; up to 1.5 times that of one look it is Rayleigh speckle of some
    # looks; beyond, K speckle of one look.
    if variance < 0.5 * variance_of_looks(MOST_LOOKS):
        return NoSpeckle()
    if variance <= SPIKY * variance_of_looks(1):
        looks = min(range(1, MOST_LOOKS + 1), key=lambda count: abs(math.log(variance_of_looks(count) / variance)))
        return Rayleigh(looks=looks)
    texture = (1.0 + variance) / (1.0 + variance_of_looks(1)) - 1.0
    low, high = math.log(SPIKIEST), math.log(SMOOTHEST)
    for _ in range(50):  # the variance falls as the shape grows
        middle = 0.5 * (low + high)
        low, high = (middle, high) if variance_of_looks(math.exp(middle)) > texture else (low, middle)
    return K(shape=round(math.exp(low), 3))
