"""Failures of layered water: no gradient, vertical rays, depths below the profile, invalid profiles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, Measured, StabilityTheme
from insonify.accuracy.stability.drawing import common, faint, inked, ours, panel, table
from insonify.accuracy.stability.level_scenes import error_message, make_level_scene
from insonify.acoustics.paths import ray_paths
from insonify.acoustics.water import make_sound_speed_field
from insonify.scene import edit, load_scene
from insonify.scene.water.layered import ProfileWater
from insonify.scene.water.sound_speed import paper, teos10

Values = NDArray[np.float64]
THEME = StabilityTheme("Layered water", 1)


def profile(depth: Sequence[float], speed: Sequence[float], **options: Any) -> ProfileWater:
    """Declare water of given speeds at given depths."""
    return ProfileWater(depth=tuple(depth), sound_speed=tuple(speed), **options)


def _range_by_gradient(c0: float, c1: float, thick: float, angle: float) -> float:
    """Range over which a ray crosses a layer, (s0 − s1)/(gξ)."""
    gradient, snell = (c1 - c0) / thick, math.cos(angle) / c0
    bend = gradient * snell
    sines = math.sin(angle) - math.sqrt(1.0 - (snell * c1) ** 2)
    return sines / bend if bend != 0.0 else math.nan


def _exact_range(c0: float, c1: float, thick: float, angle: float) -> float:
    """Range over which a ray crosses a layer, with 60 digits."""
    with localcontext() as context:
        context.prec = 60
        cosine = Decimal(math.cos(angle))
        sine, snell = (1 - cosine**2).sqrt(), cosine / Decimal(c0)
        other = (1 - (snell * Decimal(c1)) ** 2).sqrt()
        # 1/g cancels: (s0² − s1²)/(gξ) = ξ Δz (c0 + c1)
        return float(snell * Decimal(thick) * (Decimal(c0) + Decimal(c1)) / (sine + other))


def _own_range(c0: float, c1: float, thick: float, angle: float) -> float:
    """Range over which a ray crosses a layer, by this program."""
    degrees = math.degrees(angle)
    paths = ray_paths(profile([0.0, thick], [c0, c1]), 0.0, degrees, max_range=2000.0, bottom=thick)
    return float(paths.range.values[0, -1])


def _range_errors(layers: Sequence[tuple[float, float, float, float]]) -> tuple[Values, Values]:
    """Errors of the range through layers, by the gradient and by this program."""
    exact = np.array([_exact_range(*layer) for layer in layers])
    plain, own = (np.array([way(*layer) for layer in layers]) for way in (_range_by_gradient, _own_range))
    return np.abs(plain - exact), np.abs(own - exact)


@THEME.case(
    "No gradient",
    "In a layer of nearly constant speed the formula divides one vanishing number by another.",
    "worst error of the range through 10 m, for g from 0 to 0.1 1/s",
    "m",
    failing=Approach("Takes (s₀ − s₁)/(gξ).", 0.01),
    right=Approach("Traces arcs by the lengths of their tangents, which remain valid for a straight line.", 1e-9),
    scene="breaks-gradient",
)
def _no_gradient() -> Measured:
    gradients = (0.0, *(10.0**k for k in range(-11, 0)))
    thick, angle = load_scene("breaks-gradient").seabed.depth, math.radians(5.0)
    plain, own = _range_errors([(1500.0, 1500.0 + gradient * thick, thick, angle) for gradient in gradients])
    return Measured.by(np.max, plain, own, panel(
        common(gradients[1:], np.maximum(plain[1:], 1e-15), "(s₀ − s₁) / (g ξ)", "o-", markersize=3),
        ours(gradients[1:], np.maximum(own[1:], 1e-15), "arcs by their tangents", "o-", markersize=3),
        x="gradient (1/s)", y="error of the range (m)", log="xy", ylim=(1e-16, None),
    ))  # fmt: skip


@THEME.case(
    "A vertical ray",
    "Snell's constant is 0 and the radius of the arc infinite.",
    "error of range, and of time times sound speed",
    "m",
    failing=Approach("Takes R (s₀ − s₁) with R = 1/(gξ).", 1e-3),
    right=Approach("Uses no radius.", 1e-9),
)
def _vertical() -> Measured:
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = np.divide(1.0, np.float64((1480.0 - 1500.0) / 40.0) * 0.0)
        plumb = abs(float(radius * (1.0 - 1.0)))
    paths = ray_paths(profile([0.0, 40.0], [1500.0, 1480.0]), 0.0, 90.0, max_range=10.0, bottom=40.0)
    last = int(paths.hit.values[0].argmax())
    late = abs(float(paths.time[0, last]) - math.log(1480.0 / 1500.0) / -0.5) * 1500.0
    off = np.concatenate([np.logspace(-14, 0, 57)])
    plain, own = _range_errors([(1500.0, 1480.0, 40.0, 0.5 * math.pi - math.radians(angle)) for angle in off])
    return Measured(plumb, max(abs(float(paths.range[0, last])), late), panel(
        common(off, np.maximum(plain, 1e-18), "R (s₀ − s₁): no number at 0°"),
        ours(off, np.maximum(own, 1e-18), "without a radius: 0 at 0°"),
        x="angle off the vertical (°)", y="error of the range (m)", log="xy", ylim=(3e-19, None),
    ))  # fmt: skip


@THEME.case(
    "Below the profile",
    "The last gradient of a cast, extrapolated, leads to impossible speeds.",
    "speed at 1600 m, relative to the deepest sample",
    "m/s",
    failing=Approach("Extrapolates the last gradient.", 1000.0),
    right=Approach("Keeps the speed of the outermost sample.", 0.0),
)
def _below() -> Measured:
    shallow = profile([0.0, 20.0], [1520.0, 1500.0])
    (z0, z1), (c0, c1) = shallow.depth[-2:], shallow.sound_speed[-2:]
    depth = np.linspace(20.0, 1600.0, 60)
    extrapolated = [c1 + (c1 - c0) / (z1 - z0) * (z - z1) for z in depth]
    own = [float(make_sound_speed_field(shallow).speed_at(0.0, 0.0, z)) for z in depth]
    return Measured.by(lambda speed: abs(speed[-1] - c1), extrapolated, own, panel(
        common(extrapolated, depth, "last gradient extrapolated"),
        ours(own, depth, "outermost speed held", linewidth=2.0),
        inked(shallow.sound_speed, shallow.depth, "samples", "o-", markersize=4),
        faint(0.0, None, style=":", linewidth=0.7),
        x="speed of sound (m/s)", y="depth (m)", legend="lower center", down=True,
    ))  # fmt: skip


@THEME.case(
    "A steep thermocline",
    "A smooth curve through a sudden step overshoots on both sides.",
    "overshoot",
    "m/s",
    failing=Approach("Interpolates by a cubic spline.", 1.0),
    right=Approach("Interpolates by a curve that is monotone between samples.", 1e-9),
)
def _thermocline() -> Measured:
    from scipy.interpolate import CubicSpline

    depth, speed = (0.0, 10.0, 12.0, 40.0, 60.0), (1522.0, 1521.0, 1493.0, 1490.0, 1490.0)
    fine = np.linspace(0.0, 60.0, 601)
    spline = np.asarray(CubicSpline(depth, speed)(fine))
    layers = make_sound_speed_field(profile(depth, speed, interpolation="pchip"))

    def overshoot(found: Values) -> float:
        return max(found.max() - max(speed), min(speed) - found.min(), 0.0)

    return Measured.by(overshoot, spline, layers.speed, panel(
        common(spline, fine, "cubic spline"),
        ours(layers.speed[0], layers.depth, "monotone curve (PCHIP)"),
        inked(speed, depth, "samples", "o", markersize=4),
        x="speed of sound (m/s)", y="depth (m)", legend="center right", down=True,
    ))  # fmt: skip


BAD: tuple[dict[str, Any], ...] = (
    {"depth": [0.0, 20.0, 10.0], "sound_speed": [1500.0, 1490.0, 1480.0]},
    {"depth": [0.0, 10.0, 10.0], "sound_speed": [1500.0, 1490.0, 1480.0]},
    {"depth": [0.0, 10.0], "sound_speed": [1500.0, math.nan]},
    {"depth": [0.0, 10.0], "sound_speed": [1500.0, 0.0]},
    {"depth": [0.0], "sound_speed": [1500.0]},
    {"depth": [0.0, math.inf], "sound_speed": [1500.0, 1490.0]},
)


@THEME.case(
    "Invalid profiles",
    "Depths are out of order or repeated, a speed is NaN or 0, or there is a single sample.",
    "profiles accepted without an error",
    "of 6",
    failing=Approach("Interpolates without a check.", 3.0),
    right=Approach("Refuses each in one sentence.", 0.0),
)
def _invalid_profiles() -> Measured:
    accepted, unexplained, rows = 0, 0, []
    for given in BAD:
        try:
            with np.errstate(invalid="ignore"):
                made = f"{np.interp(5.0, given['depth'], given['sound_speed']):.4g} m/s at 5 m"
            accepted += 1
        except ValueError:
            made = "an error from NumPy"
        changes = {"water.kind": "profile", **{f"water.{key}": value for key, value in given.items()}}
        message = error_message(lambda changes=changes: edit(make_level_scene(), changes))  # type: ignore[misc]
        unexplained += "\n" in message or not message.startswith("water")
        depth, speed = (", ".join(f"{value:g}" for value in given[name]) for name in ("depth", "sound_speed"))
        rows.append((f"{depth} m: {speed} m/s", made, message))
    return Measured(float(accepted), float(unexplained), table(("profile", "interpolated", "message"), rows))


@THEME.case(
    "A misprint",
    "A misplaced decimal point in the equation for the speed of sound reverses its slope.",
    "worst error from 0 to 25 °C, against TEOS-10",
    "m/s",
    failing=Approach("Uses 0.55 t², as printed.", 100.0),
    right=Approach("Uses 0.055 t².", 0.3),
)
def _misprint() -> Measured:
    warmth = np.linspace(0.0, 25.0, 101)
    printed = 1449.0 + 4.6 * warmth - 0.55 * warmth**2 + 0.0003 * warmth**3  # salinity 35, no depth
    own, exact = (equation(warmth, 35.0, 0.0) for equation in (paper, teos10))
    return Measured.by(lambda speed: np.abs(speed - exact).max(), printed, own, panel(
        common(warmth, printed, "0.55 t², as printed"),
        ours(warmth, own, "0.055 t²", linewidth=2.0),
        inked(warmth, exact, "TEOS-10", "--", linewidth=0.9),
        faint(None, 1449.0, linewidth=0.6),
        x="temperature (°C)", y="speed of sound (m/s)",
    ))  # fmt: skip
