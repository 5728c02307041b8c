"""Regular patterns of materials: stripes, checks, and waves of graded rows."""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from insonify.arrays import Floats
from insonify.errors import SceneError
from insonify.scene.base import angle, metres, parameter
from insonify.scene.seabed.materials import Cells, CompositeMap, Map, Material
from insonify.scene.seabed.materials.catalogue import Reflectivity

GRADES = 256  # rows of waves from the first material to the last: the values of one byte
LIKE = 1e-12  # cycles a metre, difference below which wave numbers are equal
NEAR = 1e-3  # relative change of the wave numbers of an oblique pattern, so that its bed stays small

WaveVector = tuple[float, float]


class PatternMap(CompositeMap, kind="pattern", rank=4):
    """A regular pattern with known borders, for checks and figures."""

    of: tuple[Material, ...] = parameter(description="materials of one period", min_length=2, max_length=32)
    shape: Literal["stripes", "checks", "waves"] = parameter(
        "stripes", "stripes and checks have sharp borders; waves blend from the first to the last and back"
    )
    period: float = metres(
        8.0,
        "length after which the pattern repeats, adjusted so that whole ones fill a period of the relief",
        (0.5, 50.0),
        most=1e5,
    )
    heading: float = angle(
        "direction along the stripes, their order to its left; counter-clockwise from east; 45T is 45° by the compass"
    )

    def rows(self, frequency: float | None = None) -> tuple[tuple[str, ...], tuple[Reflectivity, ...]]:
        """Names and scattering parameters of the rows; rows of waves are mixtures of two materials."""
        return graded_rows(self.of, frequency) if self.shape == "waves" else super().rows(frequency)

    def indices(self, cells: Cells) -> Map:
        """Row of each cell; on a periodic bed, period and heading are adjusted to it."""
        x, y = cells.centres()
        across, along = (_fitted(vector, cells) for vector in self._wave_vectors())
        return self.rows_at(
            across[0] * x + (across[1] * y)[:, np.newaxis], along[0] * x + (along[1] * y)[:, np.newaxis]
        )

    def rows_at(self, across: Floats, along: Floats) -> Map:
        """Row of the table of materials at coordinates in periods."""
        if self.shape == "waves":
            return np.rint((0.5 - 0.5 * np.cos(2.0 * math.pi * across)) * (GRADES - 1)).astype(np.uint8)
        count = len(self.of)
        steps = np.floor(across * count)
        if self.shape == "checks":
            steps = steps + np.floor(along * count)
        return (steps % count).astype(np.uint8)

    def level_shape(self, spacing: float, fewest: int, most: int) -> tuple[int, int]:
        """Cells along y and x after which a level bed repeats together with the pattern, as nearly as possible."""
        if self.period > most * spacing:
            raise SceneError(
                f"period: {self.period:g} m spans more than {most} cells of seabed.spacing {spacing:g} m; "
                "shorten it or widen the spacing"
            )
        vectors = self._wave_vectors()[: 2 if self.shape == "checks" else 1]
        nx, ny = (
            _cells([vector[axis] for vector in vectors], NEAR / self.period, spacing, fewest, most) for axis in (0, 1)
        )
        return ny, nx

    def _wave_vectors(self) -> tuple[WaveVector, WaveVector]:
        """Cycles per metre along x and y, first across the stripes and then along them."""
        angle = math.radians(self.heading)
        # Rounded, so that stripes along an axis of the grid are exactly along it.
        cosine, sine = round(math.cos(angle), 12) / self.period, round(math.sin(angle), 12) / self.period
        return (-sine, cosine), (cosine, sine)


def graded_rows(
    materials: Sequence[Material], frequency: float | None
) -> tuple[tuple[str, ...], tuple[Reflectivity, ...]]:
    """Names and scattering parameters of equal steps from the first material through the others to the last."""
    levels, whole = np.linspace(0.0, len(materials) - 1.0, GRADES), np.arange(len(materials))
    given = [material.reflectivity_at(frequency) for material in materials]
    columns = [np.interp(levels, whole, column) for column in zip(*(row[:5] for row in given))]
    # Mixtures of speckle are linear in its variance 1/ν, where both materials have one.
    spiky = [math.nan if row.speckle_shape is None else 1.0 / row.speckle_shape for row in given]
    rows = tuple(
        Reflectivity(*map(float, numbers))._replace(speckle_shape=None if math.isnan(mixed) else 1.0 / float(mixed))
        for *numbers, mixed in zip(*columns, np.interp(levels, whole, spiky))
    )
    names = []  # each gives the percentages of the two materials of a mixture: ``25.1_silt+74.9_rock``
    for level in levels:
        low = int(level)
        share = 100.0 * (float(level) - low)
        first = materials[low].name
        names.append(f"{100.0 - share:.1f}_{first}+{share:.1f}_{materials[low + 1].name}" if share > 0.0 else first)
    return tuple(names), rows


def _fitted(vector: WaveVector, cells: Cells) -> WaveVector:
    """Turn and stretch a wave slightly, so that whole cycles fill a periodic bed."""
    if not cells.periodic:
        return vector
    cycles = [round(size * wave) for size, wave in zip(cells.size, vector)]
    if cycles == [0, 0]:
        main = int(abs(vector[1]) >= abs(vector[0]))
        cycles[main] = 1 if vector[main] > 0.0 else -1
    return cycles[0] / cells.size[0], cycles[1] / cells.size[1]


def _cells(waves: Sequence[float], near: float, spacing: float, fewest: int, most: int) -> int:
    """Fewest cells that contain whole cycles of all waves, or nearly whole ones if no number does."""
    length = np.arange(fewest, most + 1) * spacing
    errors = [np.abs(np.rint(length * wave) / length - wave) for wave in waves]
    worst = np.max(errors, axis=0)
    best = float(worst.min())
    enough = LIKE if best <= LIKE else max(best, near)
    return fewest + int(np.argmax(worst <= enough))
