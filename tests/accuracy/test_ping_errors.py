"""Errors that pings estimate against those found, in scenes laid out on purpose; all of them with `-m slow`.

Targets of every kind lie along, across and oblique to the track, near and far, their ends at any phase between planes,
on level and rough beds. The reference has 256 planes, and 16 across each target.
"""

import contextlib
import itertools

import numpy as np
import pytest

from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tow.poses import take_poses
from insonify.tracers import sweep
from random_scenes import short_scene, wide_scene

DEFAULT = load_scene("default")
ROUGH = {"kind": "fractal", "beta": 1.4, "period": 51.2, "rms": 0.05, "peaks": [[8.0, 4.0]]}
TARGETS = {
    "pipe": {"kind": "pipe", "radius": 0.15, "length": 6.0},
    "short pipe": {"kind": "pipe", "radius": 0.2, "length": 1.2},
    "box": {"kind": "box", "size": [4.0, 0.8, 0.6]},
    "cube": {"kind": "box", "size": [0.8, 0.8, 0.8]},
    "sphere": {"kind": "sphere", "radius": 0.5},
    "cone": {"kind": "cone", "radius": 0.5, "height": 1.0},
    "wreck": {"kind": "wreck"},
}
LAID_OUT = list(itertools.product(TARGETS, (0.0, 7.0, 90.0), (14.0, 32.0), (0.8, 2.5), ("flat", "rough")))
QUICK = range(0, len(LAID_OUT), 29)
PINGS = np.arange(40)


def lay_out(number):
    """A scene of the table, which 40 pings pass."""
    name, heading, away, width, bed = LAID_OUT[number]
    turned = {} if name == "sphere" else {"heading": heading}
    target = TARGETS[name] | turned | {"position": [5.0 + 0.25 * (0.618 * number % 1.0), away], "material": "steel"}
    return edit(
        DEFAULT,
        {
            "targets": [target],
            "seabed.relief": "flat" if bed == "flat" else ROUGH,
            "sonar": {"beam": {"kind": "fan", "width": width}, "range": 45.0, "bins": 900, "ping_rate": 1.0},
            "track": {"altitude": 10.0, "pings": PINGS.size, "speed": 0.25},
        },
    )


def judge(scene, tolerance, pings=PINGS):
    """Errors of the whole record and of each ping, found and estimated."""
    simulation = prepare(scene, tolerance=tolerance)
    poses = simulation.poses(pings)
    traced = simulation.trace_pings(poses)
    rays = {"rays": simulation.plan.model.rays} if simulation.plan.model.bent else {}
    right = sweep.trace(simulation.reduced, poses, planes=256, across=16, **rays)

    def found(pings):
        errors = compare_records(simulation.arrays, take_poses(poses, pings), traced.echoes[pings], right[pings])
        return max(errors.beyond, errors.all_bins)

    estimated = simulation.errors(traced.squares.sum(axis=1))
    each = np.array([found(slice(k, k + 1)) for k in range(pings.size)])
    return found(slice(None)), each, estimated


@pytest.mark.parametrize(
    "number",
    [pytest.param(k, marks=() if k in QUICK else pytest.mark.slow) for k in range(len(LAID_OUT))],
    ids=lambda k: "-".join(str(each) for each in LAID_OUT[k]),
)
def test_records_keep_to_their_tolerance_and_nearly_all_pings_do(number):
    for tolerance in (0.03, 0.01):
        record, each, estimated = judge(lay_out(number), tolerance)
        assert record <= tolerance
        over = each > 1.5 * tolerance
        assert over.sum() <= 1
        assert (each <= np.maximum(1.25 * estimated, 0.5 * tolerance)).mean() >= 0.9


def test_what_hangs_in_the_water_column_keeps_to_the_tolerance_by_its_own_norm():
    ball = {"kind": "sphere", "radius": 0.5, "position": [5.0, 15.0, -30.0], "material": "steel"}
    changes = {"seabed.depth": 60.0, "seabed.relief": "flat", "targets": [ball], "track.altitude": 40.0}
    simulation = prepare(edit(lay_out(0), changes | {"sonar.range": 80.0, "sonar.bins": 1600}))
    poses = simulation.poses(PINGS)
    record, right = simulation.trace(poses), sweep.trace(simulation.reduced, poses, planes=256, across=32)
    column = slice(0, int(39.0 / 0.05))
    missed, whole = (np.linalg.norm(each[:, :, column].astype(float)) for each in (record - right, right))
    assert whole > 0.0
    assert missed < 0.03 * whole


@pytest.mark.bench
@pytest.mark.parametrize("tolerance", [0.03, 0.01, 0.003])
@pytest.mark.parametrize(("draw", "seed"), [(wide_scene, 830_000), (short_scene, 930_000)], ids=["wide", "short"])
def test_pings_of_random_scenes(draw, seed, tolerance, say, tmp_path):
    records, found, estimated = [], [], []
    for number in range(seed, seed + 100):
        scene, *_ = draw(number, tmp_path)
        if not scene.sonar.beam.has_width:
            continue
        pings = np.unique(np.linspace(0, scene.track.pings - 1, 32).astype(np.int64))
        with contextlib.suppress(SceneError):  # a target that holds the sonar
            record, *of_pings = judge(scene, tolerance, pings)
            records.append(record)
            found.append(of_pings[0])
            estimated.append(of_pings[1])
    records, found, estimated = np.array(records), np.concatenate(found), np.concatenate(estimated)
    ratio = (found / np.maximum(estimated, 1e-9))[found > 2e-4]
    figures = {
        "records kept": records <= tolerance,
        "records within 1.5 times": records <= 1.5 * tolerance,
        "pings kept": found <= tolerance,
        "pings within 1.5 times": found <= 1.5 * tolerance,
        "found within 1.25 times the estimate": ratio <= 1.25,
        "estimated within 3 times what is found": ratio >= 1.0 / 3.0,
    }
    shares = ", ".join(f"{name} {100.0 * each.mean():.1f} %" for name, each in figures.items())
    say(f"{draw.__name__} {100.0 * tolerance:g} %, {records.size} records, {found.size} pings: {shares}")
    assert figures["records within 1.5 times"].mean() >= 0.9
