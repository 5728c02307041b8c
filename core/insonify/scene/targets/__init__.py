"""Targets on, in or over the bed: one file a shape, with its fields and all that the rest asks of it."""

from insonify.scene.targets.base import TARGETS, AnyTarget, BedSurface, Body, Posed, Target

__all__ = ["TARGETS", "AnyTarget", "BedSurface", "Body", "Posed", "Target"]
