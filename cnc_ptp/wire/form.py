"""The bytes of blocks that are shaped alike, packed and unpacked at once."""

from __future__ import annotations

import struct
from operator import itemgetter
from typing import Any

from cnc_ptp.wire.layout import ENCAPSULATION, HEADER_TYPE, SIZES, Header, Layout
from cnc_ptp.wire.schemas import PRIMITIVES, Field, Schema

NO_TEXT = b"\0"
SCALAR, COLUMN, TEXTS, EMPTY = range(4)


class Form:
    """Messages whose sequences and texts are as long as those of `prototype`; sequences of messages are empty.

    One `struct` holds every number, length and text of such a message in its order, with the padding between them.
    """

    def __init__(self, schema: Schema, prototype: Any) -> None:
        self.layout = Layout(schema, prototype)
        """The same places for NumPy, to read many messages at a time."""
        self._codes = ["<4s"]
        self._size = 0
        self._values = 0
        self._steps: list[tuple[str, int, int, list[Any]]] = []
        self._has_columns = any(field.length is not None and field.type in PRIMITIVES for field in schema.fields)
        lengths: dict[int, int] = {}
        """Index of a value -> what it is in every message of this form."""
        for field in schema.fields:
            self._add(field, None if field.type == HEADER_TYPE else getattr(prototype, field.name), lengths)
        self._struct = struct.Struct("".join(self._codes))
        self._lengths = itemgetter(*lengths, 0)
        self._expected = (*lengths.values(), ENCAPSULATION)

    @property
    def size(self) -> int:
        """Bytes of a message."""
        return self._struct.size

    def _add(self, field: Field, value: Any, lengths: dict[int, int]) -> None:
        """Notes the codes of a field and, from the index of its first value on, what it consists of."""
        if field.type == HEADER_TYPE:
            self._number("i", 1)
            self._number("I", 1)
            self._texts([""], lengths)
            return
        begin = self._values + 1
        if field.length is None and field.type in PRIMITIVES:
            self._number(PRIMITIVES[field.type], 1)
            self._steps.append((field.name, SCALAR, begin, []))
            if field.name == "count" and self._has_columns:
                lengths[begin] = value
        elif field.length is None:
            self._steps.append((field.name, TEXTS, begin, self._texts([value], lengths)))
        else:
            lengths[begin] = len(value)
            self._number("I", 1)
            if field.type == "string" and value:
                self._steps.append((field.name, TEXTS, begin, [len(value), *self._texts(value, lengths)]))
            elif field.type in PRIMITIVES:
                self._steps.append((field.name, COLUMN, begin, [len(value)]))
                if value:
                    self._number(PRIMITIVES[field.type], len(value))
            else:
                self._steps.append((field.name, EMPTY, begin, [0]))

    def _number(self, code: str, count: int) -> None:
        padding = -self._size % SIZES[code]
        self._codes.append(f"{padding}x{count}{code}")
        self._size += padding + count * SIZES[code]
        self._values += count

    def _texts(self, texts: list[str], lengths: dict[int, int]) -> list[Any]:
        values: list[Any] = []
        for text in texts:
            content = text.encode(errors="replace") + NO_TEXT
            lengths[self._values + 1] = len(content)
            self._number("I", 1)
            self._codes.append(f"{len(content)}s")
            self._size += len(content)
            self._values += 1
            values += [len(content), content]
        return values

    def pack(self, block: Any, header: Header) -> bytes:
        """Raises struct.error when the block holds another number of values or one beyond its field's range."""
        values: list[Any] = [ENCAPSULATION, header.sec, header.nanosec, 1, NO_TEXT]
        for name, kind, _begin, constants in self._steps:
            values += constants
            if kind == COLUMN:
                column = getattr(block, name)
                if len(column) != constants[0]:
                    raise struct.error(f"{name} has {len(column)} values")
                values += column
            elif kind == SCALAR:
                values.append(getattr(block, name))
        return self._struct.pack(*values)

    def fits(self, data: bytes) -> bool:
        """True when a message is one of this form; DDS may have filled it up to a multiple of four bytes."""
        return self._values_of(data) is not None

    def _values_of(self, data: bytes) -> tuple[Any, ...] | None:
        """All values of a message in their order; None when it is not of this form."""
        if len(data) < self.size:
            return None
        values = self._struct.unpack_from(data)
        return values if self._lengths(values) == self._expected else None

    def unpack(self, data: bytes) -> dict[str, Any] | None:
        """The fields of a message except its header; None when it is not of this form."""
        found = self._values_of(data)
        if found is None:
            return None
        values = [*found]
        fields: dict[str, Any] = {}
        for name, kind, begin, constants in self._steps:
            if kind == COLUMN:
                fields[name] = values[begin + 1 : begin + 1 + constants[0]]
            elif kind == SCALAR:
                fields[name] = values[begin]
            elif kind == EMPTY:
                fields[name] = []
            else:
                fields[name] = self._texts_at(values, begin, constants)
        return fields

    def _texts_at(self, values: list[Any], begin: int, constants: list[Any]) -> Any:
        """A text, or a list of them if their number comes first."""
        listed = len(constants) % 2
        first = begin + 1 + listed
        texts = [values[index][:-1].decode() for index in range(first, begin + len(constants), 2)]
        return texts if listed else texts[0]
