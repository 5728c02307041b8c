"""Records by exact rays, refined until they are good enough to judge others."""

from __future__ import annotations

import math

from insonify.statistics.record_errors import compare_records
from insonify.tracers import rays

FIRST_RAYS = 1 << 15
MOST_RAYS = 1 << 22


def reference(arrays, poses, *, tolerance):
    """Trace with twice as many rays until that moves the record by less than a tolerance; the record and its move."""
    count = FIRST_RAYS
    record = rays.trace(arrays, poses, rays=count)
    moved = math.inf
    while moved >= tolerance and count < MOST_RAYS:
        count *= 2
        finer = rays.trace(arrays, poses, rays=count)
        moved = compare_records(arrays, poses, record, finer).beyond
        record = finer
    return record, moved
