"""Bottom track: altitude of the sonar from the first echo of the bed in the record itself."""

from collections.abc import Callable

import numpy as np

from insonify.arrays import Dataset, Echoes, Floats, Integers, Singles

BOTTOM_TRACK = "bottom_track"  # variable of a record
BEHIND = 0.05  # of the bins: length behind the edge that the bed must fill
STEADY = 1.0  # cost, in misclassified bins, of a change of altitude by one bin from ping to ping
FAINTEST_ECHO = 1e-8  # of the strongest echo of a ping; below it counts as silence
GROUP = 16  # pings that are split into loud and quiet bins together
SUMS_TOGETHER = 2**22  # sums that are in memory at once
FAINT = 3.0  # dB: median contrast at the edges, over all pings, below which there is no bottom track


def find_altitude(record: Dataset) -> Floats:
    """Return the altitude at every ping in metres: the recorded one, else the bottom track of the record itself."""
    # Pings without a recorded altitude get the lowest one of the others.
    altitude = record["platform_altitude"].values.astype(np.float64)
    if BOTTOM_TRACK in record and not np.isfinite(altitude).any():
        return record[BOTTOM_TRACK].values.astype(np.float64)
    return complete_altitude(altitude, record.variables["intensity"], 2.0 * float(record["slant_range"].values[0]))


def complete_altitude(altitude: Floats, intensity: Echoes, bin_length: float) -> Floats:
    """Complete recorded altitudes: where some are unknown, by the lowest one; where all are, by the bottom track."""
    known = altitude[np.isfinite(altitude)]
    if known.size:
        return np.where(np.isfinite(altitude), altitude, known.min())
    return track_bottom(intensity, bin_length)


def track_bottom(intensity: Echoes, bin_length: float) -> Floats:
    """Slant range of the first echo of the bed at every ping, which over an even bed is the altitude of the sonar."""
    # Bins are quiet or loud, by Otsu's threshold of the levels in decibels of some successive pings. The edge has quiet
    # bins before it and loud ones behind. Its course along the track is the one with the fewest misclassified bins,
    # plus a cost for every change from ping to ping (dynamic programming), so that an object in the water column, the
    # transmitted pulse, or a shadow at nadir does not displace it.
    _, pings, bins = intensity.shape
    width = max(round(BEHIND * bins), 1)
    block = GROUP * max(SUMS_TOGETHER // (GROUP * bins), 1)
    first_pings = range(0, pings, block)
    # Sums of scores forwards; the last ones of every block are kept. Then the course backwards.
    last: Singles | None = None
    starts: list[Singles | None] = []
    best = np.empty((0, 0), dtype=np.float32)
    for first in first_pings:
        starts.append(last)
        best = _sum_scores(np.asarray(intensity[:, first : first + block]), width, last)
        last = best[-1].copy()
    edges, contrast = np.empty(pings, dtype=np.int64), np.empty(pings)
    behind: int | None = None
    for first, start in zip(reversed(first_pings), reversed(starts)):
        echoes, some = np.asarray(intensity[:, first : first + block]), slice(first, first + block)
        if first != first_pings[-1]:
            best = _sum_scores(echoes, width, start)
        edges[some] = _trace_back(best, behind)
        contrast[some] = _contrast(echoes, edges[some], width)
        behind = int(edges[first])
    if not np.median(contrast) >= FAINT:
        return np.full(pings, np.nan)
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
    level = np.log10(np.maximum(both / np.where(strongest > 0.0, strongest, 1.0), FAINTEST_ECHO))
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


def _sum_scores(echoes: Singles, width: int, last: Singles | None) -> Singles:
    """Greatest scores in all courses that end in each bin, (pings, bins), after the scores of the ping before."""
    # The best predecessor of every bin at a linear cost follows from running maxima from either side.
    at = np.arange(echoes.shape[2] - width + 1)
    slope = STEADY * np.arange(at.size)
    best = np.empty((echoes.shape[1], at.size), dtype=np.float32)
    for group in range(0, len(best), GROUP):
        kinds = _kinds(echoes[:, group : group + GROUP])
        total = np.append(np.zeros((len(kinds), 1)), np.cumsum(kinds, axis=1), axis=1)
        # The score of an edge before each bin: loud less quiet bins within a width behind it, less those before it.
        for ping, score in enumerate(total[:, at + width] - 2.0 * total[:, at], start=group):
            if last is not None:
                last = last - last.max()  # sums that stay small are exact
                rising = np.maximum.accumulate(last + slope) - slope
                falling = np.maximum.accumulate((last - slope)[::-1])[::-1] + slope
                score = score + np.maximum(rising, falling)
            best[ping] = score
            last = best[ping]
    return best


def _trace_back(best: Singles, behind: int | None) -> Integers:
    """Bins of the course with the greatest score in all, less the cost of its changes, before the bin of a ping."""
    slope = STEADY * np.arange(best.shape[1])
    course = np.empty(len(best), dtype=np.int64)
    for ping in range(len(best) - 1, -1, -1):
        score = best[ping] if behind is None else best[ping] - np.abs(slope - slope[behind])
        behind = int(np.argmax(score))
        course[ping] = behind
    return course
