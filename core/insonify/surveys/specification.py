"""Specifications of surveys and data sets, read from TOML files."""

from __future__ import annotations

import hashlib
import os
import tomllib
from collections.abc import Iterator, Mapping
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from insonify.errors import SceneError
from insonify.files import bundled_meshes
from insonify.io.file_access import MISSING, guarded, read_text
from insonify.scene import Scene, scene_to_toml
from insonify.scene.faults import describe_fault
from insonify.scene.files import LARGEST, scene_beside, with_paths_beside

LONGEST_PATH = 4096  # characters; a longer text is no path
Model = TypeVar("Model", bound=BaseModel)


def read_specification(name: str, model: type[Model], bundled: Mapping[str, Path], changes: Mapping[str, Any]) -> Model:
    """Read a specification."""
    path = bundled.get(name) or Path(name)
    with guarded(partial(_unreadable, name, bundled), "give a readable TOML file"):
        text = read_text(path, largest=LARGEST)
    try:
        values = with_paths_beside(path, tomllib.loads(text))
        if isinstance(base := values.get("base"), str):
            values["base"] = scene_beside(path, base)
        return model.model_validate({**values, **changes})
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"{path.name}: is not valid TOML ({error}); correct that line") from None
    except RecursionError:
        raise SceneError(f"{path.name}: is nested too deeply to be read; write fewer tables in tables") from None
    except ValidationError as error:
        raise SceneError(f"{path.name}: {describe_fault(error, model)}") from None


def _unreadable(name: str, bundled: Mapping[str, Path], fault: str, remedy: str) -> SceneError:
    if fault == MISSING:
        fault, remedy = "no such file", f"give a TOML file or one of {', '.join(bundled)}"
    return SceneError(f"specification {name!r}: {fault}; {remedy}")


def contents_of(specification: BaseModel, base: Scene) -> list[Any]:
    """List all that the files of a survey or a data set depend on: specification, base scene, files, version."""
    values = specification.model_dump(mode="json")
    scene = scene_to_toml(base)
    files = {path: _content(path) for path in sorted({*_paths(values), *_paths(tomllib.loads(scene))})}
    return [values, scene, files, version("insonify")]


def _paths(value: Any) -> Iterator[str]:
    """Every text of nested values that names a file."""
    if isinstance(value, Mapping):
        value = list(value.values())
    if isinstance(value, list):
        for item in value:
            yield from _paths(item)
    elif isinstance(value, str) and (value in bundled_meshes() or os.path.isfile(value[:LONGEST_PATH])):
        yield value


def _content(path: str) -> str:
    with open(bundled_meshes().get(path, Path(path)), "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
