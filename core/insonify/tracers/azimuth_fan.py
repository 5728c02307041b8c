"""Azimuth fan of a beam: azimuths of its planes, the sector that each stands for, and the ground range it reaches.

A beam is a cone about the fish's axis, which the planes sample. Derived in docs/theory/beam.md.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from insonify.arrays import Floats, Integers
from insonify.kernels.beam.azimuth_sector import TRANSITION
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.geometry.solids import highest_place
from insonify.kernels.sweep.plane_errors import LEAST_PLANES
from insonify.kernels.sweep.sweep import LOWEST, AzimuthFan, LaidPlanes
from insonify.tow.poses import take_poses
from insonify.tracers.target_planes import (
    divide_at_targets,
    find_pings_met,
    find_target_sectors,
    has_bodies,
    heights_of,
    split_pings,
)

FEW = 16  # planes, beyond which the approximations below shrink with the spacing of the planes
# Up to where cos θ reaches 1 - FORESHORTENED the beam's cone is followed azimuth by azimuth; beyond it the inner planes
# begin to stretch with it: a plane at azimuth φ stands for the beam direction φ cos θ. This misplaces targets by half
# of FORESHORTENED half widths or so, which more than STRETCHED planes would show: for these the share is smaller.
FORESHORTENED, STRETCHED = 0.1, 4
SPLAY = 0.4  # share of FORESHORTENED by which inner planes lie farther out than equal parts of the half width
# Growth of an outer sector from its beginning to its end, as a share: of the first sector, and at most. Sectors widen
# outwards, by which factor for few planes and for many: those near the bow reach few bins, and each costs a plane.
OUTER_GROWTH, MOST_GROWTH, WIDENING, LEAST_WIDENING = 0.3, 2.5, 1.5, 1.1
# Share of an outer sector's width by which its plane lies inwards of its middle: at most ranges it is filled in part.
INWARDS = 0.25
# Nearer than twice the altitude planes may lie farther apart, since a bin holds more of the bed there: up to this
# share of their number times their spacing.
COARSER = 0.2
SIDELOBE_STEP = 2.0  # spacing of the planes across sidelobes over that across the main lobe
SIDELOBE_GROWTH = 0.25  # growth of that spacing per distance from the main lobe
HEIGHTS_PER_OCTAVE = 16.0  # steps to which heights are rounded up
ROUNDED_DOWN = 2.0 ** (-1.0 / HEIGHTS_PER_OCTAVE)  # share of a step below it
PITCH_STEP = 0.5  # step to which pitches are rounded, in half widths of the main lobe
EVERYWHERE = 1e9  # near field per metre of height, beyond any range
NEAREST, NEAREST_OF_IMAGE = 0.01, 0.001  # ground range per height from which the beam's azimuths are looked at
GROUND_RANGES = 256  # at which the beam's azimuths are looked at


def lay_planes(
    arrays: SceneArrays, poses: Poses, planes: ArrayLike, across: ArrayLike = 0, laid_at: Floats | None = None
) -> LaidPlanes:
    """Lay the planes of the beams of pings.

    Parameters
    ----------
    arrays, poses : SceneArrays, Poses
        n pings.
    planes, across : int or (n,) int64
        Planes across the main lobe of each ping, and least number of them across each target in its beam.
    laid_at : (n,) float64, optional
        Heights by which a pattern's planes are laid, m; by default the heights of the poses.

    Returns
    -------
    LaidPlanes
        Of n pings.
    """
    planes, across = (np.broadcast_to(np.asarray(number, np.int64), poses.x.shape) for number in (planes, across))
    whole = _Laying(poses.x.size)
    for count, more in sorted(set(zip(planes.tolist(), across.tolist()))):
        places = np.flatnonzero((planes == count) & (across == more))
        some, at = take_poses(poses, places), None if laid_at is None else laid_at[places]
        for among, fan in _lay_alike(arrays, some, count, at):
            whole.add(fan, places[among])
        if more > 0 and arrays.half_width > 0.0 and has_bodies(arrays):
            # One plane stands for a whole beam that meets no target.
            for among, fan in _lay_alike(arrays, some, count if count > 1 else LEAST_PLANES, at, divided=True):
                for part in split_pings(arrays, places[among]):
                    whole.divide(fan, part, arrays, take_poses(poses, part), more, is_whole_beam=count == 1)
    return whole.laid


class _Laying:
    """Planes of pings that are laid fan by fan."""

    def __init__(self, pings: int) -> None:
        self.fans = [_no_planes()]
        self.first, self.last = np.zeros((2, pings), np.int64)
        self.size = 0

    @property
    def laid(self) -> LaidPlanes:
        columns: list[Any] = [np.concatenate(column) for column in zip(*self.fans)]
        return LaidPlanes(AzimuthFan(*columns), self.first, self.last)

    def add(self, fan: AzimuthFan, places: Integers, first: Any = 0, last: Any = None) -> None:
        """Give pings the planes of a fan, or each those from one place in it to another."""
        self.fans.append(fan)
        self.first[places] = self.size + first
        self.last[places] = self.size + (fan.azimuth.size if last is None else last)
        self.size += fan.azimuth.size

    def divide(
        self, fan: AzimuthFan, places: Integers, arrays: SceneArrays, poses: Poses, across: int, *, is_whole_beam: bool
    ) -> None:
        """Give pings that have targets in their beams planes of their own, divided from those of a fan."""
        sectors = find_target_sectors(arrays, poses, across)
        parts, counts = divide_at_targets(fan, sectors, heights_of(arrays, poses), across)
        if is_whole_beam:
            every = np.full((2, places.size), [[0], [fan.azimuth.size]])
            met = find_pings_met(arrays, poses, LaidPlanes(fan, *every))
            self.add(fan, places[met])
        ends, divided = np.cumsum(counts), counts > 0
        self.add(parts, places[divided], (ends - counts)[divided], ends[divided])


def _no_planes() -> AzimuthFan:
    return beam_planes(0.0, 1).take(slice(0))


def _lay_alike(
    arrays: SceneArrays, poses: Poses, planes: int, laid_at: Floats | None, divided: bool = False
) -> list[tuple[Integers, AzimuthFan]]:
    """Lay the planes of a scene's beam wherever targets are: fans with the pings that share them."""
    if planes == 1 and arrays.half_width > 0.0:
        return [(np.arange(poses.x.size), _whole_beam(arrays))]
    if not arrays.pattern.tabulated or arrays.half_width <= 0.0:
        return [(np.arange(poses.x.size), beam_planes(arrays.half_width, planes, divided))]
    step = PITCH_STEP * arrays.half_width
    kinds, which = np.unique(
        np.column_stack(
            [
                _octave_steps(arrays, poses.z),
                _octave_steps(arrays, poses.z if laid_at is None else laid_at),
                np.round(poses.pitch / step),
                np.where(poses.pitch != 0.0, 0.5, 0.0),
            ]
        ),
        axis=0,
        return_inverse=True,
    )
    laid = []
    for number, (height, other, pitch, spread) in enumerate(kinds):
        pitches = step * np.unique([pitch - spread, pitch + spread])
        if arrays.multipath.enabled and not arrays.pattern.two_way:
            # A surface path is received if either of its directions is in the beam; the image is pitched the other way.
            pitches = np.unique([*pitches, *-pitches])
        own, at = (2.0 ** (float(step) / HEIGHTS_PER_OCTAVE) for step in (height, other))
        beam = pattern_planes(arrays, planes, own, pitches, at if spread == 0.0 else None)
        laid.append((np.flatnonzero(which.ravel() == number), beam))
    return laid


def _octave_steps(arrays: SceneArrays, z: Floats) -> Floats:
    """Heights above the lowest bed, rounded up to steps of octaves."""
    return np.asarray(np.ceil(np.log2(np.maximum(z - arrays.bed.low, LOWEST)) * HEIGHTS_PER_OCTAVE))


def lay_planes_of_images(
    arrays: SceneArrays, poses: Poses, planes: ArrayLike, across: ArrayLike = 0
) -> tuple[LaidPlanes, LaidPlanes]:
    """Lay the planes of the sonar and those of its image in the sea surface, a fish upside down, as `lay_planes`."""
    laid = lay_planes(arrays, poses, planes, across)
    if not arrays.multipath.enabled:
        return laid, laid
    image = poses._replace(z=2.0 * arrays.water.surface - poses.z, pitch=-poses.pitch, roll=-poses.roll)
    return laid, lay_planes(arrays, image, planes, across, poses.z)


def _whole_beam(arrays: SceneArrays) -> AzimuthFan:
    """Lay one plane along the axis of a beam, which stands for the whole beam."""
    half, pattern = arrays.half_width, arrays.pattern
    # s = cos θ sin φ, so that an integral over s is one over azimuths times cos θ cos φ, and x is r cos θ.
    squint = math.asin(min(max(pattern.centre, -1.0), 1.0))
    everything = (squint, -1.0, 1.0, 2.0 / max(math.cos(squint), 0.05), 0.0, math.inf, math.inf)
    fan = (0.0, 0.0, 1.0, math.pi, 2.0 * half, EVERYWHERE, math.inf)
    return AzimuthFan(*(np.array([value]) for value in (*(everything if pattern.tabulated else fan), False)))


@lru_cache(maxsize=64)
def beam_planes(half_width: float, planes: int, divided: bool = False) -> AzimuthFan:
    """Place the planes of a beam; planes to be divided follow its cone azimuth by azimuth at every range."""
    if half_width <= 0.0:
        return AzimuthFan(*(np.array([value]) for value in (0.0, 0.0, 1.0, 0.0, 0.0, math.inf, math.inf, False)))
    s_beam = math.sin(half_width)
    rough = min(FEW / planes, 1.0)
    level = 1.0 - FORESHORTENED * rough * min(STRETCHED / planes, 1.0)
    near_field = EVERYWHERE if divided else level / math.sqrt(1.0 - level * level)
    splayed = (1.0 + SPLAY * (1.0 - level)) * half_width
    # Sectors on one side; of an odd number of planes the first is halved, and stands for both halves.
    inner = np.append(0.0, splayed * np.arange(planes % 2 or 2, planes + 1, 2) / planes)
    edges, growth = [math.sin(splayed)], OUTER_GROWTH * rough * rough
    while edges[-1] < 1.0:
        edges.append(min(1.0, edges[-1] * (1.0 + growth)))
        growth = min(max(WIDENING**rough, LEAST_WIDENING) * growth, MOST_GROWTH * rough)
    azimuths = np.concatenate([inner, np.arcsin(edges[1:])])
    low, high = np.sin(azimuths[:-1]), np.sin(azimuths[1:])
    is_inner = np.arange(low.size) < inner.size - 1
    # cos θ = x / r <= s_beam / s_low bounds the ground range of an outer sector by the height.
    beyond = np.maximum(low**2 - s_beam**2, 1e-30)
    # A little farther: the segment that crosses the border counts by its middle.
    outer_reach = 1.02 * np.minimum(s_beam / np.sqrt(beyond), (1.0 + TRANSITION) * near_field)
    columns = (
        azimuths[:-1] + np.where(is_inner, 0.5, 0.5 - INWARDS * rough) * np.diff(azimuths),
        low,
        high,
        np.diff(azimuths),
        np.where(is_inner, 2.0 * half_width / planes, 0.0),
        np.full(low.size, near_field),
        np.where(is_inner, math.inf, outer_reach),
        np.zeros(low.size, np.bool_),
    )
    both = AzimuthFan(*columns).take(np.append(np.arange(low.size)[::-1], np.arange(low.size)))
    both.azimuth[: low.size] *= -1.0
    if planes % 2 == 0:
        return both
    both.azimuth[low.size], both.angle[low.size] = 0.0, 2.0 * both.angle[low.size]
    return both.take(np.arange(both.azimuth.size) != low.size - 1)


def pattern_planes(
    arrays: SceneArrays, planes: int, height: float, pitches: Floats, laid_at: float | None = None
) -> AzimuthFan:
    """Place the planes of a beam with a pattern, which may be turned, tipped and wider near by."""
    pattern = arrays.pattern
    outline = _Outline(
        centre=pattern.centre,
        extent=tuple(pattern.extent.tolist()),
        first_range=pattern.first_range,
        per_octave=pattern.per_octave,
        main=math.sin(arrays.half_width),
        reach=arrays.bins * arrays.bin_length,
        relief=arrays.bed.high - arrays.bed.low,
        highest=highest_place(arrays) - arrays.bed.low,
    )
    return _lay(outline, planes, height, tuple(pitches.tolist()), height if laid_at is None else laid_at)


class _Outline(NamedTuple):
    """Parts of a scene on which the planes of its beam pattern depend."""

    centre: float
    extent: tuple[float, ...]
    first_range: float
    per_octave: float
    main: float  # sine of half the main lobe
    reach: float  # m
    relief: float  # m, from the lowest bed to the highest
    highest: float  # m, from the lowest bed to the highest place of bed and targets


@lru_cache(maxsize=1024)
def _lay(outline: _Outline, planes: int, height: float, pitches: tuple[float, ...], laid_at: float) -> AzimuthFan:
    """Planes of an outline, kept from call to call: they stay the same while other things of a scene are edited."""
    cone = _Cone(outline, laid_at, np.array(pitches))
    start = math.asin(min(max(outline.centre, -1.0), 1.0))
    edges = [*reversed(_edges(cone, start, -1.0, planes)), start, *_edges(cone, start, 1.0, planes)]
    azimuths = np.array(edges)
    low, high = azimuths[:-1], azimuths[1:]
    laid = reaches = np.array([cone.reach_between(a, b) for a, b in zip(low, high)])
    if height != laid_at:
        own = _Cone(outline, height, np.array(pitches), NEAREST_OF_IMAGE)
        reaches = np.array([own.reach_between(a, b) for a, b in zip(low, high)])
    kept = np.append(np.flatnonzero(laid > 0.0), np.flatnonzero((laid == 0.0) & (reaches > 0.0)))
    low, high, reaches = low[kept], high[kept], reaches[kept]
    return AzimuthFan(
        azimuth=0.5 * (low + high),
        s_low=np.sin(low),
        s_high=np.sin(high),
        angle=high - low,
        far_angle=np.zeros(low.size),
        near_field=np.full(low.size, math.inf),
        reach=reaches / (height * ROUNDED_DOWN),
        apart=np.zeros(low.size, np.bool_),
    )


def _edges(cone: _Cone, start: float, way: float, planes: int) -> list[float]:
    """Edges of the azimuth sectors from an azimuth to the bow or the stern, rad."""
    edges: list[float] = []
    azimuth = start
    while way * azimuth < math.pi / 2.0:
        azimuth += way * cone.step(azimuth, planes)
        azimuth = min(max(azimuth, -math.pi / 2.0), math.pi / 2.0)
        edges.append(azimuth)
    return edges


class _Cone:
    """Azimuths that a beam takes in, ground range by ground range, over a level bed as low as any and one as high.

    There s = cos p · sin φ · x/r − sin p · h/r.
    """

    def __init__(self, outline: _Outline, height: float, pitches: Floats, nearest: float = NEAREST) -> None:
        above_highest = max(height - outline.relief, 0.0)
        # The lowest of the heights that are rounded up to this one reaches farthest out.
        lowest = max(height * ROUNDED_DOWN - outline.highest, 0.0)
        farthest = math.sqrt(max(outline.reach**2 - lowest**2, (0.1 * height) ** 2))
        self.height, self.main = height, outline.main
        self.x = np.geomspace(nearest * min(height, farthest), farthest, GROUND_RANGES)
        # One row for each height and pitch.
        h, p = (grid.reshape(-1, 1) for grid in np.meshgrid(np.unique([above_highest, height]), pitches))
        r = np.hypot(self.x, h)
        octaves = np.log2(np.maximum(r / outline.first_range, 1.0)) * outline.per_octave
        extent = np.interp(octaves, np.arange(len(outline.extent)), outline.extent)
        per_sine = r / (np.cos(p) * self.x)
        self.centre = outline.centre * per_sine + np.tan(p) * h / self.x
        self.main_half, self.half = outline.main * per_sine, extent * per_sine

    def step(self, azimuth: float, planes: int) -> float:
        """Width of the azimuth sector that begins at an azimuth, rad."""
        off = np.abs(math.sin(azimuth) - self.centre)
        cosine = max(math.cos(azimuth), 0.05)
        taken = np.flatnonzero((off <= self.main_half * 1.001).any(axis=0))
        covered = np.flatnonzero((off <= self.half).any(axis=0))
        if not covered.size:
            # Azimuths outside the beam at every range are skipped, up to the nearest one inside.
            return float(max((off - self.half).min(), SIDELOBE_STEP * 2.0 * self.main / planes) / cosine)
        if not taken.size:
            growth = SIDELOBE_GROWTH * (off - self.main_half).min()
            return float(max(SIDELOBE_STEP * 2.0 * self.main / planes, growth) / cosine)
        last = taken[-1]
        coarser = min(max(2.0 * self.height / self.x[last], 1.0), max(COARSER * planes, 1.0))
        return float(2.0 * self.main_half[:, last].min() / planes * coarser) / cosine

    def reach_between(self, low: float, high: float) -> float:
        """Greatest ground range at which any of an azimuth sector is in the beam, m; 0 if it is nowhere."""
        sine_low, sine_high = math.sin(low), math.sin(high)
        covered = ((sine_high >= self.centre - self.half) & (sine_low <= self.centre + self.half)).any(axis=0)
        places = np.flatnonzero(covered)
        if places.size == 0:
            return 0.0
        last = int(places[-1])
        # A little farther: the segment that crosses the border counts too. The slice ends at the range itself.
        return float(self.x[min(last + 2, self.x.size - 1)] * (1.0 if last + 2 < self.x.size else 1.1))
