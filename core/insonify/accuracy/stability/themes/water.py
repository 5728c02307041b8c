"""Failures of layered water: no gradient, vertical rays, depths below the profile, invalid profiles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel, write_table
from insonify.accuracy.stability.level_scenes import make_level_scene
from insonify.acoustics.layers import make_sound_speed_field
from insonify.acoustics.paths import ray_paths
from insonify.display.style import FAINT, INK
from insonify.scene import SceneError, edit, load_scene
from insonify.scene.water import WaterKind
from insonify.scene.water.profile import ProfileWater
from insonify.scene.water.sound_speed import paper, teos10

Values = NDArray[np.float64]
LAUNCH = 5.0  # degrees below the horizontal
GRADIENTS = (0.0, *(10.0**k for k in range(-11, 0)))
THICK = load_scene("breaks-gradient").seabed.depth  # m


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
    """Range over which a ray crosses a layer as `plain_range`, with 60 digits."""
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
    axes = add_panel(figure, x="gradient (1/s)", y="error of the range (m)")
    axes.set(xscale="log", yscale="log")
    plain, own = _ranges()
    axes.plot(GRADIENTS[1:], np.maximum(plain[1:], 1e-15), "o-", color=WRONG, markersize=3, label="(s₀ − s₁) / (g ξ)")
    axes.plot(
        GRADIENTS[1:], np.maximum(own[1:], 1e-15), "o-", color=RIGHT, markersize=3, label="arcs by their tangents"
    )
    axes.set_ylim(bottom=1e-16)
    add_legend(axes)


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
    axes = add_panel(figure, x="speed of sound (m/s)", y="depth (m)")
    depth, spline = _spline()
    layers = make_sound_speed_field(THERMOCLINE)
    axes.plot(spline, depth, color=WRONG, label="cubic spline")
    axes.plot(layers.speed[0], layers.depth, color=RIGHT, label="monotone curve (PCHIP)")
    axes.plot(THERMOCLINE.sound_speed, THERMOCLINE.depth, "o", color=INK, markersize=4, label="samples")
    axes.invert_yaxis()
    add_legend(axes, "center right")


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


def _refusal(given: dict[str, Any]) -> str:
    """Error message for a profile; empty if it is accepted."""
    try:
        edit(make_level_scene(), {"water.kind": "profile", **{f"water.{key}": value for key, value in given.items()}})
    except SceneError as error:
        return str(error)
    return ""


def _taken_by_scenes() -> float:
    return float(sum("\n" in said or not said.startswith("water") for said in map(_refusal, BAD)))


def as_printed(temperature: Values) -> Values:
    """Give the paper's speed of sound with its 0.55 t², at a salinity of 35 and no depth."""
    return 1449.0 + 4.6 * temperature - 0.55 * temperature**2 + 0.0003 * temperature**3


WARMTH = np.linspace(0.0, 25.0, 101)


def _speed_off(speed: Values) -> float:
    return float(np.abs(speed - teos10(WARMTH, 35.0, 0.0)).max())


def _draw_misprint(figure: Figure) -> None:
    axes = add_panel(figure, x="temperature (°C)", y="speed of sound (m/s)")
    axes.plot(WARMTH, as_printed(WARMTH), color=WRONG, label="0.55 t², as printed")
    axes.plot(WARMTH, paper(WARMTH, 35.0, 0.0), color=RIGHT, linewidth=2.0, label="0.055 t²")
    axes.plot(WARMTH, teos10(WARMTH, 35.0, 0.0), "--", color=INK, linewidth=0.9, label="TEOS-10")
    axes.axhline(1449.0, color=FAINT, linewidth=0.6)
    add_legend(axes)


def _told_beyond(speed: float) -> float:
    return abs(speed - SHALLOW.sound_speed[-1])


def _own_beyond(water: WaterKind, depth: float) -> float:
    return float(make_sound_speed_field(water).speed_at(0.0, 0.0, depth))


def _draw_plumb(figure: Figure) -> None:
    off = np.concatenate([np.logspace(-14, 0, 57)])
    exact = np.array([exact_range(1500.0, 1480.0, 40.0, 0.5 * math.pi - math.radians(a)) for a in off])
    plain = np.array([plain_range(1500.0, 1480.0, 40.0, 0.5 * math.pi - math.radians(a)) for a in off])
    own = np.array([_own_range(1500.0, 1480.0, 40.0, 0.5 * math.pi - math.radians(a)) for a in off])
    axes = add_panel(figure, x="angle off the vertical (°)", y="error of the range (m)")
    axes.set(xscale="log", yscale="log")
    axes.plot(off, np.maximum(np.abs(plain - exact), 1e-18), color=WRONG, label="R (s₀ − s₁): no number at 0°")
    axes.plot(off, np.maximum(np.abs(own - exact), 1e-18), color=RIGHT, label="without a radius: 0 at 0°")
    axes.set_ylim(bottom=3e-19)
    add_legend(axes)


def _draw_beyond(figure: Figure) -> None:
    axes = add_panel(figure, x="speed of sound (m/s)", y="depth (m)")
    depth = np.linspace(20.0, 1600.0, 60)
    axes.plot([extrapolated(SHALLOW, z) for z in depth], depth, color=WRONG, label="last gradient extrapolated")
    axes.plot([_own_beyond(SHALLOW, z) for z in depth], depth, color=RIGHT, linewidth=2.0, label="outermost speed held")
    axes.plot(SHALLOW.sound_speed, SHALLOW.depth, "o-", color=INK, markersize=4, label="samples")
    axes.axvline(0.0, color=FAINT, linewidth=0.7, linestyle=":")
    axes.invert_yaxis()
    add_legend(axes, "lower center")


def _draw_bad(figure: Figure) -> None:
    rows = []
    for given in BAD:
        depth, speed = (", ".join(f"{value:g}" for value in given[name]) for name in ("depth", "sound_speed"))
        asked = f"{depth} m: {speed} m/s"
        with np.errstate(invalid="ignore"):
            try:
                made = f"{np.interp(5.0, given['depth'], given['sound_speed']):.4g} m/s at 5 m"
            except ValueError:
                made = "an error from NumPy"
        rows.append((asked, made, _refusal(given)))
    write_table(figure, ("profile", "interpolated", "message"), rows)


THEME = StabilityTheme("Layered water", 1, (
    StabilityCase(
        "No gradient",
        "In a layer of nearly constant speed the formula divides one vanishing number by another.",
        "worst error of the range through 10 m, for g from 0 to 0.1 1/s", "m",
        Approach("Takes (s₀ − s₁)/(gξ).", lambda: float(np.max(_ranges()[0])), 0.01),
        Approach("Traces arcs by the lengths of their tangents, which remain valid for a straight line.",
            lambda: float(np.max(_ranges()[1])), 1e-9),
        _draw_gradients,
        "breaks-gradient",
    ),
    StabilityCase(
        "A vertical ray",
        "Snell's constant is 0 and the radius of the arc infinite.",
        "error of range, and of time times sound speed", "m",
        Approach("Takes R (s₀ − s₁) with R = 1/(gξ).", _plain_plumb_range, 1e-3),
        Approach("Uses no radius.", _own_plumb_range, 1e-9),
        _draw_plumb,
    ),
    StabilityCase(
        "Below the profile",
        "The last gradient of a cast, extrapolated, leads to impossible speeds.",
        "speed at 1600 m, relative to the deepest sample", "m/s",
        Approach("Extrapolates the last gradient.", lambda: _told_beyond(extrapolated(SHALLOW, 1600.0)), 1000.0),
        Approach("Keeps the speed of the outermost sample.", lambda: _told_beyond(_own_beyond(SHALLOW, 1600.0)), 0.0),
        _draw_beyond,
    ),
    StabilityCase(
        "A steep thermocline",
        "A smooth curve through a sudden step overshoots on both sides.",
        "overshoot", "m/s",
        Approach("Interpolates by a cubic spline.", lambda: _overshoot(_spline()[1]), 1.0),
        Approach("Interpolates by a curve that is monotone between samples.",
                 lambda: _overshoot(make_sound_speed_field(THERMOCLINE).speed), 1e-9),
        _draw_thermocline,
    ),
    StabilityCase(
        "Invalid profiles",
        "Depths are out of order or repeated, a speed is NaN or 0, or there is a single sample.",
        "profiles accepted without an error", "of 6",
        Approach("Interpolates without a check.", _taken_by_interpolation, 3.0),
        Approach("Refuses each in one sentence.", _taken_by_scenes, 0.0),
        _draw_bad,
    ),
    StabilityCase(
        "A misprint",
        "A misplaced decimal point in the equation for the speed of sound reverses its slope.",
        "worst error from 0 to 25 °C, against TEOS-10", "m/s",
        Approach("Uses 0.55 t², as printed.", lambda: _speed_off(as_printed(WARMTH)), 100.0),
        Approach("Uses 0.055 t².", lambda: _speed_off(paper(WARMTH, 35.0, 0.0)), 0.3),
        _draw_misprint,
    ),
))  # fmt: skip
