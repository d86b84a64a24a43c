"""The sources as syntax trees: who contains what, and the numbers that each file knows by name."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
GENERATED = ("msg", "srv", "action")
NUMBERS = range(17_000, 130_000)
NO_ERRORS = ("MAX_H", "MOST_VALUES", "MOST_CYCLES", "POINTS", "SAMPLE", "MVS_SLP")
"""Constants of this size that are no numbers of errors."""


class Module:
    """A source file: its tree, who contains what, and its numbers by name."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.name = path.relative_to(PACKAGE).as_posix()
        self.tree = ast.parse(path.read_text(encoding="utf-8"))
        self.parents = {child: node for node in ast.walk(self.tree) for child in ast.iter_child_nodes(node)}
        self.own = dict(self._own_numbers())
        self.numbers = dict(self.own)
        self.strings = dict(self._strings())
        self.functions = [node for node in self.parents if isinstance(node, ast.FunctionDef)]
        self.imports = list(self._imports())
        self.loops = [node for node in self.parents if isinstance(node, ast.For)]
        self.calls = [node for node in self.parents if isinstance(node, ast.Call)]

    def _assigned(self) -> Iterator[tuple[str, ast.expr]]:
        for node in self.tree.body:
            if isinstance(node, ast.Assign):
                yield from ((name.id, node.value) for name in node.targets if isinstance(name, ast.Name))
            elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is not None:
                yield node.target.id, node.value

    def _own_numbers(self) -> Iterator[tuple[str, int]]:
        for name, value in self._assigned():
            number = value.value if isinstance(value, ast.Constant) else None
            if type(number) is int and number in NUMBERS and name not in NO_ERRORS:
                yield name, number

    def _strings(self) -> Iterator[tuple[str, ast.expr]]:
        for name, value in self._assigned():
            if isinstance(value, ast.JoinedStr) or (isinstance(value, ast.Constant) and isinstance(value.value, str)):
                yield name, value

    def _imports(self) -> Iterator[tuple[str, str, str]]:
        """Module, name in it, name here."""
        for node in self.parents:
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("cnc_ptp"):
                yield from ((node.module or "", name.name, name.asname or name.name) for name in node.names)

    def function_of(self, node: ast.AST) -> ast.FunctionDef | None:
        while node in self.parents:
            node = self.parents[node]
            if isinstance(node, ast.FunctionDef):
                return node
        return None


@cache
def modules() -> Mapping[str, Module]:
    """All sources by dotted name; each knows the numbers that it imports."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        if path.parent.name not in GENERATED:
            parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = Module(path)
    for _ in range(3):  # names handed on by other modules
        for module in found.values():
            for origin, name, here in module.imports:
                source = found.get(origin)
                if source is not None and name in source.numbers:
                    module.numbers[here] = source.numbers[name]
                part = found.get(f"{origin}.{name}")
                if part is not None:
                    module.numbers.update({f"{here}.{each}": number for each, number in part.own.items()})
                if source is not None and name in source.strings:
                    module.strings.setdefault(here, source.strings[name])
    return found


@cache
def functions_of_one_name() -> Mapping[str, Module]:
    """By name those functions that exist once."""
    found: dict[str, list[Module]] = {}
    for module in modules().values():
        for function in module.functions:
            found.setdefault(function.name, []).append(module)
    return {name: where[0] for name, where in found.items() if len(where) == 1}


def called_name(call: ast.Call) -> str:
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")


def argument_names(function: ast.FunctionDef) -> list[str]:
    arguments = function.args
    return [each.arg for each in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
