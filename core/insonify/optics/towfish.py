"""The towfish as solids in the scene of a light picture."""

from __future__ import annotations

import numpy as np

from insonify.kernels.common.types import SceneArrays, Solids
from insonify.optics.cutaway import Cutaway
from insonify.packing.targets import pack_solids
from insonify.scene.targets.shape import Solid, ball, frustum

FISH = np.array([0.85, 0.47, 0.03])  # as shown
SIZE = 0.045  # length over the longer side of the cutaway: larger than life, so that it shows
LINE = 0.0007  # of it: radius of the plumb line


def with_towfish(arrays: SceneArrays, cutaway: Cutaway, of_bed: int) -> SceneArrays:
    """Add the towfish, and a plumb line from it to the bed, to a packed scene."""
    longer = float((cutaway.high - cutaway.low)[:2].max())
    length, ahead = SIZE * longer, cutaway.axes[0]
    nose, waist, tail = (cutaway.lamp + share * length * ahead for share in (0.42, -0.3, -0.55))
    foot = np.array([*cutaway.lamp[:2], cutaway.low[2]])
    bodies = [
        frustum(waist, nose, 0.08 * length, 0.08 * length),
        ball(0.08 * length, nose),
        frustum(tail, waist, 0.02 * length, 0.08 * length),
        frustum(tail - 0.06 * length * ahead, tail + 0.1 * length * ahead, 0.12 * length, 0.02 * length),
        frustum(foot, cutaway.lamp, LINE * longer, LINE * longer),
    ]
    return arrays._replace(
        solids=_added(arrays.solids, bodies, len(arrays.reflectivity), of_bed),
        reflectivity=np.vstack([arrays.reflectivity, [0.3, 0.0, 1.0]]),
        interface=np.vstack([arrays.interface, [0.0, 1.0]]),
    )


def _added(solids: Solids, bodies: list[Solid], row: int, of_bed: int) -> Solids:
    """Append solids of one material."""
    own = pack_solids(bodies, np.full(len(bodies), row), np.full(len(bodies), row - of_bed))
    return Solids._make(np.concatenate(columns) for columns in zip(solids, own))
