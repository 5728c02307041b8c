"""What wrecks of ships and aircraft have in common: broken apart, sunk into the bed, grown over, amid debris."""

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import parameter, share
from insonify.scene.targets import Pit, Posed
from insonify.scene.targets.parts import Triangles, bars, blocks, draw_shares, roughen
from insonify.scene.targets.shape import Shape, rotation_matrix

TORN = np.array([70.0, 14.0, 24.0])  # °, of heading, pitch and roll, by which a piece is turned at most
ADRIFT = np.array([0.25, 0.22])  # of the length, by which a piece lies off its place at most
WIDE = 0.75  # of the length, within which debris lies
STOUT = 0.16  # height over length of a hull without its masts, at most
MOST_DEBRIS = 90
LONG = 0.4  # length of a new one over the slant range, at most


class Sunken(Posed):
    """A vessel that sank; its centre is amidships, at the level of the bed.

    A kind declares its dimensions, its `pieces` and its `scattered` share.
    """

    length: float
    seed: int = parameter(1, "seed of breakage, fallen pieces and growth", ge=0, le=2**53)
    broken: float = share(0.0, "separation of its pieces: 0 in one piece, 1 scattered")
    buried: float = share(0.0, "share of its height below the bed", most=0.95)
    growth: float = parameter(
        0.0, "greatest thickness of marine growth and rust", "m", ge=0.0, le=2.0, slider=(0.0, 0.5)
    )

    scour: float = parameter(
        0.0, "depth of the pit that the current has dug around it; negative: height of a mound. A bed of the kind flat "
        "stays flat", "m", ge=-10.0, le=10.0, slider=(-1.0, 2.0),
    )  # fmt: skip

    @abstractmethod
    def pieces(self) -> list[Triangles]:
        """Triangles of the main piece and of those that may break off; bow towards +x, keel at z = 0."""

    @property
    @abstractmethod
    def scattered(self) -> float:
        """How much debris lies about, 0 to 1."""

    @property
    @abstractmethod
    def breadth(self) -> float:
        """Beam or span, in metres."""

    @property
    def sizes(self) -> dict[str, tuple[str, ...]]:
        """Its length, by which all else is measured that is not given."""
        return {"resize": ("length",)}

    @property
    def pit(self) -> Pit | None:
        """Scour about its length and breadth."""
        if self.scour == 0.0:
            return None
        half = 0.75 * self.length, 0.3 * self.length + 0.4 * self.breadth
        return Pit(self.position[0], self.position[1], self.heading, half, self.scour)

    @classmethod
    def suited_to(cls, reach: float, path: str) -> dict[str, Any]:
        """Choose the length, at most a part of the slant range."""
        return {"length": float(f"{max(min(cls.model_fields['length'].default, LONG * reach), 1.0):.2g}")}

    @property
    def attitude(self) -> tuple[float, float, float]:
        """Heading; pitch and roll turn the vessel, not its debris."""
        return self.heading, 0.0, 0.0

    def shape(self) -> Shape:
        """Return the triangles of pieces and debris; the bed is at z = 0."""
        return _kept_shape(self.model_copy(update={"position": (0.0, 0.0), "heading": 0.0}))

    @property
    def underside(self) -> float:
        """Height of the lowest point above the bed, in metres, negative where it is buried."""
        return self.gap + self.shape().lowest

    def build(self) -> Shape:
        """Put pieces and debris together."""
        turn = rotation_matrix(0.0, self.pitch, self.roll).T
        whole = [roughen(piece, self.growth, self.seed) @ turn for piece in self.pieces()]
        low, high = min(piece[..., 2].min() for piece in whole), max(piece[..., 2].max() for piece in whole)
        pieces = [*self._torn(whole, low)]
        bed = np.array([0.0, 0.0, low + self.buried * (high - low)])
        pieces.append(self._debris(min(high - low, STOUT * self.length)) + bed)
        return Shape(triangles=np.concatenate(pieces) - bed, closed=True)

    def _torn(self, pieces: Sequence[Triangles], low: float) -> Iterator[Triangles]:
        """Pieces turned and moved away from the first, the farther the more it has broken, and sunk to the bed."""
        for number, piece in enumerate(pieces):
            drawn = (number > 0) * (2.0 * draw_shares(self.seed, f"piece {number}", 5) - 1.0)
            middle = piece.mean(axis=(0, 1))
            turned = (piece - middle) @ rotation_matrix(*(self.broken * drawn[:3] * TORN)).T + middle
            turned[..., :2] += self.broken * self.length * ADRIFT * drawn[3:]
            sunk = min(3.0 * self.broken, 1.0) * (turned[..., 2].min() - low)
            yield turned - np.array([0.0, 0.0, sunk])

    def _debris(self, height: float) -> Triangles:
        """Plates and bars that lie about on the bed."""
        count = round(MOST_DEBRIS * self.scattered)
        drawn = draw_shares(self.seed, "debris", MOST_DEBRIS, 8)[:count]
        reach = WIDE * self.length * (0.35 + 0.65 * self.scattered) * drawn[:, 0]
        angle = 2.0 * np.pi * drawn[:, 1]
        size = height * np.stack(
            [0.1 + 0.5 * drawn[:, 2] ** 2, 0.04 + 0.2 * drawn[:, 3] ** 2, 0.02 + 0.07 * drawn[:, 4]]
        )
        centre = np.stack([reach * np.cos(angle), 0.5 * reach * np.sin(angle), 0.6 * size[2]], axis=1)
        turns = (drawn[:, 5:] - 0.5) * np.array([360.0, 50.0, 50.0])
        is_bar = drawn[:, 4] < 0.4
        ahead = np.stack(
            [np.cos(np.radians(turns[:, 0])), np.sin(np.radians(turns[:, 0])), 0.2 * turns[:, 1] / 50.0], 1
        )
        half: Floats = (size[0] * ahead.T).T[is_bar]
        plates = blocks(centre[~is_bar], size.T[~is_bar], turns[~is_bar])
        return np.concatenate([plates, bars(centre[is_bar] - half, centre[is_bar] + half, 0.4 * size[2][is_bar])])


@lru_cache(maxsize=32)
def _kept_shape(target: Sunken) -> Shape:
    return target.build()
