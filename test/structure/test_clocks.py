"""Who reads the clock of the wall: it may be set while a machine runs, so nothing that moves depends on it."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "cnc_ptp"
WALL = {
    "time.time",
    "time.time_ns",
    "datetime.now",
    "datetime.utcnow",
    "datetime.today",
    "date.today",
    "time.localtime",
}
READS = {
    "nodes/clock.py": "the instant of the first tick, once; all stamps count cycles from it",
    "nodes/recorder.py": "when a message of somebody else arrived",
    "nodes/supervisor.py": "the stamp of an event about a process",
    "commands/look/report.py": "when a page was made",
    "commands/client/unit_table.py": "how old a message is that is shown",
}
"""Files that do, and what for. Every wait and every watchdog counts with time.monotonic."""


def read_by(file: Path) -> set[str]:
    calls = (node for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))) if isinstance(node, ast.Call))
    return {ast.unparse(call.func) for call in calls} & WALL


def test_only_stamps_come_from_the_wall_clock():
    files = [
        file for file in PACKAGE.rglob("*.py") if file.relative_to(PACKAGE).parts[0] not in ("msg", "srv", "action")
    ]
    found = {str(file.relative_to(PACKAGE)) for file in files if read_by(file)}
    assert found == {*READS}


def test_no_timer_waits_for_the_wall_clock():
    """That of a node counts with the wall clock where no other one is given: set back by an hour, it stops for an hour."""
    calls = {
        (str(file.relative_to(PACKAGE)), tuple(sorted(keyword.arg or "" for keyword in node.keywords)))
        for file in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in ("create_timer", "create_rate")
    }
    assert calls == {("nodes/process.py", ("clock",))}


def test_no_other_name_hides_a_wall_clock():
    """`from time import time` and the like would not be found above."""
    for file in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module == "time":
                assert not {alias.name for alias in node.names} & {"time", "time_ns", "localtime"}, file
