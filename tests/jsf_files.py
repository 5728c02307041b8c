"""Small JSF files for tests, packed from the manufacturer's table of offsets."""

import struct
from pathlib import Path

import numpy as np

ALL_VALID = 0x7FFF


def message(kind: int, body: bytes, *, subsystem=20, channel=0, version=13) -> bytes:
    return struct.pack("<HBBHBBBBHi", 0x1601, version, 0, kind, 2, subsystem, channel, 0, 0, len(body)) + body


def trace(samples: np.ndarray, ping: int = 0, **fields) -> bytes:
    """Body of a message 80; a field is ``name=value`` of the table below."""
    samples = np.asarray(samples)
    values = {
        "time": 1_700_000_000 + ping, "ping": ping, "validity": ALL_VALID, "units": 2,
        "samples": samples.shape[0] & 0xFFFF, "more": (samples.shape[0] >> 16) << 8, "interval": 40_000,
        "start": 40_500, "end": 41_500, "speed": 1480.0,
        "milliseconds": (1_700_000_000 + ping) % 86_400 * 1000, **fields,
    }  # fmt: skip
    table = {
        "time": ("i", 0), "skipped": ("I", 4), "ping": ("I", 8), "more": ("H", 16), "fraction": ("H", 18),
        "validity": ("H", 30), "format": ("h", 34), "x": ("i", 80), "y": ("i", 84), "units": ("h", 88),
        "samples": ("H", 114), "interval": ("I", 116), "start": ("H", 126), "end": ("H", 128), "depth": ("i", 136),
        "altitude": ("i", 144), "speed": ("f", 148), "weight": ("h", 168), "heading": ("H", 172), "pitch": ("h", 174),
        "roll": ("h", 176), "milliseconds": ("I", 200),
    }  # fmt: skip
    header = bytearray(240)
    for name, value in values.items():
        code, offset = table[name]
        struct.pack_into(f"<{code}", header, offset, value)
    return bytes(header) + samples.astype("<i2").tobytes()


def write_jsf(path: Path, pings: list[dict], subsystems=(20,), **message_fields) -> Path:
    """Write pings, each ``{"samples": [port, starboard], field: value, ...}``, near to far, for each subsystem."""
    content = message(182, bytes(24))
    for number, ping in enumerate(pings):
        fields = {name: value for name, value in ping.items() if name != "samples"}
        for subsystem in subsystems:
            for channel, samples in enumerate(ping["samples"]):
                frequency = {} if subsystem == 20 else {"start": 22_000, "end": 24_464, "more": 0x11}  # 900 kHz
                body = trace(samples, **{"ping": number, **frequency, **fields})
                content += message(80, body, subsystem=subsystem, channel=channel, **message_fields)
        content += message(2020, bytes(44))
    path.write_bytes(content)
    return path
