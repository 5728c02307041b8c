"""Sonar and track of a record, from its declarations, from its echoes, and by assumptions."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.ndimage import median_filter

from insonify.arrays import Floats
from insonify.errors import SceneError
from insonify.io.records.bottom_track import BOTTOM_TRACK, find_altitude
from insonify.scene import Scene, scene_from_toml
from insonify.scene.edit import build, edit, plain

STEADY = 9  # pings over which jumps of a bottom track are removed
LEVEL = 0.05  # change of altitude, over the mean, that a level track may show
STRAIGHT = 0.5  # m, or half the distance between pings if that is more, off a straight and even track
ASSUMED_BEAM = {"kind": "gaussian", "width": 0.7}
ASSUMED_RATE = 10.0  # Hz
# Fields that may not be set, because they are learned.
LEARNED = ("seabed", "receiver.speckle", "targets", "volumes", "track.pings")
CARRIED = ("sonar", "water", "track", "receiver")  # parts of a simulated record's scene that are kept


class RecordedSonar(NamedTuple):
    """Sonar and track of a record as a scene."""

    scene: Scene  # with a level bed of one material and a straight track
    altitude: Floats  # (pings,) height above the bed, in metres
    # Time, x, y, altitude and heading of a track that is not straight and level; None otherwise.
    navigation: Mapping[str, Floats] | None
    # Whether the record carries the scene that it was simulated from, so that beam, pulse and gains are known.
    simulated: bool
    assumed: tuple[str, ...]  # fields that neither the record nor the caller declares


def declare_sonar(record: xr.Dataset, changes: Mapping[str, Any]) -> RecordedSonar:
    """Take sonar and track from a record."""
    for path in changes:
        if any(path == field or path.startswith(f"{field}.") for field in LEARNED):
            raise SceneError(f"{path}: is learned from the record; leave it out, or edit the scene afterwards")
    altitude = _altitude(record)
    carried = _carried_scene(record)
    pings = record.sizes["ping_time"]
    if carried is not None:
        scene = edit(carried, {**changes, "track.pings": pings})
        return RecordedSonar(scene, altitude, None, True, ())
    values, assumed = _declared(record, altitude)
    scene = edit(build(values), changes)
    missing = tuple(name for name in assumed if not any(path.startswith(name) for path in changes))
    return RecordedSonar(scene, altitude, _navigation(record, altitude, scene), False, missing)


def _altitude(record: xr.Dataset) -> Floats:
    """Altitude by the first echoes of the bed, else as recorded."""
    if BOTTOM_TRACK in record and np.isfinite(record[BOTTOM_TRACK].values).all():
        return np.asarray(median_filter(record[BOTTOM_TRACK].values.astype(np.float64), STEADY, mode="nearest"))
    altitude = find_altitude(record)
    if not (np.isfinite(altitude).all() and altitude.max() > 0.0):
        title = record.attrs.get("title", "record")
        raise SceneError(
            f"{title}: has no altitude and shows no first echo of the bed; give a record with a water column"
        )
    return altitude


def _carried_scene(record: xr.Dataset) -> Scene | None:
    """Sonar, water, track and receiver of the scene that a simulated record carries; None for any other record."""
    try:
        scene = scene_from_toml(str(record.attrs["scene"]))
        recorded = any(motion.recording() is not None for motion in scene.track.motions)
    except (KeyError, SceneError):  # of a track that is no longer where it was, too
        return None
    if recorded or scene.seabed.relief.measured:
        return None
    values = plain(scene)
    kept = {name: values[name] for name in CARRIED if name in values}
    kept["receiver"] = {name: value for name, value in kept.get("receiver", {}).items() if name != "speckle"}
    return build(kept | {"seabed": {"depth": scene.seabed.depth}})


def _declared(record: xr.Dataset, altitude: Floats) -> tuple[dict[str, Any], list[str]]:
    """Plain values of a scene from a recording, and the fields that had to be assumed."""
    slant_range, travel_time = record["slant_range"].values, record["travel_time"].values
    speed_of_sound = float(np.clip(2.0 * slant_range[-1] / travel_time[-1], 1400.0, 1600.0))
    reach = 2.0 * float(slant_range[0]) * slant_range.size
    rate, speed, assumed = _advance(record, speed_of_sound / (2.0 * reach))
    beam = float(record.attrs.get("beam_width", 0.0))
    frequency = float(record.attrs.get("frequency", 0.0))
    assumed += [name for name, known in {"sonar.beam": beam, "sonar.frequency": frequency}.items() if not known > 0.0]
    sonar = {
        "range": reach,
        "bins": int(slant_range.size),
        "ping_rate": rate,
        "beam": {"kind": "gaussian", "width": beam} if beam > 0.0 else ASSUMED_BEAM,
    } | ({"frequency": frequency} if frequency > 0.0 else {})
    x, y = record["platform_x"].values, record["platform_y"].values
    track = {
        "altitude": float(np.mean(altitude)),
        "speed": speed,
        "pings": record.sizes["ping_time"],
        "heading": round(float(np.degrees(np.arctan2(y[-1] - y[0], x[-1] - x[0]))), 2),
    }
    water = {"kind": "uniform", "sound_speed": speed_of_sound}
    # Deep enough for the altitude if the record has no depth.
    least = 1.05 * float(altitude.max()) + 1.0
    depth = float(np.mean(record["platform_depth"].values + altitude)) if "platform_depth" in record else math.nan
    bed = {"depth": max(depth, least) if math.isfinite(depth) else least}
    return {"sonar": sonar, "track": track, "water": water, "seabed": bed}, ["sonar.pulse", *assumed]


def _advance(record: xr.Dataset, fastest: float) -> tuple[float, float, list[str]]:
    """Ping rate in Hz and speed in m/s, and the fields of these that had to be assumed."""
    times = record["ping_time"].values.astype(np.float64)
    x, y = record["platform_x"].values, record["platform_y"].values
    length, lasts = float(np.hypot(np.diff(x), np.diff(y)).sum()), float(times[-1] - times[0])
    count = len(times) - 1
    timed = lasts > 0.0
    rate = min(count / lasts if timed else ASSUMED_RATE, fastest * (1.0 - 1e-9))
    speed = float(np.clip(length / max(count, 1) * rate, 1e-3, 50.0))
    return rate, speed, [] if timed else ["sonar.ping_rate"]


def _navigation(record: xr.Dataset, altitude: Floats, scene: Scene) -> dict[str, Floats] | None:
    """Columns of a track that is not straight and level."""
    pings = np.arange(altitude.size)
    x, y = (record[f"platform_{axis}"].values.astype(np.float64) for axis in ("x", "y"))
    heading = np.radians(scene.track.heading)
    along = pings * scene.track.speed / scene.sonar.ping_rate
    off = np.hypot(x - x[0] - along * np.cos(heading), y - y[0] - along * np.sin(heading))
    level = np.ptp(altitude) <= LEVEL * float(altitude.mean())
    if level and off.max() <= max(STRAIGHT, 0.5 * scene.track.speed / scene.sonar.ping_rate):
        return None
    columns = {"time": pings / scene.sonar.ping_rate, "x": x - x[0], "y": y - y[0], "altitude": altitude}
    compass = record["platform_heading"].values if "platform_heading" in record else np.full(altitude.shape, np.nan)
    return columns | ({"heading": compass.astype(np.float64)} if np.isfinite(compass).all() else {})
