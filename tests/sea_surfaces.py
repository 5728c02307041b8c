"""Seas for tests over small scenes, and a slow, obvious twin of how their multipath echoes are swept."""

import math
from collections.abc import Callable

import numpy as np

from beds import solids_of
from brute_force import Material, Meeting, Response, dot, norm, strength
from insonify.acoustics.sea_surface import make_surface_multipath
from insonify.kernels.common.types import LIGHT, SceneArrays, still_water
from insonify.scene.water.surfaces import WAYS, FlatSurface, RoughSurface
from naive import gradients, heights, range_factor

REFLECTION = 0.4


def under_sea(arrays: SceneArrays, surface: float, *ways: str, wind_speed: float = 0.0) -> SceneArrays:
    """Put a sea surface at a height above the datum, of whose ways those named are open; the bed mirrors somewhat."""
    switches = {way: way in ways for way in WAYS}
    sea = FlatSurface(**switches) if wind_speed == 0.0 else RoughSurface(**switches, wind_speed=wind_speed)
    interface = np.tile([REFLECTION, 1.0], (len(arrays.reflectivity), 1))
    return arrays._replace(
        water=still_water(surface=surface), multipath=make_surface_multipath(sea), interface=interface
    )


def bright_ball(arrays: SceneArrays, centre: tuple[float, float, float], radius: float) -> SceneArrays:
    """Make the bed black and put a bright ball on it."""
    bed = arrays.bed._replace(materials=np.ones_like(arrays.bed.materials))
    numbers = np.array([[1.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    ball = solids_of([(centre, radius)])
    return arrays._replace(bed=bed, reflectivity=numbers, solids=ball, interface=np.tile([REFLECTION, 1.0], (2, 1)))


def image_heights(way: str, altitude: float, depth: float) -> tuple[float, float, float]:
    """Heights above the bed of the two images that a way belongs to, and the energy it has of either order."""
    surface = altitude + 2.0 * depth
    return {
        "surface_bottom": (altitude, surface, 2.0),
        "surface_bottom_surface": (surface, surface, 1.0),
        "second_bottom": (altitude, 3.0 * altitude + 2.0 * depth, 2.0 * REFLECTION**2),
    }[way]


def naive_ghost(arrays: SceneArrays, x: float, y: float, z: float, way: str, samples: int = 400) -> np.ndarray:
    """One ghost of a level fish's knife beam over a bed by brute force, (2, bins), heading along +x."""
    out = np.zeros((2, arrays.bins))
    reach = arrays.bins * arrays.bin_length
    edges = np.linspace(0.0, reach, math.ceil(reach / arrays.bed.spacing * samples) + 1)
    s, step = 0.5 * (edges[1:] + edges[:-1]), edges[1]
    beneath = float(heights(arrays.bed, np.array([x]), np.array([y]))[0])
    one, other, share = image_heights(way, z - beneath, arrays.water.surface - z)
    for side, sign in enumerate((1.0, -1.0)):
        bed = heights(arrays.bed, np.full(s.size, x), y + sign * s) - beneath
        gx, gy = gradients(arrays.bed, np.full(s.size, x), y + sign * s)
        normal = np.sqrt(1.0 + gx**2 + gy**2)
        r, cosine, seen = [], [], np.ones(s.size, bool)
        for height in (one, other):
            slope = (bed - height) / s
            seen &= slope > np.maximum.accumulate(np.concatenate([[-np.inf], slope[:-1]]))
            r.append(np.hypot(s, bed - height))
            cosine.append((sign * gy * s - (bed - height)) / (r[-1] * normal))
        towards = (s**2 + (bed - one) * (bed - other)) / (r[0] * r[1])
        value = strength(cosine[0], arrays.reflectivity[0], arrays.law, other=cosine[1], towards=towards)
        lit = seen & (cosine[0] > 0.0) & (cosine[1] > 0.0)
        where = 0.5 * (r[0] + r[1])
        if arrays.law == LIGHT:
            energy = value * np.abs(np.gradient(where)) / arrays.bin_length
        else:
            energy = value * normal * step / (r[0] * r[1]) ** 2 * where**4
        k = (where / arrays.bin_length).astype(int)
        lit &= k < arrays.bins
        out[side] = np.bincount(k[lit], (share * energy * range_factor(arrays, where))[lit], arrays.bins)
    return out


def naive_level_ghost(
    arrays: SceneArrays, respond: Response, altitude: float, depth: float, way: str, squint: float = 0.0
) -> np.ndarray:
    """One ghost of a level Lambert bed by a beam of any response, azimuth by azimuth, (bins,) of one side.

    Out in one direction and back from another the response is the root of the product of both two-way ones; law
    `light` divides each by its integral over azimuths.
    """
    one, other, share = image_heights(way, altitude, depth)
    edges = np.linspace(0.0, 1.2 * arrays.bins * arrays.bin_length, 6 * arrays.bins)
    x, step = 0.5 * (edges[1:] + edges[:-1]), edges[1]
    r, s = np.hypot(x, one), np.hypot(x, other)
    azimuth = math.pi * ((np.arange(801) + 0.5) / 801 - 0.5)
    passed = [respond((x / leg)[:, None] * np.sin(azimuth) - math.sin(squint), leg[:, None]) for leg in (r, s)]
    taken_in = np.sqrt(passed[0] * passed[1]).mean(axis=1) * math.pi
    if arrays.law == LIGHT:
        whole = np.sqrt(passed[0].mean(axis=1) * passed[1].mean(axis=1)) * math.pi
        averaged = np.divide(taken_in, whole, out=np.zeros_like(x), where=whole > 0.0)
        energy = 0.25 * (one / r + other / s) * (x / r + x / s) / arrays.bin_length * averaged
    else:
        energy = one * other / (r * s) ** 3 * (0.5 * (r + s)) ** 4 / math.pi * taken_in * x
    up_to = np.concatenate([[0.0], np.cumsum(share * energy * step * range_factor(arrays, 0.5 * (r + s)))])
    where = 0.5 * (np.hypot(edges, one) + np.hypot(edges, other))
    borders = np.arange(arrays.bins + 1) * arrays.bin_length
    return np.asarray(np.diff(np.interp(borders, where, up_to)))


def _last_met(meets: Callable[[np.ndarray], np.ndarray], inside: float, outside: float) -> float:
    """Last angle at which a body is met on the way outside, halved 42 times: 128 places are tried at a time."""
    for _ in range(6):
        places = np.linspace(inside, outside, 129)
        beyond = max(int(np.argmin(np.append(meets(places[:-1]), False))), 1)  # the first place where it is not met
        inside, outside = places[beyond - 1], places[beyond]
    return float(inside)


@np.errstate(invalid="ignore")  # rays that miss a body are infinitely long
def naive_target_ghost(
    arrays: SceneArrays,
    meet: Meeting,
    material: Material,
    altitude: float,
    depth: float,
    way: str,
    *,
    across: int = 1,
    up: int = 20_000,
) -> np.ndarray:
    """One ghost of a convex body without a bed by brute force, (bins,) of the port side of a level fish heading +x.

    ``across`` azimuths of ``up`` launch angles from the lower image, denser towards the body's edges. Places count
    that the higher image meets first too.
    """
    one, other, share = image_heights(way, altitude, depth)
    lower, higher, sine = np.array([0.0, 0.0, one]), np.array([0.0, 0.0, other]), math.sin(arrays.half_width)
    out, widest = np.zeros(arrays.bins), math.asin(min(sine / math.cos(1.3), 1.0))
    for azimuth in widest * (2.0 * (np.arange(across) + 0.5) / across - 1.0):

        def directions(angle: np.ndarray, azimuth: float = azimuth) -> np.ndarray:
            level = np.cos(angle)
            return np.stack([level * math.sin(azimuth), level * math.cos(azimuth), np.sin(angle)], axis=-1)

        def meets(angle: np.ndarray) -> np.ndarray:
            return np.isfinite(meet(lower, directions(angle))[0])

        scan = np.linspace(-1.3, -0.1, 1001)
        seen = np.flatnonzero(np.isfinite(meet(lower, directions(scan))[0]))
        if not seen.size:
            continue
        low, high = _last_met(meets, scan[seen[0]], -1.31), _last_met(meets, scan[seen[-1]], -0.09)
        edges = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(math.pi * np.arange(up + 1) / up)
        angle = 0.5 * (edges[1:] + edges[:-1])
        way = directions(angle)
        (near, cos_near), (ends, _) = meet(lower, way), meet(lower, directions(edges))
        far = norm(lower + near[:, None] * way - higher)
        back = (lower + near[:, None] * way - higher) / far[:, None]
        first, cos_far = meet(higher, back)
        lit = (np.abs(first - far) < 1e-7 * far) & (np.abs(math.sin(azimuth)) * np.cos(angle) <= sine)
        towards, r = dot(way, back), 0.5 * (near + far)
        value = strength(cos_near, material, arrays.law, other=cos_far, towards=towards)
        cone = 2.0 * np.arcsin(np.minimum(sine / np.cos(angle), 1.0))
        if arrays.law == LIGHT:
            beyond = norm(lower + ends[:, None] * directions(edges) - higher)
            energy = value * np.abs(np.diff(0.5 * (ends + beyond))) / arrays.bin_length
            energy *= 2.0 * widest / across / cone if sine > 0.0 else 1.0
        else:
            width = near * np.cos(angle) * 2.0 * widest / across if sine > 0.0 else 1.0
            energy = value * width * near * np.diff(edges) / cos_near * (r * r / (near * far)) ** 2
        lit &= np.isfinite(energy) & (r < arrays.bins * arrays.bin_length)
        energy *= share * range_factor(arrays, r)
        out += np.bincount((r[lit] / arrays.bin_length).astype(int), energy[lit], arrays.bins)
    return out
