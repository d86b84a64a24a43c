"""The emergency stop of the machine: /emergency_stop (Bool) presses it, and the services beside it (Trigger)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from std_msgs.msg import Bool
from std_srvs.srv import Trigger

from cnc_ptp.nodes.topics import EMERGENCY_STOP_TOPIC, LATEST, PLC_INPUT
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.protocol.blocks import Command, CommandRecord
from cnc_ptp.protocol.unit import PLC

SEVERAL_BUTTONS = 26229
COMMANDS: dict[str, tuple[str, dict[str, bool]]] = {
    "press": ("emergency_stop", {"enabled": True}),
    "release": ("emergency_stop", {"enabled": False}),
    "reset": ("reset", {}),
}
"""Services /emergency_stop/<name> -> command."""


class EmergencyStopTopics:
    """A button on a topic, buttons as services, and whether the emergency stop holds.

    `true` presses it, as often as it comes; `false` behind a `true` releases it, unless there are several buttons:
    nobody knows whose `true` it was. A release moves nothing: each unit that was stopped wants a reset.
    """

    def __init__(self, node: UnitNode, plc: PlcUnit, warn: Callable[[int, str], None]) -> None:
        """`warn(number, text)`: publishes what happens to the messages."""
        self._plc = plc
        self._node = node
        self._warn = warn
        self._told = False
        self._button = False
        self._shown: bool | None = None
        self._publisher = node.create_publisher(Bool, f"{EMERGENCY_STOP_TOPIC}/active", LATEST)
        node.create_subscription(Bool, EMERGENCY_STOP_TOPIC, self._on_button, PLC_INPUT)
        for name in COMMANDS:
            node.create_service(Trigger, f"{EMERGENCY_STOP_TOPIC}/{name}", partial(self._on_service, name))
        self.show()

    def _on_button(self, message: Bool) -> None:
        before, self._button = self._button, bool(message.data)
        if self._button and not self._plc.emergency:
            self._give("press")
        elif before and not self._button and self._plc.emergency:
            self._release()

    def _release(self) -> None:
        count = self._node.count_publishers(EMERGENCY_STOP_TOPIC)
        if count <= 1:
            self._give("release")
        elif not self._told:
            self._told = True
            self._warn(
                SEVERAL_BUTTONS,
                f"plc: /{EMERGENCY_STOP_TOPIC} has {count} publishers, and one says false; "
                f"the emergency stop holds until /{EMERGENCY_STOP_TOPIC}/release is called",
            )

    def _give(self, name: str) -> CommandRecord:
        command, arguments = COMMANDS[name]
        record = self._node.command(Command(PLC, command, dict(arguments)))
        self._told = False
        self.show()
        return record

    def _on_service(self, name: str, _request: Any, response: Any) -> Any:
        record = self._give(name)
        response.success, response.message = record.accepted, record.message
        return response

    def show(self) -> None:
        """Publishes whether the emergency stop holds, when that has changed."""
        if self._plc.emergency != self._shown:
            self._shown = self._plc.emergency
            self._publisher.publish(Bool(data=self._shown))
