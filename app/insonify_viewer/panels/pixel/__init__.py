"""Pixel panel: what one pixel of the record is made of, and the plane of the beam that it lies in."""

from insonify_viewer.panels.pixel.controller import PixelPanel

PANEL = PixelPanel
