"""Failures of arithmetic: too few digits, unsafe compiler flags, the order of sums."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.compiled import guarded_mean, swallowed
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel, write_table
from insonify.accuracy.stability.level_scenes import make_ground, make_level_scene
from insonify.display.style import FAINT, INK
from insonify.kernels.common.jit import FAST
from insonify.scene import SceneError, load_scene
from insonify.simulation import prepare
from insonify.terrain import relief
from insonify.tow.poses import take_poses
from insonify.tracers import rays, sweep

CELL = 0.1
ON_THE_MAP = load_scene("breaks-terraces")
EASTING, NORTHING = ON_THE_MAP.world.origin or (0.0, 0.0)
Points = NDArray[np.float64]


@lru_cache(maxsize=1)
def _bed_on_the_map() -> tuple[Points, Points]:
    """Heights of a rough bed, and places along a line over it."""
    return relief(ON_THE_MAP.seabed), np.linspace(1.0, 11.0, 2001)


def heights_in_single_precision(heights: Points, northing: Points) -> Points:
    """Heights along a line of the grid, looked up by map coordinates in float32."""
    place = (northing.astype(np.float32) - np.float32(NORTHING)) / np.float32(CELL)
    return np.interp(place, np.arange(len(heights)), heights[:, 0])


def _true_heights() -> Points:
    heights, along = _bed_on_the_map()
    return np.interp(along / CELL, np.arange(len(heights)), heights[:, 0])


def _own_heights() -> Points:
    heights, along = _bed_on_the_map()
    ground = make_ground(heights, CELL, x0=EASTING, y0=NORTHING)
    return ground.height_at(np.full(along.size, EASTING), NORTHING + along)


def _single_heights() -> Points:
    heights, along = _bed_on_the_map()
    return heights_in_single_precision(heights, NORTHING + along)


def _height_error(heights: Points) -> float:
    return float(1000.0 * np.abs(heights - _true_heights()).max())


def _draw_terraces(figure: Figure) -> None:
    along = _bed_on_the_map()[1]
    axes = add_panel(figure, x=f"northing − {NORTHING:,.0f} (m)".replace(",", " "), y="height (m)")
    some = slice(0, 801)
    axes.plot(along[some], _single_heights()[some], color=WRONG, linewidth=1.4, label="coordinates in float32")
    axes.plot(along[some], _own_heights()[some], color=RIGHT, linewidth=1.4, label="local origin, float64")
    add_legend(axes)


def next_hit(origin: Points, direction: Points, centre: Points, radius: float) -> Points:
    """Distances to a sphere in front, by the quadratic formula; infinite where there is none."""
    offset = origin - centre
    half, rest = (offset * direction).sum(axis=1), (offset**2).sum(axis=1) - radius**2
    root = np.sqrt(np.maximum(half**2 - rest, 0.0))
    near, far = -half - root, -half + root
    hit = np.where(near > 0.0, near, far)
    return np.where((half**2 >= rest) & (hit > 0.0), hit, np.inf)


@lru_cache(maxsize=1)
def _towards_a_ball() -> tuple[Points, Points, Points, float]:
    """Origins and directions of rays that meet a mirroring ball on the map, its centre and radius."""
    rng = np.random.default_rng(1)
    centre, radius = np.array([EASTING, NORTHING, 5.0]), 1.0
    goals = centre + 0.9 * radius * rng.uniform(-0.5, 0.5, (4000, 3))
    origins = np.tile(centre + np.array([0.0, -12.0, 4.0]), (4000, 1))
    ways = goals - origins
    return origins, ways / np.linalg.norm(ways, axis=1, keepdims=True), centre, radius


@lru_cache(maxsize=1)
def _met_again() -> Points:
    """Distance at which each ray, mirrored, meets its own ball again; infinite where it does not."""
    origins, ways, centre, radius = _towards_a_ball()
    points = origins + next_hit(origins, ways, centre, radius)[:, None] * ways
    normals = (points - centre) / radius
    mirrored = ways - 2.0 * (ways * normals).sum(axis=1, keepdims=True) * normals
    return next_hit(points, mirrored, centre, radius)


def _plain_self_hits() -> float:
    return float(100.0 * np.isfinite(_met_again()).mean())


def _own_self_hits() -> float:
    origins, ways, centre, radius = _towards_a_ball()
    ball = {"kind": "sphere", "position": [centre[0], centre[1], centre[2] - 30.0], "radius": radius}
    ball["material"] = {"name": "mirror", "diffuse": 0.0, "specular": 1.0, "reflection": 1.0}
    arrays = prepare(make_level_scene({"targets": [ball]})).arrays
    paths = rays.follow(arrays, origins, ways, 1, reach=40.0)
    again = (paths.bounce == 1) & (paths.what == 0)
    return float(100.0 * again.sum() / max((paths.bounce == 0).sum(), 1))


def _into_a_pipe() -> NDArray[np.float32]:
    """Record pings of a sonar that runs into a pipe."""
    pipe = {"kind": "pipe", "position": [20.0, 0.0, -20.0], "length": 10.0, "heading": 90.0}
    return prepare(make_level_scene({"targets": [pipe], "track.pings": 512})).intensity(np.arange(512))


def _own_swallowed() -> float:
    """Percentage of pings that are empty, without a word."""
    try:
        record = _into_a_pipe()
    except SceneError:
        return 0.0
    return float(100.0 * (record.sum(axis=(1, 2)) == 0.0).mean())


@lru_cache(maxsize=1)
def _many_echoes() -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Energies, and the bins they fall into."""
    rng = np.random.default_rng(2)
    return rng.random(20_000, dtype=np.float32), rng.integers(0, 200, 20_000)


def summed_by(workers: int) -> NDArray[np.float32]:
    """Sum echoes into bins in float32: each worker a share, then one share after the other."""
    energies, places = _many_echoes()
    total = np.zeros(200, dtype=np.float32)
    for share, where in zip(np.array_split(energies, workers), np.array_split(places, workers)):
        part = np.zeros(200, dtype=np.float32)
        np.add.at(part, where, share)
        total += part
    return total


def _plain_threads() -> float:
    return float(100.0 * np.mean(summed_by(1) != summed_by(4)))


def _own_threads() -> float:
    """Percentage of bins that differ with threads, with the size of blocks or with the order of the pings."""
    bed = {"kind": "fractal", "beta": 1.4, "period": 25.6, "rms": 0.05}
    scene = make_level_scene({"seabed.relief": bed, "sonar.beam": "fan", "sonar.bins": 400, "track.pings": 48})
    simulation = prepare(scene)
    pings = np.arange(48)
    poses = simulation.poses(pings)
    one = sweep.trace(simulation.arrays, poses, planes=4, threads=1)
    others = [
        sweep.trace(simulation.arrays, poses, planes=4, threads=3),
        sweep.trace(simulation.arrays, take_poses(poses, pings[::-1]), planes=4)[::-1],
        np.concatenate(
            [sweep.trace(simulation.arrays, take_poses(poses, pings[k : k + 7]), planes=4) for k in pings[::7]]
        ),
    ]
    return float(100.0 * max(np.mean(one != other) for other in others))


def _known(licences: object) -> float:
    """Error of a mean that passes over what is not known."""
    values = np.ones(100)
    values[::7] = math.nan
    return abs(guarded_mean(values, licences) - 1.0)


def _draw_self_hits(figure: Figure) -> None:
    origins, ways, centre, radius = _towards_a_ball()
    again = _met_again()
    points = origins + next_hit(origins, ways, centre, radius)[:, None] * ways - centre
    met = np.isfinite(again)
    axes = add_panel(
        figure, 121, x="east of the centre (m)", y="above the centre (m)", title="hits on a reflecting sphere"
    )
    axes.plot(points[~met, 0], points[~met, 2], ".", color=RIGHT, markersize=1.5, label="reflected away")
    axes.plot(points[met, 0], points[met, 2], ".", color=WRONG, markersize=1.5, label="met the sphere again")
    axes.set_ylim(-0.6, 1.5)
    axes.legend(loc="upper right", frameon=False, fontsize=8.5, markerscale=5.0)
    axes = add_panel(figure, 122, x="distance of that second hit (m)", y="rays")
    axes.set_xscale("log")
    axes.hist(again[met], bins=np.logspace(-12, 1, 53).tolist(), color=WRONG)
    axes.set_title(
        f"this program: {_own_self_hits():g} %, whatever the distance", fontsize=9.5, color=RIGHT, loc="left"
    )


def _draw_fast(figure: Figure) -> None:
    values = np.ones(100)
    values[::7] = math.nan
    axes = add_panel(figure, x="node", y="value")
    axes.plot(values, ".", color=INK, markersize=4, label="known")
    axes.plot(np.flatnonzero(np.isnan(values)), np.ones(15), "x", color=FAINT, markersize=4, label="missing")
    axes.axhline(guarded_mean(values, FAST), color=RIGHT, linewidth=1.6, label="mean, with the kernels' flags")
    plain = guarded_mean(values, True)
    shown = f"{plain:g}" if math.isfinite(plain) else "not a number"
    axes.plot([], [], color=WRONG, label=f"mean, with all flags: {shown}")
    axes.set_ylim(0.5, 1.9)
    add_legend(axes, "upper right")


def _draw_swallowed(figure: Figure) -> None:
    lost = f"returns; {swallowed():.0f} % of the results were never written"
    try:
        _into_a_pipe()
        said = ""
    except SceneError as error:
        said = str(error)
    asked = "a mistake in the last tenth of a parallel loop"
    write_table(figure, ("fault", "raised inside the loop", "status returned, raised above"), [(asked, lost, said)])


def _draw_threads(figure: Figure) -> None:
    axes = add_panel(figure, x="bin", y="change over the energy")
    one = summed_by(1)
    axes.plot((summed_by(4) - one) / one, ".", color=WRONG, markersize=4, label="float32, share by share")
    axes.axhline(0.0, color=RIGHT, linewidth=1.6, label="integers, ping by ping")
    add_legend(axes)


THEME = StabilityTheme("Arithmetic", 11, (
    StabilityCase(
        "Large coordinates",
        "A float32 resolves a northing of millions of metres to a quarter or half of a metre only.",
        "worst error of the bed's height", "mm",
        Approach("Looks heights up by map coordinates in float32.", lambda: _height_error(_single_heights()), 20.0),
        Approach("Subtracts a local origin in float64.", lambda: _height_error(_own_heights()), 0.01),
        _draw_terraces,
        "breaks-terraces",
    ),
    StabilityCase(
        "A ray that meets its own surface",
        "A reflected ray starts at a rounded point, as often inside the surface as outside.",
        "reflected rays that meet their own sphere again", "%",
        Approach("Starts at the hit and takes the next positive distance.", _plain_self_hits, 10.0),
        Approach("Starts off the surface by a distance that scales with the coordinates.", _own_self_hits, 0.0),
        _draw_self_hits,
    ),
    StabilityCase(
        "Fast arithmetic",
        "A compiler that may assume that no value is NaN removes every check for NaN.",
        "error of a mean over nodes, some of them missing", "",
        Approach("Compiles with all flags of fast-math.", lambda: _known(True), 0.0),
        Approach("Compiles with the kernels' flags, which all respect NaN.", lambda: _known(FAST), 1e-12),
        _draw_fast,
    ),
    StabilityCase(
        "An exception inside a parallel loop",
        "Numba drops an exception of a function that prange calls, and returns a partly filled array.",
        "results missing without an error", "%",
        Approach("Raises in a function that a parallel loop calls.", swallowed, 5.0),
        Approach("Returns a status from every kernel and raises outside it.", _own_swallowed, 0.0),
        _draw_swallowed,
    ),
    StabilityCase(
        "Threads and blocks",
        "A floating-point sum depends on its order, and the order on how work is shared.",
        "bins that depend on the number of threads", "%",
        Approach("Sums the shares of one worker and of four in float32.", _plain_threads, 10.0),
        Approach("Traces each ping by itself with integer sums.", _own_threads, 0.0),
        _draw_threads,
    ),
))  # fmt: skip
