"""Columns of numbers in text tables of any dialect, found by the names and converted by the units in their header.

Columns are parted by tabs, semicolons, commas or spaces. Numbers have a decimal point or comma. Lines of other content
may stand before the header, and a line of units below it.
"""

import csv
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from datetime import UTC, datetime
from itertools import islice
from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.io.file_access import FileFault

MARKS = ("\t", ";", ",", None)  # between columns; None: spaces
LONGEST_PREAMBLE, LONGEST_HEADER, LONGEST_NAME = 2000, 10_000, 200  # lines before a header, its characters, a name's
MOST_NAMES = 50_000  # cells that are tried as names
DAY = 86400.0  # s
CLOCK = re.compile(r"(\d{1,4}):(\d\d?)(?::(\d\d?(?:[.,]\d+)?))?\s*([ap]m)?", re.IGNORECASE)
DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(e[-+]?\d+)?", re.IGNORECASE)
GROUPED = re.compile(r"[-+]?\d{1,3}((,\d{3})+\.\d*|(\.\d{3})+,\d+)")  # 1,500.2 or 1.500,2

# Units: a pattern of lower-case letters and digits, and the scale and offset that convert a number to the first unit.
Units = Sequence[tuple[str, float, float]]
METRES: Units = (
    ("m|met(er|re)s?|mtrs?", 1.0, 0.0),
    ("cm|centimet(er|re)s?", 0.01, 0.0),
    ("km|kilomet(er|re)s?", 1000.0, 0.0),
    ("us(survey)?(ft|f(oo|ee)t)|(ft|f(oo|ee)t)us", 1200.0 / 3937.0, 0.0),
    ("(int)?(ft|f(oo|ee)t)", 0.3048, 0.0),
    ("fathoms?|fth?ms?|fms?|fths?", 1.8288, 0.0),
    ("yds?|yards?", 0.9144, 0.0),
)
DECIBARS: Units = (
    ("d(eci)?bars?|db", 1.0, 0.0),
    ("bars?", 10.0, 0.0),
    ("m(illi)?bars?|hpa", 0.01, 0.0),
    ("kpa", 0.1, 0.0),
    ("mpa", 100.0, 0.0),
    ("pa", 1e-4, 0.0),
    ("psig?", 0.6894757, 0.0),
    ("psia", 0.6894757, -10.1325),
)
SPEED: Units = (
    ("m/?s(ec)?(ond)?1?|mps|met(er|re)s?(per|/)s(ec(ond)?)?", 1.0, 0.0),
    ("(ft|f(oo|ee)t)(per|/)s(ec(ond)?)?|fps|fts1?", 0.3048, 0.0),
    ("km/s(ec)?", 1000.0, 0.0),
)
CELSIUS: Units = (
    ("(deg(ree)?s?)?c(elsius)?", 1.0, 0.0),
    ("(deg(ree)?s?)?f(ahrenheit)?", 1.0 / 1.8, -32.0 / 1.8),
    ("(deg(ree)?s?)?k(elvins?)?", 1.0, -273.15),
)
SALINITY: Units = (("psu|pss(78)?|ppt|practicalsalinityscale", 1.0, 0.0), ("g/kg", 35.0 / 35.16504, 0.0))  # TEOS-10
SECONDS: Units = (
    ("s(ec(ond)?s?)?", 1.0, 0.0),
    ("ms(ec)?|milliseconds?", 1e-3, 0.0),
    ("min(ute)?s?", 60.0, 0.0),
    ("hr?s?|hours?", 3600.0, 0.0),
    ("d(ays?)?|juliandays?", DAY, 0.0),
)
DEGREES: Units = (("deg(ree)?s?[en]?", 1.0, 0.0), ("rad(ian)?s?", 180.0 / np.pi, 0.0))
COMPASS: Units = (*DEGREES, ("(deg(ree)?s?)?(t|true)", 1.0, 0.0))
FOREIGN: Units = (("kn|kts?|knots?|volts?|v|counts?|hz|pulses", 1.0, 0.0),)
ALL_UNITS = (METRES, DECIBARS, SPEED, CELSIUS, SALINITY, SECONDS, COMPASS, FOREIGN)
OTHERWISE = {"depth": "pressure", "pressure": "depth", "heading": "compass"}  # what a column in units of the other is


class Quantity(NamedTuple):
    """How the columns of a quantity are named and read."""

    names: str  # pattern of lower-case letters and digits
    unit: str  # that of its values here, for messages
    units: Units
    read: Callable[[Sequence[str]], Floats]  # of the cells of a column; NaN where a cell has no value


class Table(NamedTuple):
    """Columns by quantity, in their units here, beside the cells of the file."""

    columns: dict[str, Floats]
    cells: dict[str, list[str]]


class _Header(NamedTuple):
    line: int
    mark: str | None
    places: dict[str, int]
    units: dict[str, str]  # of the quantities whose unit stands in the header
    width: int  # cells


def number(cell: str) -> float:
    """Return the number in a cell, NaN if there is none."""
    try:
        return float(cell)
    except ValueError:
        if GROUPED.fullmatch(cell):
            comma = cell.rindex(",") > cell.rindex(".")
            return float(cell.replace(".", "").replace(",", ".") if comma else cell.replace(",", ""))
        return float(cell.replace(",", ".")) if DECIMAL_COMMA.fullmatch(cell) else float("nan")


def read_numbers(cells: Sequence[str]) -> Floats:
    """Read numbers."""
    return np.array([number(cell) for cell in cells], dtype=np.float64)


def read_degrees(cells: Sequence[str]) -> Floats:
    """Read degrees, also with minutes and seconds, and with a letter for the hemisphere."""
    found = read_numbers(cells)
    for row in np.flatnonzero(np.isnan(found)).tolist():
        parts = [float(part) for part in re.findall(r"\d+(?:\.\d+)?", cells[row])]
        if 1 <= len(parts) <= 3 and re.search(r"[NSEW°'\s]", cells[row], re.IGNORECASE):
            sign = -1.0 if re.search(r"[SW]", cells[row], re.IGNORECASE) or cells[row].startswith("-") else 1.0
            found[row] = sign * sum(part / 60.0**power for power, part in enumerate(parts))
    return found


def read_times(cells: Sequence[str]) -> Floats:
    """Read seconds: numbers, times in ISO 8601 (since 1970), or a clock beside a date in any order of day and month."""
    found = read_numbers(cells)
    if np.isfinite(found).any() or not any(cells):
        return found
    try:
        return np.array([seconds_since_1970(cell) if cell else np.nan for cell in cells])
    except ValueError:
        pass
    # Where the text beside the clock changes, the next day begins.
    found, days, before = np.full(len(cells), np.nan), 0, ""
    for row, cell in enumerate(cells):
        clock = CLOCK.search(cell)
        if clock is None:
            continue
        date = cell[: clock.start()].strip() + cell[clock.end() :].strip()
        days, before = days + (row > 0 and date != before), date
        hours, minutes, seconds, half = clock.groups()
        hour = int(hours) % 12 + 12 * (half.lower() == "pm") if half else int(hours)
        found[row] = days * DAY + 3600.0 * hour + 60.0 * int(minutes) + number(seconds or "0")
    known = np.isfinite(found)
    if days == 0:
        found[known] = np.unwrap(found[known], period=DAY)
    return found


def seconds_since_1970(text: str) -> float:
    """Seconds since 1970 of a time in ISO 8601, in UTC unless it has a zone."""
    time = datetime.fromisoformat(re.sub(r"\s*(UTC|GMT)$", "", text.strip()))
    return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()


def split_cells(line: str, mark: str | None) -> list[str]:
    """Cells of a line, without spaces and quotation marks around them."""
    cells = next(csv.reader([line], delimiter=mark), []) if mark and '"' in line else line.split(mark)
    return [cell.strip().strip('"') for cell in cells]


def read_table(
    lines: Sequence[str], quantities: Mapping[str, Quantity], suffices: Callable[[Collection[str]], bool]
) -> Table | None:
    """Read the columns below the first header with sufficient quantities; None if there is no such line."""
    header = _find_header(lines, quantities, suffices)
    if header is None:
        return None
    text = [line for line in lines[header.line + 1 :] if line.strip(" ,;\t")]
    # The rows may be parted by another mark than the header.
    last = max(header.places.values())
    fit = (mark for mark in (header.mark, *MARKS) if any(len(split_cells(line, mark)) > last for line in text))
    mark = next(fit, header.mark)
    below = [split_cells(line, mark) for line in text]
    first = next((row for row, cells in enumerate(below) if any(np.isfinite(number(cell)) for cell in cells)), 0)
    units = dict(header.units)
    for cells in below[:first]:  # a line of units
        for name, place in header.places.items():
            if place < len(cells) and (unit := _unit(re.sub("^units?=", "", cells[place], flags=re.IGNORECASE))):
                units.setdefault(name, unit)
    rows = [cells for cells in below[first:] if cells[0][:1] not in ("#", "%")]
    texts = {
        name: [cells[place] if place < len(cells) else "" for cells in rows] for name, place in header.places.items()
    }
    _check_width(header, rows)
    if "date" in texts and "time" in texts:
        texts["time"] = [f"{date} {time}" if ":" in time else time for date, time in zip(texts["date"], texts["time"])]
    texts.pop("date", None)
    columns, cells_of = {}, {}
    for name, column in texts.items():
        actual, scale, offset = _conversion(name, units.get(name, ""), quantities)
        if actual not in columns:
            columns[actual], cells_of[actual] = scale * quantities[actual].read(column) + offset, column
    return Table(columns, cells_of)


def _check_width(header: _Header, rows: Sequence[Sequence[str]]) -> None:
    """Raise FileFault where commas part columns and stand within numbers too."""
    widths = [sum(cell != "" for cell in cells) for cells in rows]
    if (
        header.mark == ","
        and widths
        and np.median(widths) > header.width
        and not any("." in "".join(row) for row in rows)
    ):
        fault = f"has {np.median(widths):g} numbers a row below {header.width} names: commas within and between numbers"
        raise FileFault(fault, "export it with semicolons between columns, or with decimal points")


def _find_header(
    lines: Sequence[str], quantities: Mapping[str, Quantity], suffices: Callable[[Collection[str]], bool]
) -> _Header | None:
    """Find the last sufficient header before the first row of numbers below one."""
    found: _Header | None = None
    tried = 0
    for number_of_line, line in enumerate(lines[:LONGEST_PREAMBLE]):
        if found is not None and _has_numbers(line, found):
            break
        if not re.match(r"[^\w.+-]*[A-Za-z]", line) or len(line) > LONGEST_HEADER:
            continue
        bare = re.sub(r"(?i)^[\s#%*!]*(columns=)?", "", line)
        for mark in MARKS:
            # Names of several words, and units after a space, are one cell.
            joined = bare
            if mark is None:
                joined = re.sub(r"(?i) (?=[\[(]|of )|(?<=\bsound) |(?<=\bof) ", "_", " ".join(bare.split()))
            cells = split_cells(joined, mark)
            tried += len(cells)
            if tried > MOST_NAMES:
                return found
            header = _read_header(number_of_line, cells, mark, quantities)
            if suffices(header.places.keys()) and (
                mark is not None or _is_as_wide(lines[number_of_line + 1 :], header)
            ):
                found = header
                break
    return found


def _has_numbers(line: str, header: _Header) -> bool:
    cells = split_cells(line, header.mark)
    return any(np.isfinite(number(cells[place])) for place in header.places.values() if place < len(cells))


def _is_as_wide(below: Sequence[str], header: _Header) -> bool:
    """Whether the first line of numbers below a header has as many cells: prose is no header."""
    first = next((line for line in below[:LONGEST_PREAMBLE] if re.match(r"\s*[-+.]?\d", line)), "")
    return len(first.split()) == header.width


def _read_header(line: int, cells: list[str], mark: str | None, quantities: Mapping[str, Quantity]) -> _Header:
    """Find the quantities and units that the cells of a header name."""
    names, units = zip(*(_name_and_unit(cell, quantities) for cell in cells)) if cells else ((), ())
    places: dict[str, int] = {}
    for place, name in enumerate(names):
        if name and name not in places:
            places[name] = place
    if ";" in "".join(cells) and any(_is_foreign(name, unit, quantities) for name, unit in zip(names, units)):
        units = ("", *units[:-1])  # MIDAS: the unit of a column stands before the name of the next
    return _Header(
        line, mark, places, {name: units[place] for name, place in places.items() if units[place]}, len(cells)
    )


def _name_and_unit(cell: str, quantities: Mapping[str, Quantity]) -> tuple[str, str]:
    """Quantity and unit of the cell of a header, each empty if there is none."""
    if len(cell) > LONGEST_NAME:
        return "", ""
    named = re.match(r"([^\[({;]*)[\[({;]([^\])}]*)", cell)
    if named:
        name = quantity_of(named[1], quantities)
        return name, _unit(named[2]) if name else ""
    if whole := quantity_of(cell, quantities):
        return whole, ""
    for place in islice(re.finditer(r"[ _/,-]+(in[ _])?", cell), 4):  # a unit behind the name: depth_m, Depth in ft
        name = quantity_of(cell[: place.start()], quantities)
        if name and (unit := _unit(cell[place.end() :])):
            return name, unit
    return "", ""


def quantity_of(name: str, quantities: Mapping[str, Quantity]) -> str:
    """Quantity that a name without a unit stands for, empty if there is none."""
    bare = re.sub("[^a-z0-9]", "", name.lower())
    return next((each for each, quantity in quantities.items() if re.fullmatch(quantity.names, bare)), "")


def _unit(text: str) -> str:
    """Return the unit among the words of a text, empty if there is none."""
    words = [text, *re.split("[,;]", text)]
    bare = [re.sub("[^a-z0-9/]", "", word.lower()) for word in words]
    return next((word for word in bare if any(_conversion_of(word, units) for units in ALL_UNITS)), "")


def _conversion_of(unit: str, units: Units) -> tuple[float, float] | None:
    return next(((scale, offset) for pattern, scale, offset in units if re.fullmatch(pattern, unit)), None)


def _is_foreign(name: str, unit: str, quantities: Mapping[str, Quantity]) -> bool:
    known = [quantities[each].units for each in (name, OTHERWISE.get(name, "")) if each in quantities]
    return bool(name and unit) and not any(_conversion_of(unit, units) for units in known)


def _conversion(name: str, unit: str, quantities: Mapping[str, Quantity]) -> tuple[str, float, float]:
    """Quantity of a column with a unit, and the scale and offset of its numbers."""
    if not unit:
        return name, 1.0, 0.0
    for actual in (name, OTHERWISE.get(name, "")):
        if actual in quantities and (found := _conversion_of(unit, quantities[actual].units)):
            return actual, *found
    raise FileFault(f"has {name} in {unit}", f"give it in {quantities[name].unit}")
