"""How loud what comes by the sea surface is against the direct record, and what planes miss of it, in closed form.

Over a level bed a place at ground range x is heard out by one image of the sonar and back as by another, of the
heights a and b above the bed, at r = (R + R') / 2 with R² = x² + a² and R'² = x² + b², so that
R = r − (b² − a²) / 4r. Its strength, its width along the track, dx/dr and r⁴ / (R R')² are those of the sweep.
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
CELLS = 256  # of slant range at most
FAINTEST = 1e-12  # echo over the loudest that counts


class ImagePair(NamedTuple):
    """Two images of the sonar that make a way of the sound."""

    low: float  # height of the lower one above the bed, m
    high: float
    orders: int  # in which sound may take the two
    share: float  # of the energy that mirrors leave


class MultipathErrors:
    """Levels of some ways by the sea surface, and what planes miss of them.

    Parameters
    ----------
    scene : Scene
    view : View
        Its lengths.
    ways : iterable of str
        Those that are heard, without the surface's own echo, which is the same for any number of planes.
    steepness : float
        Rms slope of the bed.

    Attributes
    ----------
    shares : dict of str to float
        Of the whole record, root mean square beyond 1.4 altitudes, by way.
    direct : float
        That of the direct record, likewise.
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
        # A bed that sends back next to nothing aslant is told apart from none by so much alone.
        direct = np.maximum(direct, max(FAINTEST * max(level.max() for level in (direct, *by_way.values())), 1e-200))
        levels = {way: level / direct for way, level in by_way.items()}
        whole = _rms(1.0 + sum(levels.values()))
        self.direct = 1.0 / whole
        self.shares = {way: _rms(level) / whole for way, level in levels.items()}
        self._rise = self._by_rise(scene)

    def _by_rise(self, scene: Scene) -> float:
        """Error of a single plane, which tells nothing of how the bed rises across the beam beneath an image.

        Nor of how wide the beam is against what the first bin holds.
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
        """Error of each of ``laws.COUNTS`` planes, as shares of the record."""
        count = np.asarray(fitted_laws.COUNTS, dtype=np.float64)
        share, uneven = math.hypot(*self.shares.values()), 0.0 if self._even else fitted_laws.GHOSTS_UNEVEN
        if self._view.pattern not in fitted_laws.TABLED:
            few = min(fitted_laws.GHOSTS_FEW * self._rise, fitted_laws.GHOSTS_LEFT) * np.sqrt(2.0 / count)
            risen = np.where(count > 1, few, self._rise)
            return np.hypot(risen, share * uneven / np.sqrt(count))
        # The two images hear a place with different parts of the beam, of which few planes tell little.
        few = (
            fitted_laws.GHOSTS_TABLED * (2.0 if self._view.squint else 1.0) * (2.0 / count) ** fitted_laws.GHOSTS_ORDER
        )
        fewest = 1 if self._even else fitted_laws.GHOSTS_FEWEST
        return share * np.hypot(np.where(count > fewest, few, fitted_laws.GHOSTS_SINGLE), uneven / np.sqrt(count))

    def of_cells(self, length: float, lost: float) -> float:
        """Error of cells so long that they miss heights of so much, rms, both in metres.

        Beneath an image a bin holds much of the bed: there the least height moves echoes by bins, and any border of
        materials counts.
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
    """Images of a way."""
    altitude, lifted = view.altitude, 2.0 * scene.seabed.depth - view.altitude
    if way == "surface_bottom":
        return ImagePair(altitude, lifted, 2, 1.0)
    if way == "surface_bottom_surface":
        return ImagePair(lifted, lifted, 1, 1.0)
    return ImagePair(altitude, 2.0 * scene.seabed.depth + altitude, 2, _material(scene).reflection ** 2)


def _material(scene: Scene) -> Reflectivity:
    """Numbers of a bed's first material; they count by their ratios alone."""
    material = scene.seabed.material
    return material.materials[0].reflectivity


def _levels(pair: ImagePair, edges: Field, view: SceneSummary, of: Reflectivity) -> Field:
    """Energy of a way in each cell of slant range, without the record's 1/r⁴, to some scale."""
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
    # A squinting beam that hears a place as from one image may not hear it as from the other.
    overlaps = abs(view.squint) * (1.0 - low / high) < 2.0 * math.sin(view.half_width) if view.squint else True
    return np.asarray(pair.orders * pair.share * value * overlaps)


def _rms(levels: Field | float) -> float:
    return float(np.sqrt(np.mean(np.square(levels))))
