"""Pings of a live tow as JSF, as lines of JSON, in a growing XTF file, and as messages of ROS 2 in MCAP."""

import base64
import json
import math
from collections.abc import Mapping
from datetime import UTC
from pathlib import Path
from typing import Any

import numpy as np

from insonify.errors import SceneError
from insonify.io.records import jsf_writer, xtf_writer
from insonify.io.records.survey_log import count_exponent
from insonify.live.nmea import describe_ping
from insonify.live.outputs import LivePing, Output, Reader

KIND = xtf_writer.SAMPLE_TYPES["16"]
HEADROOM = 3  # powers of 2 between the greatest amplitude of the first ping and that of the file, 18 dB
FILE_ROOM = 512  # pings that wait for a disk
FLOAT32 = 8  # a code of ``SonarImageData``
# The definitions of marine_acoustic_msgs, without their remarks and constants.
RAW_IMAGE = f"{'=' * 80}\n".join((
    "std_msgs/Header header\nmarine_acoustic_msgs/PingInfo ping_info\nfloat32 sample_rate\nuint32 samples_per_beam\n"
    "uint32 sample0\nfloat32[] tx_delays\nfloat32[] tx_angles\nfloat32[] rx_angles\n"
    "marine_acoustic_msgs/SonarImageData image\n",
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n",
    "MSG: marine_acoustic_msgs/PingInfo\nfloat32 frequency\nfloat32 sound_speed\nfloat32[] tx_beamwidths\n"
    "float32[] rx_beamwidths\n",
    "MSG: marine_acoustic_msgs/SonarImageData\nbool is_bigendian\nuint32 dtype\nuint32 beam_count\nuint8[] data\n",
))  # fmt: skip


def encode_jsf(live: LivePing) -> bytes:
    """Encode a ping as a topside sends it: attitude, sentences of NMEA 0183, and the samples of both sides."""
    header = live.header
    nmea = b"".join(jsf_writer.encode_nmea(header.time, sentence) for sentence in describe_ping(live))
    return jsf_writer.encode_attitude(header) + nmea + jsf_writer.encode_ping(header, live.amplitudes)


def as_json(live: LivePing) -> dict[str, Any]:
    """Ping as a table of JSON: intensities of each side are float32, little-endian, near to far, in base64."""
    header = live.header
    sides = (base64.b64encode(side.astype("<f4").tobytes()).decode("ascii") for side in live.intensity)
    pose = {name.removeprefix("platform_"): value for name, value in live.pose.items()}
    return {
        "ping": header.number, "fish": live.fish, "time": header.time.replace(tzinfo=UTC).isoformat(),
        "longitude": header.x, "latitude": header.y,
        **{name: value if math.isfinite(value) else None for name, value in pose.items()},
        "slant_range": header.slant_range, "duration": header.duration, "frequency": header.frequency,
        **dict(zip(("port", "starboard"), sides)),
    }  # fmt: skip


def encode_json(live: LivePing) -> bytes:
    """Encode a ping as a line of JSON."""
    return json.dumps(as_json(live)).encode("ascii") + b"\n"


def write_growing_xtf(path: Path, fish: int, attributes: Mapping[str, Any], *, patient: bool) -> Output:
    """Make an output to an XTF file that other programs may follow while it grows."""
    file = path.open("wb")
    unit: list[float] = []

    def send(live: LivePing) -> None:
        sides = live.amplitudes
        if not unit:  # amplitude of one count, by the first ping: the header comes before what is still unknown
            unit.append(math.ldexp(1.0, count_exponent(float(sides.max()), KIND.bits - HEADROOM)))
            file.write(xtf_writer.encode_header(attributes, KIND, unit[0]))
        clipped = np.minimum(sides, np.float32(unit[0] * (2**KIND.bits - 1)))
        file.write(xtf_writer.encode_ping(live.header, clipped, KIND, unit[0]))
        file.flush()

    return Output(str(path), fish, Reader(send, file.close, room=FILE_ROOM, patient=patient))


def write_mcap(path: Path, fish: int, *, patient: bool) -> Output:
    """Make an output to an MCAP file of messages ``marine_acoustic_msgs/RawSonarImage``, made without ROS."""
    try:
        # lazy: an extra that few tows need
        from mcap_ros2.writer import Writer
    except ImportError:
        raise SceneError(f"{path}: lacks the package mcap-ros2-support; run: pip install 'insonify[live]'") from None
    file = path.open("wb")
    writer = Writer(file)
    schema = writer.register_msgdef("marine_acoustic_msgs/msg/RawSonarImage", RAW_IMAGE)

    def send(live: LivePing) -> None:
        stamp = round(live.header.time.replace(tzinfo=UTC).timestamp() * 1e6) * 1000
        message = raw_sonar_image(live, stamp)
        writer.write_message(f"/sidescan_{fish}/raw", schema, message, stamp, stamp, live.header.number)

    def end() -> None:
        writer.finish()  # type: ignore[no-untyped-call]
        file.close()

    return Output(str(path), fish, Reader(send, end, room=FILE_ROOM, patient=patient))


def raw_sonar_image(live: LivePing, stamp: int) -> dict[str, Any]:
    """Fields of a ping as ``marine_acoustic_msgs/RawSonarImage``: two beams abeam, port first, and samples by range."""
    header, (beams, bins) = live.header, live.intensity.shape
    speed, pixels = 2.0 * header.slant_range / header.duration, live.amplitudes.T.astype("<f4").tobytes()
    return {
        "header": {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": f"sidescan_{live.fish}"},
        "ping_info": {"frequency": header.frequency, "sound_speed": speed, "tx_beamwidths": [], "rx_beamwidths": []},
        "sample_rate": bins / header.duration, "samples_per_beam": bins, "sample0": 0, "tx_delays": [0.0, 0.0],
        "tx_angles": [0.0, 0.0], "rx_angles": [-0.5 * math.pi, 0.5 * math.pi],
        "image": {"is_bigendian": False, "dtype": FLOAT32, "beam_count": beams, "data": pixels},
    }  # fmt: skip
