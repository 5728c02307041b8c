"""Session, parameters, record, tow and files of contacts: what needs no window."""

import csv
import json
import os
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

from insonify.io import contacts as contact_files
from insonify.io.contacts import Contact, is_contacts, read_contacts, write_contacts
from insonify.scene import SceneError, bundled_scenes, edit, load_scene
from insonify_viewer.record.record import Record
from insonify_viewer.state.fields import ChoiceField, NumberField
from insonify_viewer.state.history import UNDO_DEPTH
from insonify_viewer.state.inspection import Mark
from insonify_viewer.state.sections import sections_of
from insonify_viewer.state.session import ContactList, Session
from insonify_viewer.state.tow_clock import TowClock


@pytest.fixture(scope="module")
def default():
    return load_scene("default")


@pytest.fixture
def session(default):
    return Session(default)


def parameters(scene) -> dict[str, Any]:
    return {p.path: p for section in sections_of(scene) for p in section.parameters}


def heard(session: Session) -> list[str]:
    sentences: list[str] = []
    session.said.connect(sentences.append)
    return sentences


def test_every_wanted_parameter_has_a_slider_and_an_open_one_shows_the_value_that_applies(default):
    found = parameters(edit(default, {"seabed.relief.peaks": [[8.0, 4.0], [3.0, -2.0]]}))
    sliders = {path for path, field in found.items() if isinstance(field, NumberField) and field.slider is not None}
    assert sliders >= {
        "sonar.beam.width", "sonar.range", "seabed.relief.beta", "seabed.relief.peaks.0.0", "seabed.relief.peaks.1.1",
        "seabed.material.diffuse", "seabed.material.specular", "seabed.material.shininess", "track.altitude",
        "targets.0.gap.2.1", "targets.1.position.1",
    }  # fmt: skip
    # Open fields show the value that applies.
    bare = edit(default, {"seabed.relief.beta": None, "track.altitude": None, "seabed.material": "rock"})
    shown = {"seabed.relief.beta": 1.4, "track.altitude": 10.0, "track.depth": 20.0, "water.reference_speed": 1500.0}
    shown |= {"seabed.material.diffuse": 0.5587}
    assert {path: field.value for path, field in parameters(bare).items() if path in shown} == shown


@pytest.mark.parametrize("name", sorted(bundled_scenes()))
def test_every_parameter_can_be_set_to_what_it_shows(name):
    scene = load_scene(name)
    for path, parameter in parameters(scene).items():
        value = int(parameter.value) if isinstance(parameter, NumberField) and parameter.integer else parameter.value
        assert Session(scene).settle({path: value}), path


def test_every_choice_can_be_made(default):
    for path, parameter in parameters(default).items():
        if isinstance(parameter, ChoiceField) and path != "seabed.relief.kind":
            for option in set(parameter.options) - {"recorded", "image", "backscatter", "cast"}:  # which need a file
                session = Session(default)
                sentences = heard(session)
                assert session.settle({path: option}), sentences
                assert parameters(session.scene)[path].value == option


def test_a_sum_of_motions_has_every_swing_and_numbers_parts_of_one_kind(session):
    session.settle({"track.motion.kind": "heave"})
    session.settle({"track.motion.amplitude": 0.7})
    session.settle({"track.motion.kind": "sum"})
    found = parameters(session.scene)
    assert found["track.motion.of.0.amplitude"].label == "heave amplitude"
    assert found["track.motion.of.0.amplitude"].value == 0.7
    swings = {found[f"track.motion.of.{k}.period"].label.split()[0] for k in range(6)}
    assert swings == {"surge", "sway", "heave", "yaw", "pitch", "roll"}
    session.settle({"track.motion.of": [{"kind": "heave"}, {"kind": "heave", "period": 3.0}, {"kind": "roll"}]})
    found = parameters(session.scene)
    labels = [found[f"track.motion.of.{part}.amplitude"].label for part in range(3)]
    assert labels == ["heave 1 amplitude", "heave 2 amplitude", "roll amplitude"]
    session.settle({"track.motion.kind": "straight"})
    assert session.scene.track.motion.kind == "straight"


def test_altitude_and_depth_take_turns_and_terrain_following_needs_an_altitude(session):
    assert session.settle({"track.depth": 24.0})
    assert session.scene.altitude == 6.0
    assert session.settle({"track.altitude": 8.0})
    assert session.scene.track.depth is None
    session.settle({"track.depth": 18.0})
    assert session.settle({"track.terrain_following": True})
    assert session.scene.track.altitude == 12.0
    assert session.settle({"track.depth": 15.0})
    assert not session.scene.track.terrain_following


def test_a_material_becomes_a_map_and_back_and_its_shares_what_arrives(session):
    sentences = heard(session)
    assert session.settle({"targets.0.material.diffuse": 0.8})
    assert session.scene.targets[0].material.specular == 0.2
    assert "specular share lowered to 0.2" in sentences[-1]
    session.settle({"seabed.material.name": "cobble"})
    session.settle({"seabed.material.kind": "patches"})
    assert [m.name for m in session.scene.seabed.material.of] == ["cobble", "rock"]
    assert "seabed.material.of.1.diffuse" in parameters(session.scene)
    session.settle({"seabed.material.kind": "uniform"})
    assert session.scene.seabed.material.name == "cobble"


def test_dunes_pass_for_the_pattern_there_was(default):
    pattern = load_scene("figure-5-pattern")
    session = Session(pattern)
    assert session.settle({"seabed.relief.kind": "mimic"})
    dunes, relief = load_scene("figure-5-relief"), session.scene.seabed.relief
    assert relief == dunes.seabed.relief.model_copy(update={"reach": 50.0})
    assert session.scene.seabed.material == dunes.seabed.material
    shown = [path for path in parameters(session.scene) if path.startswith("seabed.relief.of.of.0")]
    assert shown == ["seabed.relief.of.of.0.name", "seabed.relief.of.of.0.diffuse"]
    assert session.settle({"seabed.relief.of.of.0.name": "coarse_sand"})
    assert parameters(session.scene)["seabed.relief.of.of.0.diffuse"].value == 0.3955
    assert session.settle({"seabed.relief.kind": "flat"})
    plain = Session(default)
    assert plain.settle({"seabed.relief.kind": "mimic"})
    assert plain.scene.seabed.relief.altitude == default.altitude
    assert plain.scene.seabed.relief.law == default.sonar.law


def test_light_leaves_the_water_out_and_the_gain_makes_its_absorption_good(default):
    scene = edit(default, {"receiver.tvg": "power", "water.absorption": 97.0})
    assert parameters(scene)["receiver.tvg.absorption"].value == pytest.approx(97.0)
    deep = {"receiver.reverberation": "volume", "water.kind": "profile", "water.surface": "flat", "sonar.bounces": 1}
    session = Session(edit(default, deep))
    assert session.settle({"sonar.law": "light"})
    scene = session.scene
    assert (scene.sonar.law, scene.receiver.reverberation.kind, scene.sonar.bounces) == ("light", "none", 0)
    assert (scene.water.kind, scene.water.surface.kind) == ("uniform", "none")


def test_sliders_end_where_the_scene_does(default):
    found = parameters(default)
    assert (found["sonar.ping_rate"].slider, found["track.altitude"].slider) == ((0.5, 15.0), (2.0, 30.0))
    assert found["targets.0.gap.1.0"].slider == pytest.approx((-27.78, -6.22))
    bounded_by_others = ("seabed.depth", "seabed.spacing", "seabed.relief.period", "seabed.relief.peaks.0.0")
    for path, parameter in found.items():
        if isinstance(parameter, NumberField) and parameter.slider and path not in bounded_by_others:
            for end in parameter.slider:
                assert Session(default).settle({path: int(end) if parameter.integer else end}), (path, end)


def test_drag_starts_from_what_is_settled(session, default):
    changes, sentences = [], heard(session)
    session.changed.connect(lambda scene, settled: changes.append((scene.sonar.ping_rate, settled)))
    for reach in (60.0, 100.0, 70.0):
        session.drag({"sonar.range": reach})
    session.settle()
    assert changes == [(10.0, False), (7.5, False), (10.0, False), (10.0, True)]
    assert "ping rate lowered to 7.5 Hz" in sentences[1]
    session.undo()
    assert session.scene == default
    assert not session.history.undoable


def test_contacts_and_a_look_outlast_a_refused_scene_and_do_not_end_a_drag_and_the_history_has_an_end(session, default):
    contacts = ContactList(session)
    contacts.add(IN_WATER)
    session.settle({"seed": 5})
    contacts.add(replace(IN_WATER, name="rock"))
    session.take_back()
    assert session.scene == default
    assert [each.name for each in contacts.all] == ["fish", "rock"]
    assert session.history.undoable == ("rock marked", "fish marked")
    assert not session.history.redoable
    session.settle({"seed": 5})
    session.show(gain=3.0)
    session.take_back()
    assert (session.scene, session.display.gain, session.history.undoable[0]) == (default, 3.0, "gain")
    # A contact does not end a drag.
    session.undo(3)
    session.drag({"track.altitude": 7.0})
    contacts.add(IN_WATER)
    assert session.scene.track.altitude == 7.0
    session.settle()
    assert session.history.undoable == ("altitude", "fish marked")
    session.undo()
    assert (session.scene, len(contacts)) == (default, 1)
    for number in range(UNDO_DEPTH + 19):
        contacts.add(replace(IN_WATER, name=str(number + 1)))
    session.undo(10 * UNDO_DEPTH)
    assert len(contacts) == 20


def test_another_look_gives_up_nothing_that_can_be_redone_and_a_look_and_back_is_no_step(session, default):
    session.settle({"track.altitude": 7.0})
    session.show(palette="grey")
    session.undo(2)
    session.show(ground_range=True)
    assert not session.history.undoable
    session.redo(2)
    assert session.scene.track.altitude == 7.0
    assert (session.display.palette, session.display.ground_range) == ("grey", True)
    session.undo(2)
    session.settle({"track.altitude": 7.0})
    session.settle({"seed": default.seed})
    assert session.history.undoable == ("altitude",)
    for on in (False, True):
        session.show(ground_range=on)
    assert session.history.undoable == ("altitude",)
    session.drag({"track.altitude": 8.0})
    session.show(gain=3.0)
    assert session.scene.track.altitude == 8.0, "the drag goes on"
    session.settle()
    assert session.history.undoable == ("altitude", "gain", "altitude")


def test_refusal_is_one_sentence_and_a_mark_is_announced_once(session, default):
    refused, marks = [], []
    session.refused.connect(refused.append)
    assert not session.settle({"seabed.depth": 5.0})
    assert "above the surface" in str(refused[-1])
    assert session.scene == default
    session.marked.connect(marks.append)
    for mark in (Mark(1, 0, 2), Mark(1, 0, 2), None):
        session.point_at(mark)
    assert marks == [Mark(1, 0, 2), None]


def test_record_keeps_rows_newer_pings_above_and_knows_what_is_missing():
    record = Record(pings=8, bins=3)
    pings = np.array([9, 8, 7])
    amplitude = np.arange(18, dtype=np.float32).reshape(3, 2, 3)
    record.put(pings, amplitude, stamp=4)
    assert [record.amplitude_at(*place) for place in ((8, 0, 2), (8, 1, 2), (0, 0, 0))] == [8.0, 11.0, None]
    assert list(record.amplitude[record.rows(np.array([9]))][0]) == [2, 1, 0, 3, 4, 5]
    assert list(record.missing(9, 4)) == [6, 5, 4, 3, 2]
    assert list(record.missing(9, 5)) == [9, 8, 7, 6, 5, 4, 3, 2]
    assert list(record.missing(2, 4)) == [2, 1, 0], "the tow starts at ping 0"
    rows = record.rows(record.shown(13))
    assert list(np.diff(rows) % 8) == [1] * 7


def test_tow_counts_pauses_and_looks_back():
    tow = TowClock(511)
    tow.speed = 2.0
    assert tow.advance(1.0, 10.0)
    assert tow.newest == tow.top == 531
    tow.look_back(5)
    assert tow.top == 531, "only a paused tow looks back"
    tow.run(False)
    assert not tow.advance(1.0, 10.0)
    tow.look_back(10_000)
    assert tow.top == 0, "the first ping can be on top, for which the fish is at the start"
    tow.look_back(-3)
    assert tow.top == 3
    tow.go_to(200)
    assert (tow.top, tow.newest) == (200, 531)
    tow.run(True)
    assert (tow.top, tow.newest) == (200, 200), "the tow goes on from the ping on top"
    assert tow.advance(1.0, 10.0)
    assert tow.top == 220
    tow.go_to(900)
    assert (tow.top, tow.newest) == (900, 900)
    tow.restart(531)
    tow.run(True)
    assert tow.top == 531


def test_a_volume_has_a_section_of_its_own(default):
    plume = {"kind": "plume", "position": [5.0, 10.0, -30.0]}
    found = {section.key: section for section in sections_of(edit(default, {"volumes": [plume]}))}
    assert found["volumes.0"].title == "Plume 1"
    assert found["volumes.0"].removable
    assert "volumes.0.radius" in {row.path for row in found["volumes.0"].parameters}


PLAIN = Contact("wreck, bow", 'broken; "see log"\nline 2', "A scene", 120, "port", 700, 35.02, 33.6, 24.0, 33.6)
ON_EARTH = replace(PLAIN, name="Anker ⚓", longitude=-68.82834, latitude=48.44586, snapshot=b"\x89PNG\x00\xff")
IN_WATER = Contact("fish", "", "line.xtf", 3, "starboard", 12, 2.5)


def test_geojson_holds_all_of_contacts_and_a_table_all_but_snapshots_and_formulas_of_a_spreadsheet(tmp_path):
    path = tmp_path / "found.geojson"
    write_contacts(path, [PLAIN, ON_EARTH, IN_WATER])
    assert read_contacts(path) == (PLAIN, ON_EARTH, IN_WATER)
    collection = json.loads(path.read_text(encoding="utf-8"))
    assert collection["type"] == "FeatureCollection"
    point = {"type": "Point", "coordinates": [-68.82834, 48.44586]}
    assert [each["geometry"] for each in collection["features"]] == [None, point, None]
    assert collection["features"][1]["properties"]["name"] == "Anker ⚓"
    path = tmp_path / "found.csv"
    write_contacts(path, [PLAIN, ON_EARTH, IN_WATER])
    assert read_contacts(path) == (PLAIN, replace(ON_EARTH, snapshot=b""), IN_WATER)
    assert [row["slant_range"] for row in read_rows(path)] == ["35.02", "35.02", "2.5"]
    contacts = [replace(IN_WATER, name=text) for text in ("=cmd|' /C calc'!A0", "+1", "-1", "@a", "'quoted'")]
    write_contacts(path, contacts)
    assert all(row["name"].startswith("'") for row in read_rows(path))
    assert list(read_contacts(path)) == contacts


def read_rows(path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


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
        ("note", "x" * 131_073, "is not a file of contacts"),
    ],
)
def test_a_mistake_is_named(tmp_path, field, value, said):
    path = tmp_path / "found.csv"
    write_contacts(path, [PLAIN, ON_EARTH])
    rows = read_rows(path)
    rows[1][field] = value
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    with pytest.raises(SceneError, match=said):
        read_contacts(path)


def test_what_is_no_file_of_contacts_or_holds_an_endless_number_is_refused(tmp_path):
    endless = '{"features": [{"properties": {"ping": 1e400, "range_bin": 1, "side": "port", "slant_range": 1}}]}'
    others = ("", "{}", "[1]", '{"features": 3}', "a,b\n1,2\n", "[" * 100_000)
    for name, text in [("found.geojson", endless), *product(("found.geojson", "found.csv"), others)]:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        with pytest.raises(SceneError, match="no valid ping" if text == endless else "is not a file of contacts"):
            read_contacts(path)
    with pytest.raises(SceneError, match="does not exist"):
        read_contacts(tmp_path / "missing.csv")


def test_half_a_character_in_a_contact_is_replaced_and_hinders_no_saving(tmp_path):
    halved = replace(PLAIN, name="a\ud83d", note="\udfffb", source="caf\udce9.xtf", classification="\ud800")
    assert (halved.name, halved.note, halved.source, halved.classification) == ("a?", "?b", "caf?.xtf", "?")
    for name in ("found.geojson", "found.csv"):
        write_contacts(tmp_path / name, [halved, IN_WATER])
        assert read_contacts(tmp_path / name) == (halved, IN_WATER)
    text = (tmp_path / "found.geojson").read_text(encoding="utf-8").replace("wreck", "x").replace("a?", r"a\ud83d")
    (tmp_path / "found.geojson").write_text(text, encoding="utf-8")
    assert read_contacts(tmp_path / "found.geojson")[0].name == "a?"


@pytest.mark.parametrize("name", ["found.geojson", "found.csv"])
def test_contacts_are_read_from_regular_files_of_limited_size(tmp_path, name, monkeypatch):
    path = tmp_path / name
    os.mkfifo(path)
    assert is_contacts(str(path)) == (path.suffix == ".geojson")
    with pytest.raises(SceneError, match=f"{name}: is a device or a pipe, not a file; "):
        read_contacts(path)
    path.unlink()
    write_contacts(path, [PLAIN])
    assert is_contacts(str(path))
    monkeypatch.setattr(contact_files, "LARGEST", 20)
    with pytest.raises(SceneError, match=f"{name}: is a text of more than 0 MB; thin it"):
        read_contacts(path)


def test_a_list_numbers_names_and_knows_what_is_saved():
    session = Session(load_scene("default"))
    contacts, told = ContactList(session), []
    contacts.changed.connect(lambda: told.append(len(contacts)))
    nameless = replace(PLAIN, name="")
    contacts.add(nameless)
    contacts.add(nameless)
    contacts.remove(0)
    contacts.add(nameless)
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
