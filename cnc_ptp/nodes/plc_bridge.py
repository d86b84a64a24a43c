"""`plc_bridge MACHINE.yaml`: the PLC interface (HLI). Topics of a PLC and the scenario become commands in PlcBlocks."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

import click

from cnc_ptp import msg
from cnc_ptp.axis.jog_commands import JOG
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.silence import Silence
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import node_command_line, process
from cnc_ptp.nodes.bridge.coupling_services import CouplingServices
from cnc_ptp.nodes.bridge.jog_topics import PATIENCE as JOG_PATIENCE
from cnc_ptp.nodes.bridge.jog_topics import JogTopics
from cnc_ptp.nodes.bridge.joint_states import JointStates
from cnc_ptp.nodes.bridge.sequence import is_newer
from cnc_ptp.nodes.bridge.setpoint_services import SetpointServices
from cnc_ptp.nodes.topics import LIFE_SIGN, PLC_INPUT, PLC_TOPICS, plc_quality, plc_topic
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters import AxisParameters, ChannelParameters, MachineParameters, SpindleParameters, read_machine
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command, CycleBlock, Severity
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.start_options import start_options, take_start

LIFE_SIGN_LOST = 26103
FACTOR_STALE = 26118
OVERRIDE_STALE = 26119
FULL_OVERRIDE = 100.0


class PlcBridgeNode(UnitNode):
    """UnitNode of the PLC.

    Publishes besides: /joint_states (sensor_msgs/JointState) of all axes and spindles, while somebody subscribes.
    Subscriptions besides: /<channel|axis|spindle>/override (Override), /<channel>/feed_hold (Switch),
    /<axis|spindle>/enable (Switch), /<axis>/feed_release (FeedRelease), /<axis>/external_setpoint (ExternalSetpoint),
    /<axis>/jog (Jog), /plc/life_sign (LifeSign). A jog ends when its messages stop. Of overrides, switches and
    releases a value counts when it changes; the last one holds when messages stop; `valid` = false means 100 %, no feed
    hold, enabled, released, and has no effect on a topic that was never valid. An override of a spindle that
    came in a rhythm and falls silent is an event. A life sign that was seen once and then is silent for P-MACH
    life_sign_timeout_ms sets feed hold on all channels.
    """

    def __init__(
        self, machine: MachineParameters, *, scenario: Iterable[Entry] = (), end_when_idle: bool = True, **options: Any
    ) -> None:
        entries = [without_text(entry) for entry in scenario]
        super().__init__(machine, build_unit(machine, PLC, scenario=entries, end_when_idle=end_when_idle), **options)
        self._sequence: dict[str, int] = {}
        self._last: dict[str, str] = {}
        self._served: set[str] = set()
        self._life_sign_timeout = machine.life_sign_timeout_ms / 1000.0
        self._life_sign_counter: int | None = None
        self._channels = list(machine.channels)
        units: Mapping[str, ChannelParameters | AxisParameters | SpindleParameters]
        units = {**machine.channels, **machine.axes, **machine.spindles}
        self._highest_override = {name: unit.max_override_percent for name, unit in units.items()}
        self._spindles = list(machine.spindles)
        self._life_signs = Silence(self._life_sign_timeout)
        self._overrides = Silence(self._life_sign_timeout, rhythm=True)
        self._factors = Silence(self._life_sign_timeout)
        self._jogs = JogTopics(self._warn)
        self._joints_due = 0
        self._answers: CouplingServices | None = None

    def setup(self) -> None:
        """As UnitNode, with the topics of the PLC, couplings and joint states."""
        super().setup()
        for unit, kind in self._kinds.items():
            for name, message_type in PLC_TOPICS.get(kind, {}).items():
                self.create_subscription(
                    message_type, plc_topic(unit, name), self._receiver(unit, name), plc_quality(message_type)
                )
        self.create_timer(JOG_PATIENCE / 4.0, self._watch_jogs)
        self.create_subscription(msg.LifeSign, LIFE_SIGN, self._on_life_sign, PLC_INPUT)
        self.create_timer(self._life_sign_timeout / 4.0, self._watch_topics)
        self._answers = CouplingServices(self, self.plc, list(self._machine.axes))
        SetpointServices(self, self.plc, self._machine.axes)
        self._joints = JointStates(self, self._machine)

    @property
    def plc(self) -> PlcUnit:
        """The unit."""
        assert isinstance(self.unit, PlcUnit)
        return self.unit

    def _receiver(self, unit: str, name: str) -> Callable[[Any], None]:
        """The callback for the messages of a topic in PLC_TOPICS."""
        series = {"external_setpoint": self._on_external_setpoint, "jog": self._on_jog}
        if name in series:
            return partial(series[name], unit)
        values: dict[str, Callable[[str, Any], Command | None]] = {
            "override": self._override,
            "feed_hold": partial(self._switch, command="feed_hold", idle=False),
            "enable": partial(self._switch, command="power", idle=True),
            "feed_release": self._feed_release,
            "coupling_factor": self._coupling_factor,
        }
        return partial(self._on_value, unit, f"/{unit}/{name}", values[name])

    def _on_value(self, unit: str, topic: str, command_of: Callable[[str, Any], Command | None], message: Any) -> None:
        """A value counts when it changes."""
        if not is_newer(message.sequence, self._sequence.get(topic, 0)):
            return
        self._sequence[topic] = message.sequence
        if message.valid:
            self._served.add(topic)
        elif topic not in self._served:
            return  # an empty message of a client that has never served the topic releases nothing
        command = command_of(unit, message)
        if command is not None and self._last.get(topic) != command.arguments_json:
            self._last[topic] = command.arguments_json
            self.input(command)

    def _override(self, unit: str, message: msg.Override) -> Command:
        if unit in self._spindles:
            self._overrides.heard(f"/{unit}/override", time.monotonic())
        full = min(FULL_OVERRIDE, self._highest_override[unit])
        return Command(unit, "set_override", {"percent": message.percent if message.valid else full})

    @staticmethod
    def _switch(unit: str, message: msg.Switch, *, command: str, idle: bool) -> Command:
        return Command(unit, command, {"enabled": message.enabled if message.valid else idle})

    @staticmethod
    def _feed_release(unit: str, message: msg.FeedRelease) -> Command:
        released = {"forward": message.forward or not message.valid, "backward": message.backward or not message.valid}
        return Command(unit, "set_feed_release", released)

    def _coupling_factor(self, unit: str, message: msg.CyclicCouplingFactor) -> Command | None:
        """If not valid, no number, or no slave: nothing changes."""
        topic = f"/{unit}/coupling_factor"
        coupled = self.plc.is_coupled(unit)
        if not coupled:
            self._last.pop(topic, None)  # what comes first after the next coupling is a change
        if not (coupled and message.valid):
            self._factors.forget(topic)
            return None
        if not math.isfinite(message.factor):
            return None
        self._factors.heard(topic, time.monotonic())
        return Command(unit, "set_cyclic_factor", {"factor": message.factor})

    def _watch_topics(self) -> None:
        """One timer for all of them: the executor warns of many."""
        self._watch_life_sign()
        self._watch_overrides()
        self._watch_factors()

    def _watch_factors(self) -> None:
        """A factor whose topic falls silent freezes: the last one holds, with a warning."""
        for topic in self._factors.fallen_silent(time.monotonic()):
            self._warn(FACTOR_STALE, f"plc: no message on {topic} for {self._silence}; the factor is unchanged")

    def _watch_overrides(self) -> None:
        """The last override of a spindle holds when its topic falls silent, with a warning."""
        for topic in sorted(self._overrides.fallen_silent(time.monotonic())):
            self._warn(OVERRIDE_STALE, f"plc: no message on {topic} for {self._silence}; the override is unchanged")

    @property
    def _silence(self) -> str:
        return f"{self._life_sign_timeout * 1000.0:.0f} ms"

    def _on_external_setpoint(self, axis: str, message: msg.ExternalSetpoint) -> None:
        """With a cycle it counts for that one, without (0) for the next block; `valid` = false ends the motion."""
        topic = f"/{axis}/external_setpoint"
        if not is_newer(message.sequence, self._sequence.get(topic, 0)):
            return
        self._sequence[topic] = message.sequence
        direction = message.direction if message.valid else 0
        row = [message.cycle, message.position, message.velocity, message.acceleration, direction]
        self.plc.setpoints.arrive(axis, row)

    def _on_jog(self, axis: str, message: msg.Jog) -> None:
        velocity = self._jogs.heard(axis, message, time.monotonic(), paced=self.paced)
        if velocity is not None:
            self.input(Command(axis, JOG, {"velocity": velocity}))

    def _watch_jogs(self) -> None:
        """A jog moves only while its messages come."""
        for axis in self._jogs.fallen_silent(time.monotonic()):
            self.input(Command(axis, JOG, {"velocity": 0.0}))

    def input(self, command: Command) -> None:
        """A command of a person or an external PLC, for the next block."""
        self.plc.input(command)

    def run_ended(self) -> None:
        if self._answers is not None:
            self._answers.end()

    def destroy_node(self) -> None:
        self.run_ended()
        super().destroy_node()

    def after_block(self, block: CycleBlock) -> None:
        """Joint states of the cycle before the block: the last one that axes and spindles have reported."""
        if not self._state_period or block.first_cycle < max(self._joints_due, 1):
            return
        self._joints_due = block.first_cycle + self._state_period
        if self._joints.wanted:
            self._joints.publish(self.plc.reported, self.stamp(block.first_cycle - 1))

    def stop_all(self) -> None:
        """Controlled stop of everything; the run ends when all is at a standstill, with or without a duration."""
        self.command(Command(PLC, "stop_all", {}))

    def _on_life_sign(self, message: msg.LifeSign) -> None:
        if message.counter != self._life_sign_counter:
            self._life_sign_counter = message.counter
            self._life_signs.heard(LIFE_SIGN, time.monotonic())

    def _watch_life_sign(self) -> None:
        """The external PLC: its silence sets feed hold, which only its next command ends."""
        if not self._life_signs.fallen_silent(time.monotonic()):
            return
        for channel in self._channels:
            self._served.add(f"/{channel}/feed_hold")
            hold = Command(channel, "feed_hold", {"enabled": True})
            self._last[f"/{channel}/feed_hold"] = hold.arguments_json  # so that the PLC's next `off` counts as a change
            self.input(hold)
        reason = f"no life sign of the external PLC for {self._silence}"
        self._warn(LIFE_SIGN_LOST, f"plc: {reason}; feed hold is set on all channels")

    def _warn(self, error_id: int, text: str) -> None:
        self.tell(Severity.WARNING, error_id, text)


def without_text(entry: Entry) -> Entry:
    """Loads and manual blocks travel without texts of programs: blocks go to every unit; the channel reads files."""
    command = entry.command
    if command.command not in ("load", "mdi"):
        return entry
    kept = ("program", "dialect") if command.command == "load" else ("text",)
    arguments = {name: command.arguments[name] for name in kept if name in command.arguments}
    return Entry(entry.at, Command(command.target, command.command, arguments))


@click.command()
@node_command_line.MACHINE
@click.option("--program", type=click.Path(dir_okay=False), help="NC program that the first channel loads and starts.")
@node_command_line.DIALECT
@click.option("--scenario", type=click.Path(dir_okay=False), help="Timed PLC commands (YAML).")
@click.option("--stay", is_flag=True, help="Continue when everything is at a standstill, instead of ending the run.")
@start_options
@node_command_line.RECORDERS
@node_command_line.STATE_RATE
@node_command_line.FREE_RUN
def command(
    machine: str, program: str | None, dialect: str | None, scenario: str | None, stay: bool, **options: Any
) -> None:
    """Runs the PLC interface of MACHINE as a ROS node; plays a scenario."""
    begin = take_start(options, program)

    def make() -> PlcBridgeNode:
        parameters = read_machine(machine)
        node = PlcBridgeNode(
            parameters,
            scenario=read_entries(parameters, program=program, scenario=scenario, dialect=dialect, begin=begin),
            end_when_idle=not stay,
            **options,
        )
        node.setup()
        return node

    sys.exit(process.run_unit(make, name=PLC))


def main() -> None:
    node_command_line.call(command)


if __name__ == "__main__":
    main()
