"""The record's columns, colours, contrast and ticks."""

import math

import numpy as np
import pytest

from insonify.display.normalisation import LevelBed
from insonify.display.picture import choose_contrast, colour_rows
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify_viewer.widgets.painting import (
    HEADROOM,
    KNEE,
    colour_table,
    column_means,
    compress_highlights,
    round_steps,
    with_highlights,
)


@pytest.mark.parametrize("width", [1, 7, 100, 101, 350])
def test_display_columns_drop_no_echo(width):
    amplitude = np.zeros((1, 100), np.float32)
    for column in range(100):
        amplitude[:] = 0.0
        amplitude[0, column] = 1.0
        assert column_means(amplitude, width).max() > 0.0
    assert column_means(np.ones((2, 100), np.float32), width).tolist() == [[1.0] * width] * 2


def test_colours_run_from_low_to_high():
    table = colour_table(np.repeat(np.arange(256, dtype=np.uint8)[:, None], 3, axis=1))
    painted = colour_rows(np.array([[-1.0, 1.0, 2.0, 3.0, 9.0]], np.float32), 1.0, 3.0, table)
    assert [hex(int(word)) for word in painted[0]] == [
        "0xff000000",
        "0xff000000",
        "0xff7f7f7f",
        "0xffffffff",
        "0xffffffff",
    ]


def test_highlights_are_told_apart_and_the_bed_keeps_its_tones():
    tones = np.linspace(0.0, KNEE, 50, dtype=np.float32)
    np.testing.assert_allclose(compress_highlights(tones), tones, atol=1e-6)
    targets = compress_highlights(np.array([1.0, 2.0, 5.0, 10.0, HEADROOM], np.float32))
    assert (np.diff(targets) > 0.03).all()
    assert targets[-1] == pytest.approx(1.0)
    table = with_highlights(colour_table(np.repeat(np.arange(256, dtype=np.uint8)[:, None], 3, axis=1)))
    painted = colour_rows(np.array([[-1.0, 0.0, 0.5, 2.0, 5.0, 99.0]], np.float32), 0.0, 1.0, table)
    grey = [int(word) & 0xFF for word in painted[0]]
    assert grey[:3] == [0, 0, 127]
    assert grey[2] < grey[3] < grey[4] < grey[5] == 255


def test_the_target_of_a_scene_is_not_saturated():
    scene = edit(load_scene("pipe-on-bed"), {"track.pings": 32})
    simulation, pings = prepare(scene), np.arange(32)
    amplitude = LevelBed(simulation).amplitudes(pings)
    labels = simulation.truth(pings)
    low, high = choose_contrast(amplitude)
    tones = compress_highlights((amplitude - np.float32(low)) / np.float32(high - low))
    assert (tones[(labels.target_id == 0) & (labels.path == 0)] > 0.999).mean() < 0.05


def test_ticks_are_round():
    assert round_steps(0.0, 50.0, 3) == [0.0, 20.0, 40.0]
    assert round_steps(0.0, 0.7, 3) == pytest.approx([0.0, 0.5])
    assert round_steps(0.0, 1.0, 1) == [0.0, 1.0]


@pytest.mark.parametrize("ends", [(1.0, 1.0), (2.0, 1.0), (0.0, math.nan), (-math.inf, 0.0)])
def test_there_are_no_ticks_of_no_range(ends):
    assert round_steps(*ends, 3) == []
