"""Damaged files of every format: the command makes a record of them or refuses them in one sentence."""

from collections.abc import Iterator

import pytest

from fuzz.runner import Worker, fault, worker
from fuzz.samples import SAMPLES


@pytest.fixture(scope="module")
def running() -> Iterator[Worker]:
    with worker() as made:
        yield made


@pytest.mark.parametrize("count", [24, pytest.param(10_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", SAMPLES)
def test_damaged_files_are_read_or_refused_in_one_sentence(running: Worker, name: str, count: int) -> None:
    found = ((seed, fault(running.case(name, seed))) for seed in range(round(SAMPLES[name].share * count)))
    assert {seed: told for seed, told in found if told is not None} == {}
