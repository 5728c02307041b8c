"""Failures of targets: walls that leak or count twice, intervals of angles that do not exist."""

import math

import numpy as np
from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Approach, Measured, Quantity, StabilityTheme, percent
from insonify.accuracy.stability.drawing import add_legend, common, faint, ours, panel, table
from insonify.accuracy.stability.level_scenes import (
    arrays_over,
    ball_at,
    error_message,
    level_arrays,
    make_level_scene,
    make_pose,
)
from insonify.arrays import Floats, Singles
from insonify.kernels.common.types import NO_DECAY
from insonify.simulation import simulate
from insonify.tracers import rays, sweep

THEME = StabilityTheme("Targets", 7)
RADIUS = 1.0


def _count_triangles(corners: Floats, origin: Floats, direction: Floats) -> int:
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


@THEME.case(
    "Edges that two walls share",
    "Rounding places a ray through an edge on neither of its two triangles, or on both.",
    Quantity("rays that do not meet exactly one wall", "%"),
    failing=Approach("Tests every triangle by itself in float32.", 5.0),
    right=Approach("Decides each edge once for both its triangles.", 0.0),
)
def _walls() -> Measured:
    rng = np.random.default_rng(3)
    box = {"kind": "box", "position": [0.0, 0.0, -10.0], "size": [3.0, 2.0, 1.5]}
    turned = box | {"heading": 31.0, "pitch": 17.0, "roll": 9.0}
    arrays = level_arrays({"targets": [turned], "track.start": [0.0, 30.0]})
    corners = arrays.mesh.corners
    centre = corners.mean(axis=(0, 1))
    # Rays from inside to edges and corners, each of which meets one wall.
    which, side = rng.integers(0, len(corners), 6000), rng.integers(0, 3, 6000)
    share = rng.random((6000, 1))
    ways = (1.0 - share) * corners[which, side] + share * corners[which, (side + 1) % 3] - centre
    met = np.array([_count_triangles(corners, centre, way) for way in ways])
    distance, what, _ = rays.cast(arrays, np.tile(centre, (6000, 1)), ways)
    off = np.abs(distance / np.linalg.norm(ways, axis=1) - 1.0)

    def draw(figure: Figure) -> None:
        around = np.degrees(np.arctan2(ways[:, 1], ways[:, 0]))
        up = np.degrees(np.arctan2(ways[:, 2], np.hypot(ways[:, 0], ways[:, 1])))
        one, two, none = met == 1, met > 1, met == 0
        axes = panel(
            ours(around[one], up[one], "one wall: all rays of this program", ".", markersize=1.5),
            faint(around[two], up[two], "two walls at once, in float32", ".", markersize=2.5),
            common(around[none], up[none], "none: a leak, in float32", ".", markersize=4.0),
            x="direction of the ray (°)", y="elevation (°)", title="rays from inside a box to its edges",
            xlim=(-185.0, 185.0), xticks=range(-180, 181, 90), legend="",
        )(figure)  # fmt: skip
        add_legend(axes, "center left", bbox_to_anchor=(1.0, 0.5), markerscale=4.0)

    return Measured(percent(met != 1), percent((what != 0) | (off > 1e-9)), draw)


AROUND = "around the sonar"
PLACES = {
    AROUND: (0.0, 0.3, -20.0),
    "under the bed": (0.0, 20.0, -33.0),
    "beneath the sonar": (0.0, 0.0, -28.0),
    "beyond the range": (0.0, 80.0, -29.0),
    "on the other side": (0.0, -20.0, -29.0),
}


def _shadow_interval(across: float, above: float, altitude: float) -> tuple[float, float]:
    """Slant ranges between which a ball hides the bed, H / sin(φ ± α); ``above`` is its centre's height."""
    d, phi = math.hypot(across, altitude - above), math.atan2(altitude - above, across)
    alpha = math.asin(RADIUS / d) if d >= RADIUS else math.nan
    return altitude / math.sin(phi + alpha), altitude / math.sin(phi - alpha)


def _is_right(name: str, record: Singles, bare: Singles) -> bool:
    """Whether the record of a ball at a place is right, compared with the record of the bare bed."""
    port, starboard = record
    if not (np.isfinite(port).all() and (record >= 0.0).all()):
        return False
    if name == "beneath the sonar":
        return bool(np.allclose(port, starboard, rtol=1e-4, atol=1e-6 * port.max()) and port[:200].any())
    if name == "under the bed":
        return bool(np.allclose(port, bare[0], rtol=0.02, atol=1e-4 * bare[0].max()))
    return np.array_equal(port, bare[0]) and (name != "on the other side" or not np.array_equal(starboard, bare[1]))


@THEME.case(
    "Targets in unusual places",
    "A sphere around the sonar covers no interval of angles; one behind it, below the bed or out of range covers "
    "none either.",
    Quantity("places with a wrong record", "of 5"),
    failing=Approach("Hides the bed from H / sin(φ + α) to H / sin(φ − α).", 2.0),
    right=Approach("Traces visible targets only, and reports a sonar inside a target as one sentence.", 0.0),
)
def _places() -> Measured:
    plain, own, rows = 0, 0, []
    bare = simulate(make_level_scene()).intensity.values[:, 0]
    for name, (x, y, z) in PLACES.items():
        near, far = _shadow_interval(y, z + 30.0, 10.0)
        lit = y < 0.0 or z + 30.0 < -RADIUS or y > 50.0
        plain += not (0.0 < near < far) or (lit and near < 50.0)
        scene = make_level_scene({"targets": [ball_at(x, y, z, RADIUS, material="rock")]})
        if name == AROUND:
            result = error_message(lambda scene=scene: simulate(scene))  # type: ignore[misc]
            own += "the sonar runs into it" not in result
        else:
            right = _is_right(name, simulate(scene).intensity.values[:, 0], bare)
            result = "right record" if right else "wrong record"
            own += not right
        shadow = f"shadow {near:.3g} to {far:.3g} m" if math.isfinite(near + far) else "no interval"
        rows.append((f"sphere {name}", shadow, result))
    return Measured(float(plain), float(own), table(("place", "H / sin(φ ± α)", "this program"), rows))


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
    """Energy of the same echo by the sweep, with the bed out of reach."""
    changes = {"targets": [ball_at(0.0, CENTRE[0], CENTRE[1] - 30.0, RADIUS)]}
    arrays = arrays_over(np.zeros((2, 2)), 1.0, x0=-1000.0, changes=changes)
    lobes = np.tile([0.2, 0.8, exponent], (arrays.reflectivity.shape[0], 1))
    arrays = arrays._replace(reflectivity=lobes, range_factor=np.ones(arrays.bins), range_decay=NO_DECAY)
    return float(sweep.trace(arrays, make_pose(0.0, 0.0, 10.0))[0, 0].sum())


@THEME.case(
    "A lobe narrower than a facet",
    "Along a facet of a round target the incidence changes by more than the width of a narrow specular lobe.",
    Quantity("error of the energy, exponents from 10 to 1000", "%"),
    failing=Approach("Takes the incidence in the middle of each facet.", 5.0),
    right=Approach("Averages the lobe over as many parts of a facet as its width requires.", 0.1),
)
def _glints() -> Measured:
    facets, exponents = 64, (10.0, 25.0, 100.0, 300.0, 1000.0)
    exact = [_echo_by_facets(exponent, 100_000) for exponent in exponents]
    plain = [100.0 * abs(_echo_by_facets(n, facets) / energy - 1.0) for n, energy in zip(exponents, exact)]
    own = [100.0 * abs(_echo_by_sweep(n) / energy - 1.0) for n, energy in zip(exponents, exact)]
    return Measured(max(plain), max(own), panel(
        common(exponents, plain, f"one incidence for each of {facets} facets", "o-"),
        ours(exponents, own, "this program", "o-"),
        x="exponent of the specular lobe", y="error of the energy (%)", title="echo of a sphere", log="xy",
    ))  # fmt: skip
