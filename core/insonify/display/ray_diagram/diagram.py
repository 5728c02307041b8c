"""Ray diagram of a scene's water: rays, shadow zones, caustics and eigenrays in one vertical plane."""

import math
from dataclasses import dataclass

import numpy as np

from insonify.acoustics.water import SoundSpeedField
from insonify.arrays import Booleans, Floats

# Colours from slow to fast water: red, green and blue.
WATER = ((186, 214, 236), (228, 239, 246), (252, 246, 235), (249, 226, 190))


@dataclass(frozen=True, eq=False)
class DiagramRay:
    """Ray with its points in a vertical plane."""

    angle: float  # launch angle in degrees below the horizontal
    range: Floats  # (n,) points of the ray in metres, and travel time to each in seconds; the sonar is the first
    depth: Floats
    time: Floats


@dataclass(frozen=True, eq=False)
class DiagramEigenray(DiagramRay):
    """Ray from the sonar to a given point."""

    travel_time: float  # one-way travel time in seconds
    slant_range: float  # slant range at which the record shows the point, in metres
    level: float  # intensity relative to 1 m due to spreading alone, in dB; infinite on a caustic


@dataclass(frozen=True, eq=False)
class RayDiagram:
    """Rays of a scene's water in one vertical plane, between the surface and the mean bed."""

    title: str  # title of the scene
    layers: SoundSpeedField  # sound speed of the water
    source_depth: float  # depths of the sonar and the mean bed, and the greatest range, in metres
    bottom: float
    reach: float
    rays: tuple[DiagramRay, ...]  # rays at round launch angles
    shadow: Booleans  # (rows, columns) cells that no direct ray reaches, by depth (surface first) and range
    dark: Floats  # (n, 2) begin and end of the ranges at which none reaches the bed, in metres
    caustics: Floats  # (k, 2) ranges and depths at which neighbouring rays cross, in metres
    target: tuple[float, float] | None  # (float, float) range and depth of the point to which eigenrays are searched
    eigenrays: tuple[DiagramEigenray, ...]  # eigenrays by launch angle, the steepest upwards first
    limits: tuple[str, ...]  # ways in which the scene leaves the range of a formula for its water, as sentences


def compute_speed_limits(diagram: RayDiagram) -> tuple[float, float]:
    """Lowest and highest sound speed of the water shown, in m/s, with a margin on both sides."""
    layers = diagram.layers
    depth = np.append(layers.depth[(layers.depth > 0.0) & (layers.depth < diagram.bottom)], [0.0, diagram.bottom])
    speed = np.stack([np.interp(depth, layers.depth, profile) for profile in layers.speed])
    room = max(0.08 * float(np.ptp(speed)), 2.0)
    return float(speed.min()) - room, float(speed.max()) + room


def place_along_axis(layers: SoundSpeedField, distance: Floats) -> tuple[Floats, Floats]:
    """Coordinates x and y at distances along the line of a section's stations, in metres."""
    cos, sin = layers.axis
    return cos * distance, sin * distance


def describe_eigenray(ray: DiagramEigenray) -> str:
    """Describe an eigenray in one line: launch angle, travel time, slant range, level."""
    angle = f"{ray.angle:+.2f}°".replace("-", "−")
    level = f"{ray.level:.1f} dB".replace("-", "−") if math.isfinite(ray.level) else "on a caustic"
    return f"launched at {angle}: {1e3 * ray.travel_time:.3f} ms, slant range {ray.slant_range:.2f} m, {level}"
