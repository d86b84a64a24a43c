"""The numeric contract of docs/ptp.md and the README is the one that the tests of motion hold."""

from __future__ import annotations

import ast
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


def numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"\b\d+(?:e-?\d+)?\b", text)]


def test_the_table_has_rows() -> None:
    assert len(ROWS) > 12 and len(INPUTS) == 5


def function(place: str) -> ast.FunctionDef:
    """The one at `path name`, as the table writes it."""
    file, name = place.split()
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    return next(node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == name)


def tolerances(of: ast.FunctionDef) -> set[float]:
    """Numbers in a function that can be a tolerance; RELATIVE of the checker by its value."""
    nodes = list(ast.walk(of))
    found = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, float)}
    return found | {RELATIVE for node in nodes if isinstance(node, ast.Name) and node.id == "RELATIVE"}


def asserts_equality(of: ast.FunctionDef) -> bool:
    """An assertion of the function compares without a tolerance."""
    for node in (part for test in ast.walk(of) if isinstance(test, ast.Assert) for part in ast.walk(test.test)):
        if isinstance(node, ast.Attribute) and node.attr == "isin":
            return True
        if isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.Eq) and "approx" not in ast.unparse(node):
            return True
    return False


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_each_number_is_one_of_its_test(row: list[str]) -> None:
    """The functions named ask for what the row says: to the bit by ==, else within the number."""
    _, within, tests = row
    functions = [function(place) for place in re.findall(r"`([^`]+)`", tests)]
    asked = {float(number) for number in re.findall(r"1e-\d+", within)}
    assert functions and (asked or "bit" in within)
    for of in functions:
        assert asked <= tolerances(of)
        assert "bit" not in within or asserts_equality(of)


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
