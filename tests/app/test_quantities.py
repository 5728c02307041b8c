"""Numbers as the panel prints and reads them, and their places on a slider."""

import numpy as np
import pytest

from insonify.scene.units import parse_quantity
from insonify_viewer.state.quantities import (
    format_duration,
    format_quantity,
    slider_position,
    slider_value,
)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (4e5, "Hz", "400 kHz"),
        (1e-4, "s", "0.1 ms"),
        (1.2e6, "Hz", "1.2 MHz"),
        (10.0, "Hz", "10 Hz"),
        (1.0, "°", "1°"),
        (0.0, "s", "0 s"),
        (48.0, "cycles/period", "48"),
        (100000.0, "", "100000"),
        (-0.125, "m", "-0.125 m"),
    ],
)
def test_numbers_are_printed_and_read_back(value, unit, text):
    assert format_quantity(value, unit) == text
    assert parse_quantity(text, unit) == pytest.approx(value)


@pytest.mark.parametrize(
    ("text", "unit", "like", "value"),
    [
        ("0.2", "s", "0.1 ms", 2e-4),
        ("200 µs", "s", "0.1 ms", 2e-4),
        ("2e-4", "s", "0.1 ms", 2e-4),
        ("500 kHz", "Hz", "400 kHz", 5e5),
        ("500khz", "Hz", "400 kHz", 5e5),
        ("500", "Hz", "400 kHz", 5e5),
        ("4e5", "Hz", "400 kHz", 4e5),
        ("1.2M", "Hz", "400 kHz", 1.2e6),
        ("20 cm", "m", "0.1 m", 0.2),
        ("20", "m", "0.1 m", 20.0),
        ("1,5 m", "m", "", 1.5),
        ("−3", "m", "2 m", -3.0),
        ("17.45 mrad", "°", "1°", 0.99981),
        ("4 kn", "m/s", "2 m/s", 2.05778),
        ("0.3", "", "0.2", 0.3),
    ],
)
def test_units_that_people_write_are_read(text, unit, like, value):
    assert parse_quantity(text, unit, like) == pytest.approx(value, rel=1e-5)


def test_times_are_printed_in_three_digits():
    assert [format_duration(seconds) for seconds in (1.23e-5, 9.99e-4, 9.996e-4, 1.288e-3)] == [
        "12.3 µs",
        "999 µs",
        "1 ms",
        "1.29 ms",
    ]


def test_nonsense_is_not_a_number():
    assert [parse_quantity(text, "m") for text in ("", "abc", "nan", "inf", "1 2", "3 kHz", "1e999")] == [None] * 7


@pytest.mark.parametrize("log", [False, True])
def test_slider_places_and_values_agree(log):
    ends = (0.01, 10.0)
    for part in np.linspace(0.0, 1.0, 17):
        value = slider_value(float(part), ends, log=log, integer=False)
        assert slider_position(value, ends, log=log) == pytest.approx(part, abs=2e-3)
    assert slider_value(0.0, ends, log=log, integer=False) == 0.01
    assert slider_value(1.0, ends, log=log, integer=False) == 10.0
    assert slider_position(1e9, ends, log=log) == 1.0
