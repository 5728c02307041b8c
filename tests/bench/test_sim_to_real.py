"""Detectors trained on the bundled data sets alone, tested on real pictures.

``INSONIFY_REAL_PICTURES=FOLDER pytest -m bench -s tests/bench/test_sim_to_real.py``: the folder has sub-folders
``ship``, ``plane`` and ``seafloor`` with pictures of any size. ``INSONIFY_SIM_SCENES`` is the number of scenes of a set
(40), ``INSONIFY_SIM_SETS`` a folder in which the sets are kept and grow. Where PyTorch is installed, networks learn
too; ``INSONIFY_SIM_NETWORK`` gives their steps and channels (``3000,40``; minutes on a GPU, hours without). No real
picture is used before the test.
"""

import json
import os
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from PIL import Image

from insonify import cli
from insonify.display.display_options import DisplayOptions
from insonify.display.sheet import gather_record_sheet
from insonify.io.records import read_record

REAL = os.environ.get("INSONIFY_REAL_PICTURES")
SCENES = int(os.environ.get("INSONIFY_SIM_SCENES", "40"))
NAMES = ("seabed", "ship", "aircraft")
FOLDERS = {"seafloor": 0, "ship": 1, "plane": 2}
SETS = ("wrecks", "aircraft", "seabed")
STEPS, WIDTH = map(int, os.environ.get("INSONIFY_SIM_NETWORK", "3000,40").split(","))
CHIP, SEEDS, DRAWS = 160, 3, 1000
RECORD = Path(os.environ.get("INSONIFY_REAL_DATA", ""), "xtf", "scotsman-iver2.xtf")
# Of its wreck: side, first and last metre along the track, greatest ground range; the mast's shadow reaches farther.
WRECK = (1, 20.0, 46.0, 18.0)
WINDOWS, LEVELS = (6.0, 9.0, 13.5, 20.0), (0.85, 0.8, 0.7, 0.6, 0.5)  # m on a side; chances of an object

DETECTOR = Path(__file__).parents[2] / "docs" / "howto" / "detector.py"
detector = module_from_spec(spec := spec_from_file_location("detector", DETECTOR))
spec.loader.exec_module(detector)

pytestmark = [pytest.mark.bench, pytest.mark.skipif(REAL is None, reason="INSONIFY_REAL_PICTURES names no folder")]


class Chip(NamedTuple):
    """Picture of a bundled set, the box of what it shows with its shadow, the number of its class, and its set."""

    picture: Image.Image
    box: list[int]
    number: int
    of: str


@pytest.fixture(scope="module")
def chips(tmp_path_factory):
    """Chips of the bundled sets; beds have the boxes of objects, so that the frame tells nothing."""
    folder = Path(os.environ.get("INSONIFY_SIM_SETS") or tmp_path_factory.mktemp("sets"))
    made = []
    for name in SETS:
        place = folder / name
        assert cli.main(["dataset", name, "-o", str(place), "--scenes", str(SCENES), "--scheduler", "local:2"]) == 0
        for line in map(json.loads, (place / "metadata.jsonl").read_text().splitlines()):
            boxes = [found["both"] for found in line["targets"]] or [[]]
            picture = Image.open(place / line["file_name"]).convert("L")
            made.append(Chip(picture, boxes[0], NAMES.index(line["class"] or "seabed"), name))
    rng, boxes = np.random.default_rng(1), [chip.box for chip in made if chip.box]
    return [chip if chip.box else chip._replace(box=boxes[rng.integers(len(boxes))]) for chip in made]


def measures(chance: np.ndarray, classes: np.ndarray) -> dict[str, float]:
    """Columns of the table, from the chances of the three classes."""
    metrics = pytest.importorskip("sklearn.metrics")
    decided, objects = chance.argmax(axis=1), classes > 0
    is_plane = chance[objects, 2] / (chance[objects, 1:].sum(axis=1) + 1e-12)
    return {
        "AUC object": metrics.roc_auc_score(objects, 1.0 - chance[:, 0]),
        "accuracy, object": float(((decided > 0) == objects).mean()),
        "3 classes": float((decided == classes).mean()),
        "balanced": metrics.balanced_accuracy_score(classes, decided),
        "AUC aircraft against ships": metrics.roc_auc_score(classes[objects] == 2, is_plane),
    }


@pytest.fixture(scope="module")
def forests(chips):
    """Forests of random trees, trained on chips as they are, and closely cropped as archives do."""
    ensemble, rng = pytest.importorskip("sklearn.ensemble"), np.random.default_rng(1)
    # With beds that are mistaken for objects, from which a network gains, forests take a third of the objects for beds.
    learned = [chip for chip in chips if chip.of != "seabed"]
    shown = [part for chip in learned for part in (chip.picture, detector.cropped(chip.picture, chip.box, rng))]
    features = np.array([detector.describe(picture) for picture in shown])
    classes = np.repeat([chip.number for chip in learned], 2)
    trees = [
        ensemble.ExtraTreesClassifier(600, min_samples_leaf=2, class_weight="balanced", random_state=seed)
        for seed in range(SEEDS)
    ]
    return [forest.fit(features, classes) for forest in trees]


@pytest.fixture(scope="module")
def networks(chips):
    """Networks trained on all chips, on a GPU where there is one; none without PyTorch."""
    if not find_spec("torch"):
        return []
    import torch

    if torch.cuda.is_available():
        torch.set_default_device("cuda")
        torch.backends.cudnn.benchmark = True
    import small_network  # makes tensors on the device set

    device = torch.get_default_device()
    greys = torch.stack([torch.from_numpy(np.array(chip.picture.resize((CHIP, CHIP))))[None] for chip in chips])
    boxes = [np.multiply(chip.box, CHIP / np.array(2 * chip.picture.size)) for chip in chips]
    learned = (
        greys.to(device),
        torch.tensor(np.array(boxes), dtype=torch.float32, device=device),
        torch.tensor([chip.number for chip in chips], device=device),
    )
    return [small_network.learn(*learned, seed=seed, steps=STEPS, width=WIDTH) for seed in range(SEEDS)]


def by_each(forests: list[Any], networks: list[Any], pictures: list[Image.Image]) -> dict[str, list[np.ndarray]]:
    """Chances of the classes of pictures by each forest, by each network, and by both."""
    features = np.array([detector.describe(picture) for picture in pictures])
    found = {"trees": [forest.predict_proba(features) for forest in forests]}
    if networks:
        import small_network
        import torch

        seen = torch.stack([small_network.as_seen(picture) for picture in pictures]).to(torch.get_default_device())
        found["network"] = [small_network.chances(network, seen) for network in networks]
        found["both"] = [(one + other) / 2.0 for one, other in zip(*found.values(), strict=True)]
    return found


def test_what_is_learned_from_simulation_tells_real_pictures_apart(chips, forests, networks, say):
    """Print the mean of what models reach, what their mean reaches, and its intervals by bootstrap of the pictures."""
    paths = [path for name in FOLDERS for path in sorted(Path(REAL, name).glob("*.png"))]
    pictures = [Image.open(path).convert("L") for path in paths]
    truth = np.array([FOLDERS[path.parent.name] for path in paths])
    say(f"{SCENES} scenes a set, {len(chips)} chips; networks of {STEPS} steps, {WIDTH} channels")
    for name, chances in by_each(forests, networks, pictures).items():
        chance, rng = np.mean(chances, axis=0), np.random.default_rng(1)
        found, single = measures(chance, truth), [measures(one, truth) for one in chances]
        drawn = [measures(chance[pick], truth[pick]) for pick in rng.integers(0, len(truth), (DRAWS, len(truth)))]
        say(f"{name}: mean of {len(chances)}, and their mean, {len(truth)} real pictures")
        for measure, value in found.items():
            low, high = np.percentile([one[measure] for one in drawn], [2.5, 97.5])
            mean = np.mean([one[measure] for one in single])
            say(f"{measure:28s} {mean:.3f}   {value:.3f}  ({low:.3f} to {high:.3f})")
        assert found["AUC object"] > 0.95


class Window(NamedTuple):
    """Square of one side of a record, in pixels."""

    side: int
    row: int
    column: int
    size: int

    def overlap(self, other: "Window") -> float:
        """Share of the smaller of two windows that both cover."""
        rows, columns = (
            max(min(self[k] + self.size, other[k] + other.size) - max(self[k], other[k]), 0) for k in (1, 2)
        )
        return (self.side == other.side) * rows * columns / min(self.size, other.size) ** 2


@pytest.mark.skipif(not RECORD.exists(), reason="INSONIFY_REAL_DATA has no real recording")
def test_what_is_learned_from_simulation_finds_the_wreck_of_a_real_record(forests, networks, say):
    sheet = gather_record_sheet(read_record(RECORD), DisplayOptions(ground_range=True, newest_on_top=False))
    greys = np.uint8(255.0 * np.clip(sheet.amplitude / np.percentile(sheet.amplitude, 99.5), 0.0, 1.0))
    cell = sheet.along / len(greys)
    middle = greys.shape[1] // 2
    sides = greys[:, middle - 1 :: -1], greys[:, middle:]
    windows = [
        Window(side, row, column, size)
        for side in (0, 1)
        for size in (round(metres / cell) for metres in WINDOWS)
        for row in range(0, len(greys) - size + 1, size // 4)
        for column in range(0, middle - size + 1, size // 4)
    ]
    shown = [Image.fromarray(sides[side][row : row + n, column : column + n]) for side, row, column, n in windows]
    area = 2.0 * sheet.reach * sheet.along / 1e6
    side, first, last, reach = WRECK
    for name, chances in by_each(forests, networks, shown).items():
        chance = 1.0 - np.mean(chances, axis=0)[:, 0]
        found: list[int] = []  # the best first, without those that lie over a better one
        for number in np.argsort(-chance):
            if all(windows[number].overlap(windows[better]) < 0.3 for better in found):
                found.append(number)
        apart = np.array(windows)[found]
        along, across = cell * (apart[:, 1:3] + apart[:, 3:] / 2.0).T
        is_wreck = (apart[:, 0] == side) & (first < along) & (along < last) & (across < reach)
        say(f"{name}: {len(windows)} windows of {area:.4f} km² hold {len(found)} that lie apart")
        for level in LEVELS:
            hits, false = (int((part & (chance[found] >= level)).sum()) for part in (is_wreck, ~is_wreck))
            say(f"chance {level}: {hits} on the wreck, {false} elsewhere, {false / area:.0f} a km²")
        say(f"before the first false alarm: {int(np.argmin(is_wreck))} on the wreck")
        assert is_wreck[0]
