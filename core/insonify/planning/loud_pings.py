"""Search for loud pings: glints of a rough bed may give one ping more energy than all others of a record together."""

from __future__ import annotations

import numpy as np

from insonify.acoustics.error_range import ERROR_ALTITUDES, find_first_bin
from insonify.packing.packed_scene import Model, PackedScene
from insonify.planning.probe import scale_to_flat_bed
from insonify.planning.probe_pings import ProbePings, spread_over_track
from insonify.tow.poses import make_poses

SEARCHED, FOUND = 48, 2  # pings over the track that are searched, and the most of them that are added
LOUD = 3.0  # times the mean energy of those searched


def add_loud_pings(packed: PackedScene, pings: ProbePings) -> ProbePings:
    """Add those pings over the track that are much louder than others, by one plane over the bed alone."""
    if packed.scene.seabed.relief.level:
        return pings
    searched = spread_over_track(packed.scene, SEARCHED)
    poses = make_poses(packed.scene, packed.ground, searched)
    first = find_first_bin(ERROR_ALTITUDES, packed.arrays, poses)
    record = packed.trace(Model(), poses)[:, :, first:] * scale_to_flat_bed(packed.arrays, poses, first)
    energy = np.square(record, dtype=np.float64).sum(axis=(1, 2))
    loudest = np.argsort(-energy, kind="stable")[:FOUND]
    loud = loudest[energy[loudest] > LOUD * energy.mean()]
    return pings._replace(spread=np.union1d(pings.spread, searched[loud]))
