"""CDR of ROS 2 messages: one message by `encode`, many messages of one shape by `Layout`.

XCDR1, little endian: 4 bytes of encapsulation header (0, 1, 0, 0); every number is aligned to its own size, counted
from the end of that header; strings and sequences begin with a uint32 length (strings hold and count a closing NUL).

A `Layout` is found by encoding one prototype message and noting where each number went. All messages with the same
lengths of sequences and the same texts have their numbers at the same places: NumPy writes and reads many at once.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError
from cnc_ptp.wire.schemas import PRIMITIVES, Field, Schema, full_name

Records = npt.NDArray[np.void]
Bytes = npt.NDArray[np.uint8]

NOT_ENCODED = 26006
ENCAPSULATION = b"\x00\x01\x00\x00"
HEADER_TYPE = "std_msgs/Header"
SIZES = {code: struct.calcsize(code) for code in PRIMITIVES.values()}


class Header(NamedTuple):
    """Stand-in for std_msgs/Header; frame_id stays empty so that messages keep their layout."""

    sec: int = 0
    nanosec: int = 0

    @property
    def stamp(self) -> Header:
        return self

    @property
    def frame_id(self) -> str:
        return ""


def header_at(stamp_ns: int) -> Header:
    return Header(*divmod(stamp_ns, 1_000_000_000))


@dataclass(frozen=True, slots=True)
class Place:
    """Where a number (count None) or a run of `count` numbers lies in a message; `code` of the struct module."""

    name: str
    offset: int
    code: str
    count: int | None


TEXT_PART: Final = 1 << 16
"""Characters."""


class _Writer:
    """Walks a message and its schema; appends CDR and notes the places of numbers."""

    def __init__(self, schema: Schema, header_of: Callable[[Any], Header]) -> None:
        self.schema = schema
        self.header_of = header_of
        self.data = bytearray(ENCAPSULATION)
        self.places: list[Place] = []
        self.lengths: list[int] = []

    def message(self, type_name: str, value: Any, prefix: str = "") -> None:
        for field in self.schema.types[type_name]:
            if isinstance(value, Mapping):
                content: Any = value[field.name]
            elif field.type == HEADER_TYPE and not hasattr(value, field.name):
                content = self.header_of(value)
            else:
                content = getattr(value, field.name)
            self.field(field, content, prefix + field.name)

    def field(self, field: Field, value: Any, name: str) -> None:
        if field.length is None:
            self.single(field.type, value, name)
            return
        if field.length < 0:
            self.numbers("I", [len(value)])
        elif len(value) != field.length:
            raise struct.error(f"{name} holds {len(value)} values instead of {field.length}")
        if field.type in PRIMITIVES:
            self.numbers(PRIMITIVES[field.type], value, name)
            return
        for index, element in enumerate(value):
            self.single(field.type, element, f"{name}[{index}]")

    def single(self, type_name: str, value: Any, name: str) -> None:
        if type_name == "string":
            self.text(value)
        elif type_name in PRIMITIVES:
            self.align(SIZES[PRIMITIVES[type_name]])
            self.places.append(Place(name, len(self.data), PRIMITIVES[type_name], None))
            self.data += struct.pack(f"<{PRIMITIVES[type_name]}", value)
        else:
            self.message(type_name, value, f"{name}.")

    def text(self, value: str) -> None:
        """Part by part: the text of a program may be long, and needs no second copy.

        What is no character (a name of a file that is no UTF-8) becomes a question mark.
        """
        self.numbers("I", [0])
        begin = len(self.data)
        for part in range(0, len(value), TEXT_PART):
            self.data += value[part : part + TEXT_PART].encode(errors="replace")
        self.data += b"\0"
        struct.pack_into("<I", self.data, begin - 4, len(self.data) - begin)

    def numbers(self, code: str, values: Any, name: str = "") -> None:
        """Numbers without gaps; with a name they are noted as one run."""
        if len(values) == 0:
            return
        self.align(SIZES[code])
        if name:
            self.places.append(Place(name, len(self.data), code, len(values)))
        else:
            self.lengths.append(len(self.data))
        self.data += struct.pack(f"<{len(values)}{code}", *values)

    def align(self, size: int) -> None:
        self.data += bytes(-(len(self.data) - len(ENCAPSULATION)) % size)


def _no_stamp(_value: Any) -> Header:
    return Header()


def _walk(schema: Schema, value: Any, header_of: Callable[[Any], Header]) -> _Writer:
    writer = _Writer(schema, header_of)
    try:
        writer.message(schema.name, value)
    except (struct.error, TypeError, AttributeError, KeyError) as error:
        raise CncError(
            NOT_ENCODED, f"recording: {full_name(schema.name)} cannot be encoded: {error}", "it was not recorded"
        ) from error
    return writer


def encode(schema: Schema, value: Any, header_of: Callable[[Any], Header] = _no_stamp) -> bytes:
    """CDR of one message given as an object or mapping with the schema's field names.

    If it lacks a header, `header_of(value)` gives one. Raises CncError 26006 for values that do not fit their field.
    """
    return bytes(_walk(schema, value, header_of).data)


def zero(schema: Schema, type_name: str = "") -> dict[str, Any]:
    """A message with all numbers 0, all texts and sequences empty."""
    values: dict[str, Any] = {}
    for field in schema.types[type_name or schema.name]:
        one: Any = "" if field.type == "string" else 0 if field.type in PRIMITIVES else zero(schema, field.type)
        values[field.name] = one if field.length is None else [one] * max(field.length, 0)
    return values


class Layout:
    """The places of all numbers in messages shaped like `prototype` (same sequence lengths, same texts).

    `dtype` is a structured type of one message: nested fields have dotted names (`header.stamp.sec`), sequences are
    subarrays; padding, lengths and texts are holes in it and come from `template`, the encoded prototype.
    """

    def __init__(self, schema: Schema, prototype: Any) -> None:
        writer = _walk(schema, prototype, _no_stamp)
        self.schema = schema
        self.template = bytes(writer.data)
        self.places = tuple(writer.places)
        self.lengths = tuple(writer.lengths)
        """Where the lengths of texts and sequences lie."""
        self.dtype = _structured(self.places, len(self.template))

    def empty(self, count: int) -> Records:
        """`count` messages equal to the prototype, shape (count,)."""
        return repeat(self.template, count).view(self.dtype)[:, 0]

    def read(self, data: bytes | Bytes) -> Records:
        """Messages lying one after another without gaps, shape (n,); shares memory with `data`."""
        return np.frombuffer(data, dtype=self.dtype)


def fixed_layout(schema: Schema) -> Layout:
    """The layout of a type whose messages all have the same size because texts in them are empty."""
    return Layout(schema, zero(schema))


def repeat(template: bytes, count: int) -> Bytes:
    """`count` copies of the template, shape (count, len(template))."""
    rows = np.empty((count, len(template)), dtype=np.uint8)
    rows[:] = np.frombuffer(template, dtype=np.uint8)
    return rows


def _structured(places: tuple[Place, ...], size: int) -> np.dtype[np.void]:
    formats = [f"<{place.code}" if place.count is None else (f"<{place.code}", (place.count,)) for place in places]
    return np.dtype(
        {
            "names": [place.name for place in places],
            "formats": formats,
            "offsets": [place.offset for place in places],
            "itemsize": size,
        }
    )
