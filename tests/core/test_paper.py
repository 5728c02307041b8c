"""The page on the paper: its fields, scenes, lessons and tests exist, and its numbers are those of the formulas."""

import re
from pathlib import Path

import pytest

from insonify.files import bundled_lessons, bundled_scenes
from insonify.scene import Scene
from insonify.scene.base import is_field
from insonify.scene.water.sound_speed import paper

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "theory" / "paper.md").read_text(encoding="utf-8")
ROWS = [
    re.split(r" *\| *", line.strip("| ")) for line in PAGE.split("## Slips")[0].splitlines() if line.startswith("| ")
]
NAMED = re.compile(r"`([^`]+)`")


@pytest.mark.parametrize("row", ROWS[1:], ids=lambda row: row[0][:40])
def test_every_name_of_a_statement_exists(row):
    _, _, fields, scenes, lessons, tests = row
    for names, known in ((scenes, bundled_scenes()), (lessons, bundled_lessons())):
        assert names == "none" or 0 < len(NAMED.findall(names)) == len({*known} & {*NAMED.findall(names)}), names
    for path in NAMED.findall(fields):
        assert is_field(Scene, path.replace(".N.", ".0.")), path
    (test,) = NAMED.findall(tests)
    file, name = test.split("::")
    assert f"def {name}(" in (ROOT / "tests" / file).read_text(encoding="utf-8"), test


def test_the_slips_have_the_size_that_the_page_gives():
    for temperature, less in ((10.0, 49.5), (20.0, 198.0)):
        printed = float(paper(temperature, 35.0, 0.0)) - (0.55 - 0.055) * temperature**2
        assert float(paper(temperature, 35.0, 0.0)) - printed == pytest.approx(less)
    beta = 1.4
    assert ((8.0 - 2.0 * beta) / 2.0, (7.0 - 2.0 * beta) / 2.0) == (pytest.approx(2.6), pytest.approx(2.1))
