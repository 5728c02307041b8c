"""Display options as texts: every one is written and read back, and a mistake is one sentence."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from insonify.cli import main
from insonify.display.display_options import DisplayOptions, display_settings, read_display
from insonify.errors import SceneError

ALL_CHANGED = DisplayOptions(
    side="port",
    ground_range=True,
    palette="grey",
    gain=-3.5,
    water_column=False,
    reverse=True,
    decibels=True,
    levels=(0.1, 4.0),
    side_gains=(0.0, 6.0),
    side_slopes=(-2.0, 3.0),
    newest_on_top=False,
    bottom_line=True,
    range_lines=True,
    scale="true",
    draped=True,
)


def test_every_option_is_read_back() -> None:
    usual = DisplayOptions()
    assert all(one != other for one, other in zip(ALL_CHANGED, usual))
    assert DisplayOptions(**read_display(display_settings(ALL_CHANGED))) == ALL_CHANGED
    assert display_settings(usual) == []


@pytest.mark.parametrize(
    "setting",
    [
        "colour=red",
        'palette="mauve"',
        "reverse=1",
        "gain=true",
        "gain=nan",
        "levels=[1]",
        'side_gains=[0, "a"]',
        "water_column",
    ],
)
def test_a_mistake_names_option_and_value(setting: str) -> None:
    with pytest.raises(SceneError, match=f"--display .*{setting.split('=')[0]}"):
        read_display([setting])


def test_a_whole_number_passes_for_a_gain() -> None:
    assert read_display(["gain=6", "levels=[0, 4]"]) == {"gain": 6.0, "levels": (0.0, 4.0)}


def test_the_command_draws_by_the_options(tmp_path: Path) -> None:
    for name, more in (("usual", []), ("shown", ["--display", "reverse=true", "--display", "water_column=false"])):
        words = ["render", "figure-4a", "--set", "track.pings=64", "-o", str(tmp_path / f"{name}.png")]
        assert main([*words, *more]) == 0
    usual, shown = (np.asarray(Image.open(tmp_path / f"{name}.png").convert("L")) for name in ("usual", "shown"))
    assert usual.shape != shown.shape or not np.array_equal(usual, shown)
