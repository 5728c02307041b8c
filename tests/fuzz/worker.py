"""Runs the command on mutated files, one case a line of standard input; a process of its own, which may die or hang."""

import contextlib
import io
import json
import os
import sys
import tempfile
import time
import traceback
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from fuzz.samples import SAMPLES, Sample
from insonify import cli


def peak_bytes(*, anew: bool = False) -> int:
    """Highest resident memory of this process and of its children since it was asked for anew."""
    processes, found = [str(os.getpid())], 0
    for task in Path("/proc/self/task").iterdir():
        with contextlib.suppress(OSError):  # a thread that has ended
            processes += (task / "children").read_text(encoding="ascii").split()
    for folder in (Path("/proc", number) for number in processes):
        with contextlib.suppress(OSError, IndexError):  # a process that has ended
            if anew:
                (folder / "clear_refs").write_text("5", encoding="ascii")
            status = (folder / "status").read_text(encoding="ascii", errors="replace")
            found += int(status.partition("VmHWM:")[2].split()[0]) * 1024
    return found


def lay_out(folder: Path, sample: Sample) -> Path:
    """Write a valid file, and the scene that names it, into a folder; returns what the command is given."""
    folder.mkdir(exist_ok=True)
    sample.write(folder / sample.file)
    if not sample.scene:
        return folder / sample.file.partition("/")[0]
    scene = folder / "scene.toml"
    scene.write_text(sample.scene.format(file=sample.file), encoding="utf-8")
    return scene


class Bench:
    """Folders with a valid file and its mutated copy, for one format."""

    def __init__(self, root: Path, name: str) -> None:
        self.name, self.sample = name, SAMPLES[name]
        self.valid = lay_out(root / f"{name}-valid", self.sample)
        self.input = lay_out(root / name, self.sample)
        self.content = (root / f"{name}-valid" / self.sample.file).read_bytes()
        self.file, self.out = root / name / self.sample.file, root / "out"

    def words(self, template: tuple[str, ...]) -> list[str]:
        return [word.format(input=self.input, valid=self.valid, out=self.out) for word in template]

    def mutate(self, seed: int) -> list[str]:
        rng = np.random.default_rng([seed, *self.name.encode()])
        with contextlib.suppress(RecursionError):
            self.file.write_bytes(self.sample.mutate(self.content, rng))
        commands = self.sample.commands
        rare = len(commands) > 1 and rng.random() < 0.05
        return self.words(commands[int(rng.integers(1, len(commands))) if rare else 0])


def run(words: list[str]) -> dict[str, Any]:
    """Run the command as the program does, with all that reaches the terminal caught."""
    began, before = time.perf_counter(), peak_bytes(anew=True)
    code: Any = None
    failure = ""
    with captured() as caught:
        try:
            code = cli.main(words)
        except SystemExit as leaving:
            code = leaving.code
        except BaseException:
            failure = traceback.format_exc()
    told = caught["text"]
    return {
        "code": code, "traceback": failure, "told": told[-2000:],
        "seconds": time.perf_counter() - began, "bytes": peak_bytes() - before,
    }  # fmt: skip


@contextlib.contextmanager
def captured() -> Any:
    """Catch standard error, of libraries in C too, and discard standard output."""
    caught: dict[str, str] = {"text": ""}
    with tempfile.TemporaryFile() as file:
        kept = os.dup(2)
        os.dup2(file.fileno(), 2)
        error = io.TextIOWrapper(os.fdopen(os.dup(2), "wb"), write_through=True)
        try:
            with error, contextlib.redirect_stderr(error), contextlib.redirect_stdout(io.StringIO()):
                yield caught
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            file.seek(0)
            caught["text"] = file.read().decode(errors="replace")


def main() -> None:
    cli.build_parser = cache(cli.build_parser)  # 5 ms of each case
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    benches: dict[str, Bench] = {}
    with tempfile.TemporaryDirectory() as folder:
        for line in sys.stdin:
            name, seed = json.loads(line)
            if name not in benches:
                benches[name] = Bench(Path(folder), name)
                first = benches[name]
                for words in first.sample.commands:  # so that what is loaded once does not count
                    done = run(first.words(tuple(word.replace("{input}", "{valid}") for word in words)))
                    assert (done["code"], done["told"]) == (0, ""), done
            found = run(benches[name].mutate(seed))
            answers.write(json.dumps(found) + "\n")
            answers.flush()


if __name__ == "__main__":
    main()
