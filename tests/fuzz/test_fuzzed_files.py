"""Damaged files of every format: the command makes a record of them or refuses them in one sentence."""

import json
import os
import select
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import pytest

from fuzz.samples import SAMPLES

LONGEST = 20.0  # s, of one case
MOST_BYTES = 10**9  # beyond what the process held before
TESTS = Path(__file__).parents[1]


class Worker:
    """A process that runs cases; started anew when one kills it or hangs."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[bytes] | None = None
        self.messages = tempfile.TemporaryFile()  # noqa: SIM115  # open as long as the worker is

    def case(self, name: str, seed: int) -> dict[str, Any]:
        """Run one case; the result says why there is none where the worker died or was stopped."""
        fresh = self.process is None
        process = self.process = self.process or self._started()
        process.stdin.write(f"{json.dumps([name, seed])}\n".encode())
        process.stdin.flush()
        ready, _, _ = select.select([process.stdout], [], [], LONGEST + (300.0 if fresh else 10.0))
        answer = process.stdout.readline() if ready else b""
        if answer:
            return dict(json.loads(answer))
        died = process.wait() if ready else None
        self.stop()
        self.messages.seek(0)
        told = self.messages.read().decode(errors="replace")[-3000:]
        if died is not None and died > 0:
            raise RuntimeError(f"the worker itself is at fault: {told}")
        return {"dead": "hangs" if died is None else f"signal {-died}\n{told}"}

    def stop(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None

    def _started(self) -> subprocess.Popen[bytes]:
        environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path])}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        self.messages.seek(0)
        self.messages.truncate()
        return subprocess.Popen(
            [sys.executable, "-X", "faulthandler", "-m", "fuzz.worker"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.messages, env=environment, cwd=TESTS,
        )  # fmt: skip


def fault(result: dict[str, Any]) -> str | None:
    """What is wrong with the result of a case: anything but a record, or a refusal in one sentence."""
    if "dead" in result:
        return f"the process died: {result['dead']}"
    if result["traceback"]:
        return str(result["traceback"])
    if result["code"] not in (0, 2):
        return f"exit code {result['code']}"
    sentences = result["told"].splitlines()  # one if the command refuses, warnings if it does not
    if not all(line.startswith("insonify: ") for line in sentences) or (result["code"] != 0 and not sentences):
        return f"on the terminal with exit code {result['code']}: {result['told']}"
    if result["seconds"] > LONGEST:
        return f"took {result['seconds']:.0f} s"
    if result["bytes"] > MOST_BYTES:
        return f"took {result['bytes'] / 1e9:.1f} GB"
    return None


@pytest.fixture(scope="module")
def running():
    made = Worker()
    yield made
    made.stop()
    made.messages.close()


@pytest.mark.parametrize("count", [12, pytest.param(10_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", SAMPLES)
def test_damaged_files_are_read_or_refused_in_one_sentence(running, name, count):
    results = [running.case(name, seed) for seed in range(round(SAMPLES[name].share * count))]
    accepted = sum(result.get("code") == 0 for result in results)
    slowest, most = (max(result.get(figure, 0.0) for result in results) for figure in ("seconds", "bytes"))
    print(f"{name}: {len(results)} cases, {accepted} accepted, slowest {slowest:.1f} s, most {most / 1e6:.0f} MB")  # noqa: T201
    assert {seed: told for seed, result in enumerate(results) if (told := fault(result)) is not None} == {}
