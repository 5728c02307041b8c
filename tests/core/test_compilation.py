"""Compilation: each kernel once, what is compiled and which part is done, and what that costs."""

import io
import math
import os
import sys
import time
from pathlib import Path

import pytest

from commands import run_python
from insonify import progress
from insonify.compiler.compilation_events import WORDS, called_functions
from insonify.compiler.digests import SOURCES
from insonify.compiler.progress import Compilation
from insonify.kernels.beam.knot_weights import weigh_knots
from insonify.kernels.sweep.sweep import sweep_pings

FIRST_CALL = """
import numpy as np
from insonify.kernels.bed.voronoi import nearest_seed_hash
from insonify.compiler.progress import watch_compilation

with watch_compilation(print):
    nearest_seed_hash(7, 0, 0.5, 0.5, 1024)
"""


WORDED_ERROR = """
import sys, types
from insonify.compiler.jit import kernel
from numba.core.errors import termcolor

class Watched(types.ModuleType):
    def __setattr__(self, name, value):
        print(name)

sys.__class__ = Watched
termcolor().errmsg("no such attribute")
"""


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_every_folder_of_kernels_has_words_and_a_kernel_is_known_with_all_that_it_calls() -> None:
    assert {path.name for path in (SOURCES / "kernels").iterdir() if (path / "__init__.py").exists()} == set(WORDS)
    assert weigh_knots.py_func in called_functions(sweep_pings.py_func)
    assert sweep_pings.py_func not in called_functions(weigh_knots.py_func)


@pytest.mark.parametrize(
    ("left", "words"),
    [
        (None, "this takes a while"),
        (1.0, "about 5 s left"),
        (18.0, "about 20 s left"),
        (50.0, "about a minute left"),
        (170.0, "about 3 minutes left"),
    ],
)
def test_a_sentence_says_what_is_compiled_and_how_long_it_takes(left: float | None, words: str) -> None:
    assert Compilation("bent rays", 0.2, left).sentence == f"compiling bent rays, once, {words}"


def reports(cache: Path) -> list[str]:
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    code, printed, _ = run_python("-c", FIRST_CALL, env=environment | {"XDG_CACHE_HOME": str(cache)})
    assert code == 0
    return printed.splitlines()


def test_the_share_done_grows_and_nothing_is_said_of_code_on_disk(tmp_path: Path) -> None:
    *shares, end = [eval(line, {"Compilation": Compilation, "inf": math.inf}) for line in reports(tmp_path)]
    assert end is None
    assert {report.subject for report in shares} == {"the bed"}
    done = [report.done for report in shares]
    assert done == sorted(done)
    assert done[0] == 0.0 < done[-1] < 1.0
    assert len(set(done)) >= 4
    assert shares[0].seconds_left is None
    assert shares[-1].seconds_left > 0.0
    assert reports(tmp_path) == []


def test_streams_are_nobody_elses_while_numba_words_an_error() -> None:
    pytest.importorskip("colorama", reason="Numba replaces the streams only with it")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    assert run_python("-c", WORDED_ERROR, env=environment)[:2] == (0, "")


def test_progress_goes_on_between_two_reports(monkeypatch: pytest.MonkeyPatch) -> None:
    report = Compilation("bent rays", 0.6, 20.0, reported=100.0)
    predicted = []
    for now in (99.0, 100.0, 110.0, 119.0, 500.0):
        monkeypatch.setattr(time, "monotonic", lambda now=now: now)
        predicted.append(report.by_now)
    assert predicted[0] == predicted[1] == report
    assert predicted[2].done == pytest.approx(0.8)
    assert predicted[2].seconds_left == pytest.approx(10.0)
    assert predicted[3].done < predicted[4].done < 1.0
    assert Compilation("bent rays", 0.0, None).by_now.done == 0.0


@pytest.mark.parametrize("screen", [Terminal, io.StringIO])
def test_a_terminal_shows_a_bar_until_the_kernel_is_finished(screen, monkeypatch) -> None:
    monkeypatch.setattr(progress, "DELAY", 0.0)
    monkeypatch.setattr(sys, "stderr", screen())
    bar = progress.CompilationBar()
    bar(Compilation("bent rays", 0.0, None))
    bar(Compilation("bent rays", 0.4, 61.0))
    bar(None)
    shown = sys.stderr.getvalue()
    assert ("compiling bent rays, once, about a minute left  40 %" in shown) == sys.stderr.isatty()
    assert sys.stderr.isatty() or not shown


SCENES = ("default", "ghosts", "raw-record", "rough-tow", "sediments", "targets", "thermocline", "wreck")
COUNT = f"""
import sys
import numpy as np
from insonify.compiler.dispatch import Kernel
from insonify.compiler.separate import SeparateKernel
from insonify.scene import edit, load_scene
from insonify.simulation import prepare

for name in {SCENES}:
    simulation = prepare(edit(load_scene(name), {{"track.pings": 2}}))
    simulation.intensity(np.arange(2))
    simulation.truth(np.arange(1))
for name, module in list(sys.modules.items()):
    if name.startswith("insonify"):
        for word, found in vars(module).items():
            # What is fused into its callers is compiled by them.
            kernel = isinstance(found, Kernel) and not found.options.get("forceinline")
            if kernel and found.__module__ == name:
                signatures = {{*found.entry.signatures, *found.part.signatures}}
                signatures |= {{*found.machine_code.signatures}} if isinstance(found, SeparateKernel) else set()
                if len(signatures) > 1:
                    print(f"{{name}}.{{word}}", *signatures, sep="\\n  ")
"""


def test_no_kernel_is_compiled_for_two_kinds_of_arguments() -> None:
    # A process of its own: other tests call kernels with arguments of their own making.
    assert run_python("-c", COUNT)[:2] == (0, "")
