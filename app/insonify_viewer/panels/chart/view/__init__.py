"""Widgets of the chart panel."""
