"""Widgets of the pixel panel."""
