"""Persons on the bed, and the dummies and sacks that searchers train with."""

from collections.abc import Iterator
from typing import Any, Literal

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import metres, parameter, share
from insonify.scene.targets.generated import Generated
from insonify.scene.targets.parts import Triangles, bars, blocks, draw_shares, skin
from insonify.scene.targets.shape import Shape, rotation_matrix

AROUND, FLAPS, FOLD = 10, 6, 0.3  # plates about a trunk; loose cloths at most; depth of folds over the radius
# Places from the head down, half widths and half heights of sections, over the length.
TRUNKS = {
    "person": ((0.17, 0.21, 0.3, 0.4, 0.5, 0.56), (0.03, 0.11, 0.12, 0.1, 0.11, 0.06),
               (0.03, 0.06, 0.07, 0.06, 0.065, 0.04)),
    "sack": ((0.0, 0.05, 0.2, 0.45, 0.7, 0.92, 1.0), (0.03, 0.09, 0.15, 0.15, 0.16, 0.13, 0.05),
             (0.02, 0.05, 0.08, 0.09, 0.09, 0.07, 0.03)),
}  # fmt: skip
ROPE = 0.012  # m, radius


class Person(Generated, kind="person", rank=8):
    """A person, or an effigy of one, on the bed, face up at roll 0 and face down at 180."""

    form: Literal["person", "sack"] = parameter("person", "with limbs, or a filled sack")
    length: float = metres(1.75, "from the head to the heels", (0.5, 2.5), least=0.2, most=5.0)
    spread: float = share(0.1, "how far arms and legs are apart: 0 along the body, 1 stretched out to the sides")
    bent: float = share(0.1, "bend of hips and knees: 0 straight, 1 curled up")
    clothing: float = share(0.3, "looseness of clothes or cloth: folds, and pieces that drift")
    rope: float = parameter(
        0.0, "length of a rope to a weight that holds it; 0: none", "m", ge=0.0, le=20.0, slider=(0.0, 5.0)
    )
    buried: float = share(0.0, "share of its height below the bed", most=0.95)
    seed: int = parameter(1, "seed of its pose, folds and cloths", ge=0, le=2**53)

    @property
    def sizes(self) -> dict[str, tuple[str, ...]]:
        """Its length, by which its body is measured."""
        return {"resize": ("length",)}

    @classmethod
    def suited_to(cls, reach: float, path: str) -> dict[str, Any]:
        """Choose nothing: persons are of one size."""
        return {}

    @property
    def idle_fields(self) -> frozenset[str]:
        """The pose of limbs, of a sack; the gap if z is given."""
        return super().idle_fields | ({"spread", "bent"} if self.form == "sack" else frozenset())

    def build(self) -> Shape:
        """Put the parts together."""
        body = np.concatenate([*self._trunk(), *(self._limbs() if self.form == "person" else ()), *self._cloths()])
        body = body @ rotation_matrix(0.0, self.pitch, self.roll).T
        low, high = body[..., 2].min(), body[..., 2].max()
        body[..., 2] -= low + self.buried * (high - low)
        return Shape(triangles=np.concatenate([body, *self._anchored()]), closed=True)

    def _trunk(self) -> Iterator[Triangles]:
        """Trunk or sack, with folds, and the head."""
        places, wide, high = (self.length * np.array(values) for values in TRUNKS[self.form])
        angle = 2.0 * np.pi * np.arange(AROUND + 1) / AROUND
        folds = 1.0 + FOLD * self.clothing * (2.0 * draw_shares(self.seed, "folds", len(places), AROUND) - 1.0)
        folds = np.column_stack([folds, folds[:, 0]])
        # Sacks sag sideways where they are empty.
        aside = 0.1 * self.length * self.clothing * (draw_shares(self.seed, "aside", len(places))[:, None] - 0.5)
        x = np.broadcast_to(0.5 * self.length - places[:, None], folds.shape)
        y, z = aside - folds * wide[:, None] * np.sin(angle), -folds * high[:, None] * np.cos(angle)
        yield skin(np.stack([x, y, z], axis=-1)[::-1], 0.01 * self.length)
        if self.form == "person":
            head = self.length * np.array([0.5, 0.0, 0.0])
            crown, neck = head - [0.13 * self.length, 0, 0], head - [0.19 * self.length, 0, 0]
            yield bars([head, crown], [crown, neck], self.length * np.array([0.055, 0.045]), 8)

    def _limbs(self) -> Iterator[Triangles]:
        """Arms and legs, each of two straight parts."""
        drawn = 2.0 * draw_shares(self.seed, "limbs", 2, 4) - 1.0
        for hand, (arm, elbow, leg, knee) in zip((1.0, -1.0), drawn):
            out = np.radians(8.0 + 80.0 * self.spread * (1.0 + 0.4 * arm))
            inner = out + np.radians(40.0) * self.spread * elbow - 0.6 * self.bent
            yield self._limb([0.27, 0.13 * hand, 0.0], hand, (out, inner), (0.0, 0.1 * self.bent), (0.17, 0.24), 0.03)
            apart = np.radians(3.0 + 32.0 * self.spread * (1.0 + 0.4 * leg))
            hip, folded = 1.5 * self.bent, -1.8 * self.bent * (1.0 + 0.2 * knee)
            yield self._limb([-0.04, 0.05 * hand, 0.0], hand, (apart, apart), (hip, folded), (0.23, 0.23), 0.045)

    def _limb(
        self,
        joint: list[float],
        hand: float,
        out: tuple[float, float],
        up: tuple[float, float],
        lengths: tuple[float, float],
        radius: float,
    ) -> Triangles:
        """Limb of two parts by their angles outwards and upwards, over the length of the body."""
        points = [np.array(joint)]
        for aside, rise, long in zip(out, up, lengths):
            way = np.array([-np.cos(aside) * np.cos(rise), hand * np.sin(aside), np.cos(aside) * np.sin(rise)])
            points.append(points[-1] + long * way)
        ends = self.length * np.array(points)
        return bars(ends[:-1], ends[1:], self.length * radius * np.array([1.2, 0.9]), 6, 0.8)

    def _cloths(self) -> Iterator[Triangles]:
        """Pieces of cloth that drift to one side of the body."""
        count = round(FLAPS * self.clothing)
        side = 1.0 if draw_shares(self.seed, "drift", 1)[0] < 0.5 else -1.0
        for along, long, wide, lift, wave, skew in draw_shares(self.seed, "cloths", FLAPS, 6)[:count]:
            out, on = np.linspace(0.02, 0.1 + 0.25 * long, 5), np.linspace(-0.5, 0.5, 3) * (0.08 + 0.15 * wide)
            grid: Floats = np.zeros((5, 3, 3))
            grid[..., 0] = 0.3 - 0.7 * along + on + (0.6 * (skew - 0.5) * out)[:, None]
            grid[..., 1] = side * out[:, None]
            grid[..., 2] = (0.4 * lift * out + 0.02 * np.sin(30.0 * out + 6.0 * wave))[:, None]
            yield skin(self.length * (grid if side < 0.0 else grid[:, ::-1]), 0.006 * self.length)

    def _anchored(self) -> Iterator[Triangles]:
        """Rope along the bed, and the weight at its end."""
        if self.rope == 0.0:
            return
        turn, bend = draw_shares(self.seed, "rope", 2)
        share_of = np.linspace(0.0, 1.0, 9)
        course = 2.0 * np.pi * turn
        ahead, left = np.array([np.cos(course), np.sin(course)]), np.array([-np.sin(course), np.cos(course)])
        reach = self.rope * share_of[:, None]
        flat = 0.9 * reach * ahead + 0.25 * self.rope * (bend - 0.5) * np.sin(np.pi * share_of)[:, None] * left
        rope = np.column_stack([flat, ROPE + 0.1 * self.length * (1.0 - share_of) ** 3])
        yield bars(rope[:-1], rope[1:], ROPE)
        yield blocks([*rope[-1, :2], 0.08], [0.3, 0.22, 0.18], [np.degrees(course), 4.0, 0.0])
