"""Echoes by way of the sea surface in one plane, by the contributors that return them.

Theory: docs/theory/multipath.md.
"""

from __future__ import annotations

from insonify.compiler.jit import kernel
from insonify.kernels.multipath.image_sources import (
    SECOND_BOTTOM,
    SURFACE_BOTTOM,
    SURFACE_BOTTOM_SURFACE,
    SURFACE_ECHO,
    image_pairs,
    plane_reach,
)
from insonify.kernels.multipath.surface_echo import add_surface_echo
from insonify.kernels.multipath.surface_multipath import add_image_plane
from insonify.kernels.sweep.sweep import LOWEST


@kernel
def note_plane_echoes(arrays, poses, ping, side, path, fan, k, workspace, sink):
    """Note the contributors of the echoes by one propagation path in plane k of a fan.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses
    ping, side : int
    path : int
        By way of the sea surface; the surface's own echo has no plane.
    fan : AzimuthFan
        Of the sonar, or of its image for a path that leaves and returns by the surface.
    k : int
    workspace : MultipathWorkspace
    sink : EchoSink
        Takes the echoes and their contributors.

    Returns
    -------
    bool
        Whether the path is traced at all.
    """
    if path == SURFACE_ECHO:
        if arrays.multipath.surface_echo:
            add_surface_echo(arrays, poses, ping, side, workspace.echoes, sink)
        return arrays.multipath.surface_echo
    pairs = image_pairs(arrays, poses.x[ping], poses.y[ping], poses.z[ping])
    pair, height = pairs[path - SURFACE_BOTTOM], max(poses.z[ping] - arrays.bed.low, LOWEST)
    reach = plane_reach(arrays, pair, fan.reach[k], height)
    reaches = (
        reach if path == SURFACE_BOTTOM else 0.0,
        reach if path == SURFACE_BOTTOM_SURFACE else 0.0,
        reach if path == SECOND_BOTTOM else 0.0,
    )
    add_image_plane(arrays, poses, ping, side, fan, k, pairs, reaches, workspace, sink)
    return pair.farthest > 0.0
