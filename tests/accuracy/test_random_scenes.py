"""The sweep over random scenes full of targets that hide one another, judged by rays.

Errors are shares of the record beyond 1.4 altitudes and over all bins. The judge has noise of its own: *moved* is how
far the last doubling of the rays moved their record, and about half of that is left in it. Shadow edges are where the
reference goes dark or lit for at least two bins. Likewise through thermoclines, by tables against arcs.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from exact_rays import reference
from insonify.acoustics.flat_bed import compute_flat_bed_curves
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import Scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import RecordErrors, compare_records
from insonify.tracers import sweep
from random_scenes import dense_scene

PLANES = 64  # of a fan
ALL, BENT = range(50), range(30)
QUICK = [*((seed, False) for seed in (0, 20, 26, 31, 39)), (0, True), (28, True)]  # seeds, and whether sound bends
MORE = [*((seed, False) for seed in (3, 21, 28, 37, 47)), (3, True), (21, True)]
DARK, LIT = 0.005, 0.1  # of the median of what is heard; what lies between is an edge too faint to have a place
SPAN = 2  # bins that a stretch must last
STRETCHES = 8  # of a side, in which levels are compared


@dataclass(frozen=True)
class Judged:
    """One scene, and how far the sweep is from rays."""

    scene: Scene
    triangles: int
    errors: RecordErrors
    moved: float
    edges: np.ndarray  # bins by which the sweep misses each edge of a shadow
    level: float  # dB, by which it is off in the worst of all stretches

    def line(self) -> str:
        beam, relief = self.scene.sonar.beam, self.scene.seabed.relief
        kinds = " ".join(target.kind for target in self.scene.targets)
        worst = f"{len(self.edges):3d} edges, worst {self.edges.max(initial=0)} bins"
        return (
            f"{self.scene.title:9} {beam.kind:5} {self.scene.sonar.law:5} {relief.kind:7} "
            f"{self.scene.altitude:4.1f} m {self.triangles:5d} triangles: {100 * self.errors.beyond:5.2f} % beyond, "
            f"{100 * self.errors.all_bins:5.2f} % in all, rays moved {100 * self.moved:4.2f} %, {worst}, "
            f"{self.level:4.2f} dB; {kinds}"
        )


def judge(seed: int, folder: Path, tolerance: float, *, bent: bool = False) -> Judged:
    scene, pings = dense_scene(seed, folder, bent=bent)
    simulation = prepare(scene, method="rays", forced={"bending": "on" if bent else "off"})
    assert simulation.arrays.water.bent == bent
    arrays, poses = simulation.arrays, simulation.poses(pings)
    right, moved = reference(arrays, poses, tolerance=tolerance)
    record = sweep.trace(arrays, poses, planes=PLANES)
    errors = compare_records(arrays, poses, record, right)
    edges, level = missed_edges(arrays, poses, record, right), worst_level(record, right)
    return Judged(scene, arrays.mesh.target.size, errors, moved, edges, level)


def worst_level(record: np.ndarray, right: np.ndarray) -> float:
    """Decibels between a record and its reference in the worst stretch of any side that is heard at all."""
    one, other = (
        np.stack([part.sum(axis=-1) for part in np.array_split(r, STRETCHES, axis=-1)]) for r in (record, right)
    )
    heard = other > 1e-3 * other.max()
    return float(np.abs(10.0 * np.log10(one[heard] / other[heard])).max())


def missed_edges(arrays: SceneArrays, poses: Poses, record: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Bins by which a record misses each edge of a shadow in its reference."""
    curves = compute_flat_bed_curves(arrays, poses)
    missed = []
    for a, b, curve in zip(record, right, curves):
        heard = curve[0] > 0.0
        a, b = a[:, heard] / curve[0, heard], b[:, heard] / curve[0, heard]
        typical = np.median(b[b > 0.0])
        for one, other in zip(a / typical, b / typical):
            missed += [*_missed(one, other), *_missed(one[::-1], other[::-1])]
    return np.array(missed, dtype=int)


def _missed(record: np.ndarray, right: np.ndarray) -> list[int]:
    """Likewise for the places of one line where a shadow ends."""
    ends = [
        k
        for k in range(SPAN, right.size - SPAN)
        if (right[k - SPAN : k] < DARK).all() and right[k] >= DARK and (right[k + 1 : k + 1 + SPAN] > LIT).all()
    ]
    risen = 1 + np.flatnonzero((record[:-1] < DARK) & (record[1:] >= DARK))
    return [int(np.abs(risen - k).min(initial=right.size)) for k in ends]


@pytest.mark.parametrize(("seed", "bent"), [*QUICK, *(pytest.param(*each, marks=pytest.mark.slow) for each in MORE)])
def test_the_sweep_is_what_rays_say(seed, bent, tmp_path):
    judged = judge(seed, tmp_path, 0.004 if bent else 0.003, bent=bent)
    assert judged.errors.beyond < (0.015 if bent else 0.012), judged.line()
    assert judged.errors.dark_leakage < 1e-3
    assert judged.edges.max(initial=0) <= 1, judged.line()
    assert not bent or judged.level < 0.1, judged.line()


@pytest.mark.bench
@pytest.mark.parametrize(
    ("seeds", "tolerance", "bent", "median", "worst"),
    [(ALL, 0.001, False, 0.006, 0.02), (BENT, 0.003, True, 0.015, np.inf)],
    ids=["straight", "bent"],
)
def test_many_random_scenes(seeds, tolerance, bent, median, worst, say, tmp_path):
    all_judged = []
    for seed in seeds:
        all_judged.append(judge(seed, tmp_path, tolerance, bent=bent))
        say(all_judged[-1].line())
    errors = np.array([judged.errors.beyond for judged in all_judged])
    edges = np.concatenate([judged.edges for judged in all_judged])
    say(
        f"median {100 * np.median(errors):.2f} %, worst {100 * errors.max():.2f} % (rays' own noise included); "
        f"{100 * (edges <= 1).mean():.1f} % of {edges.size} edges of shadows within a bin, worst {edges.max()}"
    )
    assert np.median(errors) < median
    assert errors.max() < worst
    assert (edges <= 1).mean() > 0.99
    assert not bent or np.median([judged.level for judged in all_judged]) < 0.1
