"""Labels of range bins of pings that are traced by refracted rays: greatest contributor and its place, and shadows.

The echo of every ray and every mixed path is noted like that of the sweep's segments. What targets hide of the bed is
found by the same rays in the scene without targets.
"""

from __future__ import annotations

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.contributors import add_contribution, open_contributor
from insonify.kernels.common.types import BED
from insonify.kernels.labels.shadows import label_shadows, open_shadow, target_of_body
from insonify.kernels.labels.sweep_labels import label_bins, sum_target_echoes
from insonify.kernels.rays.first_echoes import empty_bundle, empty_hits, empty_launch, weigh_by_pattern
from insonify.kernels.rays.launch import find_enclosing_solid, orient_beam, rotate_to_world
from insonify.kernels.refracted_rays.echoes import aim_side, make_waveguide, refracted_echo
from insonify.kernels.refracted_rays.hits import CAUSTIC, LandedRays, empty_arrivals, find_refracted_hits
from insonify.kernels.refracted_rays.mixed_paths import find_mixed_echoes


@kernel
def label_refracted_pings(arrays, bare, poses, rays, contributions, shadows, labels):
    """Label every range bin of pings with its greatest contributor and the shadows of targets, by refracted rays.

    Parameters
    ----------
    arrays, bare : SceneArrays
        The scene, and the same without targets.
    poses : Poses
        n pings.
    rays : int
        A side.
    contributions : ContributorTable
        Empty, with a row for every contributor.
    shadows : ShadowTable
        Empty, with a row for every target.
    labels : BinLabels
        Of n pings; takes the result.

    Returns
    -------
    int
        0, or -1 - k if the sonar is inside body k.
    """
    launch, bundle, hits, arrivals = empty_launch(rays), empty_bundle(rays), empty_hits(rays), empty_arrivals(rays)
    bare_rays = LandedRays(bundle, empty_hits(rays), empty_arrivals(rays))
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
            _note_rays(arrays, hits, arrivals, weight, contributions, intensity, labels.caustic[ping, side])
            if landings.fold < np.inf:
                landed = LandedRays(bundle, hits, arrivals)
                mixed = find_mixed_echoes(arrays, beam, waveguide, z, landings, launch.weight, landed)
                _note_mixed_paths(arrays, hits, arrivals, mixed, weight, contributions, intensity)
            if shadows.present.size > 0:
                _note_hidden_bed(arrays, bare, beam, waveguide, z, landings, launch, hits, bare_rays, weighed, shadows)
            materials = arrays.reflectivity.shape[0]
            label_shadows(shadows, contributions, materials, labels, ping, side)
            sum_target_echoes(contributions, materials, 1.0, labels.target_echo[ping, side])
            label_bins(contributions, intensity, silence, labels, ping, side)
    return 0


@kernel
def _note_rays(arrays, hits, arrivals, weight, contributions, intensity, caustic):
    """Note the echoes of all hits, and mark the bins of those at a caustic."""
    for k in range(weight.size):
        b, value, cosine = refracted_echo(arrays, hits, arrivals, weight, k)
        _enter(arrays, hits, arrivals, k, b, value, cosine, contributions, intensity)
        # The width of a tube that closes at a caustic is bounded from below.
        if b >= 0 and value > 0.0 and arrivals.tube[k] <= CAUSTIC * arrivals.spread[k]:
            caustic[b] = True


@kernel
def _note_mixed_paths(arrays, hits, arrivals, mixed, weight, contributions, intensity):
    """Note the echoes that go out along one ray and come back along another."""
    for m in range(mixed.ray.size):
        k = mixed.ray[m]
        _, _, cosine = refracted_echo(arrays, hits, arrivals, weight, k)
        _enter(arrays, hits, arrivals, k, mixed.bin[m], mixed.value[m], cosine, contributions, intensity)


@kernel
def _enter(arrays, hits, arrivals, k, b, value, cosine, contributions, intensity):
    """Note the echo of the hit of ray k."""
    if b < 0 or value <= 0.0:
        return
    body = hits.body[k]
    who = hits.material[k]
    if body != BED:
        who = arrays.reflectivity.shape[0] + target_of_body(arrays.solids, arrays.mesh, body)
    open_contributor(contributions, who)
    add_contribution(contributions, who, b, value, arrivals.x[k], cosine)
    intensity[b] += value


@kernel
def _note_hidden_bed(arrays, bare, beam, waveguide, z, landings, launch, hits, bare_rays, weighed, shadows):
    """Note the echo of the bed that targets hide from rays that meet them, and from mixed paths either way."""
    bundle, landed, arrivals = bare_rays.bundle, bare_rays.hits, bare_rays.arrivals
    find_refracted_hits(bare, bundle, waveguide.reach, 0.0, landed, arrivals)
    weight = launch.weight
    if bare.pattern.tabulated:
        weight = weigh_by_pattern(bare, beam, bundle, landed, launch.weight, weighed)
    for k in range(weight.size):
        if hits.body[k] >= 0:
            b, value, _ = refracted_echo(bare, landed, arrivals, weight, k)
            _hide(arrays, hits.body[k], b, value, shadows)
    if landings.fold < np.inf:
        mixed = find_mixed_echoes(bare, beam, waveguide, z, landings, launch.weight, bare_rays)
        met, met_arrivals = empty_hits(mixed.ray.size), empty_arrivals(mixed.ray.size)
        find_refracted_hits(arrays, mixed.back, 2.0 * waveguide.reach, 0.0, met, met_arrivals)
        for m in range(mixed.ray.size):
            out = hits.body[mixed.ray[m]]
            _hide(arrays, out if out >= 0 else met.body[m], mixed.bin[m], mixed.value[m], shadows)


@inlined
def _hide(arrays, body, b, value, shadows):
    """Add echo of the bed to what a body hides, if it is one and the echo has a bin."""
    if body >= 0 and b >= 0 and value > 0.0:
        target = target_of_body(arrays.solids, arrays.mesh, body)
        open_shadow(shadows, target)
        shadows.energy[target, b] += value
