"""Box of seabed and water that a light picture shows, packed for rays of light, and the camera that looks at it."""

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from insonify.arrays import Floats, Integers
from insonify.kernels.common.types import Mesh, Poses, Solids, still_water
from insonify.packing.packed_scene import PackedScene, pack
from insonify.packing.scene_arrays import make_bed
from insonify.scene import Scene
from insonify.terrain import Ground

CUTAWAY_MARGIN = 0.07  # of the longer side, around everything that must be shown
SLENDER = 0.62  # shorter side over the longer one, at least
SHADOW = 1.4  # times the distance of a target, to which its shadow is shown
THICK = 0.035  # of the longer side, below the lowest bed
ROOM_ABOVE = 0.02  # of it, above the highest thing
SWATH = 0.9  # share of the ground range that is shown of a bed without targets
AZIMUTH, DEPRESSION = math.radians(38.0), math.radians(33.0)  # of the view: astern and aside, and down
AWAY = 2.6  # of the diagonal of the cutaway
EDGE, HEADROOM = 0.02, 0.065  # of a picture's width, around the cutaway and above it, for a title
SHAPE = (0.42, 0.8)  # height of a picture over its width


@dataclass(frozen=True, eq=False, kw_only=True)
class OpticalScene(PackedScene):
    """The bed around the sonar and the targets, packed for rays of light, which are straight."""

    ground: Ground
    pose: Poses  # the sonar half way along the track
    heading: float  # heading of the track there in radians


def make_optical_scene(scene: Scene) -> OpticalScene:
    """Build and pack a scene for rays of light."""
    packed = pack(scene)
    middle = np.array([scene.track.pings // 2], dtype=np.int64)
    pose, arrays = packed.poses(middle), packed.arrays
    reach = arrays.bins * arrays.bin_length
    ground = packed.ground.around((float(pose.x[0]), float(pose.y[0])), 1.5 * reach)  # to the corners of the cutaway
    # The law of light has no frequency, to which materials would be fitted.
    materials = (*scene.seabed.material.rows()[1], *(target.material.reflectivity for target in scene.targets))
    reflectivity = np.array([row[:3] for row in materials])
    straight = arrays._replace(bed=make_bed(ground), water=still_water(), reflectivity=reflectivity)
    heading = float(packed.line(middle).heading[0])
    return OpticalScene(scene=scene, ground=ground, arrays=straight, pose=pose, heading=heading)


@dataclass(frozen=True, eq=False)
class Cutaway:
    """A box of bed and water, along and across the heading of the sonar."""

    axes: Floats  # (3, 3) rows: ahead, to port, up
    low: Floats  # (3,) corners of the box along these axes, in metres from the local origin
    high: Floats
    lamp: Floats  # (3,) where the sonar is: local x and y, height above the datum
    # (n, 3) points that a picture must show: corners of the bed, the sonar, outermost points of the targets.
    seen: Floats
    aside: float  # side of the camera, 1 for port and -1 for starboard: the side with fewer targets

    def intersect(self, origin: Floats, ways: Floats) -> tuple[Floats, Floats, Integers]:
        """Distances at which rays from one origin enter and leave the box."""
        o, d = self.axes @ origin, ways @ self.axes.T
        d = np.where(d == 0.0, 1e-300, d)
        one, other = (self.low - o) / d, (self.high - o) / d
        near = np.minimum(one, other)
        return near.max(axis=1), np.maximum(one, other).min(axis=1), near.argmax(axis=1)


def make_cutaway(optical: OpticalScene) -> Cutaway:
    """Choose the box to show: the targets, their shadows and the sonar, or a square of the swath without targets."""
    pose, arrays = optical.pose, optical.arrays
    ahead = np.array([math.cos(optical.heading), math.sin(optical.heading), 0.0])
    lamp = np.array([pose.x[0], pose.y[0], pose.z[0]])
    axes = np.array([ahead, [-ahead[1], ahead[0], 0.0], [0.0, 0.0, 1.0]])
    reach = arrays.bins * arrays.bin_length
    beneath = float(np.nan_to_num(optical.ground.height_at(lamp[:1], lamp[1:2])[0]))
    points = _target_points(arrays.solids, arrays.mesh)
    if len(points):
        # Shadows of the points on a level bed, within the range of the sonar.
        risen = np.clip((points[:, 2:] - beneath) / (lamp[2] - beneath), 0.0, 1.0 - 1.0 / SHADOW)
        tips = lamp + (points - lamp) / (1.0 - risen)
        sides = np.vstack([lamp, points, tips[np.hypot(*(tips - lamp)[:, :2].T) < reach]]) @ axes[:2].T
    else:
        swath = SWATH * math.sqrt(max(reach**2 - (lamp[2] - beneath) ** 2, 0.0))
        sides = lamp @ axes[:2].T + swath * np.array([[-1.0, -1.0], [1.0, 1.0]])
    low, high = sides.min(axis=0), sides.max(axis=0)
    longer = float((high - low).max())
    # With a margin and a least width.
    half, middle = np.maximum(0.5 * (high - low) + CUTAWAY_MARGIN * longer, 0.5 * SLENDER * longer), 0.5 * (low + high)
    low, high = middle - half, middle + half
    heights = _heights(optical.ground, axes, low, high)
    longer = float((high - low).max())
    bottom, bed, top = heights[0] - THICK * longer, heights[1], max(heights[1], lamp[2], *points[:, 2])
    corners = np.array(list(product(*zip([*low, bottom], [*high, bed])))) @ axes
    return Cutaway(
        axes,
        np.append(low, bottom),
        np.append(high, top + ROOM_ABOVE * longer),
        lamp,
        np.vstack([corners, lamp, points]),
        -1.0 if _to_port(arrays.solids, arrays.mesh, lamp, axes[1]) >= 0.0 else 1.0,
    )


def _to_port(solids: Solids, mesh: Mesh, lamp: Floats, port: Floats) -> float:
    """Sum the sizes of the targets to port of the sonar, less those to starboard, in metres."""
    targets = np.concatenate([solids.target, np.repeat(mesh.target, 3)])
    places = np.concatenate([solids.start + 0.5 * solids.length[:, None] * solids.axis, mesh.corners.reshape(-1, 3)])
    sizes = np.concatenate([solids.length + 2.0 * solids.radius, np.zeros(3 * len(mesh.target))])
    balance = 0.0
    for target in np.unique(targets):
        own = targets == target
        size = sizes[own].sum() + float(np.ptp(places[own], axis=0).max())
        balance += size * float(np.sign((places[own].mean(axis=0) - lamp) @ port))
    return balance


def _target_points(solids: Solids, mesh: Mesh) -> Floats:
    """Outermost points of the targets, (n, 3)."""
    ends = np.concatenate([solids.start, solids.start + solids.length[:, None] * solids.axis])
    wide = np.tile(np.maximum(solids.radius, solids.radius + solids.taper * solids.length), 2)[:, None]
    around = [ends + wide * way for way in (*np.eye(3), *-np.eye(3))]
    return np.concatenate([*around, mesh.corners.reshape(-1, 3)])


def _heights(ground: Ground, axes: Floats, low: Floats, high: Floats) -> tuple[float, float]:
    """Lowest and highest bed within the box."""
    along, aside = (np.linspace(*ends, 400) for ends in zip(low, high))
    places = along[:, None, None] * axes[0, :2] + aside[:, None] * axes[1, :2]
    heights = ground.height_at(places[..., 0].ravel(), places[..., 1].ravel())
    known = heights[np.isfinite(heights)]
    return (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera: its place, axes and window."""

    place: Floats  # (3,) local coordinates, in metres
    axes: Floats  # (3, 3) rows: to the right, up, ahead
    low: Floats  # (2,) corners of the window, as slopes to the right and up
    high: Floats
    width: int  # of the picture, in pixels
    height: int

    def directions(self, rows: Integers, samples: int) -> Floats:
        """Return unit directions through rows of pixels, (rows, samples, width, samples, 3); row 0 is at the top."""
        step = (self.high - self.low) / (self.width, self.height)
        part = (np.arange(samples) + 0.5) / samples
        right = self.low[0] + step[0] * (np.arange(self.width)[:, None] + part)
        up = self.high[1] - step[1] * (rows[:, None] + part)
        slopes = np.empty((rows.size, samples, self.width, samples, 3))
        slopes[..., 0], slopes[..., 1], slopes[..., 2] = right, up[:, :, None, None], 1.0
        ways = slopes @ self.axes
        return ways / np.linalg.norm(ways, axis=-1, keepdims=True)


def make_camera(cutaway: Cutaway, width: int) -> Camera:
    """Place a camera astern, aside and above a cutaway, with a window that shows all of it."""
    middle = 0.5 * (cutaway.low + cutaway.high)
    level = math.cos(DEPRESSION)
    back = (
        level * np.array([-math.cos(AZIMUTH), cutaway.aside * math.sin(AZIMUTH), math.tan(DEPRESSION)]) @ cutaway.axes
    )
    place = middle @ cutaway.axes + AWAY * float(np.linalg.norm(cutaway.high - cutaway.low)) * back
    right = np.cross(-back, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(right, -back), -back])
    seen = (cutaway.seen - place) @ axes.T
    slopes = seen[:, :2] / seen[:, 2:]
    low, high = slopes.min(axis=0), slopes.max(axis=0)
    wide = high[0] - low[0]
    low, high = low - EDGE * wide, high + wide * np.array([EDGE, HEADROOM])
    shape = float(np.clip((high[1] - low[1]) / (high[0] - low[0]), *SHAPE))
    half = np.maximum(0.5 * (high - low), 0.5 * np.array([(high[1] - low[1]) / shape, (high[0] - low[0]) * shape]))
    middle_seen = 0.5 * (low + high)
    return Camera(place, axes, middle_seen - half, middle_seen + half, width, round(width * half[1] / half[0]))
