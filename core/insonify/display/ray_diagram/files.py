"""Files of ray diagrams: a picture, or the points of the rays as a table."""

from __future__ import annotations

import csv
from pathlib import Path

from insonify.display.ray_diagram.diagram import RayDiagram
from insonify.display.ray_diagram.figure import draw_ray_diagram
from insonify.io.atomic import replacing
from insonify.scene import SceneError

COLUMNS = ("kind", "number", "launch_angle", "range", "depth", "time")
SUFFIXES = (".png", ".csv")


def write_ray_diagram(path: str | Path, diagram: RayDiagram) -> None:
    """Write a diagram as a picture (.png) or the points of its rays as a table (.csv)."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise SceneError(f"output: {Path(path).name!r} names no format that is known; end it in .png or .csv")
    with replacing(path) as partial:
        if suffix == ".csv":
            _write_table(partial, diagram)
        else:
            draw_ray_diagram(diagram).savefig(partial, format="png", dpi=150)


def _write_table(path: Path, diagram: RayDiagram) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(COLUMNS)
        for kind, rays in (("ray", diagram.rays), ("eigenray", diagram.eigenrays)):
            for number, ray in enumerate(rays):
                for point in zip(ray.range, ray.depth, ray.time):
                    table.writerow([kind, number, f"{ray.angle:.9g}", *(f"{value:.9g}" for value in point)])
