"""Automatic pause of the tow: at the end of a measured bed, and before the targets leave the record."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from insonify.kernels.common.types import Mesh, Poses, Solids
    from insonify.simulation import Simulation
    from insonify.terrain.ground import Ground

MARGIN = 1 / 32  # of the record on screen, left below the first target
GLIMPSE = 1 / 8  # of the record on screen, towed at least


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
        return AutoPause(newest, "the tow has left the measured bed and is paused") if left else None
    first = _first_abeam(simulation) if for_targets else None
    if first is None:
        return None
    last = max(first + held - 1 - round(MARGIN * held), held - 1 + round(GLIMPSE * held))
    why = "paused before the targets leave the record; Space tows on"
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


def _ends(solids: Solids, mesh: Mesh) -> NDArray[np.float64]:
    """Horizontal positions of solids' ends and of mesh corners; only the outermost if there are many, (n, 2)."""
    places = np.concatenate(
        [solids.start, solids.start + solids.length[:, None] * solids.axis, mesh.corners.reshape(-1, 3)]
    )[:, :2]
    if len(places) < 64:
        return places
    ways = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    return places[np.unique((places @ [np.cos(ways), np.sin(ways)]).argmax(axis=0))]
