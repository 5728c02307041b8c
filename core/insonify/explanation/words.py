"""Words of an explanation: names of paths, targets and materials."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from insonify.scene import Scene
    from insonify.terrain import AnyGround

PATH_NAMES = {
    "direct": "direct",
    "surface_bottom": "ghost by surface and bottom",
    "surface_bottom_surface": "ghost by surface, bottom and surface",
    "second_bottom": "second bottom echo",
    "surface": "echo of the sea surface",
    "crosstalk": "crosstalk from the other side",
}


def name_part(part: object, index: int) -> str:
    """Name a target or a volume by its file or its kind, and its number from 1: ``wreck 1``, ``pipe 2``."""
    kind = Path(getattr(part, "path", "")).stem or str(getattr(part, "kind", "target"))
    return f"{kind.replace('_', ' ').replace('-', ' ')} {index + 1}"


def name_materials(scene: Scene, ground: AnyGround) -> tuple[str, ...]:
    """Names of the materials by their rows: first of the bed, then of the targets."""
    names = (*ground.names, *(target.material.name for target in scene.targets))
    return tuple(name.replace("_", " ") for name in names)
