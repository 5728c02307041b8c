"""What describes a version for indexes, citations and conda: all of it agrees with pyproject.toml."""

import json
import re
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
RECIPE = ROOT / "packaging" / "conda" / "recipe.yaml"
CONDA_NAMES = {"matplotlib": "matplotlib-base", "pyside6-essentials": "pyside6", "vtk": "vtk-base"}


def test_version_date_and_licence_agree_wherever_they_stand():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    deposit = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    recipe = yaml.safe_load(RECIPE.read_text(encoding="utf-8"))
    versions = citation["version"], deposit["version"], recipe["context"]["version"]
    assert set(versions) == {PROJECT["version"]}
    assert deposit["publication_date"] == str(citation["date-released"])
    assert {citation["license"], deposit["license"], recipe["about"]["license"]} == {PROJECT["license"]}
    assert PROJECT["requires-python"] == f">={recipe['context']['python_min']}"
    assert sorted(deposit["keywords"]) == sorted(citation["keywords"]) == sorted(PROJECT["keywords"])


def test_the_conda_recipe_requires_what_the_wheel_requires():
    core, viewer = yaml.safe_load(RECIPE.read_text(encoding="utf-8"))["outputs"]
    for output, wanted in ((core, PROJECT["dependencies"]), (viewer, PROJECT["optional-dependencies"]["viewer"])):
        required = dict(line.split(" ", 1) for line in output["requirements"]["run"])
        required = {name: limits for name, limits in required.items() if name not in ("python", "insonify")}
        parsed = [Requirement(line) for line in wanted]
        expected = {CONDA_NAMES.get(each.name.lower(), each.name.lower()): each.specifier for each in parsed}
        assert {name: set(limits.split(",")) for name, limits in required.items()} == {
            name: set(map(str, limits)) for name, limits in expected.items()
        }
    rattler_build = pytest.importorskip("rattler_build")
    assert len(rattler_build.Stage0Recipe.from_file(str(RECIPE)).render(rattler_build.VariantConfig())) == 2


def test_the_paper_cites_what_its_references_hold_and_has_the_parts_of_its_journal():
    paper, references = ((ROOT / "paper" / f"paper.{end}").read_text(encoding="utf-8") for end in ("md", "bib"))
    assert set(re.findall(r"@(\w+\d{4})", paper)) == set(re.findall(r"^@\w+\{(\w+),", references, re.MULTILINE))
    assert re.findall(r"^# (.*)$", paper, re.MULTILINE)[:3] == ["Summary", "Statement of need", "State of the field"]
    assert 250 < len(paper.split("---", 2)[2].split()) < 1000
