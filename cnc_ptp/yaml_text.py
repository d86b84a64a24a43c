"""YAML by libyaml, which reads and writes faster than PyYAML's own code; that serves where libyaml is missing."""

from __future__ import annotations

from typing import Any

import yaml

PARSER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
WRITER: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def load(text: str) -> Any:
    """The content of a YAML text. Raises yaml.YAMLError."""
    return yaml.load(text, Loader=PARSER)
