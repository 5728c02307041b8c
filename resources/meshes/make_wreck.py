"""Build ``wreck.ply``: a steamer of 24 m, sunk upright into the sand to a metre below her rail.

Run ``python resources/meshes/make_wreck.py`` to write ``wreck.ply`` beside it anew. The bow points along +x, port along
+y; z is up and 0 at the sand. Every part is closed, and parts may overlap. A sonar sees two sides with frames inside, a
bulwark on stanchions, beams across the open hold, the wreckage of the deck abaft, a deckhouse without its roof, a
boiler, and a mast that still stands.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

LENGTH, BEAM = 24.0, 7.0
BURIED, RAIL = -0.8, 1.0  # heights of the lowest plates and of the sheer amidships
PLATE = 0.12  # thickness of plates
Points = NDArray[np.float64]
Part = tuple[Points, NDArray[np.int64]]


def half_breadth(x: Points) -> Points:
    """Half the breadth of the deck at a station: full abaft, fine at the bow."""
    u = 2.0 * x / LENGTH
    return (
        0.5
        * BEAM
        * np.maximum(1.0 - np.maximum(u, 0.0) ** 2.2, 0.0)
        * np.maximum(1.0 - np.maximum(-u, 0.0) ** 6, 0.0) ** 0.6
    )


def sheer(x: Points) -> Points:
    """Height of the rail: it rises towards the ends."""
    return RAIL + 0.2 * (2.0 * x / LENGTH) ** 2 + 0.4 * np.maximum(2.0 * x / LENGTH, 0.0) ** 3


def loft(outer: Points, inner: Points) -> Part:
    """Close the space between two grids of points, each (stations, levels, 3), into a shell."""
    n, m, _ = outer.shape
    ring = np.concatenate([outer, inner[:, ::-1]], axis=1)
    k = 2 * m
    quads = [
        (i * k + j, i * k + (j + 1) % k, (i + 1) * k + (j + 1) % k, (i + 1) * k + j)
        for i in range(n - 1)
        for j in range(k)
    ]
    for base, turn in ((0, 1), ((n - 1) * k, -1)):
        ends = [(base + j, base + k - 1 - j, base + k - 2 - j, base + j + 1) for j in range(m - 1)]
        quads += [quad[::turn] for quad in ends]
    q = np.array(quads)
    return ring.reshape(-1, 3), np.concatenate([q[:, [0, 1, 2]], q[:, [0, 2, 3]]])


def side(hand: int, first: float, last: float, low: float = BURIED, cut: float = 0.0) -> Part:
    """Make a stretch of the ship's side; ``hand`` is +1 for port; ``cut`` is what has rusted off its top."""
    x = np.linspace(first, last, max(int((last - first) / 0.35), 2) + 1)
    # Rust takes plates in steps, and frays what it leaves.
    wear = np.random.default_rng(abs(int(100 * first)) + hand)
    torn = cut + np.repeat(wear.exponential(0.07, x.size // 4 + 1), 4)[: x.size] + wear.uniform(0.0, 0.06, x.size)
    share = np.linspace(0.0, 1.0, 4)
    z = low + (sheer(x) - torn - low)[:, None] * share
    outward = (0.78 + 0.22 * (z - BURIED) / (sheer(x)[:, None] - BURIED)) * half_breadth(x)[:, None]  # she flares
    xs = np.broadcast_to(x[:, None], z.shape)
    outer = np.stack([xs, hand * outward, z], axis=-1)
    inner = np.stack([xs, hand * np.maximum(outward - PLATE, 0.0), z], axis=-1)
    return loft(outer, inner)


def rod(start: Points, end: Points, first: float, last: float | None = None, faces: int = 8) -> Part:
    """Make a round bar from one point to another, of one radius or tapering."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    axis = (end - start) / np.linalg.norm(end - start)
    aside = np.cross(axis, [0.0, 0.0, 1.0] if abs(axis[2]) < 0.9 else [1.0, 0.0, 0.0])
    aside /= np.linalg.norm(aside)
    angle = 2.0 * np.pi * np.arange(faces) / faces
    circle = np.cos(angle)[:, None] * aside + np.sin(angle)[:, None] * np.cross(axis, aside)
    points = np.concatenate([start + first * circle, end + (first if last is None else last) * circle, [start], [end]])
    j = np.arange(faces)
    k = (j + 1) % faces
    walls = [np.stack(c, axis=1) for c in ((j, k, faces + k), (j, faces + k, faces + j))]
    caps = [np.stack(c, axis=1) for c in ((k, j, 0 * j + 2 * faces), (faces + j, faces + k, 0 * j + 2 * faces + 1))]
    return points, np.concatenate(walls + caps)


def slab(centre: Points, size: Points, heading: float = 0.0, pitch: float = 0.0, roll: float = 0.0) -> Part:
    """Make a box, turned by degrees about its centre."""
    box = trimesh.creation.box(size)
    turn = trimesh.transformations.euler_matrix(*np.radians([roll, -pitch, heading]))[:3, :3]
    return box.vertices @ turn.T + np.asarray(centre), np.asarray(box.faces)


def hull() -> list[Part]:
    """Sides with what is left of them, the stem and a broken transom."""
    starboard = [side(-1, -11.6, -6.6, cut=0.35), side(-1, -6.6, -4.4, cut=0.75), side(-1, -4.4, 11.9)]
    parts = [side(1, -11.6, 11.9), *starboard]
    parts.append(rod([11.5, 0.0, BURIED], [12.4, 0.0, 2.1], 0.16))
    parts += [slab([-11.5, y, 0.1], [PLATE, 1.5, 1.7], roll=r) for y, r in ((-2.2, 2.0), (-0.6, -4.0), (1.4, 3.0))]
    return parts


def frames() -> list[Part]:
    """Ribs along the inside of both sides, every 0.9 m; some are gone."""
    parts = []
    for number, x in enumerate(np.arange(-10.8, 10.9, 0.9)):
        for hand in (-1, 1):
            if (7 * number + 3 * hand) % 5 == 0:
                continue
            breadth, top = float(half_breadth(x)), float(sheer(x))
            foot = [x, hand * max(0.66 * breadth - 0.2, 0.05), BURIED]
            head = [x, hand * max(breadth - 0.3, 0.05), top - 0.1 - 0.25 * ((5 * number + hand) % 3)]
            parts.append(rod(foot, head, 0.09, 0.07, faces=6))
    return parts


def bulwark() -> list[Part]:
    """Rail on stanchions above the port side and part of starboard: what throws the ladder in the shadow."""
    parts, wear = [], np.random.default_rng(7)
    for hand, first, last in ((1, -8.0, 3.5), (1, 5.0, 9.5), (-1, -2.5, 4.0)):
        x = np.arange(first, last, 1.1) + wear.uniform(-0.2, 0.2, len(np.arange(first, last, 1.1)))
        up = 0.32 - np.where(wear.uniform(size=x.size) < 0.25, wear.uniform(0.1, 0.25, x.size), 0.0)  # some are bent
        tops = np.stack([x, hand * (half_breadth(x) - 0.06), sheer(x) + up], axis=1)
        parts += [rod(top - [0, 0, 0.6], top, 0.05, faces=6) for top in tops]
        parts += [rod(a, b, 0.06, faces=6) for a, b in pairwise(tops)]
    return parts


def beams() -> list[Part]:
    """Deck beams across the hold that have not fallen in."""
    parts = []
    for x, lean, drop in ((7.6, 0.2, 0.1), (3.4, -0.9, 0.35), (0.2, 0.5, 0.2), (-2.6, 1.4, 0.4)):
        y, z = float(half_breadth(x)), float(sheer(x))
        parts.append(rod([x - lean, -y + 0.2, z - drop], [x + lean, y - 0.2, z - 0.1], 0.09))
    return parts


def wreckage(rng: np.random.Generator) -> list[Part]:
    """Heap up the deck abaft: planks and plates over the remains of the engine room."""
    parts = []
    for _ in range(70):
        x = rng.uniform(-11.2, -3.2)
        y = rng.uniform(-0.85, 0.85) * float(half_breadth(x))
        z = rng.uniform(0.0, 0.75) * (1.0 - 0.3 * (x + 11.0) / 8.0)
        size = [rng.uniform(0.9, 3.0), rng.uniform(0.12, 0.45), 0.07]
        parts.append(slab([x, y, z], size, rng.uniform(0, 180), rng.uniform(-25, 25), rng.uniform(-30, 30)))
    for _ in range(12):
        x = rng.uniform(-3.0, 9.0)
        y = rng.uniform(-0.7, 0.7) * float(half_breadth(x))
        parts.append(slab([x, y, 0.04], [rng.uniform(0.5, 1.8), 0.18, 0.12], rng.uniform(0, 180), rng.uniform(-8, 8)))
    parts.append(rod([-5.6, -0.9, 0.45], [-3.2, -0.7, 0.4], 0.62, faces=20))  # boiler
    parts.append(rod([-6.9, 1.5, 0.1], [-1.2, 2.6, 0.75], 0.1, 0.06))  # a boom across it
    return parts


def deckhouse() -> list[Part]:
    """Walls of the deckhouse right aft, its roof hanging into it."""
    walls = (
        ([-9.4, -1.15, 0.45], [2.6, 0.1, 0.9], 0.0, 4.0),
        ([-9.5, 1.15, 0.65], [2.4, 0.1, 1.3], 0.0, -6.0),
        ([-8.1, 0.2, 0.6], [0.1, 1.7, 1.2], 3.0, 0.0),
    )
    parts = [slab(centre, size, heading, 0.0, roll) for centre, size, heading, roll in walls]
    parts.append(slab([-9.5, 0.1, 1.15], [2.4, 2.1, 0.08], 4.0, 9.0, -14.0))
    return parts


def mast_and_spars() -> list[Part]:
    """Set the mizzen with its crosstrees, a bowsprit, and an anchor davit that fell outboard."""
    foot, head = np.array([-10.6, 2.2, BURIED]), np.array([-11.0, 2.5, 7.4])
    parts = [rod(foot, head, 0.42, 0.36, faces=12)]
    for share, reach in ((0.55, 0.5), (0.8, 0.4)):
        at, yard = foot + share * (head - foot), np.array([reach, 0.1, 0.0])
        parts.append(rod(at - yard, at + yard, 0.07, faces=6))
    parts.append(rod([11.2, -0.1, 1.5], [14.2, 0.5, 1.1], 0.15, 0.08))
    parts.append(rod([11.8, 0.9, 0.4], [12.6, -1.5, 0.7], 0.1, 0.08))
    parts.append(rod([-11.6, -2.6, 0.5], [-12.3, -4.6, 0.35], 0.1))
    return parts


def wreck() -> trimesh.Trimesh:
    """Put all parts together."""
    parts = [
        *hull(),
        *frames(),
        *bulwark(),
        *beams(),
        *wreckage(np.random.default_rng(1913)),
        *deckhouse(),
        *mast_and_spars(),
    ]
    starts = np.cumsum([0] + [len(points) for points, _ in parts[:-1]])
    points = np.concatenate([points for points, _ in parts])
    faces = np.concatenate([faces + start for (_, faces), start in zip(parts, starts)])
    return trimesh.Trimesh(points.astype(np.float32), faces, process=False)


if __name__ == "__main__":
    shape = wreck()
    shape.export(Path(__file__).with_name("wreck.ply"))
