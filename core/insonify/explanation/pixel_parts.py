"""Parts of the echo in one pixel, the range bins that the pulse brings into it, and the scene about it."""

from dataclasses import dataclass, replace

import numpy as np

from insonify.acoustics.pulses import Taps
from insonify.acoustics.resolution_cell import bin_centres
from insonify.arrays import Floats
from insonify.explanation.sound_paths import DIRECT, SURFACE, SonarPose, height_by_range, locate_sonar, trace_path
from insonify.explanation.words import name_materials, name_part
from insonify.kernels.common.types import SONAR, Poses, SceneArrays
from insonify.kernels.labels.echo_parts import Window
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.simulation import Simulation
from insonify.tow.poses import take_poses
from insonify.tracers.azimuth_fan import lay_planes
from insonify.tracers.echo_parts import EchoParts, find_direct_parts, find_echo_parts, take_central_plane

LOUD = 0.02  # share of a contributor's echo from which a ray is drawn to a part of it
MOST_RAYS = 12  # to the parts of one contributor


def pixel_window(arrays: SceneArrays, taps: Taps, pixel: int) -> Window:
    """Range bins with echoes that the pulse brings into a pixel."""
    late = np.arange(taps.weights.size) - taps.before
    # Beyond the last bin the echo keeps its last value, as in the receiver.
    source = np.minimum(pixel - late, arrays.bins - 1)
    within = source >= 0
    first, last = int(source[within].min()), int(source[within].max())
    share = np.zeros(last - first + 1)
    np.add.at(share, source[within] - first, taps.weights[within])
    return _weigh(arrays, first, share)


def whole_window(arrays: SceneArrays) -> Window:
    """All range bins of one side, each with weight 1."""
    return _weigh(arrays, 0, np.ones(arrays.bins))


def _weigh(arrays: SceneArrays, first: int, share: Floats) -> Window:
    bins = slice(first, first + share.size)
    spreading = bin_centres(arrays)[bins] ** -4.0 if arrays.law == SONAR else 1.0
    return Window(first, np.stack([share, share * spreading, share * arrays.range_factor[bins]]))


@dataclass(frozen=True, eq=False)
class PixelParts:
    """Parts of the echo in one pixel."""

    simulation: Simulation
    arrays: SceneArrays  # as traced, over the ground about the ping
    pose: Poses  # of the ping
    side: int
    window: Window  # bins that echo in the pixel
    sonar: SonarPose
    folded: bool  # whether refraction folds, so that parts are single rays
    parts: EchoParts

    def name(self, target: int, path: int = DIRECT) -> str:
        """Name of a source: a target, the bed or the sea surface."""
        if path == SURFACE:
            return "sea surface"
        return name_part(self.simulation.scene.targets[target], target) if target >= 0 else "bed"

    def material(self, row: int) -> str:
        """Name of a material by its row; empty where there is none."""
        return name_materials(self.simulation.scene, self.simulation.ground)[row] if row >= 0 else ""

    def segments(self, some: EchoParts) -> Floats:
        """Beginnings and ends of parts in local coordinates, (n, 2, 3) in metres."""
        ends = zip(some.azimuth, some.begin, some.end)
        return np.array([self.sonar.to_world(azimuth, np.stack(pair)) for azimuth, *pair in ends]).reshape(-1, 2, 3)

    def rays(self, some: EchoParts) -> tuple[Floats, ...]:
        """Paths of the sound to the loudest of some parts, in local coordinates."""
        loudest = np.argsort(some.value)[::-1][:MOST_RAYS]
        chosen = loudest[some.value[loudest] >= LOUD * some.value.sum()]
        rays = []
        for k in chosen if chosen.size else loudest[:1]:
            azimuth, launch = float(some.azimuth[k]), float(some.launch[k])
            flat = trace_path(self.arrays, self.sonar, int(some.path[k]), azimuth, launch, some.middle[k])
            rays.append(self.sonar.to_world(azimuth, flat))
        return tuple(rays)


def find_pixel_parts(simulation: Simulation, ping: int, side: int, pixel: int) -> PixelParts:
    """Find the parts of the echo in one pixel."""
    arrays, pose = arrays_at(simulation, ping)
    window, sonar = pixel_window(arrays, simulation.reception.taps, pixel), locate_sonar(simulation, pose, side)
    parts = find_echo_parts(arrays, pose, side, window, **simulation.plan.label_settings)
    _, folded = make_apparent_tables(arrays, pose)
    placed = _place_surface_parts(simulation, sonar, parts)
    return PixelParts(simulation, arrays, pose, side, window, sonar, bool(folded.any()), placed)


def arrays_at(simulation: Simulation, ping: int) -> tuple[SceneArrays, Poses]:
    """Scene over the ground about a ping, as traced, and the pose of the ping."""
    pose = simulation.poses(np.array([ping], dtype=np.int64))
    ((_, arrays),) = simulation.tiles.split(simulation.reduced, pose)
    return arrays, take_poses(pose, slice(0, 1))


def find_athwart_parts(arrays: SceneArrays, pose: Poses, side: int, planes: int) -> tuple[float, EchoParts | None]:
    """Azimuth of the plane along the axis of the beam, and the direct parts in it of any bin; None without a plane."""
    fan = lay_planes(arrays, pose, planes).of(0)
    if fan.azimuth.size == 0:
        return 0.0, None
    fan = take_central_plane(arrays, fan)
    return float(fan.azimuth[0]), find_direct_parts(arrays, pose, side, whole_window(arrays), fan)


def _place_surface_parts(simulation: Simulation, sonar: SonarPose, parts: EchoParts) -> EchoParts:
    """Parts with heights for those by way of the sea surface: the height of the bed there, or by the slant range."""
    unknown = np.flatnonzero(np.isnan(parts.begin[:, 1]))
    if not unknown.size:
        return parts
    place = parts.begin.copy()
    for k in unknown:
        x, path = float(place[k, 0]), int(parts.path[k])
        level = sonar.place[:2] + x * sonar.direction(float(parts.azimuth[k]))
        bed = float(simulation.ground.height_at(level[:1], level[1:])[0])
        if path == SURFACE:
            place[k] = 0.0, sonar.surface
        elif parts.target[k] >= 0 or not np.isfinite(bed):
            low = bed if np.isfinite(bed) else float(simulation.arrays.bed.low)
            place[k, 1] = height_by_range(sonar, path, x, float(parts.near[k]), low)
        else:
            place[k, 1] = bed
    return replace(parts, begin=place, end=np.where(np.isnan(parts.end), place, parts.end))
