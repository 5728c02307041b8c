"""What is known of a point of the record and of the tow: ranges, the bed there, intensity."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from insonify_viewer.record import Record
from insonify_viewer.session import Mark

if TYPE_CHECKING:
    from insonify.display.picture import LevelBed
    from insonify.simulation import Simulation

Place = tuple[float, float, float]
SIDES = ("port", "starboard")


def place_of(simulation: Simulation, mark: Mark) -> tuple[float, float | None, Place | None]:
    """Find where a point of the record lies, on a bed that is level across the track.

    Parameters
    ----------
    simulation : Simulation
        Prepared scene.
    mark : Mark
        Point of the record.

    Returns
    -------
    slant_range : float
        As recorded, in metres.
    ground_range : float or None
        sqrt(r² − h²) for the height h above the bed under the sonar; None in the water column.
    place : (float, float, float) or None
        Local coordinates of the bed there; None in the water column or where there is no bed.
    """
    sonar, ground = simulation.scene.sonar, simulation.ground
    slant = (mark.bin + 0.5) * sonar.range / sonar.bins
    pose = simulation.poses(np.array([mark.ping], dtype=np.int64))
    below = float(ground.height_at(pose.x, pose.y)[0])
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
    z = float(ground.height_at(np.array([x]), np.array([y]))[0])
    return slant, math.hypot(across, ahead), None if math.isnan(z) else (x, y, z)


def readout(simulation: Simulation, record: Record, level: LevelBed, mark: Mark) -> tuple[str, Place | None]:
    """Describe a point of the record.

    Parameters
    ----------
    simulation : Simulation
        Prepared scene.
    record : Record
        Pings held.
    level : LevelBed
        Intensities that stand for amplitude 1.
    mark : Mark
        Point to describe.

    Returns
    -------
    text : str
        Ping, side, slant and ground range, height of the bed against its mean, intensity.
    place : (float, float, float) or None
        Where it lies on the bed, in local metres.
    """
    amplitude = record.amplitude_at(mark.ping, mark.side, mark.bin)
    if amplitude is None or mark.bin >= simulation.scene.sonar.bins:
        return "", None
    slant, across, place = place_of(simulation, mark)
    parts = [f"ping {mark.ping}", SIDES[mark.side], f"slant {slant:.2f} m"]
    parts.append("water column" if across is None else f"ground {across:.2f} m")
    if place is not None:
        parts.append(f"bed {place[2]:+.2f} m")
    intensity = amplitude**2 * float(level.curves(np.array([mark.ping]))[0, 0, mark.bin])
    decibels = f" ({10.0 * math.log10(intensity):.1f} dB)" if intensity > 0.0 else ""
    return "  ·  ".join([*parts, f"{intensity:.3g}{decibels}"]), place
