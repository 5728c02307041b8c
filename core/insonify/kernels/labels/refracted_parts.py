"""Parts of the echo in some range bins where refraction folds: rays, each with what it lands on."""

from __future__ import annotations

import math

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import BED
from insonify.kernels.labels.echo_parts import (
    AZIMUTH,
    BEHIND_TARGET,
    COSINE,
    ECHO,
    FAR,
    HEARD,
    HIDER,
    LAUNCH,
    MATERIAL,
    NEAR,
    STATE,
    STRENGTH,
    TARGET,
    X_FROM,
    X_TO,
    Z_FROM,
    Z_TO,
)
from insonify.kernels.labels.shadows import NO_TARGET, target_of_body
from insonify.kernels.rays.first_echoes import empty_bundle, empty_hits, empty_launch, weigh_by_pattern
from insonify.kernels.rays.launch import orient_beam, rotate_to_world
from insonify.kernels.refracted_rays.echoes import aim_side, make_waveguide, refracted_echo
from insonify.kernels.refracted_rays.hits import LandedRays, empty_arrivals, find_refracted_hits
from insonify.kernels.refracted_rays.mixed_paths import find_mixed_echoes


@kernel
def list_refracted_parts(arrays, bare, poses, ping, side, rays, window, rows):
    """List the rays of one side of one ping that echo in some range bins, and those that targets keep from the bed.

    Parameters
    ----------
    arrays, bare : SceneArrays
        The scene, and the same without targets.
    poses : Poses
    ping, side, rays : int
    window : Window
    rows : ndarray of float64, shape (room, COLUMNS)
        Filled; what is not known of a ray is NaN.

    Returns
    -------
    int
        Parts there are, of which as many are listed as there is room for.
    """
    launch, bundle, hits, arrivals = empty_launch(rays), empty_bundle(rays), empty_hits(rays), empty_arrivals(rays)
    z, n = poses.z[ping], 0
    beam = orient_beam(arrays, poses, ping, side)
    ahead = math.cos(poses.heading[ping]), math.sin(poses.heading[ping])
    waveguide = make_waveguide(arrays, beam)
    landings = aim_side(arrays, waveguide, z, poses.pitch[ping], launch)
    rotate_to_world(launch, beam, bundle)
    find_refracted_hits(arrays, bundle, waveguide.reach, 0.0, hits, arrivals)
    weight, weighed = launch.weight, np.empty(rays)
    if arrays.pattern.tabulated:
        weight = weigh_by_pattern(arrays, beam, bundle, hits, launch.weight, weighed)
    landed = LandedRays(bundle, hits, arrivals)
    for k in range(rays):
        b, value, cosine = refracted_echo(arrays, hits, arrivals, weight, k)
        n = _list_ray(arrays, landed, ahead, k, b, value, cosine, HEARD, NO_TARGET, window, rows, n)
    if landings.fold < math.inf:
        mixed = find_mixed_echoes(arrays, beam, waveguide, z, landings, launch.weight, landed)
        for m in range(mixed.ray.size):
            k = mixed.ray[m]
            _, _, cosine = refracted_echo(arrays, hits, arrivals, weight, k)
            n = _list_ray(arrays, landed, ahead, k, mixed.bin[m], mixed.value[m], cosine, HEARD, NO_TARGET, window,
                          rows, n)  # fmt: skip
    if arrays.solids.shape.size + arrays.mesh.target.size > 0:
        n = _list_hidden(arrays, bare, landed, beam, waveguide, launch.weight, ahead, window, rows, n)
    return n


@kernel
def _list_hidden(arrays, bare, met, beam, waveguide, weight, ahead, window, rows, n):
    """List the bed's echoes of the rays that meet a target first."""
    count = weight.size
    landed = LandedRays(met.bundle, empty_hits(count), empty_arrivals(count))
    find_refracted_hits(bare, landed.bundle, waveguide.reach, 0.0, landed.hits, landed.arrivals)
    if bare.pattern.tabulated:
        weight = weigh_by_pattern(bare, beam, landed.bundle, landed.hits, weight, np.empty(count))
    for k in range(count):
        if met.hits.body[k] >= 0:
            b, value, cosine = refracted_echo(bare, landed.hits, landed.arrivals, weight, k)
            hider = target_of_body(arrays.solids, arrays.mesh, met.hits.body[k])
            n = _list_ray(arrays, landed, ahead, k, b, value, cosine, BEHIND_TARGET, hider, window, rows, n)
    return n


@inlined
def _list_ray(arrays, landed, ahead, k, b, value, cosine, state, hider, window, rows, n):
    """List the echo of ray k in bin b; return the number of parts."""
    inside = b - window.first
    if b < 0 or not 0 <= inside < window.weights.shape[1] or not value > 0.0:
        return n
    if n >= rows.shape[0]:
        return n + 1
    row, bundle, hits, arrivals = rows[n], landed.bundle, landed.hits, landed.arrivals
    row[:] = math.nan
    body, material = hits.body[k], hits.material[k]
    row[STATE], row[HIDER], row[MATERIAL], row[TARGET] = state, hider, material, BED
    if body != BED:
        row[TARGET] = target_of_body(arrays.solids, arrays.mesh, body)
    forward = bundle.dx[k] * ahead[0] + bundle.dy[k] * ahead[1]
    level = math.sqrt(bundle.dx[k] * bundle.dx[k] + bundle.dy[k] * bundle.dy[k])
    row[AZIMUTH] = math.asin(min(max(forward / level, -1.0), 1.0)) if level > 0.0 else 0.0
    row[X_FROM], row[Z_FROM], row[X_TO], row[Z_TO] = arrivals.x[k], arrivals.z[k], arrivals.x[k], arrivals.z[k]
    row[NEAR], row[FAR], row[LAUNCH] = hits.distance[k], hits.distance[k], math.asin(bundle.dz[k])
    row[COSINE] = cosine
    numbers = arrays.reflectivity[material]
    row[STRENGTH] = backscatter_strength(cosine, numbers[0], numbers[1], numbers[2], arrays.law)
    for what in range(3):
        row[ECHO + what] = window.weights[what, inside] * value
    return n + 1
