"""Jobs that write a few bytes, for tests of the engine; some end their worker, fail, or take their time."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from insonify.errors import SceneError
from insonify.surveys.engine import digest_of, name_job


@dataclass(frozen=True)
class WrittenJobs:
    folder: Path
    count: int
    kills: frozenset[int] = frozenset()  # jobs that end their first worker between their two files
    fails: frozenset[int] = frozenset()  # jobs that cannot be done
    seconds: float = 0.0  # that each takes

    def names(self) -> list[str]:
        return [name_job(number, digest_of("written")) for number in range(self.count)]

    def make(self, name: str, beside: Path) -> dict[str, Any]:
        number = int(name.partition("-")[0])
        if number in self.fails:
            raise SceneError(f"scene {number}: is not to be done; leave it")
        (beside / "one").mkdir()
        (beside / "one" / f"{number}.txt").write_text(f"one {number}" * 1000)
        time.sleep(self.seconds)
        killed = self.folder.with_name("killed") / str(number)
        if number in self.kills and not list(killed.parent.glob(f"{number}-*")):
            killed.parent.mkdir(exist_ok=True)
            killed.with_name(f"{number}-{os.getpid()}").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        (beside / f"{number}.txt").write_text(f"two {number}")
        return {"made": 2, "number": number}

    def begun(self) -> WrittenJobs:
        return self

    def warm_up(self) -> None:
        """Nothing needs to be compiled."""
