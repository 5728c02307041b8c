"""Targets in one plane: primitives, angular z-buffer, occlusion, apparent targets in bent sound."""
