"""Levels of multipaths by the sea surface relative to the direct record, and their errors, in closed form.

Over a level bed sound reaches a point at ground range x from one image of the sonar and returns to another, at heights
a and b above the bed. The slant range is r = (R + R') / 2 with R² = x² + a² and R'² = x² + b², so that
R = r − (b² − a²) / 4r. Echo strength, width along the track, dx/dr and r⁴ / (R R')² are those of the sweep.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.error_range import ERROR_ALTITUDES
from insonify.planning import fitted_laws
from insonify.planning.scene_summary import SceneSummary
from insonify.scene import Scene
from insonify.scene.materials import Reflectivity

Field = NDArray[np.float64]
CELLS = 256  # greatest number of intervals of slant range
FAINTEST = 1e-12  # weakest echo that counts, over the loudest


class ImagePair(NamedTuple):
    """Two images of the sonar between which a multipath runs."""

    low: float  # height of the lower image above the bed, m
    high: float
    orders: int  # number of orders in which sound can take the two
    share: float  # of the energy left after mirror reflections


class MultipathErrors:
    """Levels of multipaths by the sea surface, and their errors with few planes or coarse cells.

    Parameters
    ----------
    scene : Scene
    view : SceneSummary
        Lengths of the scene.
    ways : iterable of str
        Multipaths received, without the surface's own echo, which is the same for any number of planes.
    steepness : float
        Rms slope of the bed.

    Attributes
    ----------
    shares : dict of str to float
        Root mean square of each multipath beyond 1.4 altitudes, as a share of the whole record.
    direct : float
        Root mean square of the direct record, as a share of the whole record.
    """

    def __init__(self, scene: Scene, view: SceneSummary, ways: list[str], steepness: float) -> None:
        self._view, self._steepness, self._even = view, steepness, len(scene.seabed.material.materials) == 1
        self._pairs = {way: _pair(way, scene, view) for way in ways}
        edges = np.linspace(
            min(ERROR_ALTITUDES * view.altitude, 0.9 * view.reach), view.reach, min(view.bins, CELLS) + 1
        )
        sonar = ImagePair(view.altitude, view.altitude, 1, 1.0)
        of = _material(scene)
        direct = _levels(sonar, edges, view, of)
        by_way = {way: _levels(pair, edges, view, of) for way, pair in self._pairs.items()}
        # The floor keeps levels finite over a bed that scatters next to nothing back at oblique incidence.
        direct = np.maximum(direct, max(FAINTEST * max(level.max() for level in (direct, *by_way.values())), 1e-200))
        levels = {way: level / direct for way, level in by_way.items()}
        whole = _rms(1.0 + sum(levels.values()))
        self.direct = 1.0 / whole
        self.shares = {way: _rms(level) / whole for way, level in levels.items()}
        self._rise = self._by_rise(scene)

    def _by_rise(self, scene: Scene) -> float:
        """Error of a single plane, which neglects how the bed rises across the beam beneath an image source.

        It also neglects the width of the beam relative to the ground range of the first bin.
        """
        view, surface = self._view, scene.water.surface
        waves = surface.rms_height
        smeared, total = max(view.bin_length, waves), 0.0
        for way, pair in self._pairs.items():
            beside = pair.low * math.sin(view.half_width)
            of_rise = fitted_laws.GHOSTS_RISE * self._steepness * beside / smeared
            of_width = fitted_laws.GHOSTS_WIDE * beside / math.sqrt(2.0 * pair.low * smeared)
            total += (self.shares[way] * min(math.hypot(of_rise, of_width), 1.0)) ** 2
        return 0.0 if view.light else math.sqrt(total)

    def of_planes(self) -> Field:
        """Error for each plane count in ``fitted_laws.COUNTS``, as a share of the record."""
        count = np.asarray(fitted_laws.COUNTS, dtype=np.float64)
        share, uneven = math.hypot(*self.shares.values()), 0.0 if self._even else fitted_laws.GHOSTS_UNEVEN
        if self._view.pattern not in fitted_laws.TABLED:
            few = min(fitted_laws.GHOSTS_FEW * self._rise, fitted_laws.GHOSTS_LEFT) * np.sqrt(2.0 / count)
            risen = np.where(count > 1, few, self._rise)
            return np.hypot(risen, share * uneven / np.sqrt(count))
        # A point lies in different parts of the beams of the two images, which few planes do not resolve.
        few = (
            fitted_laws.GHOSTS_TABLED * (2.0 if self._view.squint else 1.0) * (2.0 / count) ** fitted_laws.GHOSTS_ORDER
        )
        fewest = 1 if self._even else fitted_laws.GHOSTS_FEWEST
        return share * np.hypot(np.where(count > fewest, few, fitted_laws.GHOSTS_SINGLE), uneven / np.sqrt(count))

    def of_cells(self, length: float, lost: float) -> float:
        """Error of coarse cells, given their length and the rms height that they lose, both in metres.

        Beneath an image source a bin covers much of the bed: there a small height displaces echoes by bins, and any
        border of materials counts.
        """
        first = min(math.sqrt(2.0 * pair.low * self._view.bin_length) for pair in self._pairs.values())
        share = math.hypot(*self.shares.values())
        if not self._even:
            return 1.0
        of_length = fitted_laws.GHOSTS_CELL * length / first
        if self._steepness == 0.0:
            of_length = fitted_laws.GHOSTS_LEVEL * (length / first) ** 2
        return share * min(fitted_laws.GHOSTS_LOST * lost / self._view.bin_length + of_length, 1.0)


def _pair(way: str, scene: Scene, view: SceneSummary) -> ImagePair:
    """Images of the sonar between which a named multipath runs."""
    altitude, lifted = view.altitude, 2.0 * scene.seabed.depth - view.altitude
    if way == "surface_bottom":
        return ImagePair(altitude, lifted, 2, 1.0)
    if way == "surface_bottom_surface":
        return ImagePair(lifted, lifted, 1, 1.0)
    return ImagePair(altitude, 2.0 * scene.seabed.depth + altitude, 2, _material(scene).reflection ** 2)


def _material(scene: Scene) -> Reflectivity:
    """Reflectivity of a bed's first material; only ratios of its values matter."""
    material = scene.seabed.material
    return material.materials[0].reflectivity


def _levels(pair: ImagePair, edges: Field, view: SceneSummary, of: Reflectivity) -> Field:
    """Energy of a multipath in each interval of slant range, in arbitrary units, without the record's 1/r⁴."""
    apart = 0.25 * (pair.high**2 - pair.low**2)
    to_edges = np.sqrt(np.maximum((edges - apart / edges) ** 2 - pair.low**2, 0.0))
    to_edges[edges < 0.5 * (pair.low + pair.high)] = 0.0
    x, dx = 0.5 * (to_edges[1:] + to_edges[:-1]), np.diff(to_edges)
    low, high = np.hypot(x, pair.low), np.hypot(x, pair.high)
    sines = pair.low * pair.high / (low * high)
    mirrored = np.maximum(2.0 * sines - (x**2 + pair.low * pair.high) / (low * high), 0.0) ** of.shininess
    if view.light:
        lit = 0.5 * (pair.low / low + pair.high / high) * of.diffuse + of.specular * mirrored
        value = lit * (dx > 0.0)
    else:
        value = sines * (of.diffuse + 0.5 * (of.shininess + 2.0) * of.specular * mirrored) * dx
        value *= (0.25 * (low + high) ** 2 / (low * high)) ** 2
        value *= low if view.half_width > 0.0 else 1.0
    # A squinting beam that covers a point as seen from one image may not cover it as seen from the other.
    overlaps = abs(view.squint) * (1.0 - low / high) < 2.0 * math.sin(view.half_width) if view.squint else True
    return np.asarray(pair.orders * pair.share * value * overlaps)


def _rms(levels: Field | float) -> float:
    return float(np.sqrt(np.mean(np.square(levels))))
