"""The line of a steered tow: by a helm, or behind a ship that reports where it is."""

import math
from array import array
from threading import RLock

import numpy as np

from insonify.arrays import Integers, Reals
from insonify.scene import Scene
from insonify.tow.line import TowLine, tow_line_at

BEFORE = 2048  # pings before the first that is steered, whose places on the track are kept
KEPT = 2**17  # pings whose places are kept, to look back at: 3 MB


class Helm:
    """Line of a tow that turns, speeds up and drifts while it is under way; the pings sent so far stay where they are.

    ``turn`` is in degrees per second to port, ``speed`` in m/s through the water, which drifts by the ``current``, m/s
    along x and y. Any thread may look at the line while another gives pings their places.
    """

    def __init__(self, scene: Scene, ping: int = 0, current: tuple[float, float] = (0.0, 0.0)) -> None:
        self.turn, self.speed, self.current = 0.0, scene.track.speed, current
        self._first, self._period = max(ping - BEFORE, 0), 1.0 / scene.sonar.ping_rate
        start = tow_line_at(scene, np.arange(max(ping - BEFORE, 0), ping + 1))
        self._columns = tuple(array("d", column) for column in start)
        self._lock = RLock()

    @property
    def newest(self) -> int:
        """The last ping that has its place."""
        return self._first + len(self._columns[0]) - 1

    def put(self, x: float, y: float, heading: float) -> None:
        """Move the newest ping to a place; the heading is in radians."""
        with self._lock:
            for column, value in zip(self._columns, (x, y, heading)):
                column[-1] = value

    def advance(self, ping: int) -> None:
        """Give the pings up to a number their places, by the present turn and speed."""
        with self._lock:
            while self.newest < ping:
                place = self._next(*(column[-1] for column in self._columns))
                for column, value in zip(self._columns, place):
                    column.append(value)
            if (over := len(self._columns[0]) - KEPT) > KEPT // 8:
                self._first += over
                for column in self._columns:
                    del column[:over]

    def line(self, pings: Integers | Reals) -> TowLine:
        """Places and headings at pings; straight ahead of the newest one, and astern of the oldest that is kept."""
        numbers = np.asarray(pings, dtype=np.float64)
        with self._lock:
            first, columns = self._first, np.stack([np.frombuffer(column) for column in self._columns])
        kept = first + np.arange(columns.shape[1])
        x, y, heading = (np.interp(numbers, kept, column) for column in columns)
        beyond = self.speed * self._period * (numbers - np.clip(numbers, kept[0], kept[-1]))
        return TowLine(x + beyond * np.cos(heading), y + beyond * np.sin(heading), heading)

    def _next(self, x: float, y: float, heading: float) -> tuple[float, float, float]:
        """Place and heading one ping after another."""
        half, ahead = 0.5 * math.radians(self.turn) * self._period, self.speed * self._period
        east, north = (drift * self._period for drift in self.current)
        way = heading + half
        return x + ahead * math.cos(way) + east, y + ahead * math.sin(way) + north, heading + 2.0 * half


class ShipTow(Helm):
    """Line of a towfish behind a ship whose fixes arrive from outside.

    The fish is the trailing end of a cable of constant horizontal length (a tractrix). The catenary gives way to
    changes of the ship's motion: the point that pulls the fish follows the ship with a lag.
    """

    def __init__(self, scene: Scene, layback: float, lag: float) -> None:
        super().__init__(scene)
        self._layback, self._lag = layback, lag
        self._fix: tuple[float, float, float, float] | None = None  # x, y, and their rates in m/s
        self._age = 0.0  # s since the fix
        self._pull: tuple[float, float] | None = None

    def take_fix(self, x: float, y: float, course: float, speed: float, heading: float) -> None:
        """Take a fix of the ship: place, course over ground and heading in radians, speed in m/s."""
        with self._lock:
            if self._fix is None:  # the cable is astern of the ship at first
                astern = self._layback + self._lag * speed
                self.put(x - astern * math.cos(heading), y - astern * math.sin(heading), heading)
                self._pull = x - self._lag * speed * math.cos(course), y - self._lag * speed * math.sin(course)
            self._fix, self._age = (x, y, speed * math.cos(course), speed * math.sin(course)), 0.0

    def _next(self, x: float, y: float, heading: float) -> tuple[float, float, float]:
        """Place and heading one ping after another: the cable pulls the fish towards the ship."""
        with self._lock:
            if self._fix is None or self._pull is None:
                return x, y, heading
            self._age += self._period
            ship = [self._fix[axis] + self._age * self._fix[2 + axis] for axis in (0, 1)]
            share = -math.expm1(-self._period / self._lag) if self._lag > 0.0 else 1.0
            self._pull = pull = tuple(at + share * (to - at) for at, to in zip(self._pull, ship))  # type: ignore[assignment]
        away = math.dist(pull, (x, y))
        self.speed = max(away - self._layback, 0.0) / self._period
        if away > self._layback:
            share = 1.0 - self._layback / away
            heading_to = math.atan2(pull[1] - y, pull[0] - x)
            heading += math.remainder(heading_to - heading, 2.0 * math.pi)
            x, y = x + share * (pull[0] - x), y + share * (pull[1] - y)
        return x, y, heading
