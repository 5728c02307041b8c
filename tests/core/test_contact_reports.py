"""Reports of contacts: placemarks in KML, pages in HTML and PDF."""

from dataclasses import replace
from io import BytesIO
from xml.etree import ElementTree

import pytest
from PIL import Image

from insonify.errors import SceneError
from insonify.io.contact_reports import KML, describe_contact, write_report
from insonify.io.contacts import Contact

picture = BytesIO()
Image.new("RGB", (8, 8), "red").save(picture, "PNG")
HERE = Contact(
    "wreck <b>", "a & b $x$ " * 30, "line.xtf", 120, "port", 700, 35.02, 33.6, 24.0, 33.6, -68.5, 48.25, "wreck", 31.2,
    height=2.5, confidence="high", snapshot=picture.getvalue(),
)  # fmt: skip
NOWHERE = Contact("fish", "", "line.xtf", 3, "starboard", 12, 2.5, snapshot=b"no picture")


def test_a_contact_is_described_without_what_is_not_known():
    told = describe_contact(HERE)
    assert (told["class"], told["length"], told["height"]) == ("wreck", "31.20 m", "2.50 m")
    assert told["position"] == "48.250000° N, 68.500000° W"
    assert list(describe_contact(NOWHERE)) == ["range", "ping", "record"]


def test_placemarks_lie_at_longitude_and_latitude(tmp_path):
    write_report(tmp_path / "found.kml", [NOWHERE, HERE])
    (mark,) = ElementTree.parse(tmp_path / "found.kml").iter(f"{{{KML}}}Placemark")
    assert mark.findtext(f"{{{KML}}}name") == "wreck <b>"
    assert mark.findtext(f".//{{{KML}}}coordinates") == "-68.5,48.25,0"
    with pytest.raises(SceneError, match="no contact has a geographic position"):
        write_report(tmp_path / "none.kml", [NOWHERE])
    assert not (tmp_path / "none.kml").exists()


def test_a_page_shows_texts_as_they_are_with_the_picture_and_a_long_list_goes_on_to_the_next_of_paper(tmp_path):
    write_report(tmp_path / "found.html", [HERE, NOWHERE])
    page = (tmp_path / "found.html").read_text(encoding="utf-8")
    assert "wreck &lt;b&gt;" in page
    assert "a &amp; b $x$" in page
    assert page.count("data:image/png;base64,") == 2
    write_report(tmp_path / "found.pdf", [HERE, NOWHERE] * 4 + [replace(HERE, snapshot=b"")])
    written = (tmp_path / "found.pdf").read_bytes()
    assert written.startswith(b"%PDF")
    assert written.count(b"/Type /Page ") > 1
