"""Versions of the program and of what it runs on."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

PARTS = ("insonify", "numpy", "numba", "PySide6-Essentials", "vtk", "pyvista")


def list_versions() -> list[str]:
    """Name the program, its parts, Python and the system, each with its version."""
    parts = [f"{part} {version_of(part)}" for part in PARTS]
    return [*parts, f"Python {platform.python_version()}, {platform.platform(terse=True)}"]


def version_of(part: str) -> str:
    """Version of an installed package."""
    try:
        return version(part)
    except PackageNotFoundError:
        return "(version unknown)"
