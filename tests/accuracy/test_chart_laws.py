"""The charts of cost and convergence, and the laws through them."""

import json
import math

import numpy as np
import pytest

from insonify.accuracy.charts import kinds
from insonify.accuracy.charts.kinds import convergence, cost
from insonify.accuracy.charts.kinds.convergence import ConvergenceChart, ConvergencePoint
from insonify.accuracy.charts.kinds.cost import CostChart, CostRow
from insonify.accuracy.charts.reference import Reference
from insonify.accuracy.charts.style import fit_power_law
from insonify.scene import edit, load_scene

SMALL = edit(
    load_scene("default"),
    {
        "seabed.relief.period": 12.8, "seabed.relief.peaks": [[6.0, 3.0]], "sonar.range": 25.0, "sonar.bins": 100,
        "targets": [], "sonar.beam": {"kind": "fan", "width": 2.0}, "track.pings": 20,
    },
)  # fmt: skip


def test_a_power_law_is_found_with_its_spread():
    x = np.array([1.0, 2.0, 4.0, 8.0])
    found = fit_power_law(x, 3.0 * x**-1.5)
    assert found == pytest.approx((-1.5, 0.0, 3.0), abs=1e-12)
    # By hand: residuals +d, -d, -d, +d of the logarithms leave the slope and have the variance 4 d² / 2.
    bent = fit_power_law(x, x**2 * np.exp([0.1, -0.1, -0.1, 0.1]))
    assert bent.exponent == pytest.approx(2.0)
    assert bent.spread == pytest.approx(math.sqrt(0.04 / 2.0 / (5.0 * math.log(2.0) ** 2)))


def test_too_few_points_make_no_law():
    assert math.isnan(fit_power_law([1.0], [1.0]).exponent)
    assert fit_power_law([1.0], [1.0]).format_exponent() == ""
    assert fit_power_law([1.0, 2.0, 3.0], [0.0, 1.0, math.inf]).format_exponent() == ""
    assert fit_power_law([1.0, 2.0], [1.0, 4.0]).format_exponent() == "2.00"


def test_cost_is_measured_along_every_axis(monkeypatch, tmp_path):
    monkeypatch.setattr(cost, "SECONDS", 0.5)
    monkeypatch.setattr(cost, "TARGETS", (1, 4))
    monkeypatch.setattr(cost, "PINGS", (4, 8, 16, 32))
    monkeypatch.setattr(cost, "STREAMED", (100, 400, 1600))
    monkeypatch.setattr(cost, "SIDES", (128, 256, 512))
    monkeypatch.setattr(cost, "DIVISIONS", (2, 3))
    monkeypatch.setattr(cost, "BINS", (0.5, 1.0, 2.0))
    monkeypatch.setattr(cost, "PLANES", (1, 2, 4))
    told = []
    measured = cost.measure_chart(SMALL, progress=told.append)
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
    measured = convergence.measure_chart(SMALL)
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
    rows = tuple(CostRow("sweep", "planes", n, 10.0 * n + 5.0, 0.01, 2.0) for n in (1.0, 2.0, 4.0))
    CostChart("Pipe", rows, "a machine").save(tmp_path / "cost.png")
    points = tuple(ConvergencePoint("rays", 10.0**k, 10.0**-k, k < 3) for k in range(1, 5))
    right = Reference(np.zeros((1, 2, 4), dtype=np.float32), 1e-4, 1 << 16)
    chart = ConvergenceChart("Pipe", points, right, "a machine")
    chart.save(tmp_path / "convergence.png")
    assert chart.fits()["rays"].exponent == pytest.approx(-1.0)
    assert {path.read_bytes()[:4] for path in tmp_path.iterdir()} == {b"\x89PNG"}


def test_a_kind_of_chart_is_one_new_file(tmp_path, monkeypatch):
    (tmp_path / "weather.py").write_text("def measure_chart(scene, *, progress=None):\n    return scene\n")
    monkeypatch.setattr(kinds, "__path__", [*kinds.__path__, str(tmp_path)])
    assert kinds.list_chart_kinds() == ("accuracy", "convergence", "cost", "weather")
    assert kinds.load_chart_kind("weather")("sunny") == "sunny"
