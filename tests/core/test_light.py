"""Pictures by light: shadows where geometry puts them, Lambert's law, mirrors, and nothing black."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from beds import pipe_edges
from commands import run_python
from insonify.optics.cutaway import OpticalScene, make_camera, make_cutaway, make_optical_scene
from insonify.optics.light import LAMP, LightRenderer, find_optical_hits, hues, light_picture
from insonify.scene import edit, load_scene

LEVEL = {"seabed.relief": "flat", "seabed.material": {"name": "rock", "diffuse": 0.5, "specular": 0.0}, "targets": []}


def laid_out(name: str, changes: dict[str, Any]) -> OpticalScene:
    return make_optical_scene(edit(load_scene(name), changes))


def pixel(optical: OpticalScene, image: Any, place: tuple[float, float, float]) -> Any:
    height, width, _ = image.shape
    camera = make_camera(make_cutaway(optical), width)
    *slopes, ahead = camera.axes @ (np.array(place) - camera.place)
    x, y = (np.array(slopes) / ahead - camera.low) / (camera.high - camera.low)
    return image[int((1.0 - y) * height), int(x * width)].astype(float)


@pytest.mark.parametrize("gap", [0.0, 1.0])
def test_the_shadow_of_a_pipe_lies_where_geometry_puts_it(gap: float) -> None:
    optical = laid_out("pipe-on-bed", {"targets.0.gap": gap})
    image = light_picture(optical, make_cutaway(optical), 600)
    begins, ends = (math.sqrt(r**2 - 10.0**2) for r in pipe_edges(gap)[2:])  # ground ranges, the lamp 10 m up
    middle = optical.scene.track.pings // 2 * optical.scene.track.speed / optical.scene.sonar.ping_rate
    lit, dark = (
        [pixel(optical, image, (middle, -y, 0.0)).sum() for y in ranges]
        for ranges in ((ends + 0.3, ends + 1.0), (max(begins, 32.0) + 0.3, 0.5 * (begins + ends) + 0.5, ends - 0.3))
    )
    assert max(dark) < 0.7 * min(lit)


def test_light_on_a_level_bed_falls_with_the_cosine() -> None:
    optical = laid_out("pipe-on-bed", LEVEL)
    cutaway = make_cutaway(optical)
    renderer = LightRenderer(optical, cutaway)
    aside = (5.0, 10.0, 20.0)
    down = np.array([[0.0, 0.0, -1.0]])
    near, middle, far = (renderer.light_along(np.add(cutaway.lamp, (0.0, -y, 1.0)), down)[0, :3] for y in aside)
    cosines = [math.cos(math.atan2(y, 10.0)) for y in aside]
    # The light from around is the same everywhere and cancels.
    expected = (cosines[0] - cosines[1]) / (cosines[0] - cosines[2])
    np.testing.assert_allclose((near - middle) / (near - far), expected, rtol=1e-9)
    colour = LAMP * hues(("rock",))[0]
    np.testing.assert_allclose(near - far, 0.5 * colour * (cosines[0] - cosines[2]), rtol=1e-9)


def test_a_mirror_shows_what_stands_before_it() -> None:
    optical = laid_out("figure-1", {"sonar.bounces": 1})
    # From the ball's side of the mirror at y = 26.9, looking at the ball's image behind it.
    eye, image = np.array([16.0, 10.0, 4.0]), np.array([10.0, 2 * 26.9 - 20.0, 0.8])
    way = (image - eye) / np.linalg.norm(image - eye)
    found = find_optical_hits(optical.arrays, eye[None], way[None], np.array([100.0]), len(optical.ground.names))
    assert found.what.tolist() == [0, 1]
    assert np.linalg.norm(found.where[1] - [10.0, 20.0, 0.8]) == pytest.approx(0.8, abs=1e-6)
    assert found.share[1] == pytest.approx(1.0)
    assert found.normal[1] @ found.way[1] < -0.9


def test_what_leaves_into_the_water_is_accounted_for() -> None:
    """With surfaces that keep nothing, every ray ends on the bed or in the water, and no share is lost or won."""
    optical = laid_out("figure-1", {"sonar.bounces": 8})
    rng = np.random.default_rng(1)
    centre = np.array([12.0, -18.0, 2.5])  # of the clear ball
    eyes = centre + np.column_stack([rng.uniform(-6.0, 6.0, (500, 2)), rng.uniform(3.0, 8.0, 500)])
    ways = centre + rng.uniform(-1.2, 1.2, (500, 3)) - eyes
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    found = find_optical_hits(optical.arrays, eyes, ways, np.full(500, 100.0), len(optical.ground.names))
    ended = np.zeros(500)
    np.add.at(ended, found.ray, found.escaped)
    others = (found.what != 5) & (found.share > 0.0)
    np.add.at(ended, found.ray[others], found.share[others])
    first_on_ball = np.zeros(500, bool)
    first_on_ball[found.ray[(found.what == 5) & (found.share == 1.0)]] = True
    assert first_on_ball.sum() > 300
    # The bed mirrors under half a percent.
    assert np.median(ended[first_on_ball]) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("name", ["default", "double-image", "figure-5-relief", "sediments", "real-bed", "wreck"])
def test_no_picture_has_black_or_blank_regions(name: str) -> None:
    optical = make_optical_scene(load_scene(name))
    image = light_picture(optical, make_cutaway(optical), 300).astype(int)
    assert image.sum(axis=2).min() > 45
    assert (image.min(axis=2) >= 254).mean() < 0.01
    middle = image[image.shape[0] // 3 : -image.shape[0] // 3, 75:-75]
    assert middle.std() > 4.0
    sand = middle[..., 0] >= middle[..., 2] - 12
    assert sand.mean() > 0.7, "the block fills the picture"


def test_the_command_draws_the_scene_as_it_is_set_and_needs_no_viewer(tmp_path: Path) -> None:
    """No module of Qt, PyVista, VTK or the viewer can be imported."""
    code = (
        "import sys\n"
        "for name in ('PySide6', 'pyvista', 'pyvistaqt', 'vtk', 'vtkmodules', 'insonify_viewer'):\n"
        "    sys.modules[name] = None\n"
        "from insonify.cli import main\n"
        "sys.exit(main(['light', 'pipe-on-bed', '-o', 'light.png', *sys.argv[1:]]))"
    )
    gravel = ["--set", "seabed.relief=flat", "--set", "seabed.material=cobble", "--set", "targets=[]"]
    ended, printed, complaint = run_python("-c", code, *gravel, cwd=tmp_path)
    assert (ended, complaint) == (0, "")
    assert "light.png: 1200 x" in printed
    image = np.asarray(Image.open(tmp_path / "light.png").convert("RGB")).astype(int)
    middle = image[image.shape[0] // 2, 450:550]
    assert np.ptp(middle, axis=1).mean() < 30, "cobble is grey"
