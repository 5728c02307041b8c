"""Sealed values: text that nobody reads by accident, with a digest that tells whether it was changed."""

import base64
import hashlib
import json
import textwrap
import zlib
from typing import Any

from insonify.io.file_access import FileFault

LARGEST = 2**24  # bytes of the values
WIDTH = 100  # letters of a line
SUFFIX = ".exercise"  # of files with a scene that is sealed


def seal(values: dict[str, Any]) -> dict[str, str]:
    """Return values as a table of a text and its digest."""
    packed = zlib.compress(json.dumps(values).encode())
    text = "\n".join(textwrap.wrap(base64.b64encode(packed).decode(), WIDTH))
    return {"sealed": f"{text}\n", "digest": hashlib.sha256(packed).hexdigest()}


def unseal(table: dict[str, Any]) -> dict[str, Any]:
    """Return the values of a table that `seal` made, whatever else is in it."""
    try:
        packed = base64.b64decode(str(table["sealed"]))
        if hashlib.sha256(packed).hexdigest() != table["digest"]:
            raise ValueError
        reader = zlib.decompressobj()
        values: dict[str, Any] = json.loads(reader.decompress(packed, LARGEST))
    except (KeyError, ValueError, zlib.error):
        raise FileFault("is not as it was made", "take the file that insonify exercise make wrote") from None
    return values
