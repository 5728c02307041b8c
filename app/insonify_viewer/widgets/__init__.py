"""Widgets, colours and pictures that rooms share."""
