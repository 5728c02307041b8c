"""Sunken aircraft, made from the plans of their wings."""

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import metres, parameter, share
from insonify.scene.targets.parts import Triangles, bars, draw_shares, skin, tube
from insonify.scene.targets.sunken import Sunken

ALONG, AROUND, SPANWISE, CHORDWISE = 18, 10, 10, 4  # plates of a body along and about it, and of half a wing
WAVES = 6  # of the field that crumples
CRUMPLE = 0.05  # of the length, by which that field moves a corner, rms
THIN = 0.004  # thickness of a plate over the length
SPARS = (0.15, 0.6)  # places of the spars, as shares of the chord
# Radius of a body over the largest, at equal steps from the nose to the tail.
BODY = (0.12, 0.62, 0.86, 0.97, 1.0, 1.0, 0.96, 0.86, 0.72, 0.58, 0.44, 0.32, 0.2)
NACELLE = (0.5, 1.0, 1.0, 0.85, 0.45, 0.1)
SHARES = (0.0, 0.35, 0.7, 0.92, 1.0)  # of the half span, at which plans are given


class Plan(NamedTuple):
    """A plan of the wings: curves at `SHARES` of the half span."""

    span: float  # over the length
    chord: tuple[float, ...]  # over the length
    lead: tuple[float, ...]  # leading edge behind the nose, over the length
    rise: tuple[float, ...]  # height over the length
    body: float = 0.055  # largest radius of the body over the length
    thickness: float = 0.13  # of the wing over its chord


FLAT = (0.0, 0.01, 0.025, 0.035, 0.04)
PLANS = {
    "straight": Plan(1.35, (0.2, 0.2, 0.2, 0.19, 0.12), (0.22, 0.22, 0.22, 0.225, 0.25), FLAT),
    "tapered": Plan(1.4, (0.25, 0.2, 0.145, 0.11, 0.05), (0.22, 0.235, 0.255, 0.27, 0.3), FLAT),
    "elliptic": Plan(1.2, (0.28, 0.265, 0.2, 0.11, 0.02), (0.22, 0.225, 0.25, 0.29, 0.335), FLAT),
    "cranked": Plan(
        1.3, (0.26, 0.26, 0.18, 0.13, 0.06), (0.2, 0.2, 0.235, 0.26, 0.29), (0.0, -0.05, 0.0, 0.03, 0.04)
    ),
    "swept": Plan(0.95, (0.25, 0.2, 0.14, 0.11, 0.06), (0.28, 0.39, 0.5, 0.57, 0.61), (0.0,) * 5, 0.06, 0.08),
    "delta": Plan(0.7, (0.58, 0.39, 0.19, 0.07, 0.02), (0.3, 0.48, 0.68, 0.8, 0.85), (0.0,) * 5, 0.055, 0.06),
}  # fmt: skip
PlanName = Literal["straight", "tapered", "elliptic", "cranked", "swept", "delta"]
TailName = Literal["single", "twin", "high"]


class Aircraft(Sunken, kind="aircraft", rank=7):
    """An aircraft that has sunk: whole, crumpled, stripped to its frames, or broken into body, tail and wings."""

    plan: PlanName = parameter("tapered", "plan of the wings")
    length: float = metres(12.0, "from the nose to the tail", (6.0, 40.0), least=1.0, most=100.0)
    span: float | None = parameter(None, "from tip to tip; that of its plan when left out", "m", gt=0.0, le=100.0)
    engines: int = parameter(1, "number of engines; an odd one is in the nose, the others on the wings", ge=0, le=8)
    tail: TailName = parameter("single", "one fin, two at the tips of the tailplane, or a tailplane on top of the fin")
    porosity: float = share(0.2, "share of the skin that is missing, so that frames and spars show")
    crumpled: float = share(0.1, "deformation by the impact: 0 none, 1 flattened")

    @property
    def scattered(self) -> float:
        """Debris of an impact."""
        return min(0.15 * self.crumpled + 0.35 * self.broken, 1.0)

    @property
    def breadth(self) -> float:
        """Span of the wings, in metres."""
        return self.length * PLANS[self.plan].span if self.span is None else self.span

    def value_in_force(self, field: str, frequency: float | None = None) -> float | None:
        """Return the span of the plan where it is left out."""
        return self.breadth if field == "span" else None

    def pieces(self) -> list[Triangles]:
        """Return body, tail, and the port and starboard wings with their engines."""
        plan = PLANS[self.plan]
        cut = ALONG * 2 // 3
        forward, aft = self._body(0, cut), self._body(cut, ALONG)
        wings = [[*self._surface(hand, plan.chord, plan.lead, plan.rise, self.breadth)] for hand in (1.0, -1.0)]
        for number in range(self.engines // 2 * 2):
            wings[number % 2] += [*self._nacelle((1.0, -1.0)[number % 2], 0.27 + 0.21 * (number // 2))]
        if self.engines % 2:
            nose = np.array([0.5 * self.length, 0.0, self._middle])
            forward.append(bars([nose], [nose - [0.1 * self.length, 0.0, 0.0]], 0.9 * self._radius, 10))
            forward += self._propeller(nose)
        groups = (forward, [*aft, *self._tail()], *wings)
        bent = [self._crumple(np.concatenate(group)) for group in groups]
        low = min(float(piece[..., 2].min()) for piece in bent)
        return [piece - np.array([0.0, 0.0, low]) for piece in bent]

    @property
    def _radius(self) -> float:
        return PLANS[self.plan].body * self.length

    @property
    def _middle(self) -> float:
        """Height of the axis of the body above its underside."""
        return 1.15 * self._radius

    def _body(self, first: int, last: int) -> list[Triangles]:
        """Skin, frames and stringers of a stretch of the body."""
        x = np.linspace(0.5, -0.5, ALONG + 1)[first : last + 1]
        radius = self._radius * np.interp(0.5 - x, np.linspace(0.0, 1.0, len(BODY)), BODY)
        lift = 0.5 * self._radius * np.maximum(-x, 0.0)  # the underside rises to the tail
        middles = np.stack([x * self.length, 0.0 * x, self._middle + lift], axis=1)
        grid = tube(middles, radius, AROUND, 1.15)[::-1]
        there = self._stays(f"body {first}", last - first, AROUND)
        return [skin(grid, THIN * self.length, there), *self._lattice(grid, (1, 3, 6, 8))]

    def _stays(self, name: str, *shape: int) -> np.ndarray:
        """Which plates of the skin are left; neighbours are lost together."""
        rows, columns = shape
        patches = draw_shares(self.seed, name, -(-rows // 2), -(-columns // 2)).repeat(2, 0).repeat(2, 1)
        plates = draw_shares(self.seed, f"{name} plates", rows, columns)
        return np.asarray(0.6 * patches[:rows, :columns] + 0.4 * plates > 1.02 * self.porosity)

    def _lattice(self, grid: Floats, lines: tuple[int, ...]) -> Iterator[Triangles]:
        """Bars across at every second station of a grid and along some of its lines, where skin may be gone."""
        if self.porosity > 0.0:
            frames = grid[::2]
            thick = 1.2 * THIN * self.length
            yield bars(frames[:, :-1].reshape(-1, 3), frames[:, 1:].reshape(-1, 3), thick)
            for line in lines:
                yield bars(grid[:-1, line], grid[1:, line], thick)

    def _surface(
        self, hand: float, chord: tuple[float, ...], lead: tuple[float, ...], rise: tuple[float, ...], span: float
    ) -> Iterator[Triangles]:
        """One wing: skin above and below, ribs and spars."""
        s = np.linspace(0.0, 1.0, SPANWISE + 1)
        c, x, z = (self.length * np.interp(s, SHARES, values) for values in (chord, lead, rise))
        across = np.linspace(1.0, 0.0, CHORDWISE + 1)  # from the trailing edge forward
        thick = PLANS[self.plan].thickness * 2.9 * (np.sqrt(across) - across) * 0.8  # half of it, over the chord
        y = 0.5 * hand * span * s
        places = [np.broadcast_to(v, (SPANWISE + 1, CHORDWISE + 1)) for v in (0.0, y[:, None], 0.0)]
        flat = np.stack(places, axis=-1).copy()
        flat[..., 0] = 0.5 * self.length - x[:, None] - c[:, None] * across
        flat[..., 2] = self._middle - 0.3 * self._radius + z[:, None]
        for side in (1.0, -1.0):
            grid = flat.copy()
            grid[..., 2] += 0.5 * side * c[:, None] * thick
            # Rows forward, columns outwards to port: the normal of the upper side points up.
            grid = grid.swapaxes(0, 1)
            if hand * side < 0.0:
                grid = grid[:, ::-1]
            there = self._stays(f"wing {hand:g} {side:g} {span:g}", CHORDWISE, SPANWISE)
            yield skin(grid, 0.5 * THIN * self.length, there)
        yield from self._lattice(flat, tuple(round(CHORDWISE * (1.0 - place)) for place in SPARS))

    def _nacelle(self, hand: float, place: float) -> Iterator[Triangles]:
        """Engine on a wing, with its propeller."""
        plan = PLANS[self.plan]
        lead, rise = (self.length * float(np.interp(place, SHARES, values)) for values in (plan.lead, plan.rise))
        nose = np.array([0.5 * self.length - lead + 0.1 * self.length, 0.5 * hand * place * self.breadth, 0.0])
        nose[2] = self._middle - 0.3 * self._radius + rise
        x = np.linspace(0.0, 0.26 * self.length, len(NACELLE))
        middles = nose - np.stack([x, 0.0 * x, 0.0 * x], axis=1)
        yield skin(tube(middles, 0.6 * self._radius * np.array(NACELLE), 8)[::-1], THIN * self.length)
        yield bars([nose], [middles[2]], 0.5 * self._radius, 8)
        yield from self._propeller(nose)

    def _propeller(self, hub: Floats) -> Iterator[Triangles]:
        """Three blades, some bent backwards."""
        if PLANS[self.plan].thickness < 0.1:  # swept wings and deltas are of jets
            return
        angle = 2.0 * np.pi * (np.arange(3) / 3.0 + draw_shares(self.seed, "propeller", 1)[0])
        back = -0.4 * draw_shares(self.seed, f"blades {hub[1]:.1f}", 3)
        hub = hub - np.array([0.01 * self.length, 0.0, 0.0])
        tips = 0.13 * self.length * np.stack([back, np.sin(angle), np.cos(angle)], axis=1)
        yield bars(np.repeat(hub[None], 3, 0), hub + tips, 0.008 * self.length)

    def _tail(self) -> Iterator[Triangles]:
        """Tailplane and fins."""
        foot = self._middle + 0.25 * self._radius
        high = 0.16 * self.length
        top = high if self.tail == "high" else 0.0
        wide = 0.24 * self.length / 0.62 if PLANS[self.plan].lead[-1] > 0.8 else 0.38 * self.length
        for hand in (1.0, -1.0):
            for part in self._surface(hand, (0.13, 0.12, 0.1, 0.08, 0.05), (0.86, 0.87, 0.89, 0.9, 0.92), FLAT, wide):
                yield part + np.array([0.0, 0.0, foot + top - self._middle + 0.3 * self._radius])
        for place in (0.5 * wide, -0.5 * wide) if self.tail == "twin" else (0.0,):
            x = np.array([0.5, 0.5, 0.5]) - [0.86, 0.9, 0.93]
            chord, z = np.array([0.14, 0.1, 0.07]), np.array([0.0, 0.6, 1.0]) * high + foot - self._radius * 0.3
            grid = np.stack([np.stack([(x - chord) * self.length, 0 * x + place, z], 1),
                             np.stack([x * self.length, 0 * x + place, z], 1)])  # fmt: skip
            yield skin(grid, 2.0 * THIN * self.length)

    def _crumple(self, piece: Triangles) -> Triangles:
        """Bend by a field of long waves and flatten."""
        if self.crumpled == 0.0:
            return piece
        drawn = draw_shares(self.seed, "crumple", WAVES, 9)
        waves = 2.0 * np.pi * (drawn[:, :3] - 0.5) * np.array([6.0, 6.0, 3.0]) / self.length
        phases = np.tensordot(piece, waves, axes=([2], [1])) + 2.0 * np.pi * drawn[:, 3]
        field = np.tensordot(np.sin(phases), drawn[:, 4:7] - 0.5, axes=1) * np.sqrt(24.0 / WAVES)
        bent = piece + CRUMPLE * self.crumpled * self.length * field
        return np.asarray(bent * np.array([1.0, 1.0, 1.0 - 0.55 * self.crumpled]))
