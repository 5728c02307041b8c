"""Reliefs of the bed: their base classes, and the level bed."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, NamedTuple

from insonify.arrays import Floats
from insonify.io.georeference import Georeference
from insonify.scene.base import Family, Kind

if TYPE_CHECKING:
    from insonify.scene.seabed.materials import MaterialMap
    from insonify.scene.seabed.reliefs.random_relief import RandomRelief

RELIEFS = Family("reliefs", "insonify.scene.seabed.reliefs")


class HeightGrid(NamedTuple):
    """Heights of a bed on a square grid."""

    # (ny, nx) metres above the mean bed, or above the sea surface if measured; NaN where there is no bed.
    heights: Floats
    spacing: float  # metres between nodes
    x0: float = 0.0  # local coordinates of node (0, 0), in metres
    y0: float = 0.0


class ReliefKind(Kind):
    """Relief of the bed.

    A kind either has random `parts`, or it samples its heights.

    Attributes
    ----------
    level : bool
        Whether the bed has no relief.
    measured : bool
        Whether its heights are relative to the sea surface, and limited in extent, whatever depth is declared.
    """

    family = RELIEFS
    level: ClassVar[bool] = False
    measured: ClassVar[bool] = False

    @property
    def parts(self) -> tuple[RandomRelief, ...]:
        """The random reliefs that add up to the bed; empty for a bed that is not random."""
        return ()

    @property
    def detail(self) -> tuple[RandomRelief, ...]:
        """Random reliefs that are added to a measured bed."""
        return ()

    def sample(
        self, spacing: float, origin: tuple[float, float] | None = None, shape: tuple[int, int] | None = None
    ) -> HeightGrid:
        """Sample the heights of a bed that is not random.

        Parameters
        ----------
        spacing : float
            Metres between nodes, where the bed has no grid of its own.
        origin : (float, float), optional
            Map coordinates of the local (0, 0).
        shape : (ny, nx), optional
            Nodes of one period; as many as the spacing requires when left out.

        Raises
        ------
        SceneError
            If the bed cannot be computed or read.
        """
        raise NotImplementedError

    def georeference(self, origin: tuple[float, float] | None) -> Georeference | None:
        """Map coordinates of the local (0, 0); None for a bed without map coordinates.

        Parameters
        ----------
        origin : (float, float), optional
            Map coordinates that the scene gives.
        """
        return None

    def check(self, spacing: float, material: MaterialMap) -> None:
        """Check the relief against the spacing of the grid (m) and the material of the bed.

        Raises
        ------
        ValueError
            If they do not fit: one sentence with the field, the value and the remedy.
        """


class Flat(ReliefKind, kind="flat", rank=10):
    """A level bed without relief."""

    level = True


class AddableRelief(ReliefKind):
    """A relief that may be part of a sum."""
