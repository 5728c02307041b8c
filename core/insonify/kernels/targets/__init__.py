"""Targets in one plane: primitives, angular z-buffer, occlusion, apparent targets in refracting water."""
