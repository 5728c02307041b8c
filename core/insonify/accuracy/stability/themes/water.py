"""Failures of layered water: vanishing gradients, vertical rays, rays at the knots of a profile, invalid profiles."""

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext
from functools import cache
from typing import Any

import numpy as np

from insonify.accuracy.stability.case import Approach, Measured, Quantity, StabilityTheme, percent
from insonify.accuracy.stability.drawing import common, faint, inked, ours, panel, side_by_side, table
from insonify.accuracy.stability.level_scenes import error_message, make_level_scene
from insonify.acoustics.paths import ray_paths
from insonify.acoustics.water import make_sound_speed_field
from insonify.arrays import Floats
from insonify.kernels.refraction.arcs import GRAZING
from insonify.scene import edit, load_scene
from insonify.scene.water.layered import ProfileWater
from insonify.scene.water.sound_speed import paper, teos10

LAYERED_WATER = StabilityTheme("Layered water", 1)


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


def _range_errors(layers: Sequence[tuple[float, float, float, float]]) -> tuple[Floats, Floats]:
    """Errors of the range through layers, by the gradient and by this program."""
    exact = np.array([_exact_range(*layer) for layer in layers])
    plain, own = (np.array([way(*layer) for layer in layers]) for way in (_range_by_gradient, _own_range))
    return np.abs(plain - exact), np.abs(own - exact)


@LAYERED_WATER.case(
    "No gradient",
    "In a layer of nearly constant speed the formula divides one vanishing number by another.",
    Quantity("worst error of the range through 10 m, for g from 0 to 0.1 1/s", "m"),
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


@LAYERED_WATER.case(
    "A vertical ray",
    "Snell's constant is 0 and the radius of the arc infinite.",
    Quantity("error of range, and of time times sound speed", "m"),
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


@LAYERED_WATER.case(
    "Below the profile",
    "The last gradient of a cast, extrapolated, leads to impossible speeds.",
    Quantity("speed at 1600 m, relative to the deepest sample", "m/s"),
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
        ours(own, depth, "speed of the outermost sample", linewidth=2.0),
        inked(shallow.sound_speed, shallow.depth, "samples", "o-", markersize=4),
        faint(0.0, None, style=":", linewidth=0.7),
        x="speed of sound (m/s)", y="depth (m)", legend="lower center", down=True,
    ))  # fmt: skip


@LAYERED_WATER.case(
    "A steep thermocline",
    "A smooth curve through a sudden step overshoots on both sides.",
    Quantity("overshoot", "m/s"),
    failing=Approach("Interpolates by a cubic spline.", 1.0),
    right=Approach("Interpolates by a curve that is monotone between samples.", 1e-9),
)
def _thermocline() -> Measured:
    from scipy.interpolate import CubicSpline

    depth, speed = (0.0, 10.0, 12.0, 40.0, 60.0), (1522.0, 1521.0, 1493.0, 1490.0, 1490.0)
    fine = np.linspace(0.0, 60.0, 601)
    spline = np.asarray(CubicSpline(depth, speed)(fine))
    layers = make_sound_speed_field(profile(depth, speed, interpolation="pchip"))

    def overshoot(found: Floats) -> float:
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


@LAYERED_WATER.case(
    "Invalid profiles",
    "Depths are out of order or repeated, a speed is NaN or 0, or there is a single sample.",
    Quantity("profiles accepted without an error", "of 6"),
    failing=Approach("Interpolates without a check.", 3.0),
    right=Approach("Reports each as one sentence.", 0.0),
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


@LAYERED_WATER.case(
    "A misprint",
    "A misplaced decimal point in the equation for the speed of sound reverses its slope.",
    Quantity("worst error from 0 to 25 °C, against TEOS-10", "m/s"),
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


KNOTS = StabilityTheme("Knots of a profile", 2)
KINK = profile([0.0, 20.0, 60.0], [1499.0, 1500.0, 1498.0])


@KNOTS.case(
    "A level ray on a knot",
    "A horizontal ray that starts on a knot of the profile steps to the nearest knot, where it already is.",
    Quantity("distance to the end of 400 m after 1000 steps", "m"),
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


@KNOTS.case(
    "A layer chosen by history",
    "On a knot the ray belongs to two layers, and the layer used last is taken.",
    Quantity("difference in depth after 100 m between two histories", "m"),
    failing=Approach("Starts in the layer of the previous ray.", 0.1),
    right=Approach("Chooses by the ray's own direction and curvature.", 0.0),
)
def _history() -> Measured:
    across = np.linspace(0.0, 100.0, 51)
    # The ray before, from 5 m or from 40 m, leaves its layer, to which the knot belongs too.
    gradients = np.diff(KINK.sound_speed) / np.diff(KINK.depth)
    histories = 20.0 - 0.5 * gradients[:, None] / 1500.0 * across**2
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


def _turning_angles() -> tuple[Floats, Floats]:
    """Speeds at the second node of profiles, and the angles at which rays from the first turn just there."""
    faster = 1500.0 + np.linspace(0.3, 30.0, 100)
    return faster, np.arccos(1500.0 / faster)


@cache
def _at_the_vertex() -> tuple[int, int]:
    """Count the rays with NaN somewhere, and the rays with an unreliable tube and without a flag."""
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


@KNOTS.case(
    "A ray that turns at a knot",
    "At the turning point the sine is the root of a rounding error, as often negative as positive.",
    Quantity("rays without a number", "%"),
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


@KNOTS.case(
    "A kink met at grazing",
    "The ray tube changes by the jump of the gradient over the sine of the ray's angle, which can be 0.",
    Quantity("rays with a diverging tube and without a flag", "%"),
    failing=Approach("Takes p − qξ²Δg/|s| without a bound.", 50.0),
    right=Approach("Limits the angle and flags the ray.", 0.0),
)
def _kick() -> Measured:
    def change(sine: Floats) -> Floats:
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


@KNOTS.case(
    "A ray in a duct",
    "A trapped ray reaches neither the surface nor the bed.",
    Quantity("rays that never end", "of 5"),
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
