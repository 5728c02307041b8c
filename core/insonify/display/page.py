"""Page of a record: its picture with scales in metres, ping numbers, a colour bar and a title."""

import math
import zlib
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from insonify.arrays import Dataset
from insonify.display.display_options import DisplayOptions, check_display
from insonify.display.picture import choose_contrast, map_tones, shown_palette, span_decibels
from insonify.display.range_axis import NAMES, choose_kind
from insonify.display.sheet import RecordSheet, gather_record_sheet
from insonify.io.atomic import replacing
from insonify.scene import Scene

INK, FAINT, AMBER = "#22262b", "#6b737c", "#e08e1b"  # as of the figures (`display.style`)
DPI = 100
COMPRESSION = zlib.Z_RLE  # of PNG: a third of the time of the usual one, and 5 % more bytes
LEFT, RIGHT, TOP, BOTTOM = 86, 196, 92, 62  # margins in pixels
TICK, GAP = 5, 5  # px, length of a tick, and from it to its number
ROUND = (1.0, 2.0, 2.5, 5.0, 10.0)  # steps of scales, times a power of ten
FINER = 4  # times the pixels in which an oblique line is drawn, to be averaged

Ticks = list[tuple[float, str]]  # share of a side from its left or lower end, and the number there


class PageCaption(NamedTuple):
    """Text of a page."""

    title: str
    line: str  # line that describes how the record was made
    level: str  # level to which the echoes are relative


class Frame(NamedTuple):
    """Place of a framed picture on a page, in pixels."""

    left: int
    top: int
    width: int
    height: int


def draw_record(record: Dataset, **options: Any) -> Image.Image:
    """Draw a record as the command ``render`` does, by `DisplayOptions`."""
    look = DisplayOptions(**check_display(options))
    sheet = gather_record_sheet(record, look)
    return draw_page(sheet, look, caption_record(record, sheet.along, look))


def write_page(path: str | Path, sheet: RecordSheet, look: DisplayOptions, caption: PageCaption) -> None:
    """Write a sheet with scales, colour bar and caption as PNG, one pixel per amplitude."""
    with replacing(path) as beside:
        draw_page(sheet, look, caption).save(beside, format="PNG", dpi=(DPI, DPI), compress_type=COMPRESSION)


def draw_page(sheet: RecordSheet, look: DisplayOptions, caption: PageCaption) -> Image.Image:
    """Draw a sheet with scales, colour bar and caption, one pixel per amplitude."""
    # By Pillow: Matplotlib takes longer to import and to draw the same than all before.
    height, width = sheet.amplitude.shape
    page = Image.new("RGB", (LEFT + width + RIGHT, TOP + height + BOTTOM), "white")
    levels = look.levels or choose_contrast(sheet.amplitude, decibels=look.decibels)
    tones = Image.fromarray(map_tones(sheet.amplitude, levels, look.gain, decibels=look.decibels))
    tones.putpalette(shown_palette(look).tobytes())
    picture, bar = Frame(LEFT, TOP, width, height), Frame(LEFT + width + 84, TOP, 18, height)
    page.paste(tones, (LEFT, TOP))
    _scales(page, picture, sheet, look)
    places = np.linspace(255.49, -0.49, height).round().astype(np.int64)
    palette = np.repeat(shown_palette(look)[places][:, None], bar.width, axis=1)
    page.paste(Image.fromarray(palette), (bar.left, bar.top))
    decibels = place_decibel_ticks(levels, look.gain, decibels=look.decibels)
    _scale(page, bar, "right", decibels, f"echo relative to {caption.level} (dB)")
    for frame in (picture, bar):
        corners = (frame.left - 1, frame.top - 1, frame.left + frame.width, frame.top + frame.height)
        ImageDraw.Draw(page).rectangle(corners, outline=FAINT)
    _headings(page, width, look, caption)
    return page


def _scales(page: Image.Image, frame: Frame, sheet: RecordSheet, look: DisplayOptions) -> None:
    """Draw the scales: range from nadir outwards, metres along the track, ping numbers; and lines over the picture."""
    both = look.side == "both"
    near, along = -sheet.reach if both else 0.0, sheet.along or 1.0
    ranges = [((x - near) / (sheet.reach - near), f"{abs(x):g}") for x in _ticks(near, sheet.reach, 10 if both else 8)]
    upright = [(share, 0.35) for share, _ in ranges if share < 1.0] if look.range_lines else []
    for share, alpha in upright + [(0.5, 0.25)] * both:
        place = (frame.left + int(share * frame.width), frame.top)
        page.paste("white", place, Image.new("L", (1, frame.height), round(255 * alpha)))
    if look.bottom_line and look.water_column and not look.ground_range:
        downwards = (np.arange(sheet.pings) + 0.5) / sheet.pings
        upwards = downwards if look.newest_on_top else 1.0 - downwards
        fine = Image.new("L", (FINER * frame.width, FINER * frame.height))
        for sign in (-1.0, 1.0) if both else (1.0,):
            across = (sign * sheet.altitude - near) / (sheet.reach - near)
            points = zip((across * fine.width).tolist(), ((1.0 - upwards) * fine.height).tolist())
            ImageDraw.Draw(fine).line(list(points), fill=255, width=FINER, joint="curve")
        page.paste(AMBER, (frame.left, frame.top), fine.reduce(FINER))
    kind = choose_kind(ground_range=look.ground_range, water_column=look.water_column)
    _scale(page, frame, "below", ranges, f"{NAMES[kind]} (m)")
    metres = [(y / along, f"{y:g}") for y in _ticks(0.0, along, 9)] if sheet.along > 0.0 else []
    numbers = [(n / sheet.pings, f"{n:g}") for n in _ticks(0.0, sheet.pings, 8, least=1.0)] if metres else []
    for side, ticks, label, colour in (("left", metres, "along track (m)", INK), ("right", numbers, "ping", FAINT)):
        placed = ticks if look.newest_on_top else [(1.0 - share, text) for share, text in ticks]
        _scale(page, frame, side, placed, label if ticks or side == "left" else "", colour)


def _ticks(low: float, high: float, most: int, *, least: float = 0.0) -> list[float]:
    """Round numbers in an interval, which divide it into ``most`` parts at most."""
    span = max((high - low) / most, least)
    power = 10.0 ** math.floor(math.log10(span) + 1e-9)
    step = next(power * times for times in ROUND if power * times >= span * (1.0 - 1e-9))
    if least and step % 1.0:
        step = math.ceil(step)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(number * step, 12) for number in range(first, last + 1)]


def _scale(page: Image.Image, frame: Frame, side: str, ticks: Ticks, label: str, colour: str = INK) -> None:
    """Draw ticks with their numbers and a label below, left or right of a picture."""
    draw, numbers = ImageDraw.Draw(page), _font(9)
    beyond = TICK + GAP
    if side == "below":
        edge = frame.top + frame.height
        for share, text in ticks:
            x = _pixel(frame.left, frame.width, share)
            draw.line([(x, edge), (x, edge + TICK)], fill=FAINT)
            draw.text((x, edge + beyond + 10), text, fill=colour, font=numbers, anchor="ms")
        draw.text((frame.left + frame.width / 2, edge + beyond + 32), label, fill=colour, font=_font(10), anchor="ms")
        return
    way, edge = (-1, frame.left - 1) if side == "left" else (1, frame.left + frame.width)
    for share, text in ticks:
        y = _pixel(frame.top, frame.height, 1.0 - share)
        draw.line([(edge, y), (edge + way * TICK, y)], fill=FAINT)
        draw.text((edge + way * beyond, y), text, fill=colour, font=numbers, anchor="rm" if way < 0 else "lm")
    wide = max((numbers.getlength(text) for _, text in ticks), default=0.0)
    across, low, far, high = _font(10).getbbox(label)
    upright = Image.new("L", (int(far - across), int(high - low)))
    ImageDraw.Draw(upright).text((-across, -low), label, fill=255, font=_font(10))
    turned = upright.transpose(Image.Transpose.ROTATE_90)
    x = round(edge + way * (beyond + wide + 7)) - (turned.width if way < 0 else 0)
    page.paste(colour, (x, frame.top + (frame.height - turned.height) // 2), turned)


def _pixel(first: int, size: int, share: float) -> int:
    """Pixel at a share of a side, or of the frame at its ends."""
    return first + min(max(round(share * size - 0.5), -1), size)


@cache
def _font(points: float, *, bold: bool = False) -> ImageFont.FreeTypeFont:
    """Font that comes with Matplotlib, which is not imported for it."""
    spec = find_spec("matplotlib")
    folder = Path(str(spec and spec.origin)).parent / "mpl-data" / "fonts" / "ttf"
    return ImageFont.truetype(str(folder / f"DejaVuSans{'-Bold' * bold}.ttf"), points * DPI / 72.0)


def place_decibel_ticks(levels: tuple[float, float], gain: float, *, decibels: bool = False) -> Ticks:
    """Place ticks at round decibels along a bar that is linear in amplitude, or in decibels."""
    low, high = levels
    highest = math.floor(20.0 * math.log10(high) - gain)
    ticks: Ticks = []
    bottom, top = span_decibels(levels)
    for level in range(highest, highest - 60, -1):
        shown = level + gain
        place = (shown - bottom) / (top - bottom) if decibels else (10.0 ** (shown / 20.0) - low) / (high - low)
        if place < 0.0:
            break
        if level % 2 == 0 and (not ticks or ticks[-1][0] - place > 0.07):
            ticks.append((place, f"{level:+d}".replace("-", "−") if level else "0"))
    return ticks


def _headings(page: Image.Image, width: int, look: DisplayOptions, caption: PageCaption) -> None:
    title = caption.title if len(caption.title) <= 90 else f"{caption.title[:89]}…"
    draw, small = ImageDraw.Draw(page), _font(9, bold=True)
    for y, words, font, colour in ((34, title, _font(15, bold=True), INK), (56, caption.line, _font(10), FAINT)):
        draw.text((LEFT, y), words.replace("\n", " "), fill=colour, font=font, anchor="ls")
    if look.side in ("both", "port"):
        draw.text((LEFT, TOP - 9), "PORT", fill=FAINT, font=small, anchor="ls")
    if look.side == "both":
        draw.text((LEFT + width, TOP - 9), "STARBOARD", fill=FAINT, font=small, anchor="rs")
    elif look.side == "starboard":
        draw.text((LEFT, TOP - 9), "STARBOARD", fill=FAINT, font=small, anchor="ls")


def caption_scene(scene: Scene, look: DisplayOptions) -> PageCaption:
    """Caption of a simulated record: tow, beam, frequency, bin and ping spacing."""
    sonar, track = scene.sonar, scene.track
    height = f"altitude {scene.altitude:g} m" if track.depth is None else f"depth {track.depth:g} m"
    parts = [
        ", ".join([height, *(["terrain following"] if track.terrain_following else []), *track.kinds]),
        sonar.beam.words,
        *filter(None, [sonar.vertical.words]),
        f"{sonar.frequency / 1e3:g} kHz",
        f"{sonar.bins} bins of {100.0 * sonar.range / sonar.bins:.3g} cm",
        f"ping every {100.0 * track.speed / sonar.ping_rate:.3g} cm",
    ]
    if sonar.law == "light":
        parts.append("law light")
    return PageCaption(scene.title, _line(parts, look), "a perfect Lambert bed")


def caption_record(record: Dataset, along: float, look: DisplayOptions) -> PageCaption:
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
