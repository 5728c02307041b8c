"""Run the commands and programs that a page shows, and put what they print and draw where the page shows it.

A page is run from top to bottom in an empty folder, in which its files stay from block to block:

- a ``toml`` block with a ``title`` is written to the file of that name;
- in a ``console`` block each line that begins with ``$ `` is run; the lines up to the next one are its output;
- ``python`` blocks run in one namespace, and a ``text`` block right after one is what it prints; after the comment
  ``<!-- slow -->`` one runs to make the page, not to check it, and after ``<!-- shown -->`` it never runs;
- a picture whose name is that of a PNG file written by the page's commands is a smaller JPEG of it.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import close_ups
from PIL import Image

BLOCK = re.compile(r"^(<!-- \w+ -->\n)?```(\w+)([^\n]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]*pictures/([\w-]+)\.jpg)\)")
WIDTH, LARGEST = 900, 250_000  # pixels, bytes
WIDTHS = {
    "chart": 1500,
    "chart-bent": 1500,
    "chart-rough": 1500,
    "contact-sheet": 1100,
    "convergence": 1000,
    "learned": 1200,
    "handles": 1140,
    "lesson": 1400,
    "one-effect": 1400,
    "pixel": 1400,
    "rays": 1200,
    "record": 1100,
    "recording": 1400,
    "window": 1400,
}
# Parts of a window, (left, top, right, bottom) in pixels of its picture, that a page shows instead of the whole.
OF_WINDOWS = {
    "controls": (1270, 62, 1600, 696),
    "handles": (0, 62, 1130, 650),
    "lesson": (0, 62, 1600, 640),
    "one-effect": (514, 62, 1600, 712),
    "pixel": (0, 62, 1260, 976),
    "record": (510, 62, 1600, 976),
    "recording": (330, 62, 1600, 870),
}
QUICK = (
    "lesson",
    "plan",
    "scenes",
    "targets",
)  # commands that a check runs; anything else is run only to make the page
COLUMNS = "80"


def run(text: str, path: Path | None) -> str:
    """Run a page.

    Parameters
    ----------
    text : str
        The page.
    path : Path or None
        Where it stands, so that its pictures are made; None runs only what is quick.

    Returns
    -------
    str
        The page with outputs as they are now.
    """
    if "```console" not in text and "```python" not in text:
        return text
    names: dict[str, Any] = {"__name__": "__main__"}
    with _empty_folder() as folder:
        state: dict[str, str | None] = {"printed": None}

        def block(match: re.Match[str]) -> str:
            comment, language, attributes, body = match.groups(default="")
            printed, state["printed"] = state["printed"], None
            if language == "toml" and (title := re.search(r'title="([^"]+)"', attributes)):
                (folder / title[1]).write_text(body, encoding="utf-8")
            elif language == "console":
                body = _console(body, quick=path is None)
            elif language == "python" and "shown" not in comment and (path is not None or "slow" not in comment):
                state["printed"] = _python(body, names)
            elif language == "text" and printed is not None:
                body = printed
            return f"{comment}```{language}{attributes}\n{body}```"

        made = BLOCK.sub(block, text)
        if path is not None:
            _keep_pictures(made, path.parent, folder)
    return made


@contextlib.contextmanager
def _empty_folder() -> Iterator[Path]:
    """Work in an empty folder, with lines as wide as pages show them."""
    before, columns = Path.cwd(), os.environ.get("COLUMNS")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.environ["COLUMNS"] = COLUMNS
        try:
            yield Path(folder)
        finally:
            os.chdir(before)
            os.environ.pop("COLUMNS")
            if columns is not None:
                os.environ["COLUMNS"] = columns


def _console(body: str, quick: bool) -> str:
    """Run the commands of a block; the output of those that are not run stays."""
    out = []
    for part in re.split(r"^(?=\$ )", body, flags=re.MULTILINE):
        command, _, _ = part.partition("\n")
        words = shlex.split(command[2:], comments=True)
        skipped = quick and (len(words) < 2 or words[1] not in QUICK)
        if not part.startswith("$ insonify") or skipped:
            out.append(part)
        else:
            printed = _planned(*words[2:]) if words[1] == "plan" else _insonify(words[1:])
            out.append(f"{command}\n{printed}")
    return "".join(out)


def _insonify(words: list[str]) -> str:
    """Run the command; return what it prints, mistakes included."""
    from insonify.cli import main

    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        main(words)
    return printed.getvalue()


@cache
def _planned(*words: str) -> str:
    """Return a plan, the same on all pages: its costs are measured."""
    return _insonify(["plan", *words])


def _python(body: str, names: dict[str, Any]) -> str:
    """Run a program; return what it prints."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(body, "<page>", "exec", dont_inherit=True), names)
    return printed.getvalue()


def _keep_pictures(text: str, place: Path, folder: Path) -> None:
    """Make JPEG files of the PNG files that the page shows."""
    for path, name in PICTURE.findall(text):
        drawn = folder / f"{name}.png"
        if drawn.exists():
            if name in OF_WINDOWS:
                with Image.open(drawn) as image:
                    image.crop(OF_WINDOWS[name]).save(drawn)
            if name in close_ups.PARTS:
                close_ups.enlarge(name, drawn)
            shrink(drawn, place / path, WIDTHS.get(name, WIDTH))


def shrink(drawn: Path, picture: Path, width: int = WIDTH) -> None:
    """Write a smaller JPEG of a PNG."""
    with Image.open(drawn) as image:
        small = image.convert("RGB")
    small.thumbnail((width, 2 * width), Image.Resampling.LANCZOS)
    for quality in (88, 80, 70, 60):
        small.save(picture, quality=quality, optimize=True, progressive=True)
        if picture.stat().st_size <= LARGEST:
            return
