"""Failures of arithmetic: too few digits, unsafe compiler flags, the order of sums.

The functions compiled here are the only ones outside the kernels: they show what a compiler does.
"""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numba import njit, prange

from insonify.accuracy.stability.case import Approach, Measured, Quantity, StabilityTheme, percent
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, common, faint, inked, ours, panel, table
from insonify.accuracy.stability.level_scenes import ball_at, error_message, level_arrays, make_ground, make_level_scene
from insonify.arrays import Floats, Singles
from insonify.compiler.jit import FAST
from insonify.scene import load_scene
from insonify.simulation import prepare
from insonify.terrain import relief
from insonify.tow.poses import take_poses
from insonify.tracers import rays, sweep

THEME = StabilityTheme("Arithmetic", 11)


@THEME.case(
    "Large coordinates",
    "A float32 resolves a northing of millions of metres only to a quarter or half of a metre.",
    Quantity("worst error of the bed's height", "mm"),
    failing=Approach("Looks heights up by map coordinates in float32.", 20.0),
    right=Approach("Subtracts a local origin in float64.", 0.01),
    scene="breaks-terraces",
)
def _terraces() -> Measured:
    scene, cell = load_scene("breaks-terraces"), 0.1
    east, north = scene.world.origin or (0.0, 0.0)
    heights, along = relief(scene.seabed), np.linspace(1.0, 11.0, 2001)
    rows = np.arange(len(heights))
    exact = np.interp(along / cell, rows, heights[:, 0])
    place = ((north + along).astype(np.float32) - np.float32(north)) / np.float32(cell)
    single = np.interp(place, rows, heights[:, 0])
    own = make_ground(heights, cell, x0=east, y0=north).height_at(np.full(along.size, east), north + along)
    some = slice(0, 801)
    return Measured.by(lambda one: 1000.0 * np.abs(one - exact).max(), single, own, panel(
        common(along[some], single[some], "coordinates in float32", linewidth=1.4),
        ours(along[some], own[some], "local origin, float64", linewidth=1.4),
        x=f"northing − {north:,.0f} (m)".replace(",", " "), y="height (m)",
    ))  # fmt: skip


def _next_hit(origin: Floats, direction: Floats, centre: Floats, radius: float) -> Floats:
    """Distances to a sphere in front, by the quadratic formula; infinite where there is none."""
    offset = origin - centre
    half, rest = (offset * direction).sum(axis=1), (offset**2).sum(axis=1) - radius**2
    root = np.sqrt(np.maximum(half**2 - rest, 0.0))
    near, far = -half - root, -half + root
    hit = np.where(near > 0.0, near, far)
    return np.where((half**2 >= rest) & (hit > 0.0), hit, np.inf)


@THEME.case(
    "A ray that meets its own surface",
    "A reflected ray starts at a rounded point, as often inside the surface as outside.",
    Quantity("reflected rays that meet their own sphere again", "%"),
    failing=Approach("Starts at the hit and takes the next positive distance.", 10.0),
    right=Approach("Starts off the surface by a distance that scales with the coordinates.", 0.0),
)
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
    met, met_by_own = np.isfinite(again), (paths.bounce == 1) & (paths.what == 0)
    own = float(100.0 * met_by_own.sum() / max((paths.bounce == 0).sum(), 1))

    def draw(figure: Figure) -> None:
        x, _, z = (points - centre).T
        axes = panel(
            ours(x[~met], z[~met], "reflected away", ".", markersize=1.5),
            common(x[met], z[met], "met the sphere again", ".", markersize=1.5),
            x="east of the centre (m)", y="above the centre (m)", title="hits on a reflecting sphere", place=121,
            ylim=(-0.6, 1.5), legend="",
        )(figure)  # fmt: skip
        add_legend(axes, "upper right", markerscale=5.0)
        axes = panel(x="distance of that second hit (m)", y="rays", log="x", place=122)(figure)
        axes.hist(again[met], bins=np.logspace(-12, 1, 53).tolist(), color=WRONG)
        axes.set_title(f"this program: {own:g} %, whatever the distance", fontsize=9.5, color=RIGHT, loc="left")

    return Measured(percent(met), own, draw)


def _mean_of_known(values: Floats) -> float:
    """Mean of the values that are not NaN."""
    total, count = 0.0, 0
    for k in range(values.size):
        if math.isnan(values[k]):
            continue
        total += values[k]
        count += 1
    return total / count


@THEME.case(
    "Fast arithmetic",
    "A compiler that may assume that no value is NaN removes every check for NaN.",
    Quantity("error of a mean over nodes, some of them missing"),
    failing=Approach("Compiles with all flags of fast-math.", 0.0),
    right=Approach("Compiles with the kernels' flags, which all respect NaN.", 1e-12),
)
def _fast() -> Measured:
    values = np.ones(100)
    values[::7] = math.nan
    flags: tuple[Any, Any] = (True, FAST)
    plain, own = (float(njit(fastmath=each)(_mean_of_known)(values)) for each in flags)
    shown = f"{plain:g}" if math.isfinite(plain) else "not a number"
    return Measured(abs(plain - 1.0), abs(own - 1.0), panel(
        inked(np.arange(100), values, "known", ".", markersize=4),
        faint(np.flatnonzero(np.isnan(values)), np.ones(15), "missing", "x", markersize=4),
        ours(None, own, "mean, with the kernels' flags", linewidth=1.6),
        common([], [], f"mean, with all flags: {shown}"),
        x="node", y="value", ylim=(0.5, 1.9), legend="upper right",
    ))  # fmt: skip


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


@THEME.case(
    "An exception inside a parallel loop",
    "Numba drops an exception of a function that prange calls, and returns a partly filled array.",
    Quantity("results missing without an error", "%"),
    failing=Approach("Raises in a function that a parallel loop calls.", 5.0),
    right=Approach("Returns a status from every kernel and raises outside it.", 0.0),
)
def _dropped_exception() -> Measured:
    missing, records = _missing_results(), []
    pipe = {"kind": "pipe", "position": [20.0, 0.0, -20.0], "length": 10.0, "heading": 90.0}  # the sonar runs into it
    simulation = prepare(make_level_scene({"targets": [pipe], "track.pings": 512}))
    message = error_message(lambda: records.append(simulation.intensity(np.arange(512))))
    empty = [percent(record.sum(axis=(1, 2)) == 0.0) for record in records]
    fault = "a mistake in the last tenth of a parallel loop"
    row = (fault, f"returns; {missing:.0f} % of the results were never written", message)
    heads = "fault", "raised inside the loop", "status returned, raised above"
    return Measured(missing, sum(empty, 0.0), table(heads, [row]))


@THEME.case(
    "Threads and blocks",
    "A floating-point sum depends on its order, and the order depends on the number of threads.",
    Quantity("bins that depend on the number of threads", "%"),
    failing=Approach("Sums the shares of one worker and of four in float32.", 10.0),
    right=Approach("Traces each ping by itself with integer sums.", 0.0),
)
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
    return Measured(percent(alone != shared), max(percent(one != other) for other in others), panel(
        common(np.arange(200), (shared - alone) / alone, "float32, share by share", ".", markersize=4),
        ours(None, 0.0, "integers, ping by ping", linewidth=1.6),
        x="bin", y="change over the energy",
    ))  # fmt: skip
