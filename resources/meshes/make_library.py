"""Build the library of targets: mines, aircraft parts, fishing gear, unexploded ordnance, rubbish and rocks.

Run ``python resources/meshes/make_library.py`` to write every mesh beside it anew. All are original shapes with the
measures of things of their kind, in metres: the longest side or the bow along +x, z up. Every part is closed and its
triangles face outwards; parts may overlap.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import ArrayLike, NDArray

Points = NDArray[np.float64]
Mesh = trimesh.Trimesh
UPRIGHT = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0))  # turns +z into +x


def joined(*parts: Mesh) -> Mesh:
    """Put closed parts together."""
    return trimesh.util.concatenate(parts)


def turned(mesh: Mesh, roll: float = 0.0, pitch: float = 0.0, heading: float = 0.0, at: ArrayLike = (0, 0, 0)) -> Mesh:
    """Turn a part by degrees about x, y and z in this order, then move it."""
    moved = mesh.copy()
    moved.apply_transform(trimesh.transformations.euler_matrix(*np.radians([roll, pitch, heading])))
    moved.apply_translation(at)
    return moved


def lathe(profile: Sequence[tuple[float, float]], sections: int = 28) -> Mesh:
    """Revolve (radius, height) pairs, bottom first, about z; the ends lie on the axis."""
    return trimesh.creation.revolve(np.array(profile), sections=sections)


def along_x(mesh: Mesh) -> Mesh:
    """Lay down what stands along z, so that its top points along +x."""
    matrix = np.eye(4)
    matrix[:3, :3] = UPRIGHT
    laid = mesh.copy()
    laid.apply_transform(matrix)
    return laid


def ring(radius: float, thickness: float, sections: int = 28) -> Mesh:
    """Return a round bar bent into a circle about z."""
    return trimesh.creation.torus(radius, thickness, major_sections=sections, minor_sections=8)


def rod(start: ArrayLike, end: ArrayLike, radius: float, sections: int = 8) -> Mesh:
    """Return a round bar between two points."""
    return trimesh.creation.cylinder(radius, segment=np.array([start, end], float), sections=sections)


def slab(size: ArrayLike, at: ArrayLike = (0, 0, 0), **angles: float) -> Mesh:
    """Return a block, turned about its centre."""
    return turned(trimesh.creation.box(size), at=at, **angles)


def hull(points: ArrayLike) -> Mesh:
    """Return the convex hull of points."""
    return trimesh.convex.convex_hull(np.asarray(points, float))


def loft(rings: Points) -> Mesh:
    """Close a body through rings of points, (stations, points, 3), with a flat face at either end."""
    stations, count, _ = rings.shape
    i, j = np.meshgrid(np.arange(stations - 1), np.arange(count), indexing="ij")
    k = (j + 1) % count
    a, b, c, d = (x.ravel() for x in (i * count + j, i * count + k, (i + 1) * count + k, (i + 1) * count + j))
    j, k = np.arange(count), (np.arange(count) + 1) % count
    first, last = np.full(count, stations * count), np.full(count, stations * count + 1)
    end = (stations - 1) * count
    faces = [(a, b, c), (a, c, d), (first, k, j), (last, end + j, end + k)]
    points = np.concatenate([rings.reshape(-1, 3), rings[[0, -1]].mean(axis=1)])
    mesh = Mesh(points, np.concatenate([np.stack(face, axis=1) for face in faces]), process=False)
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh


def mine_cylinder() -> Mesh:
    """Bottom mine laid by aircraft: a cylinder with a rounded nose, bands and lugs."""
    body = [(0, -1.05), (0.2, -1.05), (0.25, -1.02), (0.265, -0.95), (0.265, 0.8)]
    nose = [(0.265 * math.cos(a), 0.8 + 0.22 * math.sin(a)) for a in np.linspace(0.2, 1.4, 6)]
    bands = [turned(along_x(ring(0.265, 0.016)), at=(x, 0, 0)) for x in (-0.55, 0.35)]
    lugs = [slab((0.1, 0.03, 0.07), (x, 0.0, 0.285)) for x in (-0.3, 0.1)]
    return joined(along_x(lathe([*body, *nose, (0, 1.02)])), *bands, *lugs)


def mine_manta() -> Mesh:
    """Bottom mine in the shape of a truncated cone, with a fuze on top and a skirt."""
    cone = [(0, 0), (0.49, 0), (0.49, 0.05), (0.44, 0.09), (0.24, 0.4), (0.2, 0.43), (0, 0.43)]
    fuze = lathe([(0, 0.42), (0.08, 0.42), (0.08, 0.46), (0.06, 0.48), (0, 0.48)], 16)
    lugs = [
        slab((0.1, 0.03, 0.06), (0.34 * math.cos(a), 0.34 * math.sin(a), 0.27), heading=math.degrees(a), pitch=57.0)
        for a in 2.0 * math.pi * np.arange(3) / 3
    ]
    return joined(lathe(cone, 36), fuze, *lugs)


def mine_horned() -> Mesh:
    """Contact mine that has sunk: a ball with a belt and horns."""
    parts = [trimesh.creation.icosphere(3, 0.45), ring(0.455, 0.025, 36)]
    tilts = [(0.0, 0.0), *((48.0, a) for a in range(0, 360, 60)), *((125.0, a) for a in range(30, 390, 90))]
    for tilt, azimuth in tilts:
        horn = lathe([(0, 0.42), (0.045, 0.42), (0.045, 0.5), (0.03, 0.53), (0.03, 0.6), (0, 0.61)], 10)
        parts.append(turned(horn, pitch=tilt, heading=float(azimuth)))
    return joined(*parts)


def mine_wedge() -> Mesh:
    """Bottom mine of flat slanting faces, which turn echoes away."""
    foot = [(-0.5, -0.38, 0), (0.5, -0.4, 0), (0.5, 0.4, 0), (-0.5, 0.38, 0)]
    rim = [(-0.52, -0.4, 0.08), (0.52, -0.42, 0.06), (0.52, 0.42, 0.06), (-0.52, 0.4, 0.08)]
    top = [(-0.36, -0.2, 0.36), (0.1, -0.22, 0.3), (0.1, 0.22, 0.3), (-0.36, 0.2, 0.36)]
    return joined(hull([*foot, *rim, *top]), slab((0.2, 0.1, 0.06), (-0.15, 0.0, 0.34), pitch=7.0))


def bomb() -> Mesh:
    """Unexploded aerial bomb of 250 kg: an ogive, a tail cone, four fins and their ring."""
    nose = [(0.18 * math.sqrt(1.0 - s**2), 0.35 + 0.45 * s) for s in np.linspace(0.0, 0.97, 8)]
    body = [(0, -0.82), (0.06, -0.82), (0.08, -0.6), (0.15, -0.3), (0.18, -0.1), *nose, (0, 0.82)]
    fins = [slab((0.38, 0.012, 0.38), (-0.65, 0, 0), roll=roll) for roll in (45.0, 135.0)]
    drum = trimesh.creation.annulus(r_min=0.175, r_max=0.187, height=0.2, sections=28)
    return joined(along_x(lathe(body)), *fins, turned(along_x(drum), at=(-0.74, 0, 0)))


def shell() -> Mesh:
    """Artillery shell of 155 mm: flat base, driving band, ogive and fuze."""
    ogive = [(0.0775 * math.sqrt(1.0 - s**2), 0.02 + 0.3 * s) for s in np.linspace(0.0, 0.94, 8)]
    case = [(0, -0.35), (0.068, -0.35), (0.0775, -0.27), (0.082, -0.265), (0.082, -0.22), (0.0775, -0.215)]
    return along_x(lathe([*case, *ogive, (0.018, 0.34), (0, 0.36)], 24))


def drum() -> Mesh:
    """Steel drum of 200 l, lying: rims and two rolling hoops."""
    side = [(0, -0.43), (0.27, -0.43), (0.27, -0.44), (0.292, -0.44), (0.292, -0.415), (0.285, -0.41)]
    hoops = [(r, z + dz) for z in (-0.14, 0.14) for r, dz in ((0.285, -0.03), (0.3, 0), (0.285, 0.03))]
    top = [(r, -z) for r, z in reversed(side)]
    bungs = [turned(lathe([(0, 0), (0.03, 0), (0.03, 0.02), (0, 0.02)], 10), at=(x, 0.0, 0.43)) for x in (0.18, -0.2)]
    return along_x(joined(lathe([*side, *hoops, *top]), *bungs))


def tyre() -> Mesh:
    """Lorry tyre lying flat, with beads and a tread."""
    angles = np.linspace(0.0, 2.0 * math.pi, 21)[:-1]
    bulge = np.abs(np.cos(angles)) ** 0.6 * np.sign(np.cos(angles))
    across = np.abs(np.sin(angles)) ** 0.8 * np.sign(np.sin(angles))
    outside = np.stack([0.39 + 0.13 * bulge, 0.135 * across], axis=1)
    inside = np.stack([0.36 + 0.085 * bulge[::-1], 0.105 * across[::-1]], axis=1)
    # The carcass is open towards the axle: the outside runs from bead to bead, the inside back.
    outer = outside[np.argsort((angles + math.pi) % (2.0 * math.pi))][2:-1]
    inner = inside[np.argsort((angles[::-1] + math.pi) % (2.0 * math.pi))][2:-1][::-1]
    profile = np.concatenate([outer, inner])
    turns = 2.0 * math.pi * np.arange(40) / 40
    x, y = (profile[:, 0] * f(turns)[:, None] for f in (np.cos, np.sin))
    rings = np.stack([x, y, np.broadcast_to(profile[:, 1], x.shape)], axis=-1)
    blocks = [
        slab((0.03, 0.05, 0.1), (0.515 * math.cos(a), 0.515 * math.sin(a), 0.06 * (-1) ** n), heading=math.degrees(a))
        for n, a in enumerate(2.0 * math.pi * np.arange(30) / 30)
    ]
    return joined(_bent_round(rings), *blocks)


def _bent_round(rings: Points) -> Mesh:
    """Close a body whose last ring meets its first."""
    stations, count, _ = rings.shape
    i, j = np.meshgrid(np.arange(stations), np.arange(count), indexing="ij")
    a, b = i * count + j, i * count + (j + 1) % count
    c, d = (i + 1) % stations * count + (j + 1) % count, (i + 1) % stations * count + j
    faces = np.concatenate([np.stack(f, axis=-1).reshape(-1, 3) for f in ((a, b, c), (a, c, d))])
    mesh = Mesh(rings.reshape(-1, 3), faces, process=False)
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh


def wing() -> Mesh:
    """Outer wing of an aircraft, broken off: tapered and swept, a torn root, an aileron out of line."""
    u = np.linspace(0.0, 1.0, 13)
    # NACA 0014, Abbott & von Doenhoff, Theory of Wing Sections, 6.2
    half = 0.7 * (0.2969 * np.sqrt(u) - 0.126 * u - 0.3516 * u**2 + 0.2843 * u**3 - 0.1036 * u**4)
    section = np.concatenate([np.stack([u, half], axis=1), np.stack([u[-2:0:-1], -half[-2:0:-1]], axis=1)])
    span, torn = np.linspace(-2.2, 2.2, 12), np.random.default_rng(3).uniform(-0.12, 0.2, len(section))
    rings = []
    for number, x in enumerate(span):
        share = (x + 2.2) / 4.4
        chord = 1.6 * (1.0 - share) + 0.85 * share
        frayed = torn if number == 0 else 0.0
        y = 0.3 * share + chord * (0.35 - section[:, 0])
        z = chord * section[:, 1] + 0.08 * share
        rings.append(np.stack([np.full(len(section), x) + frayed, y, z], axis=1))
    aileron = slab((1.5, 0.28, 0.03), (0.9, -0.72, 0.12), roll=-22.0, heading=-1.5)
    pod = lathe([(0, -0.4), (0.1, -0.35), (0.14, -0.1), (0.14, 0.2), (0.08, 0.4), (0, 0.45)], 16)
    pod = turned(along_x(pod), heading=90.0, at=(-1.0, 0.5, -0.1))
    return joined(loft(np.array(rings)), aileron, pod)


def fuselage() -> Mesh:
    """Tail of an aircraft's fuselage: an open, crushed shell with frames inside and a fin."""
    angles, stations = 2.0 * math.pi * np.arange(32) / 32, np.linspace(-1.9, 1.9, 15)
    torn = np.random.default_rng(5).uniform(-0.25, 0.1, 32)
    dent = 0.03 * np.sin(2.3 * stations + 0.7)[:, None] * np.sin(2.0 * angles) - 0.08 * np.exp(
        -((stations[:, None] - 0.6) ** 2) / 0.3 - (angles - 1.2) ** 2 / 0.2
    )
    parts = []
    rings = []
    for x, rough in zip(stations, dent):
        radius = 0.72 - 0.3 * max(-x / 1.9, 0.0) ** 1.4 + rough
        circle = np.stack([np.cos(angles), 0.86 * np.sin(angles)], axis=1)
        rings.append((x, circle * radius[:, None], circle * (radius - 0.03)[:, None]))
    outer = np.array([np.column_stack([np.full(32, x), yz]) for x, yz, _ in rings])
    inner = np.array([np.column_stack([np.full(32, x), yz]) for x, _, yz in rings])
    outer[-1, :, 0] += torn
    inner[-1, :, 0] = outer[-1, :, 0]
    parts.append(_bent_round(np.concatenate([outer, inner[::-1]])))
    for x in stations[2:-1:3]:
        size = 0.69 - 0.3 * max(-x / 1.9, 0.0) ** 1.4
        frame = along_x(ring(size, 0.035, 32))
        frame.apply_scale([1.0, 1.0, 0.86])
        parts.append(turned(frame, at=(x, 0, 0)))
    fin_outline = ((-1.85, 0.3), (-0.85, 0.45), (-1.35, 1.25), (-1.8, 1.25))
    plane_outline = ((-1.8, 0.3), (-1.1, 0.3), (-1.35, 1.2), (-1.75, 1.2))
    fin = hull([(x, y, z) for y in (-0.035, 0.035) for x, z in fin_outline])
    plane = hull([(x, y, z) for z in (-0.03, 0.03) for x, y in plane_outline])
    return joined(*parts, turned(fin, roll=4.0), plane)


def propeller() -> Mesh:
    """Aircraft propeller of three twisted blades on a hub, one of them bent by the crash."""
    parts = [lathe([(0, -0.16), (0.17, -0.16), (0.2, 0.0), (0.15, 0.16), (0.06, 0.28), (0, 0.3)], 20)]
    for number in range(3):
        r = np.linspace(0.12, 1.5, 10)
        chord = 0.26 * np.sin(np.clip((r - 0.02) / 1.62, 0, 1) * math.pi) ** 0.6 + 0.02
        twist = np.radians(55.0 - 35.0 * (r - 0.12) / 1.38)
        t = 2.0 * math.pi * np.arange(12) / 12
        flat = np.stack([0.5 * chord[:, None] * np.cos(t), (0.02 + 0.03 * (1.5 - r))[:, None] * np.sin(t)], axis=-1)
        y = flat[..., 0] * np.cos(twist)[:, None] - flat[..., 1] * np.sin(twist)[:, None]
        z = flat[..., 0] * np.sin(twist)[:, None] + flat[..., 1] * np.cos(twist)[:, None]
        z = z + (-0.45 * np.clip((r - 0.6) / 0.9, 0, 1) ** 2 * (number == 0))[:, None]
        blade = loft(np.stack([np.broadcast_to(r[:, None], y.shape), y, z], axis=-1))
        parts.append(turned(blade, heading=120.0 * number))
    return joined(*parts)


def anchor() -> Mesh:
    """Admiralty anchor: shank, curved arms with flukes, a stock across and a ring."""
    bend = np.radians(np.linspace(-68.0, 68.0, 11))
    arc = np.stack([0.55 - 0.62 * np.cos(bend) - 0.95, 0 * bend, 0.62 * np.sin(bend)], axis=1)
    arms = [rod(a, b, 0.055) for a, b in itertools.pairwise(arc)]
    knuckles = [trimesh.creation.icosphere(1, 0.056).apply_translation(p) for p in arc[1:-1]]
    palm = [(-0.78, 0, 0.68), (-0.62, 0, 0.38)]
    palm += [(x, y, z) for y in (-1, 1) for x, y, z in ((-0.5, 0.16 * y, 0.42), (-0.56, 0.1 * y, 0.56))]
    flukes = [hull([(x, y, side * z) for x, y, z in palm]) for side in (1, -1)]
    shank = rod((-1.0, 0, 0), (0.85, 0, 0), 0.06)
    knobs = [trimesh.creation.icosphere(2, 0.06).apply_translation((0.72, y, 0)) for y in (-0.75, 0.75)]
    stock = [rod((0.72, -0.75, 0), (0.72, 0.75, 0), 0.035), *knobs]
    return joined(shank, *arms, *knuckles, *flukes, *stock, turned(ring(0.12, 0.02, 20), roll=90.0, at=(0.98, 0, 0)))


def lobster_trap() -> Mesh:
    """Lobster trap with a half-round top: base boards, hoops, laths and a parlour door."""
    parts = [slab((0.92, 0.06, 0.025), (0, y, 0.0125)) for y in np.linspace(-0.26, 0.26, 6)]
    angles = np.linspace(0.0, math.pi, 13)
    for x in (-0.43, -0.14, 0.14, 0.43):
        arch = np.stack([0 * angles + x, 0.27 * np.cos(angles), 0.04 + 0.36 * np.sin(angles)], axis=1)
        parts += [rod(a, b, 0.014, 6) for a, b in itertools.pairwise(arch)]
        parts.append(slab((0.03, 0.56, 0.03), (x, 0, 0.035)))
    for a in angles[1:-1]:
        y, z = 0.28 * math.cos(a), 0.04 + 0.37 * math.sin(a)
        parts.append(slab((0.92, 0.035, 0.01), (0, y, z), roll=math.degrees(math.atan2(z - 0.04, y)) - 90.0))
    for x in (-0.44, 0.44):
        for y in np.linspace(-0.24, 0.24, 9):
            parts.append(rod((x, y, 0.04), (x, y, 0.04 + 0.36 * math.sqrt(1.0 - (y / 0.28) ** 2)), 0.006, 5))
        for z in (0.08, 0.16, 0.24):
            width = 0.27 * math.sqrt(1.0 - (z / 0.36) ** 2)
            parts.append(rod((x, -width, 0.04 + z), (x, width, 0.04 + z), 0.006, 5))
    return joined(*parts, slab((0.3, 0.12, 0.05), (0.05, 0.0, 0.05)))


def crab_pot() -> Mesh:
    """Conical crab pot: a weighted base ring, a top ring, bars, a bottom grid and the entrance collar."""
    parts = [turned(ring(0.65, 0.025, 36), at=(0, 0, 0.025)), turned(ring(0.35, 0.014), at=(0, 0, 0.6))]
    parts += [turned(ring(0.55, 0.01, 30), at=(0, 0, 0.22)), turned(ring(0.45, 0.01, 30), at=(0, 0, 0.41))]
    for number in range(24):
        c, s = math.cos(math.pi * number / 12), math.sin(math.pi * number / 12)
        thick = 0.007 if number % 3 else 0.012
        parts.append(rod((0.65 * c, 0.65 * s, 0.025), (0.35 * c, 0.35 * s, 0.6), thick, 6))
    for y in np.linspace(-0.5, 0.5, 6):
        w = math.sqrt(0.65**2 - y**2)
        parts += [rod((-w, y, 0.02), (w, y, 0.02), 0.007, 5), rod((y, -w, 0.02), (y, w, 0.02), 0.007, 5)]
    collar = trimesh.creation.annulus(r_min=0.17, r_max=0.185, height=0.2, sections=24)
    ways = [np.array([math.cos(a), math.sin(a), 0.0]) for a in 2.0 * math.pi * np.arange(8) / 8]
    spokes = [rod(0.18 * way + (0, 0, 0.57), 0.35 * way + (0, 0, 0.6), 0.007, 5) for way in ways]
    return joined(*parts, turned(collar, at=(0, 0, 0.5)), *spokes)


def mooring_block() -> Mesh:
    """Concrete sinker of a mooring: a truncated pyramid with chamfered edges and an eye."""
    levels = ((0.5, 0.0), (0.5, 0.12), (0.36, 0.55), (0.33, 0.58))
    block = hull([(half * x, 0.9 * half * y, z) for half, z in levels for x in (-1, 1) for y in (-1, 1)])
    eye = turned(ring(0.11, 0.022, 20), roll=90.0, at=(0, 0, 0.62))
    links = [(0.1 + 0.075 * n, 0.02 * n, 0.66 - 0.018 * n) for n in range(5)]
    chain = [
        turned(ring(0.06, 0.016, 14), roll=70.0 * (n % 2) + 10.0, heading=20.0 * n, at=at) for n, at in enumerate(links)
    ]
    return joined(block, eye, *chain)


def rock(seed: int, size: tuple[float, float, float], roughness: float, facets: int) -> Mesh:
    """Star-shaped boulder: a ball with smooth bumps, cut flat by planes."""
    random = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(3)
    way = ball.vertices / np.linalg.norm(ball.vertices, axis=1, keepdims=True)
    radius = np.ones(len(way))
    for scale in (1.2, 2.4, 4.8):
        waves, phases = random.normal(0.0, scale, (6, 3)), random.uniform(0.0, 2.0 * math.pi, 6)
        radius += roughness / scale * np.sin(way @ waves.T + phases).mean(axis=1)
    normals = random.normal(size=(facets, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    reach = way @ normals.T
    flat = np.where(reach > 0.0, random.uniform(0.72, 0.95, facets) / np.maximum(reach, 1e-9), np.inf)
    radius = np.minimum(radius, flat.min(axis=1, initial=np.inf))
    return Mesh(0.5 * np.asarray(size) * way * radius[:, None], ball.faces, process=False)


def figure() -> Mesh:
    """Human figure that lies on its back: trunk, head, and limbs bent a little, 1.75 m."""

    def limb(*joints: tuple[float, float, float, float]) -> list[Mesh]:
        balls = [trimesh.creation.icosphere(1, radius).apply_translation(at) for *at, radius in joints]
        return [trimesh.convex.convex_hull(joined(*pair)) for pair in itertools.pairwise(balls)]

    outline = ((-1.0, 0.0), (-0.6, 0.9), (0.6, 0.9), (1.0, 0.0), (0.6, -0.9), (-0.6, -0.9))
    widths = ((0.52, 0.13), (0.4, 0.22), (0.0, 0.15), (-0.12, 0.18))
    trunk = hull([(x, y * wide, 0.12 + z * 0.11) for x, wide in widths for y, z in outline])
    parts = [trunk, trimesh.creation.icosphere(2, 0.105).apply_translation((0.7, 0.02, 0.13))]
    parts += limb((0.45, 0.0, 0.12, 0.07), (0.66, 0.02, 0.13, 0.06))
    for hand, spread in ((1.0, 0.1), (-1.0, 0.04)):
        wide = 0.12 + spread
        elbow, wrist = (0.15, (0.27 + spread) * hand, 0.09, 0.045), (-0.1, (0.24 + 2.0 * spread) * hand, 0.08, 0.04)
        knee, heel, toe = (-0.5, wide, 0.14, 0.06), (-0.9, wide, 0.08, 0.045), (-0.94, wide + 0.03, 0.2, 0.035)
        leg = [(x, y * hand, z, radius) for x, y, z, radius in ((-0.1, 0.1, 0.12, 0.085), knee, heel, toe)]
        parts += limb((0.42, 0.2 * hand, 0.12, 0.06), elbow, wrist) + limb(*leg)
    return joined(*parts)


def log() -> Mesh:
    """Sunken trunk of a tree with stubs of branches, 2.6 m."""
    places = ((-1.3, 0.0, 0.19), (-0.4, 0.06, 0.17), (0.5, -0.02, 0.15), (1.3, 0.1, 0.11))

    def section(x: float, y: float, r: float, turn: float) -> list[tuple[float, float, float]]:
        angles = (np.arange(9) + turn) * math.pi / 4.5
        return [(x, y + r * math.cos(a), 0.19 + r * math.sin(a)) for a in angles]

    # Parts that meet share no edge.
    parts = [hull([*section(*one, 0.0), *section(*other, 0.4)]) for one, other in itertools.pairwise(places)]
    stubs = (
        ((-0.6, 0.1, 0.2), (-0.4, 0.55, 0.45)),
        ((0.4, -0.05, 0.2), (0.75, -0.4, 0.5)),
        ((0.9, 0.1, 0.2), (1.2, 0.4, 0.2)),
    )
    return joined(*parts, *(rod(foot, tip, 0.05, 7) for foot, tip in stubs))


def weed() -> Mesh:
    """Bush of kelp whose blades lean one way, 1.2 m."""
    random, parts = np.random.default_rng(5), []
    for _ in range(26):
        foot = np.append(random.normal(0.0, 0.18, 2), 0.0)
        lean = np.array([random.uniform(0.2, 0.7), random.normal(0.0, 0.15), random.uniform(0.3, 0.75)])
        blade = trimesh.creation.box((0.9 * float(np.linalg.norm(lean)), 0.09, 0.015))
        pitch, heading = -math.degrees(math.atan2(lean[2], lean[0])), math.degrees(math.atan2(lean[1], lean[0]))
        parts.append(turned(blade, roll=random.uniform(-50, 50), pitch=pitch, heading=heading, at=foot + 0.45 * lean))
    return joined(*parts)


LIBRARY: dict[str, Callable[[], Mesh]] = {
    "mine-cylinder": mine_cylinder,
    "mine-manta": mine_manta,
    "mine-horned": mine_horned,
    "mine-wedge": mine_wedge,
    "bomb": bomb,
    "shell": shell,
    "drum": drum,
    "tyre": tyre,
    "wing": wing,
    "fuselage": fuselage,
    "propeller": propeller,
    "anchor": anchor,
    "lobster-trap": lobster_trap,
    "crab-pot": crab_pot,
    "mooring-block": mooring_block,
    "figure": figure,
    "log": log,
    "weed": weed,
    "rock-round": lambda: rock(11, (1.1, 0.95, 0.8), 1.1, 4),
    "rock-flat": lambda: rock(29, (1.5, 1.15, 0.45), 0.7, 9),
    "rock-jagged": lambda: rock(37, (0.9, 0.8, 0.95), 1.6, 22),
}


def target(name: str) -> Mesh:
    """Return a target of the library, resting on z = 0, with single-precision corners as its file holds them."""
    mesh = LIBRARY[name]()
    low = mesh.vertices.min(axis=0)[2]
    return Mesh((mesh.vertices - [0.0, 0.0, low]).astype(np.float32), mesh.faces, process=False)


if __name__ == "__main__":
    for name in LIBRARY:
        target(name).export(Path(__file__).with_name(f"{name}.ply"))
