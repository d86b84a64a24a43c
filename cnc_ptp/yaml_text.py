"""YAML by libyaml, which reads and writes faster than PyYAML's own code; that serves where libyaml is missing."""

from __future__ import annotations

from typing import Any

import yaml

PARSER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
WRITER: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


UNFIT = (ValueError, TypeError, AttributeError, LookupError, RecursionError)
"""What PyYAML raises besides on values that do not fit their form or tag: 2001-13-45, !!bool x, lists in lists."""


def load(text: str, parser: Any = PARSER) -> Any:
    """The content of a YAML text. Raises yaml.YAMLError."""
    try:
        return yaml.load(text, Loader=parser)
    except UNFIT as error:
        raise unfit(error) from None


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
