"""Contacts: marked points of a record with what was found there, and the files that hold them."""

import base64
import csv
import io
import json
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from insonify.errors import SceneError, plain_text
from insonify.io.atomic import write_text
from insonify.io.file_access import FileFault, guarded, open_regular, read_text

GEOJSON, CSV = ".geojson", ".csv"
FORMATS = (("Contacts with snapshots (GeoJSON)", GEOJSON), ("Table of contacts (CSV)", CSV))
SIDES = ("port", "starboard")
CONFIDENCES = ("", "low", "medium", "high")  # that the contact is what its class says; empty where it is open
LARGEST = 2**27  # bytes of a file: ten thousand contacts with snapshots
HEADER = 10_000  # bytes, of the longest line of names
GREATEST = 2**31 - 1  # of any number
FORMULA = ("=", "+", "-", "@", "\t", "\r", "'")  # with which a spreadsheet takes a cell as more than text
TEXTS = ("name", "note", "source", "classification", "confidence")
WHOLE = ("ping", "range_bin")
REAL = ("slant_range", "ground_range", "x", "y", "longitude", "latitude", "length", "width", "height")


@dataclass(frozen=True)
class Contact:
    """A point of a record with what was found there."""

    name: str  # as the person writes them
    note: str  # remark
    source: str  # title of the scene, or name of the file of the recording
    ping: int
    side: str  # ``port`` or ``starboard``
    range_bin: int
    slant_range: float  # in metres
    ground_range: float | None = None  # in metres; None in the water column
    x: float | None = None  # place in metres of the scene or of the recording's map; None where it is not known
    y: float | None = None
    longitude: float | None = None  # in degrees; None where the map is not known
    latitude: float | None = None
    classification: str = ""  # class, such as wreck or rock, as the person writes it
    length: float | None = None  # measured size in metres; None where it was not measured
    width: float | None = None
    height: float | None = None  # above the bed, from the length of the shadow
    confidence: str = ""  # one of `CONFIDENCES`
    snapshot: bytes = b""  # picture around it as PNG; empty if there is none

    def __post_init__(self) -> None:
        """Replace what no file in UTF-8 takes: half a character, or bytes of a file name that are none."""
        for name in (*TEXTS, "side"):
            object.__setattr__(self, name, getattr(self, name).encode(errors="replace").decode())


CONTACT_COLUMNS = tuple(field.name for field in fields(Contact) if field.name != "snapshot")


def describe_contacts(number: int) -> str:
    """Words for a list of some contacts, for sentences about it."""
    return f"the list of {number} contact{'s' * (number != 1)}"


def write_contacts(path: Path, contacts: Iterable[Contact]) -> None:
    """Write contacts, to be read again, by the suffix of a file: GeoJSON with snapshots, or a table in CSV."""
    # GeoJSON follows RFC 7946: geometries hold longitude and latitude, and are null where these are not known. All
    # fields are properties, the snapshot as base64.
    if path.suffix.lower() == CSV:
        text = _as_csv(contacts)
    else:
        features = []
        for contact in contacts:
            known = contact.longitude is not None and contact.latitude is not None
            place = {"type": "Point", "coordinates": [contact.longitude, contact.latitude]} if known else None
            properties = asdict(contact) | {"snapshot": base64.b64encode(contact.snapshot).decode("ascii")}
            features.append({"type": "Feature", "geometry": place, "properties": properties})
        text = json.dumps({"type": "FeatureCollection", "features": features}, indent=1, ensure_ascii=False) + "\n"
    write_text(path, text)


def is_contacts(path: str) -> bool:
    """Whether a file holds contacts by its suffix; of a table, by the names of its columns."""
    suffix = Path(path).suffix.lower()
    if suffix != CSV:
        return suffix == GEOJSON
    try:
        with open_regular(path) as file:
            names = file.readline(HEADER).decode("utf-8-sig", errors="replace").strip().split(",")
    except (OSError, FileFault):
        return False
    return {*WHOLE, "side", "slant_range"} <= set(names)


def read_contacts(path: Path) -> tuple[Contact, ...]:
    """Read contacts by the suffix of a file."""
    with guarded(lambda *fault: SceneError(f"{path.name}: {'; '.join(fault)}"), "choose a file of contacts saved here"):
        text = read_text(path, largest=LARGEST)
    try:
        if path.suffix.lower() == CSV:
            rows = _rows_of_csv(text)
        else:
            rows = [dict(feature["properties"]) for feature in json.loads(text)["features"]]
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError, csv.Error) as error:
        raise SceneError(f"{path.name}: is not a file of contacts; choose a GeoJSON or CSV file saved here") from error
    return tuple(_contact(path, number, row) for number, row in enumerate(rows, start=1))


def _as_csv(contacts: Iterable[Contact]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, CONTACT_COLUMNS, extrasaction="ignore")
    writer.writeheader()
    for contact in contacts:
        cells = asdict(contact)
        # A spreadsheet takes what follows an apostrophe as text.
        writer.writerow(cells | {name: f"'{cells[name]}" for name in TEXTS if cells[name].startswith(FORMULA)})
    return text.getvalue()


def _rows_of_csv(text: str) -> list[dict[str, Any]]:
    reader = csv.DictReader(io.StringIO(text))
    if "ping" not in (reader.fieldnames or ()):
        raise ValueError("no column named ping")
    rows = list(reader)
    for row in rows:
        row |= {name: row[name][1:] for name in TEXTS if (row.get(name) or "").startswith("'")}
    return rows


def _contact(path: Path, number: int, row: dict[str, Any]) -> Contact:
    """Contact of one row, with every value checked."""

    def read(name: str, kind: Callable[[Any], Any]) -> Any:
        try:
            return kind(row.get(name))
        except (TypeError, ValueError, OverflowError) as error:
            raise SceneError(f"{path.name}: contact {number} has no valid {name}; correct the file") from error

    values: dict[str, Any] = {name: plain_text(str(row.get(name) or "")) for name in TEXTS}
    values |= {name: read(name, int) for name in WHOLE}
    values |= {name: None if row.get(name) in (None, "") else read(name, float) for name in REAL}
    values |= {"snapshot": read("snapshot", lambda text: base64.b64decode(text or "", validate=True))}
    for name in (*WHOLE, *REAL):
        if values[name] is not None and not abs(values[name]) <= GREATEST:
            raise SceneError(f"{path.name}: contact {number} has {name} {row[name]!s:.20}; give at most {GREATEST}")
    if row.get("side") not in SIDES:
        raise SceneError(f"{path.name}: contact {number} has side {row.get('side')!r}; write port or starboard")
    if values["confidence"] not in CONFIDENCES:
        known = ", ".join(CONFIDENCES[1:])
        raise SceneError(f"{path.name}: contact {number} has an unknown confidence; write {known} or leave it empty")
    if values["slant_range"] is None:
        raise SceneError(f"{path.name}: contact {number} has no slant_range; write it in metres")
    if min(values["ping"], values["range_bin"]) < 0:
        raise SceneError(f"{path.name}: contact {number} has a negative ping or range_bin; count them from 0")
    return Contact(side=row["side"], **values)
