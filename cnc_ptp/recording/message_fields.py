"""Fields of many messages of one topic as arrays: by views of their bytes where all have one shape."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from mcap.records import Schema as McapSchema
from mcap_ros2.decoder import DecoderFactory

from cnc_ptp.errors import CncError
from cnc_ptp.wire.layout import Bytes, Layout, Records, fixed_layout
from cnc_ptp.wire.schemas import PRIMITIVES, Field, Schema, full_name, parse_schema

Column = npt.NDArray[Any]
PADDING = 3
"""Bytes with which DDS may fill up a message."""
MOST_LAYOUTS = 8
"""That are remembered."""
PLAIN = (0, 1)
"""Begin of a message in little endian CDR."""


class MessageFields:
    """Reads fields of messages of one type.

    A number is an array (n,), a sequence of numbers (n, length); a text, and what has no fixed shape, is (n,) of
    objects. Names of fields in messages are dotted: `header.stamp.sec`.
    """

    def __init__(self, schema: McapSchema) -> None:
        """Raises CncError 26005, or whatever the library raises, for a schema that cannot be used."""
        self.schema: Schema = parse_schema(full_name(schema.name), schema.data.decode(errors="replace"))
        self._fields = dict(_leaves(self.schema, self.schema.fields))
        self.names = tuple(self._fields)
        self._decode: Any = DecoderFactory().decoder_for("cdr", schema)
        self._empty = fixed_layout(self.schema)
        """Of messages without texts and elements of sequences."""
        self._layouts: list[Layout] = []

    def read(self, contents: Bytes, names: Sequence[str]) -> dict[str, Column]:
        """The fields of messages (n, size); copies, so that the chunk is free. Raises whatever the decoder raises."""
        layout = self._layout_of(contents)
        columns = {} if layout is None else self._quick(contents, layout, names)
        rest = [name for name in names if name not in columns]
        messages = [self._decode(content.tobytes()) for content in contents] if rest else []
        decoded = {name: _column([_value(message, name) for message in messages], self._fields[name]) for name in rest}
        return {name: columns[name] if name in columns else decoded[name] for name in names}

    def _quick(self, contents: Bytes, layout: Layout, names: Sequence[str]) -> dict[str, Column]:
        """What needs no decoder."""
        rows = _view(contents, layout)
        columns: dict[str, Column] = {}
        for name in names:
            field = self._fields[name]
            if name in (layout.dtype.names or ()):
                columns[name] = np.array(rows[name])
            elif field.length is not None and field.type in PRIMITIVES:
                columns[name] = np.empty((len(rows), 0), dtype=PRIMITIVES[field.type])
            elif layout is self._empty and field.length is None:
                columns[name] = _objects([""] * len(rows))
        return columns

    def _layout_of(self, contents: Bytes) -> Layout | None:
        """The layout that all messages have; None where they have different ones."""
        for layout in (self._empty, *self._layouts):
            if _has_layout(contents, layout):
                return layout
        try:
            layout = Layout(self.schema, self._decode(contents[0].tobytes()))
        except CncError:
            return None
        if not _has_layout(contents, layout):
            return None
        self._layouts = [layout, *self._layouts[: MOST_LAYOUTS - 1]]
        return layout


def _leaves(schema: Schema, fields: Sequence[Field], prefix: str = "") -> Iterator[tuple[str, Field]]:
    """Fields that are no messages themselves, with dotted names; sequences of messages are one."""
    for field in fields:
        if field.length is None and field.type not in PRIMITIVES and field.type != "string":
            yield from _leaves(schema, schema.types[field.type], f"{prefix}{field.name}.")
        else:
            yield prefix + field.name, field


def _has_layout(contents: Bytes, layout: Layout) -> bool:
    """Whether the numbers of all messages (n, size) lie where the layout says: same size, same lengths."""
    size = layout.dtype.itemsize
    if not size <= contents.shape[1] <= size + PADDING or (contents[:, :2] != PLAIN).any():
        return False
    template = np.frombuffer(layout.template, dtype=np.uint8)
    places = (np.array(layout.lengths, dtype=np.int64)[:, None] + np.arange(4)).reshape(-1)
    return bool((contents[:, places] == template[places]).all())


def _view(contents: Bytes, layout: Layout) -> Records:
    rows: Records = contents[:, : layout.dtype.itemsize].view(layout.dtype)[:, 0]
    return rows


def _value(message: Any, name: str) -> Any:
    for part in name.split("."):
        message = getattr(message, part)
    return plain(message)


def plain(value: Any) -> Any:
    """A decoded value without objects of the decoder: messages as mappings, sequences as lists."""
    if isinstance(value, (list, tuple, bytes, bytearray, memoryview, np.ndarray)):
        return [plain(each) for each in value]
    if hasattr(value, "__slots__") and not isinstance(value, (str, int, float)):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    return value


def _column(values: list[Any], field: Field) -> Column:
    if field.type not in PRIMITIVES:
        return _objects(values)
    if field.length is None or len({len(value) for value in values}) == 1:
        return np.array(values, dtype=PRIMITIVES[field.type])
    return _objects(values)


def _objects(values: list[Any]) -> Column:
    column = np.empty(len(values), dtype=object)
    for place, value in enumerate(values):  # a list would be taken for an array
        column[place] = value
    return column
