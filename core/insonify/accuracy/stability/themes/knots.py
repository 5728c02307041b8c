"""Failures of rays at the knots of a profile: an ambiguous layer, a sine of zero, rays without an end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel
from insonify.accuracy.stability.themes.water import Values, profile
from insonify.acoustics.paths import ray_paths
from insonify.display.style import FAINT, INK
from insonify.kernels.refraction.arcs import GRAZING

KINK = profile([0.0, 20.0, 60.0], [1499.0, 1500.0, 1498.0])


def stepped_range(depth: Sequence[float], at: float, sine: float, steps: int) -> float:
    """Follow a ray from node to node, straight on within each layer, and return how far it has come."""
    x = 0.0
    for _ in range(steps):
        node = min(depth, key=lambda level: abs(level - at))
        x += abs(node - at) / math.tan(math.asin(sine)) if sine else abs(node - at)
        at = node
    return x


def _own_missing() -> float:
    ends = [float(ray_paths(KINK, 20.0, angle, max_range=400.0).range.max()) for angle in (0.0, 1e-12, -1e-12)]
    return 400.0 - min(ends)


class WithMemory:
    """A tracer that looks first into the layer it was in last."""

    def __init__(self) -> None:
        self.layer = 0

    def level_ray(self, at: float, across: float) -> float:
        """Depth of a level ray after a range, by the circle of the layer it is taken to be in."""
        depth, speed = KINK.depth, KINK.sound_speed
        if not depth[self.layer] <= at <= depth[self.layer + 1]:
            self.layer = next(k for k in range(len(depth) - 1) if depth[k] <= at <= depth[k + 1])
        gradient = (speed[self.layer + 1] - speed[self.layer]) / (depth[self.layer + 1] - depth[self.layer])
        return at - 0.5 * gradient / 1500.0 * across**2


def _plain_history() -> float:
    after_shallow, after_deep = WithMemory(), WithMemory()
    after_shallow.level_ray(5.0, 100.0)
    after_deep.level_ray(40.0, 100.0)
    return abs(after_shallow.level_ray(20.0, 100.0) - after_deep.level_ray(20.0, 100.0))


def _own_history() -> float:
    """Greatest difference of depths when rays from a node are traced in other company."""
    options: dict[str, Any] = {"max_range": 100.0, "ranges": [100.0]}
    alone = [ray_paths(KINK, 20.0, [angle], **options).depth.values[0, 0] for angle in (0.0, 2.0, -2.0)]
    up, down = ([2.0, 0.0, -2.0], [1, 0, 2]), ([-2.0, 0.0, 2.0], [1, 2, 0])
    others = [ray_paths(KINK, 20.0, angles, **options).depth.values[order, 0] for angles, order in (up, down)]
    return float(max(np.abs(np.array(alone) - other).max() for other in others))


def turning_angles() -> tuple[Values, Values]:
    """Speeds at the second node of profiles, and the angles at which rays from the first turn just there."""
    faster = 1500.0 + np.linspace(0.3, 30.0, 100)
    return faster, np.arccos(1500.0 / faster)


def _plain_vertex() -> float:
    faster, angles = turning_angles()
    snell = np.cos(angles) / 1500.0
    with np.errstate(invalid="ignore"):
        sines = np.sqrt(np.sin(angles) ** 2 - snell**2 * (faster - 1500.0) * (faster + 1500.0))
    return float(100.0 * np.isnan(sines).mean())


@lru_cache(maxsize=1)
def _at_the_vertex() -> tuple[int, int, int]:
    """Rays that have no number somewhere, whose tube is not to be trusted, and those of them that are not flagged."""
    lost = unsure = unsaid = 0
    for speed, angle in zip(*turning_angles()):
        water = profile([0.0, 20.0, 40.0], [1500.0, speed, speed + 40.0])
        paths = ray_paths(water, 0.0, math.degrees(angle), max_range=600.0)
        there = np.isfinite(paths.range.values[0])
        numbers = [paths[name].values[0][there] for name in ("depth", "time", "tube")]
        lost += not np.isfinite(numbers).all()
        wild = bool((np.abs(numbers[2]) > 1e5).any())
        unsure += wild
        unsaid += wild and not bool(paths.capped.values[0][there].any())
    return lost, unsure, unsaid


def kicked(q: float, sine: float, jump: float) -> float:
    """Change of a tube's p where the gradient jumps, q ξ² Δg / |s|."""
    with np.errstate(divide="ignore"):
        return float(np.divide(q * jump / 1500.0**2, abs(sine)))


def _plain_kicks() -> float:
    """Percentage of rays that turn within rounding of a knot, and whose tube is then wider than 10⁵ m per radian."""
    sines = np.concatenate([np.zeros(20), np.logspace(-16, -9, 80)])
    return float(np.mean([abs(kicked(400.0, s, 2.0)) * 1500.0 * 400.0 > 1e5 for s in sines]) * 100.0)


DUCT = profile([0.0, 40.0, 120.0], [1530.0, 1490.0, 1530.0])
PATIENCE = 20_000


def plain_end(depth: float, angle: float) -> bool:
    """Whether a ray in a duct ever comes to its floor or its surface, by small steps and without a limit but ours."""
    step, at, sine = 1.0, depth, math.sin(math.radians(angle))
    for _ in range(PATIENCE):
        speed = float(np.interp(at, DUCT.depth, DUCT.sound_speed))
        gradient = -1.0 if at < 40.0 else 0.5
        sine -= gradient / speed * (1.0 - sine * sine) * step
        at += sine * step
        if not 0.0 < at < 120.0:
            return True
    return False


ANGLES = (-6.0, -3.0, 0.5, 3.0, 6.0)


def _own_endless() -> float:
    ends = ray_paths(DUCT, 40.0, ANGLES, max_range=20_000.0, bottom=120.0).end.values
    return float(sum(end not in ("range", "trapped") for end in ends))


def _draw_level(figure: Figure) -> None:
    axes = add_panel(figure, x="range (m)", y="depth (m)", title="launched horizontally where sound is fastest")
    path = ray_paths(KINK, 20.0, 0.0, max_range=400.0, ranges=np.linspace(0.0, 400.0, 81))
    axes.plot(
        path.range.values[0], path.depth.values[0], color=RIGHT, linewidth=2.0, label="into the layer to which it bends"
    )
    axes.plot([0.0], [20.0], "o", color=WRONG, markersize=7, label="after 1000 steps to the nearest knot")
    axes.axhline(20.0, color=FAINT, linewidth=0.7, linestyle=":")
    axes.invert_yaxis()
    add_legend(axes)


def _draw_history(figure: Figure) -> None:
    axes = add_panel(figure, x="range (m)", y="depth (m)", title="a horizontal ray from the knot, traced after others")
    across = np.linspace(0.0, 100.0, 51)
    for before, style, words in ((5.0, "-", "after one from 5 m"), (40.0, "--", "after one from 40 m")):
        tracer = WithMemory()
        tracer.level_ray(before, 100.0)
        depths = [tracer.level_ray(20.0, x) for x in across]
        axes.plot(across, depths, style, color=WRONG, label=f"layer used last, {words}")
    paths = ray_paths(KINK, 20.0, [2.0, 0.0], max_range=100.0, ranges=across)
    axes.plot(
        paths.range.values[1],
        paths.depth.values[1],
        color=RIGHT,
        linewidth=3.0,
        alpha=0.6,
        label="this program, after any ray",
    )
    axes.invert_yaxis()
    add_legend(axes)


def _draw_vertex(figure: Figure) -> None:
    faster, angles = turning_angles()
    snell = np.cos(angles) / 1500.0
    left = np.sin(angles) ** 2 - snell**2 * (faster - 1500.0) * (faster + 1500.0)
    axes = add_panel(figure, 121, x="speed at the knot (m/s)", y="radicand", title="0 except for rounding")
    axes.plot(faster[left >= 0.0], left[left >= 0.0], ".", color=FAINT, label="has a root")
    axes.plot(faster[left < 0.0], left[left < 0.0], ".", color=WRONG, label="has none")
    axes.set_ylim(-1.4e-16, 2.2e-16)
    add_legend(axes, "upper left")
    axes = add_panel(figure, 122, x="range (m)", y="depth (m)", title="this program: turns at the knot or continues")
    for speed, angle in list(zip(faster, angles))[9::30]:
        water = profile([0.0, 20.0, 40.0], [1500.0, speed, speed + 40.0])
        path = ray_paths(water, 0.0, math.degrees(angle), max_range=600.0, ranges=np.linspace(0.0, 600.0, 121))
        axes.plot(path.range.values[0], path.depth.values[0], color=RIGHT, linewidth=1.2)
    axes.axhline(20.0, color=INK, linewidth=0.7, linestyle=":")
    axes.set_ylim(24.0, 0.0)


def _draw_kick(figure: Figure) -> None:
    axes = add_panel(figure, x="sine of the angle at the knot", y="change of the tube (m/rad)")
    sines = np.logspace(-16, 0, 65)
    axes.set(xscale="log", yscale="log")
    plain = [abs(kicked(400.0, s, 2.0)) * 1500.0 * 400.0 for s in sines]
    own = [abs(kicked(400.0, max(s, GRAZING), 2.0)) * 1500.0 * 400.0 for s in sines]
    axes.plot(sines, plain, color=WRONG, label="q ξ² Δg / |s|, 400 m farther on")
    axes.plot(sines, own, color=RIGHT, linewidth=2.2, label="with the angle limited and flagged")
    add_legend(axes)


def _draw_duct(figure: Figure) -> None:
    axes = add_panel(figure, x="range (km)", y="depth (m)", title="trapped ray: meets neither the surface nor the bed")
    across = np.linspace(0.0, 10_000.0, 1001)
    path = ray_paths(DUCT, 40.0, 6.0, max_range=10_000.0, bottom=120.0, ranges=across)
    x, depth = path.range.values[0] / 1000.0, path.depth.values[0]
    asked = x <= 5.0
    axes.plot(x[~asked], depth[~asked], color=WRONG, linewidth=1.2, label="without an end")
    axes.plot(x[asked], depth[asked], color=RIGHT, linewidth=1.6, label="to the requested range")
    axes.plot(x[asked][-1], depth[asked][-1], "o", color=RIGHT, markersize=5)
    axes.set_ylim(120.0, 0.0)
    add_legend(axes, "lower left")


THEME = StabilityTheme("Knots of a profile", 2, (
    StabilityCase(
        "A level ray on a knot",
        "A horizontal ray that starts on a knot of the profile steps to the nearest knot, where it already is.",
        "distance to the end of 400 m after 1000 steps", "m",
        Approach("Steps to the nearest knot.", lambda: 400.0 - stepped_range(KINK.depth, 20.0, 0.0, 1000), 399.0),
        Approach("Enters the layer towards which refraction bends the ray.", _own_missing, 1e-9),
        _draw_level,
    ),
    StabilityCase(
        "A layer chosen by history",
        "On a knot the ray belongs to two layers, and the layer used last is taken.",
        "difference in depth after 100 m between two histories", "m",
        Approach("Starts in the layer of the previous ray.", _plain_history, 0.1),
        Approach("Chooses by the ray's own direction and curvature.", _own_history, 0.0),
        _draw_history,
    ),
    StabilityCase(
        "A ray that turns at a knot",
        "At the turning point the sine is the root of a rounding error, as often negative as positive.",
        "rays without a number", "%",
        Approach("Takes √(s₀² − ξ² g Δz (c₀ + c₁)) at the knot.", _plain_vertex, 10.0),
        Approach("Crosses the knot or turns before it, depending on the sign.",
                 lambda: float(_at_the_vertex()[0]), 0.0),
        _draw_vertex,
    ),
    StabilityCase(
        "A kink met at grazing",
        "The ray tube changes by the jump of the gradient over the sine of the ray's angle, which can be 0.",
        "rays whose tube diverges without a flag", "%",
        Approach("Takes p − qξ²Δg/|s| without a bound.", _plain_kicks, 50.0),
        Approach("Limits the angle and flags the ray.", lambda: float(_at_the_vertex()[2]), 0.0),
        _draw_kick,
    ),
    StabilityCase(
        "A ray in a duct",
        "A trapped ray reaches neither the surface nor the bed.",
        "rays that never end", "of 5",
        Approach("Traces until the ray meets one of them.",
                 lambda: float(sum(not plain_end(40.0, a) for a in ANGLES)),
            3.0),
        Approach("Ends rays at a maximum range and after a maximum number of layers.", _own_endless, 0.0),
        _draw_duct,
    ),
))  # fmt: skip
