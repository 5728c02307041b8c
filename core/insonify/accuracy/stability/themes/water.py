"""Failures of layered water: gradients, knots and invalid profiles; false, lost and focused rays; echoes along arcs."""

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext
from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from insonify.accuracy.stability.case import Measured, StabilityTheme, percent, worst
from insonify.accuracy.stability.drawing import plot, table
from insonify.accuracy.stability.level_scenes import (
    error_message,
    first_ping,
    level_arrays,
    make_level_scene,
    make_pose,
)
from insonify.acoustics.paths import airy_pressure, eigenrays, ray_paths, shadow_zones
from insonify.acoustics.resolution_cell import bin_centres
from insonify.acoustics.water import make_sound_speed_field
from insonify.arrays import Floats, Singles
from insonify.kernels.bed.profile import empty_profile
from insonify.kernels.rays.caustics import OCTAVE, airy_field
from insonify.kernels.refraction.apparent_positions import LEVEL, RISE, TUBE, TableGrid, apply_apparent_positions
from insonify.kernels.refraction.arcs import GRAZING
from insonify.packing.apparent_tables import COLUMN_STEP, ROW_STEP, make_apparent_tables
from insonify.scene import edit, load_scene
from insonify.scene.water.layered import ProfileWater
from insonify.scene.water.sound_speed import paper, teos10
from insonify.tracers import ray_sheets, rays

LAYERED_WATER = StabilityTheme("Layered water", 1)


def profile(depth: Sequence[float], speed: Sequence[float], **options: Any) -> ProfileWater:
    """Declare water of given speeds at given depths."""
    return ProfileWater(depth=tuple(depth), sound_speed=tuple(speed), **options)


def _range_by_gradient(c0: float, c1: float, thick: float, angle: float) -> float:
    """Range over which a ray crosses a layer, (s0 − s1)/(gξ)."""
    snell = math.cos(angle) / c0
    bend = (c1 - c0) / thick * snell
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
    water, degrees = profile([0.0, thick], [c0, c1]), math.degrees(angle)
    return float(ray_paths(water, 0.0, degrees, max_range=2000.0, bottom=thick).range.values[0, -1])


def _range_errors(layers: Sequence[tuple[float, float, float, float]]) -> tuple[Floats, Floats]:
    """Errors of the range through layers, by the gradient and by this program."""
    exact = np.array([_exact_range(*layer) for layer in layers])
    plain, own = (np.array([way(*layer) for layer in layers]) for way in (_range_by_gradient, _own_range))
    return np.abs(plain - exact), np.abs(own - exact)


@LAYERED_WATER.case(
    "No gradient", "In a layer of nearly constant speed the formula divides one vanishing number by another.",
    "worst error of the range through 10 m, for g from 0 to 0.1 1/s", "m", "Takes (s₀ − s₁)/(gξ).", 0.01,
    "Traces arcs by the lengths of their tangents, which remain valid for a straight line.", 1e-9,
    scene="breaks-gradient")  # fmt: skip
def _no_gradient() -> Measured:
    gradients = (0.0, *(10.0**k for k in range(-11, 0)))
    thick, angle = load_scene("breaks-gradient").seabed.depth, math.radians(5.0)
    plain, own = _range_errors([(1500.0, 1500.0 + gradient * thick, thick, angle) for gradient in gradients])
    errors = [np.maximum(each[1:], 1e-15) for each in (plain, own)]
    return Measured.by(
        np.max, plain, own, plot("gradient (1/s)", "error of the range (m)", gradients[1:], *errors, log="xy")
    )


@LAYERED_WATER.case("A vertical ray", "Snell's constant is 0 and the radius of the arc infinite.",
    "error of range, and of time times sound speed", "m", "Takes R (s₀ − s₁) with R = 1/(gξ).", 1e-3,
    "Uses no radius.", 1e-9)  # fmt: skip
def _vertical() -> Measured:
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = np.divide(1.0, np.float64((1480.0 - 1500.0) / 40.0) * 0.0)
        plumb = abs(float(radius * (1.0 - 1.0)))
    paths = ray_paths(profile([0.0, 40.0], [1500.0, 1480.0]), 0.0, 90.0, max_range=10.0, bottom=40.0)
    last = int(paths.hit.values[0].argmax())
    late = abs(float(paths.time[0, last]) - math.log(1480.0 / 1500.0) / -0.5) * 1500.0
    off = np.logspace(-14, 0, 57)
    errors = _range_errors([(1500.0, 1480.0, 40.0, 0.5 * math.pi - math.radians(angle)) for angle in off])
    shown = [np.maximum(each, 1e-18) for each in errors]
    return Measured(
        plumb,
        max(abs(float(paths.range[0, last])), late),
        plot("angle off the vertical (°)", "error of the range (m)", off, *shown, log="xy"),
    )


@LAYERED_WATER.case("Below the profile", "The last gradient of a cast, extrapolated, leads to impossible speeds.",
    "speed at 1600 m, relative to the deepest sample", "m/s", "Extrapolates the last gradient.", 1000.0,
    "Keeps the speed of the outermost sample.", 0.0)  # fmt: skip
def _below() -> Measured:
    depth, field = np.linspace(20.0, 1600.0, 60), make_sound_speed_field(profile([0.0, 20.0], [1520.0, 1500.0]))
    extrapolated, own = 1500.0 - (depth - 20.0), np.array([float(field.speed_at(0.0, 0.0, z)) for z in depth])
    picture = plot("speed of sound (m/s)", "depth (m)", None, (extrapolated, depth), (own, depth), down=True)
    return Measured.by(lambda speed: abs(speed[-1] - 1500.0), extrapolated, own, picture)


@LAYERED_WATER.case("A steep thermocline", "A smooth curve through a sudden step overshoots on both sides.",
    "overshoot", "m/s", "Interpolates by a cubic spline.", 1.0,
    "Interpolates by a curve that is monotone between samples.", 1e-9)  # fmt: skip
def _thermocline() -> Measured:
    depth, speed = (0.0, 10.0, 12.0, 40.0, 60.0), (1522.0, 1521.0, 1493.0, 1490.0, 1490.0)
    fine = np.linspace(0.0, 60.0, 601)
    spline = np.asarray(CubicSpline(depth, speed)(fine))
    layers = make_sound_speed_field(profile(depth, speed, interpolation="pchip"))
    curves = (spline, fine), (layers.speed[0], layers.depth), (speed, depth)

    def overshoot(found: Floats) -> float:
        return max(found.max() - max(speed), min(speed) - found.min(), 0.0)

    picture = plot("speed of sound (m/s)", "depth (m)", None, *curves, down=True)
    return Measured.by(overshoot, spline, layers.speed, picture)


INVALID: tuple[dict[str, Any], ...] = (
    {"depth": [0.0, 20.0, 10.0], "sound_speed": [1500.0, 1490.0, 1480.0]},
    {"depth": [0.0, 10.0, 10.0], "sound_speed": [1500.0, 1490.0, 1480.0]},
    {"depth": [0.0, 10.0], "sound_speed": [1500.0, math.nan]},
    {"depth": [0.0, 10.0], "sound_speed": [1500.0, 0.0]},
    {"depth": [0.0], "sound_speed": [1500.0]},
    {"depth": [0.0, math.inf], "sound_speed": [1500.0, 1490.0]},
)


@LAYERED_WATER.case(
    "Invalid profiles", "Depths are out of order or repeated, a speed is NaN or 0, or there is a single sample.",
    "profiles accepted without an error", "of 6", "Interpolates without a check.", 3.0,
    "Reports each as one sentence.", 0.0)  # fmt: skip
def _invalid_profiles() -> Measured:
    accepted, unexplained, rows = 0, 0, []
    for given in INVALID:
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
    return Measured(float(accepted), float(unexplained), table(rows))


@LAYERED_WATER.case(
    "A misprint", "A misplaced decimal point in the equation for the speed of sound reverses its slope.",
    "worst error from 0 to 25 °C, against TEOS-10", "m/s", "Uses 0.55 t², as printed.", 100.0,
    "Uses 0.055 t².", 0.3)  # fmt: skip
def _misprint() -> Measured:
    warmth = np.linspace(0.0, 25.0, 101)
    printed = 1449.0 + 4.6 * warmth - 0.55 * warmth**2 + 0.0003 * warmth**3  # salinity 35, no depth
    own, exact = (equation(warmth, 35.0, 0.0) for equation in (paper, teos10))
    picture = plot("temperature (°C)", "speed of sound (m/s)", warmth, printed, own, exact)
    return Measured.by(lambda speed: np.abs(speed - exact).max(), printed, own, picture)


KNOTS = StabilityTheme("Knots of a profile", 2)
KINK = profile([0.0, 20.0, 60.0], [1499.0, 1500.0, 1498.0])


@KNOTS.case("A level ray on a knot",
    "A horizontal ray that starts on a knot of the profile steps to the nearest knot, where it already is.",
    "distance to the end of 400 m after 1000 steps", "m", "Steps to the nearest knot.", 399.0,
    "Enters the layer towards which refraction bends the ray.", 1e-9)  # fmt: skip
def _level() -> Measured:
    covered, depth, sine = 0.0, 20.0, 0.0
    for _ in range(1000):  # straight on within each layer
        node = min(KINK.depth, key=lambda level: abs(level - depth))
        covered += abs(node - depth) / math.tan(math.asin(sine)) if sine else abs(node - depth)
        depth = node
    ends = [float(ray_paths(KINK, 20.0, angle, max_range=400.0).range.max()) for angle in (0.0, 1e-12, -1e-12)]
    path = ray_paths(KINK, 20.0, 0.0, max_range=400.0, ranges=np.linspace(0.0, 400.0, 81))
    own = path.range.values[0], path.depth.values[0]
    return Measured(400.0 - covered, 400.0 - min(ends), plot("range (m)", "depth (m)", [0.0], [20.0], own, down=True))


@KNOTS.case("A layer chosen by history", "On a knot the ray belongs to two layers, and the layer used last is taken.",
    "difference in depth after 100 m between two histories", "m", "Starts in the layer of the previous ray.", 0.1,
    "Chooses by the ray's own direction and curvature.", 0.0)  # fmt: skip
def _history() -> Measured:
    across = np.linspace(0.0, 100.0, 51)
    # The ray before, from 5 m or from 40 m, leaves its layer, to which the knot belongs too.
    gradients = np.diff(KINK.sound_speed) / np.diff(KINK.depth)
    histories = 20.0 - 0.5 * gradients[:, None] / 1500.0 * across**2
    options: dict[str, Any] = {"max_range": 100.0, "ranges": [100.0]}
    alone = np.array([ray_paths(KINK, 20.0, [angle], **options).depth.values[0, 0] for angle in (0.0, 2.0, -2.0)])
    up, down = ([2.0, 0.0, -2.0], [1, 0, 2]), ([-2.0, 0.0, 2.0], [1, 2, 0])
    others = [ray_paths(KINK, 20.0, angles, **options).depth.values[order, 0] for angles, order in (up, down)]
    path = ray_paths(KINK, 20.0, [2.0, 0.0], max_range=100.0, ranges=across)
    return Measured(
        abs(float(histories[0][-1] - histories[1][-1])),
        max(float(np.abs(alone - other).max()) for other in others),
        plot("range (m)", "depth (m)", across, histories.T, (path.range.values[1], path.depth.values[1]), down=True),
    )


TURNING = 1500.0 + np.linspace(0.3, 30.0, 100)  # speeds at the second node of profiles, m/s
TURNING_ANGLES = np.arccos(1500.0 / TURNING)  # of rays from the first that turn just there


@cache
def _at_the_vertex() -> tuple[int, int]:
    """Count the rays with NaN somewhere, and the rays with an unreliable tube and without a flag."""
    lost = unflagged = 0
    for speed, angle in zip(TURNING, TURNING_ANGLES):
        water = profile([0.0, 20.0, 40.0], [1500.0, speed, speed + 40.0])
        paths = ray_paths(water, 0.0, math.degrees(angle), max_range=600.0)
        there = np.isfinite(paths.range.values[0])
        numbers = [paths[name].values[0][there] for name in ("depth", "time", "tube")]
        lost += not np.isfinite(numbers).all()
        wild = bool((np.abs(numbers[2]) > 1e5).any())
        unflagged += wild and not bool(paths.capped.values[0][there].any())
    return lost, unflagged


@KNOTS.case("A ray that turns at a knot",
    "At the turning point the sine is the root of a rounding error, as often negative as positive.",
    "rays without a number", "%", "Takes √(s₀² − ξ² g Δz (c₀ + c₁)) at the knot.", 10.0,
    "Crosses the knot or turns before it, depending on the sign.", 0.0)  # fmt: skip
def _vertex() -> Measured:
    snell = np.cos(TURNING_ANGLES) / 1500.0
    radicand = np.sin(TURNING_ANGLES) ** 2 - snell**2 * (TURNING - 1500.0) * (TURNING + 1500.0)
    return Measured(
        percent(radicand < 0.0),
        float(_at_the_vertex()[0]),
        plot("speed at the knot (m/s)", "radicand; 0 except for rounding", TURNING, radicand, np.maximum(radicand, 0.0),
             style=".", ylim=(-1.4e-16, 2.2e-16)),
    )  # fmt: skip


@KNOTS.case("A kink met at grazing",
    "The ray tube changes by the jump of the gradient over the sine of the ray's angle, which can be 0.",
    "rays with a diverging tube and without a flag", "%", "Takes p − qξ²Δg/|s| without a bound.", 50.0,
    "Limits the angle and flags the ray.", 0.0)  # fmt: skip
def _kick() -> Measured:
    def change(sine: Floats) -> Floats:
        """Change of the tube in m/rad, 400 m beyond a jump of the gradient of 2 1/s: q ξ² Δg / |s|."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.divide(400.0 * 2.0 / 1500.0**2, np.abs(sine))) * 1500.0 * 400.0

    turning = np.concatenate([np.zeros(20), np.logspace(-16, -9, 80)])  # rays that turn within rounding of a knot
    sines = np.logspace(-16, 0, 65)
    curves = change(sines), change(np.maximum(sines, GRAZING))
    picture = plot("sine of the angle at the knot", "change of the tube (m/rad)", sines, *curves, log="xy")
    return Measured(percent(change(turning) > 1e5), float(_at_the_vertex()[1]), picture)


DUCT = profile([0.0, 40.0, 120.0], [1530.0, 1490.0, 1530.0])


def _leaves_the_duct(depth: float, angle: float) -> bool:
    """Whether a ray meets the floor or the surface within 20,000 steps of 1 m."""
    sine = math.sin(math.radians(angle))
    for _ in range(20_000):
        speed = float(np.interp(depth, DUCT.depth, DUCT.sound_speed))
        sine -= (-1.0 if depth < 40.0 else 0.5) / speed * (1.0 - sine * sine)
        depth += sine
        if not 0.0 < depth < 120.0:
            return True
    return False


@KNOTS.case("A ray in a duct", "A trapped ray reaches neither the surface nor the bed.",
    "rays that never end", "of 5", "Traces until the ray meets one of them.", 3.0,
    "Ends rays at a maximum range and after a maximum number of layers.", 0.0)  # fmt: skip
def _duct() -> Measured:
    angles = (-6.0, -3.0, 0.5, 3.0, 6.0)
    ends = ray_paths(DUCT, 40.0, angles, max_range=20_000.0, bottom=120.0).end.values
    endless = sum(not _leaves_the_duct(40.0, angle) for angle in angles)
    path = ray_paths(DUCT, 40.0, 6.0, max_range=10_000.0, bottom=120.0, ranges=np.linspace(0.0, 10_000.0, 1001))
    x, depth = path.range.values[0] / 1000.0, path.depth.values[0]
    picture = plot("range (km)", "depth (m)", x, depth, (x[x <= 5.0], depth[x <= 5.0]), ylim=(120.0, 0.0))
    return Measured(float(endless), float(sum(end not in ("range", "trapped") for end in ends)), picture)


REFRACTED_RAYS = StabilityTheme("Refracted rays", 3)
CARRIER = 400e3  # Hz
# Sound slows down with depth, so that the bed is insonified up to the ray that grazes the surface.
DOWNWARD, SONAR, BED = profile([0.0, 40.0], [1500.0, 1496.0]), 10.0, 40.0


def _height_missed(angle: float, across: float) -> float:
    """Height at which a ray, an arc of a circle, passes over a point of the bed; the whole depth if it surfaces."""
    surface, slow = DOWNWARD.sound_speed[0], -0.1
    launch = math.radians(angle)
    radius = (surface + slow * SONAR) / (-slow * math.cos(launch))
    top, middle = -radius * math.sin(launch), -surface / slow
    if 0.0 < top < across and middle - radius < 0.0:
        return BED
    return BED - (middle - math.sqrt(radius**2 - (across - top) ** 2))


def _bisect(across: float) -> float:
    """Launch angle to a point of the bed, between one that falls short and one that overshoots."""
    low, high = 15.0, -5.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _height_missed(middle, across) < 0.0 else (low, middle)
    return 0.5 * (low + high)


@REFRACTED_RAYS.case("A shadow zone",
    "A bisection between a ray that falls short and one that overshoots converges even where no ray exists.",
    "rays reported where none exists", "of 5", "Bisects forty times.", 4.0,
    "Rejects a ray that misses the point.", 0.0)  # fmt: skip
def _shadow() -> Measured:
    beyond = (1700.0, 1800.0, 1900.0, 2000.0, 2200.0)
    found = [math.isfinite(_bisect(across)) for across in beyond]
    own = [eigenrays(DOWNWARD, SONAR, across, BED, bottom=BED).sizes["eigenray"] > 0 for across in beyond]
    begins = float(shadow_zones(DOWNWARD, SONAR, BED, max_range=2500.0, bottom=BED)[0, 0])
    wrong = ray_paths(DOWNWARD, SONAR, _bisect(2000.0), max_range=2500.0, bottom=BED)
    curves = (wrong.range.values[0], wrong.depth.values[0]), ([begins, 2500.0], [BED, BED]), ([2000.0], [BED])
    picture = plot("range (m); no ray in the shadow", "depth (m)", None, *curves, ylim=(BED + 2.0, 0.0))
    return Measured(float(sum(found)), float(sum(own)), picture)


CHANNEL = profile([0.0, 60.0, 200.0], [1530.0, 1490.0, 1530.0])
FROM, TO, ACROSS = 50.0, 70.0, 4000.0


def _depths_reached(angles: Floats) -> Floats:
    """Depths at which rays through the channel arrive; NaN for those that meet its ends."""
    paths = ray_paths(CHANNEL, FROM, angles, max_range=ACROSS, bottom=200.0, ranges=[ACROSS])
    return np.where(paths.range.values[:, 0] == ACROSS, paths.depth.values[:, 0], np.nan)


def _newton() -> int:
    """Search for a ray to the point by Newton's method from the straight line; return the number found, 0 or 1."""
    angle = math.degrees(math.atan2(TO - FROM, ACROSS))
    for _ in range(50):
        pair = [angle, angle + 1e-4]
        near, next_to = ray_paths(CHANNEL, FROM, pair, max_range=ACROSS, ranges=[ACROSS]).depth.values[:, 0] - TO
        if abs(near) < 1e-6:
            return 1
        angle = min(max(angle - near * 1e-4 / (next_to - near), -12.0), 12.0)
    return 0


@REFRACTED_RAYS.case("Several rays to one point",
    "In a channel many rays join two points, and a search from the straight line finds one at most.",
    "rays lost", "%", "Starts Newton's method from the straight line.", 50.0,
    "Brackets every branch between the rays that graze a knot.", 0.0)  # fmt: skip
def _several() -> Measured:
    sweep = np.linspace(-12.5, 12.5, 20_001)  # so dense that every ray to the point lies between two of them
    depths, found = _depths_reached(sweep), eigenrays(CHANNEL, FROM, ACROSS, TO, bottom=200.0)
    sides = np.sign(depths - TO)
    exact, count, newton = int((sides[:-1] * sides[1:] < 0.0).sum()), found.sizes["eigenray"], _newton()
    return Measured(
        100.0 * (exact - newton) / exact,
        100.0 * abs(exact - count) / exact,
        plot("launch angle (°)", "depth reached (m); rays to 70 m", sweep, None,
             (found.angle.values, np.full(count, TO)), (sweep, depths), style="."),
    )  # fmt: skip


def _sum_waves(rho: Floats) -> Floats:
    """Pressure at distances ρ from a caustic, 2π Ai(−ρ), by the integral of all waves, ∫exp i(s³/3 − ρs) ds.

    Its two points of stationary phase are the rays. Along a path turned by 30° nothing oscillates.
    """
    along, turn = np.linspace(0.0, 12.0, 6001), np.exp(1j * math.pi / 6.0)
    waves = np.exp(-(along**3) / 3.0 - 1j * rho[:, None] * along * turn) * turn
    return np.asarray(2.0 * np.trapezoid(waves, along, axis=1).real)


@REFRACTED_RAYS.case(
    "A caustic", "Where neighbouring rays cross, the ray tube has no width and the intensity is infinite.",
    "worst error of the level near the caustic", "dB", "Sums the two rays, each by the width of its tube.", 20.0,
    "Uses the uniform approximation with the Airy function.", 0.01)  # fmt: skip
def _caustic() -> Measured:
    rho = np.union1d(np.geomspace(1e-6, 0.1, 100), np.linspace(0.1, 6.0, 300))  # distance from the caustic
    exact = np.abs(_sum_waves(rho))
    amplitude, late = math.sqrt(math.pi) * rho**-0.25, 4.0 / 3.0 * rho**1.5
    added = np.abs(amplitude + amplitude * np.exp(1j * (late - 0.5 * math.pi)))
    own = airy_pressure(CARRIER, (0.0, late / (2.0 * math.pi * CARRIER)), (amplitude, amplitude))
    loud = exact > 0.1 * exact.max()  # within 20 dB
    picture = plot("distance from the caustic (argument ρ of the Airy function)", "pressure", rho, added, own, exact,
                   ylim=(0.0, 12.0))  # fmt: skip
    return Measured.by(lambda one: np.abs(20.0 * np.log10(one[loud] / exact[loud])).max(), added, own, picture)


FREQUENCIES, NARROWEST = (12e3, 120e3, 1e6), 0.02  # Hz; least width of a tube over its range
# A caustic 400 m away: m/rad² by which a tube grows over its front, and slowness across the ray, s/m per rad.
FOCUS, TUBE_GROWTH, SLOWNESS = 400.0, 20_000.0, 1.0 / 1500.0


@REFRACTED_RAYS.case(
    "A caustic at another frequency", "The width of a caustic depends on the wavelength, which rays do not have.",
    "worst error of the level, at 12 kHz, 120 kHz and 1 MHz", "dB", "Takes no tube as narrower than 2 % of its range.",
    6.0, "Uses the Airy function, averaged over an octave of frequency.", 0.2)  # fmt: skip
def _caustic_by_frequency() -> Measured:
    tubes, nodes, weights = np.geomspace(3.0, 110.0, 60), *np.polynomial.hermite_e.hermegauss(16)
    intensities: list[list[Floats]] = [[], [], []]
    for frequency in FREQUENCIES:
        slowness, waves = 2.0 * math.pi * frequency * SLOWNESS, np.zeros(tubes.size)
        for ratio, weight in zip(np.exp(OCTAVE * nodes), weights / weights.sum()):
            # Brekhovskikh and Godin, Acoustics of Layered Media II, ch. 6
            unit = math.sqrt(2.0) * TUBE_GROWTH ** (2.0 / 3.0) / (2.0 * (slowness * ratio) ** 2) ** (1.0 / 6.0)
            waves += weight / (math.pi * unit) * _sum_waves(np.minimum((tubes / unit) ** 2, 9.0)) ** 2
        focused = np.array([airy_field(tube, TUBE_GROWTH, slowness)[0].focus for tube in tubes])
        for kind, found in zip(intensities, (2.0 / np.maximum(tubes, NARROWEST * FOCUS), 2.0 * focused / tubes, waves)):
            kind.append(found)
    limited, own, exact = levels = [10.0 * np.log10(np.array(rows)) for rows in intensities]
    away = tubes**2 / (2.0 * TUBE_GROWTH)
    curves = (level.T for level in levels)
    picture = plot("distance from the caustic (m)", "intensity (dB)", away, *curves, log="x", ylim=(-32.0, -4.0))
    return Measured.by(lambda one: np.abs(one - exact).max(), limited, own, picture)


GRADIENT, HEIGHT = 0.05, 20.0  # 1/s; m of the sonar above the bed
TOUCHING = math.acos(1500.0 / 1501.0)  # launch angle of the ray that touches the bed


def _hits_by_steps(angles: Floats) -> Floats:
    """Ranges at which an integrator with adaptive steps finds that rays hit the bed."""

    def bend(_: float, ray: Floats) -> tuple[float, float, float]:
        return math.cos(ray[2]), math.sin(ray[2]), -GRADIENT / (1500.0 + GRADIENT * (ray[1] - 10.0)) * math.cos(ray[2])

    def touch(_: float, ray: Floats) -> float:
        return float(30.0 - ray[1])

    touch.terminal = True  # type: ignore[attr-defined]
    rays = [solve_ivp(bend, (0.0, 3000.0), (0.0, 10.0, angle), events=touch) for angle in angles]
    return np.array([float(ray.y_events[0][0][0]) if ray.t_events[0].size else math.nan for ray in rays])


@REFRACTED_RAYS.case("Steps past a touch",
    "An integrator with adaptive steps passes the point where a smooth ray touches the bed.",
    "error of the limiting range", "m", "Integrates with adaptive steps and an event at the bed.", 100.0,
    "Finds the grazing ray among exact arcs.", 0.05, scene="breaks-grazing")  # fmt: skip
def _touch() -> Measured:
    water, radius = load_scene("breaks-grazing").water, 1501.0 / GRADIENT
    limit = math.sqrt(2.0 * radius * HEIGHT - HEIGHT**2)  # √(2Rh − h²) with R = c at the bed over g
    above = np.geomspace(1e-9, 0.1, 24)
    hits = _hits_by_steps(TOUCHING + above)
    own = float(shadow_zones(water, 10.0, 30.0, max_range=3000.0, bottom=30.0)[0, 0])
    paths = ray_paths(water, 10.0, np.degrees(TOUCHING + above), max_range=3000.0, bottom=30.0)
    arcs = np.where(paths.hit.values, paths.range.values, 0.0).max(axis=1)
    picture = plot("launch angle below the grazing ray (rad)", "range of the hit, 0 if missed (m)", above,
                   np.nan_to_num(hits), arcs, limit, log="x")  # fmt: skip
    return Measured(abs(float(np.nanmax(hits)) - limit), abs(own - limit), picture)


def exact_time(across: float, depth: tuple[float, float]) -> Decimal:
    """Time between two points in one gradient, acosh(1 + g²(x² + Δz²)/(2 c₁ c₂))/g, with 50 digits."""
    with localcontext() as context:
        context.prec = 50
        g, c = Decimal(128) / 8000, [1500 + Decimal(128) / 8000 * Decimal(z) for z in depth]
        value = 1 + g * g * (Decimal(across) ** 2 + Decimal(depth[1] - depth[0]) ** 2) / (2 * c[0] * c[1])
        return (value + (value * value - 1).sqrt()).ln() / g


def _single_time(across: float, depth: tuple[float, float]) -> float:
    """Time by the same closed form in float32."""
    g, one = np.float32(0.016), np.float32(1.0)
    c = [np.float32(1500.0) + g * np.float32(z) for z in depth]
    square = np.float32(across) ** 2 + np.float32(depth[1] - depth[0]) ** 2
    return float(np.arccosh(one + g * g * square / ((one + one) * c[0] * c[1])) / g)


@REFRACTED_RAYS.case(
    "Travel time in float32", "Seven digits of a time of seconds do not resolve the phase of a 400 kHz carrier.",
    "worst error of the phase, from 1 to 5 km", "turns", "Takes the closed form in float32.", 0.1,
    "Keeps times in float64 in a form without cancellation.", 1e-6)  # fmt: skip
def _travel_time() -> Measured:
    deep, depth, across = profile([0.0, 8000.0], [1500.0, 1628.0]), (4000.0, 4100.0), np.linspace(1000.0, 5000.0, 41)
    times = [(_single_time(x, depth), float(eigenrays(deep, depth[0], x, depth[1]).time[0])) for x in across]
    off = [[abs(float(Decimal(t) - exact_time(x, depth))) * CARRIER for t in pair] for x, pair in zip(across, times)]
    plain, own = np.array(off).T
    shown = [np.maximum(each, 1e-12) for each in (plain, own)]
    picture = plot("range (m)", "error of the phase (turns)", across, *shown, log="y")
    return Measured.by(lambda errors: errors[::10].max(), plain, own, picture)


LAYERED_ECHOES = StabilityTheme("Echoes in layered water", 12)
# Sound slows down by 2 m/s per metre of depth: rays are arcs of circles, with closed forms.
SPEED, RATE, ALTITUDE = 1500.0, 2.0, 30.0
SLOWING = {
    "water": {"kind": "profile", "depth": [0.0, 45.0], "sound_speed": [SPEED + 10.0 * RATE, SPEED - 35.0 * RATE]},
    "seabed.depth": 40.0, "track.altitude": ALTITUDE, "sonar.range": 60.0, "sonar.bins": 600,
}  # fmt: skip
FACETS, HALF, EXPONENT = 400, 0.05, 400  # facets that face the sonar, half their length along the level, m, and lobe


def _cosines_from_slopes(table: Singles, low: float, x: Floats, z: Floats) -> Floats:
    """Cosines of the incidence, q dθ / ds, from launch angles that tables give, linear between their places."""
    u, v = x / COLUMN_STEP, (z - low) / ROW_STEP
    i, j = u.astype(int), v.astype(int)
    fu, fv = (u - i)[:, None], (v - j)[:, None]
    cells = table.astype(np.float64)
    near, far = ((1.0 - fu) * cells[row, i] + fu * cells[row, i + 1] for row in (j, j + 1))
    entry = ((1.0 - fv) * near + fv * far).T
    seen_x, seen_z = x * (1.0 + entry[LEVEL]), z + entry[RISE]
    q = (1.0 + entry[TUBE]) * np.hypot(seen_x, seen_z)
    return 0.5 * (q[1:] + q[:-1]) * np.diff(np.arctan2(seen_z, seen_x)) / np.hypot(np.diff(x), np.diff(z))


@LAYERED_ECHOES.case("An incidence from the slope of a table",
    "A table of positions with linear interpolation has slopes with errors of first order, and a narrow lobe takes "
    "the 400th power of the cosine that follows from them.",
    "worst error of a facet's lobe", "%", "Takes the incidence from the slopes of the table.", 20.0,
    "Takes it from the direction of arrival, which is tabulated too.", 0.5)  # fmt: skip
def _lobes() -> Measured:
    apparent, _ = make_apparent_tables(level_arrays(SLOWING), make_pose(0.0, 0.0, ALTITUDE))
    middle = np.linspace(0.4, 50.0, FACETS)
    # The arrival at the end of an arc of constant gradient: docs/theory/refraction.md.
    away = RATE * (middle**2 + ALTITUDE**2) / (2.0 * middle * (SPEED - RATE * ALTITUDE))
    slope = 1.0 / (ALTITUDE / middle + away)
    x = np.ravel(middle[:, None] + [-HALF, HALF])
    z = np.ravel(slope[:, None] * [-HALF, HALF]) - ALTITUDE
    # The table of this height, as the sonar is at a whole step.
    entries, knots = apparent.tables[0], empty_profile(4 * FACETS, np.float64)
    rows, columns, _ = entries.shape
    grid = TableGrid(True, 1.0, apparent.low - ALTITUDE, 1.0 / ROW_STEP, 1.0 / COLUMN_STEP, rows, columns)
    rises = np.diff(z) / np.diff(x)
    knots.x[: x.size], knots.z[: x.size] = x, z
    knots.slope[: x.size - 1], knots.area[: x.size - 1] = rises, 1.0 + rises**2
    apply_apparent_positions(entries, grid, True, knots, x.size)
    seen_x, seen_z = (0.5 * (ends[0 : x.size : 2] + ends[1 : x.size : 2]) for ends in (knots.x, knots.z))
    squared = knots.facing[0 : x.size - 1 : 2] ** 2 / (seen_x**2 + seen_z**2) / knots.area[0 : x.size - 1 : 2]
    by_slope = _cosines_from_slopes(entries, grid.low, x, z)[::2] ** 2
    plain, own = ((2.0 * each - 1.0) ** EXPONENT for each in (by_slope, squared))
    picture = plot("ground range (m)", "echo over the exact one", middle, plain, own, 1.0, ylim=(0.6, 2.2))
    return Measured.by(lambda echoes: worst(echoes, 1.0), plain, own, picture)


# Warm water on cold: sound that rises at less than 13 degrees is bent down again and arrives beyond 240 m.
DOUBLE = {
    "water": {"kind": "profile", "depth": [0.0, 12.0, 14.0, 54.0], "sound_speed": [1532.0, 1532.0, 1490.0, 1487.5]},
    "seabed.depth": 54.0, "track.altitude": 25.0, "sonar.range": 290.0, "sonar.bins": 2900, "sonar.ping_rate": 2.0,
}  # fmt: skip
TWICE = slice(2670, 2890)  # bins in which every echo arrives along several paths
RAYS, MANY_RAYS = 1 << 12, 1 << 20


@LAYERED_ECHOES.case("Pairs of paths binned one by one",
    "Where sound arrives along several paths, each pair of a ray out and a path back adds its echo to one bin.",
    "error of the record where every echo arrives along several paths", "%",
    "Puts the echo of each pair into the bin in which it arrives.", 10.0,
    "Spreads it over the range between neighbouring rays.", 0.5)  # fmt: skip
def _double() -> Measured:
    arrays, pose = first_ping(make_level_scene(DOUBLE))
    single, exact = (rays.trace(arrays, pose, rays=count)[0, 0, TWICE] for count in (RAYS, MANY_RAYS))
    sheet = ray_sheets.trace(arrays, pose, sheets=1, rays=RAYS)[0, 0, TWICE]
    picture = plot("slant range (m)", "echo over that of many rays", bin_centres(arrays)[TWICE], single / exact,
                   sheet / exact, 1.0, style=".", ylim=(0.6, 1.6))  # fmt: skip
    return Measured.by(lambda one: 100.0 * np.linalg.norm(one - exact) / np.linalg.norm(exact), single, sheet, picture)
