"""The value of a line: its text as YAML, and a value of a machine file as the text of a line."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from cnc_ptp.parameters.declare.declarations import Declaration, ParameterValue
from cnc_ptp.parameters.lists.lines import comment_text
from cnc_ptp.parameters.lists.text import FOREIGN
from cnc_ptp.parameters.read.source import BOOLEANS, INTEGER, NULLS, NUMBER
from cnc_ptp.parameters.read.values import BadValue, constants

_QUOTED: Final = r'"(?:[^"]|"")*"'
_END: Final = r"(?=\s|#|$)"
_WORD: Final = re.compile(rf"({_QUOTED}|[^\s#\"]+){_END}")
_FLAGS: Final = re.compile(rf"({_QUOTED}|[^\s#|\"]+(?:\s*\|\s*[^\s#|\"]+)*){_END}")
_ITEM: Final = rf"(?:{_QUOTED}|[^\s#,\"]+)"
_ITEMS: Final = re.compile(rf"(\[\]|{_ITEM}(?:\s*,\s*{_ITEM})*){_END}")
_ONE_ITEM: Final = re.compile(rf"({_ITEM})(?:\s*,\s*|$)")
_PLAIN: Final = re.compile(r"[A-Za-z_][\w./-]*(?: \| [A-Za-z_]\w*)*", re.ASCII)
_BARE: Final = re.compile(r'[^\s#"]+')
NO_VALUE: Final = "it has no value; write one behind the name, or delete the line"
NO_ITEMS: Final = "[]"
"""An empty list of names."""


class BadLine(Exception):
    """A line whose value cannot be told from the rest; carries the reason, with the remedy."""


class Written(NamedTuple):
    """The value of a line as it is written, and the remark behind it."""

    value: str
    remark: str


def split_value(declaration: Declaration, rest: str) -> Written:
    """Value and remark of what stands behind a name. Raises BadLine."""
    if not rest or rest.startswith("#"):
        raise BadLine(NO_VALUE)
    pattern = _ITEMS if declaration.type == "strings" else _FLAGS if has_flags(declaration) else _WORD
    found = pattern.match(rest)
    if found is None:
        if '"' in rest:
            raise BadLine('a quote is not closed, or no blank is behind it; write "text" and "" for a quote in it')
        raise BadLine("its value cannot be read; write a name, a number or a text in quotes")
    remark = rest[found.end() :].strip()
    if remark.startswith("|") and has_flags(declaration):
        raise BadLine("a constant is missing behind |")
    return Written(found[1], comment_text(remark))


def has_flags(declaration: Declaration) -> bool:
    """Whether constants may be joined."""
    return declaration.flags or bool(declaration.names)


def said_otherwise(declaration: Declaration, written: Written) -> str:
    """What the remark says of a constant where value and remark have it as number and as name: MOS 0x00000001.

    Empty if both mean the same, or the remark is another one.
    """
    remark = _FLAGS.match(written.remark)
    if not declaration.choices or declaration.type != "string" or remark is None:
        return ""
    try:
        value, said = (constants(declaration, unquoted(text)) for text in (written.value, remark[1]))
    except BadValue:
        return ""
    return said if said != value else ""


def unquoted(text: str) -> str:
    return text[1:-1].replace('""', '"') if text.startswith('"') else text


def to_yaml(declaration: Declaration, value: str) -> str:
    """A value as YAML that reads as the type that it is written in; what does not fit is refused when that is read."""
    if declaration.type == "strings":
        items = [] if value == NO_ITEMS else _ONE_ITEM.findall(value)
        return f"[{', '.join(yaml_text(unquoted(item)) for item in items)}]"
    number = plain_number(value)
    if number and not (declaration.type == "string" and not declaration.choices):
        return number
    if declaration.type == "bool" and value.lower() in ("true", "false"):
        return value.lower()
    text = unquoted(value)
    return yaml_text(" | ".join(part.strip() for part in text.split("|")) if has_flags(declaration) else text)


def plain_number(value: str) -> str:
    """A number as YAML here has it, decimal without zeros before it, 0x in small letters; empty if it is none."""
    if re.fullmatch("0[xX][0-9a-fA-F]+", value):
        return f"0x{value[2:]}"
    value = re.sub(r"^([-+]?)0+(?=[0-9]+$)", r"\1", value, flags=re.ASCII)
    return value if INTEGER.fullmatch(value) or NUMBER.fullmatch(value) else ""


def yaml_text(text: str) -> str:
    """A text as YAML scalar; what YAML or ROS would read as something else is quoted."""
    word = text.lower()
    if _PLAIN.fullmatch(text) and word not in BOOLEANS and word not in NULLS and word not in ("y", "n"):
        return text
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def to_list(declaration: Declaration, value: ParameterValue, raw: str) -> str:
    """A value of a machine file as a line has it; `raw` is how a number is written there. Raises ValueError.

    The error is for a text with characters that a list cannot hold.
    """
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, tuple):
        return ", ".join(list_text(item, also=",") for item in value) or NO_ITEMS
    if isinstance(value, str):
        return value if has_flags(declaration) and declaration.choices else list_text(value)
    constants = declaration.names and "|" not in (raw[:1], raw[-1:]) and _FLAGS.fullmatch(raw)
    return raw if constants or plain_number(raw) == raw != "" else repr(value)


def list_text(text: str, *, also: str = "") -> str:
    """Bare, or in quotes where it is empty or has blanks, quotes, # or characters of `also`. Raises ValueError."""
    if FOREIGN.search(text):
        raise ValueError(text)
    bare = _BARE.fullmatch(text) and text != NO_ITEMS and not (also and also in text)
    return text if bare else '"' + text.replace('"', '""') + '"'
