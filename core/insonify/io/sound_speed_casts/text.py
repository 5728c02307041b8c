"""Casts as text: Sea-Bird's, sound-speed profiles of echo sounders, tables, and logs of instruments.

Logs of Valeport (Swift and MIDAS), of AML Oceanographic and of the Castaway have a heading, a line with the names of
the columns, and a row for each sample.
"""

import re
from collections.abc import Collection, Sequence

import numpy as np

from insonify.arrays import Floats
from insonify.io.file_access import FileFault, read_text
from insonify.io.formats import FileFormat
from insonify.io.sound_speed_casts import ENCODING, PLAUSIBLE, Columns
from insonify.io.tables import (
    CELSIUS,
    DECIBARS,
    MARKS,
    METRES,
    SALINITY,
    SECONDS,
    SPEED,
    Quantity,
    read_numbers,
    read_table,
    read_times,
    split_cells,
)

COLUMN_WIDTH = 11  # characters of a column, for tables without spaces between numbers
BAD = -9.99e-29  # marks a missing value
LATITUDE = 45.0  # degrees, for depth from pressure
# Names of columns of time and their units in seconds.
CLOCKS = {"timeS": 1.0, "timeM": 60.0, "timeH": 3600.0, "timeJ": 86400.0, "timeK": 1.0, "timeN": 1.0, "timeQ": 1.0}
CONDUCTIVITY = {"mS/cm": 1.0, "uS/cm": 1e-3, "S/m": 10.0}  # in mS/cm
IPTS68 = 1.00024  # degrees on IPTS-68 per degree on ITS-90 (Saunders 1990)
FOOT, PSI = 0.3048, 0.6894757  # m, dbar
FEET_A_SECOND = tuple(speed / FOOT for speed in PLAUSIBLE["sound_speed"])
# Units of length in the heading of a profile, in metres.
LENGTHS = ((r"feet|foot|ft", FOOT), (r"fathoms?", 1.8288))
OF_DEPTHS = r"(?:^|[,;:=(\[]|\b(?:in|depths?|units?)\b)\s*(?:{})\s*(?:$|[,;)\]])"  # a unit alone, or named as one
LOG_REMEDY = "export it as CSV with the columns depth and sound_speed"
NAMES_REMEDY = "put a line with the names of the columns first, depth and sound_speed among them"
OF = "(water|sea|insitu|measured|corrected|calc(ulated)?|sensor|instrument|average|mean|ctd|probe)?"
QUANTITIES = {
    "time": Quantity("(elapsed|sample|utc|gps)?(date)?(and)?time(utc|gmt|s|stamp|elapsed)?|sec(ond)?s", "s",
                     SECONDS, read_times),
    "date": Quantity("(utc)?date(utc)?", "", (), read_numbers),
    "depth": Quantity(f"{OF}(depth|dep|dpth)(water)?1?|z", "m", METRES, read_numbers),
    "pressure": Quantity(f"{OF}(pressure|press|pres|prs)1?|p", "dbar", DECIBARS, read_numbers),
    "sound_speed": Quantity(f"{OF}(sound)?(speed|velocity|vel|sos)1?|(speed|velocity)ofsound|svp?|ssp|c", "m/s", SPEED,
                            read_numbers),
    "temperature": Quantity(f"{OF}temp(erature|ct|er)?1?|t", "°C", CELSIUS, read_numbers),
    "salinity": Quantity(f"{OF}(practical)?sal(inity)?1?|psal|s", "practical salinity", SALINITY, read_numbers),
}  # fmt: skip


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
    interval = re.search(r"^# interval = seconds: (\S+)", text, flags=re.MULTILINE)
    if interval and "scan" in known and not known.keys() & CLOCKS.keys():
        known["timeS"] = known["scan"] * float(interval.group(1))
    return _identified(known)


def _table(text: str, names: list[str]) -> Floats:
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line[0] in "*#":
            continue
        cells = line.split()
        if len(cells) != len(names) and len(line.rstrip()) == COLUMN_WIDTH * len(names):
            cells = [line[k : k + COLUMN_WIDTH] for k in range(0, COLUMN_WIDTH * len(names), COLUMN_WIDTH)]
        try:
            rows.append([float(cell.replace(",", ".")) for cell in cells])
        except ValueError:
            raise FileFault(f"has no numbers in line {number}", "convert the cast again") from None
        if len(cells) != len(names):
            raise FileFault(f"has {len(cells)} columns in line {number}, not {len(names)}", "convert it again")
    return np.array(rows, dtype=np.float64).reshape(-1, len(names))


def _identified(known: Columns) -> Columns:
    """Columns by Sea-Bird's names, of two sensors the first; pressure gives depth, and conductivity salinity."""
    found = {}
    pressure = _first(known, r"pr(d|D|S)?[ME]")
    if pressure and pressure.endswith("E"):
        known[pressure] = known[pressure] * PSI
    temperature = _first(known, r"t\w*(90|68)[CF]")
    if temperature:
        degrees = known[temperature] if temperature.endswith("C") else (known[temperature] - 32.0) / 1.8
        found["temperature"] = degrees / (IPTS68 if "68" in temperature else 1.0)
    for name, pattern in (("depth", r"dep[SF][MF]"), ("salinity", r"sal\d\d"), ("sound_speed", r"sv[CDW][MF]")):
        column = _first(known, pattern)
        if column:
            found[name] = known[column] * (FOOT if column.endswith("F") else 1.0)
    for name, seconds in CLOCKS.items():
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
    text = read_text(path, ENCODING)
    sections = len(re.findall(r"^\s*section\b", text, flags=re.MULTILINE | re.IGNORECASE))
    if sections > 1:
        raise FileFault(f"holds {sections} casts", "keep one of its sections")
    lines = text.splitlines()
    table = read_table(lines, QUANTITIES, lambda names: {"depth", "sound_speed"} <= set(names))
    if table is not None:
        return _rows(table.columns)
    # Lines that are not all numbers are headings.
    rows = [row for row in _without_names(lines) if row.size >= 2 and np.isfinite(row).all()]
    if not rows:
        raise FileFault("holds no rows of depth and sound speed", "give two numbers in every line")
    depth, speed = np.array([row[:2] for row in rows]).T
    return _in_metres(depth, speed, lines)


def _in_metres(depth: Floats, speed: Floats, lines: Sequence[str]) -> Columns:
    """Convert depths by the unit in the heading, and speeds in feet per second."""
    heading = "\n".join(line for line in lines if re.search("[A-Za-z]", line))
    found = [
        metres for unit, metres in LENGTHS if re.search(OF_DEPTHS.format(unit), heading, re.IGNORECASE | re.MULTILINE)
    ]
    in_feet = FEET_A_SECOND[0] <= np.median(speed) <= FEET_A_SECOND[1]
    if in_feet and not found:
        fault = f"has sound speeds about {np.median(speed):.4g}, which are in ft/s, beside depths of an unknown unit"
        raise FileFault(fault, NAMES_REMEDY.replace("sound_speed", "sound_speed with their units"))
    return {"depth": depth * (found[0] if found else 1.0), "sound_speed": speed * (FOOT if in_feet else 1.0)}


def _sufficient(names: Collection[str]) -> bool:
    return bool({"depth", "pressure"} & set(names) and {"sound_speed", "temperature"} & set(names))


def _rows(columns: Columns) -> Columns:
    """Rows that have any number beside the time; depth is derived from pressure where the file lacks it."""
    columns = dict(columns)
    used = np.any([np.isfinite(column) for name, column in columns.items() if name != "time"], axis=0)
    if "pressure" in columns and not np.nan_to_num(columns.get("depth", np.zeros(1))).any():
        columns["depth"] = depth_of_pressure(columns["pressure"])
    columns.pop("pressure", None)
    return {name: column[used] for name, column in columns.items()}


def read_csv(path: str) -> Columns:
    """Read a table with a header of column names, or a table without one, by the values in its columns."""
    lines = [line for line in read_text(path, ENCODING).splitlines() if line.strip(" ,;\t")]
    table = read_table(lines, QUANTITIES, _sufficient)
    first = next((line for line in lines if line[0] not in "#%"), "")
    if table is None and re.search("[A-Za-z]", first):
        table = read_table(lines, QUANTITIES, bool)  # to name what it lacks
    if table is not None and next(iter(table.columns.values())).size:
        return _rows(table.columns)
    rows = [row for row in _without_names(lines) if np.isfinite(row).sum() >= 2]
    if not rows:
        raise FileFault("holds no table", "give columns depth and sound_speed with a line for each depth")
    width = max(row.size for row in rows)
    return _by_values(np.array([np.pad(row, (0, width - row.size), constant_values=np.nan) for row in rows]), lines)


def _without_names(lines: Sequence[str]) -> list[Floats]:
    """Numbers of lines, NaN for cells without one, parted by the mark that leaves most of them."""
    read = [[read_numbers(split_cells(line, mark)) for line in lines if line.strip()] for mark in MARKS]
    numbers = [sum(int(np.isfinite(row).sum() - np.isnan(row).sum()) for row in rows if row.size > 1) for rows in read]
    return read[int(np.argmax(numbers))]


def _by_values(table: Floats, lines: Sequence[str]) -> Columns:
    """Find the columns of depth and sound speed in a table without a header."""
    whole = [place for place in range(table.shape[1]) if np.isfinite(table[:, place]).all()]
    ranges = PLAUSIBLE["sound_speed"], FEET_A_SECOND
    speeds = [place for place in whole if any(low <= np.median(table[:, place]) <= high for low, high in ranges)]
    depths = [place for place in whole if place not in speeds and _is_depth(table[:, place])]
    if len(speeds) != 1 or len(depths) != 1:
        what = "depth" if len(speeds) == 1 else "sound speed"
        count = len(depths) if len(speeds) == 1 else len(speeds)
        raise FileFault(f"has {count or 'no'} columns that look like {what}", NAMES_REMEDY)
    return _in_metres(table[:, depths[0]], table[:, speeds[0]], lines)


def _is_depth(column: Floats) -> bool:
    """Whether a column increases in most rows, over nearly its whole range."""
    steps = np.diff(column)
    return bool(column.min() >= -1.0 and steps.sum() >= 0.9 * np.ptp(column) > 0.0 and (steps > 0.0).mean() > 0.5)


def read_log(path: str) -> Columns:
    """Read the columns of a logged cast; depth is derived from pressure where the file lacks it."""
    table = read_table(read_text(path, ENCODING).splitlines(), QUANTITIES, _sufficient)
    if table is None:
        raise FileFault("has no line that names the columns of depth or pressure, and of sound speed", LOG_REMEDY)
    found = _rows(table.columns)
    if not found["depth"].size:
        raise FileFault("has no row of numbers under the names of its columns", LOG_REMEDY)
    return found


PROFILE = FileFormat("sound-speed profile of an echo sounder", (".asvp", ".svp", ".vel", ".calc"), read_profile)
TABLE = FileFormat("table", (".csv",), read_csv)
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
