"""Speed and memory of data sets: run with `pytest -m bench -s tests/bench/test_surveys.py`.

Images a second on one and two workers, what the engine takes beside the tracing, memory of the driver and of a worker
over 2,000 images, and the jobs a second that the scheduler and the driver manage, by jobs that do nothing.
"""

import threading
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import psutil
import pytest

from insonify.scene import load_scene
from insonify.surveys import schedulers as local
from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.datasets.work import DatasetWork
from insonify.surveys.engine import done_jobs, run_jobs
from small_sets import SET, data_set
from written_jobs import WrittenJobs

pytestmark = pytest.mark.bench
TILES = {"pings": 128, "bins": 160, "empty": 1.0}


def specification(scenes, **tow) -> DatasetSpecification:
    """A data set whose tows are long enough that tracing takes most of the time."""
    fields = {"seabed.spacing": 0.05, "sonar.bins": 640, "track.pings": 512, **tow}
    return data_set(scenes=scenes, tiles=TILES, set={**tomllib.loads(SET)["set"], **fields})


@contextmanager
def sampled_memory():
    """Resident memory of this process and of its largest child, sampled while jobs run."""
    samples, stop, this = [], threading.Event(), psutil.Process()

    def watch():
        while not stop.wait(0.2):
            children = []
            for child in this.children(recursive=True):
                try:
                    children.append(child.memory_info().rss)
                except psutil.NoSuchProcess:
                    continue
            samples.append((this.memory_info().rss, max(children, default=0)))

    with ThreadPoolExecutor() as pool:
        pool.submit(watch)
        try:
            yield samples
        finally:
            stop.set()


class TimedWork(DatasetWork):
    """A data set whose jobs write how long they took: on the clock, and of the processor."""

    def make(self, name, beside: Path):
        begun, used = time.perf_counter(), time.process_time()
        told = super().make(name, beside)
        (beside / "seconds").mkdir()
        spent = time.perf_counter() - begun, time.process_time() - used
        (beside / "seconds" / name).write_text("{:.6f} {:.6f}".format(*spent))
        return told


def run_timed(folder, scenes, workers, monkeypatch):
    """Images a second, seconds of the processor an image, and the share of the workers' time that is not spent in jobs.

    The first fifth of the jobs does not count: workers start and read their kernels.
    """
    monkeypatch.setattr(local, "most_threads", lambda: workers)
    work, ends = TimedWork(specification(scenes), load_scene("default"), folder), []
    run_jobs(work, work.names(), f"local:{workers}", lambda one: ends.append((time.perf_counter(), one.name, one.made)))
    first = len(ends) // 5
    seconds, images = ends[-1][0] - ends[first][0], sum(made for *_, made in ends[first + 1 :])
    spent = [(folder / "seconds" / name).read_text().split() for _, name, _ in ends[first + 1 :]]
    inside, used = np.array(spent, dtype=float).sum(axis=0)
    return images / seconds, used / images, workers * seconds / inside - 1.0


def test_two_workers_make_images_twice_as_fast_with_an_engine_that_takes_little(tmp_path, say, monkeypatch):
    """On cores that nothing else uses. The processor's time for an image tells what two workers cost each other.

    The engine takes the time of a worker that it does not spend in its jobs: flags, files put in place, the way to the
    driver.
    """
    found = {1: [], 2: []}
    for turn, workers in enumerate((1, 2, 1, 2)):
        found[workers].append(run_timed(tmp_path / str(turn), 24, workers, monkeypatch))
    rates = {workers: max(rate for rate, *_ in runs) for workers, runs in found.items()}
    used = {workers: min(used for _, used, _ in runs) for workers, runs in found.items()}
    beside = min(share for *_, share in found[1])
    say(f"images a second: {rates[1]:.1f} on one worker, {rates[2]:.1f} on two: × {rates[2] / rates[1]:.2f}")
    say(
        f"processor: {1e3 * used[1]:.1f} ms an image on one worker, {1e3 * used[2]:.1f} on each of two: "
        f"× {2.0 * used[1] / used[2]:.2f} on free cores; engine beside its jobs: {100 * beside:.1f} %\n",
    )
    assert beside <= 0.1


def test_memory_stays_flat_over_two_thousand_images(tmp_path, say):
    work = DatasetWork(specification(84, **{"track.pings": 384}), load_scene("default"), tmp_path / "set")
    with sampled_memory() as samples:
        run_jobs(work, work.names(), "local:2", lambda ended: None)
    images = len(list((tmp_path / "set").glob("*/images/*/*.png")))
    half = len(samples) // 2
    early, late = (np.mean(part, axis=0) / 1e6 for part in (samples[half // 2 : half], samples[-half // 2 :]))
    say(
        f"memory over {images} images: driver {early[0]:.0f} to {late[0]:.0f} MB, "
        f"worker {early[1]:.0f} to {late[1]:.0f} MB\n",
    )
    assert images >= 2000
    assert late[0] - early[0] < 20.0
    assert late[1] - early[1] < 60.0


@pytest.mark.parametrize(("count", "workers"), [(2000, 1), (2000, 2), (2000, 4), (2000, 8), (10_000, 2)])
def test_empty_jobs_show_the_load_of_driver_and_scheduler(tmp_path, say, monkeypatch, count, workers):
    monkeypatch.setattr(local, "most_threads", lambda: workers)
    work = WrittenJobs(tmp_path / "set", count)
    begun, driver = time.perf_counter(), psutil.Process().cpu_times()
    run_jobs(work, work.names(), f"local:{workers}", lambda ended: None)
    seconds, now = time.perf_counter() - begun, psutil.Process().cpu_times()
    cpu = now.user + now.system - driver.user - driver.system
    listed = time.perf_counter()
    assert len(done_jobs(tmp_path / "set")) == count
    listed = time.perf_counter() - listed
    say(
        f"{count} jobs that write 3 small files: {count / seconds:.0f} a second on {workers} workers; driver and "
        f"scheduler {1e3 * cpu / count:.2f} ms of processor a job; {1e3 * listed:.0f} ms to list what is done\n",
    )
