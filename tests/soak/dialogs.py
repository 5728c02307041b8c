"""Answers to the window's dialogs, drawn at random: whole files, damaged files, files of another kind, none."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtWidgets import QFileDialog, QMessageBox

from fuzz.samples import SAMPLES
from insonify_viewer.widgets.gallery import Gallery

KINDS = {
    "Open a scene": ("scene",),
    "Open a measured bed": ("grid-npy", "grid-tif", "grid-bag", "grid-asc"),
    "Open recorded navigation": ("tow-csv", "tow-gpx", "tow-xtf"),
    "Open a measured cast": ("cast-asvp", "cast-csv", "cast-cnv"),
    "Open a mesh": ("mesh-obj", "mesh-stl", "mesh-ply", "mesh-glb"),
    "Open a recording": ("record-npz", "record-nc", "record-xtf", "record-jsf"),
    "Open a map of materials": ("image-png", "image-tif"),
}

OTHER = "correlation-csv"  # for any other title
TESTS = Path(__file__).parents[1]


class Answers:
    """Answers every dialog at once."""

    def __init__(self, random: np.random.Generator, folder: Path) -> None:
        self._random, self._folder, self._files = random, folder, 0
        names = sorted({OTHER, *(name for names in KINDS.values() for name in names)})
        # Another process writes undamaged samples, whose libraries the window need not hold.
        whole = folder / "whole"
        subprocess.run([sys.executable, "-m", "fuzz.samples", str(whole), *names], check=True, cwd=TESTS)
        self._whole = {name: (whole / name / SAMPLES[name].file).read_bytes() for name in names}
        QFileDialog.getOpenFileName = self._open  # type: ignore[method-assign,assignment]
        QFileDialog.getSaveFileName = self._save  # type: ignore[method-assign,assignment]
        Gallery.exec = lambda gallery: self._pick(gallery)  # type: ignore[method-assign,assignment]
        QMessageBox.question = lambda *_: QMessageBox.StandardButton.Discard  # type: ignore[method-assign,assignment]

    def _open(self, _: Any, title: str, *rest: Any) -> tuple[str, str]:
        chance = self._random.random()
        if chance < 0.1:
            return "", ""
        if chance < 0.2:
            return str(self._random.choice([str(self._folder), "/nowhere/scene.toml", "/dev/null"])), ""
        names = KINDS[str(self._random.choice(list(KINDS)))] if chance < 0.3 else KINDS.get(title, (OTHER,))
        return str(self._file(str(self._random.choice(names)), damaged=chance > 0.6)), ""

    def _pick(self, gallery: Gallery) -> int:
        """Pick one of the pictures, or close the gallery."""
        gallery.show()
        place = int(self._random.integers(gallery.list.count() + 1))
        if place < gallery.list.count():
            gallery.list.itemActivated.emit(gallery.list.item(place))
        gallery.close()
        return 0

    def _file(self, name: str, *, damaged: bool) -> Path:
        sample = SAMPLES[name]
        self._files += 1
        folder = self._folder / f"{self._files}"
        folder.mkdir()
        path, whole = folder / sample.file, self._whole[name]
        path.write_bytes(sample.mutate(whole, self._random) if damaged else whole)
        return path

    def _save(self, *_: Any) -> tuple[str, str]:
        self._files += 1
        name = self._random.choice(["a.toml", "a.png", "a.nc", "a.npz", "a", "nowhere/a.png"])
        return str(self._folder / f"saved-{self._files}-{name}"), ""
