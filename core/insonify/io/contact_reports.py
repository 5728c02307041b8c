"""Reports of contacts that leave the program: placemarks in KML, and pages with pictures in HTML and PDF."""

import io
from collections.abc import Sequence
from itertools import chain, repeat
from pathlib import Path
from textwrap import wrap
from typing import Any
from xml.etree import ElementTree

from insonify.errors import SceneError, plain_text
from insonify.io.atomic import replacing, write_text
from insonify.io.contacts import Contact
from insonify.io.pages import fill_page, picture_url

FORMATS = (("Report with pictures (PDF)", ".pdf"), ("Page with pictures (HTML)", ".html"), ("Placemarks (KML)", ".kml"))
KML = "http://www.opengis.net/kml/2.2"
PAPER, DPI = (8.27, 11.69), 150  # inches of A4, dots per inch of the pictures
# Shares of the page: upper edge, left edge, edge of the text, height of a picture and of a line.
TOP, LEFT, MIDDLE, PICTURE, LINE = 0.95, 0.07, 0.35, 0.17, 0.016
LARGEST_SIDE = 4096  # px, of a picture
WIDEST = 58  # letters of a line beside a picture


def write_report(path: Path, contacts: Sequence[Contact]) -> None:
    """Write a report of contacts, in their order, by the suffix of a file: ``.pdf``, ``.html`` or ``.kml``."""
    if path.suffix.lower() == ".html":
        write_text(path, fill_page("contacts", contacts=list(map(_shown, contacts))))
    elif path.suffix.lower() == ".kml":
        _write_kml(path, contacts)
    else:
        _write_pdf(path, contacts)


def describe_contact(contact: Contact) -> dict[str, str]:
    """Describe a contact field by field, without what is not known."""
    sizes = {name: getattr(contact, name) for name in ("length", "width", "height")}
    texts = {"class": contact.classification, "confidence": contact.confidence}
    texts |= {name: "" if size is None else f"{size:.2f} m" for name, size in sizes.items()}
    if contact.longitude is not None and contact.latitude is not None:
        north, east = "N" if contact.latitude >= 0.0 else "S", "E" if contact.longitude >= 0.0 else "W"
        texts["position"] = f"{abs(contact.latitude):.6f}° {north}, {abs(contact.longitude):.6f}° {east}"
    if contact.x is not None and contact.y is not None:
        texts["x, y"] = f"{contact.x:.2f} m, {contact.y:.2f} m"
    across = "" if contact.ground_range is None else f", {contact.ground_range:.2f} m on the bed"
    texts["range"] = f"{contact.slant_range:.2f} m {contact.side}{across}"
    texts |= {"ping": str(contact.ping), "record": contact.source, "remark": contact.note}
    return {name: plain_text(text) for name, text in texts.items() if text}


def _write_kml(path: Path, contacts: Sequence[Contact]) -> None:
    """Write the contacts with a place on Earth as placemarks."""
    placed = [contact for contact in contacts if contact.longitude is not None and contact.latitude is not None]
    if not placed:
        raise SceneError(f"{path.name}: no contact has a geographic position; set [world] in the scene, or write HTML")
    root = ElementTree.Element("kml", xmlns=KML)
    document = ElementTree.SubElement(root, "Document")
    ElementTree.SubElement(document, "name").text = path.stem
    for contact in placed:
        mark = ElementTree.SubElement(document, "Placemark")
        ElementTree.SubElement(mark, "name").text = plain_text(contact.name)
        ElementTree.SubElement(mark, "description").text = fill_page("placemark", contact=_shown(contact))
        point = ElementTree.SubElement(mark, "Point")
        ElementTree.SubElement(point, "coordinates").text = f"{contact.longitude!r},{contact.latitude!r},0"
    write_text(path, ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n")


def _shown(contact: Contact) -> dict[str, Any]:
    """Name, fields and picture of a contact, as pages and placemarks show them."""
    fields, picture = describe_contact(contact), picture_url(contact.snapshot)
    return {"name": plain_text(contact.name), "fields": fields, "picture": picture}


def _write_pdf(path: Path, contacts: Sequence[Contact]) -> None:
    """Write pages of A4, with a picture of each contact beside its description."""
    from matplotlib.backends.backend_pdf import PdfPages  # lazy: only a report on paper needs it
    from matplotlib.figure import Figure

    with replacing(path) as beside, PdfPages(beside, metadata={"Title": "Contacts"}) as pages:
        figure, top = Figure(figsize=PAPER), TOP
        style: dict[str, Any] = {"va": "top", "parse_math": False}
        for contact in contacts:
            lines = [
                (name if first else "", line)
                for name, text in describe_contact(contact).items()
                for first, line in zip(chain([True], repeat(False)), wrap(text, WIDEST))
            ]
            high = max((len(lines) + 3) * LINE, PICTURE + 2 * LINE)
            if top - high < 1.0 - TOP and top < TOP:
                pages.savefig(figure, dpi=DPI)
                figure, top = Figure(figsize=PAPER), TOP
            if (pixels := _pixels(contact)) is not None:
                axes = figure.add_axes((LEFT, top - PICTURE, 1.414 * PICTURE, PICTURE))
                axes.imshow(pixels, interpolation="nearest")
                axes.set_axis_off()
            figure.text(MIDDLE, top, plain_text(contact.name), fontsize=12, fontweight="bold", **style)
            for row, (name, line) in enumerate(lines):
                y = top - (row + 1.5) * LINE
                figure.text(MIDDLE, y, name, color="0.4", fontsize=9, **style)
                figure.text(MIDDLE + 0.11, y, line, fontsize=9, **style)
            top -= high
        pages.savefig(figure, dpi=DPI)


def _pixels(contact: Contact) -> Any:
    """Pixels of the picture of a contact; None if there is none that can be read."""
    from PIL import Image  # lazy: only a report on paper needs it

    try:
        with Image.open(io.BytesIO(contact.snapshot), formats=("PNG",)) as picture:
            return picture.convert("RGB") if max(picture.size) <= LARGEST_SIDE else None
    except (OSError, ValueError, SyntaxError):
        return None
