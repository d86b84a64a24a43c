"""The numeric contract of docs/ptp.md and the README is the one that the tests of motion hold."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import pytest
from motion_checker import RELATIVE
from motion_problems import log_uniform, random_problem

from cnc_ptp.motion.limits import LARGEST_LIMIT, LARGEST_STATE, SMALLEST_LIMIT

ROOT = Path(__file__).parents[2]
SECTION = (ROOT / "docs" / "ptp.md").read_text(encoding="utf-8").split("## Numeric contract\n")[1].split("\n## ")[0]
ROWS = [line.strip("| ").split(" | ") for line in SECTION.splitlines() if "`test/" in line and line.startswith("|")]
INPUTS = dict(
    line.strip("| ").split(" | ") for line in SECTION.split("| input | range |\n|---|---|\n")[1].splitlines()[:5]
)
CHECKER = "test/support/motion_checker.py"


def numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"\b\d+(?:e-?\d+)?\b", text)]


def test_the_table_has_rows() -> None:
    assert len(ROWS) > 12 and len(INPUTS) == 5


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_each_number_is_one_of_its_test(row: list[str]) -> None:
    """The tests named exist and ask for what the row says: to the bit by ==, else for the number itself."""
    _, within, tests = row
    sources = [(ROOT / name).read_text(encoding="utf-8") for name in re.findall(r"`([^`]+)`", tests)]
    assert sources
    for number in re.findall(r"1e-\d+", within):
        assert any(number in source for source in sources)
    assert re.search(r"1e-\d+", within) or "bit" in within
    if "bit" in within:
        assert all("==" in source or "isin" in source for source in sources)


def test_numbers_of_the_checker() -> None:
    of_checker = [within for _, within, tests in ROWS if CHECKER in tests and "1e-" in within]
    assert len(of_checker) == 3
    assert {number for within in of_checker for number in re.findall(r"1e-\d+", within)} == {
        f"{RELATIVE:.0e}".replace("e-0", "e-")
    }


def test_ranges_of_inputs() -> None:
    accepted, states, drawn, _, count = INPUTS.values()
    assert numbers(accepted)[:2] == [SMALLEST_LIMIT, LARGEST_LIMIT]
    assert numbers(states)[0] == LARGEST_STATE
    defaults = [value.default for value in inspect.signature(log_uniform).parameters.values()][1:]
    assert numbers(drawn) == defaults
    assert "signed(draw)" in inspect.getsource(random_problem)
    source = (ROOT / "test" / "motion" / "test_many_problems.py").read_text(encoding="utf-8")
    assert f'"CNC_PTP_RANDOM_PROBLEMS", "{numbers(count)[0]:.0f}"' in source


def test_the_readme_says_the_same() -> None:
    """Every number of its three lines is one of the contract."""
    part = (ROOT / "README.md").read_text(encoding="utf-8").split("## Numeric contract\n")[1].split("\n## ")[0]
    assert "docs/ptp.md#numeric-contract" in part
    named = re.findall(r"\b1e-?\d+\b", part)
    assert named and set(named) <= set(re.findall(r"\b1e-?\d+\b", SECTION))
