"""Records of the bundled scenes are what they were: bit for bit where the digests were taken, closely anywhere else.

``pytest tests/core/test_golden_records.py --update-golden`` takes them anew. The record that comes with the
package is that of the default scene.
"""

import hashlib
import json
import platform
from pathlib import Path

import llvmlite
import numba
import numpy as np
import pytest

from insonify.display import example
from insonify.display.normalisation import LevelBed
from insonify.scene import DEFAULT_SCENE, bundled_scenes, edit, load_scene
from insonify.simulation import prepare

GOLDEN = Path(__file__).parent.parent / "golden" / "records.json"
PINGS = 12
BLOCKS = 8  # of bins, a side, whose energies are kept in plain numbers
# Scene, changes, method: what the bundled scenes alone do not reach.
VARIANTS = {
    "default by rays": ("default", {"track.pings": 64}, "rays"),
    "default by march": ("default", {"track.pings": 64}, "march"),
    "default by coherent speckle": ("default", {"receiver.speckle": {"kind": "coherent", "density": 20.0}}, "auto"),
    "two pings of double-image": ("double-image", {"track.pings": 2}, "auto"),
    "targets under an array": ("targets", {"sonar.beam": {"kind": "array", "length": 0.5, "squint": 3.0}}, "auto"),
    "targets in light": ("targets", {"sonar.law": "light", "sonar.vertical": {"kind": "fan"}}, "auto"),
    "ghosts on a rough sea": ("ghosts", {"water.surface": {"kind": "rough", "wind_speed": 6.0}}, "auto"),
    "ghosts by rays": ("ghosts", {"sonar.beam": "knife", "receiver.speckle": "none"}, "rays"),
    "thermocline by rays": ("thermocline", {"sonar.beam": "knife"}, "rays"),
    "sediments in K speckle": ("sediments", {"receiver.speckle": "k", "sonar.pulse": "chirp"}, "auto"),
}
# Cases of more than a minute of processor time.
LONG = {"double-image"}
CASES = {name: (name, {}, "auto") for name in bundled_scenes()} | VARIANTS


def machine() -> str:
    """Name all that machine code depends on: the same sources then give the same bits."""
    features = llvmlite.binding.get_host_cpu_features().flatten()
    code = f"{llvmlite.binding.get_host_cpu_name()} {features} {numba.__version__} {llvmlite.__version__}"
    return f"{platform.machine()} numpy {np.__version__} {hashlib.sha256(code.encode()).hexdigest()[:16]}"


def digest(name: str) -> dict[str, object]:
    scene_name, changes, method = CASES[name]
    scene = edit(load_scene(scene_name), changes)
    simulation = prepare(scene, method=method)
    pings = np.unique(np.linspace(0, scene.track.pings - 1, PINGS).astype(np.int64))
    # A ping's record and truth together: the bed about it is made once.
    both = [(simulation.intensity(ping), simulation.truth(ping)) for ping in np.split(pings, pings.size)]
    record = np.concatenate([one for one, _ in both])
    truth = [np.concatenate(column) for column in zip(*(labels for _, labels in both))]
    blocks = np.array_split(record.astype(np.float64), BLOCKS, axis=2)
    return {
        "record": hashlib.sha256(np.ascontiguousarray(record).tobytes()).hexdigest()[:16],
        "truth": hashlib.sha256(b"".join(np.ascontiguousarray(column).tobytes() for column in truth)).hexdigest()[:16],
        "energy": [[float(f"{block[:, side].sum():.6e}") for block in blocks] for side in range(2)],
    }


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name in LONG)) for name in CASES])
def test_a_record_is_what_it_was(name: str, request: pytest.FixtureRequest) -> None:
    found = digest(name)
    golden = json.loads(GOLDEN.read_text()) if GOLDEN.exists() else {}
    if request.config.getoption("--update-golden"):
        if golden.get("machine") != machine():
            golden = {"machine": machine(), "records": {}}
        golden["records"][name] = found
        rows = [f"  {json.dumps(name)}: {json.dumps(kept)}" for name, kept in sorted(golden["records"].items())]
        text = ",\n".join(rows)
        GOLDEN.write_text(f'{{\n "machine": {json.dumps(golden["machine"])},\n "records": {{\n{text}\n }}\n}}\n')
        return
    kept = golden["records"][name]
    energy = np.array(kept["energy"])
    np.testing.assert_allclose(found["energy"], energy, rtol=1e-4, atol=1e-6 * energy.max())
    if golden["machine"] == machine():
        assert found["record"] == kept["record"]
        assert found["truth"] == kept["truth"]


def test_the_example_is_the_record_of_the_default_scene_as_it_is_traced_and_of_no_other_scene_or_version(monkeypatch):
    scene = load_scene(DEFAULT_SCENE)
    shipped, pings = example.read_example(scene), np.arange(scene.track.pings)
    assert shipped is not None, "run python docs/make example"
    traced = LevelBed(prepare(scene)).amplitudes(pings)
    assert shipped.shape == traced.shape
    assert shipped.dtype == traced.dtype
    off, whole = (np.linalg.norm(each, axis=(1, 2)) for each in (shipped - traced, traced))
    assert off.max() <= 2.5e-4 * whole.min()  # the bits that are not stored
    assert ((shipped == 0.0) == (traced == 0.0)).all()
    assert example.FILE.stat().st_size <= 2_000_000
    assert example.read_example(edit(scene, {"seed": scene.seed + 1})) is None
    monkeypatch.setattr(example, "version", lambda _: "0.0")
    assert example.read_example(scene) is None
