"""Widgets of the water panel."""
