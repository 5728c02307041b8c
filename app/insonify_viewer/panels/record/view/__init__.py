"""Widgets of the record panel."""
