"""Widgets of the window of jobs."""
