"""Follows an expression of the sources to the texts that it may be."""

from __future__ import annotations

import ast
import re
from functools import cache
from string import Formatter
from typing import NamedTuple

from cnc_ptp.catalogue.syntax import Module, argument_names, called_name, functions_of_one_name

DEEPEST = 4
"""Calls through which a text is followed to where it is written."""
MOST = 24
"""Wordings of one expression."""


class Placeholder(NamedTuple):
    """What a text says of the case at hand."""

    name: str
    is_number: bool
    unit: str = ""
    """As it stands behind the placeholder; u: mm or deg, by the axis."""
    source: str = ""
    """The expression."""


class Template(NamedTuple):
    """One text: literal parts and placeholders in their order."""

    parts: tuple[str | Placeholder, ...]

    @property
    def text(self) -> str:
        return "".join(part if isinstance(part, str) else f"{{{part.name}}}" for part in self.parts)

    @property
    def placeholders(self) -> list[Placeholder]:
        return [part for part in self.parts if isinstance(part, Placeholder)]


class Reader:
    """Follows an expression to the texts that it may be."""

    def __init__(self, module: Module, use: ast.AST) -> None:
        self.module = module
        self.use = use

    def read(self, node: ast.expr, function: ast.FunctionDef | None, depth: int = 0) -> list[Template]:
        if isinstance(node, ast.Constant):
            return [self.constant(node)] if isinstance(node.value, str) and node.value else []
        if isinstance(node, ast.JoinedStr):
            return self.joined(node, function, depth)
        if isinstance(node, ast.IfExp):
            return self.read(node.body, function, depth) + self.read(node.orelse, function, depth)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            return crossed(self.read(node.left, function, depth), self.read(node.right, function, depth))
        if depth >= DEEPEST:
            return []
        if isinstance(node, ast.Name):
            return self.name(node, function, depth)
        if isinstance(node, ast.Call):
            return self.returned(node, depth)
        return []

    def constant(self, node: ast.Constant) -> Template:
        """A text as it is; of a fault of the language with its fields."""
        parent = self.module.parents.get(node)
        if isinstance(parent, ast.Call) and called_name(parent) == "Fault":
            return of_format(str(node.value))
        return Template((str(node.value),))

    def joined(self, node: ast.JoinedStr, function: ast.FunctionDef | None, depth: int) -> list[Template]:
        found = [Template(())]
        for index, value in enumerate(node.values):
            if isinstance(value, ast.Constant):
                found = crossed(found, [Template((str(value.value),))])
            elif isinstance(value, ast.FormattedValue):
                inner = self.inner(value, function, depth)
                behind = self.tail(node.values[index + 1 :], function)
                found = crossed(found, inner or [Template((placeholder(value, behind),))])
        return found[:MOST]

    def inner(self, value: ast.FormattedValue, function: ast.FunctionDef | None, depth: int) -> list[Template]:
        """The texts that stand in a text, where they are written here too."""
        if not isinstance(value.value, (ast.Name, ast.IfExp, ast.Constant)) or value.format_spec is not None:
            return []
        found = self.read(value.value, function, depth + 1)
        return found if len(found) <= 6 and all(" " in template.text for template in found) else []

    def tail(self, behind: list[ast.expr], function: ast.FunctionDef | None) -> str:
        """What stands behind a placeholder; a unit that is one itself as u."""
        text = ""
        for value in behind[:3]:
            if isinstance(value, ast.Constant):
                text += str(value.value)
            elif isinstance(value, ast.FormattedValue) and expression_name(value.value).endswith(("unit", "per")):
                text += self.unit(value.value, function)
            else:
                break
        return text

    def unit(self, node: ast.expr, function: ast.FunctionDef | None) -> str:
        """That a local name stands for: u/s; u where it is the axis'."""
        assigned = assigned_before(function, node) if isinstance(node, ast.Name) and function is not None else []
        for statement in assigned:
            if isinstance(statement.value, ast.JoinedStr):
                parts = statement.value.values
                return "".join(str(each.value) if isinstance(each, ast.Constant) else "u" for each in parts)
        return "u"

    def name(self, node: ast.Name, function: ast.FunctionDef | None, depth: int) -> list[Template]:
        assigned = assigned_before(function, node) if function is not None else []
        if assigned:
            found: list[Template] = []
            for statement in assigned:
                texts = self.read(statement.value, function, depth + 1)  # type: ignore[arg-type]
                found = crossed(found, texts) + found if isinstance(statement, ast.AugAssign) else found + texts
            return found
        if function is not None and node.id in argument_names(function):
            return self.given(node.id, function, depth)
        text = self.module.strings.get(node.id)
        return self.read(text, None, depth + 1) if text is not None else []

    def given(self, name: str, function: ast.FunctionDef, depth: int) -> list[Template]:
        """What the callers of a function in this file give for one of its arguments."""
        found = []
        names = argument_names(function)
        for call in self.module.calls:
            if called_name(call) != function.name:
                continue
            method = names[:1] == ["self"]
            place = names.index(name) - (1 if method else 0)
            words = {word.arg: word.value for word in call.keywords}
            given = words.get(name, call.args[place] if 0 <= place < len(call.args) else None)
            if given is not None:
                found += self.read(given, self.module.function_of(call), depth + 1)
        return found

    def returned(self, node: ast.Call, depth: int) -> list[Template]:
        """The texts that a function returns: of this file, or the only one of that name."""
        name = called_name(node)
        here = [function for function in self.module.functions if function.name == name]
        if here:
            return [template for function in here for template in self._returned(function, depth)]
        module = functions_of_one_name().get(name)
        if module is None:
            return []
        other = Reader(module, self.use)
        return [
            each for function in module.functions if function.name == name for each in other._returned(function, depth)
        ]

    def _returned(self, function: ast.FunctionDef, depth: int) -> list[Template]:
        values = [each.value for each in ast.walk(function) if isinstance(each, ast.Return) and each.value is not None]
        return [template for value in values for template in self.read(value, function, depth + 1)]


def crossed(left: list[Template], right: list[Template]) -> list[Template]:
    return [Template(a.parts + b.parts) for a in left or [Template(())] for b in right or [Template(())]][:MOST]


def assigned_before(function: ast.FunctionDef, use: ast.Name) -> list[ast.Assign | ast.AugAssign | ast.AnnAssign]:
    """The assignments to a name that count at its use: the last one, with those of the other branches beside it."""
    found = [node for node in nodes_of(function) if assigns(node, use.id) and node.lineno < use.lineno]  # type: ignore[attr-defined]
    if not found:
        return []
    found.sort(key=lambda node: node.lineno)  # type: ignore[attr-defined]
    whole = [node for node in found if not isinstance(node, ast.AugAssign)] or found
    last = whole[-1]
    start = last.lineno  # type: ignore[attr-defined]
    for branch in nodes_of(function):
        if isinstance(branch, (ast.If, ast.Match, ast.For)) and encloses(branch, last) and not encloses(branch, use):
            start = min(start, branch.lineno)
    return [node for node in found if node.lineno >= start]  # type: ignore[attr-defined, misc]


@cache
def nodes_of(tree: ast.AST) -> list[ast.AST]:
    return list(ast.walk(tree))


def assigns(node: ast.AST, name: str) -> bool:
    if isinstance(node, ast.Assign):
        return any(isinstance(target, ast.Name) and target.id == name for target in node.targets)
    targets = (ast.AugAssign, ast.AnnAssign)
    return isinstance(node, targets) and isinstance(node.target, ast.Name) and node.target.id == name


def encloses(outer: ast.stmt, node: ast.AST) -> bool:
    line: int = getattr(node, "lineno", 0)
    return outer.lineno <= line <= (outer.end_lineno or 0)


UNIT = re.compile(
    r" ((?:mm|deg|u)(?:/s[²³]?|/min|/rev)?|s|ms|µs|rpm|%|°/s²?|°|Nm|N|1/s|rad/s|cycles?|blocks?|digits|revolutions)"
    r"(?![\w/])"
)
NUMBER_FORMAT = re.compile(r"[\d.,+]*[gfed%xX]$")
READ = ("shown", "number", "state_name", "round", "abs", "float", "int", "str", "visible", "len", "repr")
"""Functions that show their argument."""


def of_format(text: str) -> Template:
    """The template of a fault of the language, which is filled by `str.format`."""
    parts: list[str | Placeholder] = []
    pieces = list(Formatter().parse(text))
    for index, (literal, name, _, _) in enumerate(pieces):
        if literal:
            parts.append(literal)
        if name is not None:
            unit = UNIT.match(pieces[index + 1][0] if index + 1 < len(pieces) else "")
            parts.append(Placeholder(name, bool(unit) or name in COUNTS, unit[1] if unit else "", name))
    return Template(tuple(parts))


COUNTS = ("limit", "count", "depth", "length", "line", "index", "low", "high")
"""Names of numbers without a unit."""


def placeholder(value: ast.FormattedValue, behind: str) -> Placeholder:
    unit = UNIT.match(behind)
    spec = "".join(
        str(part.value) for part in getattr(value.format_spec, "values", []) if isinstance(part, ast.Constant)
    )
    is_number = bool(unit or NUMBER_FORMAT.match(spec)) or called_by_number(value.value)
    name, source = expression_name(value.value), ast.unparse(plain(value.value))
    return Placeholder(name, is_number, unit[1] if unit else "", source)


def plain(node: ast.expr) -> ast.expr:
    """Without the functions that only show it."""
    while isinstance(node, ast.Call) and called_name(node) in READ and node.args:
        node = node.args[0]
    return node


def called_by_number(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and called_name(node) in ("number", "len", "round")


def expression_name(node: ast.expr) -> str:
    """A word for an expression: the last name in it that says what it is."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        base = expression_name(node.value)
        return f"{base}_{node.attr}" if base and base not in ("self", "axis", "spindle") else node.attr.lstrip("_")
    if isinstance(node, ast.Call):
        name = called_name(node)
        if name in READ and node.args:
            return expression_name(node.args[0])
        return expression_name(node.args[0]) if name == "join" and node.args else name.lstrip("_")
    if isinstance(node, ast.BinOp):
        return expression_name(node.left) or expression_name(node.right)
    if isinstance(node, ast.Subscript):
        return expression_name(node.value)
    if isinstance(node, ast.UnaryOp):
        return expression_name(node.operand)
    if isinstance(node, ast.IfExp):
        return expression_name(node.body) or expression_name(node.orelse) or "which"
    if isinstance(node, (ast.GeneratorExp, ast.ListComp)):
        return expression_name(node.generators[0].iter)
    if isinstance(node, ast.BoolOp):
        return expression_name(node.values[0])
    return "text" if isinstance(node, ast.Constant) else ""
