"""Messages that hold numbers only behind their header: read by one `struct`, whatever the name in the header is.

PLC topics come at up to 1 kHz; what rclpy does for each message costs five times as much.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from cnc_ptp.wire.layout import ENCAPSULATION, HEADER_TYPE, SIZES
from cnc_ptp.wire.schemas import PRIMITIVES, Field, Schema, load_schema
from cnc_ptp.wire.unreadable import unreadable

LENGTH = struct.Struct("<I")
TEXT_AT = 16
"""Where the text of frame_id begins: encapsulation, stamp and length come before."""
WIDEST = 8


class Place(NamedTuple):
    """A field behind the header: its dotted name, code and number of values (None: a single one)."""

    name: str
    code: str
    length: int | None


class FixedMessage:
    """Reads messages of one type. Fields have dotted names; an array is a tuple."""

    def __init__(self, type_name: str, decode: Callable[[bytes], Any] | None = None) -> None:
        """`decode`: reads what another encapsulation has (big endian, XCDR2), as an object."""
        self.schema: Schema = load_schema(type_name)
        self._name = type_name.rpartition("/")[2]
        self._decode = decode
        self._places = list(self._flat(self.schema.fields[1:], ""))
        self._structs = [struct.Struct(self._codes(residue)) for residue in range(WIDEST)]

    def _flat(self, fields: tuple[Field, ...], prefix: str) -> Iterator[Place]:
        for field in fields:
            if field.type in PRIMITIVES:
                yield Place(prefix + field.name, PRIMITIVES[field.type], field.length)
            else:
                assert field.type != HEADER_TYPE and field.type in self.schema.types, f"{field.name} is no number"
                yield from self._flat(self.schema.types[field.type], f"{prefix}{field.name}.")

    def _codes(self, residue: int) -> str:
        """With the padding for messages whose header ends at `residue` behind a multiple of eight."""
        codes, size = ["<"], residue
        for place in self._places:
            padding = -size % SIZES[place.code]
            codes.append(f"{padding}x{place.length or 1}{place.code}")
            size += padding + SIZES[place.code] * (place.length or 1)
        return "".join(codes)

    def split(self, data: bytes) -> tuple[str, int]:
        """The frame_id of a message, and where its header ends; -1 for another encapsulation. Raises CncError 26184."""
        if data[:4] != ENCAPSULATION:
            return "", -1
        if len(data) < TEXT_AT:
            raise unreadable(self._name, data, f"its header alone has {TEXT_AT}")
        (length,) = LENGTH.unpack_from(data, TEXT_AT - LENGTH.size)
        end = TEXT_AT + length
        return data[TEXT_AT : end - 1].decode(errors="replace"), end

    def fields(self, data: bytes, end: int) -> dict[str, Any]:
        """The fields behind the header, which ends at `end`. Raises struct.error for a message that is too short."""
        values = iter(self._structs[(end - len(ENCAPSULATION)) % WIDEST].unpack_from(data, end))
        return {
            place.name: next(values) if place.length is None else tuple(next(values) for _ in range(place.length))
            for place in self._places
        }

    def read(self, data: bytes) -> tuple[str, dict[str, Any]]:
        """frame_id and fields of a message. Raises CncError 26184 for bytes that are none."""
        source, end = self.split(data)
        if end < 0 and self._decode is None:
            raise unreadable(self._name, data, f"their encapsulation is {data[:4].hex()}, not {ENCAPSULATION.hex()}")
        try:
            return (source, self.fields(data, end)) if end >= 0 else self._of_another_encapsulation(data)
        except Exception as error:  # whatever `decode` raises
            raise unreadable(self._name, data, error) from error

    def _of_another_encapsulation(self, data: bytes) -> tuple[str, dict[str, Any]]:
        assert self._decode is not None
        message = self._decode(data)
        return message.header.frame_id, {place.name: nested(message, place.name) for place in self._places}


def nested(message: Any, name: str) -> Any:
    """The value of a dotted field name."""
    for part in name.split("."):
        message = getattr(message, part)
    return message
