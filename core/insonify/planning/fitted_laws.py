"""Fitted constants of the laws of error and cost.

``pytest -m bench -s tests/bench/test_laws.py`` measures them anew.
"""

from __future__ import annotations

# Errors are predicted as they come out in the middle; one scene's may be this much greater.
MARGIN, MARGIN_OF_NODES, MARGIN_OF_WAYS, MARGIN_OF_TARGETS = 1.3, 1.5, 3.0, 4.0

# Planes: counts that may be chosen.
COUNTS = (*range(1, 9), *range(10, 17, 2), *range(20, 33, 4), *range(40, 65, 8), *range(80, 129, 16))
MOST_PLANES = COUNTS[-1]
MOST_OF_PATTERNS = 64  # of a beam that is no level top-hat, whose near field has many more
# Planes that a beam's weight leaves of one, by its kind.
WORTH = {"knife": 1.0, "fan": 1.0, "gaussian": 0.85, "array": 0.6}
# What planes leave of a steep bed in a fan's near field, by the rms of its slopes; with more than so many planes it
# falls, by this power.
LEFT, LEFT_UP_TO, LEFT_ORDER = 0.03, 16, 3.0
# The edges of cells: least frequency along the track, in cycles a cell, its spread as a power of e, and how fast they
# fade in longer bins.
EDGES, EDGES_SPREAD, EDGES_IN_BINS = 0.15, 0.5, 4.0

# Error of a single plane across a target, as a share of what each of its sides returns and of what their shadow hides:
# combed · width / along · (1 + bin / along) · (1 + (CURVED · along + turn) / bin)^TURNED, in metres; it falls as
# planes^−TARGET_ORDER. Each kind of target declares its own `combed`; COMBED_SHADOW is of shadows. Fitted to random
# scenes with up to six targets of 0.1 to 15 m.
COMBED_SHADOW = 0.125
COMBED_LIGHT = 0.54  # times that of light, whose targets are not as bright
CURVED, TURNED, TARGET_ORDER = 0.35, 0.75, 1.23
LIGHT_ECHO = 0.6  # of light, whose bins are filled by slant range, over the echo by area
# However faint a target is, planes lie so close to it that UNHEARD · (spacing / length)^TARGET_ORDER keeps to the
# tolerance: at the usual one about three of them meet it.
UNHEARD = 0.13
# What targets are moved by coarse cells beneath them: error by the heights that those lack, in bins.
TARGETS_LOST = 0.8

# Of the shadows of a rough bed: how steep a slope casts one, in rms slopes over the tangent of the grazing angle, and
# how long they are along the track, in cells.
SHADOWING, SHADOW_CELLS = 1.0, 4.0
# Planes across an array's main lobe are worth the fewer the more there are, for its sidelobes have half as many.
ARRAY_WORTH = 0.9
# What comes by the sea surface: error of a single plane by what the bed rises across the beam, in bins, and by the beam
# over what the first bin holds of the bed; share that two planes leave, and the most. Of a beam with a pattern, of a
# single one, of two, and the power by which it falls.
GHOSTS_RISE, GHOSTS_WIDE, GHOSTS_FEW, GHOSTS_LEFT = 0.5, 0.22, 0.1, 0.02
# Of a bed of several materials, which glint differently beneath an image; planes that a pattern needs there.
GHOSTS_UNEVEN, GHOSTS_FEWEST = 0.07, 3
# And of coarse cells, by the heights they miss, in bins, and by their length over what the first bin holds of the bed,
# of a level one by the square of that.
GHOSTS_LOST, GHOSTS_CELL, GHOSTS_LEVEL = 2.0, 0.07, 0.005
GHOSTS_SINGLE, GHOSTS_TABLED, GHOSTS_ORDER = 0.5, 0.03, 1.6
# Relief of a bed that no spectrum describes (a measured one): exponent, rms and period in cells.
OTHER_BETA, OTHER_RMS, OTHER_PERIOD = 1.8, 1.0, 256.0
# Borders of materials: what coarse nodes make of them.
BORDERS = 4.0
# A level bed of wide cells: error by cells over bins, and the most that it comes to; by the square of cells over
# altitudes, what a vertical beam shades wrongly. More than a share of the record is never left, for what a level bed
# looks like anybody knows; nor at nadir, which no tolerance means, more than some tolerances of the first echo's peak.
LEVEL, LEVEL_ORDER, LEVEL_MOST, LEVEL_SHADED, LEVEL_SEEN = 2.5e-4, 1.8, 6e-3, 50.0, 6e-3
LEVEL_PEAK, PEAK_SEEN = 90.0, 3.0

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

# Profiles of more than one plane, in those of a single one: so many for each plane, for the near field and sidelobes,
# and for the near field of a sonar as high as its range.
PROFILES = {
    "knife": (1.0, 0.0, 0.0),
    "fan": (0.8, 1.7, 7.0),
    "squinting": (1.6, 0.0, 16.0),
    "gaussian": (1.5, 3.7, 0.0),
    "array": (1.9, 6.9, 0.0),
}
# Likewise of what comes by the sea surface, whose images are higher.
PROFILES_OF_WAYS = {
    "knife": (1.0, 0.0, 0.0),
    "fan": (0.85, 5.0, 0.0),
    "squinting": (1.6, 7.0, 0.0),
    "gaussian": (1.1, 3.5, 0.0),
    "array": (1.5, 6.0, 0.0),
}
TABLED, LOOKED_UP = ("squinting", "gaussian", "array"), 1.7  # beams read from tables, and what that makes a knot cost
# Seconds of one thread of the machine that the laws were measured on, for each of what a ping is made of.
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
