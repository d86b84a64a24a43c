"""Launch files are loaded by ROS only: what they import of the package must be there all the same."""

import ast
from importlib import import_module
from pathlib import Path

import pytest

LAUNCH_FILES = sorted((Path(__file__).parents[2] / "launch").glob("*.py"))
IMPORTED = [
    (node.module, alias.name)
    for file in LAUNCH_FILES
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
    if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("cnc_ptp")
    for alias in node.names
]


@pytest.mark.parametrize(("module", "name"), IMPORTED)
def test_what_a_launch_file_imports_is_there(module: str, name: str) -> None:
    assert hasattr(import_module(module), name)


def test_launch_files_import_from_the_package() -> None:
    assert len(IMPORTED) > 3
