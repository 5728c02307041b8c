"""Navigation: position and attitude of the sonar at every ping."""

import math
from typing import get_args

import numpy as np

from insonify.arrays import Booleans, Floats, Integers
from insonify.kernels.common.types import Poses
from insonify.scene import Scene, SceneError
from insonify.scene.track.motions import Axis
from insonify.terrain import AnyGround, EndlessGround
from insonify.tow.line import TowLine, recorded_at, tow_line_at

BED_SAMPLES = 64  # samples of the bed to either side of the fish
KNOTS = 8  # of the smoothed bed, to an altitude along the track
STRETCH = 16  # knots that are computed together, two altitudes
PINGS_TOGETHER = 2048  # pings with samples in memory at a time


def sonar_height(scene: Scene, ground: AnyGround) -> float:
    """Height of the sonar above the datum that the track declares, in metres."""
    return -scene.track.depth - ground.datum if scene.track.depth is not None else scene.altitude


def make_poses(scene: Scene, ground: AnyGround, pings: Integers, steered: TowLine | None = None) -> Poses:
    """Place the sonar at the given pings, on a steered line or the track's, which continues beyond its last ping."""
    line, known = steered or tow_line_at(scene, pings), {} if steered else recorded_at(scene, pings)
    zero = np.zeros(line.x.shape)
    moved = _displacement(scene, pings)
    return Poses(
        x=line.x + moved["surge"] * np.cos(line.heading) - moved["sway"] * np.sin(line.heading),
        y=line.y + moved["surge"] * np.sin(line.heading) + moved["sway"] * np.cos(line.heading),
        z=_height(scene, ground, line, pings, known, steered is not None) + moved["heave"],
        heading=line.heading + np.radians(moved["yaw"]),
        pitch=known.get("pitch", zero) + np.radians(moved["pitch"]),
        roll=known.get("roll", zero) + np.radians(moved["roll"]),
    )


def take_poses(poses: Poses, places: Integers | Booleans | slice) -> Poses:
    """Return some of the poses, by a slice, a mask or their places."""
    return Poses(*(np.ascontiguousarray(column[places]) for column in poses))


def bed_beneath(scene: Scene, ground: AnyGround, pings: Integers) -> Floats:
    """Smoothed height of the bed under the line, which a fish can follow: a mean over one altitude to either side."""
    share = np.arange(1 - BED_SAMPLES, BED_SAMPLES) / BED_SAMPLES
    # The altitude of a tow at a given depth over a measured bed follows from the bed's heights alone.
    reach = abs(sonar_height(scene, ground)) * scene.sonar.ping_rate / scene.track.speed
    numbers = np.asarray(pings, dtype=np.float64)
    parts = np.array_split(numbers, math.ceil(max(numbers.size, 1) / PINGS_TOGETHER))
    lines = (tow_line_at(scene, part[:, None] + reach * share) for part in parts)
    return np.concatenate([ground.height_near(line.x, line.y) @ _raised_cosine() for line in lines])


def interpolate_bed_beneath(scene: Scene, ground: AnyGround, pings: Integers) -> Floats:
    """Smoothed height of the bed under the line, interpolated between knots; a picture needs no more."""
    # The knots, at which it is that of `bed_beneath`, are an eighth of an altitude apart: the smoothing makes that
    # dense enough.
    apart = abs(sonar_height(scene, ground)) * scene.sonar.ping_rate / scene.track.speed / KNOTS
    if apart <= 1.0:
        return bed_beneath(scene, ground, pings)
    place = np.asarray(pings, dtype=np.float64) / apart
    first = np.floor(place).astype(np.int64)
    stretches, stretch = np.unique(first // STRETCH, return_inverse=True)
    knots = _knots_beneath(scene, ground, stretches, apart)
    before, share = first % STRETCH, place - first
    return knots[stretch, before] * (1.0 - share) + knots[stretch, before + 1] * share


def _knots_beneath(scene: Scene, ground: AnyGround, stretches: Integers, apart: float) -> Floats:
    """Smoothed heights at the knots of stretches of the line, (n, STRETCH + 1); neighbours share samples of the bed."""
    # ``apart`` is the number of pings from a knot to the next.
    step = BED_SAMPLES // KNOTS  # samples from a knot to the next
    samples = step * STRETCH * stretches[:, None] + np.arange(1 - BED_SAMPLES, step * STRETCH + BED_SAMPLES)
    line = tow_line_at(scene, samples * (apart / step))
    windows = np.lib.stride_tricks.sliding_window_view(ground.height_near(line.x, line.y), 2 * BED_SAMPLES - 1, axis=1)
    return np.asarray(windows[:, ::step] @ _raised_cosine())


def _raised_cosine() -> Floats:
    """Weights of the samples about a place, (2 `BED_SAMPLES` - 1,)."""
    return (1.0 + np.cos(math.pi * np.arange(1 - BED_SAMPLES, BED_SAMPLES) / BED_SAMPLES)) / (2.0 * BED_SAMPLES)


def platform_columns(poses: Poses, ground: AnyGround) -> tuple[Floats, ...]:
    """Position, depth, altitude and attitude of the sonar as a record holds them, (pings,) each."""
    altitude = poses.z - ground.height_at(poses.x, poses.y)
    attitude = map(np.degrees, (poses.heading, poses.pitch, poses.roll))
    return poses.x, poses.y, -(poses.z + ground.datum), altitude, *attitude


def find_pings_in_bed(ground: AnyGround, poses: Poses) -> Booleans:
    """Whether the sonar is below the bed at each pose; not where there is no bed."""
    return np.asarray(poses.z < ground.height_at_once(poses.x, poses.y))


def refuse_sonar_in_bed(scene: Scene, ground: AnyGround, pings: Integers, poses: Poses) -> None:
    """Raise if the sonar is below the bed at one of some pings."""
    inside = find_pings_in_bed(ground, poses)
    if inside.any():
        first = int(np.argmax(inside))
        below = float(ground.height_at_once(poses.x[[first]], poses.y[[first]])[0] - poses.z[first])
        field = "altitude" if scene.track.depth is None else "depth"
        raise SceneError(
            f"track.{field}: at ping {int(pings[first])} the sonar is {below:.2g} m below the bed; raise the track or "
            "lower the relief"
        )


def refuse_track_off_bed(scene: Scene, ground: AnyGround) -> None:
    """Refuse a tow that never comes within range of a bounded bed, unless a target may be in range."""
    if isinstance(ground, EndlessGround) or ground.periodic or scene.targets:
        return
    line = tow_line_at(scene, np.unique(np.linspace(0, scene.track.pings - 1, 512).astype(np.int64)))
    ny, nx = ground.heights.shape
    x1, y1 = ground.x0 + (nx - 1) * ground.spacing, ground.y0 + (ny - 1) * ground.spacing
    away = np.hypot(line.x - np.clip(line.x, ground.x0, x1), line.y - np.clip(line.y, ground.y0, y1))
    if (away > scene.sonar.range).all():
        raise SceneError(
            f"track.start: from {list(scene.track.start)} the tow never comes within {scene.sonar.range:g} m "
            f"of the bed (x from {ground.x0:g} to {x1:g} m, y from {ground.y0:g} to {y1:g} m); start it over the bed"
        )


def _height(
    scene: Scene, ground: AnyGround, line: TowLine, pings: Integers, known: dict[str, Floats], steered: bool
) -> Floats:
    """Heights of the sonar above the datum, without its heave; a steered fish takes the bed ahead for its future."""
    if "depth" in known:
        return -known["depth"] - ground.datum
    if "altitude" in known:
        return ground.height_near(line.x, line.y) + known["altitude"]
    height = np.full(line.x.shape, sonar_height(scene, ground))
    if not scene.track.terrain_following:
        return height
    if not steered:
        return height + bed_beneath(scene, ground, pings)
    along = np.abs(height)[:, None] * (np.arange(1 - BED_SAMPLES, BED_SAMPLES) / BED_SAMPLES)
    x, y = (
        line.x[:, None] + along * np.cos(line.heading)[:, None],
        line.y[:, None] + along * np.sin(line.heading)[:, None],
    )
    return height + ground.height_near(x, y) @ _raised_cosine()


def _displacement(scene: Scene, pings: Integers) -> dict[Axis, Floats]:
    """Sum of all motions by the axis that they act on: metres ahead, to port and up, degrees of the angles."""
    time = np.asarray(pings, dtype=np.float64) / scene.sonar.ping_rate
    total: dict[Axis, Floats] = {axis: np.zeros(time.shape) for axis in get_args(Axis)}
    for motion in scene.track.motions:
        for axis, values in motion.displacement(time).items():
            total[axis] += values
    return total
