"""A sound-speed cast: properties of the water by depth, measured on the way down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.io.formats import FileFormat, FormatRegistry

ENCODING = "latin-1"  # accepts any byte
Values = NDArray[np.float64]
# Columns of a file by name: depth (m) and any of time (s), sound_speed (m/s), temperature (°C), salinity (practical).
# NaN where a row has no value.
Columns = dict[str, Values]


@dataclass(frozen=True, eq=False)
class Cast:
    """A measured cast with sound speed, or temperature and salinity, or all three."""

    depth: Values  # (n,) metres, increasing; at least two
    sound_speed: Values | None  # (n,) m/s
    temperature: Values | None  # (n,) °C, ITS-90
    salinity: Values | None  # (n,) practical salinity


CASTS: FormatRegistry[Columns] = FormatRegistry(
    "a measured cast",
    "insonify.io.sound_speed_casts",
    "insonify.sound_speed_cast_formats",
    "water.path: {path!r} {fault}; {remedy}",
)
# Formats that are known by name alone: another program converts them.
MANAGER = "convert it to .asvp or .csv, for example with Sound Speed Manager of HydrOffice"

RBR: FileFormat[Columns] = FileFormat("RBR Ruskin", (".rsk",), converter="export it as CSV from Ruskin")
MVP: FileFormat[Columns] = FileFormat(
    "Moving Vessel Profiler", (".m1", ".s10", ".s12", ".s52", ".raw"), converter=MANAGER
)
VALEPORT: FileFormat[Columns] = FileFormat("Valeport DataLog", (".vpd",), converter=MANAGER)
SIPPICAN: FileFormat[Columns] = FileFormat("Sippican", (".edf",), converter=MANAGER)
SONARDYNE: FileFormat[Columns] = FileFormat("Sonardyne", (".pro",), converter=MANAGER)
ELAC: FileFormat[Columns] = FileFormat("ELAC", (".sva",), converter=MANAGER)
