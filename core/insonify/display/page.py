"""Page of a record: its picture with scales in metres, ping numbers, a colour bar and a title."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from insonify.display.display_options import DisplayOptions
from insonify.display.picture import choose_contrast, colour_amplitudes, shown_palette, span_decibels
from insonify.display.range_axis import NAMES, choose_kind
from insonify.display.sheet import RecordSheet
from insonify.display.style import AMBER, FAINT, INK, LINE_WIDTH, label_axes, make_figure, style_axes
from insonify.io.atomic import replacing
from insonify.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

DPI = 100
COMPRESSION = 2  # of PNG: a quarter of the time of the usual 6, and 5 % more bytes
LEFT, RIGHT, TOP, BOTTOM = 86, 196, 92, 62  # margins in pixels


class PageCaption(NamedTuple):
    """Text of a page."""

    title: str
    line: str  # line that describes how the record was made
    level: str  # level to which the echoes are relative


def write_page(path: str | Path, sheet: RecordSheet, look: DisplayOptions, caption: PageCaption) -> None:
    """Write a sheet with scales, colour bar and caption as PNG."""
    figure = draw_page(sheet, look, caption)
    with replacing(path) as beside, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a title in any script
        figure.savefig(beside, dpi=DPI, pil_kwargs={"compress_level": COMPRESSION})


def draw_page(sheet: RecordSheet, look: DisplayOptions, caption: PageCaption) -> Figure:
    """Draw a sheet on a page, one pixel per amplitude."""
    height, width = sheet.amplitude.shape
    whole = (LEFT + width + RIGHT, TOP + height + BOTTOM)
    figure = make_figure(whole[0] / DPI, whole[1] / DPI, dpi=DPI)
    levels = look.levels or choose_contrast(sheet.amplitude, decibels=look.decibels)
    axes = _axes(figure, whole, LEFT, BOTTOM, width, height)
    near = -sheet.reach if look.side == "both" else 0.0
    axes.imshow(
        colour_amplitudes(sheet.amplitude, look, levels),
        extent=(near, sheet.reach, *_ends(sheet, look)),
        aspect="auto",
        interpolation="nearest",
    )
    _scales(axes, sheet, look)
    _lines(axes, sheet, look)
    bar = _axes(figure, whole, LEFT + width + 84, BOTTOM, 18, height)
    _colour_bar(bar, look, levels, caption.level)
    _headings(figure, whole, width, look, caption)
    return figure


def _axes(figure: Figure, whole: tuple[int, int], left: int, bottom: int, width: int, height: int) -> Any:
    axes = figure.add_axes((left / whole[0], bottom / whole[1], width / whole[0], height / whole[1]))
    axes.tick_params(length=4)
    style_axes(axes, 9, framed=True)
    return axes


def _ends(sheet: RecordSheet, look: DisplayOptions) -> tuple[float, float]:
    """Metres along the track at the lower and the upper edge; one ping has no length."""
    ends = (0.0, sheet.along or 1.0)
    return ends if look.newest_on_top else ends[::-1]


def _lines(axes: Any, sheet: RecordSheet, look: DisplayOptions) -> None:
    """Draw lines of equal range, and the first echo of the bed at its slant range."""
    if look.range_lines:
        axes.grid(axis="x", color="white", alpha=0.35, linewidth=0.6)
    if look.bottom_line and look.water_column and not look.ground_range:
        along = (np.arange(sheet.pings) + 0.5) / sheet.pings * (sheet.along or 1.0)
        for sign in {"both": (-1.0, 1.0)}.get(look.side, (1.0,)):
            axes.plot(sign * sheet.altitude, along, color=AMBER, linewidth=1.0, scalex=False, scaley=False)


def _scales(axes: Any, sheet: RecordSheet, look: DisplayOptions) -> None:
    """Set the scales: range from nadir outwards, metres along the track, ping numbers."""
    axes.xaxis.set_major_locator(MaxNLocator(10 if look.side == "both" else 8, steps=[1, 2, 2.5, 5, 10]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{abs(x):g}"))
    kind = choose_kind(ground_range=look.ground_range, water_column=look.water_column)
    label_axes(axes, f"{NAMES[kind]} (m)", "along track (m)", pad=6)
    if look.side == "both":
        axes.axvline(0.0, color="white", alpha=0.25, linewidth=0.8)
    if sheet.along <= 0.0:
        axes.set_yticks([])
        return
    numbers = axes.secondary_yaxis(
        "right",
        functions=(lambda y: y * (sheet.pings / sheet.along), lambda n: n * (sheet.along / sheet.pings)),
    )
    numbers.yaxis.set_major_locator(MaxNLocator(8, integer=True))
    numbers.tick_params(labelsize=9, color=FAINT, labelcolor=FAINT, length=4, width=LINE_WIDTH)
    numbers.spines["right"].set(color=FAINT, linewidth=LINE_WIDTH)
    numbers.set_ylabel("ping", fontsize=10, color=FAINT, labelpad=4)


def _colour_bar(axes: Any, look: DisplayOptions, levels: tuple[float, float], level: str) -> None:
    """Draw the palette from low to high with ticks in decibels above a level."""
    axes.imshow(shown_palette(look)[:, None, :], extent=(0, 1, 0, 1), origin="lower", aspect="auto")
    axes.set_xticks([])
    axes.yaxis.tick_right()
    axes.yaxis.set_label_position("right")
    places = place_decibel_ticks(levels, look.gain, decibels=look.decibels)
    axes.set_yticks([place for place, _ in places], [text for _, text in places])
    label_axes(axes, y=f"echo relative to {level} (dB)", pad=6)


def place_decibel_ticks(levels: tuple[float, float], gain: float, *, decibels: bool = False) -> list[tuple[float, str]]:
    """Place ticks at round decibels along a bar that is linear in amplitude, or in decibels."""
    low, high = levels
    highest = math.floor(20.0 * math.log10(high) - gain)
    ticks: list[tuple[float, str]] = []
    bottom, top = span_decibels(levels)
    for level in range(highest, highest - 60, -1):
        shown = level + gain
        place = (shown - bottom) / (top - bottom) if decibels else (10.0 ** (shown / 20.0) - low) / (high - low)
        if place < 0.0:
            break
        if level % 2 == 0 and (not ticks or ticks[-1][0] - place > 0.07):
            ticks.append((place, f"{level:+d}".replace("-", "−") if level else "0"))
    return ticks


def _headings(figure: Figure, whole: tuple[int, int], width: int, look: DisplayOptions, caption: PageCaption) -> None:
    def text(x: float, y: float, words: str, **style: Any) -> None:
        figure.text(x / whole[0], 1.0 - y / whole[1], words, parse_math=False, **style)

    title = caption.title if len(caption.title) <= 90 else f"{caption.title[:89]}…"
    text(LEFT, 34, title, fontsize=15, fontweight="bold", color=INK, va="baseline")
    text(LEFT, 56, caption.line, fontsize=10, color=FAINT, va="baseline")
    small: dict[str, Any] = {"fontsize": 9, "fontweight": "bold", "color": FAINT, "va": "baseline"}
    if look.side in ("both", "port"):
        text(LEFT, TOP - 9, "PORT", **small)
    if look.side in ("both", "starboard"):
        right = look.side == "both"
        text(LEFT + width if right else LEFT, TOP - 9, "STARBOARD", ha="right" if right else "left", **small)


def caption_scene(scene: Scene, look: DisplayOptions) -> PageCaption:
    """Caption of a simulated record: tow, beam, frequency, bin and ping spacing."""
    sonar = scene.sonar
    parts = [
        _tow(scene),
        sonar.beam.words,
        *filter(None, [sonar.vertical.words]),
        f"{sonar.frequency / 1e3:g} kHz",
        f"{sonar.bins} bins of {100.0 * sonar.range / sonar.bins:.3g} cm",
        f"ping every {100.0 * scene.track.speed / sonar.ping_rate:.3g} cm",
    ]
    if sonar.law == "light":
        parts.append("law light")
    return PageCaption(scene.title, _line(parts, look), "a perfect Lambert bed")


def _tow(scene: Scene) -> str:
    """Altitude or depth of the sonar and its motions in words."""
    track = scene.track
    height = f"altitude {scene.altitude:g} m" if track.depth is None else f"depth {track.depth:g} m"
    return ", ".join([height, *(["terrain following"] if track.terrain_following else []), *track.kinds])


def caption_record(record: xr.Dataset, along: float, look: DisplayOptions) -> PageCaption:
    """Caption of a record read from a file, from its own data."""
    pings, bins = record.sizes["ping_time"], record.sizes["range_sample"]
    parts = [f"{bins} bins of {200.0 * float(record['slant_range'][0]):.3g} cm", f"{pings} pings"]
    altitude = record["platform_altitude"].values
    if np.isfinite(altitude).any():
        low, high = float(np.nanmin(altitude)), float(np.nanmax(altitude))
        parts.insert(0, f"altitude {low:.1f} m" if high - low < 0.1 else f"altitude {low:.1f} to {high:.1f} m")
    frequency = record.attrs.get("frequency")
    if isinstance(frequency, (float, np.floating)) and frequency > 0.0:
        parts.insert(1, f"{frequency / 1e3:g} kHz")
    if along > 0.0:
        parts.append(f"ping every {100.0 * along / pings:.3g} cm")
    return PageCaption(str(record.attrs.get("title", "")), _line(parts, look), "the median at its range")


def _line(parts: list[str], look: DisplayOptions) -> str:
    return "  ·  ".join([*parts, f"gain {look.gain:+g} dB"] if look.gain else parts)
