"""Measured beds with random detail between their nodes."""

import numpy as np
import pytest

from bathymetry_files import UTM, scene, sloped, write_tiff
from insonify.cli import main
from insonify.scene import SceneError, build, edit, scene_to_toml
from insonify.simulation import simulate
from insonify.terrain import build_ground


def detailed(path, *, spacing=0.25, seed=1, rms=0.05, **changes):
    detail = {"kind": "fractal", "beta": 1.4, "rms": rms, "period": 16.0} | changes
    relief = {"kind": "sum", "of": [{"kind": "dem", "path": str(path)}, detail]}
    return build({"seed": seed, "seabed": {"spacing": spacing, "relief": relief}})


def test_a_measured_bed_takes_random_detail(tmp_path):
    """2 m bathymetry with 5 cm of roughness: the measured bed between its nodes, plus a periodic relief."""
    path = write_tiff(tmp_path / "a.tif", sloped(40, 50), **UTM)
    plain, rough = build_ground(scene(path)), build_ground(detailed(path))
    assert rough.spacing == 0.25
    assert rough.heights.shape == (39 * 8 + 1, 49 * 8 + 1)
    assert (rough.x0, rough.y0) == (plain.x0, plain.y0)
    smooth = build_ground(detailed(path, rms=0.0))
    np.testing.assert_allclose(smooth.heights[::8, ::8] + smooth.datum, plain.heights + plain.datum, atol=1e-5)
    between = 0.5 * (smooth.heights[:, :-1:8] + smooth.heights[:, 8::8])
    np.testing.assert_allclose(smooth.heights[:, 4::8], between, atol=1e-5)
    detail = rough.heights + rough.datum - smooth.heights - smooth.datum
    assert detail[:256, :256].std() == pytest.approx(0.05, rel=0.02)
    np.testing.assert_allclose(detail[64:], detail[:-64], atol=1e-5)  # repeats after its period of 64 nodes
    other = build_ground(detailed(path, seed=2))
    assert np.abs(other.heights - rough.heights).max() > 0.05
    np.testing.assert_array_equal(build_ground(detailed(path)).heights, rough.heights)


def test_holes_stay_holes_under_detail_no_coarser_than_the_measurement(tmp_path):
    rows = sloped(10, 10)
    rows[4, 5] = -9999.0
    ground = build_ground(detailed(write_tiff(tmp_path / "a.tif", rows, **UTM)))
    assert np.isnan(ground.heights[40, 40])
    assert 0.0 < np.isnan(ground.heights).mean() < 0.1
    fine = write_tiff(tmp_path / "b.tif", sloped(40, 50), pixel=(0.11, 0.11), **UTM)
    assert 0.1 < build_ground(detailed(fine, spacing=5.0)).spacing <= 0.11
    wide = write_tiff(tmp_path / "c.tif", sloped(5, 5), pixel=(500.0, 500.0), **UTM)
    with pytest.raises(SceneError, match=r"seabed.spacing: 0.1 m makes 20001 nodes along a side of the measured bed"):
        build_ground(detailed(wide, spacing=0.1))


def test_a_detailed_bed_is_heard_and_drawn(tmp_path, capsys):
    path = write_tiff(tmp_path / "a.tif", np.full((60, 60), -20.0), **UTM)
    small = {"track.pings": 3, "sonar.bins": 200, "sonar.range": 30.0}
    records = [simulate(edit(detailed(path, rms=rms), small)) for rms in (0.0, 0.05)]
    assert records[1].attrs["crs"] == "EPSG:32633"
    far = records[0].intensity.values[..., 100:]
    assert np.std(records[1].intensity.values[..., 100:] / far) > 0.05
    text = tmp_path / "scene.toml"
    text.write_text(scene_to_toml(detailed(path)))
    assert main(["relief", str(text), "-o", str(tmp_path / "a.png")]) == 0
    assert main(["plan", str(text)]) == 0


@pytest.mark.parametrize(
    ("of", "expected"),
    [
        (["dem", "dem"], "of has 2 measured beds; keep one"),
        (["dem", {"kind": "power_law", "extent": "endless"}], "of is endless in one part and measured in another"),
        (["dem", {"kind": "flat"}], "flat"),
        (
            ["dem", {"kind": "power_law", "period": 16.0}, {"kind": "ripples", "period": 12.8}],
            "give all the same period",
        ),
    ],
)
def test_what_cannot_be_added_is_one_sentence(tmp_path, of, expected):
    path = write_tiff(tmp_path / "a.tif", sloped(5, 5), **UTM)
    parts = [{"kind": "dem", "path": str(path)} if part == "dem" else part for part in of]
    with pytest.raises(SceneError, match=expected):
        build({"seabed": {"relief": {"kind": "sum", "of": parts}}})
