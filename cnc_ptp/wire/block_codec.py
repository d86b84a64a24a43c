"""Blocks of units as messages (CDR) and back: what goes over a topic is what a recording holds.

Blocks are numbers of a shape that seldom changes: they are packed by a form, found once for each shape. Blocks that
carry commands, answers, requests or refusals are encoded field by field.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Hashable
from functools import lru_cache
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import (
    AxisBlock,
    ChannelBlock,
    ChannelOffsets,
    Command,
    CommandAnswer,
    ControlUnitState,
    CycleBlock,
    HandshakeRequest,
    JobEvent,
    PlcBlock,
    Refusal,
    SpindleBlock,
    arguments_of,
)
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.wire.form import Form
from cnc_ptp.wire.layout import NOT_ENCODED, Layout, encode, header_at
from cnc_ptp.wire.schemas import PRIMITIVES, Schema, decoder_of, load_schema, recorded_schema
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.wire.unreadable import unreadable

HEAD = struct.Struct("<4xiIIx3xQI")
"""Encapsulation, stamp, length of the empty frame_id, first cycle, count: the start of every block."""
FILES_KNOWN = 64
"""Definitions of files that are kept."""
FORMS_KEPT = 1000


def _tells_plc(block: Any) -> bool:
    """It carries what only the PLC reads."""
    return bool(block.answers or block.job_events or block.control_units)


_SHAPES: dict[type, Callable[[Any], Hashable]] = {
    PlcBlock: lambda block: None if block.commands else True,
    AxisBlock: lambda block: None if _tells_plc(block) else (block.count, block.master),
    SpindleBlock: lambda block: (
        None
        if block.commands or block.refused or _tells_plc(block)
        else (block.count, block.master, block.master_wanted, block.source)
    ),
    ChannelBlock: lambda block: (
        None
        if block.commands or block.requests or block.offsets or _tells_plc(block)
        else (
            block.count,
            *block.axes,
            len(block.set_position),
            len(block.programmed_position),
            *block.path_spindles,
            len(block.spindle_travel),
            len(block.thread_lead),
        )
    ),
}
"""By class: what blocks with the same form have in common; None for a block without one."""

_HIGHEST_STATE = {AxisBlock: max(AxisStateCode), SpindleBlock: max(AxisStateCode), ChannelBlock: max(ChannelStateCode)}


def job_event(sent: Any) -> JobEvent:
    """Raises ValueError for a status that there is not."""
    require_within("status of a job", sent.status, min(JobStatus), max(JobStatus))
    return JobEvent(sent.job, sent.status, sent.cycle, sent.error_id)


def require_within(name: str, value: int, lowest: int, highest: int) -> None:
    """Raises ValueError for a number that none of the enumerated values has."""
    if not lowest <= value <= highest:
        raise ValueError(f"{name} {value} is not within {lowest:d} ... {highest:d}")


def require_setpoints(block: ChannelBlock) -> None:
    """Raises ValueError for a path whose axes have no setpoint in each cycle."""
    expected = len(block.axes) * block.count
    if block.path_active and len(block.set_position) != expected:
        raise ValueError(f"set_position holds {len(block.set_position)} values, and its axes have {expected} setpoints")


_NESTED: dict[str, Callable[[Any], Any]] = {
    "commands": lambda sent: Command(sent.target, sent.command, arguments_of(sent.arguments_json), sent.id),
    "refused": lambda text: Refusal.decode(text),
    "job_events": job_event,
    "answers": lambda sent: CommandAnswer(sent.id, sent.error_id, sent.job, sent.message, sent.values_json),
    "control_units": lambda sent: ControlUnitState(sent.name, sent.held, sent.request, sent.state, sent.holder),
    "offsets": lambda sent: channel_offsets(sent),
    "requests": lambda sent: HandshakeRequest(
        **{name: getattr(sent, name) for name in HandshakeRequest.__dataclass_fields__ if hasattr(sent, name)}
    ),
}
"""Elements of sequences that are more than numbers: as a message has them -> as a block has them."""


BY_AXIS = "programmed_position"
"""The column that holds one value for each axis, of the last cycle."""


CHANNEL_LISTS = {field.name for field in load_schema("cnc_ptp/msg/ChannelOffsets").fields if field.length}


def channel_offsets(sent: Any) -> ChannelOffsets:
    """Sequences become lists, as the channel has made them; older files have fewer fields."""
    names = [name for name in ChannelOffsets.__dataclass_fields__ if hasattr(sent, name)]
    values: dict[str, Any] = {name: getattr(sent, name) for name in names}
    for name in CHANNEL_LISTS & values.keys():
        values[name] = list(values[name])
    return ChannelOffsets(**values)


class BlockCodec:
    """Encodes and decodes the blocks of one class."""

    def __init__(self, block_class: Any, schema: Schema | None = None) -> None:
        """`schema`: that of a file; None for that of today."""
        self._class = block_class
        self.schema = load_schema(f"cnc_ptp/msg/{block_class.__name__}") if schema is None else schema
        self._decode = decoder_of(self.schema)
        self._shape = _SHAPES[block_class]
        self._highest_state = _HIGHEST_STATE.get(block_class, 0)
        self._forms: dict[Hashable, Form] = {}
        self._of_words: dict[int, list[Form]] = {}
        """By size in words of four bytes: DDS fills the last one up."""

    def encode(self, block: Any, stamps: Stamps) -> bytes:
        """CDR of a block; raises as `encode_with_layout`."""
        return self.encode_with_layout(block, stamps)[0]

    def encode_with_layout(self, block: Any, stamps: Stamps) -> tuple[bytes, Layout | None]:
        """CDR of a block, and where its numbers lie if it has a form.

        Raises CncError 26006 when a column holds another number of values than the block has cycles, or a value is
        beyond the range of its field.
        """
        header = header_at(stamps.at(block.first_cycle))
        shape = self._shape(block)
        if shape is None:
            self._require_columns(block)
            fields = {field.name: getattr(block, field.name, header) for field in self.schema.fields}
            if isinstance(block, SpindleBlock):
                fields["refused"] = [refusal.encode() for refusal in block.refused]
            return encode(self.schema, fields, stamps.header_of), None
        try:
            form = self._forms.get(shape) or self._new_form(shape, block)
            return form.pack(block, header), form.layout
        except (struct.error, TypeError) as error:
            self._require_columns(block)
            raise misfit(block, str(error)) from error

    def decode(self, data: bytes, count: int | None = None) -> Any:
        """The block of a message. `count`: cycles that it must have, None = any number.

        Raises CncError 26184 for bytes that are none, and for what no unit sends.
        """
        try:
            block = self._by_form(data)
            if block is None:
                block = self._field_by_field(data)
            self._require_known(block.count, max(getattr(block, "state", (0,))), count)
            if isinstance(block, ChannelBlock):
                require_setpoints(block)
        except Exception as error:  # whatever the generated decoder raises
            raise unreadable(self._class.__name__, data, error) from error
        return block

    def _by_form(self, data: bytes) -> Any:
        """None for a message of a form that is not known."""
        for form in self._of_words.get(words(len(data)), ()):
            fields = form.unpack(data)
            if fields is not None:
                return self._class(**fields)
        return None

    def _field_by_field(self, data: bytes) -> Any:
        """Keeps the form of the block."""
        block = self._class(**self._fields(self._decode(data)))
        if not block.count:
            raise ValueError("count is 0")
        if name := self._wrong_column(block):
            raise ValueError(f"{name} holds {len(getattr(block, name))} values, and count is {block.count}")
        self._learn(block)
        return block

    def check(self, data: bytes, count: int) -> None:
        """Raises CncError 26184 as `decode`; of axes and spindles it costs a fraction of that."""
        form = self._form_of(data)
        if form is None or self._class is ChannelBlock:
            self.decode(data, count)
            return
        fields = form.layout.read(data[: form.size])
        highest = int(fields["state"].max()) if self._highest_state else 0
        try:
            self._require_known(int(fields["count"][0]), highest, count)
        except ValueError as error:
            raise unreadable(self._class.__name__, data, error) from error

    def _require_known(self, count: int, highest_state: int, expected: int | None) -> None:
        if expected is not None and count != expected:
            raise ValueError(f"count is {count}, and each tick has {expected} cycles")
        require_within("state", highest_state, 0, self._highest_state)

    def layout(self, data: bytes) -> Layout:
        """Where the numbers of a message lie; the same object for messages of the same form.

        Raises CncError 26006 for columns of other lengths, 26184 for bytes that are no message.
        """
        try:
            return self._found_layout(data)
        except CncError:
            raise
        except Exception as error:  # as in decode
            raise unreadable(self._class.__name__, data, error) from error

    def _found_layout(self, data: bytes) -> Layout:
        known = self._form_of(data)
        if known is None:
            message = self._decode(data)
            self._require_columns(message)
            self._learn(self._class(**self._fields(message)))
            known = self._form_of(data)
        return known.layout if known else Layout(self.schema, message)

    def _form_of(self, data: bytes) -> Form | None:
        return next((form for form in self._of_words.get(words(len(data)), ()) if form.fits(data)), None)

    def _fields(self, message: Any) -> dict[str, Any]:
        fields = {field.name: getattr(message, field.name) for field in self.schema.fields if field.name != "header"}
        for field in self.schema.fields:
            if field.name in _NESTED:
                fields[field.name] = [_NESTED[field.name](element) for element in fields[field.name]]
            elif field.length is not None:
                fields[field.name] = list(fields[field.name])
        return fields

    def _learn(self, block: Any) -> None:
        """Keeps the form of a block that has come, if it has one."""
        shape = self._shape(block)
        if shape is not None and not self._wrong_column(block):
            form = self._forms.get(shape) or self._new_form(shape, block)
            self._read_by(form)

    def _new_form(self, shape: Hashable, block: Any) -> Form:
        self._require_columns(block)
        if len(self._forms) >= FORMS_KEPT:
            self._forms.clear()
            self._of_words.clear()
        form = self._forms[shape] = Form(self.schema, block)
        self._read_by(form)
        return form

    def _read_by(self, form: Form) -> None:
        known = self._of_words.setdefault(words(form.size), [])
        if form not in known:
            known.append(form)

    def _require_columns(self, block: Any) -> None:
        if name := self._wrong_column(block):
            raise misfit(block, f"{name} holds {len(getattr(block, name))} values")

    def _wrong_column(self, block: Any) -> str:
        """The first column that does not hold `count` values, or not as many setpoints as the first one."""
        of_channel = self._class is ChannelBlock
        setpoints = len(block.set_position) if of_channel else block.count
        for field in self.schema.fields:
            if field.length is not None and field.type in PRIMITIVES and field.name != BY_AXIS:
                expected = setpoints if field.name.startswith("set_") else block.count
                if of_channel and field.name.startswith("spindle_"):
                    expected = block.count * len(block.path_spindles)
                elif of_channel and field.name.startswith("thread_"):
                    expected = len(block.thread_lead)
                if len(getattr(block, field.name)) != expected:
                    return field.name
        return ""


def words(size: int) -> int:
    return (size + 3) // 4


_CODECS: dict[type, BlockCodec] = {}


def codec_of(block_class: type) -> BlockCodec:
    codec = _CODECS.get(block_class)
    if codec is None:
        codec = _CODECS[block_class] = BlockCodec(block_class)
    return codec


@lru_cache(maxsize=FILES_KNOWN)
def codec_of_file(block_class: type, definition: bytes) -> BlockCodec:
    """For the messages of a file, which may be from before a change of their definition. Raises CncError 26005."""
    today = codec_of(block_class)
    schema = recorded_schema(today.schema.name, definition)
    return today if schema.types == today.schema.types else BlockCodec(block_class, schema)


def encode_block(block: CycleBlock, stamps: Stamps) -> bytes:
    """CDR of a block with the stamp of its first cycle. Raises CncError 26006 for one that does not fit its message."""
    return codec_of(type(block)).encode(block, stamps)


def head_of(data: bytes) -> tuple[int, int, int]:
    """Stamp in ns, first cycle and count of a block's message whose header has no frame_id, as all of ours.

    Raises CncError 26184 for one that is too short.
    """
    seconds, nanoseconds, _empty, first_cycle, count = _head(data)
    return seconds * 1_000_000_000 + nanoseconds, first_cycle, count


def has_plain_header(data: bytes) -> bool:
    """False for a message of somebody who has given its header a frame_id. Raises CncError 26184."""
    return bool(_head(data)[2] == 1)


def _head(data: bytes) -> tuple[int, ...]:
    if len(data) < HEAD.size:
        raise unreadable("of a block", data, f"its head alone has {HEAD.size}")
    return HEAD.unpack_from(data)


def with_plain_header(block_class: type, data: bytes, stamps: Stamps) -> bytes:
    """The same block without a frame_id, so that `head_of` can read it."""
    if has_plain_header(data):
        return data
    codec = codec_of(block_class)
    return codec.encode(codec.decode(data), stamps)


def misfit(block: Any, reason: str) -> CncError:
    return CncError(
        NOT_ENCODED,
        f"recording: {type(block).__name__} with first cycle {block.first_cycle}, count {block.count} does not fit its "
        f"message: {reason}",
        "it was not recorded",
    )
