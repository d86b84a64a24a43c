"""The floors of the house: a folder imports only from folders below it, and modules never import in a circle."""

import ast
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "cnc_ptp"
GENERATED = ("msg", "srv", "action")
FLOORS = (
    "compiled", "one_thread", "errors", "yaml_text", "long_text", "garbage", "plain_values", "catalogue", "motion", "parameters", "protocol", "control", "spindle", "kinematics", "nc", "path", "axis", "channel",
    "plc", "machine", "state", "wire", "recording", "plots", "commissioning", "sweep", "interrupt", "ros_arguments", "number_range", "start_options", "nodes", "client", "web", "commands",
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
        if floor(name) and floor(other) and height[floor(other)] > height[floor(name)]
    ]
    assert not upward


def test_no_import_circle():
    list(TopologicalSorter(graph()).static_order())


ROS = {"rclpy", *(f"cnc_ptp.{name}" for name in GENERATED)}
PLOTS = {"plotly"}


def named(code: str) -> set[str]:
    """Every module, and every name of a package, that a code imports, with the packages that it is in."""
    found = set()
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return {".".join(name.split(".")[: n + 1]) for name in found for n in range(name.count(".") + 1)}


@pytest.mark.parametrize(("foreign", "first"), [(ROS, "nodes"), (PLOTS, "recording")])
def test_what_only_upper_floors_may_import(foreign: set[str], first: str) -> None:
    """Nodes and the floors above them know rclpy and the interfaces generated for it; the kernel knows no plots."""
    below = FLOORS[: FLOORS.index(first)]
    importing = [name for name, file in modules().items() if floor(name) in below and named(file.read_text()) & foreign]
    assert importing == []


@pytest.mark.parametrize(
    "code",
    ["import rclpy.node", "from rclpy.node import Node", "from cnc_ptp import msg", "from cnc_ptp.srv import Stop"],
)
def test_every_form_of_an_import_is_found(code: str) -> None:
    assert named(code) & ROS
