"""Small XTF files for tests, written with pyxtf's structures."""

import ctypes
from pathlib import Path

import numpy as np
import pyxtf
import xarray as xr

PORT, STARBOARD, SUBBOTTOM = 1, 2, 0
FORMATS = {"u1": 8, "<u2": 3, "<u4": 2, "<f4": 5}
FAR_TO_NEAR, NEAR_TO_FAR = [4, 3, 2, 1], [10, 20, 30, 40]
PING = {"samples": [FAR_TO_NEAR, NEAR_TO_FAR]}


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
