"""The sweep: a few planes cut the scene, one running horizon a plane tells what is heard."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.screen import empty_screen
from insonify.kernels.slice import empty_profile, profile_capacity
from insonify.kernels.sweep import Planes, empty_heard, sweep_pings
from insonify.kernels.types import Poses, Problem
from insonify.kernels.wedge import FADING
from insonify.scene import SceneError
from insonify.tracers.parallel import in_parallel

# Up to this multiple of the altitude the beam's cone is followed azimuth by azimuth; beyond it, where cos θ > 0.9,
# the inner planes begin to stretch with it.
NEAR_FIELD = 2.0647
# Inner planes lie this much further out than the half width divided among them: in the far field a plane at azimuth φ
# stands for the beam direction φ cos θ, with cos θ between 0.9 and 1.
SPLAY = 1.04
OUTER_RATIO = 1.4  # of one outer wedge's end to its beginning


def trace(problem: Problem, poses: Poses, *, planes: int = 16, threads: int | None = None) -> NDArray[np.float32]:
    """Trace pings by the sweep.

    Parameters
    ----------
    problem : Problem
        The scene as kernels see it.
    poses : Poses
        Where the sonar is, n pings.
    planes : int
        Planes across a fan beam; a knife has one.
    threads : int, optional
        Threads to use, all cores when left out. The result does not depend on it.

    Returns
    -------
    (n, 2, bins) float32
        Intensity of the two channels, port first.

    Raises
    ------
    SceneError
        If the sonar runs into a target.
    """
    reach = problem.bins * problem.bin_length
    beam = beam_planes(problem.half_width, planes)
    capacity = profile_capacity(reach, problem.bed.spacing)
    out = np.zeros((poses.x.size, 2, problem.bins), dtype=np.float32)

    def block(first: int, last: int) -> int:
        part = Poses(*(column[first:last] for column in poses))
        room = empty_profile(capacity), empty_heard(capacity), empty_screen(problem.solids, problem.mesh)
        return sweep_pings(problem, part, beam, *room, out[first:last])

    refuse_sonar_inside(problem, in_parallel(block, poses.x.size, threads))
    return out


def refuse_sonar_inside(problem: Problem, statuses: list[int]) -> None:
    """Raise if a kernel met the sonar inside a body, which it tells by -1 - the body's row.

    Raises
    ------
    SceneError
        If a status is below 0.
    """
    for status in statuses:
        if status < 0:
            target = int(problem.solids.target[-1 - status])
            raise SceneError(f"targets.{target}.position: the sonar runs into it; move the target or raise the track")


def beam_planes(half_width: float, planes: int) -> Planes:
    """Place the planes of a beam.

    Parameters
    ----------
    half_width : float
        Of the fan, in radians; 0 for a knife.
    planes : int
        Planes across the fan's far field, made even, so that they come in pairs about athwart.

    Returns
    -------
    Planes
        Inner planes at equal steps across the beam, then outer ones in growing steps towards the bow and the stern:
        near nadir a beam is a cone that takes in all azimuths. Each reaches only as far as the beam hears it; lengths
        are per metre of the sonar's height above the lowest bed, so that every ping has planes of its own.
    """
    if half_width <= 0.0:
        return Planes(*(np.array([value]) for value in (0.0, 0.0, 1.0, 0.0, 0.0, math.inf, math.inf)))
    s_beam = math.sin(half_width)
    pairs = max(1, (planes + 1) // 2)
    inner = np.linspace(0.0, SPLAY * half_width, pairs + 1)
    edges = [math.sin(SPLAY * half_width)]
    while edges[-1] < 1.0:
        edges.append(min(1.0, edges[-1] * OUTER_RATIO))
    azimuths = np.concatenate([inner, np.arcsin(edges[1:])])
    low, high = np.sin(azimuths[:-1]), np.sin(azimuths[1:])
    is_inner = np.arange(low.size) < pairs
    # cos θ = x / r <= s_beam / s_low bounds the ground range of an outer wedge by the height.
    beyond = np.maximum(low**2 - s_beam**2, 1e-30)
    # A little further, for the segment that crosses the border counts by its middle.
    outer_reach = 1.02 * np.minimum(s_beam / np.sqrt(beyond), (1.0 + FADING) * NEAR_FIELD)
    columns = (
        0.5 * (azimuths[:-1] + azimuths[1:]),
        low,
        high,
        np.diff(azimuths),
        np.where(is_inner, half_width / pairs, 0.0),
        np.full(low.size, NEAR_FIELD),
        np.where(is_inner, math.inf, outer_reach),
    )
    mirrored = [np.concatenate([column, column]) for column in columns]
    mirrored[0][low.size :] *= -1.0
    return Planes(*mirrored)
