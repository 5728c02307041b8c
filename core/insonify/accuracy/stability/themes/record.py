"""Failures of range bins, the receiver and arithmetic: inexact sums, unbounded areas, gain on noise, lost digits.

The functions compiled here are the only ones outside the kernels: they show what a compiler does.
"""

import math
from typing import Any

import numpy as np
from numba import njit, prange

from insonify.accuracy.stability.case import Measured, StabilityTheme, percent, worst
from insonify.accuracy.stability.drawing import plot, table
from insonify.accuracy.stability.level_scenes import (
    ball_at,
    error_message,
    level_arrays,
    make_ground,
    make_level_scene,
    make_pose,
    sweep_port,
)
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.acoustics.resolution_cell import bin_centres
from insonify.arrays import Floats, Singles
from insonify.compiler.jit import FAST
from insonify.display.normalisation import LevelBed, normalise
from insonify.display.picture import choose_contrast, colour_amplitudes
from insonify.kernels.common.scattering import bistatic_strength
from insonify.kernels.common.types import SONAR
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate
from insonify.terrain import relief
from insonify.tow.poses import take_poses
from insonify.tracers import rays, sweep

RANGE_BINS = StabilityTheme("Range bins", 4)
BINS, BIN = 3000, 0.05


def _sum_in_single_precision(edges: Floats, density: Floats) -> Floats:
    """Add up in float32 the steps of a density at the edges of its pieces."""
    steps = np.zeros(BINS + 1, dtype=np.float32)
    place = np.minimum((edges / BIN).astype(np.int64), BINS)
    np.add.at(steps, place[:-1], density.astype(np.float32))
    np.add.at(steps, place[1:], -density.astype(np.float32))
    return np.cumsum(steps[:BINS], dtype=np.float32).astype(np.float64)


def _level_bed(height: float, reach: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Pieces of a level bed: ends on the ground and in slant range, middles, and Lambert energy over their range."""
    x = np.arange(0.0, reach, 0.1)
    edges = np.hypot(x, height)
    middle = 0.5 * (edges[1:] + edges[:-1])
    return x, edges, middle, (height / middle) ** 2 / math.pi * np.diff(x) / np.diff(edges)


@RANGE_BINS.case("Range factors inside a float32 sum",
    "A float32 prefix sum includes spreading by r⁻⁴, so that far bins are smaller than the rounding errors of "
    "near ones.",
    "worst error beyond 110 m", "%", "Sums energies times r⁻⁴ in float32.", 100.0,
    "Sums energies as integers and applies range factors after the sum.", 0.5, scene="breaks-sums")  # fmt: skip
def _factors() -> Measured:
    arrays = prepare(load_scene("breaks-sums")).arrays
    x, edges, middle, energy = _level_bed(5.0, BINS * BIN)
    edges[x > 135.0] = BINS * BIN  # the bed ends there
    energy[x[1:] > 135.0] = 0.0
    exact, r = flat_bed_curve(arrays, 5.0), bin_centres(arrays)
    single = _sum_in_single_precision(edges, energy * BIN * middle**-4.0)
    own = sweep_port(arrays, make_pose(0.0, 0.0, 5.0))
    far, some = slice(2200, int(134.0 / BIN)), slice(110, None, 5)
    curves = np.abs(single[some]), own[some], exact[some]
    picture = plot("slant range (m)", "energy per bin", r[some], *curves, log="y")
    return Measured.by(lambda record: worst(record[far], exact[far]), single, own, picture)


@RANGE_BINS.case("Shadows that are not silent",
    "Floating-point steps that should cancel leave a remainder, so that shadows are bright or negative.",
    "bins of a shadow that are not zero", "%", "Sums float32 steps up and down.", 50.0,
    "Sums integers, which cancel exactly.", 0.0)  # fmt: skip
def _shadows() -> Measured:
    changes = {"targets": [{"kind": "sphere", "position": [0.0, 40.0], "radius": 3.0}]}
    arrays = level_arrays(changes | {"sonar.range": 100.0, "sonar.bins": 2000, "sonar.ping_rate": 5.0})
    phi, alpha = math.atan2(7.0, 40.0), math.asin(3.0 / math.hypot(40.0, 7.0))
    begins, ends = 10.0 / math.sin(phi + alpha), 10.0 / math.sin(max(phi - alpha, 1e-9))
    _, edges, middle, energy = _level_bed(10.0, 99.0)
    energy[(middle > begins) & (middle < ends)] = 0.0
    records = _sum_in_single_precision(edges, energy), sweep_port(arrays, make_pose(0.0, 0.0, 10.0))
    dark = slice(math.ceil(begins / BIN) + 3, min(math.floor(ends / BIN) - 3, 2000))
    shown = [record[dark] / record[: dark.start].max() for record in records]
    r = (np.arange(dark.start, dark.stop) + 0.5) * BIN
    picture = plot("slant range in the shadow (m)", "energy over the maximum", r, *shown)
    return Measured.by(lambda record: percent(record[dark] != 0.0), *records, picture)


def _cell_area(r: Floats | float, height: float, width: float, length: float) -> Any:
    """Area of the textbook's cell, φ r · cτ / (2 cos θ)."""
    with np.errstate(divide="ignore"):
        return width * r * length / np.sqrt(np.maximum(1.0 - (height / np.asarray(r)) ** 2, 0.0))


@RANGE_BINS.case("Nadir", "The cell length cτ/(2 cos θ) is infinite at normal incidence.",
    "error of the first return's energy", "dB", "Uses the textbook's cell area at the first return.", 60.0,
    "Spreads each segment of the bed over the bins that it spans.", 0.1)  # fmt: skip
def _nadir() -> Measured:
    fan, width = {"sonar.beam": {"kind": "fan", "width": 1.0}}, math.radians(1.0)
    arrays, pose = level_arrays(fan), make_pose(0.05, 0.02, 10.0)
    first = round(10.0 / arrays.bin_length)
    textbook = float(_cell_area(10.0, 10.0, width, arrays.bin_length)) / math.pi * 10.0**-4.0
    swept, exact = float(sweep_port(arrays, pose, planes=32)[first]), float(flat_bed_curve(arrays, 10.0)[first])
    fine = level_arrays(fan | {"sonar.range": 14.0, "sonar.bins": 1400})
    near = 10.0 + np.geomspace(1e-6, 1.0, 400)
    book = _cell_area(near, 10.0, width, fine.bin_length) * (10.0 / near) ** 2 / math.pi * near**-4.0
    own = bin_centres(fine)[1000:1100], sweep_port(fine, pose, planes=32)[1000:1100]
    picture = plot("slant range, 10 m above the bed (m)", "energy per bin", near, book, own, log="y")
    return Measured.by(lambda energy: abs(10.0 * math.log10(energy / exact)), textbook, swept, picture)


@RANGE_BINS.case("Range zero", "The first bin begins at slant range 0; neither 0 nor a silent bin has a logarithm.",
    "bins without a number", "%", "Adds 30 log r to decibels at the near edge of each bin.", 10.0,
    "Keeps linear intensities and takes ranges at bin centres.", 0.0)  # fmt: skip
def _range_zero() -> Measured:
    record = simulate(make_level_scene()).intensity.values[0, 0].astype(np.float64)
    r = np.arange(record.size) * 0.05
    with np.errstate(divide="ignore", invalid="ignore"):
        level = 10.0 * np.log10(record) + 30.0 * np.log10(r)
    noise = {"kind": "ambient", "level": 40.0}
    changes = {"receiver.tvg": "power", "receiver.source_level": 220.0, "receiver.noise": noise}
    own = simulate(make_level_scene(changes)).intensity.values
    shown = [np.isfinite(one).astype(float) for one in (level, own[0, 0])]
    picture = plot("slant range (m)", "whether the bin has a number", r, *shown, xlim=(0.0, 15.0))
    return Measured.by(lambda values: percent(~np.isfinite(values)), level, own, picture)


EMPTY: tuple[dict[str, Any], ...] = (
    {"sonar.range": 5.0, "sonar.bins": 50},  # ends before the bed begins
    {"sonar.range": 5.0, "sonar.bins": 1},
    {"sonar.bins": 1},
    {"track.pings": 1, "targets": []},
)


@RANGE_BINS.case("An empty record",
    "A record of one bin or ping, or one that ends before the bed begins, has no maximum to normalise by.",
    "such records shown wrongly", "of 4", "Divides by the loudest echo and takes logarithms.", 2.0,
    "Shows amplitudes relative to a level bed, dark where there is no bed.", 0.0)  # fmt: skip
def _empty() -> Measured:
    plain, wrong, rows = 0, 0, []
    for changes in EMPTY:
        scene = edit(make_level_scene(), changes)
        intensity = simulate(scene).intensity.values
        with np.errstate(divide="ignore", invalid="ignore"):
            lost = percent(~np.isfinite(10.0 * np.log10(intensity / intensity.max())))
        amplitude = normalise(intensity[:, 0], LevelBed(prepare(scene)).curves(np.zeros(1, dtype=np.int64))[0])
        shown = colour_amplitudes(amplitude, levels=choose_contrast(amplitude))
        plain += lost > 0.0
        wrong += not (np.isfinite(amplitude).all() and shown.shape[:2] == amplitude.shape)
        fields = ", ".join(f"{path.partition('.')[2] or path} = {value}" for path, value in changes.items())
        lit = f"{int((intensity > 0.0).sum())} of {intensity.size} bins with an echo, the others dark"
        rows.append((fields, f"{lost:.0f} % without a number", lit))
    return Measured(float(plain), float(wrong), table(rows))


RECEIVER = StabilityTheme("The receiver", 10)
ABSORPTION = 0.3  # dB/m, some 900 kHz
NOISY = {
    "sonar.range": 150.0, "sonar.bins": 1500, "sonar.ping_rate": 4.0, "track.pings": 24,
    "water.absorption": 1e3 * ABSORPTION, "receiver.noise": {"kind": "ambient", "level": -120.0},
}  # fmt: skip


@RECEIVER.case("Gain over noise", "Time-varied gain keeps rising where only noise is left.",
    "level of the last tenth of the record above the bed's", "dB", "Applies 40 log r + 2αr at every range.", 20.0,
    "Keeps the gain constant from the range where even a perfect bed is below the noise.", 3.0)  # fmt: skip
def _gain() -> Measured:
    tvg = {"receiver.tvg": {"kind": "power", "spreading": 40.0}}
    bare, gained = (simulate(make_level_scene(NOISY | more)) for more in ({}, tvg))
    r = bare.slant_range.values
    plain, own = (one.intensity.values.astype(np.float64).mean(axis=(0, 1)) for one in (bare, gained))
    plain = plain * 10.0 ** ((40.0 * np.log10(r) + 2.0 * ABSORPTION * r) / 10.0)
    picture = plot("slant range (m)", "intensity", r, plain, own, log="y")
    return Measured.by(lambda one: 10.0 * np.log10(one[1350:].mean() / one[100:500].max()), plain, own, picture)


def _albedos(incidences: Floats, shininess: float) -> tuple[Floats, Floats]:
    """Albedo by incidence, with the lobe as computer graphics defines it and with the normalised lobe."""
    cosine = (np.arange(120) + 0.5) / 120.0
    cosines, angles = (grid.ravel() for grid in np.meshgrid(cosine, 2.0 * math.pi * cosine))
    plain, own = [], []
    for incidence in incidences:
        arrives = math.cos(incidence)
        mirrored = cosines * arrives - np.sqrt(1.0 - cosines**2) * np.cos(angles) * math.sin(incidence)
        # Lambert and Phong, k_d/π + k_s max(0, R·V)ⁿ with k_d = k_s = ½, times the cosine of the outgoing direction.
        lobe = (0.5 / math.pi + 0.5 * np.maximum(mirrored, 0.0) ** shininess) * cosines
        leaves = [bistatic_strength(arrives, c, m, 0.5, 0.5, shininess, SONAR) for c, m in zip(cosines, mirrored)]
        plain.append(2.0 * math.pi * lobe.mean())
        own.append(2.0 * math.pi * np.mean(leaves) / arrives)
    return np.array(plain), np.array(own)


@RECEIVER.case(
    "A lobe without its norm", "Phong's lobe added to Lambert's law without a norm returns more energy than arrives.",
    "surplus over the incident energy", "", "Takes k_d/π + k_s cosⁿ with k_d + k_s = 1.", 0.3,
    "Normalises the lobe by its integral: a factor (n + 2)/2π.", 0.002)  # fmt: skip
def _lobe() -> Measured:
    degrees = np.arange(0.0, 81.0, 10.0)
    plain, own = (np.array(each).T for each in zip(*(_albedos(np.radians(degrees), n) for n in (1.0, 4.0))))
    picture = plot("incidence (°); n = 1 and 4", "share of the energy that is scattered", degrees, plain, own, 1.0)
    return Measured.by(lambda shares: max(shares.max(), 1.0) - 1.0, plain, own, picture)


ARITHMETIC = StabilityTheme("Arithmetic", 11)


@ARITHMETIC.case(
    "Large coordinates", "A float32 resolves a northing of millions of metres only to a quarter or half of a metre.",
    "worst error of the bed's height", "mm", "Looks heights up by map coordinates in float32.", 20.0,
    "Subtracts a local origin in float64.", 0.01, scene="breaks-terraces")  # fmt: skip
def _terraces() -> Measured:
    scene, cell = load_scene("breaks-terraces"), 0.1
    east, north = scene.world.origin or (0.0, 0.0)
    heights, along = relief(scene.seabed), np.linspace(1.0, 11.0, 2001)
    rows = np.arange(len(heights))
    place = ((north + along).astype(np.float32) - np.float32(north)) / np.float32(cell)
    exact, single = (np.interp(where, rows, heights[:, 0]) for where in (along / cell, place))
    own = make_ground(heights, cell, x0=east, y0=north).height_at(np.full(along.size, east), north + along)
    picture = plot("northing − local origin (m)", "height (m)", along, single, own, xlim=(1.0, 5.0))
    return Measured.by(lambda one: 1000.0 * np.abs(one - exact).max(), single, own, picture)


def _next_hit(origin: Floats, direction: Floats, centre: Floats, radius: float) -> Floats:
    """Distances to a sphere in front, by the quadratic formula; infinite where there is none."""
    offset = origin - centre
    half, rest = (offset * direction).sum(axis=1), (offset**2).sum(axis=1) - radius**2
    root = np.sqrt(np.maximum(half**2 - rest, 0.0))
    hit = np.where(-half - root > 0.0, -half - root, -half + root)
    return np.where((half**2 >= rest) & (hit > 0.0), hit, np.inf)


@ARITHMETIC.case("A ray that meets its own surface",
    "A reflected ray starts at a rounded point, as often inside the surface as outside.",
    "reflected rays that meet their own sphere again", "%",
    "Starts at the hit and takes the next positive distance.", 10.0,
    "Starts off the surface by a distance that scales with the coordinates.", 0.0)  # fmt: skip
def _self_hits() -> Measured:
    east, north = load_scene("breaks-terraces").world.origin or (0.0, 0.0)
    rng, centre, radius = np.random.default_rng(1), np.array([east, north, 5.0]), 1.0
    goals = centre + 0.9 * radius * rng.uniform(-0.5, 0.5, (4000, 3))
    origins = np.tile(centre + np.array([0.0, -12.0, 4.0]), (4000, 1))
    ways = goals - origins
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    points = origins + _next_hit(origins, ways, centre, radius)[:, None] * ways
    normals = (points - centre) / radius
    again = _next_hit(points, ways - 2.0 * (ways * normals).sum(axis=1, keepdims=True) * normals, centre, radius)
    mirror = {"name": "mirror", "diffuse": 0.0, "specular": 1.0, "reflection": 1.0}
    ball = ball_at(centre[0], centre[1], centre[2] - 30.0, radius, material=mirror)
    paths = rays.follow(level_arrays({"targets": [ball]}), origins, ways, 1, reach=40.0)
    met, (x, _, z) = np.isfinite(again), (points - centre).T
    own = float(100.0 * ((paths.bounce == 1) & (paths.what == 0)).sum() / max((paths.bounce == 0).sum(), 1))
    picture = plot("east of the centre (m)", "above the centre, hits met again (m)", x[met], z[met], style=".")
    return Measured(percent(met), own, picture)


def _mean_of_known(values: Floats) -> float:
    """Mean of the values that are not NaN."""
    total, count = 0.0, 0
    for k in range(values.size):
        if math.isnan(values[k]):
            continue
        total += values[k]
        count += 1
    return total / count


@ARITHMETIC.case("Fast arithmetic", "A compiler that may assume that no value is NaN removes every check for NaN.",
    "error of a mean over nodes, some of them missing", "", "Compiles with all flags of fast-math.", 0.0,
    "Compiles with the kernels' flags, which all respect NaN.", 1e-12)  # fmt: skip
def _fast() -> Measured:
    values = np.ones(100)
    values[::7] = math.nan
    flags: tuple[Any, Any] = (True, FAST)
    plain, own = (float(njit(fastmath=each)(_mean_of_known)(values)) for each in flags)
    rows = [("85 ones, 15 NaN: mean of the numbers", f"{plain:g}", f"{own:g}")]
    return Measured.by(lambda mean: abs(mean - 1.0), plain, own, table(rows))


def _root(value: float) -> float:
    """Square root that raises an error for negative numbers."""
    if value < 0.0:
        raise ValueError("negative")
    return math.sqrt(value)


def _missing_results() -> float:
    """Percentage of results that are missing when a call of a parallel loop raises; 0 if the error is raised."""
    compiled = njit(_root)

    @njit(parallel=True)
    def roots(values: Floats, out: Floats) -> None:
        for k in prange(values.size):
            out[k] = compiled(values[k])  # type: ignore[call-overload]

    values, out = np.ones(10_000), np.full(10_000, np.nan)
    values[-1000] = -1.0
    try:
        roots(values, out)
    except ValueError:
        return 0.0
    except SystemError:
        pass  # the calling thread ran that share: it stops with another error
    return percent(np.isnan(out))


@ARITHMETIC.case("An exception inside a parallel loop",
    "Numba drops an exception of a function that prange calls, and returns a partly filled array.",
    "results missing without an error", "%", "Raises in a function that a parallel loop calls.", 5.0,
    "Returns a status from every kernel and raises outside it.", 0.0)  # fmt: skip
def _dropped_exception() -> Measured:
    missing, records = _missing_results(), []
    pipe = {"kind": "pipe", "position": [20.0, 0.0, -20.0], "length": 10.0, "heading": 90.0}  # the sonar runs into it
    simulation = prepare(make_level_scene({"targets": [pipe], "track.pings": 512}))
    message = error_message(lambda: records.append(simulation.intensity(np.arange(512))))
    empty = [percent(record.sum(axis=(1, 2)) == 0.0) for record in records]
    row = "a mistake in the last tenth of a parallel loop", f"{missing:.0f} % of the results never written", message
    return Measured(missing, sum(empty, 0.0), table([row]))


@ARITHMETIC.case("Threads and blocks",
    "A floating-point sum depends on its order, and the order depends on the number of threads.",
    "bins that depend on the number of threads", "%", "Sums the shares of one worker and of four in float32.", 10.0,
    "Traces each ping independently with integer sums.", 0.0)  # fmt: skip
def _threads() -> Measured:
    rng = np.random.default_rng(2)
    energies, places = rng.random(20_000, dtype=np.float32), rng.integers(0, 200, 20_000)

    def add_up(workers: int) -> Singles:
        """Sum echoes into bins in float32: each worker a share, then one share after the other."""
        total = np.zeros(200, dtype=np.float32)
        for share, where in zip(np.array_split(energies, workers), np.array_split(places, workers)):
            part = np.zeros(200, dtype=np.float32)
            np.add.at(part, where, share)
            total += part
        return total

    bed = {"kind": "fractal", "beta": 1.4, "period": 25.6, "rms": 0.05}
    scene = make_level_scene({"seabed.relief": bed, "sonar.beam": "fan", "sonar.bins": 400, "track.pings": 48})
    simulation, pings = prepare(scene), np.arange(48)
    arrays, poses = simulation.arrays, simulation.poses(pings)
    one = sweep.trace(arrays, poses, planes=4, threads=1)
    blocks = [sweep.trace(arrays, take_poses(poses, pings[k : k + 7]), planes=4) for k in pings[::7]]
    others = [
        sweep.trace(arrays, poses, planes=4, threads=3),
        sweep.trace(arrays, take_poses(poses, pings[::-1]), planes=4)[::-1],
        np.concatenate(blocks),
    ]
    alone, shared = add_up(1), add_up(4)
    picture = plot("bin", "change over the energy", np.arange(200), (shared - alone) / alone, 0.0)
    return Measured(percent(alone != shared), max(percent(one != other) for other in others), picture)
