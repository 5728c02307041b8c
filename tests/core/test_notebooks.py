"""Records, scenes and plans in notebooks, and the notebooks of the documentation."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import insonify
from insonify.errors import SceneError
from insonify.io.records import read_record, write_record
from insonify.scene import edit, load_scene

NOTEBOOKS = Path(__file__).parents[2] / "docs" / "notebooks"


def execute(name: str) -> dict:
    """Run the cells of a notebook; return its names, and under ``shown`` the values of last lines."""
    notebook = json.loads((NOTEBOOKS / name).read_text(encoding="utf-8"))
    space: dict = {"shown": []}
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        assert not cell["outputs"], "outputs are stripped"
        *lines, last = "".join(cell["source"]).splitlines()
        is_value = re.fullmatch(r"[\w.]+(\(.*\))?", last) is not None
        exec("\n".join([*lines, f"shown.append({last})" if is_value else last]), space)
    return space


def test_the_lesson_measures_heights_of_shadows(capsys):
    space = execute("shadows.ipynb")
    scene, plan, picture = space["shown"]
    assert "A plate of 1.5 m stands on a level bed." in scene._repr_html_()
    assert "estimated error" in plan._repr_html_()
    assert min(picture.size) > 300
    np.testing.assert_allclose(list(space["heights"].values()), 1.5, atol=0.08)


def test_the_detector_finds_boulders_and_errs_less_with_a_higher_threshold(capsys):
    found, false = np.transpose(list(execute("detector.ipynb")["curve"].values()))
    assert found.max() >= 8
    assert (np.diff(false) <= 0).all()
    assert false[-1] == 0


def test_sliders_draw_a_record(recwarn):
    widgets = pytest.importorskip("ipywidgets")
    (panel,) = execute("sliders.ipynb")["shown"]
    assert [type(child) for child in panel.children[:2]] == [widgets.FloatSlider] * 2
    assert panel.f(altitude=5.0, gap=0.5).size[0] > 300


def test_cards_are_escaped_small_and_need_nothing_from_outside():
    small = {"track.pings": 20, "sonar.bins": 60, "title": "<script>alert(1)</script>", "description": "a & <i>b</i>"}
    scene = edit(load_scene("default"), small)
    for page in (scene._repr_html_(), insonify.plan(scene)._repr_html_(), insonify.simulate(scene)._repr_html_()):
        assert "<script" not in page
        assert "<i>b" not in page
        assert len(page) < 60_000
        assert not re.search(r"(src|href)=['\"](?!#)", page)
    assert "&lt;script&gt;" in scene._repr_html_()


def test_a_record_is_drawn_and_stays_one(tmp_path):
    record = insonify.simulate(edit(load_scene("default"), {"track.pings": 20, "sonar.bins": 60}))
    wide, port = record.plot(), record.isel(ping_time=slice(10)).plot(side="port", palette="grey")
    assert port.size < wide.size
    with pytest.raises(SceneError, match="palette='red' is not a valid value; write for example copper"):
        record.plot(palette="red")
    with pytest.raises(SceneError, match="shade: is not a known option; choose one of side"):
        record.plot(shade=1)
    for name in ("a.nc", "a.zarr"):
        write_record(tmp_path / name, [record])
        assert read_record(tmp_path / name).plot().size == wide.size
    assert xr.load_dataset(tmp_path / "a.nc").plot().size == wide.size
    with pytest.raises(ValueError, match="explicit plot method"):
        record[["platform_x"]].plot()
    assert len(record.plot.scatter(x="platform_x", y="platform_depth").get_offsets()) == 20
