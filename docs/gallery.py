"""Draw the pictures of the README's gallery.

Run ``python docs/gallery.py`` to draw them all anew, or with names, ``python docs/gallery.py figure-2a wreck``, to
draw those alone. A cell of the gallery holds a picture, its caption and the command that makes it; the command is run
and what it writes is made smaller.
"""

from __future__ import annotations

import re
import shlex
import sys
import tempfile
from pathlib import Path

from PIL import Image

from insonify.cli import main

ROOT = Path(__file__).resolve().parents[1]
CELL = re.compile(r"!\[[^\]]*\]\((docs/gallery/[\w-]+\.jpg)\)<br>[^|]*?<br>`(insonify [^`]+)`")
WIDTH, LARGEST = 900, 250_000  # pixels, bytes


def cells(text: str) -> list[tuple[str, str]]:
    """Return the pictures of a gallery, by their paths, and the commands that make them."""
    return CELL.findall(text)


def draw(command: str, picture: Path) -> None:
    """Run a command that writes a PNG, and write a smaller JPEG of it."""
    words = shlex.split(command)[1:]
    with tempfile.TemporaryDirectory() as folder:
        drawn = Path(folder) / "drawn.png"
        words[words.index("-o") + 1] = str(drawn)
        if main(words) != 0:
            raise SystemExit(f"{command}: failed")
        with Image.open(drawn) as image:
            small = image.convert("RGB")
    small.thumbnail((WIDTH, 2 * WIDTH), Image.Resampling.LANCZOS)
    for quality in (88, 80, 70, 60):
        small.save(picture, quality=quality, optimize=True, progressive=True)
        if picture.stat().st_size <= LARGEST:
            return


if __name__ == "__main__":
    for path, command in cells((ROOT / "README.md").read_text(encoding="utf-8")):
        if len(sys.argv) == 1 or Path(path).stem in sys.argv[1:]:
            draw(command, ROOT / path)
