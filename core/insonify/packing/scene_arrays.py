"""A scene as the arrays and numbers that kernels take."""

import math
import weakref
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from insonify.acoustics.beam_patterns import make_pattern
from insonify.acoustics.sea_surface import make_surface_multipath
from insonify.acoustics.water import absorption_coefficient, make_water, recording_speed
from insonify.arrays import Floats, Singles
from insonify.kernels.common.range_bins import mean_over_centre
from insonify.kernels.common.types import (
    EVERY_GRAZING,
    LIGHT,
    SONAR,
    BeamPattern,
    Bed,
    RangeDecay,
    SceneArrays,
    SegmentLimits,
)
from insonify.packing.targets import make_bodies
from insonify.scene import Scene
from insonify.terrain import AnyGround, EndlessGround, Ground
from insonify.tow.poses import sonar_height

STRIP = 8  # rows turned at once
MISPLACED = 0.003  # share of a bin's echo that a segment may add wrongly
VERTICAL_SHARE = 1.0 / 16.0  # of the vertical beam's half width: the angle that a segment may span
# Heights by their identity, and their transposed copy.
_SHARED: dict[int, tuple[weakref.ref[Singles], weakref.ref[Singles]]] = {}


def pack_scene(scene: Scene, ground: AnyGround) -> SceneArrays:
    """Pack a scene and its ground for the tracers; tiles of endless ground take the place of its bed."""
    solids, mesh, reflectivities = make_bodies(scene, ground)
    sonar = scene.sonar
    bed = make_bed(ground.around(scene.track.start, 0.0))
    water = make_water(scene, ground.datum, -math.inf if isinstance(ground, EndlessGround) else bed.low)
    sonar.check_ping_rate(water.reference)
    sonar.check_pulse_length(water.reference)
    scene.check_slice_length(bed.spacing)
    half_width, pattern = make_pattern(scene, water.reference)
    bin_length = sonar.range / sonar.bins / (recording_speed(scene, ground.datum) / water.reference)
    centres = (np.arange(sonar.bins, dtype=np.float64) + 0.5) * np.float64(bin_length)
    depth = sonar_height(scene, ground) + ground.datum
    loss = 4.0 * absorption_coefficient(scene.water.absorption, sonar.frequency, abs(depth)) * bin_length
    decay = RangeDecay(4.0 if sonar.law == "sonar" else 0.0, loss)
    return SceneArrays(
        bed=bed,
        solids=solids,
        mesh=mesh,
        reflectivity=np.array([row[:3] for row in reflectivities], dtype=np.float64),
        interface=np.array([(row.reflection, row.speed_ratio) for row in reflectivities], dtype=np.float64),
        law=SONAR if sonar.law == "sonar" else LIGHT,
        half_width=half_width,
        pattern=pattern,
        bins=sonar.bins,
        bin_length=bin_length,
        range_factor=range_factor(scene, centres, depth) * mean_over_centre(sonar.bins, decay),
        range_decay=decay,
        limits=make_limits(ground.reflectivities, pattern, bin_length),
        bounces=sonar.bounces,
        water=water,
        multipath=make_surface_multipath(scene.water.surface),
    )


def make_bed(ground: Ground) -> Bed:
    """Bed of a ground's heights for the kernels, stored row by row and column by column."""
    heights = np.ascontiguousarray(ground.heights, dtype=np.float32)
    return Bed(
        heights=heights,
        transposed=_transposed(heights),
        materials=np.ascontiguousarray(ground.materials, dtype=np.uint8),
        x0=float(ground.x0),
        y0=float(ground.y0),
        spacing=float(ground.spacing),
        periodic=bool(ground.periodic),
        low=float(np.fmin.reduce(heights, axis=None)),
        high=float(np.fmax.reduce(heights, axis=None)),
        mapped=len(ground.reflectivities) > 1,
    )


def make_limits(reflectivities: Iterable[Sequence[Any]], pattern: BeamPattern, bin_length: float) -> SegmentLimits:
    """How far the bed's segments may extend under a beam."""
    shininess = max((row[2] for row in reflectivities if row[1] > 0.0), default=0.0)
    angle = math.inf if pattern.vertical == EVERY_GRAZING else VERTICAL_SHARE * pattern.s_vertical
    return SegmentLimits(shininess, bin_length, angle, MISPLACED, True)


def _transposed(heights: Singles) -> Singles:
    """Transposed copy of heights that are not written to; beds of the same heights share it while one of them lives."""
    known, shared = _SHARED.get(id(heights), (None, None))
    if known is not None and shared is not None and known() is heights and (turned := shared()) is not None:
        return turned
    # Strip by strip: six times as fast as row by row, which misses the cache.
    turned = np.empty(heights.shape[::-1], dtype=heights.dtype)
    for first in range(0, len(heights), STRIP):
        turned[:, first : first + STRIP] = heights[first : first + STRIP].T
    number = id(heights)
    _SHARED[number] = weakref.ref(heights), weakref.ref(turned, lambda _: _SHARED.pop(number, None))
    return turned


def range_factor(scene: Scene, slant_range: Floats, depth: float) -> Floats:
    """Two-way spreading r⁻⁴ (law `sonar`; the light of law `light` does not spread) and absorption."""
    loss = absorption_coefficient(scene.water.absorption, scene.sonar.frequency, abs(depth))
    factor = np.exp(-4.0 * loss * slant_range)  # intensity, there and back
    return factor / slant_range**4 if scene.sonar.law == "sonar" else factor
