"""Records of pings traced ray by ray, along straight lines or arcs."""

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.rays.cast import (
    add_echoes,
    aim_refracted,
    aim_straight,
    cast_refracted,
    cast_straight,
    echo_rays,
    unaimed,
    weigh_by_pattern,
)
from insonify.kernels.rays.launch import RayLaunch, orient_beam
from insonify.kernels.rays.specular_paths import add_specular_echoes

TOGETHER = 4096  # rays that are cast at a time, so that they stay in the processor cache


@kernel
def trace_straight_pings(arrays, poses, rays, step, out):
    """Intensity per range bin of pings traced ray by ray along straight lines.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses of ndarrays, shape (n,)
    rays : int
        Rays per side.
    step : float
        Length of a step of the march, m; a cell walk if it is 0.
    out : ndarray of float32, shape (n, 2, bins)
        Filled.
    """
    aims, sums = [unaimed(rays), unaimed(rays)], np.empty(arrays.bins)
    near = np.empty(arrays.solids.shape.size, np.int64)
    for ping in range(poses.x.size):
        for side in range(2):
            beam = orient_beam(arrays, poses, ping, side)
            count, aims[side] = aim_straight(arrays, beam, poses.pitch[ping], near, aims[side])
            sums[:] = 0.0
            for first in range(0, rays, TOGETHER):
                some = take_rays(aims[side].launch, first, min(first + TOGETHER, rays))
                landed = cast_straight(arrays, beam, near, count, some, step)
                weight = some.weight
                if arrays.pattern.tabulated:
                    weight = weigh_by_pattern(arrays, beam, landed, weight)
                add_echoes(arrays, echo_rays(arrays, landed, weight), sums)
                if arrays.bounces > 0:
                    add_specular_echoes(arrays, beam, landed.bundle, landed.hits, some.weight, sums)
            _apply_range_factor(arrays, sums, out[ping, side])


@kernel
def trace_refracted_pings(arrays, poses, rays, step, out):
    """Intensity per range bin of pings traced ray by ray along arcs; parameters as of `trace_straight_pings`."""
    aims, sums = [unaimed(rays), unaimed(rays)], np.empty(arrays.bins)
    for ping in range(poses.x.size):
        for side in range(2):
            beam = orient_beam(arrays, poses, ping, side)
            waveguide, aims[side] = aim_refracted(arrays, beam, poses.pitch[ping], aims[side])
            cast = cast_refracted(arrays, beam, waveguide, aims[side], step)
            sums[:] = 0.0
            add_echoes(arrays, cast.echoes, sums)
            _apply_range_factor(arrays, sums, out[ping, side])


@inlined
def take_rays(launch, first, last):
    """Return some of the rays of a side."""
    ahead, abeam, up, weight = launch
    return RayLaunch(ahead[first:last], abeam[first:last], up[first:last], weight[first:last])


@inlined
def _apply_range_factor(arrays, sums, out):
    """Multiply the sums of a side by the range factor: within them, r⁻⁴ would cost digits."""
    for k in range(arrays.bins):
        out[k] = sums[k] * arrays.range_factor[k]
