"""Echoes by way of the sea surface: image sources, for the sweep and for single rays."""
