"""Laws of error and cost as numbers, all that was measured in one place.

``pytest -m bench -s tests/bench/test_laws.py`` measures them anew.
"""

from __future__ import annotations

# Errors are predicted as they come out in the middle; one scene's may be this much greater.
MARGIN, MARGIN_OF_TARGETS = 1.7, 3.5

# Planes: counts that may be chosen.
COUNTS = (*range(1, 9), *range(10, 17, 2), *range(20, 33, 4), *range(40, 65, 8), *range(80, 129, 16))
MOST_PLANES = COUNTS[-1]
MOST_OF_PATTERNS = 64  # of a beam that is no level top-hat, whose near field has many more
# Planes that a beam's weight leaves of one, by its kind.
WORTH = {"knife": 1.0, "fan": 1.0, "gaussian": 0.85, "array": 0.6}
# What planes leave of a fan's near field, however little the bed has of detail: over a grazing angle of tangent t at
# the greatest range, a share of the record LEFT + LEFT_STEEP t², and after how many planes that is gone.
LEFT, LEFT_STEEP, LEFT_UP_TO = 0.001, 0.015, 16
# And a single plane for a whole beam, which hears nothing of what lies off its axis.
LEFT_BY_ONE = 0.05

# Error of planes across targets: TARGET_PLANES · width^0.75 · radius^−0.7 · planes^−1.5, lengths in metres, the beam's
# width at the greatest range and the least radius; less in light, whose targets glint less.
TARGET_PLANES, TARGET_WIDTH, TARGET_RADIUS, TARGET_ORDER, TARGET_LIGHT = 0.28, 0.75, -0.7, 1.5, 0.42
THIN = 0.15  # m, radius of the thin parts of a mesh

# Of the shadows of a rough bed: how steep a slope casts one, in rms slopes over the tangent of the grazing angle, and
# how long they are along the track, in cells.
SHADOWING, SHADOW_CELLS = 1.0, 4.0
# Variance of a cascade's slopes where they are steep, over the mean.
CASCADE = 4.0
# Relief of a bed that no spectrum describes (a measured one): exponent, and rms in cells.
OTHER_BETA, OTHER_RMS = 1.4, 0.4
# A level bed of wide cells: error by cells over bins, the most that it comes to, and what the near field misses by the
# square of cells over altitudes, which the eye sees though no tolerance means it.
LEVEL, LEVEL_ORDER, LEVEL_MOST, LEVEL_NEAR = 2.5e-4, 1.8, 6e-3, 200.0

# Error of single rays over a rough bed, at 1000 rays a side, and its order: a fan spreads them over two angles.
KNIFE_RAYS, FAN_RAYS = (0.13, 1.0), (0.31, 0.75)
# Of a march in steps of a cell, and its order.
MARCH, MARCH_ORDER = 0.3, 0.5
# What the sweep is off rays, in spite of any number of planes, over a bed and with targets.
SWEEP, SWEEP_TARGETS = 0.002, 0.004
# What bounces add, over the energy that the best mirror returns.
BOUNCED = 2.0
# Numbers of 32 bits, with sums of 64.
SINGLE = 1e-6

# The planes of a beam's near field lie in growing steps, the narrower the more planes there are; each is as long as
# the beam hears it, in altitudes.
NEAR_GROWTH, NEAR_FEW, NEAR_LENGTH = 0.4, 16, 1.0

# Seconds of one thread of the machine that the laws were measured on, for each of what a ping is made of.
SECONDS = {
    "ping": 4.5e-6,
    "bin": 0.0,
    "plane": 1.0e-6,
    "knot": 3.1e-9,
    "bent knot": 1.5e-9,
    "target": 0.29e-6,
    "way's plane": 0.3e-6,
    "way's knot": 60.0e-9,
    "way's target": 2.0e-6,
    "ray": 0.06e-6,
    "bent ray": 1.0e-6,
    "step": 2.0e-9,
}
