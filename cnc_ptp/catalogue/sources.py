"""What the sources can raise: every place with its number and texts, read from the syntax trees.

Used by the generator of texts.yaml and by tests; nothing that runs a machine reads it.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from cnc_ptp.catalogue.reader import Placeholder, Reader, Template, assigned_before, expression_name, plain
from cnc_ptp.catalogue.syntax import Module, called_name, modules

LITERALS = range(20_000, 130_000)
OTHER_CODES = ("ServiceError", "Idn")
"""What is made with numbers of SERCOS."""
RAISED_BY_LITERAL = ("Fault", "CncError")
NO_VALUES = ("where", "error_id", "values", "path_stop")
"""Keywords of calls that are no values of the text."""
MADE = ("lag_values", "beyond", "_missed_by")
"""Functions that put values together."""
TEXTS = ("text", "reason", "note", "message", "short", "warning", "missing", "why_too_far", "step")
"""Names of what is a text."""


class Site(NamedTuple):
    """A place where a number is raised: the texts that it may have there, and the names of the values it gives."""

    number: int
    file: str
    line: int
    function: str
    call: str
    """What is called with it."""
    templates: tuple[Template, ...]
    values: frozenset[str]
    """Keywords of the call; with `**` for those handed on."""


def sites() -> list[Site]:
    """Every place where a number is raised, by number."""
    found = [site for module in modules().values() for site in sites_of(module)]
    return sorted(found, key=lambda site: (site.number, site.file, site.line))


def sites_of(module: Module) -> Iterator[Site]:
    for node in module.parents:
        number = number_of(module, node)
        if number is None:
            continue
        parent = module.parents.get(node)
        if isinstance(parent, ast.keyword):
            if parent.arg not in ("error_id", "number"):
                continue
            parent = module.parents[parent]
        if isinstance(parent, ast.Call):
            called = ast.unparse(parent.func)
            literal = isinstance(node, ast.Constant)
            if called in OTHER_CODES or (
                literal and (parent.args[0] is not node or called not in ("Fault", "CncError"))
            ):
                continue
            texts = [*parent.args, *(word.value for word in parent.keywords if word.arg == "effect")]
            yield site_of(module, node, number, called, texts, names_of(module, parent))
        elif isinstance(node, ast.Constant):
            yield from sites_of_row(module, node, parent)
        elif isinstance(parent, (ast.IfExp, ast.Assign)):
            yield from sites_of_name(module, number, parent)
        elif isinstance(parent, ast.arguments):
            yield from sites_of_default(module, node, number, parent)
        elif isinstance(parent, (ast.Tuple, ast.Return, ast.FormattedValue)):
            texts = list(getattr(parent, "elts", []))
            values = {name: source for each in texts for name, source in names_in(module, each).items()}
            if isinstance(parent, ast.FormattedValue):
                texts = [module.parents[parent]]  # type: ignore[list-item]
            yield site_of(module, node, number, type(parent).__name__, texts, values)


def sites_of_row(module: Module, node: ast.Constant, parent: ast.AST | None) -> Iterator[Site]:
    """A number in a table: of a dict whose items a loop reports, or of rows of which faults are made."""
    if isinstance(parent, ast.Dict) and node in parent.values:
        table = module.parents.get(parent)
        if isinstance(table, ast.Assign) and isinstance(table.targets[0], ast.Name):
            for other in modules().values():
                yield from sites_of_table(other, node, table.targets[0].id)
    elif isinstance(parent, ast.Tuple):
        above: ast.AST | None = parent
        while above is not None and not isinstance(above, ast.DictComp):
            above = module.parents.get(above)
        if isinstance(above, ast.DictComp) and isinstance(above.value, ast.Call):
            yield site_of(module, node, node.value, called_name(above.value), above.value.args[1:], {})  # type: ignore[arg-type]


def sites_of_default(module: Module, node: ast.AST, number: int, arguments: ast.arguments) -> Iterator[Site]:
    """The number of calls that give none."""
    function = module.parents[arguments]
    words = [each.arg for each, given in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True) if given is node]
    for other in modules().values():
        for call in other.calls:
            if called_name(call) == getattr(function, "name", "") and not any(
                word.arg in words for word in call.keywords
            ):
                yield site_of(
                    other, call, number, called_name(call), call.args, {word.arg or "**": "" for word in call.keywords}
                )


def sites_of_table(module: Module, node: ast.Constant, table: str) -> Iterator[Site]:
    """Where a loop over the items of a table of numbers reports them."""
    for loop in module.loops:
        if ast.unparse(loop.iter) == f"{table}.items()":
            names = [each.id for each in ast.walk(loop.target) if isinstance(each, ast.Name)]
            for call in ast.walk(loop):
                words = [word for word in getattr(call, "keywords", []) if word.arg == "error_id"]
                if isinstance(call, ast.Call) and words and ast.unparse(words[0].value) in names:
                    values = names_of(module, call)
                    yield site_of(module, call, node.value, called_name(call), call.args, values)  # type: ignore[arg-type]


def sites_of_name(module: Module, number: int, parent: ast.AST) -> Iterator[Site]:
    """A number that is chosen before it is reported: the calls that get the name, or the call that it is in."""
    above = module.parents.get(parent) if isinstance(parent, ast.IfExp) else parent
    function = module.function_of(parent)
    if isinstance(above, ast.Call):
        yield site_of(module, parent, number, ast.unparse(above.func), above.args, {})
    elif function is not None and isinstance(above, ast.Assign):
        name = ast.unparse(above.targets[0])
        for call in ast.walk(function):
            if isinstance(call, ast.Call) and any(ast.unparse(each) == name for each in call.args):
                yield site_of(module, call, number, ast.unparse(call.func), call.args, names_of(module, call))


def number_of(module: Module, node: ast.AST) -> int | None:
    if isinstance(node, ast.Constant):
        return node.value if type(node.value) is int and node.value in LITERALS else None
    if isinstance(node, ast.Name):
        return module.numbers.get(node.id)
    return module.numbers.get(ast.unparse(node)) if isinstance(node, ast.Attribute) else None


def site_of(
    module: Module, node: ast.AST, number: int, called: str, texts: list[ast.expr], values: Mapping[str, str]
) -> Site:
    function = module.function_of(node)
    names = {source: name for name, source in values.items() if name != "**"}
    found = []
    for text in texts:
        if text is not node:
            found += [named(template, names) for template in Reader(module, node).read(text, function)]
    wanted = [template for template in found if " " in template.text] or told_elsewhere(texts, node)
    name = function.name if function is not None else ""
    return Site(number, module.name, node.lineno, name, called, tuple(dict.fromkeys(wanted)), frozenset(values))  # type: ignore[attr-defined]


def names_of(module: Module, call: ast.Call) -> dict[str, str]:
    """The names under which a call gives the values of its text, and their expressions; `**` for those handed on."""
    named = [(word.arg, word.value) for word in call.keywords if word.arg and word.arg not in NO_VALUES]
    found = {name: ast.unparse(plain(value)) for name, value in named}
    given = [word.value for word in call.keywords if word.arg in ("values", None)] + call.args
    for each in given:
        found |= names_in(module, each)
    return found


def names_in(module: Module, node: ast.expr) -> dict[str, str]:
    """Of a dict, or of a local name for one."""
    if isinstance(node, ast.Dict):
        keys = [key.value if isinstance(key, ast.Constant) else "**" for key in node.keys]
        return {str(key): ast.unparse(plain(value)) for key, value in zip(keys, node.values, strict=True)}
    if isinstance(node, ast.IfExp):
        return names_in(module, node.body) | names_in(module, node.orelse)
    function = module.function_of(node)
    if isinstance(node, ast.Name) and function is not None and node.id in ("values", "named"):
        found: dict[str, str] = {}
        for statement in assigned_before(function, node):
            found |= {"**": ""} if statement.value is None else names_in(module, statement.value)
        return found or {"**": node.id}
    handed_on = isinstance(node, (ast.Attribute, ast.Name)) and ast.unparse(node).endswith(("values", "named"))
    made = isinstance(node, ast.Call) and called_name(node) in MADE
    return {"**": ast.unparse(node)} if handed_on or made else {}


def told_elsewhere(texts: list[ast.expr], node: ast.AST) -> list[Template]:
    """A text that comes from elsewhere: of a program, of a library, of a function that puts it together."""
    given = [text for text in texts if text is not node and isinstance(text, (ast.Name, ast.Attribute, ast.Call))]
    named_so = [text for text in given if expression_name(text).split("_")[-1] in TEXTS]
    return [Template((Placeholder(expression_name(text).split("_")[-1], is_number=False),)) for text in named_so[:1]]


def named(template: Template, names: Mapping[str, str]) -> Template:
    """With the names under which the raise site gives the values."""
    parts = [
        part if isinstance(part, str) else part._replace(name=names.get(part.source.lstrip("-"), part.name))
        for part in template.parts
    ]
    return Template(tuple(parts))
