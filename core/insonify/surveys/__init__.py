"""Surveys along many lines, labelled data sets, and the mosaic of several records."""

OVERLAPS = ("mean", "last", "strongest", "nearest", "no-nadir")  # which of several records in the same cell counts
ALTITUDES = ("recorded", "bottom-track")
