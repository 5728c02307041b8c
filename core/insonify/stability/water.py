"""Failures of layered water: no gradient, no slope, no side to be on, and profiles that are none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.scene import SceneError, edit
from insonify.scene.water import ProfileWater, Water
from insonify.sound.layers import lay_out
from insonify.sound.paths import ray_paths
from insonify.sound.sound_speed import paper, teos10
from insonify.stability.case import Case, Way
from insonify.stability.drawing import FAINT, INK, RIGHT, WRONG, named, panel
from insonify.stability.scenery import level_scene

Values = NDArray[np.float64]
THICK, LAUNCH = 10.0, 5.0  # m, degrees below the horizontal
GRADIENTS = (0.0, *(10.0**k for k in range(-11, 0)))


def profile(depth: Sequence[float], speed: Sequence[float], **options: Any) -> ProfileWater:
    """Declare water of given speeds at given depths."""
    return ProfileWater(depth=tuple(depth), sound_speed=tuple(speed), **options)


def plain_range(c0: float, c1: float, thick: float, angle: float) -> float:
    """Range over which a ray crosses a layer, (s0 − s1)/(gξ)."""
    gradient, snell = (c1 - c0) / thick, math.cos(angle) / c0
    bend = gradient * snell
    sines = math.sin(angle) - math.sqrt(1.0 - (snell * c1) ** 2)
    return sines / bend if bend != 0.0 else math.nan


def exact_range(c0: float, c1: float, thick: float, angle: float) -> float:
    """Likewise, with 60 digits."""
    with localcontext() as context:
        context.prec = 60
        cosine = Decimal(math.cos(angle))
        sine, snell = (1 - cosine**2).sqrt(), cosine / Decimal(c0)
        other = (1 - (snell * Decimal(c1)) ** 2).sqrt()
        # 1/g cancels: (s0² − s1²)/(gξ) = ξ Δz (c0 + c1)
        return float(snell * Decimal(thick) * (Decimal(c0) + Decimal(c1)) / (sine + other))


def _own_range(c0: float, c1: float, thick: float, angle: float) -> float:
    degrees = math.degrees(angle)
    paths = ray_paths(profile([0.0, thick], [c0, c1]), 0.0, degrees, max_range=2000.0, bottom=thick)
    return float(paths.range.values[0, -1])


@lru_cache(maxsize=1)
def _ranges() -> tuple[Values, Values]:
    """Errors of the plain form and of the arcs, by gradient."""
    angle = math.radians(LAUNCH)
    layers = [(1500.0, 1500.0 + gradient * THICK, THICK, angle) for gradient in GRADIENTS]
    exact = np.array([exact_range(*layer) for layer in layers])
    plain, own = (np.array([way(*layer) for layer in layers]) for way in (plain_range, _own_range))
    return np.abs(plain - exact), np.abs(own - exact)


def _draw_gradients(figure: Figure) -> None:
    axes = panel(figure, x="gradient (1/s)", y="error of the range (m)")
    axes.set(xscale="log", yscale="log")
    plain, own = _ranges()
    axes.plot(GRADIENTS[1:], np.maximum(plain[1:], 1e-15), "o-", color=WRONG, markersize=3, label="(s₀ − s₁) / (g ξ)")
    axes.plot(
        GRADIENTS[1:], np.maximum(own[1:], 1e-15), "o-", color=RIGHT, markersize=3, label="arcs by their tangents"
    )
    axes.set_ylim(bottom=1e-16)
    named(axes)


def plumb_range(c0: float, c1: float, thick: float) -> float:
    """Range that a vertical ray covers, R (s0 − s1) with R = 1/(gξ) and ξ = 0."""
    radius = np.divide(1.0, np.float64((c1 - c0) / thick) * 0.0)
    return float(radius * (1.0 - 1.0))


def _plain_plumb_range() -> float:
    with np.errstate(divide="ignore", invalid="ignore"):
        return abs(plumb_range(1500.0, 1480.0, 40.0))


def _own_plumb_range() -> float:
    paths = ray_paths(profile([0.0, 40.0], [1500.0, 1480.0]), 0.0, 90.0, max_range=10.0, bottom=40.0)
    last = int(paths.hit.values[0].argmax())
    late = abs(float(paths.time[0, last]) - math.log(1480.0 / 1500.0) / -0.5) * 1500.0
    return max(abs(float(paths.range[0, last])), late)


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


THERMOCLINE = profile([0.0, 10.0, 12.0, 40.0, 60.0], [1522.0, 1521.0, 1493.0, 1490.0, 1490.0], interpolation="pchip")


def _spline() -> tuple[Values, Values]:
    from scipy.interpolate import CubicSpline

    depth = np.linspace(0.0, 60.0, 601)
    return depth, np.asarray(CubicSpline(THERMOCLINE.depth, THERMOCLINE.sound_speed)(depth))


def _overshoot(speed: Values) -> float:
    """By how much speeds leave the range of those given."""
    given = THERMOCLINE.sound_speed
    return float(max(speed.max() - max(given), min(given) - speed.min(), 0.0))


def _draw_thermocline(figure: Figure) -> None:
    axes = panel(figure, x="speed of sound (m/s)", y="depth (m)")
    depth, spline = _spline()
    layers = lay_out(THERMOCLINE)
    axes.plot(spline, depth, color=WRONG, label="cubic spline")
    axes.plot(layers.speed[0], layers.depth, color=RIGHT, label="monotone curve (PCHIP), laid out")
    axes.plot(THERMOCLINE.sound_speed, THERMOCLINE.depth, "o", color=INK, markersize=4, label="given")
    axes.invert_yaxis()
    named(axes, "center right")


def extrapolated(water: ProfileWater, depth: float) -> float:
    """Speed beyond a profile, along its last gradient."""
    (z0, z1), (c0, c1) = water.depth[-2:], water.sound_speed[-2:]
    return c1 + (c1 - c0) / (z1 - z0) * (depth - z1)


SHALLOW = profile([0.0, 20.0], [1520.0, 1500.0])

BAD: tuple[dict[str, Any], ...] = (
    {"depth": [0.0, 20.0, 10.0], "sound_speed": [1500.0, 1490.0, 1480.0]},
    {"depth": [0.0, 10.0, 10.0], "sound_speed": [1500.0, 1490.0, 1480.0]},
    {"depth": [0.0, 10.0], "sound_speed": [1500.0, math.nan]},
    {"depth": [0.0, 10.0], "sound_speed": [1500.0, 0.0]},
    {"depth": [0.0], "sound_speed": [1500.0]},
    {"depth": [0.0, math.inf], "sound_speed": [1500.0, 1490.0]},
)


def _taken_by_interpolation() -> float:
    taken = 0
    for given in BAD:
        try:
            np.interp(5.0, given["depth"], given["sound_speed"])
            taken += 1
        except ValueError:
            pass
    return float(taken)


def _taken_by_scenes() -> float:
    taken = 0
    for given in BAD:
        try:
            edit(level_scene(), {"water.kind": "profile", **{f"water.{key}": value for key, value in given.items()}})
            taken += 1
        except SceneError as error:
            taken += "\n" in str(error) or not str(error).startswith("water")
    return float(taken)


def as_printed(temperature: Values) -> Values:
    """Give the paper's speed of sound with its 0.55 t², at a salinity of 35 and no depth."""
    return 1449.0 + 4.6 * temperature - 0.55 * temperature**2 + 0.0003 * temperature**3


WARMTH = np.linspace(0.0, 25.0, 101)


def _speed_off(speed: Values) -> float:
    return float(np.abs(speed - teos10(WARMTH, 35.0, 0.0)).max())


def _draw_misprint(figure: Figure) -> None:
    axes = panel(figure, x="temperature (°C)", y="speed of sound (m/s)")
    axes.plot(WARMTH, as_printed(WARMTH), color=WRONG, label="0.55 t², as printed")
    axes.plot(WARMTH, paper(WARMTH, 35.0, 0.0), color=RIGHT, linewidth=2.0, label="0.055 t²")
    axes.plot(WARMTH, teos10(WARMTH, 35.0, 0.0), "--", color=INK, linewidth=0.9, label="TEOS-10")
    axes.axhline(1449.0, color=FAINT, linewidth=0.6)
    named(axes)


def _told_beyond(speed: float) -> float:
    return abs(speed - SHALLOW.sound_speed[-1])


def _own_beyond(water: Water, depth: float) -> float:
    return float(lay_out(water).speed_at(0.0, 0.0, depth))


CASES = (
    Case(
        "No gradient",
        "A layer whose speed hardly changes divides one vanishing number by another.",
        "worst error of the range through 10 m, for g from 0 to 0.1 1/s", "m",
        Way("Takes (s₀ − s₁)/(gξ).", lambda: float(np.max(_ranges()[0])), 0.01),
        Way("Follows arcs by the lengths of their tangents, which hold for a straight line too.",
            lambda: float(np.max(_ranges()[1])), 1e-9),
        _draw_gradients,
    ),
    Case(
        "A vertical ray",
        "Snell's constant is 0, and the radius of the arc infinite.",
        "error of range, and of time as a length", "m",
        Way("Takes R (s₀ − s₁) with R = 1/(gξ).", _plain_plumb_range, 1e-3),
        Way("Needs no radius.", _own_plumb_range, 1e-9),
    ),
    Case(
        "A level ray on a knot",
        "A ray that starts level on a knot of the profile is told to go to the nearest one, where it is already.",
        "missing after 1000 steps to the end of 400 m", "m",
        Way("Goes to the nearest knot.", lambda: 400.0 - stepped_range(KINK.depth, 20.0, 0.0, 1000), 399.0),
        Way("Goes on into the layer towards which sound bends it.", _own_missing, 1e-9),
    ),
    Case(
        "A layer chosen by history",
        "On a knot two layers claim the ray, and the one looked at last gets it.",
        "difference in depth after 100 m, by what was traced before", "m",
        Way("Looks first into the layer of the ray before.", _plain_history, 0.1),
        Way("Chooses by the ray's own direction and curvature.", _own_history, 0.0),
    ),
    Case(
        "A ray that turns at a knot",
        "Where it turns the sine is the root of a rounding error, as often below 0 as above.",
        "rays without a number", "%",
        Way("Takes √(s₀² − ξ² g Δz (c₀ + c₁)) at the knot.", _plain_vertex, 10.0),
        Way("Meets the border or turns before it, whichever the sign says.", lambda: float(_at_the_vertex()[0]), 0.0),
    ),
    Case(
        "A kink met at grazing",
        "The tube of a ray is bent by the jump of the gradient over the sine of its angle, which may be 0.",
        "rays whose tube explodes without a word", "%",
        Way("Takes p − qξ²Δg/|s| as it comes.", _plain_kicks, 50.0),
        Way("Caps the angle and flags the ray.", lambda: float(_at_the_vertex()[2]), 0.0),
    ),
    Case(
        "A ray in a duct",
        "Sound that is trapped comes neither to the surface nor to the bed.",
        "rays that never end", "of 5",
        Way("Goes on until the ray meets one or the other.", lambda: float(sum(not plain_end(40.0, a) for a in ANGLES)),
            3.0),
        Way("Ends rays at a range, and after so many layers.", _own_endless, 0.0),
    ),
    Case(
        "Beneath the profile",
        "The last gradient of a cast, continued, leads to speeds that no water has.",
        "speed told at 1600 m, off the deepest given", "m/s",
        Way("Continues the last gradient.", lambda: _told_beyond(extrapolated(SHALLOW, 1600.0)), 1000.0),
        Way("Keeps the outermost speed, as declared.", lambda: _told_beyond(_own_beyond(SHALLOW, 1600.0)), 0.0),
    ),
    Case(
        "A steep thermocline",
        "A smooth curve through a sudden step swings beyond it on both sides.",
        "overshoot", "m/s",
        Way("Draws a cubic spline.", lambda: _overshoot(_spline()[1]), 1.0),
        Way("Draws a curve that is monotone between its points.", lambda: _overshoot(lay_out(THERMOCLINE).speed), 1e-9),
        _draw_thermocline,
    ),
    Case(
        "Profiles that are none",
        "Depths out of order or twice, a speed that is no number or 0, a single point.",
        "taken without a word", "of 6",
        Way("Interpolates whatever comes.", _taken_by_interpolation, 3.0),
        Way("Refuses each in one sentence.", _taken_by_scenes, 0.0),
    ),
    Case(
        "A misprint",
        "A decimal point in the wrong place of the equation for the speed of sound turns its slope round.",
        "worst error from 0 to 25 °C, against TEOS-10", "m/s",
        Way("Takes 0.55 t².", lambda: _speed_off(as_printed(WARMTH)), 100.0),
        Way("Takes 0.055 t².", lambda: _speed_off(paper(WARMTH, 35.0, 0.0)), 0.3),
        _draw_misprint,
    ),
)  # fmt: skip
