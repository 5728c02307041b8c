"""Targets on, in or over the bed: one file a shape, with its fields and geometry."""

from insonify.scene.targets.base import TARGETS, AnyTarget, BedSurface, Body, Posed, Target

__all__ = ["TARGETS", "AnyTarget", "BedSurface", "Body", "Posed", "Target"]
