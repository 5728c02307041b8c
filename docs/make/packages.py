"""The page of packages: what each holds and imports, and the families of kinds, read from the sources."""

from __future__ import annotations

import ast
import inspect
import re
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
CORE, VIEWER = ROOT / "core" / "insonify", ROOT / "app" / "insonify_viewer"
HEAD = """# Rooms and imports

<!-- Made by `python docs/make` from the sources and their import contracts. Edit `docs/make/packages.py`. -->

The code is two packages: `insonify`, the headless core, and `insonify_viewer`, the window. The core never imports the
viewer, Qt or VTK. Imports run one way between packages, and between the rooms of the kernels; `uv run lint-imports`
checks it. Contracts name packages, not modules, so a new module is guarded without an entry.

## The core

A package imports packages below it in this table, never above it. Packages of one level do not import each other.

| level | package | what it holds | imports |
|---|---|---|---|
"""
ROOMS = """
## Rooms of the kernels

`insonify.kernels` holds all Numba code. It sees NumPy and Numba only: arrays and NamedTuples go in, arrays come out,
never a scene. Its rooms import one way, too, from the top of this table to the bottom.

| level | room | what it holds | imports |
|---|---|---|---|
"""
APP = """
## The viewer

A room holds a subject, its controllers and its views, and imports the rooms below it. PySide6 is used by `record`,
`seabed`, `window`, `widgets`, the views of panels, and the few modules that run the event loop; PyVista and VTK by
`seabed` alone. State announces changes by signals of psygnal and knows no view. Work beside the window passes its
results to the main thread through `insonify_viewer/work/executor.py`.

| level | room | what it holds | imports |
|---|---|---|---|
"""
FAMILIES = """
## Families of kinds

Every choice of a scene or of a data set is a family with one class a kind. A class is found in a module of the family's
package, or where an installed package announces it as an entry point of the group. [Add something new](extend.md) says
how.

| family | package | entry points | kinds |
|---|---|---|---|
"""
ASKED = """
A kind derives from the family's base class. It has its fields, its `kind`, and answers what the rest of the program
asks; what has a default need not be answered.

| family | base class | what a kind may be asked |
|---|---|---|
"""
FORMATS = """
## File formats

A format is a `FileFormat` at the top level of a module of its package, or announced as an entry point of the group.

| contents | package | entry points | suffixes read | suffixes written |
|---|---|---|---|---|
"""


def page() -> str:
    """Return the page."""
    layers, rooms = _contract("imports run one way"), _contract("rooms of kernels import one way")
    core = [[name.removeprefix("insonify.") for name in level.split(" | ")] for level in layers]
    kernels = [level.split(" | ") for level in rooms]
    parts = [HEAD, *_levels(CORE, core), ROOMS, *_levels(CORE / "kernels", kernels), APP]
    viewer = [level.split(" | ") for level in _contract("rooms of the viewer import one way")]
    parts += _levels(VIEWER, viewer)
    parts += [FAMILIES, *_families(), FORMATS, *_formats()]
    return "".join(parts)


def _contract(name: str) -> list[str]:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]
    layers: list[str] = next(each["layers"] for each in settings["contracts"] if each["name"] == name)
    return layers


def _levels(folder: Path, levels: list[list[str]]) -> list[str]:
    """Rows of a table of packages, from the highest to the lowest."""
    names = [name for level in levels for name in level]
    prefix = ".".join(folder.relative_to(ROOT).parts[1:])
    rows = []
    for number, level in zip(range(len(levels), 0, -1), levels):
        for name in level:
            path = folder / name if (folder / name).is_dir() else folder / f"{name}.py"
            used = [f"`{other}`" for other in names if other != name and other in _imports(path, prefix)]
            rows.append(f"| {number} | `{name}` | {_first_line(path)} | {', '.join(used)} |\n")
    return rows


def _imports(path: Path, prefix: str) -> set[str]:
    """Name the packages below a prefix that a module or the modules of a package import."""
    found = set()
    for source in path.rglob("*.py") if path.is_dir() else [path]:
        text = source.read_text(encoding="utf-8")
        found |= set(re.findall(rf"(?:from|import) {re.escape(prefix)}\.(\w+)", text))
        for names in re.findall(rf"from {re.escape(prefix)} import ([\w, ]+)", text):
            found |= set(names.replace(" ", "").split(","))
    return found


def _first_line(path: Path) -> str:
    source = path / "__init__.py" if path.is_dir() else path
    docstring = ast.get_docstring(ast.parse(source.read_text(encoding="utf-8"))) or ""
    return docstring.partition("\n")[0].replace("|", "\\|")


def _families() -> list[str]:
    """List every family with its kinds, then what each asks of a kind."""
    from pydantic import BaseModel

    rows, asked = [], []
    for base in sorted(_bases(), key=lambda base: str(base.family.name)):
        name, package, kinds = base.family.name, base.family.package or base.__module__, base.family.models(BaseModel)
        rows.append(f"| {name} | `{package}` | `insonify.{name}` | {', '.join(f'`{kind}`' for kind in kinds)} |\n")
        asked.append(f"| {name} | `{base.__name__}` | {_asked(base)} |\n")
    return [*rows, ASKED, *asked]


def _bases() -> list[Any]:
    """Find the classes from which the kinds of each family derive."""
    from pydantic import BaseModel

    from insonify.scene import Scene
    from insonify.scene.base import Family
    from insonify.surveys.datasets.specification import DatasetSpecification

    for whole in (Scene, DatasetSpecification):
        whole.model_json_schema()  # all families are in use
    found = [model for model in _descendants(BaseModel) if isinstance(vars(model).get("family"), Family)]
    return list({model.family.name: model for model in reversed(found)}.values())


def _descendants(base: Any) -> list[Any]:
    below = [each for child in base.__subclasses__() for each in _descendants(child)]
    return [base, *below] if base.__module__.startswith("insonify.") else below


def _asked(base: Any) -> str:
    """Name the public methods and properties of a class, each with the first line of its docstring."""
    members = {name: getattr(value, "fget", value) for name, value in vars(base).items() if not name.startswith("_")}
    functions = [(name, value) for name, value in members.items() if inspect.isfunction(value)]
    lines = [f"`{name}`: {(inspect.getdoc(value) or '').partition(chr(10))[0]}" for name, value in functions]
    return "<br>".join(lines).replace("|", "\\|")


def _formats() -> list[str]:
    from insonify.io.bathymetry import BATHYMETRY
    from insonify.io.meshes import MESHES
    from insonify.io.navigation import NAVIGATION
    from insonify.io.records import RECORDS
    from insonify.io.sound_speed_casts import CASTS

    rows = []
    for each in (RECORDS, BATHYMETRY, CASTS, NAVIGATION, MESHES):
        read, written = (" ".join(f"`{suffix}`" for suffix in some) for some in (each.readable(), each.writable()))
        rows.append(f"| {each.contents} | `{each.package}` | `{each.group}` | {read} | {written} |\n")
    return rows
