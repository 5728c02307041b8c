"""Files that come with the package, and versions of files on disk."""

import os
import tomllib
from collections.abc import Callable
from functools import cache, lru_cache, wraps
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar, cast

Reader = TypeVar("Reader", bound=Callable[..., Any])


@cache
def resources() -> Path:
    """Return the folder of scenes, lessons, meshes, materials, palettes and pages, in a wheel as in a checkout."""
    spec = find_spec("insonify")
    if spec is None or spec.origin is None:
        raise FileNotFoundError("the insonify package is not installed")
    package = Path(spec.origin).parent
    installed = package / "resources"
    return installed if installed.is_dir() else package.parent.parent / "resources"


def bundled_scenes() -> dict[str, Path]:
    """Return the scenes that come with the package, by name."""
    return {path.stem: path for path in sorted((resources() / "scenes").glob("*.toml"))}


def bundled_picture(path: str | Path) -> Path:
    """Return the small picture, 150 × 100 px, of a bundled scene's record or of a bundled mesh."""
    return Path(path).parent / "pictures" / f"{Path(path).stem}.jpg"


def bundled_lessons() -> dict[str, Path]:
    """Return the lessons that come with the package, by name."""
    return {path.stem: path for path in sorted((resources() / "lessons").glob("*.md"))}


def bundled_sonars() -> dict[str, Path]:
    """Return the presets of sonars that come with the package, by name."""
    return {path.stem: path for path in sorted((resources() / "sonars").glob("*.toml"))}


def bundled_meshes() -> dict[str, Path]:
    """Return the shapes that come with the package, by name."""
    # Beside them are their pictures, and in a checkout the scripts that make them.
    beside = ("", ".py", ".toml")
    return {path.stem: path for path in sorted((resources() / "meshes").iterdir()) if path.suffix not in beside}


@cache
def bundled_targets() -> dict[str, str]:
    """Return what each mesh of the library of targets is, by name, in the order of the library."""
    text = (resources() / "meshes" / "library.toml").read_text(encoding="utf-8")
    return {str(name): str(title) for name, title in tomllib.loads(text).items()}


def bundled_specifications(folder: str) -> dict[str, Path]:
    """Return the specifications that come with the package, by name, from ``surveys`` or from ``datasets``."""
    return {path.stem: path for path in sorted((resources() / folder).glob("*.toml"))}


def file_version(path: str | Path) -> tuple[int, int]:
    """Return numbers that change with the content of a file; zeros for anything else, which the reader rejects."""
    if not os.path.isfile(path):  # unlike the method of Path, no error for a name that is too long
        return 0, 0
    status = os.stat(path)
    return status.st_mtime_ns, status.st_size


def kept_until_changed(maxsize: int) -> Callable[[Reader], Reader]:
    """Decorate a reader of a path, or of a declaration with the ``version`` of a file: it keeps its last results.

    They are kept in memory until the file changes.
    """

    def decorate(read: Reader) -> Reader:
        @lru_cache(maxsize)
        def read_version(_: tuple[int, int] | None, source: Any, *options: Any) -> Any:
            return read(source, *options)

        @wraps(read)
        def reader(source: Any, *options: Any) -> Any:
            version = file_version(source) if isinstance(source, str) else source.version
            return read_version(version, source, *options)

        return cast("Reader", reader)

    return decorate
