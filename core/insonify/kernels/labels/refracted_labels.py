"""Labels of range bins of pings that are traced by refracted rays: greatest contributor and its place, and shadows.

The echo of every ray and every mixed path is noted like that of the sweep's segments. What targets hide of the bed is
found by the same rays in the scene without targets.
"""

import numpy as np

from insonify.compiler.jit import kernel
from insonify.kernels.common.contributors import add_contribution, open_contributor
from insonify.kernels.common.types import BED
from insonify.kernels.labels.sweep_labels import label_side
from insonify.kernels.rays.cast import aim_refracted, cast_refracted, unaimed
from insonify.kernels.rays.cell_walk import empty_hits
from insonify.kernels.rays.launch import orient_beam
from insonify.kernels.rays.refracted_hits import empty_arrivals, find_refracted_hits
from insonify.kernels.targets.primitives import target_of


@kernel
def label_refracted_pings(arrays, bare, poses, rays, contributors, contributions, out):
    """Label every range bin of pings with its greatest contributor and the shadows of targets, by refracted rays.

    Parameters
    ----------
    arrays, bare : SceneArrays
        The scene, and the same without targets.
    poses : Poses
        n pings.
    rays : int
        A side.
    contributors : Contributors
    contributions : ContributorTable
        Empty.
    out : LabelledPings
        Of n pings; takes the result but for what the sweep traces.
    """
    aim, intensity = unaimed(rays), np.empty(arrays.bins)
    for ping in range(poses.x.size):
        for side in range(2):
            beam = orient_beam(arrays, poses, ping, side)
            waveguide, aim = aim_refracted(arrays, beam, poses.pitch[ping], aim)
            cast = cast_refracted(arrays, beam, waveguide, aim, 0.0)
            intensity[:], place = 0.0, out.places[ping]
            _note_echoes(arrays, cast, contributions, intensity, out.labels.caustic[place, side])
            if contributions.present.size > contributions.first_hidden:
                hidden = cast_refracted(bare, beam, waveguide, aim, 0.0)
                _note_hidden_bed(arrays, 2.0 * waveguide.reach, cast.rays.hits.body, hidden, contributions)
            label_side(contributions, contributors, arrays.reflectivity.shape[0], 1.0, intensity, out, place, side)


@kernel
def _note_echoes(arrays, cast, contributions, intensity, caustic):
    """Note the echoes of one side by their contributors, and mark the bins of rays at a caustic."""
    hits, arrivals, echoes = cast.rays.hits, cast.rays.arrivals, cast.echoes
    for n in range(echoes.ray.size):
        k, b, value, cosine = echoes.ray[n], echoes.bin[n], echoes.value[n], echoes.cosine[n]
        if b < 0 or value <= 0.0:
            continue
        body, who = hits.body[k], hits.material[k]
        if body != BED:
            who = arrays.reflectivity.shape[0] + target_of(arrays.solids.target, arrays.mesh.target, body)
        open_contributor(contributions, who)
        add_contribution(contributions, who, b, value, arrivals.x[k], cosine)
        intensity[b] += value
        # Mixed echoes may come back by a path far from the caustic.
        if arrivals.dark[k] > 0.0 and not 0 <= n - hits.body.size < cast.mixed.ray.size:
            caustic[b] = True


@kernel
def _note_hidden_bed(arrays, reach, first_body, hidden, contributions):
    """Note the echo of the bed that targets hide from rays that meet them, and from mixed paths either way."""
    count, back, echoes = hidden.rays.hits.body.size, hidden.mixed.back, hidden.echoes
    met, arrivals = empty_hits(back.x.size), empty_arrivals(back.x.size)
    find_refracted_hits(arrays, back, reach, 0.0, met, arrivals)
    for n in range(echoes.ray.size):
        b, value, body = echoes.bin[n], echoes.value[n], first_body[echoes.ray[n]]
        if body < 0 and count <= n < count + met.body.size:
            body = met.body[n - count]
        if body >= 0 and b >= 0 and value > 0.0:
            row = contributions.first_hidden + target_of(arrays.solids.target, arrays.mesh.target, body)
            open_contributor(contributions, row)
            contributions.energy[row, b] += value
