"""Seeded mutations of valid files: of bytes, of numbers in text, and of what containers hold."""

import io
import json
import re
import struct
import warnings
import zipfile
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np

Random = np.random.Generator
Mutation = Callable[[bytes, Random], bytes]
ODD_INTEGERS = (0, 1, 2, 3, 7, 255, 256, 65535, 2**24, 2**31 - 1, 2**31, 2**32 - 1, 10**10, 2**62, 2**63 - 1, 2**64 - 1)
ODD_FLOATS = (0.0, -1.0, 1e-6, 1e-300, 1e15, 3e38, 1e300, float("inf"), float("-inf"), float("nan"))
ODD_WORDS = ("nan", "inf", "-inf", "1e300", "-1e300", "1e-300", "0", "-0", "-1", "", "1e9", "99999999999999999999", "x",
             "true", "''", '"', "é", "\x00", "1,5", "--", "1e999", "[" * 40, "0x10", "1_000")  # fmt: skip
ODD_VALUES = (None, True, -1, 0, 1, 3, 1e300, -1e-300, 2**31, 2**53, 10**30, "", "x", "../../x", "/dev/zero", [], {},
              [[]], "\x00", "data:,x", "data:application/octet-stream;base64,AAAA")  # fmt: skip
FACTORS = (-1.0, 0.0, 1e-3, 0.1, 0.5, 0.9, 1.1, 2.0, 5.0, 10.0, 100.0, 1e4)
NUMBER = re.compile(rb"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")


def mutate_bytes(content: bytes, rng: Random) -> bytes:
    """Change bits, numbers and ranges at one to six places."""
    data = bytearray(content)
    for _ in range(rng.integers(1, 7)):
        if data:
            _change_bytes(data, rng)
    return bytes(data)


def mutate_text(content: bytes, rng: Random) -> bytes:
    """Change numbers and lines; one time in five, bytes."""
    if rng.random() < 0.2:
        return mutate_bytes(content, rng)
    for _ in range(rng.integers(1, 5)):
        content = _change_number(content, rng) if rng.random() < 0.6 else _change_lines(content, rng)
    return content


def mutate_scene(content: bytes, rng: Random) -> bytes:
    """Scale one to three numbers of a scene; one time in four, change its text as that of any file."""
    if rng.random() < 0.25:
        return mutate_text(content, rng)
    for _ in range(rng.integers(1, 4)):
        found = list(NUMBER.finditer(content))
        match = found[rng.integers(len(found))]
        value = f"{float(match.group()) * float(rng.choice(FACTORS)):.12g}".encode()
        content = content[: match.start()] + value + content[match.end() :]
    return content


def mutate_json(content: bytes, rng: Random) -> bytes:
    """Change one to three values of a JSON document; one time in five, its text."""
    if rng.random() < 0.2:
        return mutate_text(content, rng)
    document = json.loads(content)
    for _ in range(rng.integers(1, 4)):
        places = list(_places(document))
        if places:
            holder, key = places[rng.integers(len(places))]
            _change_value(holder, key, rng)
    return json.dumps(document).encode()


def mutate_glb(content: bytes, rng: Random) -> bytes:
    """Change the document of a binary glTF file with its lengths kept true; one time in three, bytes."""
    if rng.random() < 0.33:
        return mutate_bytes(content, rng)
    length = struct.unpack_from("<I", content, 12)[0]
    document = mutate_json(content[20 : 20 + length], rng)
    document += b" " * (-len(document) % 4)
    rest = content[20 + length :]
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(document) + len(rest), len(document), b"JSON")
    return head + document + rest


def mutate_zip(content: bytes, rng: Random) -> bytes:
    """Change members of an archive, whose checksums stay true, or its own records."""
    if rng.random() < 0.3:
        return mutate_bytes(content, rng)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    chosen = list(members)[rng.integers(len(members))]
    members[chosen] = mutate_npy(members[chosen], rng)
    if rng.random() < 0.1:
        members[list(members)[rng.integers(len(members))]] = b""
    made = io.BytesIO()
    kind = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)[rng.integers(4)]
    with warnings.catch_warnings(), zipfile.ZipFile(made, "w", kind) as archive:
        warnings.simplefilter("ignore")
        for name, member in members.items():
            archive.writestr(name if rng.random() < 0.95 else f"{name}x", member)
    changed = bytearray(made.getvalue())
    if rng.random() < 0.1:  # bit 0 of the flags of the first entry of the directory: encrypted
        changed[changed.rindex(b"PK\x01\x02") + 8] |= 1
        changed[changed.index(b"PK\x03\x04") + 6] |= 1
    return bytes(changed)


def mutate_npy(content: bytes, rng: Random) -> bytes:
    """Change the header of an array or its bytes; one time in ten a header announces a great array."""
    chance = rng.random()
    if chance < 0.2:
        return mutate_bytes(content, rng)
    length = struct.unpack_from("<H", content, 8)[0]
    header, data = content[10 : 10 + length], content[10 + length :]
    if chance < 0.4:
        changed = bytearray(data)
        for _ in range(rng.integers(1, 5)):
            _set_float(changed, rng)
        data = bytes(changed[: len(data)])
    elif chance < 0.5:
        side = int(rng.choice([2000, 16384, 40000, 10**6, 10**10]))
        header = re.sub(rb"\(.*?\)", f"({side}, {side})".encode(), header)
        data = bytes(int(rng.choice([0, 10**6, 3 * 10**7])))  # zeros, which archives shrink a thousandfold
    elif chance < 0.8:
        header = mutate_text(header, rng)
    else:
        kinds = (
            "<f8", "|O", "<c16", "<U9", "|b1", "<M8[s]", "<f2", ">f4", "<i8", "<f16", "|V8", "[('a','<f4')]", "|u1",
        )  # fmt: skip
        header = re.sub(rb"'descr': '.*?'", f"'descr': '{rng.choice(kinds)}'".encode(), header)
    return content[:8] + struct.pack("<H", len(header) & 0xFFFF) + header + data


def mutate_png(content: bytes, rng: Random) -> bytes:
    """Change chunks of a PNG picture, whose checksums stay true; one time in three, bytes."""
    if rng.random() < 0.33:
        return mutate_bytes(content, rng)
    chunks, at = [], 8
    while at + 12 <= len(content):
        length = struct.unpack_from(">I", content, at)[0]
        chunks.append((content[at + 4 : at + 8], content[at + 8 : at + 8 + length]))
        at += 12 + length
    k = rng.integers(len(chunks))
    kind, data = chunks[k]
    if kind == b"IDAT" and rng.random() < 0.5:
        data = zlib.compress(mutate_bytes(zlib.decompress(data), rng))
    elif kind == b"IHDR" and rng.random() < 0.5:
        data = struct.pack(">II", *rng.choice([1, 2, 5000, 20000, 2**31 - 1], 2)) + data[8:]
    else:
        data = mutate_bytes(data, rng)
    chunks[k] = (kind, data)
    if rng.random() < 0.2:
        chunks.insert(k, chunks[rng.integers(len(chunks))])
    return content[:8] + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks
    )


def _change_bytes(data: bytearray, rng: Random) -> None:
    change = rng.integers(10)
    if change == 0:
        data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))
    elif change == 1:
        data[rng.integers(len(data))] = int(rng.integers(256))
    elif change == 2:
        size = int(rng.choice([1, 2, 4, 8]))
        odd = ODD_INTEGERS[rng.integers(len(ODD_INTEGERS))] % 2 ** (8 * size)
        _put(data, odd.to_bytes(size, "little" if rng.random() < 0.7 else "big"), rng)
    elif change == 3:
        _set_float(data, rng)
    elif change == 4:
        if rng.random() < 0.3:
            del data[rng.integers(len(data)) :]
    elif change == 9:
        data[:] = _change_number(bytes(data), rng)
    else:
        start = int(rng.integers(len(data)))
        stop = min(len(data), start + int(rng.choice([1, 4, 16, 64, 512])))
        if change == 5:
            data[start:stop] = bytes([int(rng.choice([0, 0xFF]))]) * (stop - start)
        elif change == 6:
            data[start:start] = data[start:stop]
        elif change == 7:
            del data[start:stop]
        else:
            at = int(rng.integers(len(data)))
            data[at : at + stop - start] = data[start:stop]


def _set_float(data: bytearray, rng: Random) -> None:
    code = str(rng.choice(["<f", "<d", ">f", ">d"]))
    value = ODD_FLOATS[rng.integers(len(ODD_FLOATS))]
    _put(data, struct.pack(code, value if code[1] == "d" or abs(value) < 3.1e38 else float("inf")), rng)


def _put(data: bytearray, piece: bytes, rng: Random) -> None:
    aligned = int(rng.integers(len(data)))
    at = aligned - aligned % len(piece) if rng.random() < 0.5 else aligned
    data[at : at + len(piece)] = piece


def _change_number(content: bytes, rng: Random) -> bytes:
    found = list(NUMBER.finditer(content))
    if not found:
        return content
    match = found[rng.integers(len(found))]
    odd = ODD_WORDS[rng.integers(len(ODD_WORDS))].encode()
    return content[: match.start()] + odd + content[match.end() :]


def _change_lines(content: bytes, rng: Random) -> bytes:
    lines = content.splitlines(keepends=True)
    if not lines:
        return content
    k, other = rng.integers(len(lines), size=2)
    change = rng.integers(4)
    if change == 0:
        del lines[k]
    elif change == 1:
        lines.insert(k, lines[other])
    elif change == 2:
        lines[k], lines[other] = lines[other], lines[k]
    else:
        lines[k] = lines[k][: rng.integers(len(lines[k]) + 1)]
    return b"".join(lines)


def _places(document: Any) -> Any:
    """Yield every value of a JSON document as its holder and key."""
    items = document.items() if isinstance(document, dict) else enumerate(document)
    for key, value in list(items):
        yield document, key
        if isinstance(value, (dict, list)):
            yield from _places(value)


def _change_value(holder: Any, key: Any, rng: Random) -> None:
    chance = rng.random()
    if chance < 0.15:
        del holder[key]
    elif chance < 0.4 and isinstance(holder[key], (int, float)):
        holder[key] = holder[key] + int(rng.integers(-2, 3))
    elif chance < 0.5 and isinstance(holder[key], list):
        holder[key] = holder[key] * int(rng.integers(2, 5))
    else:
        holder[key] = ODD_VALUES[rng.integers(len(ODD_VALUES))]
