"""Fitted constants of the laws of error and cost.

``pytest -m bench -s tests/bench/test_laws.py`` measures them anew.
"""

from __future__ import annotations

# Laws predict the median error over random scenes; the error of one scene may be greater by these factors.
MARGIN, MARGIN_OF_NODES, MARGIN_OF_WAYS, MARGIN_OF_TARGETS = 1.3, 1.5, 3.0, 4.0

# Numbers of planes that a plan may choose.
COUNTS = (*range(1, 9), *range(10, 17, 2), *range(20, 33, 4), *range(40, 65, 8), *range(80, 129, 16))
MOST_PLANES = COUNTS[-1]
MOST_OF_PATTERNS = 64  # for beams other than a level top-hat, whose near field takes many more
# Effective number of planes per plane by kind of beam, whose weights leave fewer.
WORTH = {"knife": 1.0, "fan": 1.0, "gaussian": 0.85, "array": 0.6}
# Residual error of planes over a steep bed in a fan's near field, per rms slope; beyond LEFT_UP_TO planes it falls with
# the power LEFT_ORDER of their number.
LEFT, LEFT_UP_TO, LEFT_ORDER = 0.03, 16, 3.0
# Slope breaks at the edges of cells: lowest frequency along the track in cycles per cell, standard deviation of the
# logarithm of the frequency, and decay with the bin length.
EDGES, EDGES_SPREAD, EDGES_IN_BINS = 0.15, 0.5, 4.0

# Error of a single plane across a target, as a share of the echo of each of its sides and of what their shadow hides:
# combed · width / along · (1 + bin / along) · (1 + (CURVED · along + turn) / bin)^TURNED, in metres; it falls as
# planes^−TARGET_ORDER. Each kind of target declares its own `combed`; COMBED_SHADOW applies to shadows. Fitted to
# random scenes with up to six targets of 0.1 to 15 m.
COMBED_SHADOW = 0.125
COMBED_LIGHT = 0.54  # factor for the law of light, where targets are less bright
CURVED, TURNED, TARGET_ORDER = 0.35, 0.75, 1.23
LIGHT_ECHO = 0.6  # echo with the law of light, whose bins are filled by slant range, over the echo by area
# However faint a target is, the planes are so close that UNHEARD · (spacing / length)^TARGET_ORDER keeps to the
# tolerance; at the default tolerance about three planes cross it.
UNHEARD = 0.13
# Error of targets displaced by coarse cells beneath them, per rms height that the cells lose, in bins.
TARGETS_LOST = 0.8

# Shadows of a rough bed: slope that casts one, in rms slopes over the tangent of the grazing angle, and length of
# shadows along the track, in cells.
SHADOWING, SHADOW_CELLS = 1.0, 4.0
# K planes across an array's main lobe count as K^ARRAY_WORTH, because each sidelobe has half as many.
ARRAY_WORTH = 0.9
# Multipaths by the sea surface with a top-hat beam: error of a single plane per rise of the bed across the beam, in
# bins, and per width of the beam over the ground range of the first bin; share of it that two planes leave, and bound.
GHOSTS_RISE, GHOSTS_WIDE, GHOSTS_FEW, GHOSTS_LEFT = 0.5, 0.22, 0.1, 0.02
# Multipaths over a bed of several materials, which glint differently beneath an image source: error of a single plane,
# and number of planes up to which a beam with a pattern has the error of one plane.
GHOSTS_UNEVEN, GHOSTS_FEWEST = 0.07, 3
# Multipaths over coarse cells: error per rms height that the cells lose, in bins, per cell length over the ground range
# of the first bin, and on a level bed per square of that ratio.
GHOSTS_LOST, GHOSTS_CELL, GHOSTS_LEVEL = 2.0, 0.07, 0.005
# Multipaths with a beam read from a table: error of a single plane, of two, and order of its fall with their number.
GHOSTS_SINGLE, GHOSTS_TABLED, GHOSTS_ORDER = 0.5, 0.03, 1.6
# Relief assumed for a bed without a declared spectrum (a measured one): exponent, rms and period in cells.
OTHER_BETA, OTHER_RMS, OTHER_PERIOD = 1.8, 1.0, 256.0
# Aliased variance of coarse borders of materials, per variance above the Nyquist frequency of the coarse nodes.
BORDERS = 4.0
# Level bed of coarse cells: LEVEL · (cell / bin)^LEVEL_ORDER up to LEVEL_MOST, and LEVEL_SHADED · (cell / altitude)²
# with a vertical beam pattern. LEVEL_SEEN bounds the error whatever the tolerance, because a level bed has a well-known
# record. At nadir, outside the tolerance, the error LEVEL_PEAK · (cell / altitude)² of the first echo's peak is at most
# PEAK_SEEN tolerances.
LEVEL, LEVEL_ORDER, LEVEL_MOST, LEVEL_SHADED, LEVEL_SEEN = 2.5e-4, 1.8, 6e-3, 50.0, 6e-3
LEVEL_PEAK, PEAK_SEEN = 90.0, 3.0

# Error of 1000 single rays per side over a rough bed, and its order; a fan spreads its rays over two angles.
KNIFE_RAYS, FAN_RAYS = (0.13, 1.0), (0.31, 0.75)
# Error of a march in steps of one cell, and its order.
MARCH, MARCH_ORDER = 0.3, 0.5
# Difference between the sweep with any number of planes and rays, over a bed alone and with targets.
SWEEP, SWEEP_TARGETS = 0.002, 0.004
# Energy of echoes after bounces, over the energy that the most reflective material returns.
BOUNCED = 2.0
# Relative error of 32-bit numbers with 64-bit sums.
SINGLE = 1e-6

# Equivalent profiles of several planes, in units of a single plane's: per plane, for near field and sidelobes, and for
# the near field of a sonar whose altitude equals its range.
PROFILES = {
    "knife": (1.0, 0.0, 0.0),
    "fan": (0.8, 1.7, 7.0),
    "squinting": (1.6, 0.0, 16.0),
    "gaussian": (1.5, 3.7, 0.0),
    "array": (1.9, 6.9, 0.0),
}
# Equivalent profiles for multipaths by the sea surface, whose image sources are higher; columns as in PROFILES.
PROFILES_OF_WAYS = {
    "knife": (1.0, 0.0, 0.0),
    "fan": (0.85, 5.0, 0.0),
    "squinting": (1.6, 7.0, 0.0),
    "gaussian": (1.1, 3.5, 0.0),
    "array": (1.5, 6.0, 0.0),
}
TABLED, LOOKED_UP = ("squinting", "gaussian", "array"), 1.7  # beams read from tables, cost factor per knot
# Seconds per operation of a ping, on one thread of the machine that the laws were fitted on.
SECONDS = {
    "ping": 3.0e-6,
    "bin": 0.0,
    "plane": 1.0e-6,
    "knot": 3.1e-9,
    "aslant knot": 36.0e-9,
    "bent knot": 1.5e-9,
    "target": 0.29e-6,
    "way's plane": 3.0e-6,
    "way's knot": 0.12e-6,
    "way's aslant knot": 0.3e-6,
    "way's target": 2.0e-6,
    "ray": 0.06e-6,
    "bent ray": 1.0e-6,
    "step": 2.0e-9,
}
