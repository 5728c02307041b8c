"""Picture of a ray diagram: the sound speed profile on the left, the refracted rays on the right; and its files."""

import csv
import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from insonify.display.ray_diagram.diagram import (
    WATER,
    RayDiagram,
    compute_speed_limits,
    describe_eigenray,
    place_along_axis,
)
from insonify.display.style import AMBER, FAINT, GREEN, INK, PINK, PURPLE, RED, label_axes, make_figure, style_axes
from insonify.io.atomic import replacing
from insonify.scene import SceneError

RAY, BED, BED_LINE, SHADE = "#2b5c8a", "#cbb693", "#8a7450", "#141c2b"
EIGENRAYS = (RED, AMBER, PURPLE, GREEN)
CAUSTIC = PINK
WATER_MAP = LinearSegmentedColormap.from_list("water", [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in WATER])
LEFT, RIGHT, BOTTOM, TOP = (0.065, 0.155), (0.262, 0.683), 0.165, 0.855  # shares of the figure
ROW = 0.034  # share of the figure that a row of the legend takes
DEPTH_MARGIN = 0.075  # share of the depth, above the surface and below the bed
LEAST_SHADOW = 1e-3  # least share of the water in shadow that the legend names
LABELS = 0.036  # share of the axes' width and height that a label of a ray needs
TABLE_COLUMNS = ("kind", "number", "launch_angle", "range", "depth", "time")
SUFFIXES = (".png", ".csv")


def draw_ray_diagram(diagram: RayDiagram) -> Figure:
    """Draw the sound speed profile and the rays over one scale of depth."""
    figure = make_figure(13.0, 7.3)
    entries = _entries(diagram)
    height = TOP - ROW * math.ceil(len(entries) / 2.0) - BOTTOM
    left, right = (figure.add_axes((begin, BOTTOM, width, height)) for begin, width in (LEFT, RIGHT))
    _profile(left, diagram)
    _water(right, diagram)
    for path in diagram.rays:
        right.plot(path.range, path.depth, color=RAY, linewidth=0.9, alpha=0.75, zorder=3)
    _labels(right, diagram)
    if diagram.caustics.size:
        right.scatter(diagram.caustics[:, 0], diagram.caustics[:, 1], s=3.0, color=CAUSTIC, linewidths=0, zorder=4)
    _eigenrays(right, diagram)
    right.plot(0.0, diagram.source_depth, "o", color=INK, markersize=9, clip_on=False, zorder=7)
    _scales(left, right, diagram)
    if entries:
        figure.legend(
            *zip(*entries), loc="upper left", bbox_to_anchor=(LEFT[0], TOP + 0.03), ncols=2, frameon=False, fontsize=10,
            labelcolor=INK, borderaxespad=0.0, borderpad=0.0, handlelength=1.6, columnspacing=3.0,
        )  # fmt: skip
    _write_headings(figure, diagram)
    return figure


def _profile(axes: Any, diagram: RayDiagram) -> None:
    """Draw speed against depth; of a section one line for each station."""
    layers = diagram.layers
    low, high = compute_speed_limits(diagram)
    axes.imshow(
        np.linspace(0.0, 1.0, 256)[None], extent=(low, high, diagram.bottom, 0.0), aspect="auto", cmap=WATER_MAP,
        zorder=0,
    )  # fmt: skip
    depth = np.unique(np.clip(np.concatenate([[0.0], layers.depth, [diagram.bottom]]), 0.0, diagram.bottom))
    for number, profile in enumerate(layers.speed):
        share = number / max(len(layers.speed) - 1, 1)
        axes.plot(np.interp(depth, layers.depth, profile), depth, color=INK, linewidth=2.2 - 1.2 * share, zorder=3)
        if len(layers.speed) > 1:
            axes.annotate(
                f"{layers.distance[number]:g} m", (float(np.interp(0.0, layers.depth, profile)), 0.0),
                xytext=(0, 4 + 9 * (number % 2)), textcoords="offset points", ha="center", fontsize=8, color=FAINT,
            )  # fmt: skip
    axes.axhline(diagram.source_depth, color=FAINT, linewidth=0.8, linestyle=(0, (4, 3)), zorder=2)
    axes.axhspan(diagram.bottom, 2.0 * diagram.bottom, color=BED, linewidth=0, zorder=1)
    axes.set_xlim(low, high)
    label_axes(axes, "speed of sound (m/s)", "depth (m)", size=10.5, pad=6)
    axes.locator_params(axis="x", nbins=4)


def _water(axes: Any, diagram: RayDiagram) -> None:
    """Draw the water by its speed, the surface, the bed and the shadow zones."""
    low, high = compute_speed_limits(diagram)
    x, depth = np.linspace(0.0, diagram.reach, 200), np.linspace(0.0, diagram.bottom, 300)
    speed = diagram.layers.speed_at(*place_along_axis(diagram.layers, x[None, :]), depth[:, None])
    extent = (0.0, diagram.reach, diagram.bottom, 0.0)
    axes.imshow(
        np.broadcast_to(speed, (300, 200)), extent=extent, aspect="auto", cmap=WATER_MAP, norm=Normalize(low, high),
        interpolation="bilinear", zorder=0,
    )  # fmt: skip
    rows, columns = diagram.shadow.shape
    shade = np.zeros((rows, columns, 4))
    shade[..., :3] = [int(SHADE[k : k + 2], 16) / 255.0 for k in (1, 3, 5)]
    shade[..., 3] = 0.52 * diagram.shadow
    axes.imshow(shade, extent=extent, aspect="auto", interpolation="bilinear", zorder=1)
    axes.axhspan(diagram.bottom, 2.0 * diagram.bottom, color=BED, linewidth=0, zorder=2)
    axes.axhline(diagram.bottom, color=BED_LINE, linewidth=1.4, zorder=2)
    axes.axhline(0.0, color=RAY, linewidth=1.2, zorder=2)
    for begin, end in diagram.dark:
        axes.plot([begin, end], 2 * [diagram.bottom], color=SHADE, linewidth=4.0, solid_capstyle="butt", zorder=4)


def _labels(axes: Any, diagram: RayDiagram) -> None:
    """Write launch angles where rays end: below the bed, above the surface, at the edge; the roundest first."""
    taken: list[tuple[float, float]] = []
    for path in sorted(diagram.rays, key=lambda path: (_roundness(path.angle), abs(path.angle))):
        x, z = path.range[-1] / diagram.reach, path.depth[-1] / diagram.bottom
        if any(abs(x - other) < LABELS and abs(z - height) < LABELS for other, height in taken):
            continue
        taken.append((x, z))
        at_edge = x > 1.0 - 1e-6
        offset, align = ((5, 0), ("left", "center")) if at_edge else ((0, 4), ("center", "bottom"))
        if not at_edge and z > 0.5:
            offset, align = (0, -4), ("center", "top")
        axes.annotate(
            f"{path.angle:g}°".replace("-", "−"), (path.range[-1], path.depth[-1]), xytext=offset, ha=align[0],
            va=align[1], textcoords="offset points", fontsize=8, color=RAY, zorder=6, annotation_clip=False,
        )  # fmt: skip


def _roundness(angle: float) -> int:
    """Rank of an angle by its roundness, 0 for multiples of ten."""
    return next((k for k, unit in enumerate((10.0, 5.0, 2.0, 1.0, 0.5)) if abs(angle / unit % 1.0) < 1e-9), 5)


def _eigenrays(axes: Any, diagram: RayDiagram) -> None:
    for number, path in enumerate(diagram.eigenrays):
        axes.plot(
            path.range, path.depth, color=EIGENRAYS[number % len(EIGENRAYS)], linewidth=2.6, zorder=5,
            path_effects=[withStroke(linewidth=4.5, foreground="white")],
        )  # fmt: skip
    if diagram.target is not None:
        axes.plot(*diagram.target, "D", color="white", markeredgecolor=INK, markeredgewidth=1.8, markersize=8, zorder=7)


def _scales(left: Any, right: Any, diagram: RayDiagram) -> None:
    margin = DEPTH_MARGIN * diagram.bottom
    right.set_xlim(0.0, diagram.reach)
    label_axes(right, "range (m)", size=10.5, pad=6)
    right.tick_params(labelleft=False)
    for axes in (left, right):
        axes.set_ylim(diagram.bottom + margin, -margin)
        style_axes(axes, 9.5)


def _entries(diagram: RayDiagram) -> list[tuple[Any, str]]:
    """List the marks and names of the legend: everything drawn besides the rays."""
    entries: list[tuple[Any, str]] = []
    if diagram.shadow.mean() > LEAST_SHADOW:
        entries.append((Patch(color=SHADE, alpha=0.52, linewidth=0), "shadow zone: no direct ray"))
    if diagram.dark.size:
        entries.append((Line2D([], [], color=SHADE, linewidth=4.0), "bed out of reach of sound"))
    if diagram.caustics.size:
        entries.append((Line2D([], [], marker="o", color=CAUSTIC, linestyle="none", markersize=4), "caustic"))
    for number, path in enumerate(diagram.eigenrays):
        entries.append(
            (Line2D([], [], color=EIGENRAYS[number % len(EIGENRAYS)], linewidth=2.6), describe_eigenray(path))
        )
    return entries


def _write_headings(figure: Figure, diagram: RayDiagram) -> None:
    figure.text(LEFT[0], 0.945, diagram.title or "Untitled", fontsize=17, fontweight="bold", color=INK)
    figure.text(LEFT[0], 0.908, _describe(diagram), fontsize=10.5, color=FAINT)
    figure.text(
        LEFT[0], 0.03, "Rays at equal steps of launch angle, in degrees below the horizontal. Each ends at the bed, at "
        "the surface or at the greatest range. Depth and range have different scales.", fontsize=9, color=FAINT,
    )  # fmt: skip


def _describe(diagram: RayDiagram) -> str:
    """State the place of the sonar, and the ranges of bed that no sound reaches."""
    parts = [f"sonar at {diagram.source_depth:.4g} m, mean bed at {diagram.bottom:.4g} m"]
    for begin, end in diagram.dark:
        where = f"beyond {begin:.1f} m" if end >= diagram.reach else f"from {begin:.1f} to {end:.1f} m"
        parts.append(f"no sound on the bed {where}")
    if diagram.target is not None:
        count = len(diagram.eigenrays)
        place = f"{diagram.target[0]:g} m away at {diagram.target[1]:g} m"
        parts.append(f"{count or 'no'} ray{'s' * (count != 1)} to the point {place}")
    return " · ".join(parts)


def write_ray_diagram(path: str | Path, diagram: RayDiagram) -> None:
    """Write a diagram as a picture (.png) or the points of its rays as a table (.csv)."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise SceneError(f"output: {Path(path).name!r} has no known suffix; end the name in .png or .csv")
    with replacing(path) as partial:
        if suffix == ".png":
            draw_ray_diagram(diagram).savefig(partial, format="png", dpi=150)
            return
        with partial.open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file)
            table.writerow(TABLE_COLUMNS)
            for kind, rays in (("ray", diagram.rays), ("eigenray", diagram.eigenrays)):
                for number, ray in enumerate(rays):
                    for point in zip(ray.range, ray.depth, ray.time):
                        table.writerow([kind, number, f"{ray.angle:.9g}", *(f"{value:.9g}" for value in point)])
