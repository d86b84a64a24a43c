"""JSON schema of machine files for editors: `python -m cnc_ptp.commands.machine_schema > tools/machine.schema.json`.

A name may be nested (`getriebe: {"0": {kv: 1000}}`), dotted (`getriebe.0.kv`) or written as in the lists
(`getriebe[0].kv`), in any mixture; so each level permits the rest of a name, too. What depends on other values (limits
that are parameters, units that /machine lists) is left to `cnc_ptp params check`.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator, Mapping
from typing import Any

from cnc_ptp.parameters.declare.declarations import Declaration, Limit, ParameterValue, catalogue
from cnc_ptp.parameters.declare.ranges import default_text, range_text
from cnc_ptp.parameters.declare.reference import change_text, unit_text

Schema = dict[str, Any]
Tree = dict[str, Any]
"""Part of a name -> the tree behind it, or the declaration; `*` is an index."""
DIALECT = "http://json-schema.org/draft-07/schema#"
"""Of which editors know every word."""
UNITS = ("channel", "axis", "spindle")
NODE_NAME = "^/?(?!machine$)[a-z][a-z0-9_]*$"


def machine_schema() -> Schema:
    """Of a whole machine file: /machine, and any number of channels, axes and spindles."""
    machine = tree_of(catalogue().of_node("machine"))
    units = tree_of(entry for kind in UNITS for entry in catalogue().of_node(kind))
    definitions: dict[str, Schema] = {}
    for name, tree in (("machine", machine), ("unit", units)):
        define(name, "", tree, definitions)
    for entry in catalogue().by_id.values():
        definitions[entry.id] = value_schema(entry)
    node = {name: section(f"#/definitions/{name}", text) for name, text in SECTIONS.items()}
    return {
        "$schema": DIALECT,
        "title": "Machine file of cnc_ptp",
        "description": "A ROS parameters file: one section per node. Made by `make docs`; do not edit.",
        "type": "object",
        "properties": {"/machine": node["machine"], "machine": node["machine"]},
        "patternProperties": {NODE_NAME: node["unit"]},
        "additionalProperties": False,
        "definitions": definitions,
    }


SECTIONS = {
    "machine": "The machine: which channels, axes and spindles there are, cycle times.",
    "unit": "A channel, an axis or a spindle that /machine lists.",
}


def section(reference: str, text: str) -> Schema:
    """The section of a node; /machine alone has the other schema."""
    parameters = {"anyOf": [{"$ref": reference}, {"type": "null"}]}
    return {
        "description": text,
        "type": ["object", "null"],
        "properties": {"ros__parameters": parameters},
        "additionalProperties": False,
    }


def tree_of(declarations: Iterator[Declaration]) -> Tree:
    tree: Tree = {}
    for entry in declarations:
        *path, last = entry.key.split(".")
        place = tree
        for segment in path:
            place = place.setdefault(segment, {})
        place[last] = entry
    return tree


def define(name: str, array: str, tree: Tree, definitions: dict[str, Schema]) -> None:
    """Adds the schema of an object and of all objects in it; `array`: the name before an index."""
    properties: dict[str, Schema] = {}
    patterns: dict[str, Schema] = {}
    for path, inner in paths(tree):
        target = {"$ref": f"#/definitions/{reference(name, path, inner)}"}
        if "*" in path:
            patterns[f"^{pattern(path, array)}$"] = target
        else:
            properties[".".join(path)] = target
    schema: Schema = {"type": "object", "properties": properties, "additionalProperties": False}
    definitions[name] = {**schema, **({"patternProperties": patterns} if patterns else {})}
    for segment, inner in tree.items():
        if isinstance(inner, dict):
            define(f"{name}.{segment}", segment, inner, definitions)


def paths(tree: Tree, before: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Every place in a tree by the parts of its name, the near ones first."""
    for segment, inner in tree.items():
        yield (*before, segment), inner
    for segment, inner in tree.items():
        if isinstance(inner, dict):
            yield from paths(inner, (*before, segment))


def reference(name: str, path: tuple[str, ...], inner: Any) -> str:
    return inner.id if isinstance(inner, Declaration) else ".".join((name, *path))


def pattern(path: tuple[str, ...], array: str) -> str:
    """Regular expression of a name: getriebe.0.kv and getriebe[0].kv."""
    text, before = "", array
    for segment in path:
        if segment == "*":
            index = up_to(catalogue().arrays[before].size - 1)
            text += f"(?:\\.(?:{index})|\\[(?:{index})\\])" if text else f"(?:{index})"
        else:
            text += ("\\." if text else "") + re.escape(segment)
        before = segment
    return text


def up_to(largest: int) -> str:
    """Regular expression of the decimal numbers 0 … largest."""
    digits = str(largest)
    shorter = ["[0-9]", *(f"[1-9][0-9]{{{length - 1}}}" for length in range(2, len(digits)))]
    return "|".join((shorter if len(digits) > 1 else []) + same_length(digits, 1 if len(digits) > 1 else 0))


def same_length(digits: str, lowest: int) -> list[str]:
    """Alternatives for the numbers of as many digits that are not larger."""
    if not digits:
        return [""]
    first, rest = int(digits[0]), digits[1:]
    below = f"[{lowest}-{first - 1}]" + "[0-9]" * len(rest) if first > lowest else ""
    return ([below] if below else []) + [digits[0] + tail for tail in same_length(rest, 0)]


# one value


def value_schema(entry: Declaration) -> Schema:
    """Type, range, choices, default and text of a parameter."""
    default: ParameterValue | list[str] = list(entry.default) if isinstance(entry.default, tuple) else entry.default
    kinds = {"int": number, "float": number, "bool": switch, "string": text, "strings": names}
    schema = kinds[entry.type](entry)
    if entry.unset is not None:
        schema = {"anyOf": [schema, {"const": entry.unset, "description": "not configured"}]}
    return {"description": description(entry), "default": default, **schema}


def description(entry: Declaration) -> str:
    unit, limits = unit_text(entry), range_text(entry)
    facts = [
        f"Unit {unit}." if unit else "",
        f"Range {limits}." if limits else "",
        f"Default {default_text(entry.default)}.",
        f"Axis types {entry.axes}." if entry.axes else "",
        f"Drive types {entry.drives}." if entry.drives else "",
        f"A change takes effect {change_text(entry)}.",
        "" if entry.effective else "Without effect in this version.",
    ]
    return f"{entry.id} {entry.name}\n{entry.text}\n" + " ".join(fact for fact in facts if fact)


def number(entry: Declaration) -> Schema:
    if entry.choices:
        return {"enum": list(entry.choices), "enumDescriptions": [str(text) for text in entry.choices.values()]}
    schema: Schema = {"type": "integer" if entry.type == "int" else "number"}
    schema |= bounds(entry.lower, "minimum", "exclusiveMinimum") | bounds(entry.upper, "maximum", "exclusiveMaximum")
    if entry.names:
        return {"anyOf": [schema, {"type": "string", "pattern": joined(entry.names)}]}
    return schema


def bounds(limits: tuple[Limit, ...], inclusive: str, exclusive: str) -> Schema:
    """Those that are numbers; at most one of each kind."""
    numbers = [limit for limit in limits if not isinstance(limit.value, str)]
    return {inclusive if limit.inclusive else exclusive: limit.value for limit in numbers}


def switch(entry: Declaration) -> Schema:
    return {"enum": [True, False, 1, 0]}


def text(entry: Declaration) -> Schema:
    if entry.flags:
        constants: list[Schema] = [{"enum": list(entry.choices)}, {"type": "string", "pattern": joined(entry.choices)}]
        return {"anyOf": [*constants, {"type": "integer", "minimum": 0}]}
    if entry.choices:
        return {"enum": [*entry.choices, *entry.choices.values()]}
    schema: Schema = {"type": "string"}
    if entry.form:
        schema["pattern"] = f"^(?:{entry.form})$"
    if entry.max_length:
        schema["maxLength"] = entry.max_length
    return schema


def joined(constants: Mapping[str, int]) -> str:
    """Regular expression of constants joined by |, and of 0x… as text."""
    one = "|".join([*constants, "0x[0-9a-fA-F]+"])
    return f"^\\s*(?:{one})\\s*(?:\\|\\s*(?:{one})\\s*)*$"


def names(entry: Declaration) -> Schema:
    return {"type": "array", "items": {"type": "string"}}


def schema_json(schema: Schema) -> str:
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(schema_json(machine_schema()))
