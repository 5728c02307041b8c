"""Data sets: distributions and draws from them, what tiles show, and that annotations are those of the labels."""

import io
import itertools
import json
import math
import tarfile
from collections import Counter
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml
import zarr
from PIL import Image
from pydantic import TypeAdapter, ValidationError
from scipy import stats

import insonify
from commands import refused
from insonify import cli
from insonify.files import bundled_meshes, bundled_specifications
from insonify.kernels.sweep.bed_stretches import NO_TARGET
from insonify.scene import edit, load_scene, scene_from_toml, scene_to_toml
from insonify.surveys.annotations import Yolo
from insonify.surveys.datasets.scenes import Draws, draw_scene, hash_share, split_of
from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.datasets.tiles import FIRST_CLASS, SHADOW, describe_region, drop_strays, starts
from insonify.surveys.datasets.work import DatasetWork
from insonify.surveys.distributions import DISTRIBUTIONS, DistributionKind, Drawn
from insonify.surveys.engine import done_jobs, finish, read_flag
from insonify.surveys.specification import read_specification
from own_kinds import forgetting
from small_sets import SET, contents, data_set, run_here, write_set

BASE = load_scene("default")
SPLITS = "train", "validation", "test"


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A data set of eight scenes, made by the command."""
    folder = tmp_path_factory.mktemp("small")
    path = write_set(folder)
    assert run_here("dataset", str(path), "-o", str(folder / "set")) == 0
    return folder / "set"


def first_job(one, folder):
    """Do the first job of a set; return its folder."""
    work = DatasetWork(one, BASE, folder / "set")
    finish(work, work.names()[0])
    return work.folder


def metadata(folder):
    return [json.loads(line) for line in (folder / "metadata.jsonl").read_text().splitlines()]


def pixels(path):
    with Image.open(path) as picture:
        return np.asarray(picture)


def decoded(segmentation):
    """Mask of COCO's run lengths, of which every second one is of the region."""
    lengths = segmentation["counts"]
    return np.repeat(np.arange(len(lengths)) % 2 == 1, lengths).reshape(segmentation["size"], order="F")


def test_a_scene_depends_on_its_number_and_no_value_on_another_field():
    one, more = data_set(), data_set(SET.replace("[set]\n", '[set]\n"sonar.frequency" = 3e5\n'))
    first = draw_scene(one, BASE, 3)
    assert first == draw_scene(one, BASE, 3)
    assert first.draws.drawn == draw_scene(more, BASE, 3).draws.drawn
    assert first.scene.seed != draw_scene(one, BASE, 4).scene.seed
    assert 5.0 <= first.scene.track.altitude <= 7.0


def test_targets_lie_clear_of_one_another_within_range():
    group = {"name": "rock", "of": ["rock-round"], "count": 6}
    for number in range(20):
        scene = draw_scene(data_set(targets=[group], negatives=0.0), BASE, number).scene
        places, radius = [target.position for target in scene.targets], scene.targets[0].outline.radius
        assert len(places) == 6
        assert all(math.dist(a, b) > 2.0 * radius for n, a in enumerate(places) for b in places[:n])
        assert all(scene.altitude < abs(y) < 24.0 for _, y in places)


def test_negatives_counts_and_splits_have_their_shares():
    one = data_set(negatives=0.3)
    counts = [list(draw_scene(one, BASE, number).classes.values()) for number in range(300)]
    assert 60 <= counts.count([]) <= 120
    assert {len(names) for names in counts if names} == {2, 3}
    shares = {"train": 0.7, "validation": 0.2, "test": 0.1}
    for scenes in (20, 100, 1000):
        found = [split_of(shares, number) for number in range(scenes)]
        assert all(abs(found.count(name) - share * scenes) <= 2.0 for name, share in shares.items())


@pytest.mark.parametrize(
    ("length", "size", "overlap"), [(512, 256, 0.0), (512, 256, 0.25), (100, 100, 0.5), (97, 32, 0.3)]
)
def test_tiles_reach_both_ends_with_the_overlap_asked_for(length, size, overlap):
    places = starts(length, size, overlap)
    assert places[0] == 0
    assert places[-1] == length - size
    assert all(b - a <= math.ceil(size * (1.0 - overlap)) for a, b in itertools.pairwise(places))


def test_run_lengths_give_the_region_back():
    region = np.random.default_rng(1).random((13, 7)) < 0.4
    for mask in (region, ~region):
        told = describe_region(mask)
        np.testing.assert_array_equal(decoded(told["segmentation"]), mask)
        assert told["area"] == mask.sum()
    assert describe_region(np.zeros((4, 4), bool)) is None


def test_every_image_has_its_mask_and_labels_and_one_split_that_of_its_scene(small):
    lines, of_scene = metadata(small), {}
    assert len(lines) > 20
    for line in lines:
        path = small / line["file_name"]
        image, mask = (pixels(str(path).replace("/images/", f"/{kind}/")) for kind in ("images", "masks"))
        assert image.shape == mask.shape == (64, 80)
        assert image.dtype == mask.dtype == np.uint8
        labels = (small / line["file_name"].replace("/images/", "/labels/")).with_suffix(".txt").read_text()
        assert len(labels.splitlines()) == len(line["targets"])
        assert line["file_name"].startswith(f"{line['split']}/")
        of_scene.setdefault(line["scene"], set()).add(line["split"])
        assert line["hash"]
        assert 5.0 <= line["drawn"]["track.altitude"] <= 7.0
    assert all(len(splits) == 1 for splits in of_scene.values())
    both = (json.loads((small / split / "coco-both.json").read_text())["images"] for split in ("train", "test"))
    train, test = ({image["file_name"] for image in images} for images in both)
    assert train.isdisjoint(test)


def test_annotations_are_those_of_the_simulation_by_truth(small):
    """The boxes of COCO, put back into the record, are those that the labels of the whole record give."""
    told = [read_flag(small, name) for name in sorted(path.stem for path in small.glob("jobs/*/*.json"))]
    scene = next(one for one in told if sum(len(tile["targets"]) for tile in one["tiles"]) > 2)
    record = insonify.simulate(scene_from_toml(scene["scenes"][0]["toml"]), truth=True)
    for tile in scene["tiles"]:
        for found in tile["targets"]:
            whole = record["echo_box"].sel(channel=tile["side"]).values[found["target"]]
            if found["echo"] is None:
                continue
            x, y, width, height = found["echo"]["box"]
            first, near = tile["first_ping"] + y, tile["first_bin"] + x
            assert whole[0] <= first <= first + height - 1 <= whole[1]
            assert whole[2] <= near <= near + width - 1 <= whole[3]
            if found["shown"] == 1.0:
                assert [first, first + height - 1, near, near + width - 1] == whole.tolist()


def test_masks_yolo_and_coco_agree(small):
    coco = json.loads((small / "train" / "coco-echo.json").read_text())
    names = {category["id"]: category["name"] for category in coco["categories"]}
    assert list(names.values()) == ["drum", "rock"]
    images = {image["id"]: image for image in coco["images"]}
    assert coco["annotations"]
    for annotation in coco["annotations"]:
        image = images[annotation["image_id"]]
        mask = pixels(small / image["file_name"].replace("/images/", "/masks/"))
        region = decoded(annotation["segmentation"])
        assert (mask[region] == FIRST_CLASS + annotation["category_id"] - 1).all()
        assert annotation["area"] == region.sum()
    shadows = json.loads((small / "train" / "coco-shadow.json").read_text())["annotations"]
    dark = pixels(small / images[shadows[0]["image_id"]]["file_name"].replace("/images/", "/masks/"))
    assert (dark[decoded(shadows[0]["segmentation"])] >= SHADOW).all()
    coco = json.loads((small / "train" / "coco-both.json").read_text())
    image = next(one for one in coco["images"] if one["id"] == coco["annotations"][0]["image_id"])
    x, y, width, height = coco["annotations"][0]["bbox"]
    line = (small / image["file_name"].replace("images", "labels")).with_suffix(".txt").read_text().splitlines()[0]
    shares = [(x + width / 2) / 80, (y + height / 2) / 64, width / 80, height / 64]
    np.testing.assert_allclose([float(share) for share in line.split()[1:]], shares, atol=1e-6)


@pytest.mark.parametrize(("start", "file"), [(".", "data.yaml"), ("..", "set/data.yaml"), ("../..", ""), ("train", "")])
def test_yolo_finds_the_images_from_any_folder(small, monkeypatch, start, file):
    """By the rules of ultralytics: `path` or the folder of the file, in the working folder if it exists there."""
    monkeypatch.chdir(small / start)
    file = Path(file or small / "data.yaml")
    declared = yaml.safe_load(file.read_text())
    folder = Path(declared.get("path") or file.parent)
    assert folder.exists()
    folders = {role: (folder / declared[role]).resolve() for role in ("train", "val", "test")}
    assert folders == {role: small.resolve() / split / "images" for role, split in zip(folders, SPLITS)}
    assert declared["names"] == {0: "drum", 1: "rock"}


@pytest.fixture(scope="module")
def formats(tmp_path_factory):
    """A set in all formats, and its metadata."""
    folder = tmp_path_factory.mktemp("formats")
    path = write_set(folder, SET, annotations='["coco", "yolo", "voc", "huggingface", "croissant"]', scenes="3")
    assert run_here("dataset", str(path), "-o", str(folder / "set")) == 0
    return folder / "set", [json.loads(line) for line in (folder / "set" / "metadata.jsonl").read_text().splitlines()]


def test_voc_has_the_boxes_of_the_metadata_counted_from_one(formats):
    folder, lines = formats
    assert any(line["targets"] for line in lines)
    for line in lines:
        path = folder / line["file_name"].replace("/images/", "/annotations/").replace(".png", ".xml")
        tree = ElementTree.parse(path)
        assert [int(tree.findtext(f"size/{side}")) for side in ("height", "width")] == line["shape"]
        boxes = [
            [int(one.findtext(f"bndbox/{c}")) for c in ("xmin", "ymin", "xmax", "ymax")] for one in tree.iter("object")
        ]
        assert boxes == [[x + 1, y + 1, x + w, y + h] for x, y, w, h in (one["both"] for one in line["targets"])]


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_coco_is_read_by_its_own_library(formats):
    coco = pytest.importorskip("pycocotools.coco")
    folder, _ = formats
    read = coco.COCO(str(folder / "train" / "coco-both.json"))
    assert read.anns
    for one in read.anns.values():
        assert read.annToMask(one).sum() == one["area"]


def test_hugging_face_loads_the_set_and_writes_parquet(formats, tmp_path):
    datasets = pytest.importorskip("datasets")
    folder, lines = formats
    loaded = datasets.load_dataset(str(folder), cache_dir=str(tmp_path / "cache"))
    for split, found in loaded.items():
        wanted = [line for line in lines if line["split"] == split]
        assert found.num_rows == len(wanted)
        assert {len(row["objects"]["bbox"]) for row in found} == {len(line["targets"]) for line in wanted}
        assert list(found[0]["image"].size) == wanted[0]["shape"][::-1]
    loaded["train"].to_parquet(tmp_path / "train.parquet")
    assert datasets.Dataset.from_parquet(str(tmp_path / "train.parquet")).num_rows == loaded["train"].num_rows


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_croissant_describes_fields_that_its_library_reads(formats):
    croissant = pytest.importorskip("mlcroissant")
    folder, lines = formats
    records = croissant.Dataset(jsonld=str(folder / "croissant.json")).records("tiles")
    assert [record["tiles/file_name"].decode() for record in records] == [line["file_name"] for line in lines]


def test_fiftyone_reads_coco(formats):
    fiftyone = pytest.importorskip("fiftyone")
    folder, lines = formats
    labels = {"dataset_type": fiftyone.types.COCODetectionDataset, "labels_path": str(folder / "train/coco-both.json")}
    read = fiftyone.Dataset.from_dir(data_path=str(folder), **labels)
    assert len(read) == sum(line["split"] == "train" for line in lines)


def test_merged_sets_have_one_number_for_each_class():
    bundled = [
        read_specification(name, DatasetSpecification, "datasets") for name in bundled_specifications("datasets")
    ]
    assert len({tuple(one.classes) for one in bundled}) == 1
    assert {group.name for one in bundled for group in one.targets} == set(bundled[0].classes)


def test_yolo_without_classes_names_none(tmp_path):
    with Yolo().collect(tmp_path, SPLITS, []):
        pass
    assert yaml.safe_load((tmp_path / "data.yaml").read_text())["names"] == {}


PARTS = {  # rows and columns of the parts of a region, and the rows and columns that are left
    "one part": ([(10, 20, 10, 30)], (10, 20, 10, 30)),
    "a stray bin above": ([(30, 40, 10, 30), (2, 3, 12, 13)], (30, 40, 10, 30)),
    "stray bins all about": ([(30, 40, 10, 30), (2, 3, 2, 3), (58, 59, 70, 71), (35, 36, 75, 77)], (30, 40, 10, 30)),
    "halves": ([(5, 15, 10, 20), (40, 50, 10, 20)], (5, 50, 10, 20)),
    "a tenth": ([(30, 40, 10, 28), (2, 6, 10, 15)], (2, 40, 10, 28)),
    "a speckled echo": (
        [(row, row + 1, column, column + 1) for row in range(8, 40, 2) for column in range(8, 60, 2)],
        None,
    ),
}


@pytest.mark.parametrize(("parts", "left"), PARTS.values(), ids=PARTS)
def test_stray_bins_do_not_make_a_box_larger(parts, left):
    layer = np.full((64, 80), NO_TARGET, np.int16)
    for top, bottom, first, last in parts:
        layer[top:bottom, first:last] = 3
    layer[60, :] = 5  # another target
    before = layer.copy()
    drop_strays(layer, 3)
    assert np.array_equal(layer == 5, before == 5)
    if left is None:
        assert (layer == 3).sum() > 0.9 * (before == 3).sum()
        left = 8, 39, 8, 59
    x, y, wide, high = describe_region(layer == 3)["box"]
    assert (y, y + high, x, x + wide) == pytest.approx(left, abs=2 if len(parts) > 9 else 0)
    inside = np.s_[y : y + high, x : x + wide]
    assert np.array_equal(layer[inside], before[inside]), "bins within the box stay"


@pytest.mark.parametrize("kind", ["tiles", "chips"])
def test_a_target_of_which_a_picture_shows_nothing_is_not_annotated(kind):
    """A box whose echo and shadow drown in noise is there by truth alone; without the noise it is annotated."""
    changes = {"targets": [{"name": "crate", "of": [{"kind": "box", "size": [1.5, 1.5, 0.6]}], "along": 0.5}]}
    changes |= {"groups": "one", "negatives": 0.0, "tiles": {"pings": 96, "bins": 160}}
    changes |= {"chips": {"pixels": 48}, "sampling": {"length": 30.0, "altitude": 0.2}} if kind == "chips" else {}
    found = {}
    for snr in (30.0, -40.0):
        for contrast in (1.0, 0.0):
            kinds = {kind: changes.get(kind, {}) | {"contrast": contrast}}
            one = data_set(**changes | kinds)
            drawn = draw_scene(one, BASE, 1)
            noisy = edit(
                drawn.scene, {"receiver.noise": {"kind": "snr", "value": snr, "at": 0.7 * drawn.scene.sonar.range}}
            )
            tiles = list(DatasetWork(one, BASE, None).cut(drawn._replace(scene=noisy)))
            found[snr, contrast] = [each["contrast"] for tile in tiles for each in tile.description["targets"]]
    assert found[30.0, 1.0] == found[30.0, 0.0] != []
    assert min(found[30.0, 1.0]) > 1.0
    assert found[-40.0, 1.0] == []
    assert max(found[-40.0, 0.0]) < 0.5


def test_pixels_of_any_size_show_no_more_of_a_target_than_there_is():
    shares = []
    for pixels_across in (16, 40, 47, 64, 200, 331):
        one = data_set(
            negatives=0.0, chips={"pixels": pixels_across, "margin": 3.0}, sampling={"length": 30.0, "altitude": 0.2}
        )
        drawn = draw_scene(one, BASE, 2)
        tiles = list(DatasetWork(one, BASE, None).cut(drawn))
        shares.append([each["shown"] for tile in tiles for each in tile.description["targets"]])
    assert shares[0]
    assert all(each == shares[0] for each in shares[1:]), "of the record, whatever the pixels"
    assert max(shares[0]) <= 1.0


def test_pictures_a_datasheet_and_checksums_show_what_the_set_holds(small):
    for name in ("contact-sheet.png", "class-balance.png"):
        assert min(pixels(small / name).shape[:2]) > 200
    sheet, lines = (small / "datasheet.md").read_text(), metadata(small)
    assert f"{len(lines)} images of 8 scenes" in sheet
    train = [line for line in lines if line["split"] == "train"]
    found = Counter(target["class"] for line in train for target in line["targets"])
    counts = len(train), sum(not line["targets"] for line in train), *(found[name] for name in data_set().classes)
    assert f"| train | {' | '.join(map(str, counts))} |" in sheet
    sums = dict(reversed(line.split("  ")) for line in (small / "SHA256SUMS").read_text().splitlines())
    files = contents(small)
    assert sums == {line["file_name"]: files[line["file_name"]] for line in lines}


def test_a_second_run_does_nothing_and_a_greater_number_adds_scenes(small, tmp_path, capsys):
    before = contents(small)
    path = write_set(tmp_path)
    assert cli.main(["dataset", str(path), "-o", str(small)]) == 0
    assert contents(small) == before
    assert run_here("dataset", str(path), "-o", str(small), "--scenes", "9") == 0
    after = contents(small)
    assert {name for name in before if "images" in name} <= set(after)
    assert all(after[name] == digest for name, digest in before.items() if "/images/" in name)
    assert "9 scenes" in capsys.readouterr().out
    assert cli.main(["dataset", str(path), "-o", str(small), "--scenes", "2"]) == 2
    assert "contains 7 jobs of another data set" in capsys.readouterr().err


@pytest.mark.parametrize("kind", ["webdataset", "zarr"])
def test_shards_hold_what_the_folders_hold(small, tmp_path, kind):
    one = data_set(scenes=4, storage={"kind": kind, "scenes": 2}, splits={"train": 1.0})
    work = DatasetWork(one, BASE, tmp_path / "set")
    for name in work.names():
        finish(work, name)
    told = [tile for name in work.names() for tile in read_flag(work.folder, name)["tiles"]]
    plain = {line["name"]: line["file_name"] for line in metadata(small) if line["scene"] < 4}
    assert [tile["name"] for tile in told] == list(plain)
    for tile in told:
        image = one.storage.read_image(work.folder, tile["file"])
        np.testing.assert_array_equal(image, pixels(small / plain[tile["name"]]))
    if kind == "zarr":
        return
    # As webdataset reads archives.
    with tarfile.open(next(work.folder.rglob("*.tar"))) as archive:
        members = [entry.name for entry in archive]
        told = json.load(archive.extractfile(next(name for name in members if name.endswith(".json"))))
        picture = Image.open(io.BytesIO(archive.extractfile(f"{told['name']}.png").read()))
    assert picture.size == (80, 64)
    keys, _, kinds = zip(*(name.partition(".") for name in members))
    assert list(keys) == sorted(keys, key=keys.index)  # what belongs to a tile stands together
    assert set(kinds) == {"png", "mask.png", "txt", "json"}


def test_a_zarr_store_is_read_by_zarr(tmp_path):
    one = data_set(storage={"kind": "zarr", "scenes": 2}, images={"bits": 16})
    (path,) = first_job(one, tmp_path).rglob("*.zarr")
    group = zarr.open_group(path, mode="r")
    assert group["images"].shape == group["masks"].shape == (len(group.attrs["names"]), 64, 80)
    assert group["images"].dtype == np.uint16


def test_grey_levels_are_decibels_about_the_median(tmp_path):
    levels = {"bits": 16, "low": -30.0, "high": 30.0}
    one = data_set(images=levels, targets=[], tiles={"pings": 64, "bins": 80})
    folder = first_job(one, tmp_path)
    (name,) = done_jobs(folder)
    tiles = [tile for tile in read_flag(folder, name)["tiles"] if tile["first_bin"] > 0]
    image = pixels(folder / tiles[0]["file"])
    # The median of Rayleigh speckle is the level of the middle grey.
    assert image.dtype == np.uint16
    assert np.median(image) == pytest.approx(0.5 * 65535, rel=0.03)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"scenes": "0"}, "set.toml: scenes: 0 is out of bounds; give a value of at least 1"),
        ({"negatives": "2.0"}, "set.toml: negatives: 2.0 is out of bounds; give a value of at most 1"),
        ({"base": '"no-such"'}, "no such file; give a TOML file or one of"),
        ({"storage": '"tape"'}, "storage.kind: 'tape' is not a known kind; choose one of files, webdataset, zarr"),
        ({"storage": '"zarr"'}, "scenes: 8 is not a multiple of storage.scenes 16, which are stored together; give 16"),
        ({"numbered": '["drum"]'}, "numbered: lacks the class 'rock'; add it, or leave numbered out"),
        ({"annotations": '["xml"]'}, "annotations.0.kind: 'xml' is not a known kind; choose one of coco, yolo, voc, "),
        ({"splits": '{ train = -1.0 }'}, "splits.train: -1.0 is out of bounds"),
        ({"splits": "{ Jobs = 1.0 }"}, "a split may not be named 'jobs', the folder of finished jobs; rename it"),
        ({"splits": '{ "../../evil" = 1.0 }'}, "'../../evil' is not a name; use letters, digits, - and _"),
        ({"colour": "1"}, "set.toml: colour: unknown key; remove it, or use one of title"),
        ({"of": '["drumm"]'}, "of: 'drumm' is not in the library of targets; choose from anchor, bomb,"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_specification_is_told_in_a_sentence(tmp_path, capsys, changes, told):
    assert told in refused(capsys, "dataset", str(write_set(tmp_path, **changes)), "-o", str(tmp_path / "set"))
    assert not (tmp_path / "set").exists()


def test_scenes_that_cannot_be_are_told_and_the_others_made(tmp_path, capsys):
    path = write_set(tmp_path, SET.replace("low = 5.0, high = 7.0", "low = 20.0, high = 40.0"))
    assert run_here("dataset", str(path), "-o", str(tmp_path / "set")) == 2
    complaint = capsys.readouterr().err
    assert "7 of 8 jobs failed, the others are finished; job 1: scene 1: targets: no ground range" in complaint
    assert {line["scene"] for line in metadata(tmp_path / "set")} == {0}


def test_files_are_found_beside_the_specification_and_count_by_their_content(tmp_path):
    meshes, own = bundled_meshes(), tmp_path / "own.ply"
    own.write_bytes(meshes["drum"].read_bytes())
    (tmp_path / "own.toml").write_text(scene_to_toml(BASE))
    mesh = '{ kind = "mesh", path = "own.ply" }'
    text = SET.replace('base = "default"', 'base = "own.toml"').replace('"rock-round"', mesh)
    one = read_specification(str(write_set(tmp_path, text)), DatasetSpecification, "datasets")
    base = load_scene(one.base)
    assert base == BASE
    shapes = {getattr(target, "path", "") for n in range(20) for target in draw_scene(one, base, n).scene.targets}
    assert str(own) in shapes
    digest = DatasetWork(one, base, tmp_path / "set").digest
    own.write_bytes(meshes["tyre"].read_bytes())
    assert DatasetWork(one, base, tmp_path / "set").digest != digest
    own.write_bytes(meshes["drum"].read_bytes())
    more = one.model_copy(update={"scenes": 16})
    assert DatasetWork(more, base, tmp_path / "set").digest == digest


@pytest.mark.parametrize("name", list(bundled_specifications("datasets")))
def test_a_bundled_specification_makes_its_first_scenes(name):
    one = read_specification(name, DatasetSpecification, "datasets")
    base = load_scene(one.base)
    for number in range(12):
        drawn = draw_scene(one, base, number)
        assert scene_from_toml(scene_to_toml(drawn.scene)) == drawn.scene


SHARES = (np.arange(10_000) + 0.5) / 10_000
NORMAL = {"draw": "normal", "mean": 1.0, "deviation": 2.0}


def distribution(**fields):
    return TypeAdapter(Drawn).validate_python(fields)


def quantiles(**fields):
    made = distribution(**fields)
    return [made.quantile(share) for share in SHARES]


@pytest.mark.parametrize(
    ("fields", "known"),
    [
        ({"draw": "uniform", "low": 2.0, "high": 5.0}, stats.uniform(2.0, 3.0)),
        ({"draw": "log_uniform", "low": 0.1, "high": 10.0}, stats.loguniform(0.1, 10.0)),
        (NORMAL, stats.norm(1.0, 2.0)),
        (NORMAL | {"low": 0.0, "high": 2.0}, stats.truncnorm(-0.5, 0.5, loc=1.0, scale=2.0)),
    ],
)
def test_quantiles_are_those_of_scipy(fields, known):
    np.testing.assert_allclose(quantiles(**fields), known.ppf(SHARES), rtol=1e-9, atol=1e-9)


def test_integers_are_equally_often_choices_keep_to_their_weights_and_a_table_without_draw_is_a_value():
    assert Counter(quantiles(draw="integers", low=-1, high=3)) == dict.fromkeys(range(-1, 4), 2000)
    drawn = quantiles(draw="choice", of=["a", "b", {"kind": "flat"}], weights=[1, 0, 3])
    assert (drawn.count("a"), drawn.count({"kind": "flat"})) == (2500, 7500)
    assert distribution(kind="uniform", sound_speed=1500.0) == {"kind": "uniform", "sound_speed": 1500.0}


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"draw": "beta"}, "draw: 'beta' is not a known distribution; choose one of uniform, log_uniform,"),
        ({"draw": "uniform", "low": 2.0}, "high: is missing; add it"),
        ({"draw": "uniform", "low": 2.0, "high": 1.0}, "low 2 is above high 1; swap them"),
        ({"draw": "log_uniform", "low": 0.0, "high": 1.0}, "low: 0.0 is out of bounds; give a value above 0"),
        ({"draw": "normal", "mean": 0.0, "deviation": 1.0, "low": 50.0}, "almost no value of mean"),
        ({"draw": "choice", "of": [1, 2], "weights": [1.0]}, "weights: there are 1 for 2 values; give one for each"),
        ({"draw": "integers", "low": 1, "high": 0.5}, "high: 0.5 is not a whole number"),
    ],
)
def test_a_mistake_is_told_in_a_sentence(fields, told):
    with pytest.raises(ValidationError, match=told.replace("(", "\\(")):
        distribution(**fields)


def test_one_new_class_adds_a_distribution():
    class Triangular(DistributionKind):
        kind: Literal["triangular"] = "triangular"

        def quantile(self, share: float) -> float:
            return math.sqrt(share)

    with forgetting(DISTRIBUTIONS):
        assert distribution(draw="triangular").quantile(0.25) == 0.5


def test_draws_are_independent_of_one_another_even_and_recorded():
    shares = np.array([[hash_share(7, number, path) for number in range(4000)] for path in ("a", "b")])
    assert stats.kstest(shares[0], "uniform").pvalue > 0.01
    assert abs(np.corrcoef(shares)[0, 1]) < 0.05
    assert hash_share(7, 0, "a") == shares[0, 0] != hash_share(8, 0, "a")
    draws = Draws(1, 0)
    value = draws.value("sonar.range", distribution(draw="uniform", low=10.0, high=20.0))
    assert draws.value("seed", 5) == 5
    assert draws.drawn == {"sonar.range": value}
