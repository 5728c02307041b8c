"""Records and mosaics laid over a picture of the bed seen from above."""

import math
from dataclasses import dataclass

import numpy as np

from insonify.arrays import Bytes, Floats, Singles
from insonify.display.picture import average_columns, place_columns
from insonify.display.range_axis import GROUND, make_range_axis
from insonify.errors import SceneError
from insonify.io.bathymetry import Grid
from insonify.io.georeference import Georeference, project
from insonify.kernels.common.types import Poses
from insonify_viewer.record.tone_map import ToneMap

MOST = 8  # places between two pings


@dataclass(frozen=True, eq=False)
class RecordStrip:
    """Successive pings of a record, and where they were sent."""

    poses: Poses  # of the pings
    amplitude: Singles  # (n, 2 bins) from far port to far starboard
    altitude: Floats  # (n,) in metres
    bin_length: float  # slant range of a bin in metres
    tone_map: ToneMap  # colours of amplitudes


@dataclass(frozen=True, eq=False)
class MosaicSheet:
    """A mosaic in colours, and the place of a scene on its map."""

    name: str  # of its file
    grid: Grid
    colours: Bytes  # (rows, columns, 4) red, green, blue, opacity; row 0 at the least y
    place: Georeference | None  # of the scene

    def __post_init__(self) -> None:
        if self.grid.crs and (self.place is None or not self.place.crs):
            raise SceneError(
                f"{self.name}: lies on the map {self.grid.crs}, but the scene has no place on Earth; "
                "set world.crs and world.origin"
            )

    def to_map(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Transform the scene's x and y to the map; a mosaic without a map is in these coordinates."""
        if not self.grid.crs or self.place is None:
            return x, y
        x, y = x + self.place.origin[0], y + self.place.origin[1]
        return (x, y) if self.place.crs == self.grid.crs else project(self.place.crs, self.grid.crs, x, y)


def drape_mosaic(image: Bytes, centre: tuple[float, float], half: float, sheet: MosaicSheet) -> Bytes:
    """Lay a mosaic over a square picture of the bed, which stays where the mosaic has no level."""
    assert sheet.grid.corner is not None
    assert sheet.grid.spacing is not None
    # A map is straight over a window of the bed to far less than a texel: three corners place the others.
    x, y = sheet.to_map(centre[0] + half * np.array([-1.0, 1.0, -1.0]), centre[1] + half * np.array([1.0, 1.0, -1.0]))
    share = (np.arange(len(image)) + 0.5) / len(image)
    easting, northing = (
        each[0] + (each[1] - each[0]) * share + (each[2] - each[0]) * share[:, None] for each in (x, y)
    )
    column = np.rint((easting - sheet.grid.corner[0]) / sheet.grid.spacing[0]).astype(np.int64)
    row = np.rint((northing - sheet.grid.corner[1]) / sheet.grid.spacing[1]).astype(np.int64)
    rows, columns = sheet.grid.heights.shape
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    found = sheet.colours[np.where(inside, row, 0), np.where(inside, column, 0)]
    return np.where((inside & (found[..., 3] > 0))[..., None], found[..., :3], image)


def drape_record(image: Bytes, centre: tuple[float, float], half: float, strip: RecordStrip) -> Bytes:
    """Lay a record over a square picture of the bed, each echo at the ground range of a level bed."""
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


def _places(poses: Poses, left: Floats, texel: float) -> list[tuple[Floats, Floats]]:
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
