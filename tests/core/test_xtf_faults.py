"""Recordings in XTF that are damaged, cut or of a kind that is not read."""

import ctypes
from pathlib import Path

import numpy as np
import pytest
import pyxtf

from commands import refused
from insonify.cli import main
from insonify.errors import FileWarning
from insonify.io.records import read_record
from insonify.scene import SceneError
from xtf_files import PING, SUBBOTTOM, amplitudes, write_xtf


def mutilated(path: Path, fault: str) -> Path:
    content = path.read_bytes()
    size = (len(content) - 1024) // 2
    pings = {
        "empty": b"",
        "text": b"title = 'a scene'\n" * 100,
        "header alone": content[:1024],
        "first cut": content[: 1024 + size - 100],
        "cut": content[:-100],
        "cut in a start": content[:-size] + content[-size:][:9],
        "no length": content[:1034] + bytes(4) + content[1038:],
        "noise": content[:1024] + b"\x5a" * 2000,
        "too few channels": content[:1028] + b"\x09" + content[1029:],
    }
    path.write_bytes(pings[fault])
    return path


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        ("empty", "has 0 bytes, less than the header of an XTF file; copy it again"),
        ("text", "is not an XTF file"),
        ("header alone", "holds no side-scan pings; give a recording with port or starboard channels"),
        ("first cut", "ends within the packet at byte 1024, before one ping is whole; copy it again"),
        ("no length", "holds no XTF packet at byte 1024"),
        ("noise", "holds no XTF packet at byte 1024"),
        ("too few channels", "declares more channels than ping 0 has"),
    ],
)
def test_a_broken_file_is_one_sentence(tmp_path, capsys, fault, expected):
    path = mutilated(write_xtf(tmp_path / "a.xtf", [PING, PING]), fault)
    assert expected in refused(capsys, "render", str(path), "-o", str(tmp_path / "a.png"))
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("fault", ["cut", "cut in a start"])
def test_a_cut_file_keeps_its_whole_pings_and_warns(tmp_path, capsys, fault):
    path = mutilated(write_xtf(tmp_path / "a.xtf", [PING, PING, PING]), fault)
    assert main(["render", str(path), "-o", str(tmp_path / "a.npz")]) == 0
    written = capsys.readouterr()
    whole = 1 if fault == "cut in a start" else 2
    assert f"{whole} pings of 2 x 4 bins" in written.out
    assert written.err.count("\n") == 1
    assert "a.xtf: ends within the packet at byte" in written.err
    assert "the whole pings before are read" in written.err
    with pytest.warns(FileWarning, match="ends within the packet"):
        record = read_record(path)
    np.testing.assert_allclose(amplitudes(record)[:, 0], [[1, 2, 3, 4], [10, 20, 30, 40]])


def test_what_cannot_be_understood_is_refused(tmp_path):
    path = write_xtf(tmp_path / "a.xtf", [PING], channels=(SUBBOTTOM, SUBBOTTOM))
    with pytest.raises(SceneError, match="holds no side-scan pings"):
        read_record(path)
    for field, value, fault in (
        (pyxtf.XTFChanInfo.SampleFormat, 1, "samples of format 1 and 2 bytes, which is not read here"),
        (pyxtf.XTFChanInfo.CorrectionFlags, 2, "is corrected to ground range; export it in slant range"),
    ):
        content = bytearray(write_xtf(path, [PING]).read_bytes())
        for number in (0, 1):
            content[256 + 128 * number + field.offset] = value
        path.write_bytes(content)
        with pytest.raises(SceneError, match=fault):
            read_record(path)
    with pytest.raises(SceneError, match="that are not echoes"):
        read_record(write_xtf(path, [{"samples": [[np.nan], [1.0]]}], kind="<f4"))
    wild = [PING, PING, {**PING, "reaches": [3e4, 3e4]}]
    with pytest.raises(SceneError, match="has slant ranges up to 3e"):
        read_record(write_xtf(path, wild))
    with pytest.raises(SceneError, match="less than the 4 samples it announces"):
        read_record(write_xtf(path, [PING], kind="<u4").write_bytes(doubled(path)) and path)


def doubled(path: Path) -> bytes:
    """Shorten the only packet below its samples."""
    content = bytearray(path.read_bytes())
    size = 1024 + ctypes.sizeof(pyxtf.XTFPingHeader) + ctypes.sizeof(pyxtf.XTFPingChanHeader) + 8
    content[1024 + 10 : 1024 + 14] = (size - 1024).to_bytes(4, "little")
    return bytes(content[:size])
