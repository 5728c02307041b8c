"""Navigation in the GPS Exchange Format (GPX): the points of all tracks of a file."""

from __future__ import annotations

from datetime import UTC, datetime
from xml.etree import ElementTree

import numpy as np

from insonify.io.file_access import FileFault, read_text
from insonify.io.formats import FileFormat
from insonify.io.navigation.recorded import Columns

REMEDY = "export the track again as GPX 1.1"


def read_gpx(path: str) -> Columns:
    """Read time, longitude and latitude of the track points of a file, in their order."""
    text = read_text(path)
    if "<!" in text.replace("<!--", "").replace("<![CDATA[", ""):  # entities can grow without bound
        raise FileFault("declares a document type", REMEDY)
    points = [each for each in ElementTree.fromstring(text).iter() if each.tag.rpartition("}")[2] == "trkpt"]
    rows = [(_time(point), float(point.get("lon", "nan")), float(point.get("lat", "nan"))) for point in points]
    columns = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    return dict(zip(("time", "longitude", "latitude"), columns))


def _time(point: ElementTree.Element) -> float:
    """Time of a point in seconds since 1970."""
    told = next((each.text for each in point if each.tag.rpartition("}")[2] == "time"), None)
    if told is None:
        raise FileFault("has points without a time", "export a recorded track, not a route")
    time = datetime.fromisoformat(told.strip())
    return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()


GPX = FileFormat("GPX track", (".gpx",), read_gpx, remedy=REMEDY)
