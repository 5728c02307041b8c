"""Files of unknown origin: what is opened, what is refused before it is opened, and how much may be expanded."""

import io
import json
import os
import stat
import warnings
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from commands import output_of
from insonify.errors import FileWarning
from insonify.io import file_access
from insonify.io.bathymetry import read_grid
from insonify.io.file_access import FileFault, guarded
from insonify.io.meshes import read_mesh
from insonify.io.navigation import read_navigation
from insonify.io.records import read_record
from insonify.io.sound_speed_casts import read_cast
from insonify.scene import SceneError, load_scene
from insonify.scene.seabed.autocorrelations import read_autocorrelation
from insonify.scene.seabed.materials.pictures import read_picture
from insonify.simulation import simulate

FILES = {
    load_scene: ["scene.toml"],
    read_grid: ["bed.npy", "bed.npz", "bed.tif", "bed.bag", "bed.asc"],
    read_navigation: ["tow.csv", "tow.nc", "tow.gpx", "tow.xtf"],
    read_cast: ["cast.cnv", "cast.aml", "cast.svp", "cast.csv"],
    read_mesh: ["body.obj", "body.gltf"],
    read_record: ["record.nc", "record.npz", "record.xtf", "record.jsf"],
    lambda path: read_picture(path, 2): ["map.png"],
    read_autocorrelation: ["lags.csv"],
}
READERS = {name: read for read, names in FILES.items() for name in names}


@pytest.mark.parametrize("name", READERS)
def test_a_pipe_a_device_and_a_folder_are_refused_at_once(tmp_path, name):
    device = r"is a device or a pipe, not a file"
    for number, (make, fault) in enumerate((
        (os.mkfifo, device), (lambda path: path.symlink_to("/dev/zero"), device),
        (os.mkdir, r"cannot be read \(Is a directory\)"),
    )):  # fmt: skip
        path = tmp_path / str(number) / name
        path.parent.mkdir()
        make(path)
        with pytest.raises(SceneError, match=rf"{name}.* {fault}; give"):
            READERS[name](str(path))


NAMING = {
    "seabed.relief.path": '[seabed]\nspacing = 1.0\nrelief = {{ kind = "dem", path = "{}.tif" }}',
    "seabed.material.path": (
        '[seabed]\nmaterial = {{ kind = "image", path = "{}.png", of = ["silt", "rock"], width = 9.0 }}'
    ),
    "targets.0.path": '[[targets]]\nkind = "mesh"\nposition = [1.0, 5.0]\npath = "{}.obj"',
}


@pytest.mark.parametrize("field", NAMING)
def test_a_name_too_long_is_refused_by_the_field_that_holds_it(tmp_path, field):
    scene = tmp_path / "scene.toml"
    scene.write_text(NAMING[field].format("x" * 300))
    with pytest.raises(SceneError, match=rf"{field}: .*File name too long"):
        simulate(load_scene(scene))


def test_a_file_that_becomes_a_pipe_and_a_pipe_beside_a_raster_or_within_a_store_are_refused(tmp_path, monkeypatch):
    (tmp_path / "record.zarr").mkdir()
    os.mkfifo(tmp_path / "record.zarr" / "zarr.json")
    with pytest.raises(SceneError, match=r"contains 'zarr\.json', which is not a regular file; remove that"):
        read_record(tmp_path / "record.zarr")
    (tmp_path / "bed.tif").write_bytes(b"II*\0")
    for companion in ("bed.tif.msk", "bed.tif.ovr", "bed.tif.aux.xml", "bed.tfw"):
        os.mkfifo(tmp_path / companion)
        with pytest.raises(SceneError, match="beside it, which is not a regular file; remove that"):
            read_grid(str(tmp_path / "bed.tif"))
        (tmp_path / companion).rename(tmp_path / "pipe")
    monkeypatch.setattr(file_access, "check_regular", lambda path: None)
    with pytest.raises(FileFault, match="pipe"):
        file_access.open_regular(tmp_path / "pipe")


def test_rasters_and_pictures_in_other_formats_are_refused_under_an_allowed_suffix(tmp_path):
    band = '<VRTRasterBand dataType="Float32" band="1" subClass="VRTDerivedRasterBand"/>'
    for name in ("bed.tif", "bed.bag", "bed.asc"):
        (tmp_path / name).write_text(f'<VRTDataset rasterXSize="4" rasterYSize="4">{band}</VRTDataset>')
        with pytest.raises(SceneError, match="cannot be read"):
            read_grid(str(tmp_path / name))
    for kind in ("EPS", "PDF", "GIF", "BMP", "PPM"):
        Image.new("RGB", (4, 4)).save(tmp_path / "map.png", format=kind)
        with pytest.raises(SceneError, match=r"map\.png' is not a picture in PNG or TIFF; save it as one"):
            read_picture(str(tmp_path / "map.png"), 2)


def test_no_driver_of_gdal_is_left_that_asks_a_server_or_runs_code():
    lines = (
        "import os, rasterio; from insonify.io.isolation import SETTINGS; os.environ.update(SETTINGS)\n"
        "with rasterio.Env() as environment: print(*environment.drivers())"
    )
    left = set(output_of("-c", lines))
    assert {"GTiff", "BAG", "AAIGrid"} <= left
    assert not left & {"VRT", "WMS", "WCS", "WMTS", "HTTP", "OGCAPI", "STACTA", "STACIT", "GTI", "netCDF", "Zarr"}


def archive(path: Path, name: str, member: bytes, kind: int = zipfile.ZIP_DEFLATED) -> Path:
    with zipfile.ZipFile(path, "w", kind) as made:
        made.writestr(name, member)
    return path


def npy(array: np.ndarray, shape: tuple[int, ...] | None = None) -> bytes:
    """Bytes of an array, of which the header may announce another shape."""
    made = io.BytesIO()
    header = {"descr": array.dtype.str, "fortran_order": False, "shape": shape or array.shape}
    np.lib.format.write_array_header_1_0(made, header)
    return made.getvalue() + array.tobytes()


GRID = np.full((3, 4), -20.0)
WRONG_ARRAYS = {
    "more announced than there is": (npy(GRID, (3, 5)), "it announces .3, 5. values and holds 96 bytes"),
    "less announced than there is": (npy(GRID, (3, 3)), "it announces .3, 3. values and holds 96 bytes"),
    "a negative side": (npy(GRID, (-3, -4)), "it announces .-3, -4. values"),
    "an enormous array": (npy(GRID, (10**6, 10**6)), "it announces .1000000, 1000000. values"),
    "objects": (npy(GRID).replace(b"'<f8'", b"'|O' "), "it holds object values"),
    "records": (npy(GRID).replace(b"'<f8'", b"'|V8'"), "it holds .*V8.* values"),
    "a header without end": (b"\x93NUMPY\x01\x00\x10\x00" + b"(" * 16, "its header is damaged"),
    "another version": (b"\x93NUMPY\x09\x00\x10\x00" + b" " * 16, "it is of version 9.0, not a plain array"),
}


@pytest.mark.parametrize("suffix", [".npy", ".npz"])
@pytest.mark.parametrize("fault", WRONG_ARRAYS)
def test_an_array_must_be_what_its_header_announces(tmp_path, suffix, fault):
    content, words = WRONG_ARRAYS[fault]
    path = tmp_path / f"bed{suffix}"
    path.write_bytes(content) if suffix == ".npy" else archive(path, "z.npy", content)
    with pytest.raises(SceneError, match=rf"bed{suffix}' cannot be read .*{words}.*; save it with numpy\.save"):
        read_grid(str(path))


def test_an_archive_that_is_encrypted_or_expands_without_bound_is_refused_before_it_is_expanded(tmp_path):
    path = archive(tmp_path / "bed.npz", "z.npy", npy(GRID))
    content = bytearray(path.read_bytes())
    content[content.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(content)
    with pytest.raises(SceneError, match=r"holds 'z' encrypted or packed in an unusual way; save it with numpy\.savez"):
        read_grid(str(path))
    archive(path, "z.npy", npy(np.zeros((5800, 5800))))
    assert path.stat().st_size < 10**6
    with pytest.raises(SceneError, match=r"announces 0\.269 GB, 64 times more than it stores; save it without"):
        read_grid(str(path))


@pytest.mark.parametrize("name", ["record.xtf", "record.jsf", "record.nc", "bed.npy"])
def test_a_sparse_file_counts_by_what_is_stored_of_it_and_is_refused_before_it_is_read(tmp_path, name):
    content = npy(np.zeros((0,)), (10_000, 10_000)) if name == "bed.npy" else b"\x7b" * 4096
    (tmp_path / name).write_bytes(content)
    os.truncate(tmp_path / name, len(content) + 8 * 10**8)
    with pytest.raises(SceneError, match=r"announces 0\.8 GB, 64 times more than it stores"):
        READERS[name](str(tmp_path / name))


def test_a_text_of_more_than_its_limit_and_a_record_of_more_pings_than_are_stored_are_refused(tmp_path):
    (tmp_path / "scene.toml").write_bytes(b"#" * (2**22 + 1))
    with pytest.raises(SceneError, match="is a text of more than 4 MB; thin it"):
        load_scene(tmp_path / "scene.toml")
    import netCDF4

    with netCDF4.Dataset(tmp_path / "record.nc", "w") as file:
        file.createDimension("ping_time", 10**10)
        file.createVariable("platform_x", "f8", ("ping_time",), chunksizes=(1000,))
        file.createVariable("time", "f8", ("ping_time",), chunksizes=(1000,))
    for read in (read_record, read_navigation):
        with pytest.raises(SceneError, match=r"announces .* GB, 64 times more than it stores; save it without"):
            read(str(tmp_path / "record.nc"))


def gltf(folder: Path, place: str, uri: str) -> str:
    """Write a box of which the buffer lies in one place and is looked for in another."""
    folder.mkdir()
    files = trimesh.Scene(trimesh.creation.box()).export(file_type="gltf", merge_buffers=True)
    document = json.loads(files.pop("model.gltf"))
    (buffer,) = files.values()
    document["buffers"][0]["uri"] = uri
    (folder / "model.gltf").write_text(json.dumps(document))
    (folder / place).parent.mkdir(exist_ok=True)
    (folder / place).write_bytes(buffer)
    return str(folder / "model.gltf")


BESIDE = "keep what it refers to beside it, under a relative path"


@pytest.mark.parametrize(
    ("place", "uri", "words"),
    [
        ("b.bin", "b.bin", None),
        ("data/b.bin", "data/b.bin", None),
        ("part one.bin", "part%20one.bin", None),
        ("../b.bin", "../b.bin", rf"refers to '\.\./b\.bin'; {BESIDE}"),
        ("../b.bin", "{folder}/b.bin", rf"refers to '/.*/b\.bin'; {BESIDE}"),
        ("../b.bin", "link.bin", rf"refers to 'link\.bin'; {BESIDE}"),
        ("../part one.bin", "%2e%2e/part%20one.bin", rf"refers to '\.\./part one\.bin'; {BESIDE}"),
        ("b.bin", "data/b.bin", r"refers to 'data/b\.bin', which does not exist; put it"),
        ("b.bin", "pipe.bin", r"refers to 'pipe\.bin', which is a device or a pipe, .*; put it beside"),
    ],
)
def test_what_a_mesh_refers_to_lies_beside_it_and_no_other_is_read_for_a_damaged_one(tmp_path, place, uri, words):
    path = gltf(tmp_path / "model", place, uri.format(folder=tmp_path))
    (tmp_path / "model" / "link.bin").symlink_to(tmp_path / "b.bin")
    os.mkfifo(tmp_path / "model" / "pipe.bin")
    if words is None:
        assert len(read_mesh(path)) == 12
        damaged = Path(path).with_name("body.gltf")
        damaged.write_text("{")
        path, words = str(damaged), r"body\.gltf' is not a glTF document \(it is not JSON\); export it again"
    with pytest.raises(SceneError, match=words):
        read_mesh(path)


def refusal(fault: str, remedy: str) -> SceneError:
    return SceneError(f"it {fault}; {remedy}")


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (MemoryError(), "it cannot be read (it does not fit in memory); mend it"),
        (RecursionError("too deep\nby far"), "it cannot be read (too deep by far); mend it"),
        (KeyError("name"), "it cannot be read ('name'); mend it"),
        (AssertionError(), "it cannot be read (AssertionError); mend it"),
        (PermissionError(13, "Permission denied"), "it cannot be read (Permission denied); mend it"),
        (FileFault("is odd", "even it"), "it is odd; even it"),
        (SceneError("as it was"), "as it was"),
    ],
)
def test_every_error_becomes_one_sentence(error, words):
    with pytest.raises(SceneError) as caught, guarded(refusal, "mend it"):
        raise error
    assert str(caught.value) == words


def test_threads_read_one_at_a_time_and_warnings_of_libraries_are_left_out_and_those_of_files_are_not():
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        with guarded(refusal, "mend it"):
            warnings.warn("of a library", stacklevel=1)
            warnings.warn(FileWarning("of a file"), stacklevel=1)
    assert [str(each.message) for each in told] == ["of a file"]
    inside, most = [0], [0]

    def read() -> None:
        for _ in range(200):
            with guarded(refusal, ""):
                inside[0] += 1
                most[0] = max(most[0], inside[0])
                inside[0] -= 1

    before = list(warnings.filters)
    with ThreadPoolExecutor(4) as threads:
        for reading in [threads.submit(read) for _ in range(4)]:
            reading.result()
    assert most == [1]
    assert warnings.filters == before


def test_what_is_read_stays_as_it_was(tmp_path):
    np.save(tmp_path / "bed.npy", GRID)
    (tmp_path / "bed.npy").chmod(stat.S_IRUSR)
    read_grid(str(tmp_path / "bed.npy"))
    assert [path.name for path in tmp_path.iterdir()] == ["bed.npy"]
