"""Data sets with a killed driver, an interrupt, or a full disk: nothing done is lost, and a rerun completes them."""

import json
import os
import resource
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest

from commands import wait_until
from insonify.surveys.engine import done_jobs, read_flag
from small_sets import contents, run_here, write_set

SCENES = "12"


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed")
    assert run_here(*words(folder)) == 0
    return contents(folder / "set")


def words(folder, workers=1):
    path = write_set(folder, scenes=SCENES)
    return ["dataset", str(path), "-o", str(folder / "set"), "--scheduler", f"local:{workers}"]


def driver(folder, workers=1, **options):
    """Start the command in a process, and a group, of its own."""
    command = [sys.executable, "-m", "insonify", *words(folder, workers)]
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell lets its background commands ignore it
        options.setdefault("preexec_fn", lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    pipes = dict.fromkeys(("stdout", "stderr"), subprocess.PIPE)
    return subprocess.Popen(command, text=True, start_new_session=True, **pipes, **options)


def wait_for_jobs(folder, count, process):
    wait_until(lambda: len(done_jobs(folder / "set")) >= count or process.poll() is not None)


def check_done(folder, undisturbed):
    """What is done is whole and as it is undisturbed; no other file has a name that a reader would take."""
    for name in done_jobs(folder / "set"):
        told = read_flag(folder / "set", name)
        assert json.loads(json.dumps(told)) == told
        for tile in told["tiles"]:
            for kind, suffix in (("images", ".png"), ("masks", ".png"), ("labels", ".txt")):
                path = (folder / "set" / tile["file"].replace("/images/", f"/{kind}/")).with_suffix(suffix)
                assert undisturbed[str(path.relative_to(folder / "set"))]
    for name, digest in contents(folder / "set").items():
        assert ".unfinished-" in name or undisturbed[name] == digest


def are_ended(process):
    """Whether the command has ended, and all its workers."""
    try:
        os.killpg(process.pid, 0)
    except ProcessLookupError:
        return True
    return False


def complete(folder, undisturbed):
    """Let another run do the jobs that are missing."""
    done = done_jobs(folder / "set")
    assert run_here(*words(folder)) == 0
    assert done <= done_jobs(folder / "set")
    assert contents(folder / "set") == undisturbed


@pytest.mark.kill
@pytest.mark.parametrize("jobs", range(12))
@pytest.mark.parametrize("attempt", range(3))
def test_a_driver_killed_at_any_time_loses_nothing(tmp_path, undisturbed, jobs, attempt):
    process = driver(tmp_path, workers=2)
    wait_for_jobs(tmp_path, jobs, process)
    process.kill()
    process.communicate(timeout=120)
    wait_until(lambda: are_ended(process))
    check_done(tmp_path, undisturbed)
    complete(tmp_path, undisturbed)


@pytest.mark.kill
@pytest.mark.parametrize("jobs", range(10))
def test_workers_killed_at_any_time_lose_nothing(tmp_path, undisturbed, jobs):
    process = driver(tmp_path, workers=2)
    wait_for_jobs(tmp_path, jobs, process)
    tasks = Path(f"/proc/{process.pid}/task")
    children = [child for task in tasks.iterdir() for child in (task / "children").read_text().split()]
    workers = [int(child) for child in children if "spawn_main" in Path(f"/proc/{child}/cmdline").read_text()]
    for worker in workers[:1]:
        os.kill(worker, signal.SIGKILL)
    assert process.wait(timeout=120) == 0, process.communicate()
    process.communicate()
    assert contents(tmp_path / "set") == undisturbed


def interrupt_and_check(folder, undisturbed, number):
    """End a run by a signal after two more jobs; what was done before and since is kept."""
    before = done_jobs(folder / "set")
    process = driver(folder)
    wait_for_jobs(folder, len(before) + 2, process)
    if number == signal.SIGINT:
        os.killpg(process.pid, number)  # as a terminal sends it: to the workers as well
    else:
        process.send_signal(number)
    complaint = process.communicate(timeout=120)[1]
    wait_until(lambda: are_ended(process))
    if number != signal.SIGKILL:
        assert process.returncode == 128 + number
        assert f"of {SCENES} jobs are finished and kept; repeat the command to resume" in complaint
        assert len(complaint.splitlines()) == 1
        assert not [name for name in contents(folder / "set") if ".unfinished-" in name]
    check_done(folder, undisturbed)
    assert before < done_jobs(folder / "set")


@pytest.mark.kill
def test_a_request_to_end_keeps_what_is_done(tmp_path, undisturbed):
    interrupt_and_check(tmp_path, undisturbed, signal.SIGTERM)


def test_what_is_done_before_a_full_disk_a_kill_and_an_interrupt_is_kept_and_completed(tmp_path, undisturbed):
    limit = 4500  # bytes of a file: some images are larger
    # Python does not notice that it wrote a part of its own bytecode.
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    limited = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (limit, limit))
    process = driver(tmp_path, preexec_fn=limited, env=environment)
    complaint = process.communicate(timeout=120)[1]
    assert process.returncode == 2
    assert complaint.count("\n") == 1
    assert f"{tmp_path / 'set'}: File too large; check the path, its permissions and the disk" in complaint
    check_done(tmp_path, undisturbed)
    for number in (signal.SIGKILL, signal.SIGINT):
        interrupt_and_check(tmp_path, undisturbed, number)
    assert len(done_jobs(tmp_path / "set")) < int(SCENES)
    complete(tmp_path, undisturbed)


@pytest.mark.kill
@pytest.mark.parametrize("kilobytes", [64, 128, 256, 400, 600])
def test_a_disk_that_fills_up_loses_nothing(tmp_path, undisturbed, kilobytes):
    (tmp_path / "disk").mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(tmp_path / "disk")]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("a small disk can be mounted by root alone")
    try:
        (tmp_path / "set").symlink_to(tmp_path / "disk")
        process = driver(tmp_path)
        complaint = process.communicate(timeout=120)[1]
        assert process.returncode == 2
        assert complaint.endswith("No space left on device; check the path, its permissions and the disk\n")
        check_done(tmp_path, undisturbed)
        subprocess.run([*mount[:3], "-o", "remount,size=64m", "tmpfs", str(tmp_path / "disk")], check=True)
        complete(tmp_path, undisturbed)
    finally:
        subprocess.run(["umount", str(tmp_path / "disk")], check=True)
