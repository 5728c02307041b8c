"""Materials of a bed against the backscatter models of their sediments: fitted numbers, misfits, limits of validity."""

import math
from collections.abc import Iterator

import numpy as np

from insonify.arrays import Floats
from insonify.scene import Scene
from insonify.scene.seabed.materials import Material
from insonify.scene.seabed.materials.sediments import (
    LEAST_FREQUENCY,
    LEAST_GRAZING,
    MOST_FREQUENCY,
    STEEPEST,
    model_strength,
    scattering_strength,
)

GRAZING = (10.0, 20.0, 30.0, 45.0, 60.0, 90.0)  # degrees at which misfits are listed


def misfit(material: Material, frequency: float, grazing: Floats) -> Floats | None:
    """Level in dB of Lambert's and Phong's laws over the model of a material, by grazing angle; None without one."""
    if material.model is None:
        return None
    angle = np.minimum(grazing, STEEPEST)
    law = scattering_strength(material.reflectivity_at(frequency), np.sin(angle))
    return np.asarray(10.0 * np.log10(law / model_strength(material.model, frequency, angle)))


def find_material(scene: Scene, row: int) -> Material | None:
    """Material of a row of the scene's table of materials; None for a mixture and for no material."""
    bed, rows = scene.seabed.material.materials, len(scene.seabed.material.rows()[0])
    if row >= rows:
        return scene.targets[row - rows].material
    return bed[row] if row >= 0 and rows == len(bed) else None


def describe_materials(scene: Scene) -> Iterator[str]:
    """Yield the lines of a table of the bed's fitted materials, then of what lies outside the range of the model."""
    frequency = scene.sonar.scattering_frequency
    named = {one.name: one for one in scene.seabed.material.materials if one.diffuse is None}
    if frequency is None or not named:
        return
    yield f"bed at {frequency / 1e3:g} kHz, with its level over the backscatter model in dB by grazing angle"
    angles = "".join(f"{angle:5g}°" for angle in GRAZING)
    yield f"  {'material':<13s} diffuse specular    n{angles}"
    for name, material in named.items():
        numbers, off = material.reflectivity_at(frequency), misfit(material, frequency, np.radians(GRAZING))
        levels = "  no model, the same at any frequency"
        if off is not None:
            levels = "".join(f"{round(level, 1) + 0.0:+6.1f}" for level in off.tolist())
        yield f"  {name:<13s}{numbers.diffuse:8.4f}{numbers.specular:9.4f}{numbers.shininess:5g}{levels}"
    yield from describe_limits(scene)


def describe_limits(scene: Scene) -> Iterator[str]:
    """Describe in a sentence each way in which a scene leaves the range of the backscatter model."""
    frequency = scene.sonar.scattering_frequency
    models = [one.model for one in scene.seabed.material.materials if one.model is not None]
    if frequency is None or not models:
        return
    nearest = min(max(frequency, LEAST_FREQUENCY), MOST_FREQUENCY)
    if frequency != nearest:
        angle = np.radians(GRAZING[:4])  # nearer to nadir facets rule, which do not depend on grains
        ratios = [model_strength(one, frequency, angle) / model_strength(one, nearest, angle) for one in models]
        changes = 10.0 * np.log10(ratios)
        beyond = "layers and buried objects add to it"
        if frequency > nearest:
            # Of grains small against the wavelength, as Rayleigh's law has it; larger ones gain less.
            beyond = f"grains may add up to {40.0 * math.log10(frequency / nearest) - changes.min():.1f} dB"
        yield (
            f"{frequency / 1e3:g} kHz is outside the range of the backscatter model, {LEAST_FREQUENCY / 1e3:g} to "
            f"{MOST_FREQUENCY / 1e3:g} kHz: extrapolated by {changes.flat[np.abs(changes).argmax()]:+.1f} dB, {beyond}"
        )
    grazing = math.asin(min(scene.altitude / scene.sonar.range, 1.0))
    if grazing < LEAST_GRAZING:
        yield (
            f"the record reaches down to {math.degrees(grazing):.1f}° grazing; the backscatter model is valid from "
            f"{math.degrees(LEAST_GRAZING):g}°"
        )
