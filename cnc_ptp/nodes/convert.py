"""Conversion of the kernel's blocks to ROS messages and back: same field names, arrays copied, nothing computed."""

from __future__ import annotations

import json
from array import array
from typing import Any

from builtin_interfaces.msg import Time

from cnc_ptp import msg
from cnc_ptp.protocol.blocks import (
    AxisBlock,
    ChannelBlock,
    Command,
    CommandRecord,
    CycleBlock,
    CycleTick,
    Event,
    EventValue,
    HandshakeRequest,
    PlcBlock,
    Refusal,
    SpindleBlock,
)

TYPECODES = {"sequence<double>": "d", "sequence<uint8>": "B", "sequence<uint32>": "I", "sequence<int32>": "i"}
BLOCK_CLASSES: dict[type, type] = {
    msg.PlcBlock: PlcBlock,
    msg.ChannelBlock: ChannelBlock,
    msg.AxisBlock: AxisBlock,
    msg.SpindleBlock: SpindleBlock,
}
BLOCK_MESSAGES = {block: message for message, block in BLOCK_CLASSES.items()}
NESTED = ("commands", "requests", "refused")


def _plan(message_type: Any) -> list[tuple[str, str]]:
    types = message_type.get_fields_and_field_types()
    return [(name, TYPECODES.get(kind, "")) for name, kind in types.items() if name not in ("header", *NESTED)]


_PLANS = {block: _plan(message) for block, message in BLOCK_MESSAGES.items()}


def block_to_message(block: CycleBlock, stamp: Time) -> Any:
    """The message of a block; `stamp` is that of its first cycle."""
    message = BLOCK_MESSAGES[type(block)]()
    message.header.stamp = stamp
    for name, typecode in _PLANS[type(block)]:
        value = getattr(block, name)
        setattr(message, name, array(typecode, value) if typecode else value)
    if isinstance(block, (PlcBlock, ChannelBlock, SpindleBlock)):
        message.commands = [command_to_message(command) for command in block.commands]
    if isinstance(block, SpindleBlock):
        message.refused = [refusal.encode() for refusal in block.refused]
    if isinstance(block, ChannelBlock):
        message.requests = [request_to_message(request, stamp) for request in block.requests]
    return message


def message_to_block(message: Any) -> Any:
    """The block of a message; its arrays become lists."""
    block_class = BLOCK_CLASSES[type(message)]
    values = {
        name: getattr(message, name).tolist() if typecode else getattr(message, name)
        for name, typecode in _PLANS[block_class]
    }
    if block_class in (PlcBlock, ChannelBlock, SpindleBlock):
        values["commands"] = [message_to_command(command) for command in message.commands]
    if block_class is SpindleBlock:
        values["refused"] = [Refusal.decode(text) for text in message.refused]
    if block_class is ChannelBlock:
        values["requests"] = [_message_to_request(request) for request in message.requests]
    return block_class(**values)


def command_to_message(command: Command) -> msg.CommandRequest:
    return msg.CommandRequest(
        id=command.id, target=command.target, command=command.command, arguments_json=command.arguments_json
    )


def message_to_command(message: msg.CommandRequest) -> Command:
    return Command(message.target, message.command, json.loads(message.arguments_json), message.id)


def record_to_message(record: CommandRecord, stamp: Time) -> msg.CommandRecord:
    return _flat(record, msg.CommandRecord, stamp)


def event_to_message(event: Event, stamp: Time) -> msg.Event:
    values = [msg.EventValue(name=name, value=value, unit=unit) for name, value, unit in event.values]
    message = msg.Event(
        cycle=event.cycle,
        source=event.source,
        severity=event.severity,
        error_id=event.error_id,
        text=event.text,
        line=event.line,
        values=values,
    )
    message.header.stamp = stamp
    return message


def message_to_tick(message: msg.CycleTick) -> CycleTick:
    return CycleTick(message.first_cycle, message.count)


def message_to_record(message: msg.CommandRecord) -> CommandRecord:
    return CommandRecord(**{name: getattr(message, name) for name in _names(msg.CommandRecord)})


def message_to_event(message: msg.Event) -> Event:
    values = [EventValue(value.name, value.value, value.unit) for value in message.values]
    return Event(message.cycle, message.source, message.severity, message.error_id, message.text, message.line, values)


def request_to_message(request: HandshakeRequest, stamp: Time) -> msg.HandshakeRequest:
    return _flat(request, msg.HandshakeRequest, stamp)


def _message_to_request(message: msg.HandshakeRequest) -> HandshakeRequest:
    return HandshakeRequest(**{name: getattr(message, name) for name in _names(msg.HandshakeRequest)})


def _names(message_type: Any) -> list[str]:
    return [name for name in message_type.get_fields_and_field_types() if name != "header"]


def _flat(value: Any, message_type: Any, stamp: Time) -> Any:
    message = message_type(**{name: getattr(value, name) for name in _names(message_type)})
    message.header.stamp = stamp
    return message


def time_message(stamp_ns: int) -> Time:
    """Nanoseconds as a ROS time."""
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    return Time(sec=seconds, nanosec=nanoseconds)


def nanoseconds(stamp: Time) -> int:
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
