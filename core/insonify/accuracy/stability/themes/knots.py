"""Failures of rays at the knots of a profile: an ambiguous layer, a sine of zero, rays without an end."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

from insonify.accuracy.stability.case import Approach, Measured, StabilityTheme, percent
from insonify.accuracy.stability.drawing import common, faint, inked, ours, panel, side_by_side
from insonify.accuracy.stability.themes.water import Values, profile
from insonify.acoustics.paths import ray_paths
from insonify.kernels.refraction.arcs import GRAZING

THEME = StabilityTheme("Knots of a profile", 2)
KINK = profile([0.0, 20.0, 60.0], [1499.0, 1500.0, 1498.0])


@THEME.case(
    "A level ray on a knot",
    "A horizontal ray that starts on a knot of the profile steps to the nearest knot, where it already is.",
    "distance to the end of 400 m after 1000 steps",
    "m",
    failing=Approach("Steps to the nearest knot.", 399.0),
    right=Approach("Enters the layer towards which refraction bends the ray.", 1e-9),
)
def _level() -> Measured:
    covered, depth, sine = 0.0, 20.0, 0.0
    for _ in range(1000):  # straight on within each layer
        node = min(KINK.depth, key=lambda level: abs(level - depth))
        covered += abs(node - depth) / math.tan(math.asin(sine)) if sine else abs(node - depth)
        depth = node
    ends = [float(ray_paths(KINK, 20.0, angle, max_range=400.0).range.max()) for angle in (0.0, 1e-12, -1e-12)]
    path = ray_paths(KINK, 20.0, 0.0, max_range=400.0, ranges=np.linspace(0.0, 400.0, 81))
    return Measured(400.0 - covered, 400.0 - min(ends), panel(
        ours(path.range.values[0], path.depth.values[0], "into the layer to which it bends", linewidth=2.0),
        common([0.0], [20.0], "after 1000 steps to the nearest knot", "o", markersize=7),
        faint(None, 20.0, style=":", linewidth=0.7),
        x="range (m)", y="depth (m)", title="launched horizontally where sound is fastest", down=True,
    ))  # fmt: skip


class _WithMemory:
    """Tracer that first tries the layer of the previous ray."""

    def __init__(self) -> None:
        self.layer = 0

    def level_ray(self, at: float, across: Any) -> Any:
        """Depth of a level ray after a range, by the circle of the layer that contains it."""
        depth, speed = KINK.depth, KINK.sound_speed
        if not depth[self.layer] <= at <= depth[self.layer + 1]:
            self.layer = next(k for k in range(len(depth) - 1) if depth[k] <= at <= depth[k + 1])
        gradient = (speed[self.layer + 1] - speed[self.layer]) / (depth[self.layer + 1] - depth[self.layer])
        return at - 0.5 * gradient / 1500.0 * across**2


@THEME.case(
    "A layer chosen by history",
    "On a knot the ray belongs to two layers, and the layer used last is taken.",
    "difference in depth after 100 m between two histories",
    "m",
    failing=Approach("Starts in the layer of the previous ray.", 0.1),
    right=Approach("Chooses by the ray's own direction and curvature.", 0.0),
)
def _history() -> Measured:
    across, histories = np.linspace(0.0, 100.0, 51), []
    for before in (5.0, 40.0):
        tracer = _WithMemory()
        tracer.level_ray(before, 100.0)
        histories.append(tracer.level_ray(20.0, across))
    options: dict[str, Any] = {"max_range": 100.0, "ranges": [100.0]}
    alone = [ray_paths(KINK, 20.0, [angle], **options).depth.values[0, 0] for angle in (0.0, 2.0, -2.0)]
    up, down = ([2.0, 0.0, -2.0], [1, 0, 2]), ([-2.0, 0.0, 2.0], [1, 2, 0])
    others = [ray_paths(KINK, 20.0, angles, **options).depth.values[order, 0] for angles, order in (up, down)]
    own = max(float(np.abs(np.array(alone) - other).max()) for other in others)
    paths = ray_paths(KINK, 20.0, [2.0, 0.0], max_range=100.0, ranges=across)
    return Measured(abs(float(histories[0][-1] - histories[1][-1])), own, panel(
        common(across, histories[0], "layer used last, after one from 5 m"),
        common(across, histories[1], "layer used last, after one from 40 m", "--"),
        ours(paths.range.values[1], paths.depth.values[1], "this program, after any ray", linewidth=3.0, alpha=0.6),
        x="range (m)", y="depth (m)", title="a horizontal ray from the knot, traced after others", down=True,
    ))  # fmt: skip


def _turning_angles() -> tuple[Values, Values]:
    """Speeds at the second node of profiles, and the angles at which rays from the first turn just there."""
    faster = 1500.0 + np.linspace(0.3, 30.0, 100)
    return faster, np.arccos(1500.0 / faster)


@cache
def _at_the_vertex() -> tuple[int, int]:
    """Count the rays that have no number somewhere, and those with an unreliable tube that are not flagged."""
    lost = unflagged = 0
    for speed, angle in zip(*_turning_angles()):
        water = profile([0.0, 20.0, 40.0], [1500.0, speed, speed + 40.0])
        paths = ray_paths(water, 0.0, math.degrees(angle), max_range=600.0)
        there = np.isfinite(paths.range.values[0])
        numbers = [paths[name].values[0][there] for name in ("depth", "time", "tube")]
        lost += not np.isfinite(numbers).all()
        wild = bool((np.abs(numbers[2]) > 1e5).any())
        unflagged += wild and not bool(paths.capped.values[0][there].any())
    return lost, unflagged


@THEME.case(
    "A ray that turns at a knot",
    "At the turning point the sine is the root of a rounding error, as often negative as positive.",
    "rays without a number",
    "%",
    failing=Approach("Takes √(s₀² − ξ² g Δz (c₀ + c₁)) at the knot.", 10.0),
    right=Approach("Crosses the knot or turns before it, depending on the sign.", 0.0),
)
def _vertex() -> Measured:
    faster, angles = _turning_angles()
    snell = np.cos(angles) / 1500.0
    radicand = np.sin(angles) ** 2 - snell**2 * (faster - 1500.0) * (faster + 1500.0)
    rooted, rays = radicand >= 0.0, []
    for speed, angle in list(zip(faster, angles))[9::30]:
        water = profile([0.0, 20.0, 40.0], [1500.0, speed, speed + 40.0])
        path = ray_paths(water, 0.0, math.degrees(angle), max_range=600.0, ranges=np.linspace(0.0, 600.0, 121))
        rays.append(ours(path.range.values[0], path.depth.values[0], linewidth=1.2))
    return Measured(percent(~rooted), float(_at_the_vertex()[0]), side_by_side(
        panel(
            faint(faster[rooted], radicand[rooted], "has a root", "."),
            common(faster[~rooted], radicand[~rooted], "has none", "."),
            x="speed at the knot (m/s)", y="radicand", title="0 except for rounding", place=121,
            ylim=(-1.4e-16, 2.2e-16), legend="upper left",
        ),
        panel(
            *rays, inked(None, 20.0, style=":", linewidth=0.7), x="range (m)", y="depth (m)",
            title="this program: turns at the knot or continues", place=122, ylim=(24.0, 0.0),
        ),
    ))  # fmt: skip


@THEME.case(
    "A kink met at grazing",
    "The ray tube changes by the jump of the gradient over the sine of the ray's angle, which can be 0.",
    "rays whose tube diverges without a flag",
    "%",
    failing=Approach("Takes p − qξ²Δg/|s| without a bound.", 50.0),
    right=Approach("Limits the angle and flags the ray.", 0.0),
)
def _kick() -> Measured:
    def change(sine: Values) -> Values:
        """Change of the tube in m/rad, 400 m beyond a jump of the gradient of 2 1/s: q ξ² Δg / |s|."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.divide(400.0 * 2.0 / 1500.0**2, np.abs(sine))) * 1500.0 * 400.0

    turning = np.concatenate([np.zeros(20), np.logspace(-16, -9, 80)])  # rays that turn within rounding of a knot
    sines = np.logspace(-16, 0, 65)
    return Measured(percent(change(turning) > 1e5), float(_at_the_vertex()[1]), panel(
        common(sines, change(sines), "q ξ² Δg / |s|, 400 m farther on"),
        ours(sines, change(np.maximum(sines, GRAZING)), "with the angle limited and flagged", linewidth=2.2),
        x="sine of the angle at the knot", y="change of the tube (m/rad)", log="xy",
    ))  # fmt: skip


DUCT = profile([0.0, 40.0, 120.0], [1530.0, 1490.0, 1530.0])


def _leaves_the_duct(depth: float, angle: float) -> bool:
    """Whether a ray meets the floor or the surface within 20,000 steps of 1 m."""
    sine = math.sin(math.radians(angle))
    for _ in range(20_000):
        speed = float(np.interp(depth, DUCT.depth, DUCT.sound_speed))
        gradient = -1.0 if depth < 40.0 else 0.5
        sine -= gradient / speed * (1.0 - sine * sine)
        depth += sine
        if not 0.0 < depth < 120.0:
            return True
    return False


@THEME.case(
    "A ray in a duct",
    "A trapped ray reaches neither the surface nor the bed.",
    "rays that never end",
    "of 5",
    failing=Approach("Traces until the ray meets one of them.", 3.0),
    right=Approach("Ends rays at a maximum range and after a maximum number of layers.", 0.0),
)
def _duct() -> Measured:
    angles = (-6.0, -3.0, 0.5, 3.0, 6.0)
    ends = ray_paths(DUCT, 40.0, angles, max_range=20_000.0, bottom=120.0).end.values
    across = np.linspace(0.0, 10_000.0, 1001)
    path = ray_paths(DUCT, 40.0, 6.0, max_range=10_000.0, bottom=120.0, ranges=across)
    x, depth = path.range.values[0] / 1000.0, path.depth.values[0]
    within = x <= 5.0
    endless = float(sum(not _leaves_the_duct(40.0, angle) for angle in angles))
    return Measured(endless, float(sum(end not in ("range", "trapped") for end in ends)), panel(
        common(x[~within], depth[~within], "without an end", linewidth=1.2),
        ours(x[within], depth[within], "to the requested range", linewidth=1.6),
        ours(x[within][-1], depth[within][-1], style="o", markersize=5),
        x="range (km)", y="depth (m)", title="trapped ray: meets neither the surface nor the bed",
        ylim=(120.0, 0.0), legend="lower left",
    ))  # fmt: skip
