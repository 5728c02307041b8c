"""Echoes of bare targets by brute force: a grid of rays in plain NumPy, apart from the program."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from insonify.kernels.common.types import LIGHT, SONAR, SPHERE, SceneArrays, Solids

Array = NDArray[np.float64]
# Takes an origin (3,) and unit directions (..., 3); gives distances, infinite where nothing is met, and the cosines of
# the incidence.
Meeting = Callable[[Array, Array], tuple[Array, Array]]
Material = tuple[float, float, float]


def dot(one: Array, other: Array) -> Array:
    """Scalar products of vectors along the last axis."""
    return np.asarray(np.einsum("...i,...i->...", one, other))


def norm(vectors: Array) -> Array:
    """Lengths of vectors along the last axis."""
    return np.sqrt(dot(vectors, vectors))


def strength(cosine: Array, material: Material, law: int = SONAR, *, other: Any = None, towards: Any = 1.0) -> Array:
    """Backscattering strength or radiance from the cosine of the incidence.

    Between two directions: from both cosines and that of the angle between them, in the mean of both orders.
    """
    diffuse, specular, shininess = material[:3]
    other = cosine if other is None else other
    lobe = specular * np.clip(2.0 * cosine * other - towards, 0.0, None) ** shininess
    if law == LIGHT:
        return 0.5 * diffuse * (cosine + other) + lobe
    return cosine * other / np.pi * (diffuse + 0.5 * (shininess + 2.0) * lobe)


def sphere(centre: ArrayLike, radius: float) -> Meeting:
    """Meeting of rays with a sphere."""

    def meet(origin: Array, way: Array) -> tuple[Array, Array]:
        to_centre = np.asarray(centre) - origin
        along = way @ to_centre
        past = to_centre @ to_centre - along * along
        depth = np.sqrt(np.clip(radius * radius - past, 0.0, None))
        met = (past < radius * radius) & (along > depth)
        return np.where(met, along - depth, np.inf), depth / radius

    return meet


def frustum(start: ArrayLike, end: ArrayLike, first: float, last: float) -> Meeting:
    """Meeting of rays with a cylinder or a cone by its radii at both ends, which are closed."""
    begin, beyond = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(beyond - begin))
    axis, taper = (beyond - begin) / length, (last - first) / length

    def meet(origin: Array, way: Array) -> tuple[Array, Array]:
        along, rate = (origin - begin) @ axis, way @ axis
        off = (origin - begin) - along * axis
        # Of the parts across the axis: products with one another and, as the ways are unit vectors, squares.
        squared, product, out = off @ off, way @ off, 1.0 - rate * rate
        radius, growth = first + taper * along, taper * rate
        a, b, c = out - growth**2, product - growth * radius, squared - radius**2
        best, cosine = np.full(rate.shape, np.inf), np.zeros(rate.shape)
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sqrt(b * b - a * c)
            for t in ((-b - root) / a, (-b + root) / a):
                wide, place = radius + t * growth, along + t * rate
                facing = (taper * rate - (product + t * out) / wide) / np.sqrt(1.0 + taper**2)
                inside = (place >= 0.0) & (place <= length) & (wide > 0.0)
                met = (t > 0.0) & inside & (t < best) & (facing > 0.0)
                best, cosine = np.where(met, t, best), np.where(met, facing, cosine)
            for place, side, wide in ((0.0, -1.0, first), (length, 1.0, last)):
                t = (place - along) / rate
                across = squared + t * (2.0 * product + t * out)
                met = (t > 0.0) & (across <= wide * wide) & (t < best) & (side * rate < 0.0)
                best, cosine = np.where(met, t, best), np.where(met, -side * rate, cosine)
        return best, cosine

    return meet


def box(centre: ArrayLike, axes: Array, half: ArrayLike) -> Meeting:
    """Meeting of rays with a box whose axes are the columns of a rotation."""

    def meet(origin: Array, way: Array) -> tuple[Array, Array]:
        shape = way.shape[:-1]
        distance, leaves, cosine = np.full(shape, -np.inf), np.full(shape, np.inf), np.zeros(shape)
        for axis, extent in zip(np.asarray(axes).T, np.asarray(half)):
            start, own = (origin - np.asarray(centre)) @ axis, way @ axis
            own = np.where(own == 0.0, 1e-30, own)
            one, other = (-extent - start) / own, (extent - start) / own
            enters = np.minimum(one, other)
            cosine = np.where(enters > distance, np.abs(own), cosine)
            distance, leaves = np.maximum(distance, enters), np.minimum(leaves, np.maximum(one, other))
        return np.where((distance < leaves) & (distance > 0.0), distance, np.inf), cosine

    return meet


def triangle(corners: Array) -> Meeting:
    """Meeting of rays with a triangle, seen from either side: Möller and Trumbore (1997)."""
    one, two = corners[1] - corners[0], corners[2] - corners[0]
    normal = np.cross(one, two)

    def meet(origin: Array, way: Array) -> tuple[Array, Array]:
        across, turned = np.cross(way, two), np.cross(origin - corners[0], one)
        with np.errstate(invalid="ignore", divide="ignore"):
            inverse = 1.0 / (across @ one)
            u, v, t = (across @ (origin - corners[0])) * inverse, (way @ turned) * inverse, (two @ turned) * inverse
            hit = np.isfinite(inverse) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        return np.where(hit, t, np.inf), np.where(hit, abs(way @ normal) / np.linalg.norm(normal), 0.0)

    return meet


def solid(solids: Solids, k: int) -> Meeting:
    """Meeting of rays with one of a scene's spheres, cylinders and cones."""
    start, radius, length = solids.start[k], float(solids.radius[k]), float(solids.length[k])
    if solids.shape[k] == SPHERE:
        return sphere(start, radius)
    return frustum(start, start + length * solids.axis[k], radius, radius + solids.taper[k] * length)


def bodies_of(arrays: SceneArrays) -> list[Meeting]:
    """Meetings of rays with every solid of a scene, then with every triangle."""
    solids = [solid(arrays.solids, k) for k in range(arrays.solids.shape.size)]
    return solids + [triangle(corners) for corners in arrays.mesh.corners]


def target_record(
    arrays: SceneArrays,
    meet: Meeting,
    height: float,
    elevations: tuple[float, float],
    across: int = 1500,
    up: int = 3000,
) -> Array:
    """Energy per bin of a scene's target on the port side of a level sonar at (0, 0, height) heading along x.

    A knife (half width 0) has ``across`` times ``up`` rays of one plane, so that both beams are as well resolved.
    """
    half_width, material = arrays.half_width, tuple(arrays.reflectivity[0])
    steps = across * up if half_width == 0.0 else up
    edges = np.linspace(*elevations, steps + 1)
    middles, step = 0.5 * (edges[1:] + edges[:-1]), edges[1] - edges[0]
    record, origin = np.zeros(arrays.bins), np.array([0.0, 0.0, height])
    for theta in np.array_split(middles, max(steps // 64 if half_width > 0.0 else steps // 100_000, 1)):
        theta = theta[:, None]
        cone = np.arcsin(np.sin(half_width) / np.cos(theta))
        azimuth = cone * (2.0 * (np.arange(across) + 0.5) / across - 1.0) if half_width > 0.0 else 0.0 * theta
        level, up = np.cos(theta), np.sin(theta) + 0.0 * azimuth
        distance, cosine = meet(origin, np.stack([level * np.sin(azimuth), level * np.cos(azimuth), up], axis=-1))
        met = np.isfinite(distance) & (cosine > 0.0)
        distance, cosine = np.where(met, distance, 0.0), np.where(met, cosine, 1.0)
        area = distance / cosine * step
        if half_width > 0.0:
            area = area * distance * level * 2.0 * cone / across
        energy = (strength(cosine, material) * area)[met]
        record += np.bincount((distance[met] / arrays.bin_length).astype(int), energy, arrays.bins)[: arrays.bins]
    return record


Response = Callable[[Array, Array], Array]  # two-way, of sines from athwart and slant ranges that broadcast together


def knife(sine: Array, slant_range: Array) -> Array:
    """Response of a beam that is cast in one plane alone."""
    return np.ones(np.broadcast_shapes(sine.shape, slant_range.shape))


def fan(width: float) -> Response:
    """Response of a top-hat of a full width in radians."""
    return lambda sine, slant_range: np.abs(sine) <= np.sin(width / 2.0) + 0.0 * slant_range


def gaussian(width: float) -> Response:
    """Response of a Gaussian beam of a one-way -3 dB width in radians, two ways."""
    return lambda sine, slant_range: np.exp2(-2.0 * (sine / np.sin(width / 2.0)) ** 2) + 0.0 * slant_range


def line_array(length: float, wavelength: float, elements: int = 64) -> Response:
    """Response of a uniform line array, two ways, near field included: Fresnel's approximation about its middle.

    It changes little along the range: it is computed for every quarter of a metre.
    """
    u = ((np.arange(elements) + 0.5) / elements - 0.5) * length

    @cache  # for every body in the same beam
    def energy(r: float, far: float) -> tuple[Array, Array]:
        grid = np.linspace(-far, far, 1201)
        waves = np.exp(2j * np.pi / wavelength * (u**2 / (2.0 * r) - u * grid[:, None]))
        return grid, np.abs(waves.mean(axis=-1)) ** 4

    def respond(sine: Array, slant_range: Array) -> Array:
        far, steps = float(np.abs(sine).max()), np.round(4.0 * slant_range[:, 0]) / 4.0
        return np.array([np.interp(s, *energy(float(r), far)) for s, r in zip(sine, steps)])

    return respond


def shadow_shares(
    targets: list[Meeting],
    respond: Response,
    *,
    height: float,
    bins: int,
    bin_length: float,
    azimuths: ArrayLike,
    per_bin: int = 16,
    along: float = 0.0,
) -> tuple[Array, NDArray[np.int64]]:
    """Share of the echo of a level Lambert bed that targets hide in every bin of the port side, and who hides most.

    Rays are cast from (``along``, 0, ``height``) to a grid of places on the bed, ``per_bin`` slant ranges a bin at
    each of the azimuths, which are equally far apart; a place is hidden if a target is met before it.
    """
    origin, azimuth = np.array([along, 0.0, height]), np.asarray(azimuths, dtype=float)
    whole, hidden = np.zeros(bins), np.zeros((len(targets), bins))
    for first in range(0, bins, 16):
        r = (np.arange(first * per_bin, min(first + 16, bins) * per_bin) + 0.5)[:, None] / per_bin * bin_length
        r = r[r[:, 0] > height]
        if not r.size:
            continue
        level = np.sqrt(1.0 - (height / r) ** 2)
        way = np.stack(np.broadcast_arrays(level * np.sin(azimuth), level * np.cos(azimuth), -height / r), axis=-1)
        # An area of r dr dφ; the rest is the same for all.
        echo = strength(height / r, (1.0, 0.0, 1.0)) * respond(level * np.sin(azimuth), r) * r
        met = [meet(origin, way)[0] for meet in targets]
        k, nearest = (r[:, 0] / bin_length).astype(int), np.minimum.reduce(met)
        whole += np.bincount(k, echo.sum(axis=1), bins)
        for target in range(len(targets)):
            behind = (nearest < r) & (met[target] == nearest)
            hidden[target] += np.bincount(k, np.where(behind, echo, 0.0).sum(axis=1), bins)
    share = hidden.sum(axis=0) / np.where(whole > 0.0, whole, 1.0)
    return share, np.where(share > 0.0, hidden.argmax(axis=0), -2)
