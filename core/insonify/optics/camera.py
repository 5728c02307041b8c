"""Camera of a light picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.optics.cutaway import Cutaway, Vectors

AZIMUTH, DEPRESSION = math.radians(38.0), math.radians(33.0)  # of the view: astern and aside, and down
AWAY = 2.6  # of the diagonal of the cutaway
EDGE, HEADROOM = 0.02, 0.065  # of a picture's width, around the cutaway and above it, for a title
SHAPE = (0.42, 0.8)  # height of a picture over its width


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera: where it stands, and the window that it looks through."""

    place: Vectors  # (3,) local coordinates, in metres
    axes: Vectors  # (3, 3) rows: to the right, up, ahead
    low: Vectors  # (2,) corners of the window, as slopes to the right and up
    high: Vectors
    width: int  # of the picture, in pixels
    height: int

    def directions(self, rows: NDArray[np.int64], samples: int) -> Vectors:
        """Return unit directions through rows of pixels, (rows, samples, width, samples, 3); row 0 is at the top."""
        step = (self.high - self.low) / (self.width, self.height)
        part = (np.arange(samples) + 0.5) / samples
        right = self.low[0] + step[0] * (np.arange(self.width)[:, None] + part)
        up = self.high[1] - step[1] * (rows[:, None] + part)
        slopes = np.empty((rows.size, samples, self.width, samples, 3))
        slopes[..., 0], slopes[..., 1], slopes[..., 2] = right, up[:, :, None, None], 1.0
        ways = slopes @ self.axes
        return ways / np.linalg.norm(ways, axis=-1, keepdims=True)

    def project(self, place: Vectors) -> tuple[float, float]:
        """Project a point: pixels from the left and from the top."""
        right, up, ahead = self.axes @ (place - self.place)
        x, y = (np.array([right, up]) / ahead - self.low) / (self.high - self.low)
        return float(x * self.width), float((1.0 - y) * self.height)


def make_camera(cutaway: Cutaway, width: int) -> Camera:
    """Place a camera astern, aside and above a cutaway, with a window that shows all of it."""
    middle = 0.5 * (cutaway.low + cutaway.high)
    level = math.cos(DEPRESSION)
    back = (
        level * np.array([-math.cos(AZIMUTH), cutaway.aside * math.sin(AZIMUTH), math.tan(DEPRESSION)]) @ cutaway.axes
    )
    place = middle @ cutaway.axes + AWAY * float(np.linalg.norm(cutaway.high - cutaway.low)) * back
    right = np.cross(-back, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(right, -back), -back])
    seen = (cutaway.seen - place) @ axes.T
    slopes = seen[:, :2] / seen[:, 2:]
    low, high = slopes.min(axis=0), slopes.max(axis=0)
    wide = high[0] - low[0]
    low, high = low - EDGE * wide, high + wide * np.array([EDGE, HEADROOM])
    shape = float(np.clip((high[1] - low[1]) / (high[0] - low[0]), *SHAPE))
    half = np.maximum(0.5 * (high - low), 0.5 * np.array([(high[1] - low[1]) / shape, (high[0] - low[0]) * shape]))
    middle_seen = 0.5 * (low + high)
    return Camera(place, axes, middle_seen - half, middle_seen + half, width, round(width * half[1] / half[0]))
