"""The floors of the house: a folder imports only from folders below it, and modules never import in a circle."""

import ast
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "cnc_ptp"
GENERATED = ("msg", "srv", "action")
FLOORS = (
    "errors", "motion", "parameters", "protocol", "control", "spindle", "nc", "path", "axis", "channel", "plc",
    "machine", "recording", "plots", "commissioning", "interrupt", "ros_arguments", "number_range", "nodes", "commands",
    "cli", "__main__",
)  # fmt: skip
"""From the ground up; docs/architecture.md says what each of them is."""


def modules() -> dict[str, Path]:
    """Every module of the package, without what is generated."""
    files = {file.relative_to(PACKAGE.parent): file for file in PACKAGE.rglob("*.py")}
    names = {".".join(path.with_suffix("").parts).removesuffix(".__init__"): file for path, file in files.items()}
    return {name: file for name, file in names.items() if floor(name) not in GENERATED}


def floor(module: str) -> str:
    """Folder or single file of the package that a module belongs to."""
    return module.split(".")[1] if "." in module else ""


def imports(file: Path, known: dict[str, Path]) -> Iterator[str]:
    """Modules of the package that a file imports when it is loaded or later."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom) and node.module in known:
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            yield from [name for name in inner if name in known] or [node.module]


def graph() -> dict[str, set[str]]:
    known = modules()
    return {name: set(imports(file, known)) - {name} for name, file in known.items()}


def test_every_folder_has_its_floor():
    assert {floor(name) for name in modules()} - {""} == set(FLOORS)


def test_imports_go_downwards_only():
    height = {name: index for index, name in enumerate(FLOORS)}
    upward = [
        f"{name} imports {other}"
        for name, others in graph().items()
        for other in others
        if floor(other) and height[floor(other)] > height[floor(name)]
    ]
    assert not upward


def test_no_import_circle():
    list(TopologicalSorter(graph()).static_order())


def test_the_kernel_imports_neither_ros_nor_plots():
    """Only nodes, and the commands above them, know rclpy and the interfaces generated for it."""
    foreign = ("rclpy", "cnc_ptp.msg", "cnc_ptp.srv", "cnc_ptp.action", "plotly")
    kernel = FLOORS[: FLOORS.index("recording")]
    for name, file in modules().items():
        if floor(name) in kernel:
            assert not [
                word for word in foreign if f"import {word}" in (text := file.read_text()) or f"from {word}" in text
            ]
