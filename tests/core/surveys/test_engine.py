"""Engine: jobs are done once, whole or not at all, whatever becomes of a worker."""

from __future__ import annotations

import os
import sys

import pytest

from insonify.errors import SceneError
from insonify.io.atomic import temporary_path
from insonify.surveys.engine import (
    Ended,
    done_jobs,
    finish,
    flag_of,
    name_job,
    prepare_folder,
    read_flag,
    run_jobs,
)
from insonify.surveys.schedulers import choose_scheduler, find_schedulers, share_cores
from small_sets import contents
from written_jobs import WrittenJobs


@pytest.fixture(scope="module")
def scheduler():
    """Address of a scheduler with two workers, as that of a cluster would be."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        dashboard_address="localhost:0",
        silence_logs=50,
        worker_dashboard_address="localhost:0",
    ) as cluster:
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
    return contents(work.folder)


def test_a_job_leaves_its_files_then_its_flag_and_nothing_else(tmp_path):
    work = WrittenJobs(tmp_path / "work", 1)
    assert finish(work, work.names()[0]).made == 2
    flag = flag_of(work.folder, work.names()[0])
    assert sorted(contents(work.folder)) == ["0.txt", str(flag.relative_to(work.folder)), "one/0.txt"]
    assert read_flag(work.folder, work.names()[0]) == {"made": 2, "number": 0}


def test_a_done_job_is_not_done_again(tmp_path):
    work = WrittenJobs(tmp_path / "work", 1)
    finish(work, work.names()[0])
    (work.folder / "0.txt").unlink()
    finish(work, work.names()[0])
    assert not (work.folder / "0.txt").exists()


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
    sentence = "2 of 9 jobs could not be done, the others are done; job 3: scene 3: is not to be done; leave it"
    with pytest.raises(SceneError, match=sentence):
        Ended([""] * done, failures).refuse_failures()


def test_a_folder_of_something_else_is_left_alone(tmp_path):
    (tmp_path / "thesis.txt").write_text("all of it")
    with pytest.raises(SceneError, match="holds other files; give a new folder"):
        prepare_folder(tmp_path, [], "test")
    work = WrittenJobs(tmp_path / "work", 2)
    finish(work, work.names()[0])
    with pytest.raises(SceneError, match="holds 1 jobs of another test"):
        prepare_folder(work.folder, [name_job(0, "another")], "test")


def test_what_ended_workers_left_is_removed_when_work_goes_on(tmp_path):
    work = WrittenJobs(tmp_path / "work", 2)
    finish(work, work.names()[0])
    left = temporary_path(flag_of(work.folder, work.names()[1]))
    left.mkdir()
    assert prepare_folder(work.folder, work.names(), "test") == work.names()[1:]
    assert left.exists()  # this process may still be writing it
    left.rename(left.with_name(left.name.replace(f"-{os.getpid()}-", "-999999999-")))
    prepare_folder(work.folder, work.names(), "test")
    assert done_jobs(work.folder) == set(work.names()[:1])
    assert len(list(left.parent.iterdir())) == 1


def test_schedulers_are_found_by_their_prefix():
    assert set(find_schedulers()) == {"local", "tcp", "tls"}
    assert choose_scheduler("tcp://host:8786")[1] == "//host:8786"
    with pytest.raises(SceneError, match="'slurm' is no kind of scheduler; write tcp://HOST:PORT or"):
        choose_scheduler("slurm:4")


def test_workers_times_threads_are_the_cores(monkeypatch):
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
        with pytest.raises(SceneError, match=f"--scheduler {address}: no worker has come within 0.2 s; start some"):
            run(WrittenJobs(tmp_path / "work", 1), address)


def test_a_missing_library_is_told_with_its_remedy(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SceneError, match=r"not installed; run: pip install 'insonify\[surveys\]'"):
        run(WrittenJobs(tmp_path / "work", 1), "local:1")
