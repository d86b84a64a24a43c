"""The stages of parameters/: each imports only from those before it."""

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "cnc_ptp" / "parameters"
STAGES = ("errors", "list_units", "declare", "read", "view", "check", "loader", "changed", "lists")
"""From the ground up."""


def imported(file: Path) -> set[str]:
    """The stages that a module imports from."""
    nodes = [node for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))) if isinstance(node, ast.ImportFrom)]
    modules = [f"{node.module}.{alias.name}" for node in nodes for alias in node.names]
    prefix = "cnc_ptp.parameters."
    return {module.removeprefix(prefix).split(".")[0] for module in modules if module.startswith(prefix)}


@pytest.mark.parametrize("stage", STAGES)
def test_a_stage_imports_only_from_those_before_it(stage: str) -> None:
    files = [*PACKAGE.glob(f"{stage}.py"), *(PACKAGE / stage).glob("*.py")]
    assert files
    below = set(STAGES[: STAGES.index(stage) + 1])
    assert not {f"{file.name} imports {other}" for file in files for other in imported(file) - below}


def test_every_module_has_its_stage() -> None:
    names = {path.stem for path in PACKAGE.iterdir() if path.name != "__pycache__"}
    assert names == {"__init__", *STAGES}
