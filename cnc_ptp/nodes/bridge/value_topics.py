"""Values that a PLC writes cyclically, one topic for each: overrides, feed hold, enables, feed releases, factors.

The newest message of a block counts, and only a change is a command. Messages come as bytes when the node looks.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

from cnc_ptp.machine.silence import Silence, patience_of
from cnc_ptp.nodes.topics import VALUE_TOPICS
from cnc_ptp.parameters import AxisParameters, ChannelParameters, MachineParameters, SpindleParameters
from cnc_ptp.plc.hli.object_control import OUT_OF_SEQUENCE
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.sequence import is_newer
from cnc_ptp.protocol.blocks import Command, CycleBlock
from cnc_ptp.wire.fixed_message import FixedMessage

FACTOR_STALE = 26118
OVERRIDE_STALE = 26119
FULL_OVERRIDE = 100.0

Fields = Mapping[str, Any]
CommandOf = Callable[[str, Fields], Command | None]


class ValueTopics:
    """What has come on the value topics since the last block, and what was commanded of it before."""

    def __init__(
        self,
        machine: MachineParameters,
        plc: PlcUnit,
        warn: Callable[[int, str], None],
        admits: Callable[[Command], bool] = lambda command: True,
    ) -> None:
        """`warn(number, text)`: publishes what happens to messages. `admits`: topics may give this command."""
        self._admits = admits
        units: Mapping[str, ChannelParameters | AxisParameters | SpindleParameters]
        units = {**machine.channels, **machine.axes, **machine.spindles}
        self._highest_override = {name: unit.max_override_percent for name, unit in units.items()}
        self._spindles = list(machine.spindles)
        self._plc = plc
        self._warn = warn
        self._timeout_text = f"{machine.life_sign_timeout_ms} ms"
        timeout = patience_of(machine.life_sign_timeout_ms)
        self._overrides, self._factors = Silence(timeout, rhythm=True), Silence(timeout)
        self._sequence: dict[str, int] = {}
        self._disordered: set[str] = set()
        self._served: set[str] = set()
        self._newest: dict[str, Command] = {}
        self._last: dict[str, str] = {}
        self._readers = {of: FixedMessage(f"cnc_ptp/msg/{of.__name__}") for of in {*VALUE_TOPICS.values()}}
        plc.outside.append(self._commands)

    def receiver(self, unit: str, name: str) -> Callable[[bytes], None]:
        """Takes the messages of a topic in VALUE_TOPICS as bytes."""
        values: dict[str, CommandOf] = {
            "override": self._override,
            "feed_hold": partial(switch, command="feed_hold", idle=False),
            "enable": partial(switch, command="power", idle=True),
            "feed_release": feed_release,
            "coupling_factor": self._coupling_factor,
        }
        return partial(self._receive, self._readers[VALUE_TOPICS[name]], unit, f"/{unit}/{name}", values[name])

    def _receive(self, reader: FixedMessage, unit: str, topic: str, command_of: CommandOf, data: bytes) -> None:
        self.take(unit, topic, command_of, reader.read(data)[1])

    def take(self, unit: str, topic: str, command_of: CommandOf, message: Fields) -> None:
        """The newest value of a block counts."""
        if not self._in_sequence(topic, message["sequence"]):
            return
        if message["valid"]:
            self._served.add(topic)
        elif topic not in self._served:
            return  # an empty message of a client that has never served the topic releases nothing
        command = command_of(unit, message)
        if command is not None:
            self._newest[topic] = command

    def _in_sequence(self, topic: str, sequence: int) -> bool:
        last = self._sequence.get(topic, 0)
        if is_newer(sequence, last):
            self._sequence[topic] = sequence
            self._disordered.discard(topic)
            return True
        if sequence != last and topic not in self._disordered:
            self._disordered.add(topic)
            self._warn(OUT_OF_SEQUENCE, f"plc: message {sequence} on {topic} comes after {last}; it is ignored")
        return False

    def _commands(self, cycle: int, inputs: Mapping[str, CycleBlock]) -> Iterator[Command]:
        """For PlcUnit: of each topic the newest value, if it is another one than before."""
        newest, self._newest = self._newest, {}
        for topic, command in newest.items():
            arguments = command.arguments_json
            if self._last.get(topic) != arguments:
                self._last[topic] = arguments
                if self._admits(command):
                    yield command

    def _override(self, unit: str, message: Fields) -> Command:
        if unit in self._spindles:
            self._overrides.heard(f"/{unit}/override", time.monotonic())
        full = min(FULL_OVERRIDE, self._highest_override[unit])
        return Command(unit, "set_override", {"percent": message["percent"] if message["valid"] else full})

    def _coupling_factor(self, unit: str, message: Fields) -> Command | None:
        """If not valid, no number, or no slave: nothing changes."""
        topic = f"/{unit}/coupling_factor"
        coupled = self._plc.is_coupled(unit)
        if not coupled:
            self._last.pop(topic, None)  # what comes first after the next coupling is a change
        if not (coupled and message["valid"]):
            self._factors.forget(topic)
            return None
        if not math.isfinite(message["factor"]):
            return None
        self._factors.heard(topic, time.monotonic())
        return Command(unit, "set_cyclic_factor", {"factor": message["factor"]})

    def hold_feed(self, unit: str) -> None:
        """A feed hold that only the next command of the PLC ends: whatever that is, it counts as a change."""
        topic = f"/{unit}/feed_hold"
        self._served.add(topic)
        self._newest.pop(topic, None)
        self._last.pop(topic, None)
        self._plc.input(Command(unit, "feed_hold", {"enabled": True}))

    def watch(self) -> None:
        """What has fallen silent: the last value holds, with a warning."""
        now = time.monotonic()
        for topic in sorted(self._overrides.fallen_silent(now)):
            self._warn(OVERRIDE_STALE, f"{self._silence_on(topic)}; the override is unchanged")
        for topic in self._factors.fallen_silent(now):
            self._warn(FACTOR_STALE, f"{self._silence_on(topic)}; the factor is unchanged")

    def _silence_on(self, topic: str) -> str:
        return f"plc: no message on {topic} for {self._timeout_text}"


def switch(unit: str, message: Fields, *, command: str, idle: bool) -> Command:
    return Command(unit, command, {"enabled": message["enabled"] if message["valid"] else idle})


def feed_release(unit: str, message: Fields) -> Command:
    released = {side: message[side] or not message["valid"] for side in ("forward", "backward")}
    return Command(unit, "set_feed_release", released)
