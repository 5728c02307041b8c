"""Display options of a record, by name alone, so that the command line loads no plotting library."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Singles
from insonify.errors import SceneError
from insonify.files import resources
from insonify.scene.edit import read_setting

DEFAULT_PALETTE = "copper"
SIDES = ("both", "port", "starboard")
SCALES = ("fill", "true")
EXAMPLES = {bool: "true", float: "3", tuple: "[0, 6]"}
Levels = tuple[float, float]  # amplitudes at the two ends of a palette


def find_palettes() -> dict[str, Path]:
    """Palettes by name, the default first: every text file in ``resources/palettes``."""
    found = {path.stem: path for path in sorted((resources() / "palettes").glob("*.txt"))}
    return {DEFAULT_PALETTE: found[DEFAULT_PALETTE], **found}


PALETTES = tuple(find_palettes())
CHOICES = {"side": SIDES, "palette": PALETTES, "scale": SCALES}


class DisplayOptions(NamedTuple):
    """How a record is shown, in the window and as a picture."""

    side: str = "both"  # ``both``, ``port`` or ``starboard``
    ground_range: bool = False  # ground range in place of slant range; the water column then is left out
    palette: str = DEFAULT_PALETTE  # name of a palette
    gain: float = 0.0  # of both sides, dB
    water_column: bool = True  # whether slant range begins at the sonar; else at the first echo of the bed
    reverse: bool = False  # whether the palette runs from bright to dark
    decibels: bool = False  # whether the palette is linear in decibels; else in amplitude
    # (float, float) amplitudes at the ends of the palette; None to choose them from the record.
    levels: Levels | None = None
    side_gains: tuple[float, float] = (0.0, 0.0)  # (float, float) of port and starboard alone, dB
    # (float, float) time-varied gain of port and starboard beyond that of the record, in dB per decade of slant
    # range; 0 dB at half the range.
    side_slopes: tuple[float, float] = (0.0, 0.0)
    newest_on_top: bool = True  # whether later pings stand above earlier ones
    bottom_line: bool = False  # whether the first echo of the bed, and lines of equal range, are drawn
    range_lines: bool = False
    # Of the window, which the record fills: ``fill`` for all of it; ``true`` for a part of it at true scale.
    scale: str = SCALES[0]
    draped: bool = False  # of the window: whether the record is laid over the bed of the 3-D view


def read_display(settings: Sequence[str]) -> dict[str, Any]:
    """Read options from texts of the form ``name=value``, with values as in TOML."""
    return check_display(dict(read_setting(setting, "--display") for setting in settings), "--display ")


def check_display(given: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return options with values of their types; raise SceneError for unknown names and values."""
    options = {}
    for name, value in given.items():
        if name not in DisplayOptions._fields:
            known = ", ".join(DisplayOptions._fields)
            raise SceneError(f"{prefix}{name}: is not a known option; choose one of {known}")
        usual: Any = (0.0, 0.0) if name == "levels" else DisplayOptions._field_defaults[name]
        if not _fits(value, usual) or (name in CHOICES and value not in CHOICES[name]):
            known = " or ".join(CHOICES[name]) if name in CHOICES else EXAMPLES[type(usual)]
            raise SceneError(f"{prefix}{name}={value!r} is not a valid value; write for example {known}")
        options[name] = tuple(map(float, value)) if isinstance(usual, tuple) else type(usual)(value)
    return options


def display_settings(look: DisplayOptions) -> list[str]:
    """Write the options that differ from the usual ones as texts that `read_display` reads."""
    usual = DisplayOptions._field_defaults
    return [f"{name}={json.dumps(value)}" for name, value in look._asdict().items() if value != usual[name]]


def _fits(value: Any, usual: Any) -> bool:
    """Whether a value has the type of the default; a whole number counts as a number of any type."""
    if isinstance(usual, tuple):
        return isinstance(value, (list, tuple)) and len(value) == len(usual) and all(_fits(one, 0.0) for one in value)
    if isinstance(usual, bool) or not isinstance(usual, float):
        return type(value) is type(usual)
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def side_factors(look: DisplayOptions, bins: int) -> Singles | None:
    """Factors on the amplitudes of both sides, (2, bins), port first; None where neither side is changed."""
    if not any((*look.side_gains, *look.side_slopes)):
        return None
    decades = np.log10((np.arange(bins) + 0.5) / (0.5 * bins))
    decibels = np.array(look.side_gains)[:, None] + np.array(look.side_slopes)[:, None] * decades
    return np.asarray(10.0 ** (decibels / 20.0), dtype=np.float32)
