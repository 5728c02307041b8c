"""Regenerate what the documentation prints and shows: reference pages, outputs of commands, pictures, figures.

``python docs/make`` makes all of it; ``python docs/make PAGE …`` makes the named ones alone (``reference``,
``figures``, ``stability``, ``movie``, ``example``, ``gallery``, ``scene-pictures``, ``mesh-pictures``, or a path below
``docs`` such as ``tutorial/python``).
``--check`` changes nothing: it compares what is quick to make with the files as they are, names what is out of date,
and exits with 1.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import courses
import example
import failures
import fields
import figures
import gallery
import movie
import packages
import pages
import reference
import small_pictures
import speeds

DOCS = Path(__file__).resolve().parents[1]
GENERATED: dict[str, Callable[[], str]] = {
    "reference/cli.md": reference.command_page,
    "reference/python.md": reference.python_page,
    "howto/index.md": reference.howto_page,
    "architecture/rooms.md": packages.page,
    **courses.pages(),
}
# Measured at every run; a page is not out of date for them.
TIMES = re.compile(r" +(-|[\d.]+(e[+-]?\d+)? [µm]s)$|^Cost .*$|(?<=, )[\d.]+ % less\n? *work", re.MULTILINE)
DRAWN: dict[str, Callable[[], None]] = {
    "figures": lambda: figures.draw(DOCS / "pictures"),
    "stability": lambda: failures.write(DOCS),
    "movie": lambda: movie.draw(DOCS / "pictures" / "tow.webp"),
    "example": lambda: example.write(DOCS.parent / "resources" / "records" / "default.npz"),
    "gallery": lambda: gallery.draw(DOCS),
    "scene-pictures": lambda: small_pictures.draw_scenes(DOCS.parent / "resources" / "scenes" / "pictures"),
    "mesh-pictures": lambda: small_pictures.draw_meshes(DOCS.parent / "resources" / "meshes" / "pictures"),
}


def main() -> int:
    """Make or check; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", help="pages to make; all when left out")
    parser.add_argument("--check", action="store_true", help="compare what is quick to make, change nothing")
    arguments = parser.parse_args()
    stale = [*_reference(arguments), *_pages(arguments)]
    if not arguments.check:
        for name, draw in DRAWN.items():
            if _wanted(name, arguments.names):
                draw()
    for name in stale:
        sys.stderr.write(f"docs/{name} {'is out of date: run python docs/make' if arguments.check else 'written'}\n")
    return int(arguments.check and bool(stale))


def _wanted(name: str, names: list[str]) -> bool:
    return not names or any(name.startswith(wanted) for wanted in names)


def _reference(arguments: argparse.Namespace) -> list[str]:
    """Make the generated pages; return those that differ from the files."""
    stale = []
    for name, text in {**fields.pages(), **{name: make() for name, make in GENERATED.items()}}.items():
        path = DOCS / name
        if _wanted(name, arguments.names) and (not path.exists() or path.read_text(encoding="utf-8") != text):
            stale.append(name)
            if not arguments.check:
                path.parent.mkdir(exist_ok=True)
                path.write_text(text, encoding="utf-8")
    return stale


def _pages(arguments: argparse.Namespace) -> list[str]:
    """Run the commands and programs of the written pages; return the pages whose printed output differs."""
    stale: dict[str, None] = {}
    written = {path.relative_to(DOCS).as_posix(): path for path in sorted(DOCS.rglob("*.md"))}
    written = {name: path for name, path in written.items() if name not in GENERATED and "reference/scene" not in name}
    written["../README.md"] = DOCS.parent / "README.md"

    def rewrite(name: str, made: str, text: str) -> None:
        if TIMES.sub("", made) != TIMES.sub("", text):
            stale[name] = None
            if not arguments.check:
                written[name].write_text(made, encoding="utf-8")

    for name, path in written.items():
        if _wanted(name, arguments.names):
            text = path.read_text(encoding="utf-8")
            rewrite(name, pages.run(text, None if arguments.check else path), text)
    for name, path in written.items():  # once the pages that they are quoted from are made
        text = path.read_text(encoding="utf-8")
        rewrite(name, speeds.quote(text), text)
    return list(stale)


if __name__ == "__main__":
    sys.exit(main())
