"""Draw the pictures of the gallery, each by the command that stands below it on the page."""

from __future__ import annotations

import re
import shlex
import tempfile
from pathlib import Path

import close_ups
from pages import shrink

CELL = re.compile(r"!\[[^\]]*\]\((gallery/[\w-]+\.jpg)\)<br>[^|]*?<br>`(insonify [^`]+)`")


def cells(text: str) -> list[tuple[str, str]]:
    """Return the pictures of the page, by their paths below ``docs``, and the commands that make them."""
    return CELL.findall(text)


def draw(docs: Path) -> None:
    """Draw every picture of ``gallery.md``."""
    from insonify.cli import main

    for path, command in cells((docs / "gallery.md").read_text(encoding="utf-8")):
        words = shlex.split(command)[1:]
        with tempfile.TemporaryDirectory() as folder:
            drawn = Path(folder) / "drawn.png"
            words[words.index("-o") + 1] = str(drawn)
            if main(words) != 0:
                raise SystemExit(f"{command}: failed")
            name = Path(path).stem
            if name in close_ups.PARTS:
                close_ups.enlarge(name, drawn)
            shrink(drawn, docs / path)
