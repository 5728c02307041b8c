"""A rectangle of endless ground, made at once instead of tile by tile."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from insonify.terrain.endless_field import FAST, Nodes
from insonify.terrain.endless_ground import EndlessGround, HeldWindow
from insonify.terrain.ground import Ground

Column = NDArray[np.float64]
Corner = tuple[float, float]


@dataclass(frozen=True, eq=False)
class EndlessExcerpt(EndlessGround):
    """Endless ground of which no tiles are made where one rectangle suffices.

    A window of tiles holds several times the nodes that a few hundred pings need, which pays where the tow goes on.
    """

    make: Callable[[Nodes], Ground]  # makes the ground of some `Nodes`, which ends at their edges
    held: Ground  # the rectangle; pings are traced over it, whatever window they are in

    @classmethod
    def of(cls, whole: EndlessGround, make: Callable[[Nodes], Ground], low: Corner, high: Corner) -> EndlessExcerpt:
        """Make the rectangle between two corners, x and y in local metres."""
        known = {field.name: getattr(whole, field.name) for field in fields(whole)}
        return cls(**known, make=make, held=make(_nodes_between(low, high, whole.spacing)))

    @property
    def same_windows(self) -> Hashable:
        """Its rectangle."""
        return self.held

    def cell(self, x: Column, y: Column) -> NDArray[np.int64]:
        """Row and column of the only window, (n, 2)."""
        del y
        return np.zeros((np.size(x), 2), np.int64)

    def window(self, row: int, column: int, reach: float, held: HeldWindow | None = None) -> Ground:
        """Return the rectangle, whatever window is asked for."""
        del row, column, reach, held
        return self.held

    def around(self, centre: Corner, half: float) -> Ground:
        """Ground of a square around a place: the rectangle, or another one if that does not hold the square."""
        low, high = ((centre[0] + sign * half, centre[1] + sign * half) for sign in (-1.0, 1.0))
        corners = (np.array(axis) for axis in zip(low, high))
        if np.isnan(self.held.height_at(*corners)).any():
            return self.make(_nodes_between(low, high, self.spacing))
        return self.held

    def thinned(self, every: int) -> EndlessExcerpt:
        """Return the bed thinned to every n-th node along each axis, with node (0, 0)."""
        thin = super().thinned(every)
        assert isinstance(thin, EndlessExcerpt)

        def make(nodes: Nodes) -> Ground:
            return self.make(Nodes(*(every * number for number in nodes))).thinned(every)

        return replace(thin, make=make, held=self.held.thinned(every))

    def height_at(self, x: Column, y: Column) -> Column:
        """Bilinear height above the datum, of tiles where the rectangle ends."""
        heights = self.held.height_at(x, y)
        beyond = np.isnan(heights)
        if beyond.any():
            heights[beyond] = super().height_at(np.asarray(x)[beyond], np.asarray(y)[beyond])
        return heights

    def height_at_once(self, x: Column, y: Column) -> Column:
        """Bilinear height as in `height_at`, of squares where the rectangle ends."""
        heights = self.held.height_at(x, y)
        beyond = np.isnan(heights)
        if beyond.any():
            heights[beyond] = super().height_at_once(np.asarray(x)[beyond], np.asarray(y)[beyond])
        return heights

    def height_near(self, x: Column, y: Column) -> Column:
        """Bilinear height above the datum, that of the nearest edge where the rectangle ends."""
        return self.held.height_near(x, y)


def _nodes_between(low: Corner, high: Corner, spacing: float) -> Nodes:
    """Nodes that hold a rectangle; of even numbers, so that thinned nodes are among them."""
    first = [math.floor(place / spacing / FAST) * FAST for place in low]
    counts = [math.ceil(place / spacing / FAST) * FAST + FAST - begin for place, begin in zip(high, first)]
    return Nodes(first[1], first[0], counts[1], counts[0])
