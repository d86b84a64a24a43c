"""/<unit>/hli/control and /<unit>/hli/status of each axis, spindle and channel."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.publisher import Publisher
from rclpy.serialization import deserialize_message

from cnc_ptp.nodes import convert
from cnc_ptp.nodes.polling_node import PollingNode
from cnc_ptp.nodes.topics import HLI_CONTROL, HLI_STATUS, PLC_EDGES, PLC_INPUT, hli_control_topic, hli_status_topic
from cnc_ptp.plc.hli.hli import Hli
from cnc_ptp.plc.hli.messages import control_message
from cnc_ptp.plc.hli.object_control import ObjectControl
from cnc_ptp.plc.hli.status import status
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.protocol.blocks import CycleBlock, PlcBlock
from cnc_ptp.wire.fixed_message import FixedMessage

SEQUENCE_BYTES = 4


class ControlTopic:
    """Reads the control messages of one object: at 1 kHz most of them say what the one before has said."""

    def __init__(self, control: ObjectControl, reader: FixedMessage) -> None:
        self._control = control
        self._reader = reader
        self._last = b""
        """What followed the sequence number in the last message that counts; empty for another encapsulation."""

    def receive(self, data: bytes) -> None:
        """A message as bytes."""
        now = time.monotonic()
        source, end = self._reader.split(data)
        begin = end + -end % SEQUENCE_BYTES
        rest = data[begin + SEQUENCE_BYTES :] if end >= 0 else b""
        if rest and rest == self._last:
            sequence = int.from_bytes(data[begin : begin + SEQUENCE_BYTES], "little")
            if self._control.heard(source, sequence, now):
                return
        source, fields = self._reader.read(data)
        counts = self._control.take(control_message(self._control.kind, source, fields), now)
        self._last = rest if counts else b""


def control_reader(kind: str) -> FixedMessage:
    """Reads the control messages of a kind of object."""
    of = HLI_CONTROL[kind]
    return FixedMessage(f"cnc_ptp/msg/{of.__name__}", partial(deserialize_message, message_type=of))


class HliTopics:
    """Subscribes to the control topics, publishes the status topics once per block while somebody subscribes."""

    def __init__(self, node: PollingNode, hli: Hli) -> None:
        self._hli = hli
        self._publishers: dict[str, Publisher[Any]] = {}
        readers = {kind: control_reader(kind) for kind in HLI_CONTROL}
        for name, control in hli.objects.items():
            topic = ControlTopic(control, readers[control.kind])
            node.poll_input(HLI_CONTROL[control.kind], hli_control_topic(name), topic.receive, PLC_EDGES)
            status_type = HLI_STATUS[control.kind]
            self._publishers[name] = node.create_publisher(status_type, hli_status_topic(name), PLC_INPUT)

    def watch(self) -> None:
        self._hli.watch(time.monotonic())

    def publish(self, plc: PlcUnit, block: PlcBlock, stamp_of: Callable[[int], Time]) -> None:
        """The status of all objects, as they reported for the block before `block`."""
        for name, publisher in self._publishers.items():
            if publisher.get_subscription_count():
                publisher.publish(self._message(name, plc, block, stamp_of))

    def _message(self, name: str, plc: PlcUnit, block: PlcBlock, stamp_of: Callable[[int], Time]) -> Any:
        control = self._hli.objects[name]
        message = HLI_STATUS[control.kind](life_sign=block.life_sign)
        reported: CycleBlock | None = plc.reported.get(name)
        if reported is None or isinstance(reported, PlcBlock):
            message.header.stamp = stamp_of(block.first_cycle)
            return message
        fill(message, status(control, reported))
        message.valid = not plc.is_lost(name)
        message.header.stamp = stamp_of(message.cycle)
        if control.kind == "channel":
            requests = plc.requests_of(name)
            message.requests = [convert.request_to_message(each, stamp_of(each.cycle)) for each in requests]
        return message


def fill(message: Any, fields: Mapping[str, Any]) -> None:
    """Sets the fields of a message, those of nested ones too."""
    for name, value in fields.items():
        if isinstance(value, Mapping):
            fill(getattr(message, name), value)
        else:
            setattr(message, name, value)
