"""Workflows for the day on which the project is public: few rights, actions by commit, and what they run exists."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
WORKFLOWS = {path.stem: path for path in sorted((ROOT / ".github" / "workflows").glob("*.yml"))}
PINNED = re.compile(r"[\w-]+/[\w-]+@[0-9a-f]{40} # v\d+(\.\d+)+")
# Beyond reading the sources: what publishes is a job of its own, without any code of the checkout.
RIGHTS = {
    ("docs", "publish"): {"pages": "write", "id-token": "write"},
    ("release", "publish"): {"id-token": "write"},
}


def jobs():
    """Name of the workflow, name of the job, and the job."""
    for workflow, path in WORKFLOWS.items():
        for name, job in yaml.safe_load(path.read_text(encoding="utf-8"))["jobs"].items():
            yield workflow, name, job


@pytest.mark.parametrize("name", WORKFLOWS)
def test_a_workflow_may_read_and_no_more_and_names_actions_by_commit_and_version(name):
    text = WORKFLOWS[name].read_text(encoding="utf-8")
    assert yaml.safe_load(text)["permissions"] == {"contents": "read"}
    assert "secrets." not in text
    assert text.count("actions/checkout@") == text.count("persist-credentials: false")
    used = re.findall(r"uses: (.+)", text)
    assert used
    assert [action for action in used if not PINNED.fullmatch(action)] == []


def test_a_job_that_publishes_has_its_rights_alone_and_runs_no_code_of_ours():
    assert set(WORKFLOWS) == {"docs", "release", "tests"}
    given = {(workflow, name): job["permissions"] for workflow, name, job in jobs() if "permissions" in job}
    assert given == RIGHTS
    for workflow, name, job in jobs():
        assert job["timeout-minutes"] <= 60
        if (workflow, name) in RIGHTS:
            assert job["environment"]
            assert not any("run" in step or "checkout" in step["uses"] for step in job["steps"])


def test_the_quick_tests_run_on_three_systems_with_three_pythons():
    (quick,) = (job for workflow, name, job in jobs() if (workflow, name) == ("tests", "quick"))
    matrix = quick["strategy"]["matrix"]
    assert {system.partition("-")[0] for system in matrix["system"]} == {"ubuntu", "windows", "macos"}
    assert matrix["python"] == ["3.11", "3.12", "3.13"]
    assert any("@tests/quick.txt" in step.get("run", "") for step in quick["steps"])


def test_every_long_test_is_there():
    for line in (ROOT / "tests" / "long.txt").read_text(encoding="utf-8").splitlines():
        file, _, name = line.partition("::")
        assert f"def {name}(" in (ROOT / file).read_text(encoding="utf-8"), line


@pytest.mark.skipif(shutil.which("actionlint") is None, reason="actionlint is not installed")
def test_actionlint_finds_nothing():
    done = subprocess.run(["actionlint", *map(str, WORKFLOWS.values())], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
