"""Files of contacts are read back as they were written, and what is wrong with one is told in a sentence."""

import csv
import json
from dataclasses import replace

import pytest

from insonify.scene import SceneError, load_scene
from insonify_viewer.state.contacts import Contact, read_contacts, write_contacts
from insonify_viewer.state.session import ContactList, Session

PLAIN = Contact("wreck, bow", 'broken; "see log"\nline 2', "A scene", 120, "port", 700, 35.02, 33.6, 24.0, 33.6)
ON_EARTH = replace(PLAIN, name="Anker ⚓", longitude=-68.82834, latitude=48.44586, snapshot=b"\x89PNG\x00\xff")
IN_WATER = Contact("fish", "", "line.xtf", 3, "starboard", 12, 2.5)


def test_geojson_holds_everything(tmp_path):
    path = tmp_path / "found.geojson"
    write_contacts(path, [PLAIN, ON_EARTH, IN_WATER])
    assert read_contacts(path) == (PLAIN, ON_EARTH, IN_WATER)
    collection = json.loads(path.read_text(encoding="utf-8"))
    assert collection["type"] == "FeatureCollection"
    assert [each["geometry"] for each in collection["features"]] == [
        None,
        {"type": "Point", "coordinates": [-68.82834, 48.44586]},
        None,
    ]
    assert collection["features"][1]["properties"]["name"] == "Anker ⚓"


def test_a_table_holds_everything_but_the_snapshots(tmp_path):
    path = tmp_path / "found.csv"
    write_contacts(path, [PLAIN, ON_EARTH, IN_WATER])
    assert read_contacts(path) == (PLAIN, replace(ON_EARTH, snapshot=b""), IN_WATER)
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["slant_range"] for row in rows] == ["35.02", "35.02", "2.5"]


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("ping", "x", "contact 2 has no valid ping"),
        ("ping", "-1", "negative ping"),
        ("side", "left", "side 'left'; write port or starboard"),
        ("slant_range", "", "no slant_range"),
        ("latitude", "48° N", "no valid latitude"),
        ("latitude", "nan", "latitude nan; give at most"),
        ("x", "1e300", "x 1e300; give at most"),
        ("ping", "9" * 5000, "no valid ping"),
        ("ping", "1" + "0" * 400, "ping 10000000000000000000; give at most"),
        ("note", "x" * 131_073, "is no file of contacts"),
    ],
)
def test_a_mistake_is_named(tmp_path, field, value, said):
    path = tmp_path / "found.csv"
    write_contacts(path, [PLAIN, ON_EARTH])
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    rows[1][field] = value
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    with pytest.raises(SceneError, match=said):
        read_contacts(path)


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"features": 3}', "a,b\n1,2\n"])
def test_what_is_no_file_of_contacts_is_refused(tmp_path, text):
    for name in ("found.geojson", "found.csv"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        with pytest.raises(SceneError, match="is no file of contacts"):
            read_contacts(path)
    with pytest.raises(SceneError, match="cannot be read"):
        read_contacts(tmp_path / "missing.csv")


@pytest.mark.parametrize(
    "text",
    [
        "[" * 100_000,
        '{"features": [{"properties": {"ping": 1e400, "range_bin": 1, "side": "port", "slant_range": 1}}]}',
    ],
)
def test_endless_and_deep_files_are_refused_in_a_sentence(tmp_path, text):
    path = tmp_path / "found.geojson"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match=r"is no file of contacts|no valid ping"):
        read_contacts(path)


def test_a_spreadsheet_takes_no_text_as_a_formula(tmp_path):
    path = tmp_path / "found.csv"
    contacts = [replace(IN_WATER, name=text) for text in ("=cmd|' /C calc'!A0", "+1", "-1", "@a", "'quoted'")]
    write_contacts(path, contacts)
    with path.open(encoding="utf-8", newline="") as file:
        assert all(row["name"].startswith("'") for row in csv.DictReader(file))
    assert list(read_contacts(path)) == contacts


def test_a_list_numbers_names_and_knows_what_is_saved():
    session = Session(load_scene("default"))
    contacts, told = ContactList(session), []
    contacts.changed.connect(lambda: told.append(len(contacts)))
    contacts.add(replace(PLAIN, name=""))
    contacts.add(replace(PLAIN, name=""))
    contacts.remove(0)
    contacts.add(replace(PLAIN, name=""))
    assert [each.name for each in contacts.all] == ["contact 2", "contact 1"]
    assert contacts.unsaved
    contacts.mark_saved("found.geojson")
    assert not contacts.unsaved
    contacts.edit(0, "note", "a rock")
    assert contacts.unsaved
    assert contacts[0].note == "a rock"
    contacts.open([PLAIN], "other.csv")
    assert (len(contacts), contacts.unsaved, contacts.file) == (1, False, "other.csv")
    assert told == [1, 2, 1, 2, 2, 2, 1]
    session.undo(2)
    assert not contacts.unsaved, "as they are in their file"
    session.redo()
    assert contacts.unsaved
    session.undo(9)
    assert (len(contacts), contacts.unsaved) == (0, False), "there is nothing to save"
