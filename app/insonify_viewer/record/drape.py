"""Record laid over a picture of the bed seen from above, each echo at the ground range of a level bed."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.display.picture import average_columns, place_columns
from insonify.display.range_axis import GROUND, make_range_axis
from insonify.kernels.common.types import Poses
from insonify_viewer.record.tone_map import ToneMap

MOST = 8  # places between two pings


@dataclass(frozen=True, eq=False)
class RecordStrip:
    """Successive pings of a record, and where they were sent."""

    poses: Poses  # of the pings
    amplitude: NDArray[np.float32]  # (n, 2 bins) from far port to far starboard
    altitude: NDArray[np.float64]  # (n,) in metres
    bin_length: float  # slant range of a bin in metres
    tone_map: ToneMap  # colours of amplitudes


def drape_record(
    image: NDArray[np.uint8], centre: tuple[float, float], half: float, strip: RecordStrip
) -> NDArray[np.uint8]:
    """Lay a record over a square picture of the bed; what is higher or hidden lies where slant range puts it."""
    size, bins = len(image), strip.amplitude.shape[1] // 2
    lowest = float(strip.altitude.min(initial=math.inf))
    axis = make_range_axis(GROUND, bins, strip.bin_length, lowest)
    draped = image.copy()
    if axis is None or not len(strip.amplitude):
        return draped
    texel = 2.0 * half / size
    edges = np.arange(0.0, axis.reach, 0.5 * texel)
    position = place_columns(edges, strip.altitude, axis)
    heard = position[:, 1:] < bins
    for side, left in ((strip.amplitude[:, bins - 1 :: -1], 1.0), (strip.amplitude[:, bins:], -1.0)):
        words = strip.tone_map.colours(average_columns(np.ascontiguousarray(side), position))
        for x, y in _places(strip.poses, left * 0.5 * (edges[1:] + edges[:-1]), texel):
            column = np.floor((x - centre[0] + half) / texel).astype(np.int64)
            row = size - 1 - np.floor((y - centre[1] + half) / texel).astype(np.int64)
            inside = heard & (column >= 0) & (column < size) & (row >= 0) & (row < size)
            for channel, shift in enumerate((16, 8, 0)):
                draped[row[inside], column[inside], channel] = (words[inside] >> shift) & 0xFF
    return draped


def _places(
    poses: Poses, left: NDArray[np.float64], texel: float
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Places of samples to the left of every ping, (n, samples) each, and between pings that lie far apart."""
    ahead_x, ahead_y = (np.gradient(each) if len(each) > 1 else np.zeros(1) for each in (poses.x, poses.y))
    step = float(np.median(np.hypot(ahead_x, ahead_y)))
    between = min(math.ceil(step / texel), MOST) or 1
    sin, cos = np.sin(poses.heading)[:, None], np.cos(poses.heading)[:, None]
    return [
        (
            (poses.x + share * ahead_x)[:, None] - left * sin,
            (poses.y + share * ahead_y)[:, None] + left * cos,
        )
        for share in (np.arange(between) / between - 0.5 * (between - 1) / between)
    ]
