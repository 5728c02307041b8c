"""Parts of the echo in some range bins where refraction folds: rays, each with what it lands on."""

from __future__ import annotations

import math

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import BED
from insonify.kernels.labels.bed_stretches import BEHIND_TARGET, HEARD
from insonify.kernels.labels.echo_parts import (
    AZIMUTH,
    COSINE,
    ECHO,
    FAR,
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
from insonify.kernels.rays.cast import aim_refracted, cast_refracted, unaimed
from insonify.kernels.rays.launch import orient_beam


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
        Filled; unknown columns of a ray are NaN.

    Returns
    -------
    int
        Parts there are, of which as many are listed as there is room for.
    """
    beam, n = orient_beam(arrays, poses, ping, side), 0
    ahead = math.cos(poses.heading[ping]), math.sin(poses.heading[ping])
    waveguide, aim = aim_refracted(arrays, beam, poses.pitch[ping], unaimed(rays))
    cast = cast_refracted(arrays, beam, waveguide, aim, 0.0)
    for m in range(cast.ray.size):
        n = _list_echo(arrays, cast, ahead, m, HEARD, NO_TARGET, window, rows, n)
    if arrays.solids.shape.size + arrays.mesh.target.size > 0:
        # The bed's echoes of the rays that meet a target first.
        hidden, body = cast_refracted(bare, beam, waveguide, aim, 0.0), cast.rays.hits.body
        for k in range(rays):
            if body[k] >= 0:
                hider = target_of_body(arrays.solids, arrays.mesh, body[k])
                n = _list_echo(arrays, hidden, ahead, k, BEHIND_TARGET, hider, window, rows, n)
    return n


@inlined
def _list_echo(arrays, cast, ahead, m, state, hider, window, rows, n):
    """List echo m of a cast if it lies in the window; return the number of parts."""
    k, b, value, cosine = cast.ray[m], cast.echoes.bin[m], cast.echoes.value[m], cast.echoes.cosine[m]
    inside = b - window.first
    if b < 0 or not 0 <= inside < window.weights.shape[1] or not value > 0.0:
        return n
    if n >= rows.shape[0]:
        return n + 1
    row, bundle, hits, arrivals = rows[n], cast.rays.bundle, cast.rays.hits, cast.rays.arrivals
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
