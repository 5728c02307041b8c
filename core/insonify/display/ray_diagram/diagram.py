"""What a ray diagram holds: the rays of a scene's water in one vertical plane."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.layers import SoundSpeedField
from insonify.io.atomic import replacing
from insonify.scene import SceneError

Values = NDArray[np.float64]
COLUMNS = ("kind", "number", "launch_angle", "range", "depth", "time")
SUFFIXES = (".png", ".csv")
# From slow to fast: red, green and blue.
WATER = ((186, 214, 236), (228, 239, 246), (252, 246, 235), (249, 226, 190))


@dataclass(frozen=True, eq=False)
class DiagramRay:
    """One ray.

    Attributes
    ----------
    angle : float
        Of launch, degrees below the horizontal.
    range, depth, time : (n,) float64
        Its points, in metres, and when it is there, in seconds; the sonar is the first.
    """

    angle: float
    range: Values
    depth: Values
    time: Values


@dataclass(frozen=True, eq=False)
class DiagramEigenray(DiagramRay):
    """A ray that joins the sonar and a point.

    Attributes
    ----------
    travel_time : float
        One way, in seconds.
    slant_range : float
        At which the record has it, in metres.
    level : float
        Intensity over that at 1 m by spreading alone, in dB; infinite on a caustic.
    """

    travel_time: float
    slant_range: float
    level: float


@dataclass(frozen=True, eq=False)
class RayDiagram:
    """Rays of a scene's water in one vertical plane, up to the surface and down to the mean bed.

    Attributes
    ----------
    title : str
        Of the scene.
    layers : Layers
        The water.
    source_depth, bottom, reach : float
        Depths of the sonar and the mean bed, and the greatest range, in metres.
    rays : tuple of Path
        At round launch angles.
    shadow : (rows, columns) bool
        Where no direct ray comes, by depth (surface first) and range.
    dark : (n, 2) float64
        Ranges at which none comes to the bed, in metres.
    caustics : (k, 2) float64
        Ranges and depths at which neighbouring rays cross, in metres.
    target : (float, float) or None
        Range and depth of the point that eigenrays are asked for.
    eigenrays : tuple of Eigenray
        By launch angle, the steepest upwards first.
    """

    title: str
    layers: SoundSpeedField
    source_depth: float
    bottom: float
    reach: float
    rays: tuple[DiagramRay, ...]
    shadow: NDArray[np.bool_]
    dark: Values
    caustics: Values
    target: tuple[float, float] | None
    eigenrays: tuple[DiagramEigenray, ...]

    def save(self, path: str | FilePath) -> None:
        """Write the diagram as a picture (.png) or the points of its rays as a table (.csv).

        Raises
        ------
        SceneError
            If the file's name ends in anything else.
        """
        suffix = FilePath(path).suffix.lower()
        if suffix not in SUFFIXES:
            raise SceneError(f"output: {FilePath(path).name!r} names no format that is known; end it in .png or .csv")
        with replacing(path) as beside:
            if suffix == ".csv":
                self._write_table(beside)
            else:
                from insonify.display.ray_diagram.figure import draw_ray_diagram  # and Matplotlib with it

                draw_ray_diagram(self).savefig(beside, format="png", dpi=150)

    def _write_table(self, path: FilePath) -> None:
        with path.open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file)
            table.writerow(COLUMNS)
            for kind, paths in (("ray", self.rays), ("eigenray", self.eigenrays)):
                for number, ray in enumerate(paths):
                    for point in zip(ray.range, ray.depth, ray.time):
                        table.writerow([kind, number, f"{ray.angle:.9g}", *(f"{value:.9g}" for value in point)])


def compute_speed_limits(diagram: RayDiagram) -> tuple[float, float]:
    """Least and greatest speed in the water that is shown, in m/s, with room on either hand."""
    layers = diagram.layers
    depth = np.append(layers.depth[(layers.depth > 0.0) & (layers.depth < diagram.bottom)], [0.0, diagram.bottom])
    speed = np.stack([np.interp(depth, layers.depth, profile) for profile in layers.speed])
    room = max(0.08 * float(np.ptp(speed)), 2.0)
    return float(speed.min()) - room, float(speed.max()) + room


def place_along_axis(layers: SoundSpeedField, distance: Values) -> tuple[Values, Values]:
    """Places of the scene at distances along the line of a water's stations, in metres."""
    cos, sin = layers.axis
    return cos * distance, sin * distance


def describe_eigenray(ray: DiagramEigenray) -> str:
    """Say what an eigenray is in one line."""
    angle = f"{ray.angle:+.2f}°".replace("-", "−")
    level = f"{ray.level:.1f} dB".replace("-", "−") if math.isfinite(ray.level) else "on a caustic"
    return f"launched at {angle}: {1e3 * ray.travel_time:.3f} ms, slant range {ray.slant_range:.2f} m, {level}"
