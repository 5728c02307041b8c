"""Widgets of the lessons panel."""
