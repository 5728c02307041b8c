"""A point of the record: its ranges, the bed there, and the intensity."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from insonify_viewer.record.record import Record
from insonify_viewer.state.session import Mark

if TYPE_CHECKING:
    from insonify.display.normalisation import LevelBed
    from insonify.simulation import Simulation
    from insonify_viewer.record.pixel_label import PixelLabel

Position = tuple[float, float, float]


@dataclass(frozen=True)
class MarkedPoint:
    """What the record and the scene hold at a point of the record."""

    mark: Mark  # ping, side and bin of the point
    slant_range: float  # as recorded, in metres
    ground_range: float | None  # in metres; None in the water column
    # (float, float, float) local coordinates of the bed there; None in the water column or where there is no bed.
    position: Position | None
    intensity: float  # linear, before display gain
    label: PixelLabel | None = None  # what the bin shows; None while it is not known


def marked_point(simulation: Simulation, record: Record, level: LevelBed, mark: Mark) -> MarkedPoint | None:
    """Look a point of the record up."""
    amplitude = record.amplitude_at(mark.ping, mark.side, mark.bin)
    if amplitude is None or mark.bin >= simulation.scene.sonar.bins:
        return None
    intensity = amplitude**2 * float(level.curves(np.array([mark.ping]))[0, 0, mark.bin])
    return MarkedPoint(mark, *locate_mark(simulation, mark), intensity)


def locate_mark(simulation: Simulation, mark: Mark) -> tuple[float, float | None, Position | None]:
    """Find where a point of the record lies, on a bed that is level across the track."""
    sonar, ground = simulation.scene.sonar, simulation.ground
    slant = (mark.bin + 0.5) * sonar.range / sonar.bins
    pose = simulation.poses(np.array([mark.ping], dtype=np.int64))
    below = float(ground.height_at_once(pose.x, pose.y)[0])
    height = float(pose.z[0]) - (0.0 if math.isnan(below) else below)
    true_slant = (mark.bin + 0.5) * simulation.arrays.bin_length
    # The beam is a cone about the fish's axis, squinted from the plane athwart; with the bow up it leans forward.
    pitch, squint = float(pose.pitch[0]), simulation.arrays.pattern.centre
    ahead = (squint * true_slant + height * math.sin(pitch)) / math.cos(pitch)
    if true_slant < math.hypot(height, ahead):
        return slant, None, None
    across = math.sqrt(true_slant**2 - height**2 - ahead**2)
    left = across if mark.side == 0 else -across
    cos, sin = math.cos(float(pose.heading[0])), math.sin(float(pose.heading[0]))
    x, y = float(pose.x[0]) + ahead * cos - left * sin, float(pose.y[0]) + ahead * sin + left * cos
    z = float(ground.height_at_once(np.array([x]), np.array([y]))[0])
    return slant, math.hypot(across, ahead), None if math.isnan(z) else (x, y, z)
