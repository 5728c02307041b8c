"""Declarations of a scene: frozen, validated, read from TOML and written to it."""

from insonify.errors import SceneError
from insonify.files import bundled_meshes, bundled_scenes
from insonify.scene.edit import build, edit, plain, read_setting
from insonify.scene.files import DEFAULT_SCENE, PLAIN_SCENE, load_partner, load_scene, scene_from_toml, scene_to_toml
from insonify.scene.scene import Scene

__all__ = [
    "DEFAULT_SCENE",
    "PLAIN_SCENE",
    "Scene",
    "SceneError",
    "build",
    "bundled_meshes",
    "bundled_scenes",
    "edit",
    "load_partner",
    "load_scene",
    "plain",
    "read_setting",
    "scene_from_toml",
    "scene_to_toml",
]
