"""Logs of fishfinders with side scan, whose headers PINGVerter reads; it comes with the extra ``fishfinder``."""

import io
import os
import tempfile
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Dataset, Floats
from insonify.io.file_access import FileFault
from insonify.io.formats import FileFormat
from insonify.io.isolation import run_isolated
from insonify.io.records import recording

CONVERTERS = {".sl2": "low2pingmapper", ".sl3": "low2pingmapper", ".rsd": "gar2pingmapper", ".dat": "hum2pingmapper"}
FAR_FIRST = (".sl2", ".sl3")  # logs whose samples to port are stored from far to near
BEAMS = ("B002", "B003")  # port and starboard
NUMBERS = ("time_s", "lon", "lat", "instr_heading", "inst_dep_m", "min_range", "max_range", "f")
PLACES = ("index", "son_offset", "ping_cnt")  # of a ping: its byte in the file, bytes before its samples, samples
REMEDY = "give a whole log of a fishfinder with side scan, or export it as XTF"


class _SideHeaders(NamedTuple):
    """Headers of the pings of one side."""

    file: str  # that holds the samples
    numbers: dict[str, Floats]  # (pings,) each, by NUMBERS and PLACES; NaN without a value
    start: str  # date and time of the first ping


def read_fishfinder(path: str | Path) -> Dataset:
    """Read the side scan of a log of a fishfinder."""
    try:
        import pingverter  # noqa: F401  whether it is there
    except ImportError:
        raise FileFault("is a log of a fishfinder", 'install its reader: pip install "insonify[fishfinder]"') from None
    log = _log_of(Path(path))
    headers: tuple[_SideHeaders, ...] = run_isolated(read_headers, str(log))
    kind, far_first = "<u2" if log.suffix.lower() == ".rsd" else "u1", log.suffix.lower() in FAR_FIRST
    rows = [(row, ping) for row, side in enumerate(headers) for ping in range(side.numbers["time_s"].size)]
    times = np.array([headers[row].numbers["time_s"][ping] for row, ping in rows])
    order = np.argsort(times, kind="stable")
    formats: dict[recording.SideFormat, int] = {}
    index = recording.EchoIndex()
    for row, ping in (rows[each] for each in order):
        each = {name: column[ping] for name, column in headers[row].numbers.items()}
        count, near, reach = int(each["ping_cnt"]), np.nan_to_num(each["min_range"]), each["max_range"]
        if not (count > 0 and 0.0 <= near < reach < 1e4):
            raise FileFault(f"has no range of ping {ping}", REMEDY)
        form = recording.SideFormat(kind, 1, count, round(near / (reach - near) * count), far_first and row == 0, 1.0)
        place = int(each["index"] + each["son_offset"])
        index.add({row: recording.Side(place, formats.setdefault(form, len(formats)), reach)})
    stamps = np.rint(1e3 * times[order]).astype(np.int64)
    begins, sides = recording.join_sides(index.columns(), np.zeros_like(stamps), stamps)
    columns = {
        name: np.array([headers[row].numbers[name][ping] for row, ping in (rows[each] for each in order[begins])])
        for name in NUMBERS
    }
    first = min(headers, key=lambda side: side.start)
    track = _track(log, columns, first.start)
    files = tuple(Path(side.file) for side in headers)
    return recording.assemble(log, formats, sides, track, recording.DEFAULT_SPEED, files)


def _log_of(path: Path) -> Path:
    """Return the file that describes a log: of Humminbird's the one beside the folder of the samples."""
    if path.suffix.lower() not in (".son", ".idx"):
        return path
    beside = [path.parent.with_suffix(suffix) for suffix in (".DAT", ".dat")]
    found = next((each for each in beside if each.is_file()), None)
    if found is None:
        raise FileFault(f"lacks {beside[0].name} beside its folder", "copy the whole log")
    return found


def read_headers(path: str) -> tuple[_SideHeaders, ...]:
    """Read the headers of the pings to port and starboard, in a process of its own."""
    # The library writes tables, prints, starts processes and may end the program.
    import joblib
    import pandas as pd
    import pingverter

    with tempfile.TemporaryDirectory() as folder, redirect_stdout(io.StringIO()), joblib.parallel_config("sequential"):
        try:
            log = getattr(pingverter, CONVERTERS[Path(path).suffix.lower()])(path, folder)
        except SystemExit as error:
            raise FileFault("has no headers of pings", REMEDY) from error
        found = [log.beamMeta.get(beam) for beam in BEAMS]
        if None in found:
            raise FileFault("holds no side-scan pings", REMEDY)
        return tuple(_side_headers(each, pd.read_csv(each["metaCSV"])) for each in found if each)


def _side_headers(beam: dict[str, Any], table: Any) -> _SideHeaders:
    numbers = {
        name: table[name].to_numpy(np.float64) if name in table else np.full(len(table), np.nan)
        for name in (*NUMBERS, *PLACES)
    }
    return _SideHeaders(
        os.path.abspath(beam["sonFile"]), numbers, f"{table['date'].iloc[0]}T{table['time'].iloc[0]}"[:23]
    )


def _track(path: Path, columns: dict[str, Floats], start: str) -> recording.RecordedTrack:
    """Navigation of the pings: that of the boat, whose transducer is at the surface."""
    times = recording.spread_ticks(path, columns["time_s"])
    fixes = recording.Fixes(np.nan_to_num(columns["lon"]), np.nan_to_num(columns["lat"]), True)
    x, y = fixes.positions(times) or (np.zeros_like(times), np.zeros_like(times))
    unknown, heading, depth = np.full_like(times, np.nan), columns["instr_heading"], columns["inst_dep_m"]
    navigation = (
        x, y, unknown, recording.fill_gaps(depth, depth > 0.0),
        recording.heading_from_compass(np.nan_to_num(heading), np.isfinite(heading)), unknown, unknown,
    )  # fmt: skip
    attributes: dict[str, Any] = {"frequency": 1e3 * max(float(np.nan_to_num(columns["f"][0])), 0.0)}
    attributes |= {"time_coverage_start": start} | (fixes.place.attributes() if fixes.place else {})
    return recording.RecordedTrack(times, navigation, attributes)


LOWRANCE = FileFormat("Lowrance SL2 or SL3", (".sl2", ".sl3"), read_fishfinder, remedy=REMEDY)
GARMIN = FileFormat("Garmin RSD", (".rsd",), read_fishfinder, remedy=REMEDY)
HUMMINBIRD = FileFormat("Humminbird DAT and SON", (".dat", ".son", ".idx"), read_fishfinder, remedy=REMEDY)
