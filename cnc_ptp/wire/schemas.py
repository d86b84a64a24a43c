"""ROS 2 message definitions: the `ros2msg` schema text that MCAP embeds, and its fields.

A schema text is the .msg file of the type followed by the .msg files of all types it uses, each after a line of `=` and
a line `MSG: package/Name` (MCAP registry, schema encoding `ros2msg`).
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, cast

from mcap.records import Schema as McapSchema
from mcap_ros2.decoder import DecoderFactory

import cnc_ptp
from cnc_ptp.errors import CncError

UNKNOWN_TYPE = 26005
DIVIDER = "=" * 80
PRIMITIVES = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}  # ROS type -> code of the struct module
_FIELD = re.compile(
    r"(?P<type>[A-Za-z]\w*(/[A-Za-z]\w*)?)(<=\d+)?(?P<array>\[(<=)?\d*\])?\s+(?P<name>[A-Za-z]\w*)(?P<rest>.*)"
)


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message. `length`: None a single value, -1 a sequence (bounded or not), n a fixed array."""

    name: str
    type: str
    length: int | None = None


@dataclass(frozen=True, slots=True)
class Schema:
    """A message type with the fields of every type it uses; keys are `package/Name`."""

    name: str
    text: str
    types: dict[str, tuple[Field, ...]]

    @property
    def fields(self) -> tuple[Field, ...]:
        return self.types[self.name]


def short_name(type_name: str) -> str:
    """`package/msg/Name` -> `package/Name`."""
    package, _, name = type_name.replace("/msg/", "/").partition("/")
    return f"{package}/{name}"


def full_name(type_name: str) -> str:
    """`package/Name` -> `package/msg/Name`."""
    package, _, name = short_name(type_name).partition("/")
    return f"{package}/msg/{name}"


@cache
def load_schema(type_name: str) -> Schema:
    """The schema of an installed message type, e.g. `cnc_ptp/msg/AxisState`. Raises CncError 26005."""
    return parse_schema(type_name, schema_text(type_name))


@cache
def schema_text(type_name: str) -> str:
    """The concatenated definition of a message type and of all types it uses. Raises CncError 26005."""
    todo = [short_name(type_name)]
    parts: list[str] = []
    for name in todo:
        text = message_file(name).read_text(encoding="utf-8").strip("\n") + "\n"
        parts.append(text if not parts else f"{DIVIDER}\nMSG: {name}\n{text}")
        used = (field.type for field in _fields(name, text) if field.type not in PRIMITIVES and field.type != "string")
        todo.extend(other for other in dict.fromkeys(used) if other not in todo)
    return "".join(parts)


@cache
def type_hash(type_name: str) -> str:
    """The hash of an installed message type (REP 2016), as ROS has generated it; empty where it has not."""
    try:
        generated = json.loads(message_file(type_name).with_suffix(".json").read_text(encoding="utf-8"))
        hashes = {entry["type_name"]: str(entry["hash_string"]) for entry in generated["type_hashes"]}
        return hashes.get(full_name(type_name), "")
    except (OSError, ValueError, KeyError):
        return ""


def parse_schema(type_name: str, text: str) -> Schema:
    """The fields named in a schema text. Raises CncError 26005 when a line is none or a used type is missing."""
    name = short_name(type_name)
    types: dict[str, tuple[Field, ...]] = {}
    owner = name
    lines: list[str] = []
    for line in [*text.splitlines(), DIVIDER]:
        if line.startswith(DIVIDER):
            types[owner] = tuple(_fields(owner, "\n".join(lines)))
            lines = []
        elif line.startswith("MSG: "):
            owner = short_name(line[5:].strip())
        else:
            lines.append(line)
    _require_complete(name, types)
    return Schema(name, text, types)


def recorded_schema(type_name: str, definition: bytes) -> Schema:
    """The fields of a type as a recording defines it. Raises CncError 26005."""
    try:
        text = definition.decode()
    except UnicodeDecodeError as error:
        raise CncError(
            UNKNOWN_TYPE,
            f"recording: message type {full_name(type_name)}: its definition is no UTF-8 at byte {error.start}",
            "the schema is not usable",
        ) from None
    return parse_schema(type_name, text)


def message_file(type_name: str) -> Path:
    """The .msg file of a type: ament index, then share folder of the environment, then the source tree (own package).

    Raises CncError 26005 when it is nowhere.
    """
    package, _, name = short_name(type_name).partition("/")
    for folder in _share_folders(package):
        path = folder / "msg" / f"{name}.msg"
        if path.is_file():
            return path
    raise CncError(
        UNKNOWN_TYPE,
        f"recording: message type {full_name(type_name)} is not installed (looked for msg/{name}.msg in the "
        f"ROS prefixes and {sys.prefix}/share/{package})",
        f"it cannot be recorded, install package {package}",
    )


def _share_folders(package: str) -> Iterator[Path]:
    try:
        from ament_index_python.packages import get_package_share_directory

        yield Path(get_package_share_directory(package))
    except (ImportError, LookupError, OSError):
        pass  # no ROS prefix is set, or the package is not in it
    yield Path(sys.prefix) / "share" / package
    if package == cnc_ptp.__name__:
        yield Path(cnc_ptp.__file__).resolve().parent.parent


def _fields(owner: str, text: str) -> Iterator[Field]:
    package = owner.partition("/")[0]
    for line in text.splitlines():
        code = line.partition("#")[0].strip()
        if not code:
            continue
        match = _FIELD.fullmatch(code)
        if match is None:
            raise CncError(
                UNKNOWN_TYPE,
                f"recording: message type {full_name(owner)}: '{code}' is not a field",
                "the schema is not usable",
            )
        if not match["rest"].lstrip().startswith("="):  # the others are constants
            yield Field(match["name"], _type_in(package, match["type"]), _length(match["array"]))


def _type_in(package: str, name: str) -> str:
    if name in PRIMITIVES or name in ("string", "wstring") or "/" in name:
        return name
    return "std_msgs/Header" if name == "Header" else f"{package}/{name}"


def decoder_of(schema: Schema) -> Callable[[bytes], Any]:
    """Reads a message of this type field by field."""
    text = McapSchema(0, schema.text.encode(), "ros2msg", schema.name)
    decoder: Any = DecoderFactory().decoder_for("cdr", text)
    return cast("Callable[[bytes], Any]", decoder)


def _length(array: str | None) -> int | None:
    if array is None:
        return None
    digits = array.strip("[]")
    return int(digits) if digits.isdigit() else -1


def _require_complete(name: str, types: dict[str, tuple[Field, ...]]) -> None:
    if name not in types:
        reason = f"recording: message type {full_name(name)}: its schema does not define it"
        raise CncError(UNKNOWN_TYPE, reason, "the schema is not usable")
    for owner, fields in types.items():
        names = [field.name for field in fields]
        if twice := next((each for each in names if names.count(each) > 1), None):
            reason = f"recording: message type {full_name(name)}: field {full_name(owner)}.{twice} is defined twice"
            raise CncError(UNKNOWN_TYPE, reason, "the schema is not usable")
        for field in fields:
            if field.type not in PRIMITIVES and field.type != "string" and field.type not in types:
                raise CncError(
                    UNKNOWN_TYPE,
                    f"recording: message type {full_name(name)}: type {field.type} of field "
                    f"{full_name(owner)}.{field.name} is neither defined in the schema nor supported",
                    "the schema is not usable",
                )
