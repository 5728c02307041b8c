"""Failures of refraction: false and lost rays, caustics, steps past a grazing point, echoes along bent paths."""

import math
from decimal import Decimal, localcontext

import numpy as np
from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Approach, Measured, Quantity, StabilityTheme
from insonify.accuracy.stability.drawing import common, faint, inked, ours, panel
from insonify.accuracy.stability.level_scenes import level_arrays, make_level_scene, make_pose
from insonify.accuracy.stability.themes.water import profile
from insonify.acoustics.paths import airy_pressure, eigenrays, ray_paths, shadow_zones
from insonify.acoustics.resolution_cell import bin_centres
from insonify.arrays import Floats, Singles
from insonify.display.style import FAINT
from insonify.kernels.bed.profile import empty_profile
from insonify.kernels.rays.caustics import OCTAVE, airy_field
from insonify.kernels.refraction.apparent_positions import LEVEL, RISE, TUBE, TableGrid, apply_apparent_positions
from insonify.packing.apparent_tables import COLUMN_STEP, ROW_STEP, make_apparent_tables
from insonify.scene import load_scene
from insonify.simulation import prepare
from insonify.tracers import ray_sheets, rays

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


@REFRACTED_RAYS.case(
    "A shadow zone",
    "A bisection between a ray that falls short and one that overshoots converges even where no ray exists.",
    Quantity("rays reported where none exists", "of 5"),
    failing=Approach("Bisects forty times.", 4.0),
    right=Approach("Rejects a ray that misses the point.", 0.0),
)
def _shadow() -> Measured:
    beyond = (1700.0, 1800.0, 1900.0, 2000.0, 2200.0)
    found = [math.isfinite(_bisect(across)) for across in beyond]
    own = [eigenrays(DOWNWARD, SONAR, across, BED, bottom=BED).sizes["eigenray"] > 0 for across in beyond]
    begins = float(shadow_zones(DOWNWARD, SONAR, BED, max_range=2500.0, bottom=BED)[0, 0])
    angles = np.concatenate([-2.09 + np.linspace(0.0, 1.0, 8) ** 2, np.linspace(-0.5, 4.0, 10)])
    paths, wrong = (
        ray_paths(DOWNWARD, SONAR, each, max_range=2500.0, bottom=BED) for each in (angles, _bisect(2000.0))
    )
    return Measured(float(sum(found)), float(sum(own)), panel(
        faint(paths.range.values.T, paths.depth.values.T, linewidth=0.6),
        common(wrong.range.values[0], wrong.depth.values[0], "result of the bisection", linewidth=1.6),
        inked([2000.0], [BED], "target point", "x", markersize=7),
        ours([begins, 2500.0], [BED, BED], f"shadow from {begins:.1f} m on: no ray", linewidth=4.0),
        x="range (m)", y="depth (m)", xlim=(0.0, 2500.0), ylim=(BED + 2.0, 0.0), legend="upper right",
    ))  # fmt: skip


CHANNEL = profile([0.0, 60.0, 200.0], [1530.0, 1490.0, 1530.0])
FROM, TO, ACROSS = 50.0, 70.0, 4000.0


def _count_crossings() -> int:
    """Count the rays to a point by the sign changes of the depths that a dense fan of rays reaches."""
    fan = np.linspace(-12.5, 12.5, 20_001)
    depths = ray_paths(CHANNEL, FROM, fan, max_range=ACROSS, bottom=200.0, ranges=[ACROSS])
    at = np.where(depths.range.values[:, 0] == ACROSS, depths.depth.values[:, 0], np.nan)
    sides = np.sign(at - TO)
    return int((sides[:-1] * sides[1:] < 0.0).sum())


def _newton() -> int:
    """Search for a ray to the point by Newton's method from the straight line; return the number found, 0 or 1."""
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


@REFRACTED_RAYS.case(
    "Several rays to one point",
    "In a channel many rays join two points, and a search from the straight line finds one at most.",
    Quantity("rays lost", "%"),
    failing=Approach("Starts Newton's method from the straight line.", 50.0),
    right=Approach("Brackets every branch between the rays that graze a knot.", 0.0),
)
def _several() -> Measured:
    exact, found = _count_crossings(), eigenrays(CHANNEL, FROM, ACROSS, TO, bottom=200.0)
    count = found.sizes["eigenray"]
    paths = ray_paths(CHANNEL, FROM, found.angle.values, max_range=ACROSS, bottom=200.0)
    return Measured(100.0 * (exact - _newton()) / exact, 100.0 * abs(exact - count) / exact, panel(
        ours(paths.range.values.T, paths.depth.values.T, linewidth=0.7),
        inked([0.0, ACROSS], [FROM, TO], style="o", markersize=4),
        x="range (m)", y="depth (m)", title=f"{count} rays join the two points", ylim=(200.0, 0.0),
    ))  # fmt: skip


def _sum_waves(rho: Floats) -> Floats:
    """Pressure at distances ρ from a caustic, 2π Ai(−ρ), by the integral of all waves, ∫exp i(s³/3 − ρs) ds.

    Its two points of stationary phase are the rays. Along a path turned by 30° nothing oscillates.
    """
    along, turn = np.linspace(0.0, 12.0, 6001), np.exp(1j * math.pi / 6.0)
    waves = np.exp(-(along**3) / 3.0 - 1j * rho[:, None] * along * turn) * turn
    return np.asarray(2.0 * np.trapezoid(waves, along, axis=1).real)


@REFRACTED_RAYS.case(
    "A caustic",
    "Where neighbouring rays cross, the ray tube has no width and the intensity is infinite.",
    Quantity("worst error of the level near the caustic", "dB"),
    failing=Approach("Sums the two rays, each by the width of its tube.", 20.0),
    right=Approach("Uses the uniform approximation with the Airy function.", 0.01),
)
def _caustic() -> Measured:
    rho = np.union1d(np.geomspace(1e-6, 0.1, 100), np.linspace(0.1, 6.0, 300))  # distance from the caustic
    exact = np.abs(_sum_waves(rho))
    amplitude, late = math.sqrt(math.pi) * rho**-0.25, 4.0 / 3.0 * rho**1.5
    added = np.abs(amplitude + amplitude * np.exp(1j * (late - 0.5 * math.pi)))
    own = airy_pressure(CARRIER, (0.0, late / (2.0 * math.pi * CARRIER)), (amplitude, amplitude))
    loud = exact > 0.1 * exact.max()  # within 20 dB
    return Measured.by(lambda one: np.abs(20.0 * np.log10(one[loud] / exact[loud])).max(), added, own, panel(
        common(rho, added, "sum of two rays"),
        ours(rho, own, "uniform approximation", linewidth=2.2),
        inked(rho, exact, "exact integral", "--", linewidth=0.9),
        x="distance from the caustic (argument ρ of the Airy function)", y="pressure", xlim=(-0.05, 6.0),
        ylim=(0.0, 12.0),
    ))  # fmt: skip


FREQUENCIES, NARROWEST = (12e3, 120e3, 1e6), 0.02  # Hz; least width of a tube over its range
# A caustic 400 m away: m/rad² by which a tube grows over its front, and slowness across the ray, s/m per rad.
FOCUS, TUBE_GROWTH, SLOWNESS = 400.0, 20_000.0, 1.0 / 1500.0


@REFRACTED_RAYS.case(
    "A caustic at another frequency",
    "The width of a caustic depends on the wavelength, which rays do not have.",
    Quantity("worst error of the level, at 12 kHz, 120 kHz and 1 MHz", "dB"),
    failing=Approach("Takes no tube as narrower than 2 % of its range.", 6.0),
    right=Approach("Uses the Airy function, averaged over an octave of frequency.", 0.2),
)
def _caustic_by_frequency() -> Measured:
    tubes, nodes, weights = np.geomspace(3.0, 110.0, 60), *np.polynomial.hermite_e.hermegauss(16)
    levels: dict[str, list[Floats]] = {"limited": [], "airy": [], "waves": []}
    for frequency in FREQUENCIES:
        slowness = 2.0 * math.pi * frequency * SLOWNESS
        fields = [airy_field(tube, TUBE_GROWTH, slowness)[0].focus for tube in tubes]
        intensity = np.zeros(tubes.size)
        for ratio, weight in zip(np.exp(OCTAVE * nodes), weights / weights.sum()):
            # Brekhovskikh and Godin, Acoustics of Layered Media II, ch. 6
            unit = math.sqrt(2.0) * TUBE_GROWTH ** (2.0 / 3.0) / (2.0 * (slowness * ratio) ** 2) ** (1.0 / 6.0)
            intensity += weight / (math.pi * unit) * _sum_waves(np.minimum((tubes / unit) ** 2, 9.0)) ** 2
        levels["limited"].append(2.0 / np.maximum(tubes, NARROWEST * FOCUS))
        levels["airy"].append(2.0 * np.array(fields) / tubes)
        levels["waves"].append(intensity)
    limited, own, exact = (10.0 * np.log10(np.array(rows)) for rows in levels.values())
    away = tubes**2 / (2.0 * TUBE_GROWTH)
    return Measured.by(lambda one: np.abs(one - exact).max(), limited, own, panel(
        common(away, limited[0], "tubes limited to 2 % of the range, at every frequency"),
        ours(away, own[1:].T, linewidth=2.2),
        ours(away, own[0], "Airy function: 12 kHz (below), 120 kHz, 1 MHz", linewidth=2.2),
        inked(away, exact[1:].T, style="--", linewidth=0.9),
        inked(away, exact[0], "integral over all waves", "--", linewidth=0.9),
        x="distance from the caustic (m)", y="intensity (dB)", log="x", ylim=(-32.0, -4.0), legend="lower left",
    ))  # fmt: skip


GRADIENT, HEIGHT = 0.05, 20.0  # 1/s; m of the sonar above the bed
GRAZING = math.acos(1500.0 / 1501.0)


def _hits_by_steps(angles: Floats) -> Floats:
    """Ranges at which an integrator with adaptive steps finds that rays hit the bed."""
    from scipy.integrate import solve_ivp

    def bend(_: float, ray: Floats) -> tuple[float, float, float]:
        return math.cos(ray[2]), math.sin(ray[2]), -GRADIENT / (1500.0 + GRADIENT * (ray[1] - 10.0)) * math.cos(ray[2])

    def touch(_: float, ray: Floats) -> float:
        return float(30.0 - ray[1])

    touch.terminal = True  # type: ignore[attr-defined]
    rays = [solve_ivp(bend, (0.0, 3000.0), (0.0, 10.0, angle), events=touch) for angle in angles]
    return np.array([float(ray.y_events[0][0][0]) if ray.t_events[0].size else math.nan for ray in rays])


@REFRACTED_RAYS.case(
    "Steps past a touch",
    "An integrator with adaptive steps passes the point where a smooth ray touches the bed.",
    Quantity("error of the limiting range", "m"),
    failing=Approach("Integrates with adaptive steps and an event at the bed.", 100.0),
    right=Approach("Finds the grazing ray among exact arcs.", 0.05),
    scene="breaks-grazing",
)
def _touch() -> Measured:
    water, radius = load_scene("breaks-grazing").water, 1501.0 / GRADIENT
    limit = math.sqrt(2.0 * radius * HEIGHT - HEIGHT**2)  # √(2Rh − h²) with R = c at the bed over g
    above = np.geomspace(1e-9, 0.1, 24)
    hits = _hits_by_steps(GRAZING + above)
    found = np.isfinite(hits)
    own = float(shadow_zones(water, 10.0, 30.0, max_range=3000.0, bottom=30.0)[0, 0])
    paths = ray_paths(water, 10.0, np.degrees(GRAZING + above), max_range=3000.0, bottom=30.0)
    arcs = np.where(paths.hit.values, paths.range.values, 0.0).max(axis=1)
    return Measured(abs(float(np.nanmax(hits)) - limit), abs(own - limit), panel(
        ours(above, arcs, "exact arcs"),
        common(above[found], hits[found], "adaptive steps", "o", markersize=4),
        common(above[~found], np.full((~found).sum(), 0.0), "missed hit", "x", markersize=5),
        inked(None, limit, "limit, √(2Rh − h²)", "--", linewidth=0.8),
        x="launch angle below the grazing ray (rad)", y="range of the hit (m)", log="x", legend="center left",
    ))  # fmt: skip


def exact_time(across: float, depth: tuple[float, float]) -> Decimal:
    """Time between two points in one gradient, acosh(1 + g²(x² + Δz²)/(2 c₁ c₂))/g, with 50 digits."""
    with localcontext() as context:
        context.prec = 50
        g, c = Decimal(128) / 8000, [1500 + Decimal(128) / 8000 * Decimal(z) for z in depth]
        value = 1 + g * g * (Decimal(across) ** 2 + Decimal(depth[1] - depth[0]) ** 2) / (2 * c[0] * c[1])
        return (value + (value * value - 1).sqrt()).ln() / g


def _single_time(across: float, depth: tuple[float, float]) -> float:
    """Time by the same closed form in float32."""
    g = np.float32(0.016)
    c = [np.float32(1500.0) + g * np.float32(z) for z in depth]
    square = np.float32(across) ** 2 + np.float32(depth[1] - depth[0]) ** 2
    return float(np.arccosh(np.float32(1.0) + g * g * square / (np.float32(2.0) * c[0] * c[1])) / g)


@REFRACTED_RAYS.case(
    "Travel time in float32",
    "Seven digits of a time of seconds do not resolve the phase of a 400 kHz carrier.",
    Quantity("worst error of the phase, from 1 to 5 km", "turns"),
    failing=Approach("Takes the closed form in float32.", 0.1),
    right=Approach("Keeps times in float64 in a form without cancellation.", 1e-6),
)
def _travel_time() -> Measured:
    deep, depth, across = profile([0.0, 8000.0], [1500.0, 1628.0]), (4000.0, 4100.0), np.linspace(1000.0, 5000.0, 41)
    times = [(_single_time(x, depth), float(eigenrays(deep, depth[0], x, depth[1]).time[0])) for x in across]
    off = [[abs(float(Decimal(t) - exact_time(x, depth))) * CARRIER for t in pair] for x, pair in zip(across, times)]
    plain, own = np.array(off).T

    def draw(figure: Figure) -> None:
        axes = panel(
            common(across, np.maximum(plain, 1e-12), "float32"),
            ours(across, np.maximum(own, 1e-12), "float64, without cancellation"),
            faint(None, 0.5, style=":", linewidth=0.8),
            x="range (m)", y="error of the phase (turns)", log="y", legend="center right",
        )(figure)  # fmt: skip
        axes.text(1000.0, 0.6, "half a turn", fontsize=8, color=FAINT)

    return Measured(float(plain[::10].max()), float(own[::10].max()), draw)


LAYERED_ECHOES = StabilityTheme("Echoes in layered water", 12)
# Sound slows down by 2 m/s per metre of depth: rays are arcs of circles, with closed forms.
SPEED, RATE, ALTITUDE = 1500.0, 2.0, 30.0
SLOWING = {
    "water": {"kind": "profile", "depth": [0.0, 45.0], "sound_speed": [SPEED + 10.0 * RATE, SPEED - 35.0 * RATE]},
    "seabed.depth": 40.0,
    "track.altitude": ALTITUDE,
    "sonar.range": 60.0,
    "sonar.bins": 600,
}
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
    angles = np.diff(np.arctan2(seen_z, seen_x))
    return 0.5 * (q[1:] + q[:-1]) * angles / np.hypot(np.diff(x), np.diff(z))


@LAYERED_ECHOES.case(
    "An incidence from the slope of a table",
    "A table of positions with linear interpolation has slopes with errors of first order, and a narrow lobe takes "
    "the 400th power of the cosine that follows from them.",
    Quantity("worst error of a facet's lobe", "%"),
    failing=Approach("Takes the incidence from the slopes of the table.", 20.0),
    right=Approach("Takes it from the direction of arrival, which is tabulated too.", 0.5),
)
def _lobes() -> Measured:
    apparent, _ = make_apparent_tables(level_arrays(SLOWING), make_pose(0.0, 0.0, ALTITUDE))
    middle = np.linspace(0.4, 50.0, FACETS)
    # The arrival at the end of an arc of constant gradient: docs/theory/refraction.md.
    away = RATE * (middle**2 + ALTITUDE**2) / (2.0 * middle * (SPEED - RATE * ALTITUDE))
    slope = 1.0 / (ALTITUDE / middle + away)
    x = np.ravel(middle[:, None] + [-HALF, HALF])
    z = np.ravel(slope[:, None] * [-HALF, HALF]) - ALTITUDE
    # The table of this height, as the sonar is at a whole step.
    table, profile = apparent.tables[0], empty_profile(4 * FACETS, np.float64)
    rows, columns, _ = table.shape
    grid = TableGrid(True, 1.0, apparent.low - ALTITUDE, 1.0 / ROW_STEP, 1.0 / COLUMN_STEP, rows, columns)
    area = 1.0 + (np.diff(z) / np.diff(x)) ** 2
    profile.x[: x.size], profile.z[: x.size] = x, z
    profile.slope[: x.size - 1], profile.area[: x.size - 1] = np.diff(z) / np.diff(x), area
    apply_apparent_positions(table, grid, True, profile, x.size)
    seen_x, seen_z = (0.5 * (knots[0 : x.size : 2] + knots[1 : x.size : 2]) for knots in (profile.x, profile.z))
    squared = profile.facing[0 : x.size - 1 : 2] ** 2 / (seen_x**2 + seen_z**2) / profile.area[0 : x.size - 1 : 2]
    by_slope = _cosines_from_slopes(table, grid.low, x, z)[::2] ** 2
    plain, own = ((2.0 * each - 1.0) ** EXPONENT for each in (by_slope, squared))
    return Measured.by(lambda echoes: 100.0 * np.abs(echoes - 1.0).max(), plain, own, panel(
        common(middle, plain, "incidence from the slope of a table", ".", markersize=3),
        ours(middle, own, "incidence from the direction of arrival", ".", markersize=3),
        inked(None, 1.0, linewidth=0.6),
        x="ground range (m)", y="echo over the right one", ylim=(0.6, 2.2), legend="upper right",
    ))  # fmt: skip


# Warm water on cold: sound that rises at less than 13 degrees is bent down again and arrives beyond 240 m.
DOUBLE = {
    "water": {"kind": "profile", "depth": [0.0, 12.0, 14.0, 54.0], "sound_speed": [1532.0, 1532.0, 1490.0, 1487.5]},
    "seabed.depth": 54.0,
    "track.altitude": 25.0,
    "sonar.range": 290.0,
    "sonar.bins": 2900,
    "sonar.ping_rate": 2.0,
}
TWICE = slice(2670, 2890)  # bins in which every echo arrives along several paths
RAYS, MANY_RAYS = 1 << 12, 1 << 20


@LAYERED_ECHOES.case(
    "Pairs of paths binned one by one",
    "Where sound arrives along several paths, each pair of a ray out and a path back adds its echo to one bin.",
    Quantity("error of the record where every echo arrives along several paths", "%"),
    failing=Approach("Puts the echo of each pair into the bin in which it arrives.", 10.0),
    right=Approach("Spreads it over the range between neighbouring rays.", 0.5),
)
def _double() -> Measured:
    simulation = prepare(make_level_scene(DOUBLE))
    arrays, pose = simulation.arrays, simulation.poses(np.zeros(1, dtype=np.int64))
    single, exact = (rays.trace(arrays, pose, rays=count)[0, 0, TWICE] for count in (RAYS, MANY_RAYS))
    sheet = ray_sheets.trace(arrays, pose, sheets=1, rays=RAYS)[0, 0, TWICE]
    r = bin_centres(arrays)[TWICE]

    def error(record: Floats) -> float:
        return float(100.0 * np.linalg.norm(record - exact) / np.linalg.norm(exact))

    return Measured.by(error, single, sheet, panel(
        common(r, single / exact, "rays binned one by one", ".", markersize=3),
        ours(r, sheet / exact, "spread between neighbours", ".", markersize=3),
        inked(None, 1.0, linewidth=0.6),
        x="slant range (m)", y="echo over that of many rays", ylim=(0.6, 1.6), legend="upper right",
    ))  # fmt: skip
