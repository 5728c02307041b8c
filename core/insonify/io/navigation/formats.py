"""Formats of recorded navigation: text, GPX tracks, records and recordings."""

from typing import Any
from xml.etree import ElementTree

import numpy as np

from insonify.io.file_access import FileFault, read_text
from insonify.io.formats import FileFormat
from insonify.io.navigation import LIMITS, Columns
from insonify.io.records import read_record
from insonify.io.records.netcdf import check_variables
from insonify.io.tables import (
    COMPASS,
    DEGREES,
    METRES,
    SECONDS,
    Quantity,
    quantity_of,
    read_degrees,
    read_numbers,
    read_table,
    read_times,
    seconds_since_1970,
)

ON_EARTH = {"x": "longitude", "y": "latitude"}  # what a recording with a place has instead
CSV_REMEDY, GPX_REMEDY = "give one number in every column of every row", "export the track again as GPX 1.1"
BLANK = ("", "nan", "null", "none", "-")
OF = "(platform|ping|fish|towfish|sensor)?"  # before the names; the first two are those of a record
QUANTITIES = {
    "time": Quantity(f"{OF}(utc|gps)?(date)?(and)?time(utc|gmt|stamp)?|sec(ond)?s", "s", SECONDS, read_times),
    "date": Quantity("(utc|gps)?date(utc)?", "", (), read_numbers),
    **{
        name: Quantity(f"{OF}({names})", "m", METRES, read_numbers)
        for name, names in (("x", "x|easting"), ("y", "y|northing"), ("depth", "depth"), ("altitude", "altitude"))
    },
    **{
        name: Quantity(f"{OF}({names})", "°", COMPASS if name == "compass" else DEGREES, read_degrees)
        for name, names in (
            ("heading", "heading"),
            ("compass", "compass|hdg|hdt|gyro|trueheading|headingtrue|compassheading"),
            ("pitch", "pitch"),
            ("roll", "roll"),
            ("longitude", "longitude|lon|long|lng"),
            ("latitude", "latitude|lat"),
        )
    },
}


def read_csv(path: str) -> Columns:
    """Read the columns of navigation in a CSV file."""
    lines = read_text(path, "latin-1").splitlines()
    table = read_table(lines, QUANTITIES, lambda names: "time" in names and len(names) > 1)
    table = table or read_table(lines, QUANTITIES, bool)  # to name what it lacks
    if table is None:
        return {}
    for name, column in table.columns.items():
        for row in np.flatnonzero(np.isnan(column)):
            if (cell := table.cells[name][row]).lower() not in BLANK:
                raise FileFault(f"cannot be read (row {row + 1} has the {name} {cell[:40]!r})", CSV_REMEDY)
    return table.columns


def read_gpx(path: str) -> Columns:
    """Read time, longitude and latitude of the points of all tracks of a file, in their order."""
    text = read_text(path, "latin-1")  # numbers and times are the same in UTF-8
    if "<!" in text.replace("<!--", "").replace("<![CDATA[", ""):  # entities can grow without bound
        raise FileFault("declares a document type", GPX_REMEDY)
    points = [each for each in ElementTree.fromstring(text).iter() if each.tag.rpartition("}")[2] == "trkpt"]
    rows = []
    for point in points:
        time = next((each.text for each in point if each.tag.rpartition("}")[2] == "time"), None)
        if time is None:
            raise FileFault("has points without a time", "export a recorded track, not a route")
        rows.append((seconds_since_1970(time), float(point.get("lon", "nan")), float(point.get("lat", "nan"))))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    return dict(zip(("time", "longitude", "latitude"), columns))


def read_platform(path: str) -> Columns:
    """Read the columns of navigation in a netCDF record, as ``insonify render`` writes it."""
    import netCDF4  # slow to import, and only recorded tracks need it

    with netCDF4.Dataset(path) as file:
        named: dict[str, Any] = {}
        for name, variable in file.variables.items():
            named.setdefault(quantity_of(name, QUANTITIES), variable)
        found = {name: named[name] for name in LIMITS if name in named}
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
CONVERTER = "convert it to .gpx, for example with GPSBabel"
NMEA: FileFormat[Columns] = FileFormat("NMEA 0183", (".nmea", ".nme", ".nma"), converter=CONVERTER)
DEVICE: FileFormat[Columns] = FileFormat("track of a receiver", (".fit", ".tcx", ".kml", ".kmz"), converter=CONVERTER)
RECORDING = FileFormat("side-scan recording", (".xtf", ".jsf"), read_recording)
