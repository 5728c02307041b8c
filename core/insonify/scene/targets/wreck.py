"""Wrecks of ships and boats, made from the curves of their hulls."""

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import metres, parameter, share
from insonify.scene.targets.parts import Triangles, bars, blocks, draw_shares, skin
from insonify.scene.targets.sunken import Sunken

Pairs = tuple[tuple[float, ...], ...]
STATIONS = (0.0, 0.06, 0.2, 0.5, 0.78, 0.92, 1.0)  # of the curves, from the stern to the bow
FRAMES, LEVELS, ACROSS = 36, 7, 9  # points of a hull along, from rail to keel, and of a deck across
WALLS, GEAR = 16, 14  # plates around a deckhouse; things on a deck
GONE = (0.15, 0.55)  # decay at which the first and the last plates of the deck have fallen


class Form(NamedTuple):
    """A form of hull: curves at `STATIONS`, and what stands on its deck."""

    slender: float  # length over beam
    depth: float  # from keel to rail amidships, over the beam
    breadth: tuple[float, ...]  # of the rail, over the beam
    sheer: tuple[float, ...]  # height of the rail, over the depth
    rise: tuple[float, ...]  # of the keel, over the depth
    fullness: float  # exponent of the sections: 1 a wedge, 2 an ellipse, large a box
    bulwark: float = 0.1  # part of the depth by which the rail stands above the deck
    holds: Pairs = ()  # (after end, fore end, breadth over that of the ship) of openings in the deck
    houses: Pairs = ()  # (station, foot over the depth, length over the ship's, breadth, height over the depth)
    masts: Pairs = ()  # (station, height over the ship's length, radius over the beam)
    machines: Pairs = ()  # (station, length over the ship's, radius over the beam) of boilers, engines and turrets
    funnels: Pairs = ()  # (station, height over the depth, radius over the beam)


FINE, FULL = (0.5, 0.66, 0.9, 1.0, 0.82, 0.42, 0.02), (0.55, 0.8, 0.98, 1.0, 0.98, 0.66, 0.02)
RISING, RAKED = (1.25, 1.18, 1.06, 1.0, 1.08, 1.25, 1.42), (0.25, 0.08, 0.0, 0.0, 0.0, 0.05, 0.5)
ROUND, LEVEL = (0.16, 0.66, 0.96, 1.0, 0.97, 0.74, 0.03), (1.0,) * 7
FORMS = {
    "dinghy": Form(2.8, 0.42, (0.6, 0.74, 0.94, 1.0, 0.74, 0.36, 0.02), RISING, RAKED, 1.7, 1.0),
    "trawler": Form(
        3.4, 0.62, FULL, (1.1, 1.06, 1.0, 1.0, 1.15, 1.4, 1.6), RAKED, 2.2, 0.16, ((0.3, 0.44, 0.4),),
        ((0.62, 1.0, 0.17, 0.55, 0.5), (0.63, 1.5, 0.1, 0.4, 0.35)), ((0.5, 0.42, 0.03), (0.1, 0.25, 0.03)),
        ((0.55, 0.09, 0.14), (0.74, 0.05, 0.09)), ((0.54, 0.9, 0.09),),
    ),
    "schooner": Form(
        4.6, 0.58, FINE, RISING, RAKED, 1.5, 0.14, ((0.34, 0.46, 0.4), (0.58, 0.68, 0.36)),
        ((0.14, 0.95, 0.12, 0.45, 0.25),), ((0.3, 0.62, 0.04), (0.64, 0.6, 0.04), (0.84, 0.4, 0.03)),
    ),
    "barge": Form(
        4.4, 0.4, (0.9, 0.98, 1.0, 1.0, 1.0, 0.98, 0.86), LEVEL, (0.5, 0.1, 0.0, 0.0, 0.0, 0.1, 0.5), 6.0, 0.05,
        ((0.14, 0.36, 0.74), (0.38, 0.6, 0.74), (0.62, 0.86, 0.74)), ((0.07, 0.95, 0.06, 0.4, 0.5),),
    ),
    "freighter": Form(
        6.6, 0.62, FULL, (1.12, 1.08, 1.0, 1.0, 1.02, 1.2, 1.3), RAKED, 4.0, 0.06,
        ((0.13, 0.24, 0.5), (0.27, 0.38, 0.5), (0.58, 0.7, 0.5), (0.73, 0.84, 0.46)),
        ((0.48, 0.94, 0.13, 0.8, 0.4), (0.5, 1.34, 0.07, 0.6, 0.3), (0.04, 1.02, 0.07, 0.5, 0.25)),
        ((0.255, 0.22, 0.024), (0.715, 0.22, 0.024)), ((0.45, 0.06, 0.13), (0.51, 0.05, 0.15)), ((0.4, 0.9, 0.09),),
    ),
    "coaster": Form(
        5.6, 0.5, ROUND, (1.16, 1.1, 1.0, 1.0, 1.06, 1.28, 1.42), RAKED, 5.0, 0.08,
        ((0.32, 0.58, 0.66), (0.62, 0.82, 0.6)),
        ((0.15, 0.96, 0.2, 0.78, 0.5), (0.17, 1.44, 0.1, 0.7, 0.45), (0.94, 1.1, 0.06, 0.3, 0.12)),
        ((0.6, 0.25, 0.03), (0.9, 0.16, 0.02)), ((0.16, 0.1, 0.16),), ((0.1, 1.4, 0.08),),
    ),
    "liner": Form(
        7.6, 0.66, ROUND, (1.14, 1.08, 1.0, 1.0, 1.04, 1.18, 1.32), RAKED, 4.0, 0.06,
        ((0.12, 0.18, 0.3), (0.8, 0.87, 0.36)),
        ((0.48, 0.94, 0.56, 0.9, 0.3), (0.5, 1.24, 0.44, 0.8, 0.28), (0.66, 1.5, 0.1, 0.86, 0.26)),
        ((0.2, 0.26, 0.02), (0.8, 0.28, 0.02)), ((0.4, 0.06, 0.15), (0.5, 0.06, 0.15), (0.58, 0.05, 0.12)),
        ((0.42, 1.9, 0.11), (0.54, 1.9, 0.11)),
    ),
    "warship": Form(
        9.4, 0.6, (0.6, 0.76, 0.96, 1.0, 0.76, 0.36, 0.02), (0.84, 0.84, 0.86, 1.0, 1.1, 1.22, 1.36), RAKED, 2.4, 0.03,
        (),
        ((0.66, 1.02, 0.1, 0.6, 0.5), (0.68, 1.5, 0.05, 0.44, 0.5), (0.4, 0.96, 0.16, 0.34, 0.3),
         (0.77, 1.06, 0.045, 0.34, 0.3), (0.2, 0.8, 0.045, 0.34, 0.3), (0.11, 0.8, 0.045, 0.34, 0.2)),
        ((0.62, 0.2, 0.02), (0.32, 0.12, 0.015)), ((0.48, 0.06, 0.16), (0.56, 0.06, 0.16), (0.38, 0.06, 0.14)),
        ((0.57, 1.2, 0.1), (0.47, 1.1, 0.1)),
    ),
    "barque": Form(
        5.4, 0.66, ROUND, RISING, RAKED, 2.2, 0.12, ((0.26, 0.32, 0.3), (0.46, 0.54, 0.34), (0.72, 0.78, 0.3)),
        ((0.12, 1.0, 0.14, 0.5, 0.25), (0.64, 0.9, 0.08, 0.36, 0.3)),
        ((0.2, 0.5, 0.03), (0.44, 0.62, 0.04), (0.7, 0.6, 0.04), (0.92, 0.2, 0.03)),
    ),
    "tug": Form(
        3.0, 0.5, FULL, (1.0, 0.98, 0.95, 1.0, 1.2, 1.42, 1.6), RAKED, 2.4, 0.16, (),
        ((0.56, 1.0, 0.34, 0.58, 0.5), (0.64, 1.5, 0.13, 0.42, 0.4)), ((0.52, 0.36, 0.03),),
        ((0.5, 0.14, 0.18), (0.34, 0.1, 0.1)), ((0.46, 1.0, 0.12),),
    ),
    "submarine": Form(
        10.5, 1.0, (0.04, 0.3, 0.8, 1.0, 0.86, 0.5, 0.04), (0.56, 0.72, 0.94, 1.0, 0.96, 0.82, 0.55),
        (0.46, 0.34, 0.06, 0.0, 0.04, 0.2, 0.45), 2.0, -0.06, (),
        ((0.55, 1.0, 0.12, 0.3, 0.6), (0.5, 1.0, 0.5, 0.3, 0.1)), ((0.56, 0.14, 0.03),),
    ),
}  # fmt: skip
FormName = Literal[
    "dinghy", "trawler", "schooner", "barge", "freighter", "coaster", "liner", "warship", "barque", "tug", "submarine"
]


class Wreck(Sunken, kind="wreck", rank=6):
    """A sunken ship, from nearly whole by way of an open hold to ribs amid debris."""

    form: FormName = parameter("trawler", "form of the hull and what stands on its deck")
    length: float = metres(24.0, "length of the hull", (6.0, 120.0), least=1.0, most=400.0)
    beam: float | None = parameter(None, "breadth of the hull; that of its form when left out", "m", gt=0.0, le=80.0)
    timber: bool = parameter(False, "whether ribs and planks are thick, as of wood, or thin, as of steel")
    decay: float = share(0.3, "decay: 0 intact, 0.4 without deck, 0.8 without sides, 1 without most ribs")

    @property
    def scattered(self) -> float:
        """Debris that decay and a broken hull have left."""
        return min(self.decay**1.5 + 0.4 * self.broken, 1.0)

    @property
    def overall_length(self) -> float:
        """Length of the hull, in metres."""
        return self.length

    @property
    def breadth(self) -> float:
        """Breadth of the hull, in metres."""
        return self.length / FORMS[self.form].slender if self.beam is None else self.beam

    def value_in_force(self, field: str, frequency: float | None = None) -> float | None:
        """Return the beam of the form where it is left out."""
        return self.breadth if field == "beam" else None

    def pieces(self) -> list[Triangles]:
        """Return the fore and the after part, the longer one first."""
        hull = _Hull(self)
        cut = 9 + int(18 * draw_shares(self.seed, "cut", 1)[0])
        place = (cut / (FRAMES - 1) - 0.5) * self.length
        both = hull.shell(0, cut), hull.shell(cut, FRAMES - 1)
        for part in hull.fittings():
            if len(part):
                both[int(part[..., 0].mean() > place)].append(part)
        pieces = [np.concatenate(parts) for parts in both]
        return pieces if cut > FRAMES // 2 else pieces[::-1]


class _Hull:
    """Points and parts of a hull."""

    def __init__(self, wreck: Wreck) -> None:
        self._wreck, self._form = wreck, FORMS[wreck.form]
        self._length, self._beam, self._decay = wreck.length, wreck.breadth, wreck.decay
        self._depth = self._form.depth * self._beam
        self._plate = (0.02 if wreck.timber else 0.012) * self._beam
        self._x = np.linspace(-0.5, 0.5, FRAMES) * wreck.length

    def _curve(self, values: tuple[float, ...], u: Floats) -> Floats:
        """Smooth curve through the values at the stations, without overshoot."""
        # lazy: only generated targets need it
        from scipy.interpolate import PchipInterpolator

        return np.asarray(PchipInterpolator(STATIONS, values)(u))

    def _draw(self, name: str, *shape: int) -> Floats:
        return draw_shares(self._wreck.seed, name, *shape)

    def _points(self, x: Floats, level: Floats, inset: float = 0.0) -> Floats:
        """Points of the port side: (stations, levels, 3), level 0 at the keel and 1 at the rail."""
        u, form = x / self._length + 0.5, self._form
        rail, keel = self._depth * self._curve(form.sheer, u), self._depth * self._curve(form.rise, u)
        half = 0.5 * self._beam * self._curve(form.breadth, u)
        section = (1.0 - (1.0 - level) ** form.fullness) ** (1.0 / form.fullness)
        if form.bulwark < 0.0:  # closed above: sections are round
            section = np.sqrt(np.maximum(1.0 - (2.0 * level - 1.0) ** 2, 0.0))
        z = keel[:, None] + (rail - keel)[:, None] * level
        splayed = 1.8 * max(self._decay - 0.35, 0.0) * z * half[:, None] / self._beam
        y = np.maximum(half[:, None] * section - inset, 0.0) + splayed
        z = z * (1.0 - 0.55 * max(self._decay - 0.4, 0.0))  # its sides settle as they splay
        return np.stack([np.broadcast_to(x[:, None], z.shape), y, z], axis=-1)

    def shell(self, first: int, last: int) -> list[Triangles]:
        """Sides and deck between two frames."""
        levels = np.linspace(0.0, 1.0, LEVELS) ** (1.0 if self._form.bulwark < 0.0 else 1.6)  # closer at the bilge
        port = self._points(self._x[first : last + 1], levels)
        around = np.concatenate([port[:, :0:-1], port * np.array([1.0, -1.0, 1.0])], axis=1)
        # Sides lose their highest strakes first, along stretches of some frames.
        worn = self._draw("sides", 2, FRAMES // 4)[:, np.arange(first, last) // 4]
        torn = self._draw("plates", 2, FRAMES, LEVELS - 1)[:, first:last]
        strake = np.arange(LEVELS - 1) / (LEVELS - 1)  # from the keel up
        lost = self._decay * (0.35 + 0.9 * worn[..., None] + 0.25 * torn) * (0.2 + strake) > 0.62
        lost |= torn < 0.35 * self._decay * strake
        lost &= strake > 0.0
        sides = skin(around, self._plate, ~np.concatenate([lost[0][:, ::-1], lost[1]], axis=1))
        ends = [self._end(port[place], place) for place in (0, -1) if (first if place == 0 else last + 1 - FRAMES) == 0]
        return [sides, *ends, *self._deck(first, last), *self._fallen(first, last)]

    def _end(self, port: Floats, place: int) -> Triangles:
        """Transom, or bow of a barge: plates between the last frames of both sides, (levels, 3)."""
        rows = np.linspace(port, port * np.array([1.0, -1.0, 1.0]), 5)
        torn = self._draw(f"end {place}", 4, LEVELS - 1) < 0.8 * self._decay * np.linspace(0.0, 1.0, LEVELS - 1)
        return skin(rows if place else rows[::-1], self._plate, ~(torn if place else torn[::-1]))

    def _fallen(self, first: int, last: int) -> Iterator[Triangles]:
        """Stretches of the sides that have fallen outwards and lie beside the hull."""
        form = self._form
        if form.bulwark < 0.0:
            return
        for side, hand in enumerate((1.0, -1.0)):
            for stretch, (fate, out, tilt) in enumerate(self._draw(f"fallen {side}", FRAMES // 4, 3)):
                begin = 4 * stretch
                if not (first <= begin and begin + 4 <= last) or fate > 0.55 * (self._decay - 0.25):
                    continue
                foot = self._points(self._x[begin : begin + 5], np.array([0.35]))[:, 0]
                beyond = np.linspace(0.02, 0.3 + 0.5 * out, 4)[:, None] * self._depth
                grid = np.stack(
                    [
                        np.broadcast_to(foot[:, 0], (4, 5)),
                        foot[:, 1] + beyond + 0.1 * out * self._beam,
                        0.08 * self._depth + 0.5 * (tilt - 0.3) * (beyond - beyond[0]) + 0.0 * foot[:, 1],
                    ],
                    2,
                )
                grid[..., 1] *= hand
                yield skin(grid[::-1] if hand < 0.0 else grid, self._plate)

    def _deck(self, first: int, last: int) -> Iterator[Triangles]:
        """Deck with its hatches, as far as it is left; none in an open boat."""
        form, x = self._form, self._x[first : last + 1]
        if not 0.0 < form.bulwark < 1.0:
            return
        edge = self._points(x, np.array([1.0 - form.bulwark]), 0.5 * self._plate)[:, 0]
        share_across = np.linspace(-1.0, 1.0, ACROSS)
        deck = np.stack([np.broadcast_to(p[:, None], (len(x), ACROSS)) for p in edge.T], axis=-1).copy()
        deck[..., 1] *= share_across
        deck[..., 2] += 0.02 * self._beam * (1.0 - share_across**2)  # camber
        # Beams give way: the deck sags between the frames that hold it.
        sag = np.interp(np.arange(first, last + 1), np.arange(0, FRAMES + 4, 4), self._draw("sag", FRAMES // 4 + 1))
        deck[..., 2] -= min(1.6 * self._decay, 0.6) * self._depth * (sag**2)[:, None] * (1.0 - share_across**2)
        u, v = (0.5 * (c[1:] + c[:-1]) for c in (x / self._length + 0.5, share_across))
        there = np.ones((len(u), len(v)), np.bool_)
        for after, fore, breadth in form.holds:
            there &= ~(((u > after) & (u < fore))[:, None] & (np.abs(v) < breadth))
        panels = self._draw("deck", FRAMES // 3, 3)[np.arange(first, last) // 3][
            :, np.arange(ACROSS - 1) * 3 // (ACROSS - 1)
        ]
        plates = self._draw("deck plates", FRAMES, ACROSS - 1)[first:last]
        there &= 0.8 * panels + 0.2 * plates > (self._decay - GONE[0]) / (GONE[1] - GONE[0])
        yield skin(deck, self._plate, there)

    def fittings(self) -> Iterator[Triangles]:
        """Ribs, beams, coamings, houses, masts, machines and rails."""
        makers = [self._coamings, self._houses, self._gear, self._masts, self._machines]
        if self._form.bulwark >= 0.0:  # not closed above
            makers = [self._ribs, self._beams, *makers, self._rails]
        for make in makers:
            yield from make()

    def _ribs(self) -> Iterator[Triangles]:
        """Ribs along the inside of both sides; some have fallen."""
        count = int(np.clip(self._length / (0.9 if self._wreck.timber else 1.4), 9, 26))
        x = np.linspace(-0.46, 0.45, count) * self._length
        thick = (0.022 if self._wreck.timber else 0.012) * self._beam
        level = np.array([0.02, 0.2, 0.55, 1.0])
        points = self._points(x, level, self._plate + thick)
        for hand, drawn in zip((1.0, -1.0), self._draw("ribs", 2, count)):
            for rib, fate in zip(points * np.array([1.0, hand, 1.0]), drawn):
                if fate < 0.6 * self._decay**2:
                    continue
                top = max(1.0 - 0.9 * self._decay * (1.0 - fate), 0.3)
                rib[-1] = rib[-2] + top * (rib[-1] - rib[-2])
                yield bars(rib[:-1], rib[1:], thick)

    def _beams(self) -> Iterator[Triangles]:
        """Beams across under the deck, thwarts of an open boat; some hang."""
        is_open = self._form.bulwark >= 1.0
        count = 4 if is_open else 12
        x = np.linspace(-0.34, 0.36, count) * self._length
        ends = self._points(x, np.array([0.7 if is_open else 1.0 - 1.2 * self._form.bulwark]), self._plate)[:, 0]
        drawn = self._draw("beams", count, 3)
        stay = drawn[:, 0] > 1.1 * self._decay**1.5
        sag = self._decay * (drawn[:, 1:] - 0.3) * 0.5 * self._depth
        port, starboard = ends.copy(), ends * np.array([1.0, -1.0, 1.0])
        port[:, 2] -= np.maximum(sag[:, 0], 0.0)
        starboard[:, 2] -= np.maximum(sag[:, 1], 0.0)
        yield bars(port[stay], starboard[stay], (0.05 if is_open else 0.016) * self._beam)

    def _coamings(self) -> Iterator[Triangles]:
        """Frames about the hatches."""
        for number, (after, fore, breadth) in enumerate(self._form.holds):
            if self._draw("coamings", 9)[number] < self._decay - 0.25:
                continue
            ends = np.array([after, fore, 0.5 * (after + fore)]) - 0.5
            deck = self._points(self._length * ends, np.array([1.0 - self._form.bulwark]))[:, 0]
            half, thick, high = breadth * float(deck[:2, 1].min()), 1.5 * self._plate, 0.09 * self._depth
            long, z = self._length * (fore - after), float(deck[2, 2]) + 0.02 * self._beam
            middle = float(deck[2, 0])
            yield blocks([[middle, hand * half, z] for hand in (-1, 1)], [long, thick, high])
            yield blocks([[middle + hand * 0.5 * long, 0.0, z] for hand in (-1, 1)], [thick, 2.0 * half, high])

    def _houses(self) -> Iterator[Triangles]:
        """Walls with windows and roofs of deckhouses, which lean, lose their plates and fall in; funnels."""
        turn = 2.0 * np.pi * (np.arange(WALLS + 1) / WALLS + 0.5 / WALLS)
        for number, (station, foot, long, broad, high) in enumerate(self._form.houses):
            drawn = self._draw(f"house {number}", 8)
            if drawn[0] < 1.6 * self._decay - 0.5:
                continue
            # Sections between an ellipse and a box, rounder in front.
            power = 0.25 + 0.35 * drawn[1] * (np.cos(turn) > 0.0)
            x, y = (np.sign(f(turn)) * np.abs(f(turn)) ** power for f in (np.cos, np.sin))
            level = np.array([0.0, 0.5, 0.8, 1.0])
            size = np.array([long * self._length, broad * self._beam, high * self._depth * (1.0 - 0.6 * self._decay)])
            lean = (drawn[2:4] - 0.5) * self._decay * size[2]
            narrow = 1.0 - 0.12 * drawn[4] * level[:, None]
            up = np.broadcast_to(level[:, None], (len(level), WALLS + 1))
            flat = 0.5 * narrow[..., None] * np.stack([size[0] * x, size[1] * y], axis=-1) + up[..., None] * lean
            walls = np.concatenate([flat, size[2] * up[..., None]], axis=-1)
            walls += [(station - 0.5) * self._length, 0.0, (foot - 0.04) * self._depth]
            stay = self._draw(f"walls {number}", 3, WALLS) > 0.8 * self._decay
            stay[1] &= (np.arange(WALLS) + number) % 2 == 0  # windows
            thick = 1.2 * self._plate
            yield skin(walls[::-1], thick, stay[::-1])
            top = walls[-1, :-1]
            roof = np.stack([top[: WALLS // 2], top[: WALLS // 2 - 1 : -1]], axis=0)
            kept = self._draw(f"roof {number}", 1, WALLS // 2 - 1) > self._decay
            yield skin(roof + 0.05 * (roof - roof.mean(axis=(0, 1))) * [1.0, 1.0, 0.0], thick, kept)
        for number, (station, tall, radius) in enumerate(self._form.funnels):
            if self._draw("funnels", 9)[number] > 1.5 * self._decay:
                foot_at = np.array([(station - 0.5) * self._length, 0.0, 0.9 * self._depth])
                up = np.array([-0.1 * tall * self._depth, 0.0, tall * self._depth])
                yield bars(foot_at, foot_at + up, radius * self._beam, 10)

    def _gear(self) -> Iterator[Triangles]:
        """Winches, bollards, boats and cargo on deck; they drop into the hull as the deck goes."""
        if not 0.0 < self._form.bulwark < 1.0:
            return
        drawn = self._draw("gear", GEAR, 7)
        at, across = 0.08 + 0.84 * drawn[:, 0], 1.4 * (drawn[:, 1] - 0.5)
        edge = self._points((at - 0.5) * self._length, np.array([1.0 - self._form.bulwark]))[:, 0]
        dropped = np.where(drawn[:, 2] < self._decay, 0.7 * drawn[:, 3] + 0.2, 0.0)
        place = np.stack([edge[:, 0], across * edge[:, 1], edge[:, 2] * (1.0 - dropped)], axis=1)
        size = self._beam * np.stack(
            [0.04 + 0.16 * drawn[:, 4] ** 2, 0.03 + 0.1 * drawn[:, 5], 0.03 + 0.06 * drawn[:, 6]]
        )
        round_ones = drawn[:, 6] < 0.4
        half = np.zeros((GEAR, 3))
        half[:, 1] = size[1]
        ends = place - half, place + half
        yield bars(ends[0][round_ones], ends[1][round_ones], size[2][round_ones], 8)
        yield blocks(place[~round_ones], size.T[~round_ones], drawn[~round_ones, 4:] * [90.0, 20.0, 20.0])

    def _masts(self) -> Iterator[Triangles]:
        """Masts with their booms, which stand or have fallen across the deck."""
        for number, (station, high, radius) in enumerate(self._form.masts):
            drawn = self._draw(f"mast {number}", 4)
            foot = np.array([(station - 0.5) * self._length, 0.0, 0.8 * self._depth])
            tall, thick = high * self._length, radius * self._beam
            if drawn[0] > 1.2 * self._decay:
                lean = 0.5 * self._decay * (drawn[1:3] - 0.5)
                head = foot + tall * np.array([lean[0], lean[1], 1.0])
                boom = foot + np.array([-min(0.3 * tall, foot[0] + 0.45 * self._length), 0.0, 0.1 * tall])
                yield bars([foot], [head], thick, 8, 0.6)
                root, cross, yard = tall * np.array([[0.0, 0.0, 0.1], [0.0, 0.0, -0.3], [0.0, 0.12, 0.0]])
                yield bars([foot + root, head + cross - yard], [boom, head + cross + yard], 0.5 * thick)
            elif drawn[0] > 0.35 * self._decay:
                angle = 2.0 * np.pi * drawn[1]
                along = np.array([0.5 * np.cos(angle), np.sin(angle), 0.1 - 0.3 * self._decay])
                yield bars([foot], [foot + 0.8 * tall * along], thick, 8, 0.6)

    def _machines(self) -> Iterator[Triangles]:
        """Boilers and engines, which outlast the hull; their tops stand below the deck."""
        for station, long, radius in self._form.machines:
            middle = np.array([(station - 0.5) * self._length, 0.0, (radius + 0.05) * self._beam])
            half = np.array([0.5 * long * self._length, 0.0, 0.0])
            yield bars([middle - half], [middle + half], radius * self._beam, 12)

    def _rails(self) -> Iterator[Triangles]:
        """Thick rims of the sides and, above them, rails on stanchions, in stretches that are left."""
        x = self._x[1:-1]
        rim = self._points(x, np.array([1.0]), 0.8 * self._plate)[:, 0]
        for hand, drawn in zip((1.0, -1.0), self._draw("rails", 2, FRAMES // 3)):
            line = rim * np.array([1.0, hand, 1.0])
            stay = drawn[np.arange(len(x) - 1) // 3] > 0.2 + 1.3 * self._decay
            up = np.array([0.0, 0.0, 0.0 if self._form.bulwark >= 1.0 else 0.12 * self._depth])
            yield bars(line[:-1][stay] + up, line[1:][stay] + up, 0.8 * self._plate)
            if up[2]:
                yield bars(line[:-1][stay], line[:-1][stay] + up, 0.6 * self._plate)
