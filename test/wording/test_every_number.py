"""Each number of an error or warning has its text in a test, so that no text changes unseen."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

TEST = Path(__file__).parents[1]
KERNEL = TEST.parent / "cnc_ptp"
GENERATED = ("msg", "srv", "action")
NUMBERS = range(17_000, 130_000)
IN_TEXT = re.compile(r"\b(\d{5,6})[: ] ?\S+ \S+ \S+")
"""A number with the words that follow it."""
APART = {
    22024: "channel/test_channel_held.py",
    22025: "channel/test_channel_spindle_ends.py",
    22026: "axis/test_feed_release.py",
    22045: "channel/test_program_start.py",
    22050: "channel/test_measuring.py",
    22053: "channel/test_measuring.py",
    25102: "plc/test_setpoint_file.py",
    26103: "graph/test_client.py",
    26124: "catalogue/test_catalogue.py",
    26118: "graph/test_slaves.py",
    26119: "graph/test_spindles.py",
    26142: "graph/test_gap.py",
    26195: "recording/test_on_demand.py",
    26196: "graph/test_recording_on_demand.py",
    26220: "client/test_recorder.py",
}
"""Tests that hold the number and its text apart from each other."""


def is_number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) is int and node.value in NUMBERS


def defined_in(tree: ast.Module) -> Iterator[int]:
    """Numbers that have a name, and those that an error is raised with."""
    named = [node.value for node in tree.body if isinstance(node, ast.Assign)]
    first = [node.args[0] for node in ast.walk(tree) if isinstance(node, ast.Call) and node.args]
    raised = [node for node in first if is_number(node) and node.value >= 20_000]
    return (node.value for node in [*named, *raised] if is_number(node))


def text_of(node: ast.AST) -> str:
    """Of a string with its replacement fields left out; empty for anything else."""
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def worded_in(tree: ast.Module) -> Iterator[int]:
    """Numbers within a text, and numbers beside one, or its name, in a tuple, list or call."""
    named = set(names_of_texts(tree))
    for node in ast.walk(tree):
        yield from map(int, IN_TEXT.findall(text_of(node)))
        beside = node.args if isinstance(node, ast.Call) else getattr(node, "elts", [])
        if any(is_text(part) or getattr(part, "id", "") in named for part in beside):
            yield from (part.value for part in beside if is_number(part))


def is_text(node: ast.AST) -> bool:
    return text_of(node).count(" ") >= 2


def names_of_texts(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and is_text(node.value):
            yield from (target.id for target in node.targets if isinstance(target, ast.Name))


def trees(folder: Path) -> Iterator[ast.Module]:
    for path in folder.rglob("*.py"):
        if path.parent.name not in GENERATED:
            yield ast.parse(path.read_text(encoding="utf-8"))


def programs() -> Iterator[int]:
    """Numbers in the bad programs of test/nc, each with its text."""
    for path in (TEST / "nc").rglob("*.nc"):
        yield from map(int, IN_TEXT.findall(path.read_text(encoding="utf-8", errors="replace")))


def test_each_number_has_its_text_in_a_test() -> None:
    defined = {number for tree in trees(KERNEL) for number in defined_in(tree)}
    worded = {number for tree in trees(TEST) for number in worded_in(tree)} | {*programs()}
    assert len(defined) > 300
    assert defined - worded == set(APART)


def test_what_is_held_apart_is_there() -> None:
    for number, name in APART.items():
        assert str(number) in (TEST / name).read_text(encoding="utf-8"), name
