"""Ghosts for tests: seas over small scenes, and a slow, obvious twin of how they are swept."""

from __future__ import annotations

import math

import numpy as np

from beds import solids_of
from insonify.kernels.types import LIGHT, Problem, still_water
from insonify.scene.surface import WAYS, FlatSurface, RoughSurface
from insonify.sound.sea_surface import make_ghosts
from naive import gradients, heights

REFLECTION = 0.4


def under_sea(problem: Problem, surface: float, *ways: str, wind_speed: float = 0.0) -> Problem:
    """Put a sea surface at a height above the datum, of whose ways those named are open; the bed mirrors somewhat."""
    switches = {way: way in ways for way in WAYS}
    sea = FlatSurface(**switches) if wind_speed == 0.0 else RoughSurface(**switches, wind_speed=wind_speed)
    interface = np.tile([REFLECTION, 1.0], (len(problem.reflectivity), 1))
    return problem._replace(water=still_water(surface=surface), ghosts=make_ghosts(sea), interface=interface)


def bright_ball(problem: Problem, centre: tuple[float, float, float], radius: float) -> Problem:
    """Make the bed black and put a bright ball on it."""
    bed = problem.bed._replace(materials=np.ones_like(problem.bed.materials))
    numbers = np.array([[1.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    ball = solids_of([(centre, radius)])
    return problem._replace(bed=bed, reflectivity=numbers, solids=ball, interface=np.tile([REFLECTION, 1.0], (2, 1)))


def image_heights(way: str, altitude: float, depth: float) -> tuple[float, float, float]:
    """Heights above the bed of the two images that a way belongs to, and the energy it has of either order."""
    surface = altitude + 2.0 * depth
    return {
        "surface_bottom": (altitude, surface, 2.0),
        "surface_bottom_surface": (surface, surface, 1.0),
        "second_bottom": (altitude, 3.0 * altitude + 2.0 * depth, 2.0 * REFLECTION**2),
    }[way]


def naive_ghost(problem: Problem, x: float, y: float, z: float, way: str, samples: int = 400) -> np.ndarray:
    """One ghost of a level fish's knife beam over a bed by brute force, (2, bins), heading along +x."""
    out = np.zeros((2, problem.bins))
    reach = problem.bins * problem.bin_length
    edges = np.linspace(0.0, reach, math.ceil(reach / problem.bed.spacing * samples) + 1)
    s, step = 0.5 * (edges[1:] + edges[:-1]), edges[1]
    beneath = float(heights(problem.bed, np.array([x]), np.array([y]))[0])
    one, other, share = image_heights(way, z - beneath, problem.water.surface - z)
    for side, sign in enumerate((1.0, -1.0)):
        bed = heights(problem.bed, np.full(s.size, x), y + sign * s) - beneath
        gx, gy = gradients(problem.bed, np.full(s.size, x), y + sign * s)
        normal = np.sqrt(1.0 + gx**2 + gy**2)
        r, cosine, seen = [], [], np.ones(s.size, bool)
        for height in (one, other):
            slope = (bed - height) / s
            seen &= slope > np.maximum.accumulate(np.concatenate([[-np.inf], slope[:-1]]))
            r.append(np.hypot(s, bed - height))
            cosine.append((sign * gy * s - (bed - height)) / (r[-1] * normal))
        towards = (s**2 + (bed - one) * (bed - other)) / (r[0] * r[1])
        mirrored = np.maximum(2.0 * cosine[0] * cosine[1] - towards, 0.0)
        diffuse, specular, shininess = problem.reflectivity[0]
        lit = seen & (cosine[0] > 0.0) & (cosine[1] > 0.0)
        where = 0.5 * (r[0] + r[1])
        if problem.law == LIGHT:
            shade = diffuse * 0.5 * (cosine[0] + cosine[1]) + specular * mirrored**shininess
            energy = shade * np.abs(np.gradient(where)) / problem.bin_length
        else:
            lobe = specular * (shininess + 2.0) / 2.0 * mirrored**shininess
            sigma = cosine[0] * cosine[1] * (diffuse + lobe) / np.pi
            energy = sigma * normal * step / (r[0] * r[1]) ** 2 * where**4
        k = (where / problem.bin_length).astype(int)
        lit &= k < problem.bins
        out[side] = np.bincount(k[lit], (share * energy)[lit], problem.bins)
    return out * problem.range_factor
