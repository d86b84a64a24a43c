"""`plc_bridge MACHINE.yaml`: the PLC interface (HLI). Topics of a PLC and the scenario become commands in PlcBlocks."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable
from functools import partial
from math import isfinite
from typing import Any

import click

from cnc_ptp import msg
from cnc_ptp.axis.external_commands import SETPOINTS
from cnc_ptp.axis.jog_commands import JOG
from cnc_ptp.errors import CncError
from cnc_ptp.machine.plc_file import read_plc
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.silence import Silence, patience_of
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import node_command_line, process
from cnc_ptp.nodes.bridge.coupling_services import CouplingServices
from cnc_ptp.nodes.bridge.function_blocks import FunctionBlockActions
from cnc_ptp.nodes.bridge.hli.emergency_stop import EmergencyStopTopics
from cnc_ptp.nodes.bridge.hli.hli_topics import HliTopics
from cnc_ptp.nodes.bridge.jog_topics import JogTopics
from cnc_ptp.nodes.bridge.joint_states import JointStates
from cnc_ptp.nodes.bridge.plc_watch import PlcWatch
from cnc_ptp.nodes.bridge.setpoint_services import SetpointServices
from cnc_ptp.nodes.bridge.trajectory_server import TrajectoryServer
from cnc_ptp.nodes.bridge.value_topics import ValueTopics
from cnc_ptp.nodes.topics import (
    ACKNOWLEDGED,
    LIFE_SIGN,
    PLC_INPUT,
    PLC_TOPICS,
    VALUE_TOPICS,
    plc_quality,
    plc_topic,
)
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.parameters.view.authority import OF_PLC, OF_SERVICES, OF_TOPICS
from cnc_ptp.plc.hli.hli import Hli
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.program.plc_program import PlcFile
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.plc.sequence import is_newer
from cnc_ptp.protocol.authority import require_axes_open
from cnc_ptp.protocol.blocks import Command, CommandRecord, CycleBlock, PlcBlock, Severity
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.start_options import start_options, take_start

LIFE_SIGN_LOST = 26103
INPUT_PERIOD = 0.005
"""Seconds between two looks for values of a PLC in free run."""


class PlcBridgeNode(UnitNode):
    """UnitNode of the PLC.

    Publishes besides, while somebody subscribes: /<unit>/hli/status of each axis, spindle and channel once per block,
    /joint_states (sensor_msgs/JointState) of all axes and spindles; /emergency_stop/active (std_msgs/Bool).
    Subscriptions besides: /<channel|axis|spindle>/override (Override), /<channel|axis|spindle>/feed_hold (Switch),
    /<axis|spindle>/enable (Switch), /<axis>/feed_release (FeedRelease), /<axis>/external_setpoint (ExternalSetpoint),
    /<axis>/jog (Jog), /plc/life_sign (LifeSign), /<unit>/hli/control (<Kind>HliControl), /emergency_stop (Bool),
    /plc/acknowledged (Event; published again on /events).
    Services besides: /emergency_stop/press, release, reset (std_srvs/Trigger).
    Actions: /trajectory/follow_joint_trajectory (FollowTrajectory), beside the topic /trajectory/joint_trajectory;
    /<axis|spindle>/function_block (FunctionBlock); cancel = halt.
    A jog ends when its messages stop. Of overrides, switches and releases a value counts when it changes; the last one
    holds when messages stop; `valid` = false means 100 %, no feed hold, enabled, released, and has no effect on a topic
    that was never valid. An override of a spindle that came in a rhythm and falls silent is an event. A life sign that
    was seen once and then is silent for P-MACH life_sign_timeout_ms sets feed hold on all channels, axes and spindles.
    """

    def __init__(
        self,
        machine: MachineParameters,
        *,
        scenario: Iterable[Entry] = (),
        plc_file: PlcFile | None = None,
        end_when_idle: bool = True,
        **options: Any,
    ) -> None:
        entries = [without_text(entry) for entry in scenario]
        unit = build_unit(machine, PLC, scenario=entries, end_when_idle=end_when_idle, plc_file=plc_file)
        super().__init__(machine, unit, **options)
        if self.plc.program is not None:
            self.plc.program.guard = PlcWatch(
                machine.watchdog_ms,
                block_ms=machine.block_cycles * machine.cycle_time_us / 1000.0,
                paced=lambda: self.paced,
            )
        self._sequence: dict[str, int] = {}
        self._life_sign_timeout = patience_of(machine.life_sign_timeout_ms)
        self._life_sign_counter: int | None = None
        self._life_signs = Silence(self._life_sign_timeout)
        self._values = ValueTopics(machine, self.plc, self._warn, self._admits)
        self._closed_topics: set[tuple[str, str]] = set()
        self._hli = Hli(
            self.plc,
            kinds=self._kinds,
            largest_overrides=largest_overrides(machine),
            timeout=self._life_sign_timeout,
            numbers={
                **{name: axis.number for name, axis in machine.axes.items()},
                **{name: spindle.number for name, spindle in machine.spindles.items()},
            },
        )
        self.input_period = INPUT_PERIOD
        self._jogs = JogTopics(self._warn)
        self._joints_due = 0
        self._answers: CouplingServices | None = None
        self._trajectories: TrajectoryServer | None = None
        self._function_blocks: FunctionBlockActions | None = None

    def setup(self) -> None:
        """As UnitNode, with the topics of the PLC, couplings and joint states."""
        super().setup()
        for unit, kind in self._kinds.items():
            for name in PLC_TOPICS.get(kind, {}):
                self._listen(unit, name)
        self._hli_topics = HliTopics(self, self._hli)
        self._emergency_stop = EmergencyStopTopics(self, self.plc, self._warn)
        self.create_subscription(msg.LifeSign, LIFE_SIGN, self._on_life_sign, PLC_INPUT)
        self.create_subscription(msg.Event, ACKNOWLEDGED, self._publications.pass_on, PLC_INPUT)
        if isfinite(self._life_sign_timeout):
            process.timer(self, self._life_sign_timeout / 4.0, self._watch_topics)
        self._answers = CouplingServices(self, self.plc, list(self._machine.axes))
        SetpointServices(self, self.plc, self._machine.axes)
        self._trajectories = TrajectoryServer(self, self.plc, self._machine)
        self._function_blocks = FunctionBlockActions(self, self.plc, self._kinds, self._machine)
        self._joints = JointStates(self, self._machine)

    def _listen(self, unit: str, name: str) -> None:
        """To a topic of PLC_TOPICS; those of the HLI are read by HliTopics."""
        series = {"external_setpoint": self._on_external_setpoint, "jog": self._on_jog}
        topic = plc_topic(unit, name)
        if name in VALUE_TOPICS:
            self.poll_input(VALUE_TOPICS[name], topic, self._values.receiver(unit, name), PLC_INPUT)
        elif name in series:
            message_type = PLC_TOPICS[self._kinds[unit]][name]
            self.create_subscription(message_type, topic, partial(series[name], unit), plc_quality(message_type))

    def before_block(self) -> None:
        """Overrides and the like that have come count for this block."""
        if not self._free_run:
            self.take_written_inputs()

    @property
    def plc(self) -> PlcUnit:
        """The unit."""
        assert isinstance(self.unit, PlcUnit)
        return self.unit

    def _watch_topics(self) -> None:
        """One timer for all of them: the executor warns of many."""
        self.take_inputs()
        self.look()
        self._watch_life_sign()
        self._values.watch()
        self._hli_topics.watch()

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
        if direction and not self._admits(Command(axis, SETPOINTS)):
            return
        row = [message.cycle, message.position, message.velocity, message.acceleration, direction]
        self.plc.setpoints.arrive(axis, row)

    def _on_jog(self, axis: str, message: msg.Jog) -> None:
        moves = message.valid and message.velocity != 0.0
        if moves and not self._admits(Command(axis, JOG, {"velocity": message.velocity})):
            return
        velocity = self._jogs.heard(axis, message, time.monotonic(), paced=self.paced)
        if velocity is not None:
            self.input(Command(axis, JOG, {"velocity": velocity}))

    def _watch_jogs(self) -> None:
        """A jog moves only while its messages come."""
        for axis in self._jogs.fallen_silent(time.monotonic()):
            self.input(Command(axis, JOG, {"velocity": 0.0}))

    def _admits(self, command: Command) -> bool:
        """Topics may give it; the first one of a unit and name that they may not give is a warning."""
        error = self.why_closed(command, OF_TOPICS)
        what = command.target, command.command
        if error is not None and what not in self._closed_topics:
            self._closed_topics.add(what)
            self._warn(error.number, error.message)
        return error is None

    def command(self, command: Command, source: str | None = OF_SERVICES) -> CommandRecord:
        """As UnitNode; a trajectory takes the authority over all of its axes."""
        try:
            if source is not None:
                require_axes_open(command, self._machine.closed, source)
        except CncError as error:
            return self.refuse(command, error)
        return super().command(command, source)

    def input(self, command: Command) -> None:
        """A command of a person or an external PLC, for the next block."""
        self.plc.input(command)

    def run_ended(self) -> None:
        if self._answers is not None:
            self._answers.end()
        if self._trajectories is not None:
            self._trajectories.end()
        if self._function_blocks is not None:
            self._function_blocks.end()

    def destroy_node(self) -> None:
        self.run_ended()
        super().destroy_node()

    def after_block(self, block: CycleBlock) -> None:
        """Ends silent jogs. HLI and joint states are of the last cycle that axes and spindles have reported."""
        self._watch_jogs()
        if isinstance(block, PlcBlock):
            self._hli_topics.publish(self.plc, block, self.stamp)
        if self._trajectories is not None:
            self._trajectories.after_block(block)
        self._emergency_stop.show()
        if self._function_blocks is not None:
            self._function_blocks.after_block()
        if not self._state_period or block.first_cycle < max(self._joints_due, 1):
            return
        self._joints_due = block.first_cycle + self._state_period
        if self._joints.wanted:
            self._joints.publish(self.plc.reported, self.stamp(block.first_cycle - 1))

    def stop_all(self) -> None:
        """Controlled stop of everything; the run ends when all is at a standstill, with or without a duration."""
        self.command(Command(PLC, "stop_all", {}), None)

    def _on_life_sign(self, message: msg.LifeSign) -> None:
        if message.counter != self._life_sign_counter:
            self._life_sign_counter = message.counter
            self._life_signs.heard(LIFE_SIGN, time.monotonic())

    def _watch_life_sign(self) -> None:
        """The external PLC: its silence sets feed hold, which only its next command ends, or a person's.

        What a channel, a master or external setpoints move stops with them. A unit that is closed to the PLC is left
        alone: the PLC could not release it.
        """
        if not self._life_signs.fallen_silent(time.monotonic()):
            return
        closed = self._machine.closed
        held = [unit for unit in self._hli.objects if not self.plc.is_led(unit) and OF_PLC not in closed.get(unit, ())]
        for unit in held:
            self._hli.objects[unit].hold_feed()
            self._values.hold_feed(unit)
        reason = f"no life sign of the external PLC for {self._silence}"
        self._warn(LIFE_SIGN_LOST, f"plc: {reason}; feed hold is set on {', '.join(held) or 'nothing'}")

    def _warn(self, error_id: int, text: str) -> None:
        self.tell(Severity.WARNING, error_id, text)


def largest_overrides(machine: MachineParameters) -> dict[str, float]:
    """Percent, by unit; an axis has at most 100."""
    axes = {name: min(100.0, axis.max_override_percent) for name, axis in machine.axes.items()}
    channels = {name: channel.max_override_percent for name, channel in machine.channels.items()}
    return axes | channels | {name: spindle.max_override_percent for name, spindle in machine.spindles.items()}


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
@click.option("--plc", type=click.Path(dir_okay=False), help="PLC in a file: a Python class Plc with cycle(io).")
@click.option("--stay", is_flag=True, help="Continue when everything is at a standstill, instead of ending the run.")
@start_options
@node_command_line.RECORDERS
@node_command_line.STATE_RATE
@node_command_line.CHECKPOINTS
@node_command_line.FREE_RUN
def command(
    machine: str,
    program: str | None,
    dialect: str | None,
    scenario: str | None,
    plc: str | None,
    stay: bool,
    **options: Any,
) -> None:
    """Runs the PLC interface of MACHINE as a ROS node; plays a scenario, runs a PLC in a file."""
    begin = take_start(options, program)

    def make() -> PlcBridgeNode:
        parameters = read_machine(machine)
        node = PlcBridgeNode(
            parameters,
            scenario=read_entries(parameters, program=program, scenario=scenario, dialect=dialect, begin=begin),
            plc_file=None if plc is None else read_plc(plc),
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
