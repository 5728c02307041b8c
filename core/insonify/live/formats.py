"""Pings of a live tow as JSF, as lines of JSON, in a growing XTF file, and as messages of ROS 2 in MCAP."""

import base64
import json
import math
from collections.abc import Mapping
from datetime import UTC
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from insonify.errors import SceneError
from insonify.io.records import jsf_writer, xtf_writer
from insonify.io.records.survey_log import count_exponent
from insonify.live.nmea import describe_ping
from insonify.live.outputs import Output, Reader
from insonify.live.ping import LivePing

KIND = xtf_writer.SAMPLE_TYPES["16"]
HEADROOM = 3  # powers of 2 between the greatest amplitude of the first ping and that of the file, 18 dB
FILE_ROOM = 512  # pings that wait for a disk
FLOAT32 = 8  # a code of ``SonarImageData``
EXTRA = "pip install 'insonify[live]'"
HEADER = "builtin_interfaces/Time stamp\nstring frame_id\n"
MESSAGES = {  # the definitions of marine_acoustic_msgs, without their remarks
    "marine_acoustic_msgs/RawSonarImage": "std_msgs/Header header\nPingInfo ping_info\nfloat32 sample_rate\n"
    "uint32 samples_per_beam\nuint32 sample0\nfloat32[] tx_delays\nfloat32[] tx_angles\nfloat32[] rx_angles\n"
    "SonarImageData image\n",
    "std_msgs/Header": HEADER,
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "marine_acoustic_msgs/PingInfo": "float32 frequency\nfloat32 sound_speed\nfloat32[] tx_beamwidths\n"
    "float32[] rx_beamwidths\n",
    "marine_acoustic_msgs/SonarImageData": "uint8 DTYPE_UINT8=0\nuint8 DTYPE_INT8=1\nuint8 DTYPE_UINT16=2\n"
    "uint8 DTYPE_INT16=3\nuint8 DTYPE_UINT32=4\nuint8 DTYPE_INT32=5\nuint8 DTYPE_UINT64=6\nuint8 DTYPE_INT64=7\n"
    "uint8 DTYPE_FLOAT32=8\nuint8 DTYPE_FLOAT64=9\nbool is_bigendian\nuint32 dtype\nuint32 beam_count\nuint8[] data\n",
}
RULE = "=" * 80
RAW_IMAGE = "marine_acoustic_msgs/RawSonarImage"


def encode_jsf(live: LivePing) -> bytes:
    """Encode a ping as a topside sends it: attitude, sentences of NMEA 0183, and the samples of both sides."""
    header = live.header
    nmea = b"".join(jsf_writer.encode_nmea(header.time, sentence) for sentence in describe_ping(live))
    return jsf_writer.encode_attitude(header) + nmea + jsf_writer.encode_ping(header, live.amplitudes)


def as_json(live: LivePing) -> dict[str, Any]:
    """Ping as a table of JSON: intensities of each side are float32, little-endian, near to far, in base64."""
    header = live.header
    sides = (base64.b64encode(side.astype("<f4").tobytes()).decode("ascii") for side in live.intensity)
    return {
        "ping": header.number,
        "fish": live.fish,
        "time": header.time.replace(tzinfo=UTC).isoformat(timespec="microseconds"),
        "longitude": header.x,
        "latitude": header.y,
        **{name.removeprefix("platform_"): _or_null(value) for name, value in live.pose.items()},
        "slant_range": header.slant_range,
        "duration": header.duration,
        "frequency": header.frequency,
        **dict(zip(("port", "starboard"), sides)),
    }


def encode_json(live: LivePing) -> bytes:
    """Encode a ping as a line of JSON."""
    return json.dumps(as_json(live)).encode("ascii") + b"\n"


def write_growing_xtf(path: Path, fish: int, attributes: Mapping[str, Any], *, patient: bool) -> Output:
    """Make an output to an XTF file that other programs may follow while it grows."""
    file = path.open("wb")
    unit: list[float] = []

    def send(live: LivePing) -> None:
        sides = live.amplitudes
        if not unit:  # amplitude of one count, by the first ping: a header comes before what is still unknown
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
        raise SceneError(f"{path}: MCAP files need the packages mcap and mcap-ros2-support; run: {EXTRA}") from None
    file = path.open("wb")
    writer = Writer(file)
    texts = [text if name == RAW_IMAGE else f"MSG: {name}\n{text}" for name, text in MESSAGES.items()]
    schema = writer.register_msgdef(RAW_IMAGE.replace("/", "/msg/"), f"{RULE}\n".join(texts))
    topic = f"/sidescan_{fish}/raw"

    def send(live: LivePing) -> None:
        stamp = round(live.header.time.replace(tzinfo=UTC).timestamp() * 1e6) * 1000
        writer.write_message(topic, schema, raw_sonar_image(live), stamp, stamp, live.header.number)

    def end() -> None:
        writer.finish()  # type: ignore[no-untyped-call]
        file.close()

    return Output(str(path), fish, Reader(send, end, room=FILE_ROOM, patient=patient))


def raw_sonar_image(live: LivePing) -> Any:
    """Message of a ping with the names of ``marine_acoustic_msgs/RawSonarImage``: two beams, port first."""
    header, (beams, bins) = live.header, live.intensity.shape
    microseconds = round(header.time.replace(tzinfo=UTC).timestamp() * 1e6)
    sides = np.array([-0.5 * math.pi, 0.5 * math.pi])  # abeam, positive to starboard
    image = {
        "is_bigendian": False,
        "dtype": FLOAT32,
        "beam_count": beams,
        # Samples of all beams of one range follow one another, as the definition wants them.
        "data": live.amplitudes.T.astype("<f4").tobytes(),
    }
    return _message({
        "header": {
            "stamp": {"sec": microseconds // 10**6, "nanosec": microseconds % 10**6 * 1000},
            "frame_id": f"sidescan_{live.fish}",
        },
        "ping_info": {
            "frequency": header.frequency,
            "sound_speed": 2.0 * header.slant_range / header.duration,
            "tx_beamwidths": [],
            "rx_beamwidths": [],
        },
        "sample_rate": bins / header.duration,
        "samples_per_beam": bins,
        "sample0": 0,
        "tx_delays": [0.0, 0.0],
        "tx_angles": [0.0, 0.0],
        "rx_angles": sides.tolist(),
        "image": image,
    })  # fmt: skip


def _message(values: Mapping[str, Any]) -> Any:
    """Object with attributes in place of a table and the tables within it."""
    made = {name: _message(value) if isinstance(value, dict) else value for name, value in values.items()}
    return SimpleNamespace(**made)


def _or_null(value: float) -> float | None:
    return value if math.isfinite(value) else None
