"""Threads: how many the process may use, and work shared among them."""

import multiprocessing
import os
import threading
import time
from collections import deque
from concurrent.futures import Future
from unittest.mock import Mock

import pytest

from commands import LONG, PATIENCE, run_python
from insonify import cores, parallel
from insonify.parallel import PerThread, count_threads, in_parallel, limited_threads, one_ahead
from insonify.scene import SceneError


@pytest.fixture(autouse=True)
def _fresh_count():
    cores.most_threads.cache_clear()
    yield
    cores.most_threads.cache_clear()


@pytest.mark.parametrize("count", [0, 1, 7, 8, 100, 10_000])
@pytest.mark.parametrize("threads", [1, 2, 3, None])
@pytest.mark.parametrize("least", [1, 8])
def test_shares_cover_every_ping_once_and_in_order(count, threads, least):
    shares = in_parallel(lambda first, last: (first, last), count, threads, least)
    assert [ping for first, last in shares for ping in range(first, last)] == list(range(count))
    assert all(last - first >= least for first, last in shares[:-1])


def test_few_pings_stay_on_the_calling_thread_and_a_share_may_share_its_own_work():
    assert in_parallel(lambda first, last: threading.get_ident(), 64, least=64) == [threading.get_ident()]
    inner = in_parallel(lambda first, last: sum(in_parallel(lambda a, b: b - a, 40 * (last - first))), 100)
    assert sum(inner) == 4000


@pytest.mark.parametrize("threads", [1, 2])
def test_no_more_threads_work_than_allowed(threads):
    at_work, most, lock = [], [], threading.Lock()

    def block(first, last):
        with lock:
            at_work.append(first)
            most.append(len(at_work))
        time.sleep(0.002)
        at_work.remove(first)

    with limited_threads(threads):
        in_parallel(block, 400)
    assert max(most) <= threads


def test_several_callers_share_one_pool():
    names = set()

    def call():
        in_parallel(lambda first, last: (names.add(threading.current_thread().name), time.sleep(0.002)), 400)

    callers = [threading.Thread(target=call, name=f"caller {k}") for k in range(4)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert len({name for name in names if name.startswith("in parallel")}) <= max(cores.most_threads() - 1, 1)


def test_an_error_stops_the_others_and_is_raised(monkeypatch):
    begun, failed = [], threading.Event()

    def block(first, last):
        begun.append(first)
        if first == 0:
            raise ValueError("the first share")
        failed.wait(10.0)  # no share ends before the others are called off

    def call_off(waiting, **how):
        deque(waiting, **how)
        failed.set()

    monkeypatch.setattr(parallel, "deque", call_off)
    with pytest.raises(ValueError, match="the first share"):
        in_parallel(block, 10_000, threads=2)
    assert len(begun) <= 2  # the one that fails, and one beside it


def test_each_thread_makes_its_own_room_once():
    rooms = PerThread(lambda: [])

    def block(first, last):
        rooms.own.append(first)
        time.sleep(0.002)
        return threading.get_ident(), rooms.own

    by_thread = {}
    for thread, room in in_parallel(block, 400):
        assert by_thread.setdefault(thread, room) is room
    assert len({id(room) for room in by_thread.values()}) == len(by_thread)


def test_arguments_and_the_variable_limit_threads(monkeypatch):
    monkeypatch.setenv(cores.VARIABLE, "3")
    assert [count_threads(), count_threads(2), count_threads(8)] == [3, 2, 3]
    with limited_threads(2):
        assert [count_threads(), count_threads(1), count_threads(3)] == [2, 1, 2]
        with limited_threads(None):
            assert count_threads() == 2
    assert count_threads() == 3


@pytest.mark.parametrize("value", ["0", "-1", "two", "1.5"])
def test_a_mistaken_variable_is_one_sentence(monkeypatch, value):
    monkeypatch.setenv(cores.VARIABLE, value)
    with pytest.raises(SceneError, match=f"^INSONIFY_THREADS: '{value}' is not a number of threads; set it to .*$"):
        count_threads()


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system has no affinity")
def test_affinity_counts():
    code = "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))}); "
    code += "from insonify.parallel import count_threads; print(count_threads())"
    alone = {name: value for name, value in os.environ.items() if name != cores.VARIABLE}
    assert run_python("-c", code, env=alone)[1].strip() == "1"


@pytest.mark.parametrize(
    ("groups", "files", "quota"),
    [
        ("0::/\n", {"cpu.max": "150000 100000\n"}, 1.5),
        ("0::/\n", {"cpu.max": "max 100000\n"}, float("inf")),
        ("0::/job/step\n", {"job/step/cpu.max": "max 100000\n", "job/cpu.max": "200000 100000\n"}, 2.0),
        ("0::/job/../other\n", {"other/cpu.max": "100000 100000\n"}, 1.0),
        (
            "4:memory:/x\n3:cpu,cpuacct:/docker/x\n",
            {"cpu/cpu.cfs_quota_us": "300000\n", "cpu/cpu.cfs_period_us": "100000\n"},
            3.0,
        ),
        ("3:cpu:/\n", {"cpu/cpu.cfs_quota_us": "-1\n", "cpu/cpu.cfs_period_us": "100000\n"}, float("inf")),
        ("nonsense\n", {"cpu.max": "nonsense\n"}, float("inf")),
    ],
)
def test_the_quota_of_control_groups_counts(monkeypatch, tmp_path, groups, files, quota):
    (tmp_path / "groups").write_text(groups)
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(cores, "GROUPS", tmp_path / "groups")
    monkeypatch.setattr(cores, "MOUNT", tmp_path)
    assert cores._quota() == quota
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: set(range(64)), raising=False)
    assert cores.usable_cores() == min(64, quota if quota != 1.5 else 2)


@pytest.mark.parametrize(("value", "threads"), [(None, 1), ("2", 2)])
def test_a_worker_process_takes_one_thread_unless_told_otherwise(monkeypatch, value, threads):
    monkeypatch.delenv(cores.VARIABLE, raising=False)
    if value:
        monkeypatch.setenv(cores.VARIABLE, value)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(count_threads) == threads


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_forked_process_has_a_pool_of_its_own():
    code = """
import os, time
from insonify.parallel import in_parallel
work = lambda: sum(in_parallel(lambda first, last: (time.sleep(0.001), last - first)[1], 400, 2))
assert work() == 400
child = os.fork()
if child == 0:
    os._exit(0 if work() == 400 else 1)
print(os.waitpid(child, 0)[1])
"""
    assert run_python("-c", code, timeout=PATIENCE)[1].strip() == "0"


def test_one_item_ahead_is_made_meanwhile():
    made = []

    def items():
        for number in range(5):
            made.append(number)
            yield number

    seen = []
    for item in one_ahead(items()):
        limit = time.monotonic() + PATIENCE
        while len(made) < min(item + 2, 5) and time.monotonic() < limit:
            time.sleep(0.001)
        time.sleep(0.01)  # for one made too early
        seen.append((item, len(made)))
    assert seen == [(0, 2), (1, 3), (2, 4), (3, 5), (4, 5)]


def test_an_error_of_the_maker_comes_after_the_items_before_it():
    def items():
        yield 1
        raise ValueError("the second")

    ahead = one_ahead(items())
    assert next(ahead) == 1
    with pytest.raises(ValueError, match="the second"):
        next(ahead)


@pytest.mark.parametrize("kind", [KeyboardInterrupt, SystemExit])
def test_a_caller_that_is_interrupted_does_not_wait_for_the_item(monkeypatch, kind):
    finish = threading.Event()

    def items():
        finish.wait(LONG)
        yield 1

    began = time.perf_counter()
    with monkeypatch.context() as patched:
        patched.setattr(Future, "result", Mock(side_effect=kind))
        with pytest.raises(kind):
            next(one_ahead(items()))
    assert time.perf_counter() - began < PATIENCE  # not an hour
    finish.set()


def test_a_caller_that_leaves_early_leaves_no_thread():
    before = threading.enumerate()  # one that an earlier test interrupted may still be ending
    for _ in one_ahead(iter(range(1000))):
        break
    assert not [thread for thread in threading.enumerate() if thread not in before and "ahead" in thread.name]
