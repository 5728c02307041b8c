"""Layered water: nodes of height, and speed that is linear between them and constant beyond."""

from __future__ import annotations

from insonify.compiler.jit import inlined

SNAP = 1e-9  # a ray within this of a node is on it, m


@inlined
def node_below(height, z):
    """Highest node of the water at or below a height."""
    low, high = 0, height.size
    while low < high:
        middle = (low + high) // 2
        if height[middle] <= z + SNAP:
            low = middle + 1
        else:
            high = middle
    return low - 1


@inlined
def gradient_above(height, speed, k):
    """Gradient dc/dz between nodes k and k + 1."""
    if k < 0 or k >= height.size - 1:
        return 0.0
    return (speed[k + 1] - speed[k]) / (height[k + 1] - height[k])


@inlined
def speed_at(height, speed, z):
    """Speed of sound at a height."""
    k = node_below(height, z)
    if k < 0:
        return speed[0]
    return speed[k] + gradient_above(height, speed, k) * max(z - height[k], 0.0)
