"""Numbers with units in settings of the command line."""

import pytest

from insonify.scene import edit, load_scene, read_setting


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("track.speed=3kn", 3.0 * 1852.0 / 3600.0),
        ("track.speed=3 kn", 3.0 * 1852.0 / 3600.0),
        ("track.speed=3", 3),
        ("sonar.frequency=455kHz", 455e3),
        ("sonar.pulse.duration=0.1ms", 1e-4),
        ("sonar.beam.width=2°", 2.0),
        ("track.start.0=0.2 km", 200.0),
        ("targets.0.radius=30cm", 0.3),
        ("title=3kn", "3kn"),
        ("water.absorption=francois_garrison", "francois_garrison"),
    ],
)
def test_a_number_may_have_a_unit_where_its_field_has_one(text: str, value: float | str) -> None:
    path, read = read_setting(text)
    assert read == (pytest.approx(value) if isinstance(value, float) else value)
    edit(load_scene("default"), {path: read})


def test_an_unknown_unit_stays_text() -> None:
    assert read_setting("track.speed=3furlongs") == ("track.speed", "3furlongs")
    assert read_setting("nowhere.at.all=3kn") == ("nowhere.at.all", "3kn")
