"""Scenes read from TOML files and written to them."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import tomli_w

from insonify.errors import FileWarning, SceneError, warn_caller
from insonify.files import bundled_meshes, bundled_scenes
from insonify.io.file_access import LARGEST_TOML, FileFault, parse_toml, read_named
from insonify.io.sealed import SUFFIX, unseal
from insonify.scene.edit import build, edit, plain, read_setting
from insonify.scene.scene import Scene

DEFAULT_SCENE = "wreck-site"  # with which the viewer opens
PLAIN_SCENE = "default"  # from which surveys and data sets derive theirs unless they name another


def load_scene(name_or_path: str | Path) -> Scene:
    """Read a scene.

    Parameters
    ----------
    name_or_path : str or Path
        Name of a bundled scene, a TOML file, or an exercise.

    Returns
    -------
    Scene

    Raises
    ------
    SceneError
        If the scene cannot be read or is invalid: one sentence with the fault and the remedy.
    """
    named = bundled_scenes().get(str(name_or_path))
    path = named or Path(name_or_path)
    text = read_named("scene", str(name_or_path), path, form="TOML", bundled=bundled_scenes(), largest=LARGEST_TOML)
    if "\0" in text:
        raise SceneError(f"scene {str(name_or_path)!r}: is a binary file, not text; give a TOML file")
    if path.suffix.lower() == SUFFIX:
        try:
            return build(unseal(parse_toml(text))["scene"])
        except FileFault as fault:
            raise SceneError(f"{path.name}: {fault}") from None
    scene = scene_from_toml(text, source=path)
    noise = scene.receiver.noise
    if noise is not None and noise.advice and path not in bundled_scenes().values():
        warn_caller(FileWarning(f"{path.name}: {noise.advice}"))
    return scene


def load_partner(scene: Scene) -> Scene | None:
    """Read the partner of a scene, to which it is compared; None if it has none."""
    if not scene.partner:
        return None
    named = [word for word in scene.partner if "=" not in word]
    if len(named) > 1:
        found = ", ".join(named)
        raise SceneError(f"partner: names {len(named)} scenes, {found}; give one scene, and settings as path=value")
    settings = [word for word in scene.partner if "=" in word]
    other = load_scene(named[0]) if named else scene
    return edit(other, dict(read_setting(word, "partner") for word in settings))


def scene_from_toml(text: str, *, source: Path | None = None) -> Scene:
    """Build a scene from TOML text; relative file paths in it are taken from the folder of ``source``."""
    name = "scene" if source is None else str(source)
    try:
        values = parse_toml(text)
        if source is not None:
            values = with_paths_beside(source, values)
            if isinstance(partner := values.get("partner"), list):
                # A setting stays as it is.
                is_scene = (isinstance(word, str) and not {"=", "\0"} & {*word} for word in partner)
                values["partner"] = [
                    scene_beside(source, word) if one else word for one, word in zip(is_scene, partner)
                ]
        return build(values)
    except FileFault as fault:
        raise SceneError(f"{name}: {fault}") from None
    except SceneError as error:
        raise SceneError(str(error) if source is None else f"{source.name}: {error}") from None


def scene_to_toml(scene: Scene) -> str:
    """Write a scene as TOML; reading it back gives an equal scene."""
    return tomli_w.dumps(plain(scene))


def with_paths_beside(source: Path, values: Mapping[str, Any]) -> dict[str, Any]:
    """Resolve every relative path of nested values against the folder of the file they were read from."""
    resolved: dict[str, Any] = changed_paths(values, partial(_beside, source))
    return resolved


def named_paths(values: Mapping[str, Any]) -> list[str]:
    """List every path of nested values: of a scene, or of what its fields are set to or drawn from."""
    paths: list[str] = []
    changed_paths(values, paths.append)
    return paths


def changed_paths(value: Any, change: Callable[[str], Any], is_path: bool = False) -> Any:
    """Copy nested values with all paths changed: fields named ``path``, dotted ones too, and what is drawn for them."""
    if isinstance(value, Mapping):
        return {
            key: changed_paths(child, change, key.rpartition(".")[2] == "path" or (is_path and key == "of"))
            for key, child in value.items()
        }
    if isinstance(value, (list, tuple)):
        return [changed_paths(item, change, is_path) for item in value]
    return change(value) if is_path and isinstance(value, str) else value


def scene_beside(source: Path, name: str) -> str:
    """Return the name of a bundled scene as it is, and the path of another resolved against the folder of a file."""
    return name if name in bundled_scenes() or Path(name).is_absolute() else str((source.parent / name).resolve())


def _beside(source: Path, path: str) -> str:
    """Resolve a path against the scene's folder; sample grids (``sample:...``) and bundled meshes stay names."""
    if "\0" in path or path.startswith("sample:") or path in bundled_meshes() or Path(path).is_absolute():
        return path
    return str((source.parent / path).resolve())
