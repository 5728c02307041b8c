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
FARTHEST = 1e4  # m
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
    suffix = log.suffix.lower()
    kind = "<u2" if suffix == ".rsd" else "u1"
    columns = {name: np.concatenate([side.numbers[name] for side in headers]) for name in (*NUMBERS, *PLACES)}
    rows = np.repeat((0, 1), [side.numbers["index"].size for side in headers])
    # What a cut log lacks, and what a damaged header places beyond its end.
    begins = columns["index"] + columns["son_offset"]
    sizes = np.array([os.path.getsize(side.file) for side in headers])[rows]
    whole = begins + np.dtype(kind).itemsize * columns["ping_cnt"] <= sizes
    order = np.argsort(columns["time_s"], kind="stable")
    order = order[whole[order]]
    if not whole.all():
        recording.warn_of_cut(log, int(np.nanmin(columns["index"][~whole])), order.size)
    columns = {name: column[order] for name, column in columns.items()}
    near, reach, counts = np.nan_to_num(columns["min_range"]), columns["max_range"], columns["ping_cnt"]
    if not ((counts > 0.0) & (near >= 0.0) & (near < reach) & (reach < FARTHEST)).all():
        raise FileFault("has pings without a range", REMEDY)
    formats: dict[recording.SideFormat, int] = {}
    index = recording.EchoIndex()
    silent = np.rint(near / (reach - near) * counts)
    for row, at, count, before, end in zip(rows[order], begins[order], counts, silent, reach):
        far_first = row == 0 and suffix in FAR_FIRST
        form = recording.SideFormat(kind, 1, int(count), int(before), bool(far_first), 1.0)
        index.add({int(row): recording.Side(int(at), formats.setdefault(form, len(formats)), float(end))})
    stamps = np.rint(1e3 * columns["time_s"]).astype(np.int64)
    kept, sides = recording.join_sides(index.columns(), np.zeros_like(stamps), stamps)
    track = _track(log, {name: column[kept] for name, column in columns.items()}, min(side.start for side in headers))
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
