"""Converted casts of Sea-Bird instruments (.cnv)."""

import re

import numpy as np

from insonify.io.file_access import FileFault, read_text
from insonify.io.formats import FileFormat
from insonify.io.sound_speed_casts import ENCODING, Columns, Values

WIDTH = 11  # characters of a column, for tables without spaces between numbers
BAD = -9.99e-29  # marks a missing value
LATITUDE = 45.0  # degrees, for depth from pressure
# Names of columns and their units in seconds.
SECONDS = {"timeS": 1.0, "timeM": 60.0, "timeH": 3600.0, "timeJ": 86400.0}
CONDUCTIVITY = {"S/m": 10.0, "mS/cm": 1.0, "uS/cm": 1e-3}  # in mS/cm
IPTS68 = 1.00024  # degrees on IPTS-68 per degree on ITS-90 (Saunders 1990)


def read_seabird(path: str) -> Columns:
    """Read the columns of a converted cast."""
    text = read_text(path, ENCODING)
    names = [match.group(1) for match in re.finditer(r"^# name \d+ = ([^:\r\n]+)", text, flags=re.MULTILINE)]
    if not names:
        raise FileFault("names no columns as Sea-Bird does", "give a converted cast")
    table = _table(text, names)
    bad = re.search(r"^# bad_flag = (\S+)", text, flags=re.MULTILINE)
    # A float of an old file may have lost some of its digits.
    table[np.isclose(table, float(bad.group(1)) if bad else BAD, rtol=1e-3, atol=0.0)] = np.nan
    known = {name.strip(): column for name, column in reversed(list(zip(names, table.T)))}
    if "flag" in known:
        for name in known.keys() - {"flag"}:
            known[name] = np.where(np.isnan(known["flag"]), np.nan, known[name])
    return _identified(known)


def _table(text: str, names: list[str]) -> Values:
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
    """Columns of the cast by Sea-Bird's names; of two sensors the first."""
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
    if pressure:
        _add_of_pressure(known, found, known[pressure])
    return found


def depth_of_pressure(pressure: Values) -> Values:
    """Return depths in metres from pressures in dbar (TEOS-10, at a middle latitude)."""
    import gsw  # lazy: only casts with pressure need it

    return np.asarray(-gsw.z_from_p(pressure, LATITUDE))


def _add_of_pressure(known: Columns, found: Columns, pressure: Values) -> None:
    """Add depth from pressure (dbar) and salinity from conductivity where the file lacks them."""
    import gsw  # a fifth of a second

    if "depth" not in found:
        found["depth"] = depth_of_pressure(pressure)
    conductivity = _first(known, r"c(ond)?_?\d?(S/m|mS/cm|uS/cm)")
    if conductivity and "salinity" not in found and "temperature" in found:
        unit = next(scale for unit, scale in CONDUCTIVITY.items() if conductivity.endswith(unit))
        found["salinity"] = np.asarray(gsw.SP_from_C(known[conductivity] * unit, found["temperature"], pressure))


def _first(known: Columns, pattern: str) -> str | None:
    return next((name for name in reversed(list(known)) if re.fullmatch(pattern, name)), None)


SEABIRD = FileFormat("Sea-Bird converted cast", (".cnv",), read_seabird)
