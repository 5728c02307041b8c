"""Specifications of surveys and data sets, read from TOML files."""

import hashlib
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from insonify.errors import SceneError
from insonify.files import bundled_meshes, bundled_specifications
from insonify.io.file_access import LARGEST_TOML, FileFault, open_regular, parse_toml, read_named
from insonify.scene import Scene, plain
from insonify.scene.faults import describe_fault
from insonify.scene.files import changed_paths, scene_beside, with_paths_beside

Model = TypeVar("Model", bound=BaseModel)


def read_specification(name: str, model: type[Model], folder: str, **changes: Any) -> Model:
    """Read a specification: a file, or one that comes with the package, ``surveys`` or ``datasets``."""
    bundled = bundled_specifications(folder)
    values = _read_values(name, Path(), bundled)
    try:
        return model.model_validate({**values, **changes})
    except ValidationError as error:
        raise SceneError(f"{Path(bundled.get(name) or name).name}: {describe_fault(error, model)}") from None


def _read_values(
    name: str, folder: Path, bundled: Mapping[str, Path], parents: tuple[Path, ...] = ()
) -> dict[str, Any]:
    """Read the values of a specification over the values of the one that it is `like`: tables are joined."""
    path = bundled.get(name) or folder / name
    if path in parents:
        raise SceneError(f"{path.name}: like: the specification refers to itself; name another one")
    text = read_named("specification", name, path, form="TOML", bundled=bundled, largest=LARGEST_TOML)
    try:
        values = with_paths_beside(path, parse_toml(text))
    except FileFault as fault:
        raise SceneError(f"{path.name}: {fault}") from None
    if isinstance(base := values.get("base"), str):
        values["base"] = scene_beside(path, base)
    if (like := values.pop("like", None)) is None:
        return values
    inherited = _read_values(str(like), path.parent, bundled, (*parents, path))
    both = ((key, values[key], inherited.get(key)) for key in values)
    joined = {key: {**old, **new} if isinstance(old, dict) and isinstance(new, dict) else new for key, new, old in both}
    return {**inherited, **joined}


def contents_of(specification: BaseModel, base: Scene, *without: str) -> list[Any]:
    """List all that a survey or a data set depends on: specification (less some fields), base scene, files, version."""
    # Where the files are does not count, so that a folder of all of them can be moved.
    values = specification.model_dump(mode="json", exclude={"base", *without})
    return [changed_paths(values, _content), changed_paths(plain(base), _content), version("insonify")]


def _content(path: str) -> str:
    """Name and digest of a file; its path where it is none."""
    try:
        with open_regular(bundled_meshes().get(path, path)) as file:
            digest = hashlib.sha256()
            while piece := file.read(2**20):
                digest.update(piece)
            return f"{Path(path).name} {digest.hexdigest()}"
    except (FileFault, OSError, ValueError):  # the job that reads it says what is wrong
        return path
