"""Failures of targets: walls that leak or count twice, intervals of angles that do not exist."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_panel, write_table
from insonify.accuracy.stability.level_scenes import make_level_scene, make_pose, prepare_over_heights
from insonify.display.style import FAINT
from insonify.kernels.common.types import SceneArrays
from insonify.scene import SceneError
from insonify.simulation import prepare, simulate
from insonify.tracers import rays, sweep

Vectors = NDArray[np.float64]


@lru_cache(maxsize=1)
def _from_within() -> tuple[SceneArrays, Vectors, Vectors]:
    """Ball of triangles, and rays from inside it to its edges and corners, all of which meet it once."""
    rng = np.random.default_rng(3)
    box = {"kind": "box", "position": [0.0, 0.0, -10.0], "size": [3.0, 2.0, 1.5], "heading": 31.0, "pitch": 17.0}
    arrays = prepare(make_level_scene({"targets": [box | {"roll": 9.0}], "track.start": [0.0, 30.0]})).arrays
    corners = arrays.mesh.corners
    centre = corners.mean(axis=(0, 1))
    which, side = rng.integers(0, len(corners), 6000), rng.integers(0, 3, 6000)
    share = rng.random((6000, 1))
    goals = (1.0 - share) * corners[which, side] + share * corners[which, (side + 1) % 3]
    return arrays, np.tile(centre, (6000, 1)), goals - centre


def triangles_met(corners: Vectors, origin: Vectors, direction: Vectors) -> int:
    """Count the triangles that a ray meets (Möller and Trumbore), in float32, borders included."""
    a, b, c = (corners[:, k].astype(np.float32) for k in range(3))
    way, start = direction.astype(np.float32), origin.astype(np.float32)
    p = np.cross(way, c - a)
    determinant = ((b - a) * p).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = ((start - a) * p).sum(axis=1) / determinant
        q = np.cross(start - a, b - a)
        v, t = (q @ way) / determinant, ((c - a) * q).sum(axis=1) / determinant
    return int(((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0)).sum())


@lru_cache(maxsize=1)
def _walls_met() -> NDArray[np.int64]:
    """Walls that each ray meets, triangle by triangle."""
    arrays, origins, ways = _from_within()
    return np.array([triangles_met(arrays.mesh.corners, origin, way) for origin, way in zip(origins, ways)])


def _plain_walls() -> float:
    return float(100.0 * np.mean(_walls_met() != 1))


def _own_walls() -> float:
    arrays, origins, ways = _from_within()
    distance, what, _ = rays.cast(arrays, origins, ways)
    off = np.abs(distance / np.linalg.norm(ways, axis=1) - 1.0)
    return float(100.0 * np.mean((what != 0) | (off > 1e-9)))


PLACES: dict[str, Any] = {
    "around the sonar": [0.0, 0.3, -20.0],
    "under the bed": [0.0, 20.0, -33.0],
    "beneath the sonar": [0.0, 0.0, -28.0],
    "beyond the range": [0.0, 80.0, -29.0],
    "on the other side": [0.0, -20.0, -29.0],
}
RADIUS = 1.0


def shadow_interval(across: float, above: float, altitude: float) -> tuple[float, float]:
    """Slant ranges between which a ball hides the bed, H / sin(φ ± α); ``above`` is its centre's height."""
    d, phi = math.hypot(across, altitude - above), math.atan2(altitude - above, across)
    alpha = math.asin(RADIUS / d) if d >= RADIUS else math.nan
    with np.errstate(divide="ignore"):
        return altitude / math.sin(phi + alpha), altitude / math.sin(phi - alpha)


def _plain_intervals() -> float:
    """Count the places where that interval is none, or hides a bed that is in sight."""
    wrong = 0
    for _, y, z in PLACES.values():
        near, far = shadow_interval(y, z + 30.0, 10.0)
        lit = y < 0.0 or z + 30.0 < -RADIUS or y > 50.0
        wrong += not (0.0 < near < far) or (lit and near < 50.0)
    return float(wrong)


def _own_intervals() -> float:
    bare = simulate(make_level_scene()).intensity.values[:, 0]
    return float(sum(not _is_right(name, place, bare) for name, place in PLACES.items()))


def _ball(place: list[float]) -> dict[str, Any]:
    return {"kind": "sphere", "position": place, "radius": RADIUS, "material": "rock"}


def _is_right(name: str, place: list[float], bare: NDArray[np.float32]) -> bool:
    try:
        port, starboard = simulate(make_level_scene({"targets": [_ball(place)]})).intensity.values[:, 0]
    except SceneError as error:
        return name == "around the sonar" and "the sonar runs into it" in str(error)
    if not (np.isfinite(port).all() and (port >= 0.0).all() and (starboard >= 0.0).all()):
        return False
    if name == "beneath the sonar":
        return bool(np.allclose(port, starboard, rtol=1e-4, atol=1e-6 * port.max()) and port[:200].any())
    if name == "under the bed":
        return bool(np.allclose(port, bare[0], rtol=0.02, atol=1e-4 * bare[0].max()))
    return np.array_equal(port, bare[0]) and (name != "on the other side" or not np.array_equal(starboard, bare[1]))


def _draw_walls(figure: Figure) -> None:
    ways = _from_within()[2]
    met = _walls_met()
    axes = add_panel(
        figure, x="direction of the ray (°)", y="elevation (°)", title="rays from inside a box to its edges"
    )
    around = np.degrees(np.arctan2(ways[:, 1], ways[:, 0]))
    up = np.degrees(np.arctan2(ways[:, 2], np.hypot(ways[:, 0], ways[:, 1])))
    for meets, colour, size, words in (
        (met == 1, RIGHT, 1.5, "one wall: all rays of this program"),
        (met > 1, FAINT, 2.5, "two walls at once, in float32"),
        (met == 0, WRONG, 4.0, "none: a leak, in float32"),
    ):
        axes.plot(around[meets], up[meets], ".", color=colour, markersize=size, label=words)
    axes.set_xlim(-185.0, 185.0)
    axes.set_xticks(range(-180, 181, 90))
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8.5, markerscale=4.0)


def _draw_places(figure: Figure) -> None:
    rows = []
    bare = simulate(make_level_scene()).intensity.values[:, 0]
    for name, place in PLACES.items():
        near, far = shadow_interval(place[1], place[2] + 30.0, 10.0)
        shadow = f"shadow {near:.3g} to {far:.3g} m" if math.isfinite(near + far) else "no interval"
        rows.append((f"sphere {name}", shadow, "right record" if _is_right(name, place, bare) else "wrong record"))
    try:
        simulate(make_level_scene({"targets": [_ball(PLACES["around the sonar"])]}))
    except SceneError as error:
        rows[0] = (*rows[0][:2], str(error))
    write_table(figure, ("place", "H / sin(φ ± α)", "this program"), rows)


EXPONENTS = (10.0, 25.0, 100.0, 300.0, 1000.0)
FACETS, FINE_FACETS = 64, 100_000
CENTRE = (15.0, 0.6)  # ground range and height above the bed of a sphere's centre, m


def _echo_by_facets(exponent: float, facets: int) -> float:
    """Energy of a sphere's specular echo in a plane through its centre, one incidence per facet of launch angle."""
    distance = math.hypot(CENTRE[0], 10.0 - CENTRE[1])
    edge = math.asin(RADIUS / distance)
    border = -edge * np.cos(np.pi * np.arange(facets + 1) / facets)
    off = 0.5 * (border[1:] + border[:-1])
    sine = distance * np.sin(off) / RADIUS
    cosine = np.sqrt(1.0 - sine * sine)
    slant = distance * np.cos(off) - RADIUS * cosine
    lobe = np.clip(2.0 * cosine * cosine - 1.0, 0.0, None) ** exponent
    strength = cosine * cosine * (0.2 + 0.8 * 0.5 * (exponent + 2.0) * lobe) / np.pi
    return float((strength * slant / cosine * np.diff(border)).sum())


def _echo_by_sweep(exponent: float) -> float:
    """Energy of the same echo by the sweep of this program, the bed out of reach."""
    ball = {"kind": "sphere", "position": [0.0, CENTRE[0], CENTRE[1] - 30.0], "radius": RADIUS}
    simulation = prepare_over_heights(make_level_scene({"targets": [ball]}), np.zeros((2, 2)), 1.0, x0=-1000.0)
    arrays = simulation.arrays
    lobes = np.tile([0.2, 0.8, exponent], (arrays.reflectivity.shape[0], 1))
    arrays = arrays._replace(reflectivity=lobes, range_factor=np.ones(arrays.bins))
    return float(sweep.trace(arrays, make_pose(0.0, 0.0, 10.0))[0, 0].sum())


@lru_cache(maxsize=1)
def _glint_errors() -> tuple[list[float], list[float]]:
    """Errors of the energy for every exponent, in per cent: one incidence per facet, and this program."""
    right = [_echo_by_facets(n, FINE_FACETS) for n in EXPONENTS]
    plain = [100.0 * abs(_echo_by_facets(n, FACETS) / energy - 1.0) for n, energy in zip(EXPONENTS, right)]
    return plain, [100.0 * abs(_echo_by_sweep(n) / energy - 1.0) for n, energy in zip(EXPONENTS, right)]


def _draw_glints(figure: Figure) -> None:
    axes = add_panel(figure, x="exponent of the specular lobe", y="error of the energy (%)", title="echo of a sphere")
    plain, own = _glint_errors()
    axes.loglog(EXPONENTS, plain, "o-", color=WRONG, label=f"one incidence for each of {FACETS} facets")
    axes.loglog(EXPONENTS, own, "o-", color=RIGHT, label="this program")
    axes.legend(frameon=False, fontsize=8.5)


THEME = StabilityTheme("Targets", 7, (
    StabilityCase(
        "Edges that two walls share",
        "Rounding places a ray through an edge on neither of its two triangles, or on both.",
        "rays that do not meet exactly one wall", "%",
        Approach("Tests every triangle by itself in float32.", _plain_walls, 5.0),
        Approach("Decides each edge once for both its triangles.", _own_walls, 0.0),
        _draw_walls,
    ),
    StabilityCase(
        "Targets in odd places",
        "A sphere around the sonar covers no interval of angles; one behind it, below the bed or out of range covers "
        "none either.",
        "places with a wrong record", "of 5",
        Approach("Hides the bed from H / sin(φ + α) to H / sin(φ − α).", _plain_intervals, 2.0),
        Approach("Traces what is in sight, and refuses a sonar inside a target in one sentence.", _own_intervals, 0.0),
        _draw_places,
    ),
    StabilityCase(
        "A lobe narrower than a facet",
        "On a round target the incidence changes along a facet by more than a narrow specular lobe is wide.",
        "error of the energy, exponents from 10 to 1000", "%",
        Approach("Takes the incidence in the middle of each facet.", lambda: max(_glint_errors()[0]), 5.0),
        Approach("Averages the lobe, in as many parts as it asks for.", lambda: max(_glint_errors()[1]), 0.1),
        _draw_glints,
    ),
))  # fmt: skip
