"""Presets of a lecture: scenes with their display on the keys 1 to 9, and the TOML files that hold them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import tomli_w

from insonify.display.display_options import DisplayOptions, display_settings, read_display
from insonify.errors import located
from insonify.io.atomic import write_text
from insonify.io.file_access import LARGEST_TOML, guarded, parse_toml, read_text
from insonify.scene import Scene, SceneError, edit, load_scene, scene_from_toml, scene_to_toml

KEYS = range(1, 10)
FIELDS = ("key", "title", "scene", "set", "display")


@dataclass(frozen=True)
class Preset:
    """A scene and how its record is shown."""

    title: str
    scene: Scene
    display: DisplayOptions


def write_playlist(path: Path, presets: Mapping[int, Preset]) -> None:
    """Write presets with their keys; each scene is TOML text within the file, so that the file can be passed on."""
    entries = [
        {
            "key": key,
            "title": preset.title,
            "scene": scene_to_toml(preset.scene),
            "display": display_settings(preset.display),
        }
        for key, preset in sorted(presets.items())
    ]
    write_text(path, tomli_w.dumps({"preset": entries}, multiline_strings=True))


def read_playlist(path: Path) -> dict[int, Preset]:
    """Read presets by their keys; a scene is TOML text, a file, or the name of a bundled scene."""
    with guarded(partial(_unreadable, path), "give a readable TOML file"):
        entries = parse_toml(read_text(path, largest=LARGEST_TOML)).get("preset")
    if not isinstance(entries, list) or not entries or not all(isinstance(entry, dict) for entry in entries):
        raise SceneError(f"{path.name}: has no [[preset]]; add one with scene = a name, a file or the text of a scene")
    found: dict[int, Preset] = {}
    for number, entry in enumerate(entries, 1):
        with located(f"{path.name}: preset {number}: "):
            key = _read(entry, "key", int, number)
            if key not in KEYS or key in found:
                taken = "belongs to an earlier preset" if key in found else "is not one of 1 to 9"
                raise SceneError(f"key {key} {taken}; give each preset a key of its own, 1 to 9")
            found[key] = _preset(path, entry)
    return found


def _preset(path: Path, entry: Mapping[str, Any]) -> Preset:
    if unknown := set(entry) - {*FIELDS}:
        raise SceneError(f"{min(unknown)} is not a field of a preset; write {', '.join(FIELDS)}")
    scene = _scene(path, _read(entry, "scene", str, ""))
    changes = _read(entry, "set", dict, {})
    options = _read(entry, "display", list, [])
    display = read_display([str(option) for option in options])
    scene = edit(scene, changes) if changes else scene
    return Preset(_read(entry, "title", str, scene.title), scene, DisplayOptions(**display))


def _scene(path: Path, scene: str) -> Scene:
    """Scene of a preset, from its text, its file beside the playlist, or its name."""
    if "\n" in scene:
        return scene_from_toml(scene)
    beside = path.parent / scene
    return load_scene(beside if scene.endswith(".toml") and beside.exists() else scene)


def _read(entry: Mapping[str, Any], name: str, kind: Callable[..., Any], usual: Any) -> Any:
    value = entry.get(name, usual)
    if not isinstance(value, type(usual)):
        raise SceneError(f"{name} = {value!r:.40} is not valid; write a value like {usual!r}")
    return kind(value)


def _unreadable(path: Path, fault: str, remedy: str) -> SceneError:
    return SceneError(f"playlist {path.name}: {fault}; {remedy}")
