"""Damaged files of every format: the command makes a record of them or refuses them in one sentence."""

import pytest

from fuzz.runner import Worker, fault
from fuzz.samples import SAMPLES


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
