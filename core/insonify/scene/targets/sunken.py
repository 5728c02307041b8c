"""What wrecks of ships and aircraft have in common: broken apart, sunk into the bed, grown over, amid debris."""

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import parameter, share
from insonify.scene.targets import Pit
from insonify.scene.targets.generated import Generated
from insonify.scene.targets.parts import Triangles, bars, blocks, draw_shares, roughen
from insonify.scene.targets.shape import Shape, rotation_matrix

TORN = np.array([70.0, 14.0, 24.0])  # °, of heading, pitch and roll, by which a piece is turned at most
ADRIFT = np.array([0.25, 0.22])  # of the length, by which a piece lies off its place at most
WIDE = 0.75  # of the length, within which debris lies
STOUT = 0.16  # height over length of a hull without its masts, at most
MOST_DEBRIS, MOST_FISH = 90, 500
LOOSE = 0.3  # share of the pieces that come loose as soon as it breaks
LONG = 0.4  # length of a new one over the slant range, at most


class Sunken(Generated):
    """A vessel that sank; its centre is amidships, at the level of the bed.

    A kind declares its dimensions, a `length` among them, its `pieces` and its `scattered` share.
    """

    seed: int = parameter(1, "seed of breakage, fallen pieces and growth", ge=0, le=2**53)
    broken: float = share(0.0, "separation of its pieces: 0 in one piece, 1 scattered")
    buried: float = share(0.0, "share of its height below the bed", most=0.95)
    growth: float = parameter(
        0.0, "greatest thickness of marine growth and rust", "m", ge=0.0, le=2.0, slider=(0.0, 0.5)
    )
    fish: int = parameter(0, "number of fish that stand over it", ge=0, le=MOST_FISH, slider=(0, 200), rare=True)
    scour: float = parameter(
        0.0, "depth of the pit that the current has dug around it; negative: height of a mound. A bed of the kind flat "
        "stays flat", "m", ge=-10.0, le=10.0, slider=(-1.0, 2.0),
    )  # fmt: skip
    current: float | None = parameter(
        None, "direction in which the current flows, which digs before and leaves a ridge behind; counter-clockwise "
        "from east; an even pit when left out", "°", ge=-360.0, le=360.0, slider=(-180.0, 180.0), rare=True,
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
    def overall_length(self) -> float:
        """Length from end to end, in metres."""

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
        half = 0.75 * self.overall_length, 0.3 * self.overall_length + 0.4 * self.breadth
        return Pit(self.position[0], self.position[1], self.heading, half, self.scour, self.current)

    @classmethod
    def suited_to(cls, reach: float, path: str) -> dict[str, Any]:
        """Choose the length, at most a part of the slant range."""
        return {"length": float(f"{max(min(cls(position=(0.0, 0.0)).overall_length, LONG * reach), 1.0):.2g}")}

    def build(self) -> Shape:
        """Put pieces, debris and fish together."""
        turn = rotation_matrix(0.0, self.pitch, self.roll).T
        whole = [roughen(piece, self.growth, self.seed) @ turn for piece in self.pieces()]
        low, high = min(piece[..., 2].min() for piece in whole), max(piece[..., 2].max() for piece in whole)
        bed = np.array([0.0, 0.0, low + self.buried * (high - low)])
        around = self._debris(min(high - low, STOUT * self.overall_length)), self._school(high - bed[2])
        return Shape(
            triangles=np.concatenate([*self._torn(whole, low), *(part + bed for part in around)]) - bed, closed=True
        )

    def _torn(self, pieces: Sequence[Triangles], low: float) -> Iterator[Triangles]:
        """Pieces, of which loose ones are turned at their joints, moved away and sunk to the bed."""
        main = pieces[0].reshape(-1, 3).mean(axis=0)
        loose = np.array([draw_shares(self.seed, f"loose {number}", 1)[0] for number in range(len(pieces))])
        held = loose > max(LOOSE + (1.0 - LOOSE) * self.broken, float(loose[1:].min(initial=1.0)))
        for number, piece in enumerate(pieces):
            if number == 0 or held[number] or self.broken == 0.0:
                yield piece
                continue
            drawn = 2.0 * draw_shares(self.seed, f"piece {number}", 5) - 1.0
            corners = piece.reshape(-1, 3)
            joint = corners[np.argmin(np.linalg.norm(corners - main, axis=1))]
            turned = (piece - joint) @ rotation_matrix(*(self.broken * drawn[:3] * TORN)).T + joint
            turned[..., :2] += self.broken * self.overall_length * ADRIFT * drawn[3:]
            sunk = min(3.0 * self.broken, 1.0) * (turned[..., 2].min() - low)
            yield turned - np.array([0.0, 0.0, sunk])

    def _debris(self, height: float) -> Triangles:
        """Plates and bars that lie on the bed, thinning out along the way on which they came down."""
        count = round(MOST_DEBRIS * self.scattered)
        drawn = draw_shares(self.seed, "debris", MOST_DEBRIS, 8)[:count]
        way = 2.0 * np.pi * draw_shares(self.seed, "way", 1)[0]
        reach = WIDE * self.overall_length * (0.35 + 0.65 * self.scattered)
        ahead, beside = reach * (1.3 * drawn[:, 0] ** 1.5 - 0.3), 0.5 * reach * (2.0 * drawn[:, 1] - 1.0) ** 3
        size = height * np.stack(
            [0.1 + 0.5 * drawn[:, 2] ** 2, 0.04 + 0.2 * drawn[:, 3] ** 2, 0.02 + 0.07 * drawn[:, 4]]
        )
        x, y = np.cos(way) * ahead - np.sin(way) * beside, np.sin(way) * ahead + np.cos(way) * beside
        centre = np.stack([x, y, 0.6 * size[2]], axis=1)
        turns = (drawn[:, 5:] - 0.5) * np.array([360.0, 50.0, 50.0])
        is_bar = drawn[:, 4] < 0.4
        axis = np.stack([np.cos(np.radians(turns[:, 0])), np.sin(np.radians(turns[:, 0])), 0.004 * turns[:, 1]], 1)
        half: Floats = (size[0] * axis.T).T[is_bar]
        plates = blocks(centre[~is_bar], size.T[~is_bar], turns[~is_bar])
        return np.concatenate([plates, bars(centre[is_bar] - half, centre[is_bar] + half, 0.4 * size[2][is_bar])])

    def _school(self, height: float) -> Triangles:
        """Fish in a school over a part of it, most of them near its middle."""
        drawn = draw_shares(self.seed, "fish", MOST_FISH, 7)[: self.fish]
        middle = (draw_shares(self.seed, "school", 2) - 0.5) * [0.7 * self.overall_length, 0.7 * self.breadth]
        spread = np.array([0.2, 0.12]) * self.overall_length
        away = (drawn[:, :2] + drawn[:, 2:4] - 1.0) * spread
        place = np.column_stack([middle + away, height * (0.5 + 0.8 * drawn[:, 4])])
        course = 0.8 * (drawn[:, 5] - 0.5) + 2.0 * np.pi * draw_shares(self.seed, "course", 1)[0]
        long = 0.2 + 0.3 * drawn[:, 6]
        ahead = 0.5 * long[:, None] * np.stack([np.cos(course), np.sin(course), 0.0 * course], axis=1)
        return bars(place + ahead, place - ahead, 0.15 * long, 3, 0.3)
