"""Survey exercises: what is drawn, what the file tells, and marks of contacts whose truth is known."""

import csv
import json
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands import refused
from insonify.cli import main
from insonify.exercises.exercise import Exercise, Hidden, make_exercise, read_exercise, write_exercise
from insonify.exercises.marking import Found, Track, describe_marks, mark_contacts, read_found, read_track
from insonify.io.contacts import Contact, write_contacts
from insonify.io.georeference import to_degrees
from insonify.live.helm import Helm
from insonify.live.tow import steer_by
from insonify.scene import edit, load_scene
from insonify.simulation import prepare

BASIN = "harbour-search"


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("exercise") / "search.exercise"
    write_exercise(path, make_exercise(BASIN, 5))
    return path


@pytest.fixture(scope="module")
def exercise(file: Path) -> Exercise:
    return read_exercise(file)


def test_a_seed_draws_one_exercise_and_another_draws_another(exercise: Exercise, tmp_path: Path) -> None:
    assert make_exercise(BASIN, 5) == make_exercise(BASIN, 5)
    wanted, digests = set(), set()
    for seed in range(6):
        content = make_exercise(BASIN, seed)
        digests.add(content["digest"])
        write_exercise(tmp_path / "one.exercise", content)
        drawn = read_exercise(tmp_path / "one.exercise")
        wanted.add(sum(each.wanted for each in drawn.hidden))
        places = np.array([each[2:4] for each in drawn.hidden])
        assert (places > drawn.area.min(axis=0)).all()
        assert (places < drawn.area.max(axis=0)).all()
        apart = np.hypot(*(places[:, None] - places).transpose(2, 0, 1)) + 100.0 * np.eye(len(places))
        assert apart.min() > 6.0
        assert np.abs(drawn.current).max() <= 0.25
        assert all(0.05 < each.height < 2.0 for each in drawn.hidden)
    assert len(digests) == 6
    assert len(wanted) > 1
    assert len(exercise.scene.targets) == len(exercise.hidden)
    assert not exercise.bare.targets
    assert not exercise.bare.volumes


def test_the_file_gives_nothing_away_and_stands_for_a_scene(file: Path, exercise: Exercise) -> None:
    text = file.read_text()
    assert "dredged" in text
    for each in exercise.scene.targets:
        assert each.path not in text.partition("sealed")[2]  # type: ignore[attr-defined]
        assert f"{each.position[0]}" not in text
    assert load_scene(file) == exercise.scene
    degrees = np.array(tomllib.loads(text)["area_on_earth"])
    assert exercise.scene.georeference is not None
    np.testing.assert_allclose(degrees.T, to_degrees(exercise.scene.georeference, *exercise.area.T), atol=1e-7)


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (lambda text: text.replace("minutes = 25.0\n", ""), "lacks a part ('minutes'); make it again"),
        (lambda text: text.replace("eJ", "eK", 1), "is not as it was made; take the file that insonify exercise make"),
        (lambda text: text.partition("sealed")[0], "is not as it was made"),
        (lambda text: "title = [", "is not valid TOML"),
    ],
)
def test_damaged_exercises(
    damage: Any, sentence: str, file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, contacts = tmp_path / "damaged.exercise", tmp_path / "contacts.csv"
    path.write_text(damage(file.read_text()))
    contacts.write_text("name,x,y\n")
    assert sentence in refused(capsys, "exercise", "mark", str(path), str(contacts))


HIDDEN = (
    Hidden("mine", True, 20.0, 30.0, 0.5),
    Hidden("mine", True, 100.0, 50.0, 0.6),
    Hidden("bomb", True, 150.0, 90.0, 0.4),
    Hidden("other", False, 60.0, 60.0, 1.0),
)


def known(exercise: Exercise) -> Exercise:
    return Exercise(**{**vars(exercise), "hidden": HIDDEN})


def test_marks_of_known_contacts(exercise: Exercise) -> None:
    contacts = [
        Found("a", 21.0, 30.0, 0.4), Found("again", 20.0, 32.0), Found("b", 100.0, 47.5), Found("rock", 61.0, 61.0),
        Found("ghost", 150.0, 95.0, 2.0),
    ]  # fmt: skip
    marks = mark_contacts(known(exercise), contacts)
    assert [(match.found.name, match.target) for match in marks.found] == [("a", HIDDEN[0]), ("b", HIDDEN[1])]
    assert [match.away for match in marks.found] == [1.0, 2.5]
    assert marks.missed == [HIDDEN[2]]
    assert [match.found.name for match in marks.others] == ["rock"]
    assert [match.found.name for match in marks.repeated] == ["again"]
    assert [one.name for one in marks.false] == ["ghost"]
    lines = describe_marks(known(exercise), marks)
    assert lines[0] == "Harbour search: 2 of 3 found, 1 missed, 1 false, 1 of other things, 1 repeated"
    assert "  a: mine, 1.00 m away, height -0.10 m of 0.50 m" in lines
    assert lines[-1] == f"rms error of positions {math.sqrt(7.25 / 2):.2f} m, of heights 0.10 m over 1"
    assert describe_marks(known(exercise), mark_contacts(known(exercise), []))[0].startswith(
        "Harbour search: 0 of 3 found"
    )
    # Two contacts between two targets are given to both, though one is nearest to both.
    near = Exercise(**{**vars(exercise), "hidden": (HIDDEN[0], Hidden("mine", True, 24.0, 30.0, 0.5))})
    both = mark_contacts(near, [Found("a", 22.1, 30.0), Found("b", 21.5, 30.0)])
    assert len(both.found) == 2


def test_coverage_of_lines_whose_area_is_known(exercise: Exercise) -> None:
    def line(y: float) -> Track:
        x = np.linspace(-5.0, 205.0, 400)
        return Track(x, np.full(x.size, y), 9.0, 41.0, 105.0)

    def covered(*lines: float) -> float:
        return mark_contacts(exercise, [], map(line, lines)).coverage

    assert covered(75.0) == pytest.approx(80.0 / 150.0, abs=0.01)  # 40 m to either side
    assert covered(75.0, 75.0) == covered(75.0)
    assert covered(10.0, 140.0) == pytest.approx(100.0 / 150.0, abs=0.01)
    assert covered(30.0, 110.0) == pytest.approx(1.0, abs=0.01)
    marks = mark_contacts(exercise, [], [line(30.0)] * 20)
    assert describe_marks(exercise, marks)[-1].endswith("in 35.0 of 25 minutes, 10.0 over")


def test_contacts_of_the_viewer_and_of_other_programs(exercise: Exercise, tmp_path: Path) -> None:
    place = exercise.scene.georeference
    assert place is not None
    longitude, latitude = (float(value[0]) for value in to_degrees(place, np.array([42.0]), np.array([17.5])))
    contact = Contact("c", "", "", 3, "port", 9, 12.0, x=1e6, y=0.0, longitude=longitude, latitude=latitude, height=0.7)
    lines = [["Label", "LON", " Lat ", "target_height"], ["c", longitude, latitude, 0.7]]
    table = tmp_path / "others.csv"
    with table.open("w", newline="") as stream:
        csv.writer(stream).writerows(lines)
    point = {"type": "Point", "coordinates": [longitude, latitude]}
    features = [{"type": "Feature", "geometry": point, "properties": {"id": "c", "height": 0.7}}]
    (tmp_path / "others.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    (tmp_path / "local.csv").write_text("name,x,y,height\nc,42.0,17.5,0.7\n")
    for name in ("ours.csv", "ours.geojson"):
        write_contacts(tmp_path / name, [contact])
    for name in ("ours.csv", "ours.geojson", "others.csv", "others.geojson", "local.csv"):
        (found,) = read_found(exercise, tmp_path / name)
        assert found.name == "c"
        assert found[1:] == pytest.approx((42.0, 17.5, 0.7), abs=1e-3)


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        (
            "a.csv",
            "name,height\nb,3\n",
            "contact 1 has no place; give .csv or .geojson with columns longitude and latitude, or x and y",
        ),
        ("a.csv", "name,x,y\nb,three,4\n", "is not a list of contacts"),
        ("a.geojson", "{}", "is not a list of contacts"),
        ("a.txt", "x", "is no list of contacts by its suffix; give .csv or .geojson"),
    ],
)
def test_contacts_that_cannot_be_read(
    name: str, text: str, sentence: str, file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / name).write_text(text)
    assert sentence in refused(capsys, "exercise", "mark", str(file), str(tmp_path / name))


def test_an_exercise_from_making_to_marking(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, survey, contacts = (tmp_path / name for name in ("a.exercise", "a.xtf", "a.csv"))
    assert main(["exercise", "make", BASIN, "--seed", "3", "-o", str(path)]) == 0
    assert (
        main(["tow", str(path), "--set", "sonar.bins=64", "--xtf", str(survey), "--pings", "60", "--times", "20"]) == 0
    )
    exercise = read_exercise(path)
    track = read_track(exercise, str(survey))
    assert track.seconds == pytest.approx(59 / exercise.scene.sonar.ping_rate, abs=0.02)
    drifted = 59 / exercise.scene.sonar.ping_rate * np.array([2.0 + exercise.current[0], exercise.current[1]])
    np.testing.assert_allclose((track.x[-1] - track.x[0], track.y[-1] - track.y[0]), drifted, atol=0.02)
    target = next(each for each in exercise.hidden if each.wanted)
    contacts.write_text(f"name,x,y\nmine,{target.x + 0.5},{target.y}\n")
    capsys.readouterr()
    assert main(["exercise", "mark", str(path), str(contacts), "--record", str(survey)]) == 0
    said = capsys.readouterr().out
    assert "1 of " in said
    assert "mine, 0.50 m away" in said or "bomb, 0.50 m away" in said
    assert "% of the area covered, in 0.1 of 25 minutes" in said


def test_a_steered_simulation_is_traced_along_its_helm(exercise: Exercise) -> None:
    scene = edit(exercise.scene, {"sonar.bins": 64})
    helm = Helm(scene, 0, exercise.current)
    steered = steer_by(prepare(scene), helm)
    helm.turn = 5.0
    helm.advance(40)
    line, poses = helm.line(np.arange(41)), steered.poses(np.arange(41))
    np.testing.assert_array_equal(poses.x, line.x)
    assert poses.heading[-1] - poses.heading[0] == pytest.approx(math.radians(5.0 * 40 / 15.0), abs=0.03)
    assert steered.intensity(np.arange(3)).shape == (3, 2, 64)
