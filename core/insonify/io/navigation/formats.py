"""Formats of recorded navigation: text, GPX tracks, records and recordings."""

from datetime import UTC, datetime
from xml.etree import ElementTree

import numpy as np

from insonify.io.file_access import FileFault, read_text
from insonify.io.formats import FileFormat
from insonify.io.navigation import LIMITS, Columns
from insonify.io.records import read_record
from insonify.io.records.netcdf import check_variables

ON_EARTH = {"x": "longitude", "y": "latitude"}  # what a recording with a place has instead
CSV_REMEDY, GPX_REMEDY = "give one number in every column of every row", "export the track again as GPX 1.1"
PREFIXES = ("platform_", "ping_")  # of the same names in a record
ALIASES = {"lon": "longitude", "long": "longitude", "lng": "longitude", "lat": "latitude"}


def read_csv(path: str) -> Columns:
    """Read the columns of navigation in a CSV file."""
    lines = read_text(path).splitlines()
    places = _find_columns(lines[0].split(",")) if lines else {}
    if not places:
        return {}
    try:
        table = np.loadtxt(
            lines[1:],
            delimiter=",",
            usecols=tuple(places.values()),
            ndmin=2,
            converters={places["time"]: _seconds_or_time} if "time" in places else None,
        )
    except ValueError as error:
        fault = str(error).splitlines()[0].rstrip(".;")
        raise FileFault(f"cannot be read ({fault})", CSV_REMEDY) from None
    return dict(zip(places, np.ascontiguousarray(table.reshape(-1, len(places)).T)))


def _seconds_or_time(text: str) -> float:
    """Read a number of seconds, or a time in ISO 8601."""
    try:
        return float(text)
    except ValueError:
        return _seconds(text.strip().strip('"'))


def _seconds(text: str) -> float:
    """Seconds since 1970 of a time in ISO 8601, in UTC unless it has a zone."""
    time = datetime.fromisoformat(text)
    return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()


def _find_columns(names: list[str]) -> dict[str, int]:
    """Places of the columns of navigation among the names in a file."""
    bare = [name.strip().strip('"').lower() for name in names]
    for prefix in PREFIXES:
        bare = [name.removeprefix(prefix) for name in bare]
    bare = [ALIASES.get(name, name) for name in bare]
    return {name: bare.index(name) for name in LIMITS if name in bare}


def read_gpx(path: str) -> Columns:
    """Read time, longitude and latitude of the points of all tracks of a file, in their order."""
    text = read_text(path)
    if "<!" in text.replace("<!--", "").replace("<![CDATA[", ""):  # entities can grow without bound
        raise FileFault("declares a document type", GPX_REMEDY)
    points = [each for each in ElementTree.fromstring(text).iter() if each.tag.rpartition("}")[2] == "trkpt"]
    rows = []
    for point in points:
        time = next((each.text for each in point if each.tag.rpartition("}")[2] == "time"), None)
        if time is None:
            raise FileFault("has points without a time", "export a recorded track, not a route")
        rows.append((_seconds(time.strip()), float(point.get("lon", "nan")), float(point.get("lat", "nan"))))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    return dict(zip(("time", "longitude", "latitude"), columns))


def read_platform(path: str) -> Columns:
    """Read the columns of navigation in a netCDF record, as ``insonify render`` writes it."""
    import netCDF4  # slow to import, and only recorded tracks need it

    with netCDF4.Dataset(path) as file:
        names = [str(name) for name in file.variables]
        found = {name: file.variables[names[place]] for name, place in _find_columns(names).items()}
        check_variables(path, found.values())
        return {
            name: np.ma.filled(np.ma.asarray(column[:], dtype=np.float64), np.nan).ravel()
            for name, column in found.items()
        }


def read_recording(path: str) -> Columns:
    """Read the columns of navigation of a recording."""
    record = read_record(path)
    names = {name: f"ping_{name}" if name == "time" else f"platform_{name}" for name in LIMITS}
    skipped = set(ON_EARTH if "platform_longitude" in record else ON_EARTH.values())
    return {
        name: record[stored].values.astype(np.float64)
        for name, stored in names.items()
        if stored in record.variables and name not in skipped
    }


CSV = FileFormat("comma-separated values", (".csv",), read_csv, remedy=CSV_REMEDY)
GPX = FileFormat("GPX track", (".gpx",), read_gpx, remedy=GPX_REMEDY)
NC_REMEDY = "give a record as insonify render writes it"
RECORD = FileFormat("record in netCDF", (".nc",), read_platform, isolated=True, remedy=NC_REMEDY)
RECORDING = FileFormat("side-scan recording", (".xtf", ".jsf"), read_recording)
