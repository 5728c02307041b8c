"""What README and documentation say works."""

import os
import re
import shlex
import subprocess
import tomllib
from importlib.metadata import distributions, metadata, requires
from itertools import chain
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from commands import PATIENCE, run_python
from insonify.cli import build_parser
from insonify.commands.options import chosen_scene, is_record
from insonify.scene import scene_from_toml
from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.lines.specification import SurveySpecification

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
README = ROOT / "README.md"
PAGES = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in [README, *DOCS.rglob("*.md")]}
GALLERY = re.findall(r"\]\((gallery/[\w-]+\.jpg)\)<br>[^|]*?<br>`(insonify [^`]+)`", PAGES["docs/gallery.md"])
PARSER, COMMANDS = build_parser()
SPECIFICATIONS = {"docs/howto/data-sets.md": DatasetSpecification, "docs/howto/survey.md": SurveySpecification}


def blocks(language: str) -> list[tuple[str, str]]:
    """Blocks of one language, each with its page."""
    pattern = rf"```{language}([^\n]*)\n(.*?)```"
    return [(page, body) for page, text in PAGES.items() for _, body in re.findall(pattern, text, flags=re.DOTALL)]


def commands() -> list[str]:
    shown = "\n".join(body for language in ("sh", "console") for _, body in blocks(language))
    lines = [line.removeprefix("$ ").removeprefix("uv run ") for line in shown.splitlines()]
    known = [line for line in lines if re.match(r"insonify \w+ ", line) and line.split()[1] in COMMANDS]
    made = [title for text in PAGES.values() for title in re.findall(r'```toml title="([^"]+)"', text)]
    return sorted({line for line in known if not any(name in line for name in ("width=90", *made))})


@pytest.mark.parametrize("line", [*commands(), *(command for _, command in GALLERY)])
def test_every_command_is_understood(line):
    words = shlex.split(line, comments=True)[1:]
    arguments = PARSER.parse_args(words)
    if hasattr(arguments, "scene") and isinstance(arguments.scene, str) and not is_record(arguments.scene):
        chosen_scene(arguments)


EXAMPLES = re.findall(r"^uv run insonify (.+?)(?: +#.*)?$", PAGES["README.md"], re.MULTILINE)
LONGER = {"dataset", "movie"}  # examples that take a minute and more


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """A fresh clone, and an environment in which Python finds its packages."""
    folder = tmp_path_factory.mktemp("clone") / "insonify"
    subprocess.run(["git", "clone", "-q", "--depth", "1", ROOT.as_uri(), str(folder)], check=True, timeout=PATIENCE)
    paths = os.pathsep.join(str(folder / source) for source in ("core", "app"))
    return folder, {**os.environ, "PYTHONPATH": paths, "MPLBACKEND": "agg"}


@pytest.mark.parametrize(
    "line", [pytest.param(each, marks=[pytest.mark.slow] * (each.split()[0] in LONGER)) for each in EXAMPLES]
)
def test_the_examples_of_the_readme_run_as_printed_in_a_fresh_clone(line, clone):
    folder, environment = clone
    code, _, complaint = run_python("-m", "insonify", *shlex.split(line), cwd=folder, env=environment)
    assert code == 0, complaint
    named = re.findall(r"-o (\S+)", line)
    assert all((folder / name).exists() for name in named)


def test_there_are_commands_to_try_in_the_environment_that_the_first_of_the_readme_makes():
    """``uv run`` syncs the default groups, which hold every extra that an example needs."""
    assert len(commands()) > 30
    assert len(EXAMPLES) >= 4
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    groups = project["tool"]["uv"]["default-groups"]
    needed = [each for group in groups for each in project["dependency-groups"][group]]
    assert "insonify[fishfinder,learning,live,movies,surveys,viewer]" in needed


def test_clones_get_a_version_of_every_package_and_all_have_a_bound_above():
    """No host is named; xarray and distributed count by years."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    pinned = {Requirement(line).name for line in project["tool"]["uv"]["constraint-dependencies"]}
    extras = project["project"]["optional-dependencies"]
    declared = [*project["project"]["dependencies"], *chain(*extras.values())]
    bounded = {each.name for each in map(Requirement, declared) if "<" in str(each.specifier)}
    assert {Requirement(line).name for line in declared} - bounded == {"xarray", "distributed"}
    used = dependencies("insonify", {"", *extras})
    assert {canonical(name) for name in used} <= {canonical(name) for name in pinned}
    # Of those with a condition for whoever passes them on, the page of licences says which.
    strict = {canonical(name) for name in used if re.search("GPL|MPL|Mozilla", licence(name))}
    assert {"pyside6-essentials", "shiboken6", "tqdm", "certifi"} <= strict
    assert [name for name in strict if name not in PAGES["docs/licences.md"].lower()] == []
    assert "docs/licences.md" in PAGES["README.md"]


def dependencies(name, extras=frozenset([""])):
    """Names of the packages that an installed one needs here, and of what they need."""
    found, pending = set(), [(name, extras)]
    while pending:
        package, wanted = pending.pop()
        for each in map(Requirement, requires(package) or ()):
            needed = each.marker is None or any(each.marker.evaluate({"extra": extra}) for extra in wanted)
            if needed and each.name not in found and installed(each.name):
                found.add(each.name)
                pending.append((each.name, {"", *each.extras}))
    return found


def installed(name):
    return any(distributions(name=name))


def canonical(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def licence(name):
    told = metadata(name)
    named = [text for text in told.get_all("Classifier") or [] if text.startswith("License")]
    return " ".join([told.get("License-Expression") or "", (told.get("License") or "").partition("\n")[0], *named])


def test_the_gallery_is_whole_and_light():
    pictures = [DOCS / path for path, _ in GALLERY]
    assert len(pictures) == PAGES["docs/gallery.md"].count("](gallery/")
    assert {path.name for path in pictures} == {path.name for path in (DOCS / "gallery").iterdir()}
    sizes = [path.stat().st_size for path in pictures]
    assert max(sizes) < 300_000
    assert sum(sizes) < 4_000_000


def test_every_scene_is_one_every_part_is_of_one_and_every_specification_is_one():
    others = {"docs/architecture/extend.md", "docs/howto/lessons.md", "docs/howto/view.md", *SPECIFICATIONS}
    parts = [scene_from_toml(body) for page, body in blocks("toml") if page not in others]
    assert any(part.targets and part.targets[0].length == 30.0 for part in parts if part.title == "A pipe with a span")
    assert ("heave", "yaw", "turn") in {part.track.kinds for part in parts}
    assert "pattern" in {part.seabed.material.kind for part in parts}
    for page, model in SPECIFICATIONS.items():
        assert [model.model_validate(tomllib.loads(body)) for place, body in blocks("toml") if place == page], page


def test_generated_pages_and_quoted_outputs_are_up_to_date():
    """Run what is quick of the script that makes the documentation: references, plans, lists, programs."""
    code, _, complaint = run_python(str(DOCS / "make"), "--check", cwd=ROOT)
    assert code == 0, complaint


def test_pages_pictures_and_paths_that_code_and_documentation_name_exist():
    for source in [*(ROOT / "core").rglob("*.py"), *(ROOT / "app").rglob("*.py")]:
        for path in re.findall(r"docs/[\w/-]+\.md", source.read_text(encoding="utf-8")):
            assert (ROOT / path).is_file(), f"{source.name}: {path}"
    roots = (ROOT, ROOT / "core" / "insonify", ROOT / "app")
    for page, text in PAGES.items():
        for path in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text):
            assert ((ROOT / page).parent / path).resolve().is_file(), f"{page}: {path}"
        prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
        known = r"\.py|\.toml|\.md" if page.startswith("docs/howto") else r"\.\w+|"
        for path in re.findall(rf"`([\w.-]+(?:/[\w.-]+)+(?:{known}))`", prose):
            place = re.sub(r"/NAME\.\w+$", "", path)
            assert any((root / place).exists() for root in roots), f"{page}: {path}"


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"])
def test_links_from_outside_the_site_lead_to_files_and_headings(name):
    """`mkdocs build --strict` checks the links of the pages themselves."""
    for path, heading in re.findall(
        r"\]\((?!https:)([^)\s#]+)(?:#([\w-]+))?[^)]*\)", (ROOT / name).read_text(encoding="utf-8")
    ):
        assert (ROOT / path).is_file(), path
        titles = re.findall(r"^#+ (.*)$", PAGES.get(path, ""), re.MULTILINE)
        known = {re.sub(r"\s+", "-", re.sub(r"[^\w\s-]", "", title).strip().lower()) for title in titles}
        assert not heading or heading in known, f"{path}#{heading}"
