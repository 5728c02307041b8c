"""Values drawn by hashing the seed of a specification, the number of a scene and the path of a field."""

from __future__ import annotations

import hashlib
from typing import Any

from insonify.surveys.distributions import DistributionKind

SEED_BITS = 53  # of a drawn seed: every reader of JSON keeps it exactly


def hash_share(seed: int, number: int, path: str) -> float:
    """Hash a seed, a number and a path to a uniform number inside (0, 1)."""
    digest = hashlib.blake2b(f"{seed}\n{number}\n{path}".encode(), digest_size=8).digest()
    return ((int.from_bytes(digest, "big") >> 12) + 0.5) * 2.0**-52


class Draws:
    """Values of one scene, and a record of them."""

    def __init__(self, seed: int, number: int) -> None:
        self._seed, self._number = seed, number
        self.drawn: dict[str, Any] = {}

    def share(self, path: str) -> float:
        """Draw a number inside (0, 1) that is not recorded."""
        return hash_share(self._seed, self._number, path)

    def value(self, path: str, declared: Any) -> Any:
        """Draw a value from a distribution, or return a value that is none."""
        if not isinstance(declared, DistributionKind):
            return declared
        self.drawn[path] = declared.quantile(self.share(path))
        return self.drawn[path]

    def seed(self, path: str) -> int:
        """Draw the seed of a scene's random numbers."""
        self.drawn[path] = int(self.share(path) * 2**SEED_BITS)
        return int(self.drawn[path])
