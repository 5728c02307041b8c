"""Laws of error and cost as numbers, all that was measured in one place."""

from __future__ import annotations

MOST_PLANES = 64

# Error of a fan of planes against 128, over fractal beds of β 1.2 to 2 with rms 0.4 cells: share of the record when
# planes lie one cell apart at the greatest range; a factor of ten for every 0.4 of β; square of the spacing.
ERROR_AT_ONE_CELL, LAW_BETA, LAW_RMS = 0.012, 1.2, 0.4
BETA_PER_DECADE = 0.4
# Likewise for targets, whose glint is narrow: with planes one radius apart.
ERROR_AT_ONE_RADIUS = 0.18
THIN = 0.15  # m, radius of the thin parts of a mesh, which it does not tell before it is read
# A bed that no β describes (measured heights, patches of material) counts as this smooth.
OTHER_BETA = 1.4
# Error law of single rays over a rough bed, at 1000 rays a side, and its order: a fan spreads them over two angles.
KNIFE_RAYS, FAN_RAYS = (0.13, 1.0), (0.31, 0.75)
# Of a march over a rough bed, in steps of a cell, and its order.
MARCH, MARCH_ORDER = 0.3, 0.5

# Seconds of one thread of the machine that the laws were measured on.
A_PING = 1.0e-6
A_BIN = 2.0e-9
A_KNOT = 7.0e-9  # of a profile
A_RAY = 0.1e-6
A_STEP = 2.0e-9
BENT = 1.3  # by which bent sound costs more than straight
BENT_RAYS = 4.0
A_BOUNCE = 1.0  # share of the first echo's cost
A_TARGET = 3.0e-6  # in one plane
A_WAY = 1.0  # by the surface, share of the direct one's cost
