"""A simulation that costs nothing: numbers one can predict, in the shapes of the real one."""

from contextlib import suppress
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.packing.scene_arrays import pack_scene
from insonify.planning import Plan
from insonify.planning import plan as make_plan
from insonify.receiver.reception import assemble
from insonify.receiver.stage import ReceiverSetup
from insonify.scene import Scene, SceneError, edit
from insonify.scene.seabed import Seabed
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify.terrain.ground import Ground
from insonify.tow.line import tow_line_at
from insonify.tow.poses import make_poses
from insonify.tracers.labels import RecordLabels


def plan_of(scene: Scene, tolerance: float, forced: frozenset[tuple[str, str]]) -> Plan:
    """Plan of a scene like this one, of which no stand-in traces a ping: words, seed and altitude may be others."""
    usual = {"title": "", "description": "", "seed": 0} | ({"track.altitude": 10.0} if scene.track.altitude else {})
    with suppress(SceneError):  # where a fish at that altitude would be above the surface
        scene = edit(scene, usual)
    return _plan_once(scene, tolerance, forced)


@lru_cache(maxsize=256)
def _plan_once(scene: Scene, tolerance: float, forced: frozenset[tuple[str, str]]) -> Plan:
    """Plan of a scene, made once for all windows that show one like it."""
    return make_plan(scene, tolerance, forced=dict(forced))


class StandIn:
    """Amplitude of ping p in bin k: diffuse share × (1 + (p mod 7) / 10), zero in the nearest tenth of the bins."""

    def __init__(
        self, scene: Scene, tolerance: float, forced: dict[str, str] | None = None, plan: Plan | None = None
    ) -> None:
        if scene.seed == 666:
            raise SceneError("seed: 666 is refused by the stand-in; take another")
        self.scene, self.tolerance, self.forced = scene, tolerance, forced
        self.ground = ground_of(scene.seabed)
        self.arrays = pack_scene(scene, self.ground)
        self.plan = plan or plan_of(scene, tolerance, frozenset((forced or {}).items()))
        self.reception = assemble(ReceiverSetup(scene, self.arrays, altitude=scene.altitude, depth=0.0))
        self.curve = self.reception.expected(flat_bed_curve(self.arrays, scene.altitude))

    def poses(self, pings: NDArray[np.int64]) -> Any:
        return make_poses(self.scene, self.ground, pings)

    def line(self, pings: NDArray[np.int64]) -> Any:
        return tow_line_at(self.scene, pings)

    def altitude(self, pings: NDArray[np.int64]) -> NDArray[np.float64]:
        return self.poses(pings).z

    def pings_within(self, seconds: float) -> int:
        return 64

    def expect(self, pings: NDArray[np.int64]) -> None:
        pass

    def intensity(self, pings: NDArray[np.int64]) -> NDArray[np.float32]:
        bins = self.scene.sonar.bins
        amplitude = np.zeros((len(pings), 2, bins))
        diffuse = self.ground.reflectivities[0].diffuse
        amplitude[:, :, bins // 10 :] = diffuse * (1.0 + (pings % 7)[:, None, None] / 10.0)
        return np.asarray(amplitude**2 * np.maximum(self.curve, 1e-30), dtype=np.float32)

    def trace_record(self, pings: NDArray[np.int64]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Intensity, and errors of 1, 2 .. 7 % in turns."""
        return self.intensity(pings), (0.01 * (1 + pings % 7)).astype(np.float32)

    def truth(self, pings: NDArray[np.int64]) -> RecordLabels:
        """Bed past the water column; target 0 in bin 70, its shadow in 71; a ghost in 80; none in 90; volume 0 in 5."""
        shape = (len(pings), 2, self.scene.sonar.bins)
        first = self.scene.sonar.bins // 10
        target, path = np.full(shape, -2, np.int16), np.full(shape, -1, np.int8)
        target[..., first:], path[..., first:] = -1, 0
        target[..., 70], target[..., [71, 90]], path[..., [71, 90]] = 0, -2, -1
        path[..., 80] = 1
        material = np.where(target == -1, 0, np.where(target == 0, 1, -1)).astype(np.int16)
        shadow, by = np.zeros(shape, np.float32), np.full(shape, -2, np.int16)
        shadow[..., 71], by[..., 71] = 1.0, 0
        shadow[..., 72], by[..., 72] = 0.3, 0
        heard = np.where(target > -2, 1.0, np.nan)
        volume = np.full(shape, -2, np.int16)
        volume[..., 5] = 0 if self.scene.volumes else -2
        slant = (np.arange(shape[-1]) + 0.5) * self.scene.sonar.range / shape[-1]
        flat = np.sqrt(np.maximum(slant**2 - self.scene.altitude**2, 0.0))
        return RecordLabels(
            target, material, shadow, by, (heard * flat).astype(np.float32), (heard * 40.0).astype(np.float32), path,
            volume, np.zeros(shape, bool), np.zeros((len(pings), 2, 1), np.float32),
        )  # fmt: skip


@lru_cache(maxsize=64)
def ground_of(seabed: Seabed) -> Ground:
    """A ripple of 1 cm under everything; the same ground for the same seabed, as in a real simulation."""
    n = 64
    heights = np.tile(0.01 * np.sin(2 * np.pi * np.arange(n) / 8), (n, 1))
    material = seabed.material
    name = material.name if material.kind == "uniform" else material.of[0].name
    numbers = material.reflectivity if material.kind == "uniform" else MATERIALS[name].reflectivity
    return Ground(
        heights.astype(np.float32), np.zeros((n, n), np.uint8), (name,), (numbers,),
        x0=0.0, y0=0.0, spacing=0.5, periodic=True, datum=-seabed.depth,
    )  # fmt: skip
