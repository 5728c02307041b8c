"""Recordings of real sonars: positions with gaps, and the pings of one frequency on a common grid of slant range."""

import errno
import math
import os
from array import array
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from insonify.arrays import Booleans, Bytes, Dataset, Floats, Integers, Singles
from insonify.errors import FileWarning, SceneError, warn_caller
from insonify.io.file_access import FileFault, open_regular, reason
from insonify.io.georeference import Georeference, find_georeference, from_degrees, local_georeference
from insonify.io.record_block import make_record_block
from insonify.io.record_schema import ACROSS, coordinates, describe, platform
from insonify.io.records.bottom_track import BOTTOM_TRACK, track_bottom

DEFAULT_SPEED = 1500.0  # m/s, where the file has no plausible one
PLAUSIBLE_SPEEDS = (1300.0, 1700.0)  # m/s
WIDEST = 8  # bins per sample of the longest ping; a corrupt range gives more
LOUDEST = 1e18  # the square of an amplitude must fit a float32
FREQUENCY_RANGE = 0.1  # relative difference of two frequencies that count as the same
FARTHEST_PLACE = 1e8  # m, of any map's coordinates
DAY = 86400.0  # s
ABSENT = -1  # format of a side that a ping lacks
FEW_ECHOES = 2**23  # echoes up to which a recording is held in memory
ECHOES_TOGETHER = 2**20  # echoes that are decoded at a time
SPEED_RATIO = 4.0  # ratio of two speeds that are the same
SLOWEST = 0.2  # m/s, of a recorded speed that counts
SPEEDS = (0.2, 20.0)  # m/s, of a sonar under way
LEAST_WAY = 20.0  # m, of a speed that counts against positions
STANDING = 0.05  # share of that way below which positions stand still
THIN = 16  # pings over which fixes that scatter about a place come back to it
SPARSE = 16  # times the bytes wanted, in a stretch of a file that is read for them


class SideFormat(NamedTuple):
    """How a file stores the samples of one side of a ping, and what they are."""

    dtype: str  # of a number
    numbers: int  # of a sample: 1, or 2 of an analytic signal
    length: int  # samples
    silent: int  # samples of the time between transmission and recording, which are not stored
    far_first: bool  # whether they are stored from far to near
    scale: float  # amplitude of the number 1

    @property
    def stored(self) -> int:
        """Bytes in the file."""
        return self.numbers * self.length * np.dtype(self.dtype).itemsize

    @property
    def unchecked(self) -> bool:
        """Whether the numbers may be no amplitudes: not finite, or too large for their square to be stored."""
        kind = np.dtype(self.dtype)
        return kind.kind == "f" or np.iinfo(kind).max * self.numbers * self.scale >= LOUDEST

    @property
    def samples(self) -> int:
        """Samples from the transmission on."""
        return self.silent + self.length

    def decode(self, content: Bytes) -> Singles:
        """Amplitudes near to far, (pings, samples), from the bytes of some pings, (pings, stored)."""
        values = np.ascontiguousarray(content).view(self.dtype).astype(np.float64)
        magnitude = np.abs(values) if self.numbers == 1 else np.hypot(values[:, ::2], values[:, 1::2])
        amplitude = np.zeros((len(content), self.samples), dtype=np.float32)
        amplitude[:, self.silent :] = (magnitude * self.scale)[:, :: -1 if self.far_first else 1]
        return amplitude


class Side(NamedTuple):
    """Echoes of one side of one ping in a file."""

    at: int  # byte at which its samples begin
    format: int  # number of their `SideFormat`; ABSENT without echoes
    slant_range: float  # m, of its last edge


NO_SIDE = Side(0, ABSENT, 0.0)


class SideColumns(NamedTuple):
    """Echoes of both sides of some pings in a file, (2, pings) each; port first."""

    at: Integers
    format: NDArray[np.int32]
    slant_range: Floats

    def take(self, pings: Integers) -> "SideColumns":
        """Return the values of some pings."""
        return SideColumns(self.at[:, pings], self.format[:, pings], self.slant_range[:, pings])


class EchoIndex:
    """Where a file holds the echoes of the pings of one frequency: 20 bytes a side, whatever its samples."""

    def __init__(self) -> None:
        self._at, self._format, self._slant_range = array("q"), array("i"), array("d")

    def add(self, sides: Mapping[int, Side]) -> None:
        """Add a ping by the sides that it has, 0 port and 1 starboard."""
        for row in (0, 1):
            side = sides.get(row, NO_SIDE)
            self._at.append(side.at)
            self._format.append(side.format)
            self._slant_range.append(side.slant_range)

    def columns(self) -> SideColumns:
        """Return the index of all pings."""
        return SideColumns(
            np.frombuffer(self._at, dtype=np.int64).reshape(-1, 2).T,
            np.frombuffer(self._format, dtype=np.int32).reshape(-1, 2).T,
            np.frombuffer(self._slant_range, dtype=np.float64).reshape(-1, 2).T,
        )


class StoredEchoes(NamedTuple):
    """Echoes of the pings of a recording in its file."""

    paths: Sequence[Path]  # of the files of port and starboard, which are mostly one
    signatures: Sequence[tuple[int, int]]  # their lengths and times of change
    formats: list[SideFormat]
    sides: SideColumns

    def intensity(self, pings: Integers, bins: int, bin_length: float) -> Singles:
        """Squares of the samples of some pings on a grid of slant range, (2, n, bins)."""
        out = np.zeros((2, pings.size, bins), dtype=np.float32)
        together = max(ECHOES_TOGETHER // (2 * bins), 1)
        for row, (path, signature) in enumerate(zip(self.paths, self.signatures)):
            try:
                with open_regular(path) as file:
                    if _signature(os.fstat(file.fileno())) != signature:
                        raise SceneError(f"{path}: has changed since it was opened; open it again")
                    for first in range(0, pings.size, together):
                        some = slice(first, first + together)
                        self._lay(file, row, pings[some], out[row, some], bin_length)
            except (OSError, FileFault) as error:
                why = error.fault if isinstance(error, FileFault) else reason(error)
                raise SceneError(f"{path}: cannot be read any more ({why}); open it again") from error
        return np.square(out, out=out)

    def _lay(self, file: BinaryIO, row: int, pings: Integers, out: Singles, bin_length: float) -> None:
        at, formats, slant_range = (column[row, pings] for column in self.sides)
        for number in np.unique(formats[formats != ABSENT]):
            some, form = np.flatnonzero(formats == number), self.formats[number]
            samples = form.decode(_gather(file, at[some], form.stored))
            for reach in np.unique(slant_range[some]):
                alike = slant_range[some] == reach
                _put_on_grid(samples[alike], float(reach), bin_length, out, some[alike])


class RecordedTrack(NamedTuple):
    """Time, position and attitude of pings, and further attributes of a recording."""

    times: Floats  # (pings,) s since the first
    columns: Sequence[Floats]  # in the order and units of PLATFORM
    attributes: dict[str, Any]


def plausible_speed(*speeds: float) -> float:
    """Return the first of some sound speeds that water can have, in m/s; the default if none."""
    low, high = PLAUSIBLE_SPEEDS
    return next((speed for speed in speeds if low <= speed <= high), DEFAULT_SPEED)


def check_amplitudes(ping: int, form: SideFormat, content: bytes) -> None:
    """Raise FileFault for samples that are not finite, or too large for their square to be stored."""
    with np.errstate(over="ignore", invalid="ignore"):
        amplitude = form.decode(np.frombuffer(content, dtype=np.uint8)[None])
    if not (np.isfinite(amplitude).all() and amplitude.max() < LOUDEST):
        raise FileFault(f"has samples in ping {ping} that are not echoes", "export it again")


def warn_of_cut(path: Path, at: int, whole: int) -> None:
    """Warn that a recording ends within a packet, at a byte; raise FileFault if no packet before has echoes."""
    if whole == 0:
        raise FileFault(f"ends within the packet at byte {at}, before one ping is whole", "copy it again")
    _warn(path, f"ends within the packet at byte {at}; the whole pings before are read")


def choose_band(frequencies: Mapping[int, float], wanted: float | None) -> tuple[int, dict[str, Any]]:
    """Return the band of the wanted frequency, with its attributes and those of all bands; in Hz."""
    band = next(iter(frequencies))
    if wanted is not None:
        band = min(frequencies, key=lambda each: abs(frequencies[each] - wanted))
        if abs(frequencies[band] - wanted) > FREQUENCY_RANGE * wanted:
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
        widest, highest = (180.0, 90.0) if self.degrees else (FARTHEST_PLACE, FARTHEST_PLACE)
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


def settle_units(path: Path, declared: Fixes, other: Fixes, times: Floats, speed: Floats) -> Fixes:
    """Return the fixes in the unit that the file declares, or in the other where only that can be; then warn."""
    if not declared.known.any() and other.known.any():
        unit = "degrees" if other.degrees else "metres"
        _warn(path, f"its positions are those of no place in the unit that it declares; they are read as {unit}")
        return other
    if declared.degrees or not other.known[declared.known].all():
        return declared
    slow, likely = _course_speed(declared, times), _course_speed(other, times)
    recorded = float(np.median(speed))
    least, most = (recorded / SPEED_RATIO, recorded * SPEED_RATIO) if recorded > SLOWEST else SPEEDS
    if not (0.0 < slow < 0.1 * least and least < likely < most):
        return declared
    _warn(
        path, f"declares positions in metres, which move by {slow:.2g} m/s; they are read as degrees: {likely:.2g} m/s"
    )
    return other


def check_advance(path: Path, x: Floats, y: Floats, run: float) -> None:
    """Warn of positions that stand still while the recorded speed gives a way, in metres."""
    towed = float(np.hypot(np.diff(x), np.diff(y)).sum())
    if run > LEAST_WAY and towed < STANDING * run:
        _warn(path, f"its positions move by {towed:.3g} m, its speed gives {run:.3g} m; the positions are taken")


def _course_speed(fixes: Fixes, times: Floats) -> float:
    """Speed along the fixes in m/s; 0 where they only scatter about a place."""
    found = fixes.positions(times)
    if found is None or not times[-1] > 0.0:
        return 0.0
    step = min(THIN, times.size - 1)
    every, thinned = (
        float(np.hypot(*(np.diff(axis[::some]) for axis in found)).sum() / times[::some][-1]) for some in (1, step)
    )
    return thinned if thinned > 0.5 * every else 0.0


def _warn(path: Path, sentence: str) -> None:
    warn_caller(FileWarning(f"{path}: {sentence}"))


def spread_ticks(path: Path, clock: Floats) -> Floats:
    """Seconds from the first ping to each, by a clock that may tick more rarely than the sonar pings."""
    # The pings of a tick are spread over the time to the next one; a recording without a clock gets a ping a second.
    number = np.arange(clock.size, dtype=np.float64)
    back = np.flatnonzero(np.diff(clock) < 0.0)
    if back.size:
        _warn(path, f"its clock goes back at ping {back[0] + 1}; it counts again from where it was before")
        clock = np.maximum.accumulate(clock)
    if not np.ptp(clock) > 0.0:
        return number
    first = np.flatnonzero(np.diff(clock, prepend=-np.inf) > 0.0)  # pings of the ticks
    if first.size == clock.size:
        return clock - clock[0]
    steps = np.diff(clock[first]) / np.diff(first)
    usual = float(np.median(steps))
    steps = np.append(np.where(steps > 2.0 * usual, usual, steps), usual)  # a pause is not filled
    tick = np.repeat(np.arange(first.size), np.diff(first, append=clock.size))
    times = clock[first][tick] + steps[tick] * (number - first[tick])
    # The first tick may have begun before the recording.
    head = int(first[1])
    times[:head] = clock[head] - np.arange(head, 0, -1) * min(usual, float(clock[head] - clock[0]) / head)
    return times - times[0]


def fill_gaps(values: Floats, known: Booleans, at: Floats | None = None) -> Floats:
    """Interpolate unknown values; NaN if all are unknown."""
    if known.all():
        return values
    if not known.any():
        return np.full(values.shape, np.nan)
    at = np.arange(values.size, dtype=np.float64) if at is None else at
    return np.interp(at, at[known], values[known])


def heading_from_compass(compass: Floats, known: Booleans) -> Floats:
    """Return headings counter-clockwise from east, within 180° of it, from bearings clockwise from north; degrees."""
    heading = 90.0 - np.degrees(np.unwrap(np.radians(fill_gaps(compass, known))))
    return (heading + 180.0) % 360.0 - 180.0


def join_sides(sides: SideColumns, numbers: Integers, stamps: Integers) -> tuple[Integers, SideColumns]:
    """Join sides that a file stores one by one; return the packets that begin a ping, and the sides of these.

    ``numbers`` and ``stamps`` are the ping numbers and the times of the packets, in any unit.
    """
    has = sides.format != ABSENT
    lone = has[0] != has[1]
    fits = lone[:-1] & lone[1:] & (has[0, :-1] != has[0, 1:])
    # Both sides of a ping share its number. Where numbers or else times pair no sides, they follow each other.
    keys = [key for key in (numbers, stamps) if np.ptp(key) > 0]
    pairs = (_greedy(fits & (key[1:] == key[:-1])) for key in keys)
    first = next((found for found in pairs if 4 * found.size >= lone.sum()), None)
    first = _greedy(fits) if first is None else first
    kept = np.ones(lone.size, dtype=np.bool_)
    kept[first + 1] = False
    begins = np.flatnonzero(kept)
    if first.size:
        columns: tuple[NDArray[Any], ...] = sides
        for column in columns:
            column[:, first] = np.where(has[:, first], column[:, first], column[:, first + 1])
        whole = (sides.format[:, begins] != ABSENT).all(axis=0)
        if whole[0] and not whole[-1]:  # the file ends between port and starboard
            begins = begins[:-1]
    joined = sides if begins.size == lone.size else sides.take(begins)
    return begins, joined._replace(
        format=_without_repeats(joined.format), slant_range=_without_repeats(joined.slant_range)
    )


def _without_repeats(values: NDArray[Any]) -> NDArray[Any]:
    """Return an array of one value as one that takes no memory."""
    first = values.flat[0]
    return np.broadcast_to(first, values.shape) if (values == first).all() else values


def _greedy(links: Booleans) -> Integers:
    """Places of links between neighbours, taken from the first on so that nothing is linked twice."""
    places = np.flatnonzero(links)
    begins = np.maximum.accumulate(np.where(np.diff(places, prepend=-2) > 1, places, 0))
    return places[(places - begins) % 2 == 0]


def _signature(status: os.stat_result) -> tuple[int, int]:
    return status.st_size, status.st_mtime_ns


def assemble(
    path: Path, formats: Iterable[SideFormat], sides: SideColumns, track: RecordedTrack, sound_speed: float,
    files: Sequence[Path] = (),
) -> Dataset:  # fmt: skip
    """Lay the pings of a recording on a common grid of slant range, with the median bin length."""
    # Echoes stay in the file, or in those of port and starboard, until they are needed, unless they are few.
    files = [each.absolute() for each in files or (path, path)]
    echoes = StoredEchoes(files, [_signature(each.stat()) for each in files], list(formats), sides)
    present = sides.format != ABSENT
    samples = np.array([form.samples for form in echoes.formats])[sides.format[present]]
    reaches = sides.slant_range[present]
    bin_length = float(np.partition(reaches / samples, samples.size // 2)[samples.size // 2])
    bins = round(reaches.max() / bin_length)
    if bins > WIDEST * samples.max():
        raise FileFault(
            f"has slant ranges up to {bins * bin_length:.3g} m in bins of {bin_length:.3g} m", "export it again"
        )
    del present, samples, reaches
    shape, slant_range = (2, sides.format.shape[1], bins), (np.arange(bins) + 0.5) * bin_length
    record = make_record_block(
        platform(track.columns, find_georeference(track.attributes)),
        coordinates(track.times, slant_range, sound_speed),
        {"title": os.fsencode(path.name).decode(errors="replace")} | track.attributes,
    ).to_dataset()
    # lazy: xarray is slow to import
    from insonify.io.deferred import defer

    intensity = defer(
        ACROSS, shape, "f4", lambda pings: echoes.intensity(pings, bins, bin_length),
        describe("1", "square of the samples"),
    )  # fmt: skip
    if math.prod(shape) <= FEW_ECHOES:
        intensity = intensity.load()
    track_once = cache(lambda: track_bottom(intensity, bin_length))
    bottom = defer(
        ACROSS[1:2], shape[1:2], "f8", lambda pings: track_once()[pings],
        describe("m", "slant range of the first echo of the bed in the record"),
    )  # fmt: skip
    if math.prod(shape) <= FEW_ECHOES:
        bottom = bottom.load()
    names = ["intensity", BOTTOM_TRACK, *record.data_vars]
    return record.assign({"intensity": intensity, BOTTOM_TRACK: bottom})[names]


def _gather(file: BinaryIO, at: Integers, size: int) -> Bytes:
    """Read as many bytes from some places of a file on, (places, size)."""
    first, last = int(at.min()), int(at.max()) + size
    if at.size > 1 and last - first > SPARSE * at.size * size:
        return np.concatenate([_gather(file, half, size) for half in np.array_split(at, 2)])
    file.seek(first)
    content = np.frombuffer(file.read(last - first), dtype=np.uint8)
    if content.size < last - first:
        raise OSError(errno.EIO, "it has become shorter")
    return sliding_window_view(content, size)[at - first]


def _put_on_grid(samples: Singles, slant_range: float, bin_length: float, out: Singles, pings: Integers) -> None:
    """Lay samples, (n, samples), in the rows of some pings; samples of another bin length are interpolated."""
    count, bins = samples.shape[1], out.shape[1]
    if abs(slant_range - count * bin_length) < 0.5 * bin_length:
        out[pings, :count] = samples[:, :bins]
        return
    wanted, step = min(round(slant_range / bin_length), bins), slant_range / count
    places, known = (np.arange(wanted) + 0.5) * bin_length, (np.arange(count) + 0.5) * step
    for ping, row in zip(pings, samples):
        out[ping, :wanted] = np.interp(places, known, row)
