"""Labels of range bins of pings that are traced by refracted rays: greatest contributor and its place.

The echo of every ray and every mixed path is noted like that of the sweep's segments. A bin is in shadow if it holds
no echo although unobstructed rays would land there on the mean bed.
"""

from __future__ import annotations

import numpy as np

from insonify.kernels.common.contributors import add_contribution, open_contributor
from insonify.kernels.common.jit import kernel
from insonify.kernels.common.types import BED
from insonify.kernels.labels.sweep_labels import label_bins
from insonify.kernels.rays.first_echoes import empty_bundle, empty_hits, empty_launch, weigh_by_pattern
from insonify.kernels.rays.launch import find_enclosing_solid, orient_beam, rotate_to_world
from insonify.kernels.refracted_rays.echoes import aim_side, make_waveguide, refracted_echo
from insonify.kernels.refracted_rays.hits import CAUSTIC, LandedRays, empty_arrivals, find_refracted_hits
from insonify.kernels.refracted_rays.mixed_paths import find_mixed_echoes
from insonify.kernels.refracted_rays.probe_rays import CLOSE


@kernel
def label_refracted_pings(arrays, poses, rays, contributions, labels):
    """Label every range bin of pings with its greatest contributor, by refracted rays.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses
        n pings.
    rays : int
        A side.
    contributions : ContributorTable
        Empty, with a row for every contributor.
    labels : BinLabels
        Of n pings; takes the result.

    Returns
    -------
    int
        0, or -1 - k if the sonar is inside body k.
    """
    launch, bundle, hits, arrivals = empty_launch(rays), empty_bundle(rays), empty_hits(rays), empty_arrivals(rays)
    weighed, intensity, silence = np.empty(rays), np.empty(arrays.bins), np.zeros(arrays.bins)
    for ping in range(poses.x.size):
        z = poses.z[ping]
        body = find_enclosing_solid(arrays.solids, poses.x[ping], poses.y[ping], z)
        if body >= 0:
            return -1 - body
        for side in range(2):
            beam = orient_beam(arrays, poses, ping, side)
            waveguide = make_waveguide(arrays, beam)
            landings = aim_side(arrays, waveguide, z, poses.pitch[ping], launch)
            rotate_to_world(launch, beam, bundle)
            find_refracted_hits(arrays, bundle, waveguide.reach, 0.0, hits, arrivals)
            weight = launch.weight
            if arrays.pattern.tabulated:
                weight = weigh_by_pattern(arrays, beam, bundle, hits, launch.weight, weighed)
            intensity[:] = 0.0
            for k in range(rays):
                b, value, cosine = refracted_echo(arrays, hits, arrivals, weight, k)
                _enter(arrays, hits, arrivals, k, b, value, cosine, contributions, intensity)
                # The width of a tube that closes at a caustic is bounded from below.
                if b >= 0 and value > 0.0 and arrivals.tube[k] <= CAUSTIC * arrivals.spread[k]:
                    labels.caustic[ping, side, b] = True
            if landings.fold < np.inf:
                pairs, bins, values = find_mixed_echoes(
                    arrays, beam, waveguide, z, landings, launch, LandedRays(bundle, hits, arrivals)
                )
                for m in range(pairs.size):
                    k = pairs[m]
                    _, _, cosine = refracted_echo(arrays, hits, arrivals, weight, k)
                    _enter(arrays, hits, arrivals, k, bins[m], values[m], cosine, contributions, intensity)
            _mark_landings(landings, arrays.bin_length, contributions.hidden)
            label_bins(contributions, intensity, silence, labels, ping, side)
    return 0


@kernel
def _enter(arrays, hits, arrivals, k, b, value, cosine, contributions, intensity):
    """Note the echo of the hit of ray k."""
    if b < 0 or value <= 0.0:
        return
    body, bodies = hits.body[k], arrays.solids.shape.size
    who = hits.material[k]
    if body != BED:
        target = arrays.solids.target[body] if body < bodies else arrays.mesh.target[body - bodies]
        who = arrays.reflectivity.shape[0] + target
    open_contributor(contributions, who)
    add_contribution(contributions, who, b, value, arrivals.x[k], cosine)
    intensity[b] += value


@kernel
def _mark_landings(landings, bin_length, hidden):
    """Mark the bins in which the mean bed would be visible; those that hold an echo are unmarked later."""
    for i in range(landings.range.size - 1):
        near, far = landings.range[i], landings.range[i + 1]
        # Probe rays this close in elevation that land far apart enclose a jump, in which no ray lands.
        jump = landings.angle[i + 1] - landings.angle[i] < CLOSE
        if near == near and far == far and not jump:
            first, last = int(min(near, far) / bin_length), int(max(near, far) / bin_length)
            hidden[first : min(last, hidden.size)] = True
