"""The PLC: plays the scenario, calls a PLC in a file, passes on commands from topics, acknowledges, ends the run."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar

from cnc_ptp.axis.external_commands import SETPOINTS
from cnc_ptp.errors import NO_VALUES, CncError, Value
from cnc_ptp.parameters import AxisParameters, ParameterSet
from cnc_ptp.plc.axis_groups import AxisGroups
from cnc_ptp.plc.program.plc_io import PlcIo
from cnc_ptp.plc.program.plc_program import PlcFile, PlcProgram
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.plc.setpoint_file import SetpointRow, check_setpoints, placed
from cnc_ptp.plc.setpoint_queue import SetpointQueue
from cnc_ptp.plc.spindle_answers import spindle_answers
from cnc_ptp.plc.trajectories import FollowedTrajectory, Trajectories
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
from cnc_ptp.protocol.commands import BAD_ARGUMENT
from cnc_ptp.protocol.notes import PLC_MESSAGE
from cnc_ptp.protocol.unit import EMERGENCY_HOLDS, EMERGENCY_STOP, UPSTREAM_LOST, Unit

NOTHING_TO_ACKNOWLEDGE = 22013
CANNOT_GO_ON = 22014
SETTLING_TIME = 0.2
"""Seconds that everything must have been at a standstill before a run ends, so that the drives have come to rest."""

SPINDLE_AT_WORK = (AxisStateCode.DISCRETE_MOTION, AxisStateCode.HOMING, AxisStateCode.STOPPING)
Outside = Callable[[int, Mapping[str, CycleBlock]], Iterable[Command]]
"""Gives commands for the block that begins at a cycle, from what the units have reported."""
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
        self._trajectories = Trajectories([unit for unit, kind in self._kinds.items() if kind == "axis"])
        self.trajectory: FollowedTrajectory | None = None
        """The newest one."""
        self._outgoing: list[Command] = []
        self.setpoints = SetpointQueue(cycle_time=cycle_time, warn=self._warn)
        """External setpoints that scenario and topics give."""
        self._auto_acknowledge = True
        self._pending: dict[int, HandshakeRequest] = {}
        self._served: set[str] = set()
        """Channels and spindles whose functions an external PLC answers."""
        self._led: dict[str, int] = {}
        """Axes that were led when everything was stopped, and when that was, until they rest."""
        self.emergency = False
        """The emergency stop is pressed."""
        self.outside: list[Outside] = []
        """What external PLCs command, asked once a block."""
        self._life_sign_on = True
        self._life_sign = 0
        self._commands_sent = 0
        self._idle_cycles = 0
        self._lost: set[str] = set()
        self._failed = False
        self._inputs: dict[str, float] = {}
        self.program: PlcProgram | None = None
        """A PLC in a file."""
        self.reported: Mapping[str, CycleBlock] = {}
        """The units' blocks previous to the one computed last."""

    def take_program(self, file: PlcFile, sets: Mapping[str, ParameterSet]) -> None:
        """Makes the PLC of a file, which `step` calls; `sets`: parameters of the units. Raises CncError 25104."""
        io = PlcIo(
            self._kinds,
            sets,
            cycle_time=self._cycle_time,
            requests=self._pending,
            inputs=self._inputs,
            finished=bool(self._scenario),
        )
        self.program = PlcProgram(file, io)

    @property
    def program_runs(self) -> bool:
        """A PLC in a file is called with each block."""
        return self.program is not None and self.program.runs

    def is_coupled(self, axis: str) -> bool:
        """True for a slave, as it has reported."""
        block = self.reported.get(axis)
        return isinstance(block, AxisBlock) and bool(block.master)

    def is_led(self, unit: str) -> bool:
        """A channel, a master or external setpoints move it, as it has reported: what moves it stops it too."""
        block = self.reported.get(unit)
        if isinstance(block, AxisBlock | SpindleBlock) and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION:
            return True
        return self.is_coupled(unit) or has_external_setpoints(block)

    def is_lost(self, unit: str) -> bool:
        return unit in self._lost

    def input(self, command: Command) -> None:
        """A command from outside (topic, button): goes out with the next block."""
        self._outgoing.append(command)

    def requests_of(self, channel: str) -> list[HandshakeRequest]:
        """The functions of a channel that wait for their acknowledgement, oldest first."""
        return [request for request in self._pending.values() if request.channel == channel]

    def channel_of(self, request_id: int) -> str | None:
        """The channel that waits for this acknowledgement, None if none does."""
        request = self._pending.get(request_id)
        return None if request is None else request.channel

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

    def do_set_input(self, cycle: int, *, name: str, value: float) -> str | None:
        """A value from outside, for a PLC in a file."""
        self._inputs[name] = value
        return None if self.program_runs else f"plc {self.name}: set_input without effect: no PLC in a file runs"

    def do_serve(self, cycle: int, *, unit: str, enabled: bool) -> None:
        """An external PLC answers the functions of a channel, or the gear changes of a spindle, instead of this one."""
        if self._kinds.get(unit) not in ("channel", "spindle"):
            known = ", ".join(name for name, kind in self._kinds.items() if kind in ("channel", "spindle")) or "none"
            where = f"plc {self.name}: serve refused"
            reason = f"unit = '{unit}' is no channel or spindle; known are: {known}"
            raise CncError(BAD_ARGUMENT, reason, "nothing was changed", where=where, unit=unit)
        (self._served.add if enabled else self._served.discard)(unit)

    def do_follow_trajectory(
        self,
        cycle: int,
        *,
        axes: Sequence[Any],
        points: Sequence[Any],
        path_tolerance: Sequence[Any] = (),
        goal_tolerance: Sequence[Any] = (),
        goal_time: float = 0.0,
    ) -> None:
        """Axes follow a trajectory together: rows of time and lists of what each axis has; all of them or none begins.

        Refused (23064) when the rows do not fit the axes, or an axis follows another one; each axis checks its own
        values, and one that refuses or fails stops the others.
        """
        self.trajectory = self._trajectories.begin(axes, points, path_tolerance, goal_tolerance, goal_time)
        self._outgoing += [member.command for member in self.trajectory.members.values()]

    def do_emergency_stop(self, cycle: int, *, enabled: bool) -> str | None:
        """Everything stops at once and is locked until this is off again and each unit has been reset.

        Axes on their emergency ramps (P-AXIS-00003), spindles on their own, channels abort their programs.
        """
        if enabled == self.emergency:
            return f"plc {self.name}: the emergency stop is {'pressed' if enabled else 'released'} already"
        self.emergency = enabled
        self.setpoints.clear()
        units = [unit for unit in self._kinds if unit not in self._lost]
        self._outgoing += [Command(unit, "set_emergency_stop", {"enabled": enabled}) for unit in units]
        if enabled:
            what = "axes stop on their emergency ramps, spindles on their own, programs are aborted"
            self.event(cycle, Severity.ERROR, EMERGENCY_STOP, f"plc {self.name}: emergency stop; {what}")
        else:
            text = f"plc {self.name}: the emergency stop is released; nothing moves before its unit is reset"
            self.event(cycle, Severity.INFO, 0, text)
        return None

    def do_reset(self, cycle: int) -> None:
        """Resets each unit that is in error; refused (26169) before the emergency stop is released."""
        if self.emergency:
            where = f"plc {self.name}: reset refused"
            reason = "the emergency stop holds; release it first"
            raise CncError(EMERGENCY_HOLDS, reason, "nothing was changed", where=where)
        failed = [name for name, block in self.reported.items() if error_of(block)]
        self._outgoing += [Command(name, "reset", {}) for name in failed]

    def do_set_life_sign(self, cycle: int, *, enabled: bool) -> None:
        """Stops or resumes the life sign; without it all units stop after the watchdog time."""
        self._life_sign_on = enabled

    def do_stop_all(self, cycle: int) -> None:
        """Controlled stop of everything: channels are reset, axes and spindles stopped on their ramps.

        Left out is what stops with its channel (axes on the path) or its master, and channels in error, which stop on
        their own; external setpoints and superimposed motions of what is led are ended.
        """
        self._scenario.clear()
        self.setpoints.clear()
        if self.program is not None:
            self.program.runs = False
            self._outgoing += self.program.io.release_stops()
        self._end_when_idle = True
        for unit, kind in self._kinds.items():
            block = self.reported.get(unit)
            if unit not in self._lost and (block is None or needs_stop(block) or self._let_go(unit, block)):
                waits_for_gear = isinstance(block, SpindleBlock) and block.gear_request
                self._outgoing.append(Command(unit, "reset" if waits_for_gear else STOP_COMMAND[kind], {}))
            elif unit not in self._lost:
                self._outgoing += [Command(unit, command, {}) for command in ends_of_added(block)]
                self._led[unit] = cycle

    def _stop_freed(self, inputs: Mapping[str, CycleBlock]) -> None:
        """Axes that were led when everything was stopped, and were let go before they came to rest, by whomever."""
        for unit, cycle in [*self._led.items()]:
            block = inputs.get(unit)
            if not isinstance(block, AxisBlock) or block.first_cycle < cycle:
                continue
            freed = needs_stop(block) and not at_rest(block)
            if freed:
                self._outgoing.append(Command(unit, STOP_COMMAND["axis"], {}))
            if freed or block.set_velocity[-1] == 0.0:
                del self._led[unit]

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

    def _fail(self, cycle: int, error_id: int, reason: str, line: int = 0) -> None:
        """`line` of a PLC in a file."""
        self._failed = True
        text = f"plc {self.name}: {reason}; everything is stopped and the run ends"
        self.event(cycle, Severity.ERROR, error_id, text, line)
        self.do_stop_all(cycle)

    def _warn(self, cycle: int, number: int, text: str, values: Mapping[str, Value] = NO_VALUES) -> None:
        self.report(cycle, Severity.WARNING, number, text, values)

    # one block

    def step(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> PlcBlock:
        """Computes one block from the units' previous blocks."""
        first_cycle, count = tick
        self.reported = inputs
        self._outgoing += self._groups.report(first_cycle, inputs)
        self._outgoing += self._trajectories.report(inputs)
        self.setpoints.watch(inputs)
        self._stop_freed(inputs)
        self._play_scenario(first_cycle)
        self._note_requests(inputs)
        self._run_program(tick, inputs)
        self._acknowledge_all(first_cycle)
        for commands_of in self.outside:
            self._outgoing += commands_of(first_cycle, inputs)
        automatic = {unit for unit in self._kinds if self._auto_acknowledge and unit not in self._served}
        self._outgoing += spindle_answers(inputs, changes_gears_of=automatic)
        self._outgoing += self.setpoints.take(first_cycle, count)
        run_done = self._end_when_idle and self._run_done(count, inputs)
        if self._life_sign_on:
            self._life_sign += 1
        self._trajectories.place(count * self._cycle_time)
        commands, self._outgoing = self._groups.complete(self._outgoing, self._lost)
        for command in commands:
            self._commands_sent += 1
            command.id = self._commands_sent
        if self.program is not None:
            self.program.io.note_writes(commands)
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

    def _run_program(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> None:
        """What a PLC in a file commands; its fault stops everything."""
        if self.program is None or not self.program.runs:
            return
        cycle = tick.first_cycle
        fault = self.program.run(tick, inputs, self._lost)
        for text in self.program.io.take_events():
            self.event(cycle, Severity.INFO, PLC_MESSAGE, f"plc {self.name}: {text}")
        for command in self.program.io.take_commands():
            if command.target == self.name:
                self.command(command, cycle)
            else:
                self._outgoing.append(command)
        if fault is not None:
            self._fail(cycle, fault.number, fault.reason, fault.line)

    def _note_requests(self, inputs: Mapping[str, CycleBlock]) -> None:
        for name, block in inputs.items():
            if isinstance(block, ChannelBlock):
                self._pending.update({request.id: request for request in block.requests if request.acknowledge_needed})
                if block.done:  # a program that is finished, or was aborted, waits for nothing
                    for number in [n for n, request in self._pending.items() if request.channel == name]:
                        del self._pending[number]

    def _acknowledge_all(self, cycle: int) -> None:
        if self._auto_acknowledge:
            for request in list(self._pending.values()):
                if request.channel not in self._served:
                    self.do_acknowledge(cycle, id=request.id)

    def _run_done(self, count: int, inputs: Mapping[str, CycleBlock]) -> bool:
        """Everything has been at a standstill for the settling time; spindles that still turn are stopped first."""
        expected = set(self._kinds) - self._lost
        idle = not (self._scenario or self._outgoing or self.setpoints) and expected <= inputs.keys()
        idle = idle and (not self.program_runs or (self.program is not None and self.program.io.finished))
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
        stands = block.state[-1] == AxisStateCode.CONTINUOUS_MOTION and block.target_velocity == 0.0
        withheld = stands or block.override_percent[-1] == 0.0 or bits & StatusBit.FEED_WITHHELD
        held = bits & StatusBit.HAS_JOB and withheld
        if bits & StatusBit.PROTECTED and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION:
            return block.set_velocity[-1] == 0.0  # a slave: its master knows whether there is more to come
        waits = bool(held or (bits & StatusBit.EXT_SETPOINT and not bits & StatusBit.HAS_JOB))
        return block.set_velocity[-1] == 0.0 and (waits or block.state[-1] in REST_STATES or stop_held(block))
    if isinstance(block, SpindleBlock):
        pending = block.plc_commands != block.plc_acknowledged
        works = block.state[-1] in SPINDLE_AT_WORK and not (stop_held(block) and block.set_speed_rpm[-1] == 0.0)
        busy = works or block.gear_change_active[-1] or pending
        return block.set_acceleration_deg_s2[-1] == 0.0 and not busy
    return True


def stop_held(block: AxisBlock | SpindleBlock) -> bool:
    """MC_Stop holds the unit: it reports Stopping, but its stop is done."""
    return block.state[-1] == AxisStateCode.STOPPING and not block.job


def needs_stop(block: CycleBlock) -> bool:
    """False for what stops without a command: axes on the path of a channel, channels in error."""
    if isinstance(block, ChannelBlock):
        return not block.error_id[-1]
    return not (isinstance(block, AxisBlock) and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION)


def has_external_setpoints(block: CycleBlock | None) -> bool:
    return isinstance(block, AxisBlock) and bool(block.status_bits[-1] & StatusBit.EXT_SETPOINT)


def ends_of_added(block: CycleBlock | None) -> Iterator[str]:
    """Commands that end what is superimposed on the motion of an axis. A compensation ends with what it follows."""
    if has_external_setpoints(block):
        yield "external_disable"
    if isinstance(block, AxisBlock) and block.status_bits[-1] & StatusBit.COMPENSATING:
        yield "halt_superimposed"


def error_of(block: CycleBlock) -> int:
    """The error number that a unit has at the end of its block, 0 if none."""
    return 0 if isinstance(block, PlcBlock) else block.error_id[-1]
