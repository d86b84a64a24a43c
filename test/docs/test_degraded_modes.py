"""docs/reliability.md: each degraded mode names a test that there is, and numbers that there are."""

import ast
import re
from pathlib import Path

from cnc_ptp.catalogue import catalogue

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "reliability.md").read_text(encoding="utf-8")
ROWS = PAGE.partition("## Degraded modes")[2].partition("|---")[2].partition("\n\n")[0].splitlines()[1:]


def functions(file: Path) -> set[str]:
    tree = ast.parse(file.read_text(encoding="utf-8"))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}


def test_each_line_names_tests_that_there_are():
    assert len(ROWS) > 30
    for row in ROWS:
        cells = row.strip("| ").split(" | ")
        assert len(cells) == 5, row
        tests = re.findall(r"`(test/\S+\.py)::(test_\w+)`", cells[-1])
        assert tests and all(name in functions(ROOT / file) for file, name in tests), row


def test_numbers_are_those_of_the_catalogue():
    numbers = {int(number) for row in ROWS for number in re.findall(r"\b2[0-9]{4}\b", row)}
    assert len(numbers) > 15 and numbers <= catalogue().keys()
