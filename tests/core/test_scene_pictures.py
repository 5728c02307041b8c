"""Every bundled scene has a small picture of its record, and no picture is left of a scene that went."""

import pytest
from PIL import Image

from insonify.scene import bundled_scenes, resources, scene_picture

LARGEST, TOTAL = 6_000, 250_000  # bytes


@pytest.mark.parametrize("name", bundled_scenes())
def test_a_scene_has_a_small_picture(name: str) -> None:
    path = scene_picture(name)
    assert path.stat().st_size <= LARGEST
    with Image.open(path) as picture:
        assert picture.size == (150, 100)
        low, high = picture.convert("L").getextrema()
        assert high - low > 40, "it shows a record"
        edges = [picture.convert("L").getpixel(place) for place in ((0, 50), (149, 50), (75, 0), (75, 99))]
        assert min(edges) < 200, "the record fills it, without a page around"


def test_pictures_are_those_of_the_scenes_and_light() -> None:
    files = list((resources() / "scenes" / "pictures").iterdir())
    assert {path.name for path in files} == {f"{name}.jpg" for name in bundled_scenes()}
    assert sum(path.stat().st_size for path in files) <= TOTAL
