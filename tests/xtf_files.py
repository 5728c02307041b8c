"""Small XTF files for tests, written with pyxtf's structures."""

import ctypes
from pathlib import Path

import numpy as np
import pyxtf
import xarray as xr

from insonify.io.record_schema import coordinates, echo_variable, platform

PORT, STARBOARD, SUBBOTTOM = 1, 2, 0
FORMATS = {"u1": 8, "<u2": 3, "<u4": 2, "<f4": 5}
FAR_TO_NEAR, NEAR_TO_FAR = [4, 3, 2, 1], [10, 20, 30, 40]
PING = {"samples": [FAR_TO_NEAR, NEAR_TO_FAR]}
SPEED = 1480.0


def write_xtf(path: Path, pings: list[dict], *, channels=(PORT, STARBOARD), kind="<u2", told=True, **fields) -> Path:
    """Write pings, each ``{"samples": [array a channel, in stored order, or None], field: value, ...}``."""
    header = pyxtf.XTFFileHeader()
    header.NumberOfSonarChannels = len(channels)
    header.NavUnits = 3
    for number, channel in enumerate(channels):
        info = header.ChanInfo[number]
        info.TypeOfChannel = channel
        info.SubChannelNumber = number
        info.BytesPerSample = np.dtype(kind).itemsize
        info.SampleFormat = FORMATS[kind] if told else 0
        info.Frequency = 600.0
    for name, value in fields.items():
        setattr(header, name, value)
    path.write_bytes(bytes(header) + b"".join(packet(number, ping, kind) for number, ping in enumerate(pings)))
    return path


def packet(number: int, ping: dict, kind: str = "<u2") -> bytes:
    ping = dict(ping)
    samples, reaches = ping.pop("samples"), ping.pop("reaches", None)
    weight = ping.pop("Weight", 0)
    header = pyxtf.XTFPingHeader()
    header.NumChansToFollow = sum(values is not None for values in samples)
    header.PingNumber = number
    header.Second = number
    for name, value in ping.items():
        setattr(header, name, value)
    body = b""
    for channel, values in enumerate(samples):
        if values is None:
            continue
        head = pyxtf.XTFPingChanHeader()
        head.ChannelNumber = channel
        head.NumSamples = len(values)
        head.SlantRange = 30.0 if reaches is None else reaches[channel]
        head.TimeDuration = 0.04
        head.Weight = weight
        body += bytes(head) + np.asarray(values).astype(kind).tobytes()
    size = ctypes.sizeof(header) + len(body)
    header.NumBytesThisRecord = -(-size // 64) * 64
    return bytes(header) + body + bytes(header.NumBytesThisRecord - size)


def amplitudes(record: xr.Dataset) -> np.ndarray:
    """Amplitudes of a record, (2, pings, bins)."""
    assert record["intensity"].dims == ("channel", "ping_time", "range_sample")
    assert record["intensity"].dtype == np.float32
    return np.sqrt(record["intensity"].values)


def made_record(amplitude: np.ndarray, **attributes) -> xr.Dataset:
    """Record of amplitudes (pings, 2, bins) along a bend, 0.05 m bins, 4 pings a second."""
    pings, _, bins = amplitude.shape
    time = np.arange(pings) / 4.0
    columns = (
        3.0 + 2.0 * time, -7.0 + 0.5 * time**2, 20.0 + np.sin(time), 9.0 - 0.1 * time,
        30.0 * time - 170.0, 2.0 * np.cos(time), 5.0 * np.sin(time),
    )  # fmt: skip
    variables = echo_variable((amplitude.astype(np.float64) ** 2).astype(np.float32)) | platform(columns)
    slant_range = (np.arange(bins) + 0.5) * 0.05
    named = {"title": "bend", "frequency": 400e3, **attributes}
    return xr.Dataset(variables, coordinates(time, slant_range, SPEED), named)


def random_counts(bits: int, pings: int = 7, bins: int = 40) -> np.ndarray:
    # A float32 amplitude holds 24 bits, its square is stored as float32: 11 bits survive that exactly.
    counts = np.random.default_rng(4).integers(0, 2**bits, (pings, 2, bins)).astype(np.float64)
    counts[0, 0, 0] = 2**bits - 1
    return counts


def packets(path: Path) -> tuple[pyxtf.XTFFileHeader, list[pyxtf.XTFPingHeader]]:
    header, found = pyxtf.xtf_read(str(path))
    assert list(found) == [pyxtf.XTFHeaderType.sonar]
    return header, found[pyxtf.XTFHeaderType.sonar]
