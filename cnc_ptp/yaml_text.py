"""YAML by libyaml, which reads and writes faster than PyYAML's own code; that serves where libyaml is missing."""

from __future__ import annotations

import math
from typing import Any

import yaml

PARSER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
WRITER: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


MOST_VALUES = 1_000_000
UNFIT = (ValueError, TypeError, AttributeError, LookupError, RecursionError)
"""What PyYAML raises besides on values that do not fit their form or tag: 2001-13-45, !!bool x, lists in lists."""


def load(text: str, parser: Any = PARSER) -> Any:
    """The content of a YAML text. Raises yaml.YAMLError."""
    try:
        return _loaded(parser(text))
    except UNFIT as error:
        raise unfit(error) from None


def _loaded(loader: Any) -> Any:
    try:
        node = loader.get_single_node()
        if node is None:
            return None
        require_few(node)
        return loader.construct_document(node)
    finally:
        loader.dispose()


def require_few(node: yaml.Node) -> None:
    """Raises yaml.YAMLError where aliases make more than `MOST_VALUES` of a few lines, or lead into themselves."""
    if number_of_values(node, {}) > MOST_VALUES:
        reason = f"its aliases make more than {MOST_VALUES} values of it"
        raise yaml.constructor.ConstructorError(None, None, reason, node.start_mark)


def number_of_values(node: yaml.Node, known: dict[int, float]) -> float:
    """Scalars and collections with each alias written out; `known`: by identity of the node."""
    if id(node) not in known:
        known[id(node)] = math.inf  # should it be in itself
        inner = [part for pair in node.value for part in pair] if isinstance(node, yaml.MappingNode) else node.value
        parts = inner if isinstance(node, yaml.CollectionNode) else []
        known[id(node)] = 1.0 + sum(number_of_values(part, known) for part in parts)
    return known[id(node)]


def unfit(error: Exception) -> yaml.YAMLError:
    """One of `UNFIT` as the error that a wrong text is."""
    return yaml.constructor.ConstructorError(None, None, f"a value cannot be read: {reason_of(error)}")


def reason_of(error: Exception) -> str:
    """Why a value cannot be read, of a `yaml.YAMLError` or one of `UNFIT`."""
    if isinstance(error, yaml.MarkedYAMLError):
        return str(error.problem)
    if isinstance(error, RecursionError):
        return "lists in lists are too deep"
    if isinstance(error, (AttributeError, LookupError)):
        return "it has not the form that its tag says"
    return str(error)
