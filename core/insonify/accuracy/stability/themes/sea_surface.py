"""Failures of paths by the sea surface: waves at a record's end, two beams taken apart, light at a body's edge."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, Measured, StabilityTheme
from insonify.accuracy.stability.drawing import common, inked, ours, panel
from insonify.accuracy.stability.level_scenes import arrays_over, ball_at, level_arrays, make_pose, sweep_port
from insonify.acoustics.resolution_cell import bin_centres
from insonify.acoustics.sea_surface import make_surface_multipath
from insonify.kernels.common.types import LIGHT, SceneArrays, still_water
from insonify.scene.water.surfaces import WAYS, FlatSurface, RoughSurface

THEME = StabilityTheme("Paths by the sea surface", 13)
Values = NDArray[np.float64]
ALTITUDE, DEPTH = 10.0, 20.0  # m, of the sonar over the bed and beneath the sea surface
RAISED = 2.0 * DEPTH  # m, of the sonar's image in the surface above the sonar


def _surface_echo(arrays: SceneArrays, wind_speed: float = 0.0) -> Values:
    """Echo of one side out by the surface and back straight, (bins,), without the record's spreading."""
    switches = {way: way == "surface_bottom" for way in WAYS}
    sea = RoughSurface(**switches, wind_speed=wind_speed) if wind_speed > 0.0 else FlatSurface(**switches)
    bare = arrays._replace(range_factor=np.ones(arrays.bins))
    under = bare._replace(water=still_water(surface=ALTITUDE + DEPTH), multipath=make_surface_multipath(sea))
    pose = make_pose(0.0, 0.0, ALTITUDE)
    return sweep_port(under, pose, planes=1) - sweep_port(bare, pose, planes=1)


def _pair_range(x: Values | float) -> Values:
    """Slant range of a level bed's echo out by the surface and back straight."""
    return 0.5 * np.asarray(np.hypot(x, ALTITUDE) + np.hypot(x, ALTITUDE + RAISED))


END, LAST, WIND = 40.0, 0.5, 8.0  # m, end of a record, and how much of it counts; m/s


@THEME.case(
    "Waves at a record's end",
    "A wave trough shortens the way of an echo that over a calm sea comes after the record's end.",
    f"echo missing from the last {LAST:g} m of the record",
    "%",
    failing=Approach("Follows the bed up to the end of the record over a calm sea.", 5.0),
    right=Approach("Follows it as far as the lowest facet of the sea brings echoes in.", 0.1),
)
def _waves() -> Measured:
    def over(heights: Values, end: float) -> SceneArrays:
        changes = {"sonar.range": end, "sonar.bins": round(20.0 * end)}
        return arrays_over(heights, 0.1, x0=-0.2, y0=0.0, changes=changes)

    level = np.zeros((1201, 4))
    seen = np.where(_pair_range(0.1 * np.arange(1201, dtype=np.float64)) <= END, 0.0, np.nan)
    calm, short, long = over(np.tile(seen[:, None], 4), END), over(level, END), over(level, END + 20.0)
    plain, own, exact = (_surface_echo(arrays, WIND)[: short.bins] for arrays in (calm, short, long))
    r, lit = bin_centres(short), exact > 0.0
    last = r > END - LAST
    return Measured.by(lambda one: 100.0 * abs(one[last].sum() / exact[last].sum() - 1.0), plain, own, panel(
        common(r[lit], plain[lit] / exact[lit], "bed up to the end over a calm sea"),
        ours(r[lit], own[lit] / exact[lit], "bed as far as waves bring it in"),
        x="slant range (m)", y="echo by the surface over that of a longer record", xlim=(END - 5.0, END),
        ylim=(0.0, 1.2), legend="lower left",
    ))  # fmt: skip


WIDTH, SQUINT = 4.0, 10.0  # °


@THEME.case(
    "Two legs of a squinting beam",
    "Out by the surface and back straight, a beam that squints meets other azimuths on either leg.",
    "error of the energy",
    "%",
    failing=Approach("Takes the root of the product of the azimuths that each leg has by itself.", 100.0),
    right=Approach("Integrates the root of both responses over the azimuths that they share.", 0.05),
)
def _squint() -> Measured:
    beam = {"kind": "gaussian", "width": WIDTH, "squint": SQUINT, "two_way": True}
    arrays = level_arrays({"sonar.beam": beam, "sonar.range": 60.0, "sonar.bins": 600})
    edges = np.linspace(0.0, 70.0, 7001)
    x = 0.5 * (edges[1:] + edges[:-1])
    near, far = np.hypot(x, ALTITUDE), np.hypot(x, ALTITUDE + RAISED)
    azimuth = math.pi * ((np.arange(2001) + 0.5) / 2001 - 0.5)
    half, extent = math.sin(math.radians(0.5 * WIDTH)), arrays.pattern.extent[0]
    off = [(x / leg)[:, None] * np.sin(azimuth) - math.sin(math.radians(SQUINT)) for leg in (near, far)]
    beams = [2.0 ** (-2.0 * (sine / half) ** 2) * (np.abs(sine) < extent) for sine in off]
    common_azimuths = math.pi * np.sqrt(beams[0] * beams[1]).mean(axis=1)
    apart = math.pi * np.sqrt(beams[0].mean(axis=1) * beams[1].mean(axis=1))
    density = 2.0 * ALTITUDE * (ALTITUDE + RAISED) / math.pi * x * _pair_range(x) ** 4 / (near * far) ** 3
    borders = arrays.bin_length * np.arange(arrays.bins + 1)
    plain, exact = (
        np.diff(np.interp(borders, _pair_range(edges), np.concatenate([[0.0], np.cumsum(density * taken * 0.01)])))
        for taken in (apart, common_azimuths)
    )
    own, r = _surface_echo(arrays), bin_centres(arrays)
    shown = r > _pair_range(0.0)
    return Measured.by(lambda one: 100.0 * abs(one.sum() / exact.sum() - 1.0), plain, own, panel(
        common(r[shown], plain[shown], "azimuths of each leg by itself"),
        ours(r[shown], own[shown], "one plane of this program"),
        inked(r[shown], exact[shown], "azimuths that both legs have", ":"),
        x="slant range (m)", y="echo by the surface", log="y", ylim=(exact.max() * 1e-4, plain.max() * 2.0),
    ))  # fmt: skip


CENTRE, RADIUS = (12.0, -9.0), 0.6  # m, of a ball: ground range, height above the sonar
FACETS, FINE_FACETS = 24, 100_000


def _radiances(facets: int) -> tuple[Values, Values, float]:
    """Slant ranges at the ends of facets of a ball, Lambert's radiance for both images in their middles, and its sum.

    Facets are denser towards the edges; the radiance is 0 where the higher image sees nothing.
    """
    x, z = CENTRE
    distance, middle = math.hypot(x, z), math.atan2(z, x)
    edge = math.asin(RADIUS / distance)
    borders = -edge * np.cos(np.pi * np.arange(facets + 1) / facets)
    off = 0.5 * (borders[1:] + borders[:-1])

    def legs(angle: Values) -> tuple[Values, Values, Values]:
        root = np.sqrt(np.clip(RADIUS**2 - (distance * np.sin(angle)) ** 2, 0.0, None))
        near = distance * np.cos(angle) - root
        px, pz = near * np.cos(middle + angle), near * np.sin(middle + angle)
        far = np.hypot(px, pz - RAISED)
        facing = -((px - x) * px + (pz - z) * (pz - RAISED)) / (RADIUS * far)
        return 0.5 * (near + far), root / RADIUS, facing

    _, one, other = legs(off)
    ends, radiance = legs(borders)[0], np.where(other > 0.0, one + other, 0.0)
    return ends, radiance, float((radiance * np.abs(np.diff(ends))).sum())


@THEME.case(
    "Light at a body's edge",
    "Under law light an echo counts the range it spans, which at the edge of a round body is a large part of it.",
    "error of the energy of a ball",
    "%",
    failing=Approach(
        f"Takes the radiance in the middle of each of {FACETS} facets, and the whole facet if that is seen.", 0.5
    ),
    right=Approach("Cuts facets where an image stops seeing them, and takes the mean radiance of their ends.", 0.05),
)
def _light() -> Measured:
    ball = ball_at(0.0, CENTRE[0], CENTRE[1] - DEPTH, RADIUS)
    changes = {"targets": [ball], "sonar.range": 60.0, "sonar.bins": 1200}
    arrays = arrays_over(np.zeros((2, 2)), 1.0, x0=-1000.0, changes=changes)  # the bed is out of reach
    arrays = arrays._replace(law=LIGHT, reflectivity=np.tile([1.0, 0.0, 1.0], (arrays.reflectivity.shape[0], 1)))
    (ends, radiance, plain), (fine_ends, fine_radiance, exact) = _radiances(FACETS), _radiances(FINE_FACETS)
    own = float(_surface_echo(arrays).sum() * arrays.bin_length)
    return Measured.by(lambda energy: 100.0 * abs(energy / exact - 1.0), plain, own, panel(
        common(_corners(ends), np.repeat(radiance, 2), f"{FACETS} facets, each as in its middle"),
        ours(_corners(fine_ends), np.repeat(fine_radiance, 2), "the ball itself"),
        x="slant range (m)", y="radiance for both images", title="a ball, surface-bottom path",
    ))  # fmt: skip


def _corners(ends: Values) -> Values:
    """Both ends of each facet, facet by facet."""
    return np.ravel(np.column_stack([ends[:-1], ends[1:]]))
