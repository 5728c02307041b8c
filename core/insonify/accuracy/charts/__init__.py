"""Charts, measured on this machine: speed against accuracy, cost against size, error against step or count."""

from insonify.accuracy.charts.convergence import ConvergenceChart, convergence_chart
from insonify.accuracy.charts.cost import CostChart, cost_chart
from insonify.accuracy.charts.measure import Chart, Row, chart

__all__ = ["Chart", "ConvergenceChart", "CostChart", "Row", "chart", "convergence_chart", "cost_chart"]
