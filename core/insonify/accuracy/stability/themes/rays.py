"""Failures of refracted rays between two points: false rays, lost rays, caustics, steps past a grazing point."""

from __future__ import annotations

import math
from decimal import Decimal, localcontext
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel
from insonify.accuracy.stability.themes.water import profile
from insonify.acoustics.caustics import airy_pressure
from insonify.acoustics.paths import eigenrays, ray_paths, shadow_zones
from insonify.display.style import FAINT, INK
from insonify.scene import load_scene

Values = NDArray[np.float64]
# Sound slows down with depth, so that the bed is insonified up to the ray that grazes the surface.
DOWNWARD, FISH, BED = profile([0.0, 40.0], [1500.0, 1496.0]), 10.0, 40.0
BEYOND = (1700.0, 1800.0, 1900.0, 2000.0, 2200.0)


def height_missed(angle: float, across: float) -> float:
    """By how much a ray, an arc of a circle, passes over a point of the bed; over it too if the surface ends it."""
    surface, slow = DOWNWARD.sound_speed[0], -0.1
    launch = math.radians(angle)
    radius = (surface + slow * FISH) / (-slow * math.cos(launch))
    top, middle = -radius * math.sin(launch), -surface / slow
    if 0.0 < top < across and middle - radius < 0.0:
        return BED
    return BED - (middle - math.sqrt(radius**2 - (across - top) ** 2))


def bisected(across: float) -> float:
    """Launch angle to a point of the bed, between one that falls short and one that goes over."""
    low, high = 15.0, -5.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        if height_missed(middle, across) < 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _found_in_shadow() -> float:
    return float(sum(math.isfinite(bisected(across)) for across in BEYOND))


def _own_in_shadow() -> float:
    return float(sum(eigenrays(DOWNWARD, FISH, across, BED, bottom=BED).sizes["eigenray"] > 0 for across in BEYOND))


def _draw_shadow(figure: Figure) -> None:
    axes = add_panel(figure, x="range (m)", y="depth (m)")
    begins = float(shadow_zones(DOWNWARD, FISH, BED, max_range=2500.0, bottom=BED)[0, 0])
    angles = np.concatenate([-2.09 + np.linspace(0.0, 1.0, 8) ** 2, np.linspace(-0.5, 4.0, 10)])
    paths = ray_paths(DOWNWARD, FISH, angles, max_range=2500.0, bottom=BED)
    axes.plot(paths.range.values.T, paths.depth.values.T, color=FAINT, linewidth=0.6)
    wrong = ray_paths(DOWNWARD, FISH, bisected(2000.0), max_range=2500.0, bottom=BED)
    axes.plot(wrong.range.values[0], wrong.depth.values[0], color=WRONG, linewidth=1.6, label="result of the bisection")
    axes.plot([2000.0], [BED], "x", color=INK, markersize=7, label="target point")
    axes.plot([begins, 2500.0], [BED, BED], color=RIGHT, linewidth=4.0, label=f"shadow from {begins:.1f} m on: no ray")
    axes.set(xlim=(0.0, 2500.0), ylim=(BED + 2.0, 0.0))
    add_legend(axes, "upper right")


CHANNEL = profile([0.0, 60.0, 200.0], [1530.0, 1490.0, 1530.0])
FROM, TO, ACROSS = 50.0, 70.0, 4000.0


def crossings() -> int:
    """Count the rays to a point by a fan so dense that the depth it comes to changes its side once a ray."""
    fan = np.linspace(-12.5, 12.5, 20_001)
    depths = ray_paths(CHANNEL, FROM, fan, max_range=ACROSS, bottom=200.0, ranges=[ACROSS])
    at = np.where(depths.range.values[:, 0] == ACROSS, depths.depth.values[:, 0], np.nan)
    sides = np.sign(at - TO)
    return int((sides[:-1] * sides[1:] < 0.0).sum())


@lru_cache(maxsize=1)
def _lost() -> tuple[float, float]:
    """Percentage of eigenrays lost by a search from the straight line, and by `find_eigenrays`."""
    exact = crossings()
    found = eigenrays(CHANNEL, FROM, ACROSS, TO, bottom=200.0).sizes["eigenray"]
    return 100.0 * (exact - newton()) / exact, 100.0 * abs(exact - found) / exact


def newton() -> int:
    """Improve the straight line's angle until it comes to the point; return how many rays that finds."""
    angle = math.degrees(math.atan2(TO - FROM, ACROSS))
    for _ in range(50):
        near, next_to = (
            float(ray_paths(CHANNEL, FROM, a, max_range=ACROSS, ranges=[ACROSS]).depth.values[0, 0]) - TO
            for a in (angle, angle + 1e-4)
        )
        if abs(near) < 1e-6:
            return 1
        angle = min(max(angle - near * 1e-4 / (next_to - near), -12.0), 12.0)
    return 0


def _draw_eigenrays(figure: Figure) -> None:
    found = eigenrays(CHANNEL, FROM, ACROSS, TO, bottom=200.0)
    axes = add_panel(figure, x="range (m)", y="depth (m)", title=f"{found.sizes['eigenray']} rays join the two points")
    paths = ray_paths(CHANNEL, FROM, found.angle.values, max_range=ACROSS, bottom=200.0)
    axes.plot(paths.range.values.T, paths.depth.values.T, color=RIGHT, linewidth=0.7)
    axes.plot([0.0, ACROSS], [FROM, TO], "o", color=INK, markersize=4)
    axes.set_ylim(200.0, 0.0)


UPWARD, HIGH, GRADIENT = load_scene("breaks-grazing").water, 20.0, 0.05
GRAZING = math.acos(1500.0 / 1501.0)


def _limit() -> float:
    """Ground range beyond which the bed is unseen, √(2Rh − h²) with R = c at the bed over g."""
    radius = 1501.0 / GRADIENT
    return math.sqrt(2.0 * radius * HIGH - HIGH**2)


@lru_cache(maxsize=1)
def _stepped_hits() -> tuple[Values, Values]:
    """Angles below the one that touches, and ranges at which rays integrated with adaptive steps are seen to hit."""
    from scipy.integrate import solve_ivp

    def bend(_: float, ray: Values) -> tuple[float, float, float]:
        return math.cos(ray[2]), math.sin(ray[2]), -GRADIENT / (1500.0 + GRADIENT * (ray[1] - 10.0)) * math.cos(ray[2])

    def touch(_: float, ray: Values) -> float:
        return float(30.0 - ray[1])

    touch.terminal = True  # type: ignore[attr-defined]
    angles, hits = np.geomspace(1e-9, 0.1, 24), []
    for above in angles:
        ray = solve_ivp(bend, (0.0, 3000.0), (0.0, 10.0, GRAZING + above), events=touch)
        hits.append(float(ray.y_events[0][0][0]) if ray.t_events[0].size else math.nan)
    return angles, np.array(hits)


def stepped_limit() -> float:
    """Farthest range at which integrated rays are seen to hit the bed."""
    return float(np.nanmax(_stepped_hits()[1]))


def _own_limit() -> float:
    return float(shadow_zones(UPWARD, 10.0, 30.0, max_range=3000.0, bottom=30.0)[0, 0])


DEEP = profile([0.0, 8000.0], [1500.0, 1628.0])
CARRIER = 400e3


def exact_time(across: float, depth: tuple[float, float]) -> Decimal:
    """Time between two points in one gradient, acosh(1 + g²(x² + Δz²)/(2 c₁ c₂))/g, with 50 digits."""
    with localcontext() as context:
        context.prec = 50
        g, c = Decimal(128) / 8000, [1500 + Decimal(128) / 8000 * Decimal(z) for z in depth]
        value = 1 + g * g * (Decimal(across) ** 2 + Decimal(depth[1] - depth[0]) ** 2) / (2 * c[0] * c[1])
        return (value + (value * value - 1).sqrt()).ln() / g


def single_time(across: float, depth: tuple[float, float]) -> float:
    """Time between two points in one gradient as `exact_time`, in float32."""
    g = np.float32(0.016)
    c = [np.float32(1500.0) + g * np.float32(z) for z in depth]
    square = np.float32(across) ** 2 + np.float32(depth[1] - depth[0]) ** 2
    return float(np.arccosh(np.float32(1.0) + g * g * square / (np.float32(2.0) * c[0] * c[1])) / g)


def _phase_off(own: bool) -> float:
    """Worst error of the phase of a carrier, in turns, over echoes from 1 to 5 km."""
    depth, worst = (4000.0, 4100.0), 0.0
    for across in (1000.0, 2000.0, 3000.0, 4000.0, 5000.0):
        time = float(eigenrays(DEEP, depth[0], across, depth[1]).time[0]) if own else single_time(across, depth)
        worst = max(worst, abs(float(Decimal(time) - exact_time(across, depth))) * CARRIER)
    return worst


SPACE = np.union1d(np.geomspace(1e-6, 0.1, 100), np.linspace(0.1, 6.0, 300))  # ρ, by which points lie off the caustic


@lru_cache(maxsize=1)
def _across_a_caustic() -> tuple[Values, Values, Values]:
    """Pressure beside a caustic as two rays add up, as the uniform form has it, and ∫exp i(s³/3 − ρs) ds itself."""
    # The integral's two points of stationary phase are the rays; along a path turned by 30° nothing oscillates.
    along, turn = np.linspace(0.0, 12.0, 6001), np.exp(1j * math.pi / 6.0)
    waves = np.exp(-(along**3) / 3.0 - 1j * SPACE[:, None] * along * turn) * turn
    exact = 2.0 * np.abs(np.trapezoid(waves, along, axis=1).real)
    amplitude, late = math.sqrt(math.pi) * SPACE**-0.25, 4.0 / 3.0 * SPACE**1.5
    added = np.abs(amplitude + amplitude * np.exp(1j * (late - 0.5 * math.pi)))
    own = airy_pressure(CARRIER, (0.0, late / (2.0 * math.pi * CARRIER)), (amplitude, amplitude))
    return added, own, exact


def _too_loud(pressure: Values) -> float:
    """Worst error of the level where sound is within 20 dB of its loudest."""
    exact = _across_a_caustic()[2]
    loud = exact > 0.1 * exact.max()
    return float(np.abs(20.0 * np.log10(pressure[loud] / exact[loud])).max())


def _draw_caustic(figure: Figure) -> None:
    axes = add_panel(figure, x="distance from the caustic (argument ρ of the Airy function)", y="pressure")
    added, own, exact = _across_a_caustic()
    axes.plot(SPACE, added, color=WRONG, label="sum of two rays")
    axes.plot(SPACE, own, color=RIGHT, linewidth=2.2, label="uniform approximation")
    axes.plot(SPACE, exact, "--", color=INK, linewidth=0.9, label="exact integral")
    axes.set(xlim=(-0.05, 6.0), ylim=(0.0, 12.0))
    add_legend(axes)


def _draw_touch(figure: Figure) -> None:
    above, hits = _stepped_hits()
    axes = add_panel(figure, x="launch angle below the grazing ray (rad)", y="range of the hit (m)")
    axes.set_xscale("log")
    found = np.isfinite(hits)
    paths = ray_paths(UPWARD, 10.0, np.degrees(GRAZING + above), max_range=3000.0, bottom=30.0)
    exact = np.where(paths.hit.values, paths.range.values, 0.0).max(axis=1)
    axes.plot(above, exact, color=RIGHT, label="exact arcs")
    axes.plot(above[found], hits[found], "o", color=WRONG, markersize=4, label="adaptive steps")
    axes.plot(above[~found], np.full((~found).sum(), 0.0), "x", color=WRONG, markersize=5, label="missed hit")
    axes.axhline(_limit(), color=INK, linewidth=0.8, linestyle="--", label="limit, √(2Rh − h²)")
    add_legend(axes, "center left")


def _draw_time(figure: Figure) -> None:
    depth, across = (4000.0, 4100.0), np.linspace(1000.0, 5000.0, 41)
    exact = [exact_time(x, depth) for x in across]
    own = [float(eigenrays(DEEP, depth[0], x, depth[1]).time[0]) for x in across]
    axes = add_panel(figure, x="range (m)", y="error of the phase (turns)")
    axes.set_yscale("log")
    for times, colour, words in (
        ([single_time(x, depth) for x in across], WRONG, "float32"),
        (own, RIGHT, "float64, without cancellation"),
    ):
        off = [max(abs(float(Decimal(t) - e)) * CARRIER, 1e-12) for t, e in zip(times, exact)]
        axes.plot(across, off, color=colour, label=words)
    axes.axhline(0.5, color=FAINT, linewidth=0.8, linestyle=":")
    axes.text(1000.0, 0.6, "half a turn", fontsize=8, color=FAINT)
    add_legend(axes, "center right")


THEME = StabilityTheme("Refracted rays", 3, (
    StabilityCase(
        "A shadow zone",
        "A bisection between a ray that falls short and one that overshoots converges even where no ray exists.",
        "rays reported where none exists", "of 5",
        Approach("Bisects forty times.", _found_in_shadow, 4.0),
        Approach("Rejects a ray that misses the point.", _own_in_shadow, 0.0),
        _draw_shadow,
    ),
    StabilityCase(
        "Several rays to one point",
        "In a channel many rays join two points, and a search from the straight line finds one at most.",
        "rays lost", "%",
        Approach("Starts Newton's method from the straight line.", lambda: _lost()[0], 50.0),
        Approach("Brackets every branch between the rays that graze a knot.", lambda: _lost()[1], 0.0),
        _draw_eigenrays,
    ),
    StabilityCase(
        "A caustic",
        "Where neighbouring rays cross, the ray tube has no width and the intensity is infinite.",
        "worst error of the level near the caustic", "dB",
        Approach("Sums the two rays, each by the width of its tube.",
                 lambda: _too_loud(_across_a_caustic()[0]), 20.0),
        Approach("Uses the uniform approximation with the Airy function.",
                 lambda: _too_loud(_across_a_caustic()[1]), 0.01),
        _draw_caustic,
    ),
    StabilityCase(
        "Steps past a touch",
        "An integrator with adaptive steps passes the point where a smooth ray touches the bed.",
        "error of the limiting range", "m",
        Approach("Integrates with adaptive steps and an event at the bed.",
                 lambda: abs(stepped_limit() - _limit()), 100.0),
        Approach("Finds the grazing ray among exact arcs.", lambda: abs(_own_limit() - _limit()), 0.05),
        _draw_touch,
        "breaks-grazing",
    ),
    StabilityCase(
        "Travel time in float32",
        "Seven digits of a time of seconds do not resolve the phase of a 400 kHz carrier.",
        "worst error of the phase, from 1 to 5 km", "turns",
        Approach("Takes the closed form in float32.", lambda: _phase_off(own=False), 0.1),
        Approach("Keeps times in float64 in a form without cancellation.", lambda: _phase_off(own=True), 1e-6),
        _draw_time,
    ),
))  # fmt: skip
