"""Damaged files of every format: the command makes a record of them or refuses them in one sentence."""

from collections.abc import Iterator

import pytest

from fuzz.runner import Worker, fault, worker
from fuzz.samples import SAMPLES

FEW, MANY = 24, 10_000


@pytest.fixture(scope="module")
def running() -> Iterator[Worker]:
    with worker() as made:
        yield made


def faults(running: Worker, name: str, seeds: range) -> dict[int, str]:
    """Seeds whose file is not dealt with as it should be, with what is wrong."""
    found = ((seed, fault(running.case(name, seed))) for seed in seeds)
    return {seed: told for seed, told in found if told is not None}


@pytest.mark.parametrize("name", SAMPLES)
def test_a_damaged_file_is_read_or_refused_in_one_sentence(running: Worker, name: str) -> None:
    assert faults(running, name, range(round(SAMPLES[name].share * FEW))) == {}


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLES)
def test_ten_thousand_damaged_files_are_read_or_refused(running: Worker, name: str) -> None:
    assert faults(running, name, range(round(SAMPLES[name].share * MANY))) == {}
