"""Draw the library of targets: each mesh as it stands, and the record of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.files import bundled_targets
from insonify.io.meshes import read_mesh

COLUMNS = 6
LAMP = np.array([-0.35, -0.6, 0.72])  # unit vector towards the light
STEEL = np.array([0.86, 0.74, 0.58])
SCENE = {
    "seabed.relief": {"kind": "fractal", "beta": 1.8, "rms": 0.004, "period": 25.6},
    "seabed.spacing": 0.05,
    "seabed.material": "medium_sand",
    "sonar.frequency": 900e3,
    "sonar.beam.width": 0.25,
    "sonar.pulse.duration": 2e-5,
    "sonar.range": 14.0,
    "sonar.bins": 700,
    "sonar.ping_rate": 25.0,
    "track.altitude": 4.0,
    "track.speed": 0.5,
    "track.pings": 300,
    "receiver.speckle": {"kind": "rayleigh", "looks": 3},
}


def target_library(figure: Any) -> None:
    """Every bundled target, and its record beneath."""
    names = list(bundled_targets())
    rows = -(-len(names) // COLUMNS)
    for number, name in enumerate(names):
        row, column = divmod(number, COLUMNS)
        solid = figure.add_subplot(2 * rows, COLUMNS, 2 * row * COLUMNS + column + 1, projection="3d")
        _draw_solid(solid, read_mesh(name))
        solid.set_title(name, fontsize=9, pad=-2)
        record = figure.add_subplot(2 * rows, COLUMNS, (2 * row + 1) * COLUMNS + column + 1)
        record.imshow(_record(name), cmap="copper", vmin=0.0, vmax=3.0, aspect="equal", interpolation="bilinear")
        record.set_axis_off()


def _draw_solid(axes: Any, corners: NDArray[np.float64]) -> None:
    """Draw triangles, (n, 3, 3), with flat shading."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    shade = 0.35 + 0.65 * np.clip(normals @ LAMP, 0.0, 1.0)
    colours = shade[:, None] * STEEL
    axes.add_collection3d(Poly3DCollection(corners, facecolors=colours, edgecolors=colours, linewidths=0.4))
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    half = 0.38 * float((high - low).max())
    for set_limits, middle in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), 0.5 * (low + high)):
        set_limits(middle - half, middle + half)
    axes.set_box_aspect((1, 1, 1))
    axes.view_init(28, -62)
    axes.set_axis_off()


def _record(name: str) -> NDArray[np.float32]:
    """Amplitudes of starboard over a target 7 m abeam, in steps of 2 cm, relative to the bed; pings downwards."""
    import insonify
    from insonify.scene import edit

    target = {"kind": "mesh", "path": name, "position": [3.0, -7.0], "heading": 65.0}
    record = insonify.simulate(edit(insonify.load_scene("default"), {**SCENE, "targets": [target]}))
    amplitude = np.sqrt(record["intensity"].sel(channel="starboard").values)
    level = np.median(amplitude, axis=0)
    near = slice(330, 630)
    return (amplitude / np.maximum(level, 1e-12))[:, near]
