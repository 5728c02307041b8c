"""Parts of which the echo in some range bins of one ping is made, by the geometry of the sweep."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from insonify.acoustics.rays import list_rows
from insonify.arrays import Booleans, Floats, Integers
from insonify.kernels.bed.profile import empty_profile, profile_capacity
from insonify.kernels.common.range_bins import FIXED_POINT, RangeBins
from insonify.kernels.common.types import BED, Poses, SceneArrays
from insonify.kernels.labels import echo_parts as kernels
from insonify.kernels.labels.echo_parts import VISIBLE, PartList, Window, list_echo_parts, list_refracted_parts
from insonify.kernels.labels.sweep_labels import NO_MATERIAL
from insonify.kernels.multipath.surface_multipath import empty_multipath_workspace, note_plane_echoes
from insonify.kernels.sweep.bed_stretches import NO_TARGET
from insonify.kernels.sweep.image_paths import SURFACE_BOTTOM, SURFACE_BOTTOM_SURFACE, SURFACE_ECHO
from insonify.kernels.sweep.stretches import StretchSink
from insonify.kernels.sweep.sweep import AzimuthFan, empty_sweep_workspace
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.packing.containment import refuse_sonar_in_target
from insonify.packing.packed_scene import without_targets
from insonify.tracers.azimuth_fan import lay_planes_of_images
from insonify.tracers.labels import contributor_materials, count_contributors, empty_contributions


@dataclass(frozen=True, eq=False)
class EchoParts:
    """Parts of the echo in some range bins of one side of one ping, one entry a part.

    Parts by way of the sea surface lie in the bins alone: their unknown columns are NaN.
    """

    # VISIBLE, BEHIND_BED or BEHIND_TARGET; hidden parts have the echo that they would return were they in sight.
    state: Integers
    path: Integers  # place of the propagation path among `insonify.tracers.labels.PATHS`
    azimuth: Floats  # of the plane in which the part lies, from athwart towards the bow, rad
    target: Integers  # index of the declared target, -1 for the bed; row of the reflectivity table
    material: Integers
    hider: Integers  # index of the target that hides the part, -2 where none does
    # (n, 2) ground range and height above the datum of the bed's highest place, as the sonar sees it, before the
    # part, m.
    crest: Floats
    begin: Floats  # (n, 2) ground range and height above the datum of both ends, m
    end: Floats
    near: Floats  # slant range of both ends, m
    far: Floats
    launch: Floats  # launch angle of the middle above the horizontal, rad
    # Cosine of the incidence, and the scattering strength of the material there, m² per m² and steradian.
    cosine: Floats
    strength: Floats
    # Factor of the beam and of refraction (law `sonar`: m, along the track), of which ``width`` is the part
    # without the response of the beam, ``vertical`` the response of the vertical beam and ``gain`` that of
    # refraction.
    weight: Floats
    width: Floats
    vertical: Floats
    gain: Floats
    echo: Floats  # echo in the bins, weighed by each of three weights
    spread: Floats
    value: Floats

    def take(self, which: Booleans | Integers) -> EchoParts:
        """Return some of the parts, by a mask or by their places."""
        return EchoParts(*(getattr(self, field.name)[which] for field in fields(self)))

    @property
    def middle(self) -> Floats:
        """Ground range and height of the middle of each part, (n, 2) in metres."""
        return 0.5 * (self.begin + self.end)


def find_echo_parts(
    arrays: SceneArrays,
    pose: Poses,
    side: int,
    window: Window,
    *,
    planes: int = 16,
    across: int = 0,
    rays: int = 4000,
) -> EchoParts:
    """Find the parts of which the echo in some range bins is made."""
    _, folded = make_apparent_tables(arrays, pose)
    if folded.any():
        bare = without_targets(arrays)
        beam = arrays, bare, pose, 0, side, rays, window
        return _columns(list_rows(lambda rows: list_refracted_parts(*beam, rows), kernels.COLUMNS))
    fan, image_fan = (laid.of(0) for laid in lay_planes_of_images(arrays, pose, planes, across))
    direct = find_direct_parts(arrays, pose, side, window, fan)
    if not arrays.multipath.enabled:
        return direct
    both = direct, find_surface_parts(arrays, pose, side, window, (fan, image_fan))
    return EchoParts(*(np.concatenate([getattr(one, field.name) for one in both]) for field in fields(EchoParts)))


def take_central_plane(arrays: SceneArrays, fan: AzimuthFan) -> AzimuthFan:
    """Return the plane of a fan that is nearest to the axis of its beam, as a fan of one."""
    k = int(np.argmin(np.abs(np.sin(fan.azimuth) - arrays.pattern.centre)))
    return fan.take(slice(k, k + 1))


def find_direct_parts(arrays: SceneArrays, pose: Poses, side: int, window: Window, fan: AzimuthFan) -> EchoParts:
    """Find the parts by the direct path in the planes of a fan."""
    refuse_sonar_in_target(arrays, pose)
    apparent, _ = make_apparent_tables(arrays, pose)
    workspace = empty_sweep_workspace(arrays, apparent)
    knots = empty_profile(profile_capacity(apparent.stretch * arrays.bins * arrays.bin_length, arrays.bed.spacing))
    bins = RangeBins(np.zeros(arrays.bins + 2, np.int64), arrays.range_decay)

    def fill(rows: Floats) -> int:
        parts = PartList(rows, bins, knots)
        return int(list_echo_parts(arrays, pose, 0, side, fan, apparent, workspace, window, parts))

    return _columns(list_rows(fill, kernels.COLUMNS))


def _columns(rows: Floats, paths: Any = 0) -> EchoParts:
    """Columns of listed parts by one path, or each by its own."""
    k = kernels
    state, target, material, hider = rows[:, [k.STATE, k.TARGET, k.MATERIAL, k.HIDER]].T.astype(np.int64)
    ends: list[Any] = [rows[:, [a, b]] for a, b in ((k.CREST_X, k.CREST_Z), (k.X_FROM, k.Z_FROM), (k.X_TO, k.Z_TO))]
    path = np.broadcast_to(np.asarray(paths, np.int64), len(rows)).copy()
    return EchoParts(state, path, rows[:, k.AZIMUTH], target, material, hider, *ends, *rows[:, k.NEAR :].T)


def find_surface_parts(
    arrays: SceneArrays, pose: Poses, side: int, window: Window, fans: tuple[AzimuthFan, AzimuthFan]
) -> EchoParts:
    """Find the contributors of the echo by way of the sea surface, one part for each of every plane."""
    workspace = empty_multipath_workspace(arrays)
    table = empty_contributions(arrays)
    sink = StretchSink(RangeBins(np.zeros(arrays.bins + 2, np.int64), arrays.range_decay), table, True)
    rows, paths = [np.empty((0, kernels.COLUMNS))], [np.empty(0, np.int64)]
    for path in range(SURFACE_BOTTOM, SURFACE_ECHO + 1):
        fan = fans[1] if path == SURFACE_BOTTOM_SURFACE else fans[0]
        for k in range(fan.azimuth.size if path != SURFACE_ECHO else 1):
            if not note_plane_echoes(arrays, pose, 0, side, path, fan, k, workspace, sink):
                break
            rows.append(_contributor_rows(arrays, sink, window, path, float(fan.azimuth[k])))
            paths.append(np.full(len(rows[-1]), path))
            table.present[:] = False
            sink.bins.steps[:] = 0
    return _columns(np.concatenate(rows), np.concatenate(paths))


def _contributor_rows(arrays: SceneArrays, sink: StretchSink, window: Window, path: int, azimuth: float) -> Floats:
    """Parts by one path in one plane: a contributor's echo in the bins, placed where the strongest of it comes from."""
    k, table, bins = kernels, sink.contributions, slice(window.first, window.first + window.weights.shape[1])
    # Contributors share the energy of a bin, where each is weighed by its own range.
    shares = np.where(table.strongest[table.present, bins] >= 0.0, table.energy[table.present, bins], 0.0)
    listed, whole = shares.sum(axis=0), np.cumsum(sink.bins.steps)[bins] / FIXED_POINT
    shares *= np.divide(whole, listed, out=np.zeros_like(whole), where=listed > 0.0)
    materials, of_surface, found = arrays.reflectivity.shape[0], path == SURFACE_ECHO, []
    for place, energy in zip(np.flatnonzero(table.present), shares):
        value = window.weights[2] * energy
        if not value.any():
            continue
        strongest, contributor = window.first + int(np.argmax(value)), int(place) - path * count_contributors(arrays)
        row = np.full(k.COLUMNS, np.nan)
        row[k.STATE], row[k.AZIMUTH], row[k.HIDER] = VISIBLE, azimuth, NO_TARGET
        row[k.TARGET] = BED if contributor < materials or of_surface else contributor - materials
        row[k.MATERIAL] = NO_MATERIAL if of_surface else contributor_materials(arrays)[contributor]
        row[k.X_FROM] = row[k.X_TO] = table.x[place, strongest]
        row[k.NEAR] = row[k.FAR] = (strongest + 0.5) * arrays.bin_length
        row[k.COSINE] = table.cosine[place, strongest]
        row[k.ECHO], row[k.SPREAD] = window.weights[0] @ energy, window.weights[1] @ energy
        row[k.VALUE] = value.sum()
        found.append(row)
    return np.array(found).reshape(-1, k.COLUMNS)
