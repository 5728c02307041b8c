"""Workers of a scheduler with the same build as the files that are already there: only these get jobs."""

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

from insonify.compiler.build import Build, own_build, stated_build
from insonify.io.atomic import unfinished_folder

RECORD = "build.json"  # beside the flags of the jobs
SILENCE, REMINDER = 10.0, 60.0  # s without a worker until the first sentence, and between it and the next one


class Workers:
    """Workers that calculate alike, and their threads by address; others are named once and get no job."""

    def __init__(self, client: Any, flags: Path, scheduler: str) -> None:
        self.threads: dict[str, int] = {}
        self._client, self._flags, self._scheduler = client, flags, scheduler
        self._builds: dict[str, Build | None] = {}
        self._expected = read_build(flags)
        self._since, self._told = time.monotonic(), 0.0

    def count(self) -> None:
        """Look who is there, and let those who are new state their build."""
        present = self._client.nthreads()
        if new := sorted(present.keys() - self._builds.keys()):
            stated = self._client.run(stated_build, workers=new, on_error="return")
            for address in new:
                build = self._builds[address] = _as_build(stated.get(address))
                if fault := self._fault(build):
                    _say(f"--scheduler {self._scheduler}: {address} gets no jobs: {fault}")
        alike = (address for address, build in self._builds.items() if build is not None and build == self._expected)
        self.threads = {address: present[address] for address in alike if address in present}
        self._remind(len(present))

    def _fault(self, build: Build | None) -> str:
        """Return why a worker gets no job; empty if it gets some. The first one of the versions here sets the build."""
        if build is None:
            return "it does not state its version of insonify; install the same version there as here"
        here = own_build()._replace(system=build.system, processor=build.processor)
        if self._expected is None and build == here:
            self._expected = claim_build(self._flags, build)
        if difference := (self._expected or here).difference(build):
            return f"it has {difference}; files of both would not be the same to the bit: let workers be alike"
        return ""

    def _remind(self, present: int) -> None:
        """Say that nobody works, after a while and then every minute."""
        now = time.monotonic()
        if self.threads:
            self._since, self._told = now, 0.0
        elif now - self._since > SILENCE and now - self._told > REMINDER:
            self._told = now
            left = f"none of the {present} workers may do the jobs that are left" if present else "no worker is left"
            _say(f"--scheduler {self._scheduler}: {left}; start some, or interrupt: the same command goes on")


def claim_build(flags: Path, build: Build) -> Build:
    """Record the build that files of a folder are to be made with; return it, or that of another driver before this."""
    flags.mkdir(parents=True, exist_ok=True)
    final = flags / RECORD
    with unfinished_folder(final) as folder:
        written = folder / RECORD
        written.write_text(json.dumps(build._asdict()), encoding="utf-8", newline="")
        try:
            os.link(written, final)  # fails where there is one
        except OSError:
            if first := read_build(flags):
                return first
            written.replace(final)  # the disk has no links
    return build


def read_build(flags: Path) -> Build | None:
    """Return the build that files of a folder were made with; None before there are any."""
    try:
        return _as_build(json.loads((flags / RECORD).read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return None


def _as_build(stated: Any) -> Build | None:
    """Return a build from its texts; None for an error, or for what another version states."""
    return Build(**stated) if isinstance(stated, dict) and stated.keys() == set(Build._fields) else None


def _say(sentence: str) -> None:
    sys.stderr.write(f"insonify: {sentence}\n")
