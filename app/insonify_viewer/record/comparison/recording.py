"""A recording as the viewer shows it: amplitudes relative to its own median, and its navigation in words."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from insonify.arrays import Dataset, Floats, Singles
from insonify.io.georeference import find_georeference, to_degrees
from insonify.io.records import RECORDS
from insonify.scene import SceneError
from insonify_viewer.record.record import MAX_CELLS, MAX_PINGS
from insonify_viewer.record.record_image import COLUMNS
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.painting import column_means

UNKNOWN = "not recorded"
MOST_IN_MEMORY = 2**23  # amplitudes of a side
BLOCK = 512  # pings whose overview is computed at once


@dataclass(frozen=True, eq=False)
class StoredAmplitudes:
    """Relative amplitudes of a long recording, which are read from its file when they are needed for."""

    shape: tuple[int, int, int]  # pings, sides and bins
    relate: Callable[[Any], Singles]  # pings to their amplitudes

    def __getitem__(self, pings: Any) -> Singles:
        return self.relate(pings)


@dataclass(frozen=True, eq=False)
class Recording:
    """A record that was read from a file."""

    path: Path  # the file
    dataset: Dataset  # the record, from ``records.read_record``
    # (pings, 2, bins) amplitudes relative to the median curve of the record; port first, near to far.
    amplitude: "Singles | StoredAmplitudes"
    # (pings,) height of the sonar above the bed in metres, as recorded, else by the bottom track; NaN where
    # neither is known.
    altitude: Floats

    @cached_property
    def overview(self) -> Singles:
        """Amplitudes in a few columns, from far port to far starboard, (pings, columns)."""
        found = np.empty((self.pings, COLUMNS), dtype=np.float32)
        for first in range(0, self.pings, BLOCK):
            each = self.amplitude[first : first + BLOCK]
            found[first : first + BLOCK] = column_means(np.concatenate([each[:, 0, ::-1], each[:, 1]], axis=1), COLUMNS)
        return found

    @property
    def pings(self) -> int:
        """Number of pings."""
        return self.amplitude.shape[0]

    @property
    def bins(self) -> int:
        """Range bins per side."""
        return self.amplitude.shape[2]

    @property
    def held(self) -> int:
        """Number of pings that are on screen at once."""
        return max(min(self.pings, MAX_PINGS, MAX_CELLS // (2 * self.bins)), 1)

    @property
    def slant_range(self) -> float:
        """Slant range of the outer edge of the last bin, in metres."""
        return 2.0 * float(self.dataset["slant_range"].values[0]) * self.bins

    @property
    def ping_rate(self) -> float:
        """Mean number of pings a second; 1 where the record has no times."""
        times = self.dataset["ping_time"].values
        lasts = float(times[-1] - times[0])
        return (self.pings - 1) / lasts if lasts > 0.0 else 1.0

    @property
    def step(self) -> float:
        """Mean distance between pings in metres; where the fish does not move, that of a picture as long as wide."""
        x, y = (self.dataset[f"platform_{axis}"].values for axis in "xy")
        towed = float(np.hypot(np.diff(x), np.diff(y)).sum())
        return towed / (self.pings - 1) if towed > 0.0 else 2.0 * self.slant_range / self.held

    def slant_range_of(self, range_bin: int) -> float:
        """Slant range of the centre of a bin, in metres."""
        return float(self.dataset["slant_range"].values[range_bin])

    def value(self, name: str, ping: int) -> float:
        """Value of a platform variable at a ping; NaN where the record lacks it."""
        column = self.dataset.variables.get(f"platform_{name}")
        return math.nan if column is None else float(column.values[ping])


def is_recording(path: str) -> bool:
    """Whether a file is, by its suffix, a recording or a record rather than a scene."""
    return Path(path).suffix.lower() in (*RECORDS.readable(), *RECORDS.suffixes("converter"))


def load_recording(path: str, frequency: float | None = None) -> Recording:
    """Read a record and relate it to its own median curve, as ``insonify compare`` draws it."""
    # lazy: loads SciPy and kernels on a thread of its own; the window opens before
    from insonify.display.normalisation import normalise
    from insonify.display.picture import compile_picture
    from insonify.display.sheet import find_median_curve
    from insonify.io.record_schema import read_echoes
    from insonify.io.records import read_record
    from insonify.io.records.bottom_track import find_altitude

    compile_picture()
    dataset = read_record(path, frequency)
    altitude = find_altitude(dataset)
    curve = find_median_curve(dataset, altitude)

    def relate(pings: Any) -> Singles:
        return normalise(read_echoes(dataset, pings), curve.at(np.nan_to_num(altitude[pings]))[:, None])

    sides, pings, bins = dataset["intensity"].shape
    stored = StoredAmplitudes((pings, sides, bins), relate)
    # What fits is read once, so that playing it needs no file.
    amplitude = stored if pings * bins > MOST_IN_MEMORY else stored[:]
    recording = Recording(Path(path), dataset, amplitude, altitude)
    assert len(recording.overview) == recording.pings  # computed on this thread
    return recording


def describe_point(recording: Recording, mark: Mark) -> dict[str, str]:
    """Describe a point of a recording: where the sonar was, and what it received."""
    return {
        "ping": f"{mark.ping} of {recording.pings}",
        "time": _time(recording, mark.ping),
        "position": _position(recording, mark.ping),
        "heading": _quantity(compass_heading(recording.value("heading", mark.ping)), ".1f", "°"),
        "altitude": _quantity(recording.value("altitude", mark.ping), ".2f", " m"),
        "slant range": f"{recording.slant_range_of(mark.bin):.2f} m, {mark.side_name}",
        "level": _level(recording, mark),
    }


def _level(recording: Recording, mark: Mark) -> str:
    try:
        level = float(recording.amplitude[mark.ping : mark.ping + 1][0, mark.side, mark.bin])
    except SceneError:  # the file of a long recording has been moved
        return "its file is gone"
    return f"{20.0 * math.log10(level):+.1f} dB re median".replace("-", "−") if level > 0.0 else "no echo"


def explain_point(recording: Recording, mark: Mark) -> tuple[str, str]:
    """Describe in two sentences what is known of a pixel of a recording, on a flat bed."""
    known = describe_point(recording, mark)
    slant, altitude = recording.slant_range_of(mark.bin), float(recording.altitude[mark.ping])
    if not math.isfinite(altitude):
        place = "its place on the bed is not known without an altitude"
    elif slant <= altitude:
        place = f"in the water column: nearer than the bed, {altitude:.2f} m beneath"
    else:
        ground = math.sqrt(slant**2 - altitude**2)
        place = (
            f"flat bed at {ground:.2f} m ground range, grazing angle {math.degrees(math.asin(altitude / slant)):.1f}°"
        )
        heading = math.radians(recording.value("heading", mark.ping) + (90.0 if mark.side == 0 else -90.0))
        if math.isfinite(heading):
            place += f", {_position(recording, mark.ping, (ground * math.cos(heading), ground * math.sin(heading)))}"
    height = f"altitude {altitude:.2f} m" if math.isfinite(altitude) else f"altitude {UNKNOWN}"
    return (
        f"recorded pixel, {known['level']} at its range; a recording does not tell what returned the echo",
        f"recorded ping {mark.ping}, {known['slant range']}, {height}: {place}",
    )


def summarise_point(recording: Recording, mark: Mark) -> str:
    """Describe a point of a recording in one line, without what the file lacks."""
    known = {name: text for name, text in describe_point(recording, mark).items() if text != UNKNOWN}
    parts = [f"recorded ping {mark.ping}", f"slant {known['slant range']}"]
    parts += [f"{name} {known[name]}" for name in ("altitude", "heading") if name in known]
    return "  ·  ".join([*parts, known["level"]])


def compass_heading(heading_deg: float) -> float:
    """Heading by the compass, 0 to 360 degrees clockwise from north, of one counter-clockwise from east."""
    return (90.0 - heading_deg) % 360.0


def _time(recording: Recording, ping: int) -> str:
    """Date and time of a ping where the record has its start time, else seconds since its first ping."""
    seconds = float(recording.dataset["ping_time"].values[ping])
    try:
        begin = datetime.fromisoformat(str(recording.dataset.attrs["time_coverage_start"]))
    except (KeyError, ValueError):
        return f"{seconds:.2f} s"
    at = begin + timedelta(seconds=seconds)
    return f"{at:%Y-%m-%d %H:%M:%S}.{at.microsecond // 10_000:02d}"


def _position(recording: Recording, ping: int, off: tuple[float, float] = (0.0, 0.0)) -> str:
    """Latitude and longitude of a place off the sonar where the record has them, else metres."""
    latitude, longitude = recording.value("latitude", ping), recording.value("longitude", ping)
    x, y = (recording.value(axis, ping) + part for axis, part in zip("xy", off))
    place = find_georeference(recording.dataset.attrs)
    if any(off) and place is not None and place.crs:
        longitude, latitude = (float(each[0]) for each in to_degrees(place, np.array([x]), np.array([y])))
    if math.isfinite(latitude) and math.isfinite(longitude):
        north, east = "N" if latitude >= 0.0 else "S", "E" if longitude >= 0.0 else "W"
        return f"{abs(latitude):.5f}° {north}, {abs(longitude):.5f}° {east}"
    return f"x {x:.1f} m, y {y:.1f} m".replace("-", "−")


def _quantity(value: float, form: str, unit: str) -> str:
    return f"{value:{form}}{unit}" if math.isfinite(value) else UNKNOWN
