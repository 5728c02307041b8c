"""Formats of casts that are known by name alone: another program converts them."""

from __future__ import annotations

from insonify.io.formats import FileFormat
from insonify.io.sound_speed_casts.cast import Columns

MANAGER = "convert it to .asvp or .csv, for example with Sound Speed Manager of HydrOffice"

RBR: FileFormat[Columns] = FileFormat("RBR Ruskin", (".rsk",), converter="export it as CSV from Ruskin")
MVP: FileFormat[Columns] = FileFormat(
    "Moving Vessel Profiler", (".m1", ".s10", ".s12", ".s52", ".raw"), converter=MANAGER
)
VALEPORT: FileFormat[Columns] = FileFormat("Valeport DataLog", (".vpd",), converter=MANAGER)
SIPPICAN: FileFormat[Columns] = FileFormat("Sippican", (".edf",), converter=MANAGER)
SONARDYNE: FileFormat[Columns] = FileFormat("Sonardyne", (".pro",), converter=MANAGER)
ELAC: FileFormat[Columns] = FileFormat("ELAC", (".sva",), converter=MANAGER)
