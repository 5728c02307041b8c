"""Casts as text: Sea-Bird's, sound-speed profiles of echo sounders, tables, and logs of instruments.

Logs of Valeport (Swift and MIDAS), of AML Oceanographic and of the Castaway have a heading, a line with the names of
the columns, and a row for each sample.
"""

import re
from collections.abc import Mapping

import numpy as np

from insonify.arrays import Floats
from insonify.io.file_access import FileFault, read_text
from insonify.io.formats import FileFormat
from insonify.io.sound_speed_casts import ENCODING, Columns

WIDTH = 11  # characters of a column, for tables without spaces between numbers
BAD = -9.99e-29  # marks a missing value
LATITUDE = 45.0  # degrees, for depth from pressure
# Names of columns and their units in seconds.
SECONDS = {"timeS": 1.0, "timeM": 60.0, "timeH": 3600.0, "timeJ": 86400.0}
CONDUCTIVITY = {"S/m": 10.0, "mS/cm": 1.0, "uS/cm": 1e-3}  # in mS/cm
IPTS68 = 1.00024  # degrees on IPTS-68 per degree on ITS-90 (Saunders 1990)
BYTE_ORDER_MARK = "\u00ef\u00bb\u00bf"  # read as Latin-1
SPEEDS = (1300.0, 1700.0)
# Names of columns in a header, in lower case and without units.
NAMES = {
    "time": r"time|seconds",
    "depth": r"depth|dep|z",
    "sound_speed": r"sound[ _]?(speed|velocity)|speed|velocity|sv|svp|c",
    "temperature": r"temperature|temp|t",
    "salinity": r"(practical )?salinity|sal|psal|s",
}
PREFIX = "Columns="  # of AML, before the names
PRESSURE = r"pressure|pres|prs"  # dbar
CLOCK = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}(?:\.\d+)?)\s*$")
DAY = 86400.0  # s
LOG_REMEDY = "export it as CSV with the columns depth and sound_speed"
LOG_NAMES = {
    **NAMES,
    "temperature": NAMES["temperature"] + "|tempct",
    "time": r"time|date ?/ ?time",
    "pressure": PRESSURE,
}


def read_seabird(path: str) -> Columns:
    """Read the columns of a converted cast."""
    text = read_text(path, ENCODING)
    names = [match.group(1) for match in re.finditer(r"^# name \d+ = ([^:\r\n]+)", text, flags=re.MULTILINE)]
    if not names:
        raise FileFault("lacks the column names of a Sea-Bird file", "give a converted cast")
    table = _table(text, names)
    bad = re.search(r"^# bad_flag = (\S+)", text, flags=re.MULTILINE)
    # A float of an old file may have lost some of its digits.
    table[np.isclose(table, float(bad.group(1)) if bad else BAD, rtol=1e-3, atol=0.0)] = np.nan
    known = {name.strip(): column for name, column in reversed(list(zip(names, table.T)))}
    if "flag" in known:
        for name in known.keys() - {"flag"}:
            known[name] = np.where(np.isnan(known["flag"]), np.nan, known[name])
    return _identified(known)


def _table(text: str, names: list[str]) -> Floats:
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line[0] in "*#":
            continue
        cells = line.split()
        if len(cells) != len(names) and len(line.rstrip()) == WIDTH * len(names):
            cells = [line[k : k + WIDTH] for k in range(0, WIDTH * len(names), WIDTH)]
        try:
            rows.append([float(cell) for cell in cells])
        except ValueError:
            raise FileFault(f"has no numbers in line {number}", "convert the cast again") from None
        if len(cells) != len(names):
            raise FileFault(f"has {len(cells)} columns in line {number}, not {len(names)}", "convert it again")
    return np.array(rows, dtype=np.float64).reshape(-1, len(names))


def _identified(known: Columns) -> Columns:
    """Columns by Sea-Bird's names, of two sensors the first; pressure gives depth, and conductivity salinity."""
    found = {}
    pressure = _first(known, r"pr(dM|DM|SM|M)")
    temperature = _first(known, r"t\w*(90|68)C")
    if temperature:
        scale = IPTS68 if temperature.endswith("68C") else 1.0
        found["temperature"] = known[temperature] / scale
    for name, pattern in (("depth", r"dep[SF]M"), ("salinity", r"sal\d\d"), ("sound_speed", r"sv[CDW]M")):
        column = _first(known, pattern)
        if column:
            found[name] = known[column]
    for name, seconds in SECONDS.items():
        if name in known:
            found.setdefault("time", known[name] * seconds)
    if pressure and "depth" not in found:
        found["depth"] = depth_of_pressure(known[pressure])
    conductivity = _first(known, r"c(ond)?_?\d?(S/m|mS/cm|uS/cm)")
    if pressure and conductivity and "salinity" not in found and "temperature" in found:
        import gsw  # lazy: only casts with conductivity need it

        unit = next(scale for unit, scale in CONDUCTIVITY.items() if conductivity.endswith(unit))
        practical = gsw.SP_from_C(known[conductivity] * unit, found["temperature"], known[pressure])
        found["salinity"] = np.asarray(practical)
    return found


def depth_of_pressure(pressure: Floats) -> Floats:
    """Return depths in metres from pressures in dbar (TEOS-10, at a middle latitude)."""
    import gsw  # lazy: only casts with pressure need it

    return np.asarray(-gsw.z_from_p(pressure, LATITUDE))


def _first(known: Columns, pattern: str) -> str | None:
    return next((name for name in reversed(list(known)) if re.fullmatch(pattern, name)), None)


SEABIRD = FileFormat("Sea-Bird converted cast", (".cnv",), read_seabird)


def read_profile(path: str) -> Columns:
    """Read depth and speed of sound from ``.asvp``, ``.svp``, ``.vel`` and ``.calc`` files."""
    # Lines that are not all numbers are headings.
    text = read_text(path, ENCODING)
    sections = len(re.findall(r"^\s*section\b", text, flags=re.MULTILINE | re.IGNORECASE))
    if sections > 1:
        raise FileFault(f"holds {sections} casts", "keep one of its sections")
    rows = [row for row in map(_numbers, text.splitlines()) if row.size >= 2 and np.isfinite(row).all()]
    if not rows:
        raise FileFault("holds no rows of depth and sound speed", "give two numbers in every line")
    depth, speed = np.array([row[:2] for row in rows]).T
    return {"depth": depth, "sound_speed": speed}


def read_table(path: str) -> Columns:
    """Read a table with a header of column names, or a table without one, by the values in its columns."""
    whole = read_text(path, ENCODING).removeprefix(BYTE_ORDER_MARK).splitlines()
    lines = [line for line in whole if line.strip(" ,;\t") and line[0] not in "#%"]
    rows = [_numbers(line) for line in lines]
    names = find_columns(_cells(lines[0]), NAMES) if lines and np.isnan(rows[0]).all() else None
    rows = rows[names is not None :]
    width = max((row.size for row in rows), default=0)
    if width < 2:
        raise FileFault("holds no table", "give columns depth and sound_speed with a line for each depth")
    table = np.array([np.pad(row, (0, width - row.size), constant_values=np.nan) for row in rows])
    if names is None:
        return _by_values(table)
    return {name: table[:, place] for name, place in names.items() if place < width}


def _cells(line: str) -> list[str]:
    separator = next((mark for mark in ",;\t" if mark in line), None)
    return [cell.strip().strip('"') for cell in line.split(separator)]


def _numbers(line: str) -> Floats:
    """Return the numbers of a line, NaN for cells without one."""
    return np.array([number_or_nan(cell) for cell in _cells(line)])


def find_columns(cells: list[str], names: Mapping[str, str]) -> dict[str, int]:
    """Find the columns that the cells of a header name."""
    bare = [re.sub(r"[\[(;].*", "", cell).strip().lower() for cell in cells]
    places = {
        name: next((place for place, cell in enumerate(bare) if re.fullmatch(pattern, cell)), -1)
        for name, pattern in names.items()
    }
    return {name: place for name, place in places.items() if place >= 0}


def number_or_nan(cell: str) -> float:
    """Return the number in a cell, NaN if there is none."""
    try:
        return float(cell)
    except ValueError:
        return float("nan")


def _by_values(table: Floats) -> Columns:
    """Find the columns of depth and sound speed in a table without a header."""
    remedy = "put a line with the names of the columns first, depth and sound_speed among them"
    whole = [place for place in range(table.shape[1]) if np.isfinite(table[:, place]).all()]
    speeds = [place for place in whole if SPEEDS[0] <= table[:, place].min() and table[:, place].max() <= SPEEDS[1]]
    depths = [place for place in whole if place not in speeds and _is_depth(table[:, place])]
    if len(speeds) != 1 or len(depths) != 1:
        what = "depth" if len(speeds) == 1 else "sound speed"
        count = len(depths) if len(speeds) == 1 else len(speeds)
        raise FileFault(f"has {count or 'no'} columns that look like {what}", remedy)
    return {"depth": table[:, depths[0]], "sound_speed": table[:, speeds[0]]}


def _is_depth(column: Floats) -> bool:
    """Whether a column increases in most rows, over nearly its whole range."""
    steps = np.diff(column)
    return bool(column.min() >= -1.0 and steps.sum() >= 0.9 * np.ptp(column) > 0.0 and (steps > 0.0).mean() > 0.5)


def read_log(path: str) -> Columns:
    """Read the columns of a logged cast; depth is derived from pressure where the file lacks it."""
    lines = read_text(path, ENCODING).splitlines()
    heads = (
        (number, find_columns(_log_cells(line.removeprefix(PREFIX)), LOG_NAMES)) for number, line in enumerate(lines)
    )
    needed = {"depth", "pressure"}, {"sound_speed", "temperature"}  # one of each
    sufficient = (head for head in heads if all(head[1].keys() & either for either in needed))
    number, places = next(sufficient, (0, {}))
    if not places:
        raise FileFault("has no line that names the columns of depth or pressure, and of sound speed", LOG_REMEDY)
    rows = (_row(line, places) for line in lines[number + 1 :])
    table = np.array([row for row in rows if np.isfinite(row).all()]).reshape(-1, len(places))
    if not table.size:
        raise FileFault("has no row of numbers under the names of its columns", LOG_REMEDY)
    found = dict(zip(places, table.T))
    if "time" in found:
        found["time"] = np.unwrap(found["time"], period=DAY)
    pressure = found.pop("pressure", None)
    if "depth" not in found and pressure is not None:
        found["depth"] = depth_of_pressure(pressure)
    return found


def _log_cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.split("\t" if "\t" in line else ",")]


def _row(line: str, places: dict[str, int]) -> Floats:
    """Return the numbers of a row in the order of the columns, NaN for cells without a number."""
    cells = _log_cells(line)
    used = (cells[place] if place < len(cells) else "" for place in places.values())
    return np.array([_seconds(cell) if name == "time" else number_or_nan(cell) for name, cell in zip(places, used)])


def _seconds(cell: str) -> float:
    """Time of day, from a time with or without a date before it."""
    found = CLOCK.search(cell)
    if found is None:
        return number_or_nan(cell)
    hours, minutes, seconds = (float(part) for part in found.groups())
    return 3600.0 * hours + 60.0 * minutes + seconds


PROFILE = FileFormat("sound-speed profile of an echo sounder", (".asvp", ".svp", ".vel", ".calc"), read_profile)
TABLE = FileFormat("table", (".csv",), read_table)
LOG = FileFormat("log of Valeport or AML", (".vp2", ".000", ".aml"), read_log, remedy=LOG_REMEDY)
# Formats that are known by name alone: another program converts them.
MANAGER = "convert it to .asvp or .csv, for example with Sound Speed Manager of HydrOffice"
RBR: FileFormat[Columns] = FileFormat("RBR Ruskin", (".rsk",), converter="export it as CSV from Ruskin")
MVP: FileFormat[Columns] = FileFormat(
    "Moving Vessel Profiler", (".m1", ".s10", ".s12", ".s52", ".raw"), converter=MANAGER
)
VALEPORT: FileFormat[Columns] = FileFormat("Valeport DataLog", (".vpd",), converter=MANAGER)
SIPPICAN: FileFormat[Columns] = FileFormat("Sippican", (".edf",), converter=MANAGER)
SONARDYNE: FileFormat[Columns] = FileFormat("Sonardyne", (".pro",), converter=MANAGER)
ELAC: FileFormat[Columns] = FileFormat("ELAC", (".sva",), converter=MANAGER)
