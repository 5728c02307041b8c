"""PyVista meshes of a scene: bed, targets, fish, track and scan line; without window or plotter."""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from insonify.arrays import Bytes, Floats, Integers, Singles
from insonify.kernels.common.types import Mesh, Poses, SceneArrays, Solids
from insonify.receiver.water_column import points_in_water
from insonify.scene.targets.shape import rotation_matrix
from insonify.scene.volumes import Volume
from insonify_viewer.core_types import AnyGround, TowLine
from insonify_viewer.seabed.bed_shading import BedPatch, bed_image, sample_heights
from insonify_viewer.seabed.lean_pyvista import pv

MESH_NODES = 257
THINNED = 2  # every so many nodes are drawn while the view is turned
TEXTURE_SIZE = 768
LINE_POINTS = 96  # per side, of the current scan line
MAX_SOLIDS = 400
ROUND = 28  # corners of a circle
CLOUD = 1500  # points, at most, by which a volume of the water column is drawn
# Colours of the scan line, from dark for shadow to a cold white, distinct from sand.
SHADOW, ECHO = np.array([8.0, 30.0, 48.0]), np.array([214.0, 250.0, 255.0])
WINDOW = 3.6  # side of the bed shown, in slant ranges
BEHIND = 0.55  # distance of its middle behind the fish, in slant ranges: recorded bed matters most
PATH_POINTS = 160
PATH = (1.7, 0.5)  # of the track, shown behind and ahead, in slant ranges
STEPS = 16  # of the window, per slant range


def window_centre(line: TowLine, reach: float) -> tuple[float, float]:
    """Centre of the window around a point of the track; it moves with the tow in steps."""
    step, behind = reach / STEPS, BEHIND * reach
    x = float(line.x[0]) - behind * math.cos(float(line.heading[0]))
    y = float(line.y[0]) - behind * math.sin(float(line.heading[0]))
    return round(x / step) * step, round(y / step) * step


def bed_patch(bed: AnyGround, centre: tuple[float, float], reach: float, by_depth: bool = False) -> BedPatch:
    """Sample and shade the bed within a window, in the colours of its materials or of its depth."""
    half = WINDOW * reach / 2.0
    ground = bed.around(centre, half)
    x = np.linspace(centre[0] - half, centre[0] + half, MESH_NODES)
    y = np.linspace(centre[1] - half, centre[1] + half, MESH_NODES)
    z = sample_heights(ground, x, y)
    z = np.where(np.isnan(z), np.nanmin(ground.heights), z)
    points = np.stack([*np.meshgrid(x, y), z], axis=-1).reshape(-1, 3).astype(np.float32)
    low, high = float(z.min()), float(z.max())
    image = bed_image(ground, centre, half, TEXTURE_SIZE, (low, high) if by_depth else None)
    return BedPatch(centre, points, image, half, (-high - bed.datum, -low - bed.datum) if by_depth else None)


def bed_mesh(*, thinned: bool = False) -> Any:
    """Return a textured grid of `MESH_NODES`² nodes or of every `THINNED`th of them, to be filled from a `BedPatch`."""
    mesh: Any = pv.StructuredGrid()
    side = np.linspace(0.0, 1.0, MESH_NODES, dtype=np.float32)[:: THINNED if thinned else 1]
    u, v = np.meshgrid(side, side)
    mesh.points = np.column_stack([u.ravel(), v.ravel(), np.zeros(u.size, np.float32)])
    mesh.dimensions = (len(side), len(side), 1)
    mesh.active_texture_coordinates = np.column_stack([u.ravel(), v.ravel()])
    return mesh


# Targets and volumes are arrays, because they are made beside the main thread, on which alone objects of VTK may live.
# VTK draws without the interpreter's lock: another thread that destroys an object meanwhile waits, with that lock, for
# VTK's garbage collector, which waits for the lock.


def target_triangles(solids: Solids, mesh: Mesh, colours: Bytes) -> tuple[Floats, Bytes]:
    """Return the triangles of targets, (n, 3, 3), and their colours, (n, 3), without solids beyond `MAX_SOLIDS`."""
    parts, targets = [mesh.corners], [mesh.target]
    for row in range(min(len(solids.shape), MAX_SOLIDS)):
        start, axis = solids.start[row], solids.axis[row]
        length, radius = float(solids.length[row]), float(solids.radius[row])
        if length > 0.0:
            last_radius = max(radius + float(solids.taper[row]) * length, 0.0)
            parts.append(frustum_triangles(start, start + length * axis, radius, last_radius))
        else:
            parts.append(_ball_triangles(start, radius))
        targets.append(np.full(len(parts[-1]), solids.target[row]))
    return np.concatenate(parts), colours[np.concatenate(targets)]


def volume_points(volumes: Sequence[Volume], ground: AnyGround) -> Singles:
    """Return the volumes of the water column as points, (n, 3); the first points of each fill it evenly too."""
    clouds = [points_in_water(volume.sample().points[:CLOUD], ground) for volume in volumes]
    return np.concatenate([np.empty((0, 3)), *clouds]).astype(np.float32)


def frustum_triangles(first: Floats, last: Floats, radius: float, last_radius: float) -> Floats:
    """Return a cylinder, a cone or a frustum from the centres and radii of its ends, (n, 3, 3)."""
    axis = (last - first) / np.linalg.norm(last - first)
    aside = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[2]) > 0.7 else [0.0, 0.0, 1.0])
    aside /= np.linalg.norm(aside)
    angle = np.linspace(0.0, 2.0 * math.pi, ROUND + 1)[:, None]
    rim = np.cos(angle) * aside + np.sin(angle) * np.cross(axis, aside)
    return _skin(np.stack([first + 0.0 * rim, first + radius * rim, last + last_radius * rim, last + 0.0 * rim]))


def _ball_triangles(centre: Floats, radius: float) -> Floats:
    """Return a ball, (n, 3, 3)."""
    up, around = np.linspace(-0.5 * math.pi, 0.5 * math.pi, ROUND // 2 + 1), np.linspace(0.0, 2.0 * math.pi, ROUND + 1)
    up, around = np.meshgrid(up, around, indexing="ij")
    return _skin(centre + radius * np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], -1))


def _skin(rings: Floats) -> Floats:
    """Return two triangles between every two neighbours of two neighbouring rings, (rings, points, 3)."""
    a, b, c, d = rings[:-1, :-1], rings[:-1, 1:], rings[1:, 1:], rings[1:, :-1]
    return np.concatenate([np.stack([a, b, c], axis=-2), np.stack([a, c, d], axis=-2)]).reshape(-1, 3, 3)


@cache
def fish_mesh(length: float) -> Any:
    """Return a towfish of a length in metres that heads for +x; one mesh that all views share."""
    radius = 0.085 * length
    body = pv.Cylinder(center=(-0.02 * length, 0, 0), direction=(1, 0, 0), radius=radius, height=0.76 * length)
    nose = pv.Sphere(center=(0.36 * length, 0, 0), radius=radius)
    tail = pv.Cone(
        center=(-0.45 * length, 0, 0), direction=(-1, 0, 0), radius=radius, height=0.14 * length, resolution=24
    )
    wide = pv.Box((-0.52 * length, -0.36 * length, -0.2 * length, 0.2 * length, -0.012 * length, 0.012 * length))
    tall = pv.Box((-0.52 * length, -0.36 * length, -0.012 * length, 0.012 * length, -0.2 * length, 0.2 * length))
    return pv.merge([body, nose, tail, wide, tall]).extract_surface(algorithm=None)


def cable_mesh(length: float) -> Any:
    """Return the tow cable of a fish at the origin, which runs up and ahead."""
    s = np.linspace(0.0, 1.0, 24)
    ahead, up = 0.03 + 22.0 * s, 0.08 + 13.0 * s**1.2
    return pv.MultipleLines(length * np.column_stack([ahead, np.zeros(24), up]))


def path_pings(ping: int, step: float, reach: float) -> Integers:
    """Choose the pings whose places are shown, given the metres between two pings; the tow starts at ping 0."""
    behind, ahead = (share * reach / step for share in PATH)
    return np.maximum(np.rint(np.linspace(ping - behind, ping + ahead, PATH_POINTS)), 0.0).astype(np.int64)


def pose_matrix(pose: Poses, length: float, *, level: bool = False) -> Floats:
    """Matrix that scales a mesh along +x and moves it to a pose, with its pitch and roll or level; (4, 4) float64."""
    pitch, roll = (0.0, 0.0) if level else (math.degrees(pose.pitch[0]), math.degrees(pose.roll[0]))
    matrix = np.eye(4)
    matrix[:3, :3] = length * rotation_matrix(math.degrees(pose.heading[0]), pitch, roll)
    matrix[:3, 3] = pose.x[0], pose.y[0], pose.z[0]
    return matrix


def triangles_mesh(triangles: Floats) -> Any:
    """Return triangles of (n, 3, 3) corners as one surface."""
    corners = triangles.reshape(-1, 3)
    faces: Any = np.arange(len(corners)).reshape(-1, 3)
    return pv.PolyData.from_regular_faces(corners, faces)


def polylines(lines: Sequence[Floats]) -> Any:
    """Mesh of several lines, each of (n, 3) points."""
    first, cells = 0, []
    for line in lines:
        cells += [len(line), *range(first, first + len(line))]
        first += len(line)
    return pv.PolyData(np.concatenate(lines).astype(np.float32), lines=np.array(cells))


ScanLine = tuple[Floats, Floats]


class ScanFan:
    """The current scan: a sheet from the fish to the bed, and its footprint."""

    def __init__(self) -> None:
        n = 2 * LINE_POINTS
        i = np.arange(n - 1)
        triangles = np.column_stack([np.full(n - 1, 3), np.zeros(n - 1, np.int64), i + 1, i + 2])
        quads = np.column_stack([np.full(n - 1, 4), 2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2])
        self.sheet = pv.PolyData(np.zeros((n + 1, 3), np.float32), faces=triangles.ravel())
        self.footprint = pv.PolyData(np.zeros((2 * n, 3), np.float32), faces=quads.ravel())
        self.footprint.point_data["colour"] = np.full((2 * n, 3), 255, np.uint8)

    def move(self, arrays: SceneArrays, pose: Poses, scanned: ScanLine, tones: Singles) -> None:
        """Move sheet and footprint to a pose."""
        line, slant = scanned
        ahead = np.array([math.cos(pose.heading[0]), math.sin(pose.heading[0]), 0.0])
        reach = arrays.bins * arrays.bin_length
        half = np.maximum(slant * math.sin(arrays.half_width), 0.006 * reach)[:, None]
        lifted = line + np.array([0.0, 0.0, 0.0015 * reach])
        self.sheet.points = np.vstack([[[pose.x[0], pose.y[0], pose.z[0]]], line]).astype(np.float32)
        self.footprint.points = (
            np.stack([lifted - half * ahead, lifted + half * ahead], 1).reshape(-1, 3).astype(np.float32)
        )
        bins = arrays.bins
        bin_scanned = np.clip((slant / arrays.bin_length).astype(np.int64), 0, bins - 1)
        columns = np.concatenate([bins - 1 - bin_scanned[:LINE_POINTS], bins + bin_scanned[LINE_POINTS:]])
        colours = SHADOW + tones[columns][:, None] * (ECHO - SHADOW)
        self.footprint.point_data["colour"] = np.repeat(colours.astype(np.uint8), 2, axis=0)


def scan_line(ground: AnyGround, arrays: SceneArrays, pose: Poses) -> ScanLine:
    """Points of the bed under the beam, far port to far starboard, and their slant ranges."""
    reach = arrays.bins * arrays.bin_length
    below = float(np.nan_to_num(ground.height_at(pose.x[:1], pose.y[:1])[0]))  # the mean if there is no bed
    height, squint = float(pose.z[0]) - below, arrays.pattern.centre
    farthest = (squint * reach + height * math.sin(pose.pitch[0])) / math.cos(pose.pitch[0])
    far = math.sqrt(max(reach**2 - height**2 - farthest**2, 0.0))
    across = np.concatenate([np.linspace(far, 0.0, LINE_POINTS), np.linspace(0.0, -far, LINE_POINTS)])
    cos, sin = math.cos(pose.heading[0]), math.sin(pose.heading[0])
    ahead = _ahead(np.hypot(across, height), height, float(pose.pitch[0]), squint)
    x, y = pose.x[0] + ahead * cos - across * sin, pose.y[0] + ahead * sin + across * cos
    z = ground.height_at(x, y)
    z = np.where(np.isnan(z), below, z)
    return np.column_stack([x, y, z]), np.hypot(np.hypot(across, ahead), pose.z[0] - z)


def _ahead(distance: Floats, height: float, pitch: float, squint: float) -> Floats:
    """Distance ahead of the fish at which its beam meets a level bed, given the distance athwart."""
    # With x ahead, the bow's direction (cos p, sin p) and d the distance athwart, the cone is x cos p − h sin p = s
    # √(x² + d²); of the two roots of its square the one on the side of s.
    cos, lean = math.cos(pitch), height * math.sin(pitch)
    square = cos**2 - squint**2
    return np.asarray((cos * lean + squint * np.sqrt(lean**2 + square * distance**2)) / square)
