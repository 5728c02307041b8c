"""Recordings of real sonars: positions with gaps, and the pings of one frequency on a common grid of slant range."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Booleans, Dataset, Floats, Singles
from insonify.errors import FileWarning, warn_caller
from insonify.io.file_access import FileFault
from insonify.io.georeference import Georeference, find_georeference, from_degrees, local_georeference
from insonify.io.record_block import make_record_block
from insonify.io.record_schema import ACROSS, coordinates, describe, platform
from insonify.io.records.bottom_track import BOTTOM_TRACK, track_bottom

DEFAULT_SPEED = 1500.0  # m/s, where the file has no plausible one
PLAUSIBLE_SPEEDS = (1300.0, 1700.0)  # m/s
WIDEST = 8  # bins per sample of the longest ping; a corrupt range gives more
LOUDEST = 1e18  # the square of an amplitude must fit a float32
NEAR = 0.1  # relative difference of two frequencies that count as the same
FARTHEST = 1e8  # m, of any map's coordinates
DAY = 86400.0  # s


class SideEchoes(NamedTuple):
    """Echoes of one side of one ping."""

    amplitude: Singles  # (samples,) near to far
    slant_range: float  # m, of its last edge
    sound_speed: float  # m/s, as the sonar assumed it


class RecordedTrack(NamedTuple):
    """Time, position and attitude of pings, and further attributes of a recording."""

    times: Floats  # (pings,) s since the first
    columns: Sequence[Floats]  # in the order and units of PLATFORM
    attributes: dict[str, Any]


def plausible_speed(*speeds: float) -> float:
    """Return the first of some sound speeds that water can have, in m/s; the default if none."""
    low, high = PLAUSIBLE_SPEEDS
    return next((speed for speed in speeds if low <= speed <= high), DEFAULT_SPEED)


def check_amplitude(ping: int, amplitude: Singles) -> None:
    """Raise FileFault for samples that are not finite, or too large for their square to be stored."""
    if not (np.isfinite(amplitude).all() and amplitude.max() < LOUDEST):
        raise FileFault(f"has samples in ping {ping} that are not echoes", "export it again")


def warn_of_cut(path: Path, at: int, whole: int) -> None:
    """Warn that a recording ends within a packet, at a byte; raise FileFault if no packet before has echoes."""
    if whole == 0:
        raise FileFault(f"ends within the packet at byte {at}, before one ping is whole", "copy it again")
    warn_caller(FileWarning(f"{path}: ends within the packet at byte {at}; the whole pings before are read"))


def choose_band(frequencies: Mapping[int, float], wanted: float | None) -> tuple[int, dict[str, Any]]:
    """Return the band of the wanted frequency, and attributes of it and of all where there are several; in Hz."""
    band = next(iter(frequencies))
    if wanted is not None:
        band = min(frequencies, key=lambda each: abs(frequencies[each] - wanted))
        if abs(frequencies[band] - wanted) > NEAR * wanted:
            known = " or ".join(f"{frequency:g}" for frequency in frequencies.values() if frequency > 0.0)
            remedy = f"choose {known}" if known else "leave it out"
            raise FileFault(f"has no channels of {wanted:g} Hz", remedy)
    every = ", ".join(f"{frequency:g}" for frequency in frequencies.values())
    return band, {"frequency": frequencies[band]} | ({"frequencies": every} if len(frequencies) > 1 else {})


class Fixes(NamedTuple):
    """Positions as a recording has them."""

    # (pings,) longitude and latitude in degrees, or easting and northing in metres; both 0 or not finite without
    # a fix.
    x: Floats
    y: Floats
    degrees: bool

    @property
    def known(self) -> Booleans:
        """Which pings have a fix: not zero, and within the map."""
        widest, highest = (180.0, 90.0) if self.degrees else (FARTHEST, FARTHEST)
        inside = (np.abs(self.x) <= widest) & (np.abs(self.y) <= highest)
        return ((self.x != 0.0) | (self.y != 0.0)) & inside

    @property
    def place(self) -> Georeference | None:
        """Place of the first fix; None without any. Metres have no map."""
        known = self.known
        if not known.any():
            return None
        first = float(self.x[np.argmax(known)]), float(self.y[np.argmax(known)])
        return local_georeference(*first) if self.degrees else Georeference("", first)

    def positions(self, times: Floats) -> tuple[Floats, Floats] | None:
        """Metres east and north of the first fix at every ping; None without any."""
        # Fixes repeat because they are rarer than pings; positions between them are interpolated over time.
        place, moved = self.place, self.known
        if place is None:
            return None
        first = int(np.argmax(moved))
        moved[1:] &= (self.x[1:] != self.x[:-1]) | (self.y[1:] != self.y[:-1])
        moved[first] = True
        east, north = np.zeros_like(self.x), np.zeros_like(self.y)
        if self.degrees:
            east[moved], north[moved] = from_degrees(place, self.x[moved], self.y[moved])
        else:
            east[moved], north[moved] = self.x[moved] - place.origin[0], self.y[moved] - place.origin[1]
        return fill_gaps(east, moved, times), fill_gaps(north, moved, times)


def fill_gaps(values: Floats, known: Booleans, at: Floats | None = None) -> Floats:
    """Interpolate unknown values; NaN if all are unknown."""
    if not known.any():
        return np.full(values.shape, np.nan)
    at = np.arange(values.size, dtype=np.float64) if at is None else at
    return np.interp(at, at[known], values[known])


def heading_from_compass(compass: Floats, known: Booleans) -> Floats:
    """Return headings counter-clockwise from east, within 180° of it, from bearings clockwise from north; degrees."""
    heading = 90.0 - np.degrees(np.unwrap(np.radians(fill_gaps(compass, known))))
    return (heading + 180.0) % 360.0 - 180.0


def assemble(path: Path, pings: Sequence[dict[int, SideEchoes]], track: RecordedTrack) -> Dataset:
    """Lay the pings of a recording on a common grid of slant range, with the median bin length."""
    sides = [side for ping in pings for side in ping.values()]
    bin_length = sorted(side.slant_range / side.amplitude.size for side in sides)[len(sides) // 2]
    bins = max(round(side.slant_range / bin_length) for side in sides)
    most = max(side.amplitude.size for side in sides)
    if bins > WIDEST * most:
        raise FileFault(
            f"has slant ranges up to {bins * bin_length:.3g} m in bins of {bin_length:.3g} m", "export it again"
        )
    amplitude = np.zeros((2, len(pings), bins), dtype=np.float32)
    for number, ping in enumerate(pings):
        for row, side in ping.items():
            _lay(amplitude[row, number], side, bin_length)
    slant_range, intensity = (np.arange(bins) + 0.5) * bin_length, amplitude**2
    bottom = track_bottom(intensity, bin_length)
    return make_record_block(
        {
            "intensity": (ACROSS, intensity, describe("1", "square of the samples")),
            BOTTOM_TRACK: (ACROSS[1], bottom, describe("m", "slant range of the first echo of the bed in the record")),
        }
        | platform(track.columns, find_georeference(track.attributes)),
        coordinates(track.times, slant_range, sides[0].sound_speed),
        {"title": os.fsencode(path.name).decode(errors="replace")} | track.attributes,
    ).to_dataset()


def _lay(row: Singles, side: SideEchoes, bin_length: float) -> None:
    """Store a side in its row; one of another bin length is interpolated."""
    samples, step = side.amplitude, side.slant_range / side.amplitude.size
    if abs(side.slant_range - samples.size * bin_length) < 0.5 * bin_length:
        row[: samples.size] = samples[: row.size]
        return
    count = min(round(side.slant_range / bin_length), row.size)
    row[:count] = np.interp((np.arange(count) + 0.5) * bin_length, (np.arange(samples.size) + 0.5) * step, samples)
