"""Charts as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from insonify.accuracy.charts.files import Table

if TYPE_CHECKING:
    from insonify.accuracy.charts.convergence import ConvergenceChart
    from insonify.accuracy.charts.cost import CostChart
    from insonify.accuracy.charts.measure import Chart

ACCURACY_COLUMNS = (
    "method",
    "setting",
    "targets",
    "microseconds_per_ping",
    "spread",
    "error_beyond",
    "error_all_bins",
    "energy_bias",
    "dark_leakage",
    "shadow_edge_m",
    "echo_position_m",
    "echoes_lost",
    "reference_moved",
    "reference_moved_all_bins",
    "resolved",
    "best_for_its_time",
)
COST_COLUMNS = ("method", "axis", "size", "microseconds", "spread", "exponent", "exponent_spread")
CONVERGENCE_COLUMNS = ("series", "size", "error_beyond", "resolved", "exponent", "exponent_spread")


def accuracy_table(chart: Chart) -> Table:
    """Lay the points of a chart of accuracy out as rows."""
    best = {row.name for targets in chart.cases for row in chart.front(targets)}
    rows = []
    for row in chart.rows:
        reference, errors, moved = chart.cases[row.targets].judge(row.method), row.errors, row.displacement
        rows.append(
            (
                row.method,
                row.setting,
                "with" if row.targets else "without",
                row.microseconds,
                row.spread,
                errors.beyond,
                errors.all_bins,
                errors.energy_bias,
                errors.dark_leakage,
                moved.shadow_edge,
                moved.echo,
                moved.lost,
                reference.moved,
                reference.moved_all,
                "yes" if errors.beyond >= reference.floor else "no",
                "yes" if row.name in best else "no",
            )
        )
    facts = {"title": chart.title, "machine": chart.machine, "pings": chart.pings, "notes": "; ".join(chart.told)}
    return Table(facts, ACCURACY_COLUMNS, rows)


def cost_table(chart: CostChart) -> Table:
    """Lay a chart of cost out as rows, each with the law that was fitted through its axis."""
    fits = chart.fits()
    rows = [
        (row.method, row.axis, row.size, row.microseconds, row.spread, *fits[row.axis, row.method][:2])
        for row in chart.rows
    ]
    return Table({"title": chart.title, "machine": chart.machine}, COST_COLUMNS, rows)


def convergence_table(chart: ConvergenceChart) -> Table:
    """Lay a chart of convergence out as rows, each with the order that was fitted through its series."""
    fits = chart.fits()
    rows = [
        (point.series, point.size, point.error, "yes" if point.resolved else "no", *fits[point.series][:2])
        for point in chart.points
    ]
    facts = {"title": chart.title, "machine": chart.machine, "reference_moved": chart.reference.moved}
    return Table(facts, CONVERGENCE_COLUMNS, rows)
