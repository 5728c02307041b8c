"""Panels of the window, one folder each."""
