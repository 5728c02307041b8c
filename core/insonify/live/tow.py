"""A tow in real time: each ping is traced one ahead, sent when it is due, and steered from outside in between."""

import gc
import math
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

from insonify.acoustics.water import recording_speed
from insonify.arrays import Floats, Integers, Singles
from insonify.errors import SceneError
from insonify.io.georeference import Georeference, convergence, to_degrees
from insonify.io.record_schema import PLATFORM
from insonify.io.records.survey_log import NOWHERE, LoggedPing
from insonify.kernels.common.types import Poses
from insonify.live.helm import Helm
from insonify.live.outputs import LivePing, Output
from insonify.live.pacer import Pacer
from insonify.scene import Scene, edit
from insonify.simulation import Simulation, prepare
from insonify.tow.line import TowLine, tow_line_at
from insonify.tow.poses import make_poses, platform_columns

MOST_FISH = 16
OWN_NOISE = 2**24  # pings between those of two fish, whose noise is that of pings so many later in the record
SWITCHING = 5e-4  # s, after which a thread that encodes lets the one that sends go first
PLACE = ("x", "y", "heading")
POSE = (*PLACE, "depth", "altitude", "pitch", "roll")
HELM = {"turn": (-90.0, 90.0), "speed": (0.0, 50.0)}


@dataclass(frozen=True, eq=False, kw_only=True)
class SteeredSimulation(Simulation):
    """A simulation whose track is that of a helm, and whose record may be that of a scene with more in it."""

    helm: Helm
    hidden: Simulation | None = None

    def trace_record(self, pings: Integers, poses: Poses | None = None) -> tuple[Singles, Singles]:
        """Trace and receive pings, with what is hidden."""
        poses = self.poses(pings) if poses is None else poses
        return super().trace_record(pings, poses) if self.hidden is None else self.hidden.trace_record(pings, poses)

    def poses(self, pings: Integers) -> Poses:
        """Return position and attitude of the sonar at the given pings."""
        return make_poses(self.scene, self.ground, pings, self.helm.line(pings))

    def line(self, pings: Integers) -> TowLine:
        """Return positions and headings along the line of the tow, without the motion of the fish about it."""
        return self.helm.line(pings)


def steer_by(simulation: Simulation, helm: Helm, hidden: Scene | None = None) -> SteeredSimulation:
    """Return a simulation along a helm, and with the record of another scene if there is one."""
    parts = {field.name: getattr(simulation, field.name) for field in fields(Simulation)}
    more = None if hidden is None else prepare_everywhere(hidden, tolerance=simulation.tolerance)
    return SteeredSimulation(**parts, helm=helm, hidden=more)


def prepare_everywhere(scene: Scene, *, forced: Mapping[str, str] | None = None, **how: Any) -> Simulation:
    """Prepare a scene for any pose: its plan keeps targets that are out of reach of the declared track."""
    kept = {"far_targets": "on"} if scene.targets else {}
    return prepare(scene, forced=kept | dict(forced or {}), **how)


class Tow:
    """A scene towed over in real time by one fish, or by several abeam of one another.

    Parameters
    ----------
    scene : Scene
        What there is. Ping n of the first fish is ping n of its record, until it is steered.
    fish, apart
        Number of towfish, up to 16, and metres between neighbours, each to starboard of the one before.
    times : float
        Seconds of the tow in a second.
    start : datetime, optional
        Time of the first ping, in UTC; now when left out.
    **how
        Arguments of `insonify.prepare`.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        fish: int = 1,
        apart: float = 0.0,
        times: float = 1.0,
        start: datetime | None = None,
        **how: Any,
    ) -> None:
        if not 1 <= fish <= MOST_FISH:
            raise SceneError(f"fish: {fish} is out of bounds; give 1 to {MOST_FISH}")
        self.fish, self.apart, self.times, self.number = fish, apart, times, 0
        self.helm: Helm | None = None  # what steers; None on the scene's own track
        self.pacer: Pacer | None = None
        self.start, place = start or datetime.now(UTC).replace(tzinfo=None), scene.georeference
        self.on_earth = place is not None and bool(place.crs)  # else in the sea, until it is put elsewhere
        self.put_on_earth(place if place is not None and place.crs else NOWHERE)
        self._how, self.simulation = how, prepare_everywhere(scene, **how)
        self._last: Poses | None = None
        self._running, self._ended = threading.Event(), False
        self._running.set()

    @property
    def scene(self) -> Scene:
        """The scene, with what was changed under way."""
        return self.simulation.scene

    def put_on_earth(self, place: Georeference) -> None:
        """Put the scene's own x and y on a map."""
        self.place, self._convergence = place, convergence(place)

    def direction(self, bearing: float) -> float:
        """Direction in radians, counter-clockwise from +x, of a bearing in degrees from true north."""
        return math.radians(90.0 - bearing + self._convergence)

    def poses(self, ping: int) -> Poses:
        """Return the poses of all fish at a ping."""
        numbers = np.full(self.fish, ping)
        if self.helm is None and self.fish == 1:
            return self.simulation.poses(numbers)
        if self.helm is not None:
            self.helm.advance(ping)
        line = tow_line_at(self.scene, numbers) if self.helm is None else self.helm.line(numbers)
        aside = self.apart * np.arange(self.fish)
        beside = TowLine(line.x + aside * np.sin(line.heading), line.y - aside * np.cos(line.heading), line.heading)
        return make_poses(self.scene, self.simulation.ground, numbers, beside)

    def trace(self, ping: int) -> list[LivePing]:
        """Trace a ping of every fish."""
        poses, before = self.poses(ping), self._last
        self._last = poses
        return self._describe(ping, poses, ping + OWN_NOISE * np.arange(self.fish), before)

    def ping(self, pose: Mapping[str, float], number: int = 0) -> LivePing:
        """Trace one ping at any pose, beside those of the tow; its number is that from which its noise derives.

        A pose has ``x``, ``y``, ``depth`` or ``altitude``, ``heading`` (counter-clockwise from +x), ``pitch`` and
        ``roll`` in metres and degrees; those left out are 0, and the height is the track's.
        """
        values = _numbers(pose, POSE, "is not part of a pose")
        if {"depth", "altitude"} <= values.keys():
            raise SceneError("altitude: has no effect beside depth; give one of the two")
        x, y, *angles = (np.array([values.get(name, 0.0)]) for name in ("x", "y", "heading", "pitch", "roll"))
        ground, numbers, (heading, *tilt) = self.simulation.ground, np.array([number]), map(np.radians, angles)
        if "depth" in values:
            z = np.array([-values["depth"]]) - ground.datum
        elif "altitude" in values:
            z = ground.height_near(x, y) + values["altitude"]
        else:
            z = make_poses(self.scene, ground, numbers, TowLine(x, y, heading)).z
        return self._describe(number, Poses(x, y, z, heading, *tilt), numbers)[0]

    def set(self, changes: Mapping[str, Any]) -> None:
        """Change fields of the scene by their paths; the tow goes on meanwhile, and pings after that show it."""
        free = "track.altitude", "track.depth"
        fixed = [path for path in changes if path.startswith(("track", "sonar.ping_rate")) and path not in free]
        if fixed:
            raise SceneError(f"{fixed[0]}: places the pings and stays as it is during a tow; steer it instead")
        self.simulation = prepare_everywhere(edit(self.scene, dict(changes)), **self._how)

    def steer(self, changes: Mapping[str, float]) -> None:
        """Turn (``turn``, °/s to port), change the ``speed`` (m/s), or move to ``x``, ``y`` with a ``heading``."""
        values = _numbers(changes, (*HELM, *PLACE), "is no way to steer")
        helm = self.helm or Helm(self.scene, self.number)
        for name in HELM.keys() & values.keys():
            low, high = HELM[name]
            if not low <= values[name] <= high:
                raise SceneError(f"{name}: {values[name]:g} is out of bounds; give {low:g} to {high:g}")
            setattr(helm, name, values[name])
        if values.keys() & PLACE:
            x, y, heading = (float(column[0]) for column in helm.line(np.array([helm.newest])))
            known = {"x": x, "y": y, "heading": math.degrees(heading)} | values
            helm.put(known["x"], known["y"], math.radians(known["heading"]))
        self.helm = helm

    def pause(self, paused: bool = True) -> None:
        """Pause, or go on with the next ping."""
        (self._running.clear if paused else self._running.set)()

    def stop(self) -> None:
        """End with the ping that is next."""
        self._ended = True
        self._running.set()

    def run(
        self, outputs: Sequence[Output], pings: int | None = None, look: Callable[[int], object] = lambda _: None
    ) -> Pacer:
        """Send pings when they are due, some or without an end, and call ``look`` with the number of each."""
        last, waiting = math.inf if pings is None else self.number + pings, self.trace(self.number)
        gc.collect()
        gc.freeze()  # what is prepared is not looked through again while pings are due
        interval = sys.getswitchinterval()
        sys.setswitchinterval(SWITCHING)
        self.pacer = pacer = Pacer(self.scene.sonar.ping_rate * self.times, skips=self.times <= 1.0)
        pacer.restart(self.number)
        try:
            while self.number < last and not self._ended:
                if not self._running.is_set():
                    self._running.wait()
                    pacer.restart(self.number)
                    continue
                if (due := pacer.wait(self.number)) != self.number:
                    self.number, waiting = due, self.trace(due)
                for live in waiting:
                    for output in outputs:
                        output.offer(live)
                look(self.number)
                self.number += 1
                if self.number < last:
                    waiting = self.trace(self.number)
        finally:
            sys.setswitchinterval(interval)
            gc.unfreeze()
        return pacer

    def _describe(self, number: int, poses: Poses, numbers: Integers, before: Poses | None = None) -> list[LivePing]:
        """Trace pings at poses, by the numbers of their noise; speed and course are those since the poses before."""
        scene, ground, rate = self.scene, self.simulation.ground, self.scene.sonar.ping_rate
        intensity = self.simulation.record(numbers, poses)
        columns = dict(zip(PLATFORM, platform_columns(poses, ground)))
        pitch, roll, depth, altitude = (columns[f"platform_{name}"] for name in ("pitch", "roll", "depth", "altitude"))
        east, north = to_degrees(self.place, poses.x, poses.y)
        ahead = scene.track.speed / rate
        moved = (ahead * np.cos(poses.heading), ahead * np.sin(poses.heading))
        if before is not None:
            moved = poses.x - before.x, poses.y - before.y
        heading, course = self._bearing(poses.heading), self._bearing(np.arctan2(moved[1], moved[0]))
        time, speed = self.start + timedelta(seconds=number / rate), np.hypot(*moved) * rate
        reach, found = scene.sonar.range, []
        duration, frequency = 2.0 * reach / recording_speed(scene, ground.datum), scene.sonar.frequency
        for fish, (x, y, *rest) in enumerate(zip(east, north, heading, pitch, roll, depth, altitude, speed)):
            place: Any = float(x), float(y), True, *map(float, rest), reach, duration, frequency
            pose = {name: float(column[fish]) for name, column in columns.items()}
            header = LoggedPing(number, time, *place)
            found.append(LivePing(fish, header, intensity[fish], float(course[fish]), pose))
        return found

    def _bearing(self, direction: Floats) -> Floats:
        """Bearing from true north, above 0 and up to 360, of a direction in radians counter-clockwise from +x."""
        return np.asarray(360.0 - np.mod(np.degrees(direction) - 90.0 - self._convergence, 360.0))


def _numbers(given: Mapping[str, Any], known: Sequence[str], fault: str) -> dict[str, float]:
    """Return values that are finite numbers of known names."""
    for name, value in given.items():
        if name not in known:
            raise SceneError(f"{name}: {fault}; give {', '.join(known)}")
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise SceneError(f"{name}: {value!r:.40} is not a number; give a plain number")
    return dict(given)
