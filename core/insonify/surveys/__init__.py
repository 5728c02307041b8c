"""Surveys along many lines, labelled data sets, and the mosaic of several records."""

from insonify.foreign_settings import MATPLOTLIB, ignore_settings

OVERLAPS = ("mean", "last", "strongest", "nearest", "no-nadir")  # which of several records in the same cell counts
ALTITUDES = ("recorded", "bottom-track")
ignore_settings(MATPLOTLIB)  # also in the workers
