"""Data sets in an object store: the same objects as files on a disk, resumed alike, and errors of one sentence."""

import hashlib

import numpy as np
import pytest
import s3fs
from moto.server import ThreadedMotoServer

from commands import refused
from insonify import cli
from insonify.io.object_store import folder_at
from insonify.surveys.storages import Tile, WebDataset, ZarrStore
from small_sets import contents, run_here, write_set


# Connections are kept as long as the process: a second server, at another address, would not be found.
@pytest.fixture(scope="session")
def store():
    """A server of this machine that answers as S3 does, with an empty bucket."""
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    with pytest.MonkeyPatch.context() as patch:
        named = {"ACCESS_KEY_ID": "nobody", "SECRET_ACCESS_KEY": "secret", "DEFAULT_REGION": "us-east-1"}
        for name, value in (named | {"ENDPOINT_URL": f"http://{host}:{port}"}).items():
            patch.setenv(f"AWS_{name}", value)
        files = s3fs.S3FileSystem(use_listings_cache=False)
        files.mkdir("sets")
        yield files
    server.stop()


def objects(store, prefix):
    return {path.removeprefix(f"{prefix}/"): hashlib.sha256(store.cat(path)).hexdigest() for path in store.find(prefix)}


def test_a_set_in_a_store_has_the_bytes_of_one_on_a_disk(store, tmp_path):
    path = write_set(tmp_path, scenes="2")
    command = ["dataset", str(path), "--scheduler", "local:1", "-o"]
    assert run_here(*command, str(tmp_path / "set")) == 0
    assert cli.main([*command, "s3://sets/small"]) == 0
    made = contents(tmp_path / "set")
    assert objects(store, "sets/small") == made
    # A job whose flag is lost is done again.
    store.rm(f"sets/small/{next(key for key in made if key.startswith('jobs/0'))}")
    store.rm("sets/small/contact-sheet.png")
    assert run_here(*command, "s3://sets/small") == 0
    assert objects(store, "sets/small") == made


@pytest.mark.parametrize("storage", [WebDataset(), ZarrStore()], ids=lambda storage: storage.kind)
def test_images_of_unlike_shapes_are_read_back_from_archives_and_stores(storage, store, tmp_path):
    images = [np.arange(108, dtype=np.uint8).reshape(shape) for shape in ((12, 9), (9, 12), (6, 18))]
    tiles = [Tile(each, each, {"name": f"t{number}", "split": "train"}) for number, each in enumerate(images)]
    storage.write(tmp_path, "0000000", "0000", tiles)
    store.put(f"{tmp_path}/train", f"sets/{storage.kind}/train", recursive=True)
    folder = folder_at(f"s3://sets/{storage.kind}")
    for tile, image in zip(tiles, images):
        np.testing.assert_array_equal(storage.read_image(folder, tile.description["file"]), image)


def test_what_a_store_cannot_do_is_one_sentence(store, tmp_path, capsys):
    path = str(write_set(tmp_path, scenes="1"))
    assert "a disk; give a folder" in refused(capsys, "survey", "harbour", "-o", "s3://sets/survey")
    assert "check address and credentials" in refused(capsys, "dataset", path, "-o", "nowhere://sets/one")
    store.pipe("sets/other/readme.txt", b"taken")
    assert "contains other files" in refused(capsys, "dataset", path, "-o", "s3://sets/other")
