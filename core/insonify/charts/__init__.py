"""Charts, measured on this machine: speed against accuracy."""

from insonify.charts.measure import Chart, Row, chart

__all__ = ["Chart", "Row", "chart"]
