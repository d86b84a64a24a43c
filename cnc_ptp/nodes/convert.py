"""Conversion of events, records and requests to ROS messages and back: same field names, nothing computed."""

from __future__ import annotations

import json
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.serialization import deserialize_message

from cnc_ptp import msg
from cnc_ptp.errors import Value
from cnc_ptp.protocol.blocks import ChannelOffsets, CommandRecord, Event, EventValue, HandshakeRequest, Severity
from cnc_ptp.protocol.event_values import ROLES, read_event_values
from cnc_ptp.wire.unreadable import unreadable


def message_of(data: bytes, message_type: Any) -> Any:
    """Raises CncError 26184 for bytes that are no such message."""
    try:
        return deserialize_message(data, message_type)
    except Exception as error:  # as many types as middlewares have
        raise unreadable(message_type.__name__, data, error) from error


def record_to_message(record: CommandRecord, stamp: Time) -> msg.CommandRecord:
    return _flat(record, msg.CommandRecord, stamp)


def event_to_message(event: Event, stamp: Time) -> msg.Event:
    message = msg.Event(
        cycle=event.cycle,
        source=event.source,
        severity=event.severity,
        error_id=event.error_id,
        text=event.text,
        line=event.line,
        values=[_value_to_message(value) for value in event.values],
        **{role: _value_to_message(getattr(event, role)) for role in ROLES},
    )
    message.header.stamp = stamp
    return message


def _value_to_message(value: EventValue) -> msg.EventValue:
    return msg.EventValue(name=value.name, value=value.value, unit=value.unit)


def message_to_record(message: msg.CommandRecord) -> CommandRecord:
    fields = {name: getattr(message, name) for name in _names(msg.CommandRecord)}
    values = _values_of(fields.pop("values_json"))
    return CommandRecord(arguments=fields.pop("arguments_json"), values=values, **fields)


def _values_of(values_json: str) -> dict[str, Value]:
    """None where a foreign message has no JSON object there."""
    try:
        values = json.loads(values_json) if values_json else {}
    except (ValueError, RecursionError):
        return {}
    return values if isinstance(values, dict) else {}


def event_of(data: bytes) -> Event:
    """Raises CncError 26184 for bytes that are no event, or one of a severity that there is not."""
    message = message_of(data, msg.Event)
    if message.severity > max(Severity):
        raise unreadable("Event", data, f"severity {message.severity} is not within 0 ... {max(Severity):d}")
    values = read_event_values(message)
    return Event(message.cycle, message.source, message.severity, message.error_id, message.text, message.line, values)


def request_to_message(request: HandshakeRequest, stamp: Time) -> msg.HandshakeRequest:
    return _flat(request, msg.HandshakeRequest, stamp)


def message_to_request(message: msg.HandshakeRequest) -> HandshakeRequest:
    return HandshakeRequest(**{name: getattr(message, name) for name in _names(msg.HandshakeRequest)})


def offsets_to_message(offsets: ChannelOffsets, stamp: Time) -> msg.ChannelOffsets:
    return _flat(offsets, msg.ChannelOffsets, stamp)


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
