"""Widgets of the parameters panel."""
