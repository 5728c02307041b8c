"""The charts, on a scene small enough to measure in a moment, and the laws through them."""

import csv
import itertools
import json
import math
import time
from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest

from beds import arrays_of, poses_of
from insonify.accuracy.charts import kinds, reference
from insonify.accuracy.charts.kinds import accuracy, convergence, cost
from insonify.accuracy.charts.method_settings import (
    EMBREE_OWN,
    PLAN,
    SWEEPS,
    list_settings,
    pack_for_chart,
    plan_settings,
)
from insonify.accuracy.charts.style import fit_power_law
from insonify.kernels.common.types import no_surface_multipath
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import Displacement, RecordErrors, compare_records, measure_similarity


def row(method, setting, microseconds, error, targets=False):
    errors = RecordErrors(all_bins=error, beyond=error, energy_bias=0.0, dark_leakage=0.0)
    moved = Displacement(0.02, math.nan)
    return accuracy.AccuracyRow(method, setting, 1.0, targets, microseconds, 0.01, errors, moved)


ROWS = (
    row("march", "0.1 m", 500.0, 0.30),
    row("rays", "1,000 rays", 120.0, 0.31),
    row("rays", "4,000 rays", 470.0, 0.08),
    row("sweep", "1 plane", 12.0, 0.01),
)


def made(rows=ROWS):
    poses, arrays = poses_of([0.0, 1.0], 0.0, 8.0), arrays_of(np.zeros((8, 8)), 4.0, periodic=True)
    record = np.ones((2, 2, arrays.bins), dtype=np.float32)
    case = accuracy.TracedScene(arrays, poses, reference.Reference(record, 0.001, 65536))
    records = {each.key: record for each in rows}
    return accuracy.AccuracyChart("Pipe", rows, 2, "a machine, two cores", {False: case}, records)


SMALL = edit(
    load_scene("default"),
    {
        "seabed.relief.period": 12.8, "seabed.relief.peaks": [[6.0, 3.0]], "sonar.range": 25.0, "sonar.bins": 100,
        "targets": [{"kind": "sphere", "position": [0.0, 12.0], "radius": 0.5}],
        "sonar.beam": {"kind": "fan", "width": 2.0}, "track.pings": 20, "track.start": [-2.0, 0.0],
    },
)  # fmt: skip


def test_plans_are_charted_as_their_records_are_made():
    """Some pings take more planes than the plan chooses, so that each keeps the tolerance: the chart times them too."""
    scene = edit(SMALL, {"targets": [{"kind": "pipe", "position": [0.0, 12.0], "heading": 55.0, "length": 8.0}]})
    simulation = prepare(scene)
    poses = simulation.poses(np.arange(20))
    traced = simulation.trace_pings(poses)
    assert traced.planes.max() > simulation.plan.planes
    settings = plan_settings(scene)
    assert [(one.setting, one.size) for one in settings] == [
        ("10 %", 0.1), ("3 %", 0.03), ("1 %", 0.01), ("0.3 %", 0.003), ("0.1 %", 0.001)
    ]  # fmt: skip
    usual = settings[1]
    np.testing.assert_array_equal(usual.trace(poses), traced.echoes)


def test_every_method_is_measured_beside_its_reference(monkeypatch, tmp_path):
    monkeypatch.setattr(accuracy, "PROVING", 1.0)
    monkeypatch.setattr(accuracy, "TIMING", 0.4)
    measured = accuracy.measure_chart(SMALL, pings=2)
    methods = {"march", "rays", "sweep", "sweep, float64", "sweep, every 2nd node", "sweep, every 4th node"}
    methods |= {"sweep, whole segments", "sweep, segments to 3 %", "sweep, segments to 1 %"}
    assert methods <= {row.method for row in measured.rows}
    assert all(row.microseconds > 0.0 and row.spread >= 0.0 for row in measured.rows)
    assert measured.pings == 2
    assert measured.machine
    assert set(measured.scenes) == {False, True}
    of_both = [row.targets for row in measured.rows if not row.method.startswith("embree")]
    assert sum(of_both) == len(of_both) / 2
    for row in measured.rows:
        record, right = measured.normalise_row(row)
        assert record.shape == right.shape == (2, 2, 100)
        assert -1.0 <= measure_similarity(record, right) <= 1.0
    best = min(measured.rows, key=lambda row: row.errors.beyond)
    assert measure_similarity(*measured.normalise_row(best)) > 0.95
    # What the reference does not resolve is said.
    measured.save(tmp_path / "chart.csv")
    with (tmp_path / "chart.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for each in rows:
        floor = 10.0 * float(each["reference_moved"])
        assert each["resolved"] == ("yes" if float(each["error_beyond"]) >= floor else "no")
    # Errors fall with rays, planes and nodes, and hardly with digits.
    for method in ("rays", "sweep"):
        errors = [row.errors.beyond for row in measured.rows if row.method == method and not row.targets]
        assert errors[-1] < 0.2 * errors[0]
    plans = [row for row in measured.rows if row.method == PLAN and not row.targets]
    assert [row.size for row in plans] == sorted((row.size for row in plans), reverse=True)
    assert all(row.errors.beyond <= row.size for row in plans[:3])  # of which the reference resolves the errors
    errors = [row.errors.beyond for row in measured.rows if row.method == "rays" and not row.targets]
    assert all(later < earlier for earlier, later in itertools.pairwise(errors))
    found = {(row.method, row.setting): row for row in measured.rows if not row.targets}
    full, half, quarter, double = (
        found[method, "16 planes"].errors.beyond
        for method in ("sweep", "sweep, every 2nd node", "sweep, every 4th node", "sweep, float64")
    )
    assert full < half < quarter
    assert full == pytest.approx(double, abs=1e-4)
    # How much sooner the sweep is near the truth is said.
    for note, which in zip(measured.summarise(), ("without", "with")):
        assert note.startswith(f"{which} targets: 2 % in ")
        assert float(note.split("× ")[1]) > 1.0
    assert measured.summarise()[2].startswith("plan, ")
    for each in measured.rows_of(targets=True):
        assert np.linalg.norm(measured.split(each)) == pytest.approx(each.errors.beyond)


def test_what_the_division_of_segments_brings_over_a_rough_bed_is_charted():
    arrays, poses = pack_for_chart(edit(load_scene("rough-ground"), {"targets": [], "sonar.beam": "knife"}), 2)
    arrays = arrays._replace(multipath=no_surface_multipath())
    right = reference.trace_exact_rays(arrays, poses, 1 << 15)
    variants = ("whole segments", "segments to 3 %", "segments to 1 %")
    found = {
        one.method: compare_records(arrays, poses, one.trace(poses), right).beyond
        for one in list_settings(arrays, poses)
        if one.method == "sweep" or one.method.removeprefix("sweep, ") in variants
    }
    whole, coarsest, coarser = (found[f"sweep, {variant}"] for variant in variants)
    assert found["sweep"] < coarser < coarsest < 0.2 * whole
    assert found["sweep"] < 0.01


def test_progress_is_reported_and_stops_a_measurement_or_a_reference_after_any_ping(monkeypatch):
    progress = Mock(side_effect=[None] * 4 + [InterruptedError])
    with pytest.raises(InterruptedError):
        accuracy.measure_chart(SMALL, pings=2, progress=progress)
    shares = [call.args[0] for call in progress.call_args_list]
    assert shares == sorted(shares)
    assert all(0.0 <= share <= 1.0 for share in shares)
    trace = Mock(side_effect=lambda *_, **how: time.sleep(0.01))
    monkeypatch.setattr(reference.rays, "trace", trace)
    bounces, poses = arrays_of(np.zeros((8, 8)))._replace(bounces=1), poses_of(np.arange(64.0), 0.0, 8.0)
    with pytest.raises(InterruptedError):
        reference.trace_exact_rays(bounces, poses, 1 << 16, Mock(side_effect=InterruptedError))
    assert trace.call_count < 32


def test_front_keeps_what_none_beats_and_times_are_those_to_come_within_an_error():
    slow = (row("rays", "16,000 rays", 1900.0, 0.005),)
    assert [each.setting for each in made(ROWS + slow).find_front(targets=False)] == ["1 plane", "16,000 rays"]
    # Gains that the reference does not resolve are left out.
    rows = (row("sweep", "1 plane", 12.0, 0.0100), row("sweep", "2 planes", 20.0, 0.0095))
    assert [each.setting for each in made(rows).find_front(targets=False)] == ["1 plane"]  # it moved by 0.001
    whole = made()
    # Straight in the logarithms: halfway between two settings in error is halfway in time.
    assert whole.time_to_error("rays", (0.31 * 0.08) ** 0.5, targets=False) == pytest.approx((120.0 * 470.0) ** 0.5)
    assert whole.time_to_error("sweep", 0.02, targets=False) == 12.0
    assert np.isnan(whole.time_to_error("rays", 0.02, targets=False))
    assert np.isnan(whole.time_to_error("sweep", 0.5 * whole.scenes[False].reference.floor, targets=False))


def test_speeds_are_compared_with_the_division_that_serves_best_at_that_error():
    rays = (row("rays", "16,000 rays", 1900.0, 0.02),)
    divided = row("sweep", "1 plane", 30.0, 0.001)
    whole = (row("sweep, whole segments", "1 plane", 10.0, 0.1), row("sweep, whole segments", "2 planes", 20.0, 0.01))
    lesser = (row("sweep, every 2nd node", "1 plane", 1.0, 0.01), row("sweep, straight", "1 plane", 1.0, 0.01))
    found = made((*rays, divided, *whole, *lesser))
    method, time = found.fastest_sweep(0.02, targets=False)
    assert (method, time) == ("sweep, whole segments", pytest.approx(10.0 * 2.0 ** np.log10(5.0)))
    assert found.describe_speedup(targets=False) == (
        "2 % in 16.2 µs by the sweep (whole segments), in 1.9 ms by exact rays: × 117"
    )
    # An error that whole segments do not reach is that of divided ones.
    assert made((*rays, divided, whole[0])).fastest_sweep(0.02, targets=False) == ("sweep", 30.0)
    assert made((*rays, divided, whole[0])).describe_speedup(targets=False).startswith("2 % in 30 µs by the sweep, in")
    assert made(rays).describe_speedup(targets=False) == ""


def test_tables_hold_what_was_measured_and_other_endings_and_no_pings_are_refused(tmp_path):
    with pytest.raises(SceneError, match=r"chart\.pdf.*\.csv or \.json"):
        made().save(tmp_path / "chart.pdf")
    assert not list(tmp_path.iterdir())
    with pytest.raises(SceneError, match="pings"):
        accuracy.measure_chart(load_scene("default"), pings=0)
    made().save(tmp_path / "chart.csv")
    with (tmp_path / "chart.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [each["method"] for each in rows] == ["march", "rays", "rays", "sweep"]
    assert float(rows[2]["error_beyond"]) == pytest.approx(0.08)
    assert rows[2]["resolved"] == "yes"
    assert rows[0]["machine"] == "a machine, two cores"
    assert rows[0]["echo_position_m"] == ""
    made().save(tmp_path / "chart.json")
    whole = json.loads((tmp_path / "chart.json").read_text(encoding="utf-8"))
    assert whole["machine"] == "a machine, two cores"
    assert whole["rows"][2]["error_beyond"] == 0.08
    assert whole["rows"][2]["echo_position_m"] is None


@pytest.mark.parametrize(("suffix", "magic"), [(".png", b"\x89PNG"), (".svg", b"<?xml")])
def test_picture_is_written_whole(tmp_path, suffix, magic):
    # One method may lack an error altogether.
    made((*ROWS, row("sweep", "2 planes", 20.0, 0.0))).save(tmp_path / f"chart{suffix}")
    written = (tmp_path / f"chart{suffix}").read_bytes()
    assert written.startswith(magic)
    assert b"a machine, two cores" in written
    assert [path.name for path in tmp_path.iterdir()] == [f"chart{suffix}"]


@pytest.mark.parametrize("both", [False, True])
def test_legend_notes_and_headings_are_whole_and_apart(both):
    methods = ("march", "rays", "embree", "sweep", *SWEEPS[1:], EMBREE_OWN, PLAN)
    rows = [row(name, "16", 10.0 + k, 0.1 + 0.01 * k) for k, name in enumerate(methods)]
    chart = made((*rows, *(replace(each, targets=True) for each in rows)))
    scenes = dict.fromkeys((False, True) if both else (False,), chart.scenes[False])
    notes = ("embree: " + 24 * "left out ", "embree: " + 20 * "differs ")
    figure = replace(chart, scenes=scenes, notes=notes).draw()
    figure.canvas.draw()
    whole = figure.bbox
    boxes = [each.get_window_extent() for each in (*figure.texts, *figure.legends, *figure.axes)]
    for one in boxes:
        assert whole.x0 <= one.x0 < one.x1 <= whole.x1
        assert whole.y0 <= one.y0 < one.y1 <= whole.y1
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))


BARE = edit(SMALL, {"targets": []})


def test_a_power_law_is_found_with_its_spread():
    x = np.array([1.0, 2.0, 4.0, 8.0])
    assert fit_power_law(x, 3.0 * x**-1.5) == pytest.approx((-1.5, 0.0, 3.0), abs=1e-12)
    # By hand: residuals +d, -d, -d, +d of the logarithms leave the slope and have the variance 4 d² / 2.
    bent = fit_power_law(x, x**2 * np.exp([0.1, -0.1, -0.1, 0.1]))
    assert bent.exponent == pytest.approx(2.0)
    assert bent.spread == pytest.approx(math.sqrt(0.04 / 2.0 / (5.0 * math.log(2.0) ** 2)))
    # Too few points make no law.
    assert math.isnan(fit_power_law([1.0], [1.0]).exponent)
    assert fit_power_law([1.0], [1.0]).format_exponent() == ""
    assert fit_power_law([1.0, 2.0, 3.0], [0.0, 1.0, math.inf]).format_exponent() == ""
    assert fit_power_law([1.0, 2.0], [1.0, 4.0]).format_exponent() == "2.00"


def test_cost_is_measured_along_every_axis(monkeypatch, tmp_path):
    few = {"SECONDS": 0.5, "TARGETS": (1, 4), "PINGS": (4, 8, 16, 32), "STREAMED": (100, 400, 1600)}
    few |= {"BED_NODES": (128, 256, 512), "DIVISIONS": (2, 3), "BINS": (0.5, 1.0, 2.0), "PLANES": (1, 2, 4)}
    for name, values in few.items():
        monkeypatch.setattr(cost, name, values)
    told = []
    measured = cost.measure_chart(BARE, progress=told.append)
    axes = {
        "pings", "pings of a streamed record", "cells along a profile", "nodes of the bed", "bins a side",
        "targets in the beam", "triangles in the beam", "planes", "rays a side",
    }  # fmt: skip
    assert {row.axis for row in measured.rows} == axes
    assert all(row.microseconds > 0.0 for row in measured.rows)
    streams = [row.megabytes for row in measured.rows if row.axis == "pings of a streamed record"]
    assert len(streams) == 3
    assert max(streams) < 50.0
    beds = [row.megabytes for row in measured.rows if (row.axis, row.method) == ("nodes of the bed", "sweep")]
    assert np.diff(beds) == pytest.approx([9e-6 * (256**2 - 128**2), 9e-6 * (512**2 - 256**2)], rel=0.01)
    assert 0.3 < measured.fits()["rays a side", "rays"].exponent < 2.0  # other work on the machine counts too
    assert told[-1] <= 1.0
    measured.save(tmp_path / "cost.json")
    written = json.loads((tmp_path / "cost.json").read_text(encoding="utf-8"))
    assert len(written["rows"]) == len(measured.rows)
    assert written["machine"]


def test_convergence_has_the_orders_of_the_methods(monkeypatch, tmp_path):
    monkeypatch.setattr(convergence, "PINGS", 4)
    monkeypatch.setattr(convergence, "PROVING", 2.0)
    measured = convergence.measure_chart(BARE)
    fits = measured.fits()
    assert set(fits) == {"rays", "sweep, planes", "march, step in m", "sweep, spacing in m"}
    assert -1.1 < fits["rays"].exponent < -0.5
    # Few points are resolved in so short a time, and they scatter about the second order.
    assert fits["sweep, planes"].exponent + 4.0 * fits["sweep, planes"].spread > -2.0
    assert fits["sweep, planes"].exponent < -0.9
    assert fits["march, step in m"].exponent > 0.4
    assert fits["sweep, spacing in m"].exponent > 0.4
    for suffix in (".csv", ".svg"):
        measured.save(tmp_path / f"convergence{suffix}")
    assert "sweep, planes" in (tmp_path / "convergence.csv").read_text(encoding="utf-8")


def test_pictures_of_laws_are_written(tmp_path):
    rows = tuple(cost.CostRow("sweep", "planes", n, 10.0 * n + 5.0, 0.01, 2.0) for n in (1.0, 2.0, 4.0))
    cost.CostChart("Pipe", rows, "a machine").save(tmp_path / "cost.png")
    points = tuple(convergence.ConvergencePoint("rays", 10.0**k, 10.0**-k, k < 3) for k in range(1, 5))
    right = reference.Reference(np.zeros((1, 2, 4), dtype=np.float32), 1e-4, 1 << 16)
    chart = convergence.ConvergenceChart("Pipe", points, right, "a machine")
    chart.save(tmp_path / "convergence.png")
    assert chart.fits()["rays"].exponent == pytest.approx(-1.0)
    assert {path.read_bytes()[:4] for path in tmp_path.iterdir()} == {b"\x89PNG"}


def test_a_kind_of_chart_is_one_new_file(tmp_path, monkeypatch):
    (tmp_path / "weather.py").write_text("def measure_chart(scene, *, progress=None):\n    return scene\n")
    monkeypatch.setattr(kinds, "__path__", [*kinds.__path__, str(tmp_path)])
    assert kinds.list_chart_kinds() == ("accuracy", "convergence", "cost", "weather")
    assert kinds.load_chart_kind("weather")("sunny") == "sunny"
