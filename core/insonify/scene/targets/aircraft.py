"""Sunken aircraft, made from the published dimensions of their types."""

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np

from insonify.arrays import Booleans, Floats
from insonify.scene.base import parameter, share
from insonify.scene.targets.parts import Triangles, bars, blocks, draw_shares, skin, tube
from insonify.scene.targets.shape import rotation_matrix
from insonify.scene.targets.sunken import Sunken

ALONG, AROUND, SPANWISE, CHORDWISE = 18, 10, 9, 4  # plates of a body along and about it, and of half a wing
THIN = 0.004  # thickness of a plate over the length
SPARS = (1, 3)  # lines of a wing's grid, from the trailing edge, along which spars run
DENT, FLAT = 0.5, 0.6  # of the radius of the body, by which its plates are dented at most; of its height that is lost
HINGED = np.array([16.0, 8.0, 14.0])  # °, by which an impact turns wings and tail at their joints, at most
MISSING = 0.4  # chance of a piece to lie elsewhere, over `broken`
SPINNER = 0.02  # of the length, by which the hub of a propeller stands before its engine
SQUASH, THICK = 1.1, 0.14  # height of a body over its width; thickness of a wing over its chord
PARASOL = 1.5  # level of a wing from which on it stands on a pylon
DROOP = 0.06  # slope of the blades of a rotor
JOINT = 2 / 3  # of the length of the body, where the tail breaks off
# Radius of a body over the largest, at equal steps from the nose to the tail.
BODIES = {
    "slim": (0.14, 0.5, 0.7, 0.84, 0.95, 1.0, 0.97, 0.86, 0.72, 0.57, 0.43, 0.3, 0.12),
    "stout": (0.55, 0.97, 1.0, 1.0, 1.0, 0.97, 0.91, 0.81, 0.68, 0.54, 0.4, 0.27, 0.1),
    "bomber": (0.3, 0.78, 0.94, 1.0, 1.0, 1.0, 0.98, 0.92, 0.83, 0.72, 0.6, 0.46, 0.28),
    "liner": (0.22, 0.8, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.95, 0.8, 0.6, 0.38, 0.14),
    "jet": (0.5, 0.7, 0.85, 0.95, 1.0, 1.0, 1.0, 0.98, 0.95, 0.89, 0.82, 0.74, 0.62),
    "dart": (0.05, 0.3, 0.55, 0.8, 0.95, 1.0, 1.0, 1.0, 0.98, 0.95, 0.9, 0.85, 0.72),
    "pod": (0.3, 0.75, 0.97, 1.0, 1.0, 0.93, 0.62, 0.34, 0.26, 0.22, 0.19, 0.16, 0.12),
}
# Places of the cockpit, over the length.
COCKPITS = {"slim": (0.36, 0.54), "stout": (0.36, 0.58), "bomber": (0.13, 0.25), "liner": (0.05, 0.13),
            "jet": (0.2, 0.38), "dart": (0.22, 0.38), "pod": (0.1, 0.3)}  # fmt: skip
CANOPY = (0.2, 0.75, 1.0, 0.85, 0.55, 0.2)
NACELLE = (0.55, 1.0, 1.0, 0.9, 0.55, 0.1)
TailName = Literal["single", "twin", "high"]


class Surface(NamedTuple):
    """Half of a wing or of a tailplane, in metres and degrees."""

    lead: float  # of the leading edge at the root, behind the nose
    chord: float  # at the root
    taper: float  # chord at the tip over that at the root
    sweep: float  # of the leading edge
    rise: tuple[float, float]  # dihedral of the inner and the outer part
    crank: float  # share of the half span at which the outer part begins
    round: float  # share of the half span over which the tip is rounded
    half: float = 1.0  # half the span for which the sweep holds

    def scaled(self, scale: float, half: float) -> "Surface":
        """Surface of another size."""
        return self._replace(lead=scale * self.lead, chord=scale * self.chord, half=scale * half)

    def at(self, s: Floats) -> tuple[Floats, Floats, Floats]:
        """Leading edge, m, chord, m, and height over the half span, at shares of the half span."""
        tip = np.maximum(s - 1.0 + self.round, 0.0) / self.round
        straight = self.chord * (1.0 - (1.0 - self.taper) * s)
        chord = straight * np.maximum(np.sqrt(np.maximum(1.0 - tip**2, 0.0)), 0.05)
        lead = self.lead + self.half * s * np.tan(np.radians(self.sweep)) + 0.35 * (straight - chord)
        inner, outer = np.tan(np.radians(self.rise))
        return lead, chord, inner * np.minimum(s, self.crank) + outer * np.maximum(s - self.crank, 0.0)


class Plan(NamedTuple):
    """Dimensions of a type, in metres and degrees: published ones, and shapes as its three-view drawings show them."""

    span: float  # of a helicopter: diameter of the rotor
    length: float  # of a helicopter: without the rotor
    height: float  # on its wheels
    engines: int
    body: str  # form of the body
    width: float  # of the body
    nose: float  # from the nose to the leading edge at the root
    chord: float  # of the wing at the root
    taper: float  # chord at the tip over that at the root
    sweep: float = 0.0  # of the leading edge
    rise: tuple[float, float] = (5.0, 5.0)  # dihedral of the inner and the outer wing
    crank: float = 0.3  # share of the half span at which the outer wing begins
    level: float = -0.6  # of the wing's root above the axis of the body, over half the width
    tail: TailName = "single"
    tailplane: float = 0.34  # its span over that of the wings
    round: float = 0.12  # share of the half span over which the tip is rounded
    propeller: float = 3.0  # diameter; 0 of a jet
    nacelle: float = 0.6  # radius of an engine on the wing
    at: tuple[float, float] = (0.27, 0.5)  # shares of the half span at which engines are
    gap: float = 0.0  # between the wings of a biplane


# Plans without a type, and types by their published dimensions.
PLANS = {
    "straight": Plan(16.2, 12.0, 4.2, 1, "bomber", 1.3, 2.6, 2.4, 0.75),
    "tapered": Plan(16.8, 12.0, 4.2, 1, "bomber", 1.3, 2.6, 3.0, 0.35, 5.0, (2.0, 6.0)),
    "elliptic": Plan(14.4, 12.0, 4.2, 1, "slim", 1.3, 2.6, 3.4, 1.0, round=1.0),
    "cranked": Plan(15.6, 12.0, 4.2, 1, "stout", 1.3, 2.4, 3.1, 0.5, 2.0, (-12.0, 9.0)),
    "swept": Plan(11.4, 12.0, 4.0, 0, "jet", 1.4, 3.6, 2.9, 0.45, 37.0, (0.0, 0.0), propeller=0.0, level=0.0),
    "delta": Plan(8.4, 12.0, 4.0, 0, "dart", 1.3, 3.6, 7.0, 0.06, 58.0, (0.0, 0.0), propeller=0.0, tailplane=0.0),
    "spitfire": Plan(11.23, 9.12, 3.86, 1, "slim", 1.0, 2.3, 2.55, 1.0, 0.0, (6.0, 6.0), round=1.0, propeller=3.27),
    "bf-109": Plan(9.92, 8.95, 2.6, 1, "slim", 0.95, 2.3, 2.15, 0.5, 4.0, (6.5, 6.5)),
    "corsair": Plan(12.5, 10.16, 4.6, 1, "stout", 1.25, 2.5, 2.75, 0.65, 0.0, (-17.0, 8.5), 0.28, -0.8, propeller=4.0),
    "avenger": Plan(16.51, 12.48, 4.7, 1, "stout", 1.6, 3.4, 3.6, 0.45, 5.0, (0.0, 8.0), 0.3, 0.0, propeller=4.0),
    "stuka": Plan(13.8, 11.5, 3.9, 1, "slim", 1.15, 3.2, 3.0, 0.55, 3.0, (-12.0, 8.0), 0.25, propeller=3.4),
    "swordfish": Plan(13.87, 10.87, 3.76, 1, "stout", 1.2, 1.9, 1.9, 0.95, gap=2.0, rise=(2.0, 2.0), propeller=3.2),
    "tiger-moth": Plan(8.94, 7.29, 2.68, 1, "slim", 0.75, 1.2, 1.3, 1.0, 9.0, (3.0, 3.0), gap=1.4, propeller=2.0),
    "cessna-172": Plan(11.0, 8.28, 2.72, 1, "pod", 1.15, 2.0, 1.63, 0.7, 0.0, (1.7, 1.7), level=1.1, propeller=1.9),
    "ju-88": Plan(20.08, 14.36, 4.85, 2, "bomber", 1.4, 3.4, 4.1, 0.35, 7.0, (3.0, 6.0), nacelle=0.65, propeller=3.6),
    "b-25": Plan(20.6, 16.13, 4.98, 2, "bomber", 1.45, 5.0, 4.0, 0.4, 4.0, (4.5, -0.5), 0.32, 0.5, "twin", 0.32),
    "he-111": Plan(22.6, 16.4, 4.0, 2, "bomber", 1.7, 4.1, 5.6, 0.2, 12.0, (2.0, 7.0), 0.25, nacelle=0.7, round=0.25),
    "dakota": Plan(28.96, 19.43, 5.18, 2, "liner", 2.4, 4.9, 4.5, 0.28, 12.0, (0.0, 5.0), 0.2, nacelle=0.7,
                   at=(0.2, 0.0)),
    "catalina": Plan(31.7, 19.46, 6.15, 2, "bomber", 3.1, 4.2, 4.6, 0.5, 0.0, (0.0, 0.0), 0.4, 1.7, at=(0.17, 0.0)),
    "ju-52": Plan(29.25, 18.9, 5.55, 3, "liner", 1.9, 4.2, 5.0, 0.35, 11.0, (5.0, 5.0), round=0.03, at=(0.33, 0.0)),
    "b-17": Plan(31.62, 22.66, 5.82, 4, "bomber", 2.3, 5.6, 5.8, 0.4, 8.0, (4.5, 4.5), nacelle=0.75, at=(0.25, 0.47)),
    "liberator": Plan(33.53, 20.47, 5.49, 4, "bomber", 2.4, 5.6, 4.3, 0.4, 4.0, (3.0, 3.0), 0.3, 0.7, "twin", 0.24),
    "lancaster": Plan(31.09, 21.11, 6.25, 4, "bomber", 1.9, 5.6, 4.9, 0.45, 4.0, (0.0, 7.0), 0.2, 0.2, "twin", 0.33),
    "sunderland": Plan(34.39, 26.01, 9.79, 4, "bomber", 3.1, 6.6, 6.0, 0.35, 6.0, (3.0, 3.0), 0.3, 1.3, propeller=3.9),
    "mig-15": Plan(10.08, 10.1, 3.7, 0, "jet", 1.45, 2.8, 2.75, 0.7, 37.0, (-2.0, -2.0), level=0.0, tail="high",
                   propeller=0.0),
    "sabre": Plan(11.31, 11.45, 4.5, 0, "jet", 1.5, 3.6, 3.2, 0.5, 37.0, (3.0, 3.0), propeller=0.0),
    "skyhawk": Plan(8.38, 12.22, 4.57, 0, "jet", 1.5, 3.9, 4.7, 0.25, 41.0, (2.5, 2.5), propeller=0.0),
    "mirage": Plan(8.22, 15.03, 4.5, 0, "dart", 1.5, 5.7, 7.6, 0.05, 60.0, (-1.0, -1.0), propeller=0.0, tailplane=0.0),
    "boeing-737": Plan(28.35, 30.53, 11.23, 2, "liner", 3.76, 10.6, 6.6, 0.25, 29.0, (6.0, 6.0), tailplane=0.39,
                       propeller=0.0, nacelle=0.7, at=(0.33, 0.0)),
    "huey": Plan(14.63, 12.77, 4.41, 0, "pod", 2.3, 0.0, 0.53, 1.0, tailplane=0.2),
    "sea-king": Plan(18.9, 16.69, 4.72, 0, "liner", 2.2, 0.0, 0.46, 1.0, tailplane=0.15),
}  # fmt: skip
ROTORS = {"huey": 2, "sea-king": 5}  # number of blades of helicopters
PlanName = Literal[
    "straight", "tapered", "elliptic", "cranked", "swept", "delta", "spitfire", "bf-109", "corsair", "avenger", "stuka",
    "swordfish", "tiger-moth", "cessna-172", "ju-88", "b-25", "he-111", "dakota", "catalina", "ju-52", "b-17",
    "liberator", "lancaster", "sunderland", "mig-15", "sabre", "skyhawk", "mirage", "boeing-737", "huey", "sea-king",
]  # fmt: skip


LEFT_OUT = "; that of its type when left out"


class Aircraft(Sunken, kind="aircraft", rank=7):
    """An aircraft that has sunk: whole, dented, stripped to its frames, or broken at its joints."""

    plan: PlanName = parameter("tapered", "type, or plan of the wings of none")
    length: float | None = parameter(
        None, f"from the nose to the tail{LEFT_OUT}", "m", ge=1.0, le=100.0, slider=(6.0, 40.0), log=True
    )
    span: float | None = parameter(None, f"from tip to tip{LEFT_OUT}", "m", gt=0.0, le=100.0)
    engines: int | None = parameter(
        None, f"number of engines; an odd one is in the nose, the others on the wings{LEFT_OUT}", ge=0, le=8
    )
    tail: TailName | None = parameter(
        None, f"one fin, two at the tips of the tailplane, or a tailplane on top of the fin{LEFT_OUT}"
    )
    porosity: float = share(0.2, "share of the skin that is missing, so that frames and spars show")
    crumpled: float = share(0.1, "deformation by the impact: 0 none, 1 flattened, wings and tail bent at their joints")

    @property
    def scattered(self) -> float:
        """Debris of an impact."""
        return min(0.15 * self.crumpled + 0.35 * self.broken, 1.0)

    @property
    def scale(self) -> float:
        """Size over that of the type."""
        return 1.0 if self.length is None else self.length / PLANS[self.plan].length

    @property
    def overall_length(self) -> float:
        """From the nose to the tail, in metres."""
        return self.scale * PLANS[self.plan].length

    @property
    def breadth(self) -> float:
        """Span of the wings, in metres."""
        return self.scale * PLANS[self.plan].span if self.span is None else self.span

    def value_in_force(self, field: str, frequency: float | None = None) -> float | None:
        """Return the dimensions and engines of the type where they are left out."""
        whole = {"length": self.overall_length, "span": self.breadth, "engines": PLANS[self.plan].engines}
        return whole.get(field)

    def pieces(self) -> list[Triangles]:
        """Return the body, and what breaks off at its joints: tail, wings, engines."""
        return _Airframe(self).pieces()


class _Airframe:
    """Surfaces and parts of an aircraft, in metres, the axis of its body at z = 0."""

    def __init__(self, aircraft: Aircraft) -> None:
        plan = PLANS[aircraft.plan]
        self._aircraft, self._plan, self._scale = aircraft, plan, aircraft.scale
        self._length, self._half_span = aircraft.overall_length, 0.5 * aircraft.breadth
        self._radius, self._level = 0.5 * self._scale * plan.width, 0.5 * self._scale * plan.width * plan.level
        self._engines = plan.engines if aircraft.engines is None else aircraft.engines
        self._thin = THIN * self._length
        self._in_nose, self._has_canopy = self._engines % 2, self._draw("canopy", 1)[0] < 0.6
        # Without its wheels an aircraft is lower by about a fifth.
        self._top = 0.8 * self._scale * plan.height - 1.1 * self._radius

    def _draw(self, name: str, *shape: int) -> Floats:
        return draw_shares(self._aircraft.seed, name, *shape)

    def pieces(self) -> list[Triangles]:
        """Body, tail, wings and engines; those that lie elsewhere are left out."""
        cut = round(JOINT * ALONG)
        body, tail = [*self._body(0, cut)], [*self._body(cut, ALONG), *self._tail()]
        groups = [body, tail]
        if self._aircraft.plan in ROTORS:
            groups.append([*self._rotor()])
        else:
            groups += [[*self._wings(hand)] for hand in (1.0, -1.0)]
            for number in range(self._engines // 2 * 2):
                place = self._plan.at[min(number // 2, 1)] + 0.2 * max(number // 2 - 1, 0)
                nacelle, engine = self._nacelle((1.0, -1.0)[number % 2], min(place, 0.9))
                groups[2 + number % 2] += nacelle
                groups.append(engine)
        if self._in_nose:
            nose = np.array([(0.5 - SPINNER) * self._length, 0.0, 0.0])
            body += self._propeller(nose, 0.35 * self._radius * BODIES[self._plan.body][0] + 0.1 * self._radius)
        gone = self._draw("gone", 16) < MISSING * self._aircraft.broken
        bent = [
            self._bend(number, np.concatenate(group))
            for number, group in enumerate(groups)
            if number == 0 or not gone[number]
        ]
        low = min(float(piece[..., 2].min()) for piece in bent)
        return [piece - np.array([0.0, 0.0, low]) for piece in bent]

    def _bend(self, number: int, piece: Triangles) -> Triangles:
        """Flatten a piece, and turn all but the body at the joint to it."""
        crumpled = self._aircraft.crumpled
        flat = piece * np.array([1.0, 1.0, 1.0 - FLAT * crumpled**2])
        if number == 0 or crumpled == 0.0:
            return flat
        joint = np.array([(0.5 - JOINT) * self._length if number == 1 else float(flat[..., 0].mean()), 0.0, 0.0])
        # Most impacts leave most joints straight.
        turn = (2.0 * self._draw(f"bent {number}", 3) - 1.0) ** 3 * HINGED * crumpled
        return np.asarray((flat - joint) @ rotation_matrix(*turn).T + joint)

    def _body(self, first: int, last: int) -> Iterator[Triangles]:
        """Skin, dented, with frames and stringers, of a stretch of the body."""
        along = np.linspace(SPINNER * self._in_nose, 1.0, ALONG + 1)[first : last + 1]
        form = BODIES[self._plan.body]
        radius = self._radius * np.interp(along, np.linspace(0.0, 1.0, len(form)), form)
        # The upper line is nearly straight towards the tail, the underside rises.
        lift = 0.75 * (self._radius - radius) * (along > 0.4)
        middles = np.stack([(0.5 - along) * self._length, 0.0 * along, lift], axis=1)
        grid = tube(middles, radius, AROUND, SQUASH)
        struck = self._draw(f"dents {first}", last - first + 1, AROUND) ** 3 * DENT * self._aircraft.crumpled
        grid += np.pad(struck, ((0, 0), (0, 1)), mode="wrap")[..., None] * (middles[:, None] - grid)
        there = self._stays(f"body {first}", last - first, AROUND)
        begin, end = COCKPITS[self._plan.body]
        if not self._has_canopy:
            open_to_sea = (along[1:] > begin) & (along[:-1] < end)
            there[open_to_sea, AROUND // 2 - 1 : AROUND // 2 + 1] = False
        yield skin(grid[::-1], self._thin, there[::-1])
        yield from self._lattice(grid, (1, 3, 6, 8))
        if self._has_canopy and first == 0:
            x = np.linspace(begin, end, len(CANOPY))
            round_of = 0.55 * self._radius * np.array(CANOPY)
            top = np.interp(x, along, middles[:, 2] + 0.85 * SQUASH * radius)
            yield skin(tube(np.stack([(0.5 - x) * self._length, 0.0 * x, top], 1), round_of, 8)[::-1], self._thin)

    def _stays(self, name: str, rows: int, columns: int) -> Booleans:
        """Which plates of the skin are left; neighbours are lost together."""
        patches = self._draw(name, -(-rows // 2), -(-columns // 2)).repeat(2, 0).repeat(2, 1)
        plates = self._draw(f"{name} plates", rows, columns)
        return np.asarray(0.6 * patches[:rows, :columns] + 0.4 * plates > 1.02 * self._aircraft.porosity)

    def _lattice(self, grid: Floats, lines: tuple[int, ...]) -> Iterator[Triangles]:
        """Bars across at every second station of a grid and along some of its lines, where skin may be gone."""
        if self._aircraft.porosity > 0.0:
            frames = grid[::2]
            thick = 1.2 * self._thin
            yield bars(frames[:, :-1].reshape(-1, 3), frames[:, 1:].reshape(-1, 3), thick)
            for line in lines:
                yield bars(grid[:-1, line], grid[1:, line], thick)

    def _wings(self, hand: float) -> Iterator[Triangles]:
        """Wing of one side; two with their struts of a biplane."""
        plan = self._plan
        wing = Surface(plan.nose, plan.chord, plan.taper, plan.sweep, plan.rise, plan.crank, plan.round)
        wing = wing.scaled(self._scale, 0.5 * plan.span)
        yield from self._surface(f"wing {hand:g}", hand, self._half_span, wing, self._level)
        if plan.gap:
            gap = self._scale * plan.gap
            upper = wing._replace(lead=wing.lead - 0.15 * gap)
            yield from self._surface(f"upper {hand:g}", hand, self._half_span, upper, self._level + gap)
            places = np.array([[0.1, 0.3], [0.1, 0.6], [0.7, 0.2], [0.7, 0.7]])  # shares of half span and chord
            feet = np.stack([0.5 * self._length - wing.lead - places[:, 1] * wing.chord,
                             hand * places[:, 0] * self._half_span, np.full(4, self._level)], axis=1)  # fmt: skip
            yield bars(feet, feet + np.array([0.15 * gap, 0.0, gap]), 0.04 * self._scale)
        elif plan.level > PARASOL and hand > 0.0:
            middle = [0.5 * self._length - wing.lead - 0.4 * wing.chord, 0.0, 0.5 * self._level]
            yield blocks([middle], [0.5 * wing.chord, 0.4 * self._radius, self._level])

    def _surface(self, name: str, hand: float, half: float, wing: Surface, height: float) -> Iterator[Triangles]:
        """Half a wing or tailplane: skin above and below, ribs and spars."""
        s = 1.0 - (1.0 - np.linspace(0.0, 1.0, SPANWISE + 1)) ** 1.5  # closer at the tip, which is round
        lead, chord, rise = wing.at(s)
        across = (
            np.linspace(1.0, 0.0, CHORDWISE + 1) ** 1.4
        )  # from the trailing edge forward, closer at the leading one
        thick = THICK * 2.3 * (np.sqrt(across) - across)  # half of it, over the chord
        flat = np.zeros((SPANWISE + 1, CHORDWISE + 1, 3))
        flat[..., 0] = 0.5 * self._length - lead[:, None] - chord[:, None] * across
        flat[..., 1] = hand * half * s[:, None]
        flat[..., 2] = height + half * rise[:, None]
        for side in (1.0, -1.0):
            grid = flat.copy()
            grid[..., 2] += 0.5 * side * chord[:, None] * thick
            # Rows forward, columns outwards to port: the normal of the upper side points up.
            grid = grid.swapaxes(0, 1)
            if hand * side < 0.0:
                grid = grid[:, ::-1]
            yield skin(grid, 0.5 * self._thin, self._stays(f"{name} {side:g}", CHORDWISE, SPANWISE))
        yield from self._lattice(flat, SPARS)

    def _nacelle(self, hand: float, place: float) -> tuple[list[Triangles], list[Triangles]]:
        """Nacelle of an engine on the wing, and the engine before it, with its propeller."""
        plan, scale = self._plan, self._scale
        wing = Surface(plan.nose, plan.chord, plan.taper, plan.sweep, plan.rise, plan.crank, plan.round)
        lead, chord, rise = (float(v[0]) for v in wing.scaled(scale, 0.5 * plan.span).at(np.array([place])))
        radius, is_jet = scale * plan.nacelle, plan.propeller == 0.0
        drop = 1.3 * radius if is_jet else 0.2 * radius
        mount = np.array([0.5 * self._length - lead + 1.4 * radius, hand * place * self._half_span, 0.0])
        mount[2] = self._level + self._half_span * rise - drop
        x = np.linspace(0.0, 1.4 * radius + (0.25 if is_jet else 0.85) * chord, len(NACELLE))
        middles = mount - np.stack([x, 0.0 * x, 0.0 * x], axis=1)
        nacelle = skin(tube(middles, radius * np.array(NACELLE), 8)[::-1], self._thin)
        face = mount + np.array([1.1 * radius, 0.0, 0.0])
        return [nacelle], [bars([face], [mount], 0.95 * radius, 10), *self._propeller(face, 0.35 * radius)]

    def _propeller(self, face: Floats, hub: float) -> Iterator[Triangles]:
        """Hub and three blades, some bent backwards; none of a jet."""
        reach = 0.5 * self._scale * self._plan.propeller
        if reach == 0.0:
            return
        turn, *bent = self._draw(f"blades {face[1]:.1f}", 4)
        angle = 2.0 * np.pi * (np.arange(3) / 3.0 + turn)
        back = -0.7 * np.maximum(np.array(bent) - 0.4, 0.0)
        tips = reach * np.stack([back, np.sin(angle), np.cos(angle)], axis=1)
        ahead = np.array([SPINNER * self._length, 0.0, 0.0])
        yield bars([face + ahead], [face - ahead], [hub], 8)
        yield bars(np.repeat(face[None], 3, 0), face + tips, 0.05 * reach)

    def _rotor(self) -> Iterator[Triangles]:
        """Mast and blades of a helicopter; an impact breaks blades."""
        count = ROTORS[self._aircraft.plan]
        head = np.array([0.17 * self._length, 0.0, self._top])
        yield bars([head - [0.0, 0.0, self._top]], [head], 0.12 * self._radius, 6)
        turn, *left = self._draw("rotor", 1 + count)
        reach = self._half_span * np.where(np.array(left) < self._aircraft.crumpled, 0.25 + 0.7 * np.array(left), 1.0)
        angle = 360.0 * (np.arange(count) / count + turn)
        ahead = np.stack([np.cos(np.radians(angle)), np.sin(np.radians(angle)), np.full(count, -DROOP)], axis=1)
        chord = self._scale * self._plan.chord
        sizes = np.stack([reach, np.full(count, chord), np.full(count, 0.15 * chord)], axis=1)
        pitch = np.full(count, -np.degrees(np.arctan(DROOP)))
        yield blocks(head + 0.5 * reach[:, None] * ahead, sizes, np.stack([angle, pitch, 0.0 * angle], axis=1))

    def _tail(self) -> Iterator[Triangles]:
        """Tailplane and fins."""
        plan, half = self._plan, self._plan.tailplane * self._half_span
        tail, foot = self._aircraft.tail or plan.tail, 0.6 * self._radius
        chord = 0.85 * half if plan.tailplane else 0.16 * self._length
        end = 0.98 * self._length
        high = self._top if tail == "high" else foot
        if plan.tailplane:
            lead = end - chord - 0.1 * self._length * (tail == "high")
            wing = Surface(lead, chord, 0.55, max(0.8 * plan.sweep, 8.0), (0.0, 0.0), 0.5, 0.25, half)
            for hand in (1.0, -1.0):
                yield from self._surface(f"tailplane {hand:g}", hand, half, wing, high)
        is_twin, wide = tail == "twin", max(half, 0.1 * self._half_span)
        # Rows from the foot up, their trailing and leading edges; of two fins a third lies below the tailplane.
        level = np.array([-0.5 if is_twin else 0.0, 0.3, 0.8, 1.0]) * (0.75 if is_twin else 1.0)
        back = np.array([0.0, 0.0, 0.02, 0.08]) * self._length
        front = np.array([0.15, 0.13, 0.09, 0.07]) * self._length + 0.03 * self._length * (plan.sweep > 20.0)
        z = foot + level * (self._top - foot)
        for place in (wide, -wide) if is_twin else (0.0,):
            edges = [np.stack([0.5 * self._length - end + x, np.full(4, place), z], 1) for x in (back, front)]
            yield skin(np.stack(edges), 2.0 * self._thin)
