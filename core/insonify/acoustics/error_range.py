"""Slant range beyond which errors count; nearer bins hold strong echoes near nadir, to which no tolerance applies."""

from __future__ import annotations

import math

from insonify.kernels.common.types import Poses, SceneArrays

ERROR_ALTITUDES = 1.4  # altitudes of the sonar above the mean bed


def find_first_bin(altitudes: float, arrays: SceneArrays, poses: Poses) -> int:
    """First bin that lies beyond a number of altitudes under every pose, at most the number of bins."""
    return min(math.ceil(altitudes * float(poses.z.max(initial=0.0)) / arrays.bin_length), arrays.bins)
