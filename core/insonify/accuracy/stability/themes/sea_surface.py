"""Failures of paths by the sea surface: waves at a record's end, two beams taken apart, light at a body's edge."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel
from insonify.accuracy.stability.level_scenes import make_level_scene, make_pose, prepare_over_heights
from insonify.acoustics.resolution_cell import bin_centres
from insonify.acoustics.sea_surface import make_surface_multipath
from insonify.display.style import INK
from insonify.kernels.common.types import LIGHT, SceneArrays, still_water
from insonify.scene.water.surfaces import WAYS, FlatSurface, RoughSurface
from insonify.simulation import prepare
from insonify.tracers import sweep

Values = NDArray[np.float64]
ALTITUDE, DEPTH = 10.0, 20.0  # m, of the sonar over the bed and beneath the sea surface
RAISED = 2.0 * DEPTH  # m, of the sonar's image in the surface above the sonar
END, LAST = 40.0, 0.5  # m, end of a record, and how much of it is looked at
WIND = 8.0  # m/s
WIDTH, SQUINT = 4.0, 10.0  # °
CENTRE, RADIUS = (12.0, -9.0), 0.6  # m, of a ball: ground range, height above the sonar
FACETS, FINE_FACETS = 24, 100_000


def _ghost(arrays: SceneArrays, wind_speed: float = 0.0) -> Values:
    """Echo of one side out by the surface and back straight, (bins,), without the record's spreading."""
    switches = {way: way == "surface_bottom" for way in WAYS}
    sea = RoughSurface(**switches, wind_speed=wind_speed) if wind_speed > 0.0 else FlatSurface(**switches)
    bare = arrays._replace(range_factor=np.ones(arrays.bins))
    under = bare._replace(water=still_water(surface=ALTITUDE + DEPTH), multipath=make_surface_multipath(sea))
    pose = make_pose(0.0, 0.0, ALTITUDE)
    found = [sweep.trace(each, pose, planes=1)[0, 0].astype(np.float64) for each in (under, bare)]
    return np.asarray(found[0] - found[1])


def _pair_range(x: Values | float) -> Values:
    """Slant range of a level bed's echo out by the surface and back straight."""
    return 0.5 * np.asarray(np.hypot(x, ALTITUDE) + np.hypot(x, ALTITUDE + RAISED))


@lru_cache(maxsize=1)
def _waves() -> tuple[Values, Values, Values, Values]:
    """Slant range, and echoes of a level bed under waves: of what a calm sea brings in, of all, of a longer record."""
    scenes = [make_level_scene({"sonar.range": end, "sonar.bins": round(20.0 * end)}) for end in (END, END + 20.0)]
    short, long = (prepare_over_heights(scene, np.zeros((1201, 4)), 0.1, x0=-0.2, y0=0.0).arrays for scene in scenes)
    places = 0.1 * np.arange(1201, dtype=np.float64)
    seen = np.where(_pair_range(places) <= END, 0.0, np.nan)
    calm = prepare_over_heights(scenes[0], np.tile(seen[:, None], 4), 0.1, x0=-0.2, y0=0.0).arrays
    plain, own, right = (_ghost(arrays, WIND)[: short.bins] for arrays in (calm, short, long))
    return bin_centres(short), plain, own, right


def _missing_at_end(record: Values) -> float:
    last = _waves()[0] > END - LAST
    return float(100.0 * abs(record[last].sum() / _waves()[3][last].sum() - 1.0))


def _draw_waves(figure: Figure) -> None:
    r, plain, own, right = _waves()
    axes = add_panel(figure, x="slant range (m)", y="echo by the surface over that of a longer record")
    heard = right > 0.0
    axes.plot(r[heard], plain[heard] / right[heard], color=WRONG, label="bed up to the end over a calm sea")
    axes.plot(r[heard], own[heard] / right[heard], color=RIGHT, label="bed as far as waves bring it in")
    axes.set(xlim=(END - 5.0, END), ylim=(0.0, 1.2))
    add_legend(axes, "lower left")


@lru_cache(maxsize=1)
def _squinting() -> tuple[Values, Values, Values, Values]:
    """Slant range, and echo of a level bed: by azimuths of each leg, by one plane of the sweep, by common azimuths."""
    beam = {"kind": "gaussian", "width": WIDTH, "squint": SQUINT, "two_way": True}
    changes = {"sonar.beam": beam, "sonar.range": 60.0, "sonar.bins": 600}
    arrays = prepare(make_level_scene(changes)).arrays
    edges = np.linspace(0.0, 70.0, 7001)
    x = 0.5 * (edges[1:] + edges[:-1])
    near, far = np.hypot(x, ALTITUDE), np.hypot(x, ALTITUDE + RAISED)
    azimuth = math.pi * ((np.arange(2001) + 0.5) / 2001 - 0.5)
    half, extent = math.sin(math.radians(0.5 * WIDTH)), arrays.pattern.extent[0]
    off = [(x / leg)[:, None] * np.sin(azimuth) - math.sin(math.radians(SQUINT)) for leg in (near, far)]
    beams = [2.0 ** (-2.0 * (sine / half) ** 2) * (np.abs(sine) < extent) for sine in off]
    common = math.pi * np.sqrt(beams[0] * beams[1]).mean(axis=1)
    apart = math.pi * np.sqrt(beams[0].mean(axis=1) * beams[1].mean(axis=1))
    density = 2.0 * ALTITUDE * (ALTITUDE + RAISED) / math.pi * x * _pair_range(x) ** 4 / (near * far) ** 3
    borders = arrays.bin_length * np.arange(arrays.bins + 1)
    plain, right = (
        np.diff(np.interp(borders, _pair_range(edges), np.concatenate([[0.0], np.cumsum(density * taken * 0.01)])))
        for taken in (apart, common)
    )
    return bin_centres(arrays), plain, _ghost(arrays), right


def _energy_off(record: Values) -> float:
    return float(100.0 * abs(record.sum() / _squinting()[3].sum() - 1.0))


def _draw_squint(figure: Figure) -> None:
    r, plain, own, right = _squinting()
    axes = add_panel(figure, x="slant range (m)", y="echo by the surface")
    shown = r > _pair_range(0.0)
    axes.semilogy(r[shown], plain[shown], color=WRONG, label="azimuths of each leg by itself")
    axes.semilogy(r[shown], own[shown], color=RIGHT, label="one plane of this program")
    axes.semilogy(r[shown], right[shown], ":", color=INK, label="azimuths that both legs have")
    axes.set_ylim(right.max() * 1e-4, plain.max() * 2.0)
    add_legend(axes)


def _radiances(facets: int) -> tuple[Values, Values]:
    """Slant ranges at the ends of facets of a ball, and Lambert's radiance for both images in their middles.

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
    return legs(borders)[0], np.where(other > 0.0, one + other, 0.0)


def _light_by_facets(facets: int) -> float:
    ends, radiance = _radiances(facets)
    return float((radiance * np.abs(np.diff(ends))).sum())


@lru_cache(maxsize=1)
def _light_by_sweep() -> float:
    """Light of the same ball by the sweep, the bed out of reach."""
    ball = {"kind": "sphere", "position": [0.0, CENTRE[0], CENTRE[1] - DEPTH], "radius": RADIUS}
    scene = make_level_scene({"targets": [ball], "sonar.range": 60.0, "sonar.bins": 1200})
    arrays = prepare_over_heights(scene, np.zeros((2, 2)), 1.0, x0=-1000.0).arrays
    arrays = arrays._replace(law=LIGHT, reflectivity=np.tile([1.0, 0.0, 1.0], (arrays.reflectivity.shape[0], 1)))
    return float(_ghost(arrays).sum() * arrays.bin_length)


def _light_off(light: float) -> float:
    return 100.0 * abs(light / _light_by_facets(FINE_FACETS) - 1.0)


def _draw_light(figure: Figure) -> None:
    axes = add_panel(figure, x="slant range (m)", y="radiance for both images", title="a ball, surface-bottom path")
    for facets, colour, words in (
        (FACETS, WRONG, f"{FACETS} facets, each as in its middle"),
        (FINE_FACETS, RIGHT, "the ball itself"),
    ):
        ends, radiance = _radiances(facets)
        axes.plot(np.ravel(np.column_stack([ends[:-1], ends[1:]])), np.repeat(radiance, 2), color=colour, label=words)
    add_legend(axes)


THEME = StabilityTheme("Paths by the sea surface", 13, (
    StabilityCase(
        "Waves at a record's end",
        "A wave trough shortens the way of an echo that over a calm sea comes after the record's end.",
        f"echo missing from the last {LAST:g} m of the record", "%",
        Approach("Follows the bed up to the end of the record over a calm sea.",
                 lambda: _missing_at_end(_waves()[1]), 5.0),
        Approach("Follows it as far as the lowest facet of the sea brings echoes in.",
                 lambda: _missing_at_end(_waves()[2]), 0.1),
        _draw_waves,
    ),
    StabilityCase(
        "Two legs of a squinting beam",
        "Out by the surface and back straight, a beam that squints meets other azimuths on either leg.",
        "error of the energy", "%",
        Approach("Takes the root of the product of the azimuths that each leg has by itself.",
                 lambda: _energy_off(_squinting()[1]), 100.0),
        Approach("Integrates the root of both responses over the azimuths that they share.",
                 lambda: _energy_off(_squinting()[2]), 0.05),
        _draw_squint,
    ),
    StabilityCase(
        "Light at a body's edge",
        "Under law light an echo counts the range it spans, which at the edge of a round body is a large part of it.",
        "error of the energy of a ball", "%",
        Approach(f"Takes the radiance in the middle of each of {FACETS} facets, and the whole facet if that is seen.",
                 lambda: _light_off(_light_by_facets(FACETS)), 0.5),
        Approach("Cuts facets where an image stops seeing them, and takes the mean radiance of their ends.",
                 lambda: _light_off(_light_by_sweep()), 0.05),
        _draw_light,
    ),
))  # fmt: skip
