"""Logs of fishfinders: small ones after the public descriptions of their formats, read through PINGVerter."""

import struct
import sys
from pathlib import Path

import numpy as np
import pytest

from commands import refused
from insonify.errors import FileWarning
from insonify.io.records import read_record
from xtf_files import amplitudes

PINGS, BINS, START = 6, 40, 1_700_000_000
ECHOES = np.random.default_rng(3).integers(1, 200, (2, PINGS, BINS))
LONGITUDE, LATITUDE = 7.5 + 5e-6 * np.arange(PINGS), 54.0
FEET = 3.2808399


def lowrance(folder: Path, suffix: str, both: bool) -> Path:
    """Frames of 144 or 168 bytes before their samples; port is stored from far to near."""
    radius = 6356752.3142
    place = [round(radius * value) for value in (0.0, np.log(np.tan(np.pi / 4 + np.radians(LATITUDE) / 2)))]
    content = struct.pack("<HHHBB", 2 if suffix == ".sl2" else 3, 0, BINS * 2, 0, 0)
    for ping in range(PINGS):
        place[0] = round(radius * np.radians(LONGITUDE[ping]))
        port, starboard = (row.astype(np.uint8).tobytes() for row in ECHOES[:, ping])
        for kind, samples in ((5, port[::-1] + starboard),) if both else ((3, port[::-1]), (4, starboard)):
            size = 144 if suffix == ".sl2" else 168
            header = bytearray(size)
            where = struct.pack("<ffii4f", 0.0, 15.0, *place, 1.0, np.pi / 2.0, 0.0, 0.0)
            count, whole, now = len(samples), size + len(samples), 250 * ping
            fields = {
                ".sl2": ((0, "I", len(content)), (28, "H", whole), (32, "H", kind), (34, "H", count),
                         (44, "f", 20.0 * FEET), (60, "I", START), (64, "f", 5.0 * FEET), (140, "I", now)),
                ".sl3": ((0, "I", len(content)), (8, "H", whole), (12, "H", kind), (44, "I", count),
                         (24, "f", 20.0 * FEET), (40, "I", START), (48, "f", 5.0 * FEET), (124, "I", now)),
            }[suffix]  # fmt: skip
            for offset, code, value in fields:
                struct.pack_into(f"<{code}", header, offset, value)
            begin = 100 if suffix == ".sl2" else 84
            header[begin : begin + len(where)] = where
            content += bytes(header) + samples
    path = folder / f"log{suffix}"
    path.write_bytes(content)
    return path


def varint(value: int) -> bytes:
    return bytes([value]) if value < 128 else bytes([value & 127 | 128]) + varint(value >> 7)


def structure(*fields: tuple[int, bytes]) -> bytes:
    """Number of fields, then key (number and length) and value of each."""
    content = bytes([len(fields)])
    for number, value in fields:
        content += bytes([number << 3 | min(len(value), 7)]) + (varint(len(value)) if len(value) > 6 else b"") + value
    return content


def garmin(folder: Path) -> Path:
    """Records of two channels from byte 20480 on, samples of 16 bits at their ends."""
    told = structure((0, bytes(2)), (1, bytes(4)), (2, bytes(2)), (3, struct.pack("<I", START)))
    head = structure((0, struct.pack("<I", 3085556358)), (1, b"\1\0"), (2, struct.pack("<I", 2)), (3, b"\2"))
    content = (bytes([6]) + head[1:] + b"\x2f" + varint(len(told)) + told + b"\x37\1\0").ljust(20480, b"\0")
    for ping in range(PINGS):
        for side in (0, 1):
            samples = ECHOES[side, ping].astype("<u2").tobytes()
            degrees = [round(value * 2**32 / 360) for value in (LATITUDE, LONGITUDE[ping])]
            body = structure(
                (0, bytes([side])), (1, varint(2 * 5000)), (3, b"\0"), (4, varint(2 * 20_000)),
                (7, struct.pack("<I", BINS)), *((9 + k, struct.pack("<i", each)) for k, each in enumerate(degrees)),
                (12, bytes([2 + side])),
            ) + samples  # fmt: skip
            state = structure((0, b"\2"), (1, bytes([1, 1, side])))
            numbers = struct.pack("<I", ping), bytes(4), struct.pack("<H", len(body)), struct.pack("<I", 250 * ping)
            parts = enumerate((struct.pack("<I", 3085556358), state, *numbers))
            content += structure(*parts) + bytes(4) + body + bytes(12)
    path = folder / "log.RSD"
    path.write_bytes(content)
    return path


def humminbird(folder: Path) -> Path:
    """A description, and a folder with a file for each side, whose headers have 67 bytes."""
    radius = 6378388.0
    east = np.radians(LONGITUDE) * radius
    north = radius * np.log(np.tan(np.pi / 4 + np.arctan(np.tan(np.radians(LATITUDE)) / 1.0067642927) / 2))
    description = bytearray(64)
    struct.pack_into(">i", description, 20, START)
    (folder / "R00001.DAT").write_bytes(description)
    (folder / "R00001").mkdir()
    for side in (0, 1):
        content = b""
        for ping, samples in enumerate(ECHOES[side]):
            values = (
                0xC0DEAB21, 128, 2 * ping + side, 129, 250 * ping, 130, round(east[ping]), 131, round(north), 132, 1,
                900, 133, 1, 15, 135, 50, 80, 2 + side, 81, 0, 146, 455_000, 83, 0, 84, 0, 149, 0, 86, 0, 87, 0, 160,
                BINS, 33,
            )  # fmt: skip
            content += struct.pack(">IBIBIBiBiBHHBHHBIBBBBBIBBBBBIBBBBBIB", *values)
            content += samples.astype(np.uint8).tobytes()
        (folder / "R00001" / f"B00{2 + side}.SON").write_bytes(content)
    return folder / "R00001.DAT"


LOGS = {
    "sl2": lambda folder: lowrance(folder, ".sl2", True),
    "sl2 in two": lambda folder: lowrance(folder, ".sl2", False),
    "sl3": lambda folder: lowrance(folder, ".sl3", True),
    "rsd": garmin,
    "dat": humminbird,
    "son": lambda folder: humminbird(folder).with_suffix("") / "B003.SON",
}


@pytest.mark.parametrize("name", LOGS)
def test_a_log_is_read_with_its_echoes_near_to_far_and_its_way(tmp_path, name):
    pytest.importorskip("pingverter")
    record = read_record(LOGS[name](tmp_path))
    np.testing.assert_array_equal(amplitudes(record), ECHOES)
    np.testing.assert_allclose(record.ping_time, 0.25 * np.arange(PINGS), atol=1e-9)
    np.testing.assert_allclose(record.platform_altitude, 5.0, rtol=1e-6)
    np.testing.assert_allclose(record.platform_heading, 0.0, atol=0.5)
    if name not in ("dat", "son"):  # whose range follows from the sonar's resolution
        np.testing.assert_allclose(record.slant_range[-1] + record.slant_range[0], 20.0, rtol=1e-5)
    step = 5e-6 * 111_320.0 * np.cos(np.radians(LATITUDE))
    np.testing.assert_allclose(record.platform_x, step * np.arange(PINGS), atol=2.0 if name == "rsd" else 1.1)
    assert record.attrs["time_coverage_start"].startswith("2023-11-14" if name != "rsd" else "2043-11-13")
    place = dict(word.split("=") for word in record.attrs["crs"].split())
    np.testing.assert_allclose([float(place[name]) for name in ("+lat_0", "+lon_0")], [54.0, 7.5], atol=1e-5)


@pytest.mark.parametrize("name", ["sl2", "rsd", "dat"])
def test_a_broken_log_is_one_sentence(tmp_path, capsys, name):
    pytest.importorskip("pingverter")
    path = LOGS[name](tmp_path)
    (path if name != "dat" else path.with_suffix("") / "B002.SON").write_bytes(bytes(range(256)))
    error = refused(capsys, "render", str(path), "-o", str(tmp_path / "a.png"))
    assert f"{path.name}: " in error
    lone = tmp_path / "R7" / "B002.SON"
    lone.parent.mkdir()
    lone.write_bytes(b"1")
    assert "lacks R7.DAT beside its folder; copy the whole log" in refused(capsys, "render", str(lone), "-o", "a.png")


def test_a_cut_log_keeps_its_whole_pings_and_warns(tmp_path):
    pytest.importorskip("pingverter")
    path = LOGS["sl2"](tmp_path)
    path.write_bytes(path.read_bytes()[:-10])
    with pytest.warns(FileWarning, match="ends within the packet at byte .*; the whole pings before are read"):
        record = read_record(path)
    assert record.sizes["ping_time"] == PINGS - 1
    np.testing.assert_array_equal(amplitudes(record), ECHOES[:, :-1])


def test_without_the_library_the_extra_is_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "pingverter", None)
    for name in ("a.sl2", "b.SL3", "c.rsd", "d.dat", "e.son"):
        (tmp_path / name).write_bytes(b"1")
        error = refused(capsys, "render", str(tmp_path / name), "-o", str(tmp_path / "a.png"))
        assert f'{name}: is a log of a fishfinder; install its reader: pip install "insonify[fishfinder]"' in error
