"""Beam patterns: tables of the two-way sensitivity of the sonar by range and direction."""

import math

import numpy as np

from insonify.arrays import Floats
from insonify.kernels.common.types import EVERY_GRAZING, GAUSSIAN, TABLE, TOP_HAT, BeamPattern, plain_pattern
from insonify.scene import Scene
from insonify.scene.sonar import Sonar
from insonify.scene.sonar.beams import BeamConditions
from insonify.scene.sonar.vertical_beams import VerticalBeamKind

FAR_FIELD = 1e7  # m, where waves from the array are flat
ANGLES = 8193  # of half a turn about the track
SHAPES = {"every_grazing": EVERY_GRAZING, "top_hat": TOP_HAT, "gaussian": GAUSSIAN, "table": TABLE}


def make_pattern(scene: Scene, sound_speed: float) -> tuple[float, BeamPattern]:
    """Half width and pattern of the beam of a scene, packed for the tracers."""
    beam, vertical = scene.sonar.beam, scene.sonar.vertical.response
    conditions = BeamConditions(sound_speed, scene.sonar.frequency, scene.sonar.range)
    half_width = beam.half_width(conditions)
    if not is_patterned(scene):
        return half_width, plain_pattern()
    table, shaded = beam.tabulate(conditions), scene.sonar.vertical.shades
    energy = table.energy[:, [0, -1]] if np.ptp(table.energy) == 0.0 else table.energy  # a top-hat needs no more
    # The integral of every row over the sine s from its start, by the trapezoidal rule.
    steps = 0.5 * (energy[:, 1:] + energy[:, :-1]) * (2.0 * table.extent[:, None] / (energy.shape[1] - 1))
    return half_width, BeamPattern(
        tabulated=True,
        centre=math.sin(math.radians(beam.axis)),
        extent=table.extent,
        energy=energy,
        integral=np.concatenate([np.zeros((len(energy), 1)), np.cumsum(steps, axis=1)], axis=1),
        first_range=table.first_range,
        per_octave=table.per_octave,
        vertical=SHAPES[vertical.shape],
        tilt=math.radians(vertical.tilt),
        s_vertical=math.sin(math.radians(vertical.width) / 2.0) if shaded else 1.0,
        two_way=beam.passes == 2,
        vertical_energy=scene.sonar.vertical.sensitivity(conditions.wavelength) ** beam.passes,
    )


def is_patterned(scene: Scene) -> bool:
    """Whether the beam needs a table: it is no level top-hat or knife with a uniform vertical beam."""
    beam = scene.sonar.beam
    tilts = beam.has_width and any(motion.tilts for motion in scene.track.motions)
    return not beam.top_hat or beam.axis != 0.0 or tilts or scene.sonar.vertical.shades


def vertical_energy(vertical: VerticalBeamKind, wavelength: float, passes: int, depression: Floats) -> Floats:
    """Response of a vertical beam in the plane across the fish, as the tracers' `vertical_response` has it."""
    response = vertical.response
    if response.shape == "every_grazing":
        return np.ones(depression.shape)
    off = depression - math.radians(response.tilt)
    ahead = np.cos(off) > 0.0
    if response.shape == "table":
        table = vertical.sensitivity(wavelength) ** passes
        return np.where(ahead, np.interp(-np.sin(off), np.linspace(-1.0, 1.0, table.size), table), 0.0)
    share = np.sin(off) / math.sin(math.radians(response.width) / 2.0)
    lobe = np.abs(share) <= 1.0 if response.shape == "top_hat" else np.exp2(-passes * share * share)
    return np.where(ahead, lobe, 0.0)


def directivity(sonar: Sonar, sound_speed: float) -> float:
    """Response of one side's array to isotropic noise, 4π / ∫ b dΩ, as a ratio of at least 1."""
    # Directions are the sine s along the track and the angle ψ about it: dΩ = ds dψ. A knife has no aperture that would
    # make it narrow, so it counts as even along the track.
    beam, conditions = sonar.beam, BeamConditions(sound_speed, sonar.frequency, FAR_FIELD)
    along = 2.0
    if beam.has_width:
        table = beam.at_range(conditions)
        s = np.linspace(-table.extent[0], table.extent[0], table.energy.shape[1])
        along = float(np.trapezoid(table.energy[0] ** (1.0 / beam.passes), s))
    about = np.linspace(-0.5 * math.pi, 0.5 * math.pi, ANGLES) + math.radians(sonar.vertical.response.tilt)
    vertical = vertical_energy(sonar.vertical, conditions.wavelength, 1, about)
    return max(4.0 * math.pi / (along * float(np.trapezoid(vertical, about))), 1.0)
