"""Pictures of records as arrays: contrast, palette, slant and ground range.

Pictures show amplitudes as `insonify.display.normalisation` makes them.
"""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Bytes, Floats, Integers, Singles
from insonify.display.display_options import DisplayOptions, Levels, find_palettes
from insonify.display.range_axis import RangeAxis
from insonify.parallel import in_parallel
from insonify.scene import SceneError

DYNAMIC = 40.0  # dB, greatest span of a palette that is linear in decibels
HIGHLIGHTS = 10.0  # times the middle of a record, the least upper end of such a palette
_ENOUGH = 200_000  # amplitudes that suffice for a percentile


@cache
def load_palette(name: str) -> Bytes:
    """Read a palette: its file has one colour per line, ``#rrggbb``, evenly spaced from silence to the maximum."""
    palettes = find_palettes()
    if name not in palettes:
        raise SceneError(f"palette {name!r} is not known; choose one of {', '.join(palettes)}")
    lines = palettes[name].read_text(encoding="utf-8").splitlines()
    anchors = np.array([list(bytes.fromhex(line[1:])) for line in lines if not line.startswith("# ")], dtype=np.float64)
    at, given = np.linspace(0.0, 1.0, 256), np.linspace(0.0, 1.0, len(anchors))
    table = np.stack([np.interp(at, given, channel) for channel in anchors.T], axis=1)
    colours = np.rint(table).astype(np.uint8)
    colours.flags.writeable = False
    return colours


def shown_palette(look: DisplayOptions) -> Bytes:
    """Palette of display options, (256, 3), reversed if `reverse` is set."""
    colours = load_palette(look.palette)
    return colours[::-1] if look.reverse else colours


def choose_contrast(amplitude: Singles, *, decibels: bool = False) -> Levels:
    """Choose the amplitudes that become the darkest and the brightest colour."""
    # Shadows (zeros) do not count. The span follows the texture of the bed within limits: a bed without texture stays
    # in the middle of the palette and distinct from a shadow, one strong target does not darken the rest, and a
    # material that covers a tenth of the picture keeps its texture however strong it is.
    sample = amplitude.ravel()[:: amplitude.size // _ENOUGH + 1]
    positive = sample[np.isfinite(sample) & (sample > 0.0)]
    if positive.size == 0:
        return 0.0, 1.0
    weak, middle, upper, strong = (float(p) for p in np.percentile(positive, [2.0, 50.0, 90.0, 99.7]))
    if decibels:
        return max(0.5 * weak, HIGHLIGHTS * middle * 10.0 ** (-DYNAMIC / 20.0)), max(1.5 * strong, HIGHLIGHTS * middle)
    low = min(weak, 0.6 * middle) - 0.2 * middle
    return max(low, 0.0), min(max(strong, 1.5 * middle, 1.3 * upper), max(2.4 * middle, 1.3 * upper))


def span_decibels(levels: Levels) -> Levels:
    """Return the ends in dB of a palette that is linear in decibels, at most `DYNAMIC` apart, by their amplitudes."""
    low, high = levels
    top = 20.0 * math.log10(max(high, 1e-30))
    return (max(20.0 * math.log10(low), top - DYNAMIC) if low > 0.0 else top - DYNAMIC), top


def map_tones(amplitude: Singles, levels: Levels, gain: float = 0.0, *, decibels: bool = False) -> Bytes:
    """Turn amplitudes into entries of a palette."""
    low, high = levels
    amplified = np.nan_to_num(amplitude) * np.float32(10.0 ** (gain / 20.0))
    if decibels:
        low, high = span_decibels(levels)
        amplified = np.float32(20.0) * np.log10(np.maximum(amplified, np.float32(1e-30)))
    scaled = (np.clip(amplified, low, high) - low) / (high - low) if high > low else np.clip(amplified, 0.0, 1.0)
    return np.rint(255.0 * scaled).astype(np.uint8)


def mirror_channels(sides: Singles, edges: Floats, side: str = "both") -> Singles:
    """Lay out the channels with port to the left of nadir and the newest ping on top."""
    newest_first = slice(None, None, -1)
    port, starboard = (average_columns(sides[newest_first, channel], edges[newest_first]) for channel in (0, 1))
    if side == "both":
        return np.concatenate([port[:, ::-1], starboard], axis=1)
    return port if side == "port" else starboard


def compute_column_edges(altitude: Floats, axis: RangeAxis, columns: int) -> Floats:
    """Compute the edges of equally wide columns as positions in the bins of one side."""
    return place_columns(np.linspace(0.0, axis.reach, columns + 1), altitude, axis)


def place_columns(distance: Floats, altitude: Floats, axis: RangeAxis) -> Floats:
    """Positions of distances in the bins of one side, (pings, distances); one row where all pings have the same."""
    if axis.shows_water:
        same = np.round(axis.bins_at(distance, np.zeros(1)), 9)  # so that edges of columns meet edges of bins
        return np.broadcast_to(same, (len(altitude), distance.size))
    return axis.bins_at(distance[None, :], altitude[:, None])


def average_columns(
    rows: Singles, edges: Floats, *, picked: Integers | None = None, bins: range | None = None
) -> Singles:
    """Average rows between successive edges, with parts of bins weighted by their width.

    Columns wider than a bin average it, so that no narrow echo is lost; columns narrower than a bin repeat it.
    """
    # lazy: the window opens before Numba is loaded
    from insonify.kernels.display.rows import ROWS_A_THREAD, average_bins

    # Rows that share their edges are views of one row.
    grids = edges[:1] if edges.strides[0] == 0 else edges
    # Contiguous arrays have one type, so that one compiled kernel serves all callers.
    places = np.arange(len(rows)) if picked is None else np.ascontiguousarray(picked)
    which = np.minimum(np.arange(len(places)), len(grids) - 1)
    values, at = np.ascontiguousarray(rows), np.require(grids, requirements=("C", "W"))
    chosen = range(rows.shape[1]) if bins is None else bins
    out = np.empty((len(places), edges.shape[1] - 1), np.float32)

    def block(first: int, last: int) -> None:
        some = slice(first, last)
        average_bins(values, places[some], chosen.start, chosen.step, len(chosen), at, which[some], out[some])

    in_parallel(block, len(places), least=ROWS_A_THREAD)
    return out


def colour_rows(values: Singles, low: float, high: float, table: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Colour values by a table with entries beyond the upper end."""
    if not values.size:
        return np.empty(values.shape, np.uint32)
    from insonify.kernels.display.rows import ROWS_A_THREAD, colour_values  # lazy: as above

    scale = np.float32(255.0 / max(high - low, 1e-30))
    rows = np.ascontiguousarray(values).reshape(-1, values.shape[-1])
    out = np.empty(rows.shape, np.uint32)

    def block(first: int, last: int) -> None:
        colour_values(rows[first:last], np.float32(low), scale, table, out[first:last])

    in_parallel(block, len(rows), least=ROWS_A_THREAD)
    return out.reshape(values.shape)


def compile_picture() -> None:
    """Compile the kernels that average bins into columns and colour them, away from the main thread."""
    columns = average_columns(np.zeros((1, 2), dtype=np.float32), np.array([[0.0, 1.0, 2.0]]))
    colour_rows(columns, 0.0, 1.0, np.zeros(256, dtype=np.uint32))


def colour_amplitudes(amplitude: Singles, look: DisplayOptions | None = None, levels: Levels | None = None) -> Bytes:
    """Colour amplitudes."""
    look = look or DisplayOptions()
    ends = choose_contrast(amplitude) if levels is None else levels
    return np.take(shown_palette(look), map_tones(amplitude, ends, look.gain, decibels=look.decibels), axis=0)
