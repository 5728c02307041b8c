"""Shapes of the bed, one file a kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.io.georeference import Georeference
from insonify.scene.base import Choice
from insonify.scene.kinds import Family

if TYPE_CHECKING:
    from insonify.scene.seabed.materials import MaterialMap
    from insonify.scene.seabed.reliefs.random_relief import RandomRelief

RELIEFS = Family("reliefs", "insonify.scene.seabed.reliefs")


class HeightGrid(NamedTuple):
    """Heights of a bed on a square grid."""

    # (ny, nx) metres above the mean bed, or above the sea surface if measured; NaN where there is no bed.
    heights: NDArray[np.float64]
    spacing: float  # metres between nodes
    x0: float = 0.0  # local coordinates of node (0, 0), in metres
    y0: float = 0.0


class ReliefKind(Choice):
    """Shape of the bed.

    A kind either has random `parts`, or it samples its heights.

    Attributes
    ----------
    level : bool
        Whether the bed has no relief.
    measured : bool
        Whether its heights are above the sea surface and end somewhere, whatever depth is declared.
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

    @property
    def version(self) -> tuple[int, int] | None:
        """Version of the file that it is read from, None if there is none."""
        return None

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
            Nodes of one period; as many as the spacing makes when left out.

        Raises
        ------
        SceneError
            If the bed cannot be made.
        """
        raise NotImplementedError

    def georeference(self, origin: tuple[float, float] | None) -> Georeference | None:
        """Place of the local (0, 0) on the map of a measured bed; None if the bed is on no map.

        Parameters
        ----------
        origin : (float, float), optional
            Its map coordinates, where the scene gives them.
        """
        del origin
        return None

    def check(self, spacing: float, material: MaterialMap) -> None:
        """Refuse a relief that a grid of that spacing (m), or a bed of that material, cannot have.

        Raises
        ------
        ValueError
            One sentence with the field, the value and the remedy.
        """


class AddableRelief(ReliefKind):
    """A relief that may be one of a sum."""
