"""Choices of a mosaic by their names."""

OVERLAPS = ("mean", "last", "strongest", "nearest")  # of records that hear the same cell
ALTITUDES = ("recorded", "bottom-track")
