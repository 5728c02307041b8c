"""Charts as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from insonify.charts.files import Table

if TYPE_CHECKING:
    from insonify.charts.measure import Chart

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
    "reference_moved",
    "resolved",
    "best_for_its_time",
)


def accuracy_table(chart: Chart) -> Table:
    """Lay the points of a chart of accuracy out as rows."""
    best = {row.name for targets in chart.cases for row in chart.front(targets)}
    rows = []
    for row in chart.rows:
        reference, errors, moved = chart.cases[row.targets].reference, row.errors, row.displacement
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
                reference.moved,
                "yes" if errors.beyond >= reference.floor else "no",
                "yes" if row.name in best else "no",
            )
        )
    return Table({"title": chart.title, "machine": chart.machine, "pings": chart.pings}, ACCURACY_COLUMNS, rows)
