"""Waters of tests, and rays through them one at a time."""

import math

import numpy as np

from insonify.acoustics.rays import follow_paths
from insonify.compiler.jit import kernel
from insonify.kernels.common.types import Water
from insonify.kernels.rays.cell_walk import RayBundle, empty_hits
from insonify.kernels.rays.refracted_hits import empty_arrivals, find_refracted_hits
from insonify.kernels.refraction.arcs import advance_in_layers, launch_in_layers
from insonify.kernels.refraction.eigenrays import find_direct_ray, follow_to_range
from insonify.kernels.refraction.ray_paths import RayLimits

NO_FLOOR, NO_CEILING = -math.inf, math.inf


def layers(depths, speeds):
    """Nodes as kernels take them, heights above the sea surface ascending."""
    return -np.array(depths, float)[::-1], np.array(speeds, float)[::-1].copy()


def gradient(speed, per_metre, depth=1e5):
    return layers([0.0, depth], [speed, speed + per_metre * depth])


@kernel
def launched(height, speed, z, cosine, sine):
    return launch_in_layers(height, speed, z, cosine, sine)


@kernel
def stepped(height, speed, ray, x_end, low, high):
    return advance_in_layers(height, speed, ray, x_end, low, high)


def downward(water, depth, degrees):
    """A ray launched at so many degrees below the horizontal."""
    angle = math.radians(degrees)
    return launched(*water, -depth, math.cos(angle), -math.sin(angle))


def shot(water, depth, degrees, x_end=math.inf, bottom=math.inf, surface=NO_CEILING):
    return follow_to_range(*water, downward(water, depth, degrees), x_end, -bottom, surface)


def joined(water, depth, x, to_depth):
    """The ray between two points, and its launch angle below the horizontal in degrees."""
    status, ray = find_direct_ray(*water, -depth, -to_depth, x, NO_FLOOR, NO_CEILING)
    return status, ray, math.degrees(math.atan2(-ray.sine0, ray.cosine0))


def water_of(height, speed, station=(0.0,), *, reference=1500.0, surface=0.0):
    """Lay water out as tracers take it: speeds at ascending heights, below a sea surface."""
    speed = np.atleast_2d(np.asarray(speed, float))
    return Water(True, np.asarray(height, float), speed, np.asarray(station, float), 1.0, 0.0, reference, surface)


def water_about(sonar, height, speed, surface=1e4):
    """Water whose reference is the speed at the height of a sonar."""
    return water_of(height, speed, reference=float(np.interp(sonar, height, speed)), surface=surface)


def followed(water, depth, degrees, ranges, bottom=math.inf, surface=NO_CEILING, mirrored=False):
    """Follow rays launched at so many degrees below the horizontal, to the last of some ranges."""
    ranges = np.asarray(ranges, float)
    limits = RayLimits(float(ranges[-1]), -float(bottom), surface, False, mirrored)
    return follow_paths(water, -float(depth), -np.radians(np.atleast_1d(degrees).astype(float)), ranges, limits)


def land(arrays, start, directions, reach=1000.0):
    """First hits of a scene by rays along arcs in directions (n, 3) from one place or many, and how they arrive."""
    columns = np.broadcast_arrays(*start, *np.asarray(directions, float).T)
    bundle = RayBundle(*(np.ascontiguousarray(column, dtype=float) for column in columns))
    hits, arrivals = empty_hits(bundle.x.size), empty_arrivals(bundle.x.size)
    find_refracted_hits(arrays, bundle, reach, 0.0, hits, arrivals)
    return hits, arrivals
