"""Clock of the tow: newest ping, ping on top of the screen, and when the tow pauses by itself."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.kernels.common.types import Mesh, Poses, Solids
from insonify.live.helm import Helm
from insonify_viewer.core_types import Ground, Simulation

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
MARGIN = 1 / 32  # of the record on screen, left below the first target
GLIMPSE = 1 / 8  # of the record on screen, towed at least


class TowClock:
    """Counts pings at the ping rate times a speed; a paused clock can look back."""

    def __init__(self, newest: int) -> None:
        self.running = True
        self.speed = 1.0
        self.helm: Helm | None = None  # what steers; None on the track of the scene
        self._position = float(newest)
        self._back = 0

    @property
    def newest(self) -> int:
        """Newest ping sent."""
        return int(self._position)

    @property
    def top(self) -> int:
        """Ping on top of the screen: the newest, or an earlier one when looking back."""
        return self.newest - self._back

    def advance(self, seconds: float, ping_rate: float) -> bool:
        """Count the pings of some seconds; return whether a new ping was sent."""
        if not self.running:
            return False
        before = self.newest
        self._position += seconds * ping_rate * self.speed
        if self.helm is not None:
            self.helm.advance(self.newest)
        return self.newest > before

    def run(self, running: bool) -> None:
        """Run on from the ping on top of the screen, or pause."""
        self.running = running
        if running and self._back:
            self._position, self._back = float(self.top), 0

    def look_back(self, pings: int) -> None:
        """Move the paused screen back by some pings, within those that were sent."""
        if not self.running:
            self._back = min(max(self._back + pings, 0), self.newest)

    def go_to(self, ping: int) -> None:
        """Pause, and put a ping on top of the screen; pings up to it count as sent."""
        self.running = False
        self._position = max(self._position, float(ping))
        self._back = self.newest - ping

    def restart(self, newest: int) -> None:
        """Start again at a ping."""
        self._position, self._back = float(newest), 0


class AutoPause(NamedTuple):
    """The ping at which the tow pauses, and a sentence that says why."""

    ping: int
    why: str


def next_pause(
    simulation: Simulation, before: int, newest: int, held: int, *, for_targets: bool = True
) -> AutoPause | None:
    """Find the ping between two others at which the tow pauses by itself."""
    # lazy: the window opens before Numba is loaded
    from insonify.terrain import EndlessGround

    ground = simulation.ground
    if not (isinstance(ground, EndlessGround) or ground.periodic):
        pose = simulation.poses(np.array([newest - 1, newest], dtype=np.int64))
        left = leaves_grid(ground, pose)
        return AutoPause(newest, "paused because the tow has left the measured bed") if left else None
    first = _first_abeam(simulation) if for_targets else None
    if first is None:
        return None
    last = max(first + held - 1 - round(MARGIN * held), held - 1 + round(GLIMPSE * held))
    why = "paused before the targets scroll out of the record; press Space to go on"
    return AutoPause(last, why) if before < last <= newest else None


def leaves_grid(ground: Ground, poses: Poses) -> bool:
    """Whether the second of two poses lies off the grid, and farther off than the first."""
    ny, nx = ground.heights.shape
    middle = np.array([ground.x0 + (nx - 1) * ground.spacing / 2.0, ground.y0 + (ny - 1) * ground.spacing / 2.0])
    half = np.array([nx - 1, ny - 1]) * ground.spacing / 2.0
    off = (np.abs(np.stack([poses.x, poses.y], axis=1) - middle) - half).max(axis=1)
    return bool(off[1] > 0.0 and off[1] >= off[0])


@lru_cache(maxsize=1)
def _first_abeam(simulation: Simulation) -> int | None:
    """First ping of the declared track that has a part of a target abeam; None without targets within range."""
    line = simulation.line(np.arange(simulation.scene.track.pings, dtype=np.int64))
    arrays = simulation.arrays
    reach = arrays.bins * arrays.bin_length
    pings = []
    for x, y in _ends(arrays.solids, arrays.mesh):
        away = np.hypot(line.x - x, line.y - y)
        if away.min() < reach:
            pings.append(int(away.argmin()))
    return min(pings, default=None)


def _ends(solids: Solids, mesh: Mesh) -> Floats:
    """Horizontal positions of solids' ends and of mesh corners; only the outermost if there are many, (n, 2)."""
    places = np.concatenate(
        [solids.start, solids.start + solids.length[:, None] * solids.axis, mesh.corners.reshape(-1, 3)]
    )[:, :2]
    if len(places) < 64:
        return places
    ways = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    return places[np.unique((places @ [np.cos(ways), np.sin(ways)]).argmax(axis=0))]
