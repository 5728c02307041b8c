"""Draw the small pictures of the bundled scenes, which the viewer shows beside their titles."""

from __future__ import annotations

import tempfile
from pathlib import Path

from PIL import Image

SIZE = (150, 100)  # px; the viewer shows half of it where pixels are not doubled
LARGEST = 6_000  # bytes of a picture


def draw(folder: Path) -> None:
    """Draw the whole record of every bundled scene into ``NAME.jpg``."""
    from insonify.cli import main
    from insonify.scene import bundled_scenes

    folder.mkdir(exist_ok=True)
    for name in bundled_scenes():
        with tempfile.TemporaryDirectory() as temporary:
            drawn = Path(temporary) / "drawn.png"
            if main(["render", name, "-o", str(drawn)]) != 0:
                raise SystemExit(f"{name}: its record cannot be drawn")
            squeeze(drawn, folder / f"{name}.jpg")


def squeeze(drawn: Path, picture: Path) -> None:
    """Write a picture as a small JPEG of one shape, which shows all of it."""
    with Image.open(drawn) as image:
        small = image.convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)
    for quality in range(80, 20, -5):
        small.save(picture, quality=quality, optimize=True)
        if picture.stat().st_size <= LARGEST:
            return
    raise SystemExit(f"{picture.name}: larger than {LARGEST} bytes")
