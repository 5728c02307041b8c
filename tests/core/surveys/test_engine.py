"""Engine: jobs are done once, whole or not at all, whatever becomes of a worker."""

import os
import shutil
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest

from insonify.compiler.build import own_build
from insonify.errors import SceneError
from insonify.io.atomic import unfinished_folder
from insonify.surveys.engine import (
    FLAGS,
    Ended,
    done_jobs,
    finish,
    flag_of,
    name_job,
    prepare_folder,
    read_flag,
    run_jobs,
)
from insonify.surveys.schedulers import (
    Workers,
    choose_scheduler,
    claim_build,
    connected,
    find_schedulers,
    read_build,
    share_cores,
)
from small_sets import contents
from written_jobs import WrittenJobs


@pytest.fixture(scope="module")
def scheduler():
    """Address of a scheduler with two workers, as that of a cluster would be."""
    from distributed import LocalCluster

    pages = dict.fromkeys(("dashboard_address", "worker_dashboard_address"), "localhost:0")
    with LocalCluster(n_workers=2, threads_per_worker=1, silence_logs=50, **pages) as cluster:
        yield cluster.scheduler_address


def run(work, scheduler):
    """Do the jobs that are missing; return how many were done, what they made, and those that failed."""
    outcomes = []
    failures = run_jobs(work, prepare_folder(work.folder, work.names(), "test"), scheduler, outcomes.append)
    return len(outcomes) - len(failures), sum(outcome.made for outcome in outcomes), failures


def undisturbed(tmp_path, count):
    """What jobs write if they are done one after another in this process."""
    work = WrittenJobs(tmp_path / "undisturbed", count)
    for name in work.names():
        finish(work, name)
    claim_build(work.folder / FLAGS, own_build())
    return contents(work.folder)


def test_a_job_leaves_its_files_then_its_flag_and_nothing_else(tmp_path):
    work = WrittenJobs(tmp_path / "work", 1)
    assert finish(work, work.names()[0]).made == 2
    flag = flag_of(work.folder, work.names()[0])
    assert sorted(contents(work.folder)) == ["0.txt", str(flag.relative_to(work.folder)), "one/0.txt"]
    assert read_flag(work.folder, work.names()[0]) == {"made": 2, "number": 0}
    (work.folder / "0.txt").unlink()
    finish(work, work.names()[0])
    assert not (work.folder / "0.txt").exists(), "a done job is not done again"


def test_jobs_on_workers_write_what_they_write_here(tmp_path, scheduler):
    work = WrittenJobs(tmp_path / "work", 25)
    assert run(work, scheduler) == (25, 50, ())
    assert contents(work.folder) == undisturbed(tmp_path, 25)
    assert run(WrittenJobs(work.folder, 30), scheduler)[0] == 5


def test_workers_that_are_killed_leave_no_trace(tmp_path, scheduler):
    work = WrittenJobs(tmp_path / "work", 12, kills=frozenset({2, 7}))
    assert run(work, scheduler)[0] == 12
    assert contents(work.folder) == undisturbed(tmp_path, 12)
    assert len(list((tmp_path / "killed").iterdir())) == 2


def test_a_job_that_fails_stops_no_other(tmp_path, scheduler):
    done, _, failures = run(WrittenJobs(tmp_path / "work", 9, fails=frozenset({3, 5})), scheduler)
    assert done == 7
    sentence = "2 of 9 jobs failed, the others are finished; job 3: scene 3: is not to be done; leave it"
    with pytest.raises(SceneError, match=sentence):
        Ended([""] * done, failures).refuse_failures()


def test_a_folder_of_something_else_is_left_alone(tmp_path):
    (tmp_path / "thesis.txt").write_text("all of it")
    with pytest.raises(SceneError, match="contains other files; give a new folder"):
        prepare_folder(tmp_path, [], "test")
    work = WrittenJobs(tmp_path / "work", 2)
    finish(work, work.names()[0])
    with pytest.raises(SceneError, match="contains 1 jobs of another test"):
        prepare_folder(work.folder, [name_job(0, "another")], "test")


def test_what_ended_workers_left_is_removed_when_work_goes_on(tmp_path):
    work = WrittenJobs(tmp_path / "work", 2)
    finish(work, work.names()[0])
    flag = flag_of(work.folder, work.names()[1])
    with unfinished_folder(flag) as left:
        assert prepare_folder(work.folder, work.names(), "test") == work.names()[1:]
        assert left.exists()  # this process is still writing it
        kept = shutil.copytree(left, tmp_path / "kept")
    kept.rename(left)
    prepare_folder(work.folder, work.names(), "test")
    assert done_jobs(work.folder) == set(work.names()[:1])
    assert len(list(left.parent.iterdir())) == 1


def test_schedulers_are_found_by_their_prefix_and_workers_times_threads_are_the_cores(monkeypatch):
    assert set(find_schedulers()) == {"local", "tcp", "tls"}
    assert choose_scheduler("tcp://host:8786")[1] == "//host:8786"
    with pytest.raises(SceneError, match="'slurm' is not a kind of scheduler; write tcp://HOST:PORT or"):
        choose_scheduler("slurm:4")
    monkeypatch.setattr("insonify.surveys.schedulers.most_threads", lambda: 8)
    assert [share_cores(text) for text in ("", "2", "8", "3")] == [(8, 1), (2, 4), (8, 1), (3, 2)]
    for text in ("0", "x", "9"):
        with pytest.raises(SceneError, match=f"--scheduler local:{text}: "):
            share_cores(text)


def test_a_scheduler_without_workers_is_told(tmp_path, monkeypatch):
    from distributed import LocalCluster

    monkeypatch.setattr("insonify.surveys.engine.PATIENCE", 0.2)
    with LocalCluster(n_workers=0, dashboard_address="localhost:0", silence_logs=50) as cluster:
        address = cluster.scheduler_address
        with pytest.raises(SceneError, match=f"--scheduler {address}: no worker connected within 0.2 s; start workers"):
            run(WrittenJobs(tmp_path / "work", 1), address)


class Cluster:
    """A client of workers with given builds, or with an error instead."""

    def __init__(self, **builds):
        self.builds = builds

    def nthreads(self):
        return dict.fromkeys(self.builds, 1)

    def run(self, function, workers, on_error):
        return {address: self.builds[address] for address in workers}


def stated(**changes):
    return own_build()._replace(**changes)._asdict()


def test_workers_of_another_build_get_no_jobs_and_are_named_once(tmp_path, capsys):
    cluster = Cluster(first=stated(), old=stated(insonify="0.0.1", kernels="0123456789ab"), oldest=AttributeError())
    workers = Workers(cluster, tmp_path, "tcp://host:1")
    workers.count()
    cluster.builds |= {"late": stated(processor="generic-0"), "twin": stated(), "newer": stated() | {"compiler": "2"}}
    workers.count()
    workers.count()
    assert workers.threads == {"first": 1, "twin": 1}
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 4
    assert f"old gets no jobs: it has insonify 0.0.1 instead of {own_build().insonify}, kernels 0123456789ab" in told[0]
    assert "oldest gets no jobs: it does not state its version" in told[1]
    assert "late gets no jobs: it has processor generic-0 instead of" in told[2]
    assert "newer gets no jobs: it does not state its version" in told[3]


def test_the_first_of_two_drivers_sets_the_build_and_workers_alike_alone_go_on(tmp_path, capsys):
    Workers(Cluster(one=stated(processor="generic-0")), tmp_path, "tcp://host:1").count()
    assert read_build(tmp_path) == own_build()._replace(processor="generic-0")
    later = Workers(Cluster(one=stated()), tmp_path, "tcp://host:1")
    later.count()
    assert later.threads == {}
    assert "instead of generic-0" in capsys.readouterr().err
    (folder := tmp_path / "at once").mkdir()
    one = Workers(Cluster(one=stated()), folder, "tcp://host:1")
    other = Workers(Cluster(one=stated(processor="generic-0")), folder, "tcp://host:2")
    for workers in (one, other):
        workers.count()
    assert (one.threads, other.threads) == ({"one": 1}, {})
    assert "processor generic-0 instead of" in capsys.readouterr().err
    assert [file.name for file in folder.iterdir()] == ["build.json"]


def test_nobody_left_to_work_is_said_after_ten_seconds_and_every_minute(tmp_path, capsys, monkeypatch):
    now = 100.0
    monkeypatch.setattr("insonify.surveys.schedulers.time", SimpleNamespace(monotonic=lambda: now))
    workers = Workers(Cluster(), tmp_path, "tcp://host:1")
    told = []
    for now in range(100, 200, 5):
        workers.count()
        told += [now for _ in capsys.readouterr().err.splitlines()]
    assert told == [115, 180]


def test_no_listener_is_open_to_other_machines_and_pages_are_empty(tmp_path):
    psutil = pytest.importorskip("psutil")
    with connected("local:1") as client:
        own = psutil.Process()
        used = [at for process in (own, *own.children(recursive=True)) for at in process.net_connections("inet")]
        assert {at.laddr.ip for at in used if at.status == psutil.CONN_LISTEN} <= {"127.0.0.1", "::1"}
        pages = [client.scheduler_info()["services"]["dashboard"]]
        pages += [worker["services"]["dashboard"] for worker in client.scheduler_info()["workers"].values()]
        for port in pages:
            with pytest.raises(HTTPError, match="404"):
                urlopen(f"http://127.0.0.1:{port}/status")


SCHEDULER = """
import time
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address="localhost:0", silence_logs=50) as cluster:
        print(cluster.scheduler_address, flush=True)
        time.sleep(600)
"""


def test_a_scheduler_that_ends_is_told_in_one_sentence(tmp_path, capsys):
    (tmp_path / "scheduler.py").write_text(SCHEDULER)
    command = [sys.executable, str(tmp_path / "scheduler.py")]
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process, ExitStack() as stack:
        stack.callback(process.kill)
        address = process.stdout.readline().strip()
        work = WrittenJobs(tmp_path / "work", 20, seconds=0.1)

        def end(outcome):
            process.kill()

        with pytest.raises(SceneError, match=f"--scheduler {address}: the scheduler has ended"):
            run_jobs(work, prepare_folder(work.folder, work.names(), "test"), address, end)
    assert capsys.readouterr().err == ""


def test_a_missing_library_is_told_with_its_remedy(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SceneError, match=r"not installed; run: pip install 'insonify\[surveys\]'"):
        run(WrittenJobs(tmp_path / "work", 1), "local:1")
