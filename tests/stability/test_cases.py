"""Every stability case and the scenes named after what breaks: the common method fails, the program's own holds."""

import math
import re
from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest
from matplotlib.figure import Figure

from commands import refused
from insonify.accuracy.stability import CASES, Outcome, StabilityCase, find_themes, themes
from insonify.accuracy.stability.case import Measured
from insonify.accuracy.stability.report import write_report
from insonify.scene import bundled_scenes, edit, load_scene
from insonify.simulation import prepare, simulate

EVERY = [case for members in CASES.values() for case in members]


@pytest.mark.parametrize("case", EVERY, ids=lambda case: case.name)
def test_the_common_method_fails_and_this_program_does_not(case):
    outcome = Outcome(case, case.measure())
    assert outcome.is_shown, f"{case.quantity}: {outcome.measured.failing} by the common method"
    assert outcome.is_held, f"{case.quantity}: {outcome.measured.right} by this program"
    assert outcome.verdict == "holds"
    figure = Figure()
    outcome.measured.picture(figure)
    assert all((axes.get_xlabel() and axes.get_ylabel()) or axes.texts for axes in figure.axes)
    assert [one.name for one in EVERY].count(case.name) == 1
    for sentence in (case.trigger, case.failing, case.right):
        assert sentence[0].isupper(), sentence
        assert sentence.endswith("."), sentence


def test_a_theme_is_one_new_file(tmp_path, monkeypatch):
    module = "from insonify.accuracy.stability.case import StabilityTheme\nTHEME = StabilityTheme('Tides', 0)\n"
    (tmp_path / "tides.py").write_text(module)
    monkeypatch.setattr(themes, "__path__", [*themes.__path__, str(tmp_path)])
    found = find_themes()
    assert found[0].title == "Tides"
    assert [theme.title for theme in found[1:]] == list(CASES)
    assert len({theme.place for theme in found}) == len(found)


def case_of(failing: float, right: float) -> StabilityCase:
    measured = Measured(failing, right, lambda figure: figure.add_subplot())
    row = "A < B", "Is.", "this", "m", "Does.", 1.0, "Acts.", 0.1
    return StabilityCase(*row, lambda: measured, "breaks-steps")


@pytest.mark.parametrize(
    ("verdict", "figures"),
    [
        ("holds", [(2.0, 0.1), (math.nan, 0.0), (math.inf, 0.0)]),
        ("holds, failure not shown", [(1.0, 0.0)]),
        ("does not hold", [(2.0, 0.2), (2.0, math.nan)]),
    ],
)
def test_verdicts(verdict, figures):
    cases = [case_of(failing, right) for failing, right in figures]
    assert [Outcome(case, case.measure()).verdict for case in cases] == [verdict] * len(cases)


def test_figures_are_readable():
    texts = {math.nan: "not a number", math.inf: "infinite m", 0.0: "0 m", 12.345: "12.3 m", -0.5: "−0.5 m"}
    texts |= {4e-16: "4.0 × 10⁻¹⁶ m", 1.7e5: "1.7 × 10⁵ m"}
    assert {value: case_of(0.0, 0.0).format(value) for value in texts} == texts


def test_the_page_stands_by_itself(tmp_path):
    outcomes = write_report(tmp_path / "page.html", {"One": (case_of(2.0, 0.0),), "Two": (EVERY[0], case_of(2.0, 0.2))})
    assert len(outcomes) == 3
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "A &lt; B" in text
    assert "2 of 3 cases" in text
    assert "does not hold" in text
    assert text.count('src="data:image/png;base64,') == 3
    assert "on the scene <code>breaks-steps</code>" in text
    # Nothing is fetched, and every link leads somewhere on the page.
    assert not re.search(r"https?://|<script|<link", text)
    assert set(re.findall(r'href="#([^"]+)"', text)) == set(re.findall(r'id="([^"]+)"', text))
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_a_failure_leaves_the_old_page(tmp_path):
    page = tmp_path / "page.html"
    page.write_text("old")
    with pytest.raises(MemoryError):
        write_report(page, {"One": (replace(case_of(2.0, 0.0), measure=Mock(side_effect=MemoryError)),)})
    assert page.read_text() == "old"


def test_the_command_refuses_other_formats(capsys):
    sentence = "insonify: -o page.pdf: '.pdf' is not written by this command; end the name in .html or .htm\n"
    assert refused(capsys, "stability", "-o", "page.pdf") == sentence


def test_every_scene_that_breaks_names_the_case_that_measures_it():
    breaking = {name for name in bundled_scenes() if name.startswith("breaks-")}
    assert breaking == {case.scene for case in EVERY if case.scene}
    for case in EVERY:
        assert not case.scene or f'"{case.name}"' in " ".join(load_scene(case.scene).description.split()), case.name


def test_pings_beat_with_ripples():
    scene = edit(load_scene("breaks-beats"), {"track.pings": 256})
    wave = 50.4 / 80.0
    for speed, true in ((3.0, False), (0.3, True)):
        record = simulate(edit(scene, {"track.speed": speed})).intensity.values[0, :, 500:700].astype(np.float64)
        power = (np.abs(np.fft.rfft(record / record.mean(axis=0) - 1.0, axis=0)) ** 2).sum(axis=1)
        strongest = 256 * speed / 5.0 / (np.argmax(power[2:]) + 2)
        assert (abs(strongest / wave - 1.0) < 0.2) == true
        assert true or strongest > 4.0 * wave


def test_steps_leak_less_the_shorter_they_are():
    scene = edit(load_scene("breaks-steps"), {"track.pings": 4})
    exact = simulate(scene, method="rays", forced={"rays": "16000"}).intensity.values
    records = (simulate(scene, method="march", forced={"step": step}).intensity.values for step in ("2", "0.5", "0.1"))
    long, middling, short = (float(record[exact == 0.0].sum()) for record in records)
    assert long > 3.0 * middling > 9.0 * short


@pytest.mark.parametrize(
    ("name", "without", "most"),
    [("breaks-terraces", {"world.origin": [0.0, 0.0]}, 0.0), ("breaks-gradient", {"water": "uniform"}, 1e-6)],
)
def test_a_place_on_the_map_and_next_to_no_gradient_change_nothing(name, without, most):
    scene = edit(load_scene(name), {"track.pings": 8})
    one, other = (simulate(each).intensity.values for each in (scene, edit(scene, without)))
    np.testing.assert_allclose(one, other, rtol=most, atol=0)


def test_the_bed_is_heard_to_where_the_last_ray_grazes_it():
    truth = prepare(load_scene("breaks-grazing")).truth(np.arange(2))
    assert np.nanmax(truth.ground_range) == pytest.approx(1095.63, abs=2.0)
