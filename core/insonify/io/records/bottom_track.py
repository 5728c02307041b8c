"""Bottom track: altitude of the sonar from the first echo of the bed in the record itself."""

from collections.abc import Callable, Iterator

import numpy as np

from insonify.arrays import Dataset, Floats, Integers, Singles

BOTTOM_TRACK = "bottom_track"  # variable of a record
BEHIND = 0.05  # of the bins: length behind the edge that the bed must fill
STEADY = 1.0  # cost, in misclassified bins, of a change of altitude by one bin from ping to ping
FAINTEST = 1e-8  # of the strongest echo of a ping; below it counts as silence
GROUP = 16  # pings that are split into loud and quiet bins together
FAINT = 3.0  # dB: median contrast at the edges, over all pings, below which there is no bottom track


def find_altitude(record: Dataset) -> Floats:
    """Return the altitude at every ping in metres: the recorded one, else the bottom track of the record itself."""
    # Pings without a recorded altitude get the lowest one of the others.
    altitude = record["platform_altitude"].values.astype(np.float64)
    if BOTTOM_TRACK in record and not np.isfinite(altitude).any():
        return record[BOTTOM_TRACK].values.astype(np.float64)
    return complete_altitude(altitude, record["intensity"].values, 2.0 * float(record["slant_range"].values[0]))


def complete_altitude(altitude: Floats, intensity: Singles, bin_length: float) -> Floats:
    """Complete recorded altitudes: where some are unknown, by the lowest one; where all are, by the bottom track."""
    known = altitude[np.isfinite(altitude)]
    if known.size:
        return np.where(np.isfinite(altitude), altitude, known.min())
    return track_bottom(intensity, bin_length)


def track_bottom(intensity: Singles, bin_length: float) -> Floats:
    """Slant range of the first echo of the bed at every ping, which over an even bed is the altitude of the sonar."""
    # Bins are quiet or loud, by Otsu's threshold of the levels in decibels of some successive pings. The edge has quiet
    # bins before it and loud ones behind. Its course along the track is the one with the fewest misclassified bins,
    # plus a cost for every change from ping to ping (dynamic programming), so that an object in the water column, the
    # transmitted pulse, or a shadow at nadir does not displace it.
    width = max(round(BEHIND * intensity.shape[2]), 1)
    groups = (intensity[:, first : first + GROUP] for first in range(0, intensity.shape[1], GROUP))  # one in memory
    at = np.arange(intensity.shape[2] - width + 1)
    # The score of an edge before each bin: loud less quiet bins within a width behind it, less those before it.
    sums = (np.append(np.zeros((len(kinds), 1)), np.cumsum(kinds, axis=1), axis=1) for kinds in map(_kinds, groups))
    scores = (score for total in sums for score in total[:, at + width] - 2.0 * total[:, at])
    edges = _steadiest(scores, intensity.shape[1])
    if not np.median(_contrast(intensity, edges, width)) >= FAINT:
        return np.full(len(edges), np.nan)
    return np.asarray(bin_length * (edges + 0.5), dtype=np.float64)


def _kinds(intensity: Singles) -> Floats:
    """Which bins are loud (1) or quiet (-1) on both sides together, (pings, bins); 0 throughout a ping without echo."""
    # The threshold of a ping is the middle of the mean levels of its two classes by Otsu's threshold of the group.
    from skimage import filters  # slow to import, and few commands need it

    split: Callable[..., float] = filters.threshold_otsu
    bins = intensity.shape[2]
    # Two-way spherical spreading is taken out, so that the far bed is not as quiet as the water column.
    both = intensity.astype(np.float64).mean(axis=0) * ((np.arange(bins) + 0.5) / bins) ** 4
    strongest = both.max(axis=1, keepdims=True)
    level = np.log10(np.maximum(both / np.where(strongest > 0.0, strongest, 1.0), FAINTEST))
    varied = np.ptp(level, axis=1, keepdims=True) > 0.0
    if not varied.any():
        return np.zeros_like(level)
    high = level > split(level[varied[:, 0]])
    count = high.sum(axis=1, keepdims=True)
    loud = (level * high).sum(axis=1, keepdims=True) / np.maximum(count, 1)
    quiet = (level * ~high).sum(axis=1, keepdims=True) / np.maximum(bins - count, 1)
    return np.where(level > 0.5 * (loud + quiet), 1.0, -1.0) * varied


def _contrast(intensity: Singles, edges: Integers, width: int) -> Floats:
    """Ratio of the mean energies behind and before the edges, over as many bins on either side, in dB; 0 at bin 0."""
    pairs = (
        (intensity[:, ping, edge : edge + width].sum(), intensity[:, ping, max(edge - width, 0) : edge].sum())
        for ping, edge in enumerate(edges)
    )
    behind, before = np.array(list(pairs), dtype=np.float64).T
    ratio = np.maximum(behind / width, 1e-37) / np.maximum(before / np.maximum(np.minimum(edges, width), 1), 1e-37)
    return 10.0 * np.log10(ratio) * (edges > 0)


def _steadiest(scores: Iterator[Floats], pings: int) -> Integers:
    """Bins of the course with the greatest score in all, less the cost of its changes."""
    # The best predecessor of every bin at a linear cost follows from running maxima from either side.
    first = next(scores)
    slope = STEADY * np.arange(first.size)
    best = np.empty((pings, first.size), dtype=np.float32)
    best[0] = first
    for ping, score in enumerate(scores, start=1):
        last = best[ping - 1] - best[ping - 1].max()  # sums that stay small are exact
        rising = np.maximum.accumulate(last + slope) - slope
        falling = np.maximum.accumulate((last - slope)[::-1])[::-1] + slope
        best[ping] = score + np.maximum(rising, falling)
    course = np.empty(pings, dtype=np.int64)
    course[-1] = np.argmax(best[-1])
    for ping in range(pings - 2, -1, -1):
        course[ping] = np.argmax(best[ping] - np.abs(slope - slope[course[ping + 1]]))
    return course
