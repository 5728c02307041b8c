"""Echoes by way of the sea surface in one plane, by the contributors that return them.

Theory: docs/theory/multipath.md.
"""

from __future__ import annotations

from insonify.kernels.common.jit import kernel
from insonify.kernels.multipath.image_sources import SURFACE_ECHO, farthest_ground_range, highest_place, image_pair
from insonify.kernels.multipath.surface_echo import add_surface_echo
from insonify.kernels.multipath.surface_multipath import add_image_plane


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
    pair, wanted = image_pair(arrays, path, poses.x[ping], poses.y[ping], poses.z[ping])
    farthest = farthest_ground_range(pair, poses.z[ping] - highest_place(arrays))
    if wanted and farthest > 0.0:
        add_image_plane(arrays, poses, ping, side, fan, k, pair, farthest, workspace, sink)
    return wanted
