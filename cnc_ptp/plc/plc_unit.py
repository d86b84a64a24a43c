"""The PLC: plays the scenario, passes on commands from topics, acknowledges M functions, ends the run."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from typing import ClassVar

from cnc_ptp.axis.external_commands import SETPOINTS
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import AxisParameters
from cnc_ptp.plc.axis_groups import AxisGroups
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.plc.setpoint_file import SetpointRow, check_setpoints, placed
from cnc_ptp.plc.setpoint_queue import SetpointQueue
from cnc_ptp.plc.spindle_answers import spindle_answers
from cnc_ptp.protocol.axis_states import REST_STATES, AxisStateCode, StatusBit
from cnc_ptp.protocol.blocks import (
    AxisBlock,
    ChannelBlock,
    Command,
    CycleBlock,
    CycleTick,
    HandshakeRequest,
    PlcBlock,
    Severity,
    SpindleBlock,
)
from cnc_ptp.protocol.unit import UPSTREAM_LOST, Unit

NOTHING_TO_ACKNOWLEDGE = 22013
CANNOT_GO_ON = 22014
SETTLING_TIME = 0.2
"""Seconds that everything must have been at a standstill before a run ends, so that the drives have come to rest."""

SPINDLE_AT_WORK = (AxisStateCode.DISCRETE_MOTION, AxisStateCode.HOMING, AxisStateCode.STOPPING)
STOP_COMMAND = {"axis": "stop", "spindle": "stop", "channel": "reset"}


class PlcUnit(Unit):
    """Commands of the scenario and of the outside world go out in PlcBlocks and act in the same block everywhere.

    The PLC knows of the units what they reported for the previous block.
    """

    kind: ClassVar[str] = "plc"

    def __init__(
        self,
        name: str,
        *,
        kinds: Mapping[str, str],
        axes: Mapping[str, AxisParameters] | None = None,
        scenario: Iterable[Entry] = (),
        cycle_time: float,
        end_when_idle: bool = True,
    ) -> None:
        """`kinds`: unit name -> axis, spindle, channel; `axes`: parameters by name. `cycle_time` in s.

        `end_when_idle`: the run ends automatically.
        """
        super().__init__(name)
        self._kinds = {unit: kind for unit, kind in kinds.items() if kind != "plc"}
        self._scenario = deque(scenario)
        self._cycle_time = cycle_time
        self._end_when_idle = end_when_idle
        spindles = {unit for unit, kind in self._kinds.items() if kind == "spindle"}
        self._groups = AxisGroups(axes or {}, cycle_time=cycle_time, spindles=spindles)
        self._outgoing: list[Command] = []
        self.setpoints = SetpointQueue(cycle_time=cycle_time, warn=self._warn)
        """External setpoints that scenario and topics give."""
        self._auto_acknowledge = True
        self._pending: dict[int, HandshakeRequest] = {}
        self._life_sign_on = True
        self._life_sign = 0
        self._commands_sent = 0
        self._idle_cycles = 0
        self._lost: set[str] = set()
        self._failed = False
        self.reported: Mapping[str, CycleBlock] = {}
        """The units' blocks previous to the one computed last."""

    def is_coupled(self, axis: str) -> bool:
        """True for a slave, as it has reported."""
        block = self.reported.get(axis)
        return isinstance(block, AxisBlock) and bool(block.master)

    def is_lost(self, unit: str) -> bool:
        return unit in self._lost

    def input(self, command: Command) -> None:
        """A command from outside (topic, button): goes out with the next block."""
        self._outgoing.append(command)

    def give_setpoints(self, axis: str, rows: list[SetpointRow], cycle: int) -> None:
        """External setpoints as a series; they count from `cycle`, that of the next block, if that is after the first.

        Raises CncError 22001.
        """
        check_setpoints(axis, rows)
        self.setpoints.add(axis, placed(rows, cycle))

    def withdraw(self, command: Command) -> bool:
        """Takes an `input` back; False when it has gone out with a block."""
        waits = any(each is command for each in self._outgoing)
        self._outgoing = [each for each in self._outgoing if each is not command]
        return waits

    # commands

    def do_acknowledge(self, cycle: int, *, id: int) -> None:
        """Acknowledges a handshake request; refused (22013) when none of that number waits."""
        request = self._pending.pop(id, None)
        if request is None:
            waiting = ", ".join(map(str, self._pending)) or "none"
            raise CncError(
                NOTHING_TO_ACKNOWLEDGE,
                f"no request {id} waits",
                f"nothing was changed. Waiting: {waiting}",
                where=f"plc {self.name}: acknowledge refused",
                request=id,
            )
        self._outgoing.append(Command(request.channel, "acknowledge", {"id": id}))

    def do_auto_acknowledge(self, cycle: int, *, enabled: bool) -> None:
        """Acknowledges every request automatically (the default), or leaves that to `acknowledge`."""
        self._auto_acknowledge = enabled

    def do_set_life_sign(self, cycle: int, *, enabled: bool) -> None:
        """Stops or resumes the life sign; without it all units stop after the watchdog time."""
        self._life_sign_on = enabled

    def do_stop_all(self, cycle: int) -> None:
        """Controlled stop of everything: channels are reset, axes and spindles stopped on their ramps.

        Left out is what stops with its channel (axes on the path) and channels in error, which stop on their own;
        external setpoints superimposed on a path are disabled.
        """
        self._scenario.clear()
        self.setpoints.clear()
        self._end_when_idle = True
        for unit, kind in self._kinds.items():
            block = self.reported.get(unit)
            if unit not in self._lost and (block is None or needs_stop(block) or self._let_go(unit, block)):
                waits_for_gear = isinstance(block, SpindleBlock) and block.gear_request
                self._outgoing.append(Command(unit, "reset" if waits_for_gear else STOP_COMMAND[kind], {}))
            elif unit not in self._lost and has_external_setpoints(block):
                self._outgoing.append(Command(unit, "external_disable", {}))

    def _let_go(self, unit: str, block: CycleBlock) -> bool:
        """True for a slave that has not reported yet that it was decoupled: no other unit stops it."""
        if not (isinstance(block, AxisBlock) and block.master):
            return False
        now = any(command.target == unit and command.command == "decouple" for command in self._outgoing)
        return now or not self._groups.above(unit)

    def do_upstream_lost(self, cycle: int, *, source: str) -> None:
        """Watchdog: `source` is lost; the run has failed."""
        self._lost.add(source)
        self._fail(cycle, UPSTREAM_LOST, f"no block of '{source}' came within the watchdog time")

    def do_abort(self, cycle: int, *, reason: str) -> None:
        """Harness: the run cannot continue; it has failed."""
        self._fail(cycle, CANNOT_GO_ON, reason)

    def _fail(self, cycle: int, error_id: int, reason: str) -> None:
        self._failed = True
        text = f"plc {self.name}: {reason}; everything is stopped and the run ends"
        self.event(cycle, Severity.ERROR, error_id, text)
        self.do_stop_all(cycle)

    def _warn(self, cycle: int, number: int, text: str) -> None:
        self.event(cycle, Severity.WARNING, number, text)

    # one block

    def step(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> PlcBlock:
        """Computes one block from the units' previous blocks."""
        first_cycle, count = tick
        self.reported = inputs
        self._outgoing += self._groups.report(first_cycle, inputs)
        self.setpoints.watch(inputs)
        self._play_scenario(first_cycle)
        self._answer_requests(first_cycle, inputs)
        self._outgoing += spindle_answers(inputs, changes_gears=self._auto_acknowledge)
        self._outgoing += self.setpoints.take(first_cycle, count)
        run_done = self._end_when_idle and self._run_done(count, inputs)
        if self._life_sign_on:
            self._life_sign += 1
        commands, self._outgoing = self._groups.complete(self._outgoing, self._lost)
        for command in commands:
            self._commands_sent += 1
            command.id = self._commands_sent
        return PlcBlock(
            first_cycle,
            count,
            life_sign=self._life_sign,
            scenario_done=not (self._scenario or self._outgoing or self.setpoints),
            run_done=run_done and not (commands or self._outgoing),
            run_failed=self._failed or any(error_of(block) for block in inputs.values()),
            commands=commands,
        )

    def _play_scenario(self, first_cycle: int) -> None:
        now = first_cycle * self._cycle_time
        while self._scenario and self._scenario[0].at <= now * (1.0 + 1e-12):
            command = self._scenario.popleft().command
            if command.target == self.name:
                self.command(command, first_cycle)
            elif command.command == SETPOINTS:
                self.setpoints.add(command.target, placed(command.arguments["setpoints"], first_cycle))
            else:
                self._outgoing.append(command)

    def _answer_requests(self, cycle: int, inputs: Mapping[str, CycleBlock]) -> None:
        for name, block in inputs.items():
            if isinstance(block, ChannelBlock):
                self._pending |= {request.id: request for request in block.requests if request.acknowledge_needed}
                if block.done:  # a program that is finished, or was aborted, waits for nothing
                    self._pending = {n: r for n, r in self._pending.items() if r.channel != name}
        if self._auto_acknowledge:
            for request_id in list(self._pending):
                self.do_acknowledge(cycle, id=request_id)

    def _run_done(self, count: int, inputs: Mapping[str, CycleBlock]) -> bool:
        """Everything has been at a standstill for the settling time; spindles that still turn are stopped first."""
        expected = set(self._kinds) - self._lost
        idle = not (self._scenario or self._outgoing or self.setpoints) and expected <= inputs.keys()
        idle = idle and all(at_rest(block) for block in inputs.values())
        self._idle_cycles = self._idle_cycles + count if idle else 0
        if self._idle_cycles * self._cycle_time < SETTLING_TIME:
            return False
        turning = [
            name for name, block in inputs.items() if isinstance(block, SpindleBlock) and block.set_speed_rpm[-1]
        ]
        if turning:
            self._outgoing += [Command(name, "stop", {}) for name in turning]
            self._idle_cycles = 0
        return not turning


def at_rest(block: CycleBlock) -> bool:
    """True when a unit has no job of its own; a spindle at constant speed counts as at rest here."""
    if isinstance(block, ChannelBlock):
        return block.done
    if isinstance(block, AxisBlock):
        bits = block.status_bits[-1]
        held = bits & StatusBit.HAS_JOB and (block.override_percent[-1] == 0.0 or bits & StatusBit.FEED_WITHHELD)
        if bits & StatusBit.PROTECTED and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION:
            return block.set_velocity[-1] == 0.0  # a slave: its master knows whether there is more to come
        waits = bool(held or (bits & StatusBit.EXT_SETPOINT and not bits & StatusBit.HAS_JOB))
        return block.set_velocity[-1] == 0.0 and (waits or block.state[-1] in REST_STATES)
    if isinstance(block, SpindleBlock):
        pending = block.plc_commands != block.plc_acknowledged
        busy = block.state[-1] in SPINDLE_AT_WORK or block.gear_change_active[-1] or pending
        return block.set_acceleration_deg_s2[-1] == 0.0 and not busy
    return True


def needs_stop(block: CycleBlock) -> bool:
    """False for what stops without a command: axes on the path of a channel, channels in error."""
    if isinstance(block, ChannelBlock):
        return not block.error_id[-1]
    return not (isinstance(block, AxisBlock) and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION)


def has_external_setpoints(block: CycleBlock | None) -> bool:
    return isinstance(block, AxisBlock) and bool(block.status_bits[-1] & StatusBit.EXT_SETPOINT)


def error_of(block: CycleBlock) -> int:
    """The error number that a unit has at the end of its block, 0 if none."""
    return 0 if isinstance(block, PlcBlock) else block.error_id[-1]
