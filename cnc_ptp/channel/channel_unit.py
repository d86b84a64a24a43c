"""The NC channel: takes commands and reports, follows the program sequence, computes setpoints for its axes.

One cycle block: `step` reads the reports of axes and spindles, sends the functions that came up, then `_fill` makes the
rows cycle by cycle: from the path while a motion is active, at a standstill while the program waits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import count as numbers
from typing import Any, ClassVar, NoReturn

from cnc_ptp.channel.axis_homing import AxisHoming
from cnc_ptp.channel.cycle_rows import CycleRows
from cnc_ptp.channel.feed_per_turn import FeedPerTurn
from cnc_ptp.channel.function_output import FunctionOutput
from cnc_ptp.channel.measuring import Measuring
from cnc_ptp.channel.offset_memory import OffsetMemory
from cnc_ptp.channel.path_axes import NOT_AT_END, PathAxes
from cnc_ptp.channel.path_spindle import PathSpindle
from cnc_ptp.channel.program_check import ProgramCheck, ProgramState
from cnc_ptp.channel.program_memory import ProgramMemory
from cnc_ptp.channel.program_sequence import NO_SOURCE, OFF_PATH, Phase, ProgramSequence
from cnc_ptp.channel.program_start import NOTHING_STARTED, ProgramStart, start_point
from cnc_ptp.channel.program_times import NO_TIMES, ProgramProgress
from cnc_ptp.channel.program_view import ProgramView
from cnc_ptp.channel.running_blocks import RunningBlocks
from cnc_ptp.channel.supervision import Finding, Supervision
from cnc_ptp.channel.thread_errors import ThreadErrors, add_thread
from cnc_ptp.channel.time_estimate import TimeEstimate
from cnc_ptp.channel.timers import Timers
from cnc_ptp.channel.waits import Outgoing
from cnc_ptp.errors import NO_VALUES, CncError, Value
from cnc_ptp.nc.faults import ProgramError, line_of_program
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.parser import NO_FILES
from cnc_ptp.nc.vocabulary import MAX_SKIP_LEVEL
from cnc_ptp.parameters import AxisParameters, ChannelParameters, SpindleParameters
from cnc_ptp.parameters.view.homing_view import IGNORE_ABSOLUTE
from cnc_ptp.path.active_motion import PathPoint
from cnc_ptp.path.geometry import begins_element
from cnc_ptp.path.path_motion import PathMotion
from cnc_ptp.path.shape import AxisState
from cnc_ptp.path.thread_place import ThreadPlace
from cnc_ptp.protocol.axis_states import AxisStateCode, state_name
from cnc_ptp.protocol.blocks import ChannelBlock, Command, CycleBlock, CycleTick, Severity
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.protocol.commands import BAD_ARGUMENT
from cnc_ptp.protocol.notes import START_STEP
from cnc_ptp.protocol.unit import CLOCK, EMERGENCY_STOP, UPSTREAM_LOST, Unit

NO_PROGRAM = 22003
NOT_NOW = 22004
AXIS_NOT_READY = 22005
COORDINATES_SHIFTED = 22037
BAD_OVERRIDE = 22006
NOTHING_TO_ACKNOWLEDGE = 22007
STILL_MOVING = 22008
NO_TEXT = 22009
NOTHING_AWAITS_EVENT = 22020
FEED_WITHHELD = 22026
THREAD_BROKEN = 22087
EFFECTS = {"start": NOTHING_STARTED, "mdi": "nothing was executed"}
"""What the refusal of a command means, of others that nothing was changed."""

C = ChannelStateCode


class ChannelUnit(Unit):
    """One NC channel with its path axes and spindles."""

    kind: ClassVar[str] = "channel"

    def __init__(
        self,
        parameters: ChannelParameters,
        *,
        axes: Mapping[str, AxisParameters],
        spindles: Mapping[str, SpindleParameters],
        cycle_time: float,
        request_numbers: Iterator[int] | None = None,
        handshake_timeout: float = 0.0,
    ) -> None:
        """`axes` and `spindles` of the machine by node name, `cycle_time` in s.

        `request_numbers`: numbers for handshake requests that no other channel of the machine uses.
        `handshake_timeout`: s within which the PLC must acknowledge them, 0 means without limit.
        """
        super().__init__(parameters.name)
        self._parameters = parameters
        nodes = [axis.node for axis in parameters.axes]
        functions = FunctionOutput(parameters, spindles, request_numbers or numbers(1))
        self._path_spindle = PathSpindle(parameters.name, functions.spindles, parameters.c_axis_ramp)
        on_path = [axes[node] for node in nodes]
        self._cutting_speed, feed_per_turn = functions.cutting_speed, FeedPerTurn(functions.spindles)
        self._motion = PathMotion(parameters, on_path, cycle_time, self._path_spindle.limits, feed_per_turn.turns)
        logical = {**{n: axis.number for n, axis in axes.items()}, **{n: each.number for n, each in spindles.items()}}
        self._thread_errors = ThreadErrors(nodes, logical, self._motion.delay)
        self._axes = PathAxes(nodes, axes, self._motion)
        self._handshake_timeout = handshake_timeout
        self._handshake_cycles = round(handshake_timeout / cycle_time)
        absolute = [axis.name for axis in parameters.axes if axes[axis.node].homing.kind == IGNORE_ABSOLUTE]
        homing = AxisHoming({axis.name: axis.node for axis in parameters.axes}, absolute)
        names, required = [axis.name for axis in parameters.axes], parameters.signal_required
        measuring = Measuring(names, [axes[node] for node in nodes], cycle_time, required=required)
        timers, spindle = Timers(cycle_time), self._path_spindle
        self._sequence = ProgramSequence(self._motion, functions, nodes, homing, measuring, timers, spindle)
        self._watch = Supervision(parameters, self._sequence, self._motion, self._axes, feed_per_turn)
        self._check = ProgramCheck(parameters, axes, spindles)
        self._offsets = OffsetMemory(parameters.name, self._check.nc)
        estimate = TimeEstimate(self._motion, functions)
        self._programs = ProgramMemory(self._check, self._offsets, estimate, parameters.blocks_per_cycle)
        self._progress = ProgramProgress(NO_TIMES, 0)
        self._turning_after_reset = {node for node, spindle in spindles.items() if not spindle.stops_at_reset}
        self._commands_sent = 0
        self._just_started = False
        self._unfinished = False
        """The program ended, or a homing began, after the last cycle of the previous block."""
        self._feedback: Mapping[str, CycleBlock] = {}
        self._override_percent = min(100.0, parameters.max_override_percent)
        self.check_override = self._check_override
        self.overlay.full_override = self._override_percent
        self.overlay.begin("override", self._override_percent)
        self._feed_hold = False
        self._element_begins = False
        """The active element starts with the next block: what axes report belongs to the previous one."""
        self._error_id = 0
        self._resumed = False
        """The last start has resumed a program."""
        self._apply_override()

    def prepare(self, program: str, text: str, files: Mapping[str, str] = NO_FILES, dialect: str | None = None) -> None:
        """Parses and interprets ahead of time what `load` and `start` then find ready. Raises ProgramError.

        A program that is read while it runs has nothing to be prepared but the first look at it.
        """
        self._programs.prepare(program, text, files, dialect, self._motion.position, self._feedback)

    # commands

    def _dispatch(self, command: Command, cycle: int) -> Command:
        """An error that does not say what happens now, as those of programs, says it here."""
        try:
            return super()._dispatch(command, cycle)
        except CncError as error:
            error.effect = error.effect or EFFECTS.get(command.command, "nothing was changed")
            raise

    def do_load(
        self,
        cycle: int,
        *,
        program: str,
        text: str | None = None,
        files: Mapping[str, str] = NO_FILES,
        dialect: str | None = None,
    ) -> None:
        """Takes over a program: syntax is checked here, the rest at the start. Raises ProgramError, 22004, 22009.

        `dialect`: its vocabulary, also of the manual blocks behind it; None: that of the machine file.
        """
        self._require_idle("load")
        if text is None:
            self._refuse("load", NO_TEXT, f"no text came with program '{program}'", program=program)
        self._programs.load(program, text, files, dialect)
        self._sequence.source = NO_SOURCE

    def do_start(
        self,
        cycle: int,
        *,
        line: int | None = None,
        block_number: int | None = None,
        in_program: str = "",
        pass_number: int | None = None,
    ) -> None:
        """Starts the program, which is interpreted as a whole first; or resumes it after M00 or in single block.

        With a `line` or `block_number` it begins there (ProgramStart): an event for each step that comes before.
        Raises ProgramError, 22001, 22003 … 22005, 22040 … 22044.
        """
        point = start_point(line, block_number, in_program, pass_number, self._refuse)
        if self._sequence.phase is Phase.STOPPED:
            if point is not None:
                at = self._sequence.source.line
                self._refuse("start", NOT_NOW, f"the program is stopped in line {at} and can only be resumed there")
            self._sequence.resume()
            self._resumed = True
            return
        self._require_idle("start")
        program = self._programs.loaded
        if program is None:
            self._refuse("start", NO_PROGRAM, "no program is loaded")
        begin = None if point is None else ProgramStart(point, program)
        position = self._motion.position
        self._begin(cycle, "start", program, self._programs.initial_state(self._feedback), begin)
        self._resumed = False
        self._sequence.end_couplings()
        if program.streamed:
            size = f"more than {self._parameters.checked_text} characters (P-CHAN-90005)"
            self.event(cycle, Severity.INFO, START_STEP, f"the program has {size}: it is checked while it runs")
        for step in () if begin is None else begin.lines(self._check.axis_names, position):
            self.event(cycle, Severity.INFO, START_STEP, step)

    def do_mdi(self, cycle: int, *, text: str, files: Mapping[str, str] = NO_FILES) -> None:
        """Executes NC text immediately; modal states are kept from one such text to the next.

        It may call `files`, texts by name, and what the loaded program may call.
        """
        self._require_idle("mdi")
        program = self._programs.parse_manual(text, files)
        self._begin(cycle, "mdi", program, self._programs.manual_state(self._feedback))

    def do_set_zero_offset(self, cycle: int, *, index: int, axis: str, value: float) -> None:
        """A value (mm, deg) of a zero offset; it counts when the offset is selected next."""
        self._require_idle("set_zero_offset")
        place = self._offsets.place("set_zero_offset", axis)
        self._offsets.set("set_zero_offset", index, {place: value})
        self._offsets.give(self._programs.state.modal.coordinates)

    def do_teach_zero_offset(self, cycle: int, *, index: int, axis: str = "", value: float = 0.0) -> None:
        """The present position of an axis, or of all, becomes `value` (mm, deg) in a zero offset."""
        self._require_idle("teach_zero_offset")
        coordinates = self._programs.state.modal.coordinates
        self._offsets.teach("teach_zero_offset", index, axis, value, self._motion.position, coordinates)
        self._offsets.give(coordinates)

    def do_set_clamp_position(self, cycle: int, *, index: int) -> None:
        """The clamp position of programs that are started from now on."""
        self._require_idle("set_clamp_position")
        self._offsets.choose_clamp_position("set_clamp_position", index)
        self._offsets.give(self._programs.state.modal.coordinates)

    def do_feed_hold(self, cycle: int, *, enabled: bool) -> None:
        """Feed hold: the path stops on its ramp, and resumes when the hold is off."""
        self._feed_hold = enabled
        self._apply_override()

    def do_set_override(self, cycle: int, *, percent: float) -> None:
        """Path override, 0 … P-CHAN-00056 %; acts on feed and rapid."""
        self._check_override("set_override", percent)
        self._override_percent = float(percent)
        self._apply_override()

    def _check_override(self, command: str, percent: float) -> None:
        limit = self._parameters.max_override_percent
        if not 0.0 <= percent <= limit:
            reason = f"percent = {percent} is not within 0 ... {limit:g} (P-CHAN-00056)"
            self._refuse(command, BAD_OVERRIDE, reason, percent=percent, limit=limit)

    def requested(self, command: str, arguments: Mapping[str, Any]) -> dict[str, float]:
        """See Unit."""
        level = arguments.get("level", 1) if command == "block_skip" else 1
        if not 1 <= level <= MAX_SKIP_LEVEL:
            reason = f"level = {level} is not within 1 ... {MAX_SKIP_LEVEL}"
            self._refuse(command, BAD_ARGUMENT, reason, level=level)
        return super().requested(command, arguments)

    def do_single_block(self, cycle: int, *, enabled: bool, mode: str = "block") -> None:
        """Single block: the channel stops after each block, or (mode `motion`) after each motion, until `start`."""
        self._sequence.set_single_block(mode if enabled else "")

    def do_optional_stop(self, cycle: int, *, enabled: bool) -> None:
        """Makes M01 a stop like M00 (off by default)."""
        self._sequence.optional_stop = enabled

    def do_block_skip(self, cycle: int, *, levels: int) -> None:
        """Skips blocks with / (level 1, bit 0) or /2 … /10 from the next start on (off by default)."""
        self._check.block_skip = levels

    def do_reset(self, cycle: int) -> None:
        """Aborts the program on the path ramp and clears the error; refused while an error ramp runs (22008).

        The spindles that the channel has started stop, unless P-AXIS-00455 keeps them (TF5200 spindle 2.4.3).
        """
        if self._error_id:
            if self._sequence.phase is Phase.RAMP_DOWN:
                self._refuse("reset", STILL_MOVING, "the path still moves on its error ramp; wait for standstill")
            self._error_id = 0
        if self._motion.cuts_thread and (broken_off := self._motion.stop_text):
            text = f"channel {self.name}: reset within a thread; {broken_off}"
            self.event(cycle, Severity.WARNING, THREAD_BROKEN, text, self._sequence.source.line)
        self._sequence.ramp_down(keep=self._turning_after_reset)

    def do_set_emergency_stop(self, cycle: int, *, enabled: bool) -> None:
        """The emergency stop of the machine or of the HLI: the program is aborted, the channel wants a reset."""
        if enabled:
            self._fault(cycle, EMERGENCY_STOP, "emergency stop")

    def do_acknowledge(self, cycle: int, *, id: int) -> None:
        """The PLC's answer to a handshake request."""
        handshake = self._sequence.handshake
        if id not in handshake:
            waiting = ", ".join(map(str, handshake.open_ids)) or "none"
            self._refuse("acknowledge", NOTHING_TO_ACKNOWLEDGE, f"no request {id} waits (waiting: {waiting})", id=id)
        self._sequence.acknowledge(id)

    def do_measuring_event(self, cycle: int) -> None:
        """The event for which a measuring run and functions of type MNE_SNS wait; refused (22020) without either."""
        if not self._sequence.measuring_event():
            self._refuse("measuring_event", NOTHING_AWAITS_EVENT, "nothing in the running block waits for one")

    def begin_job(self, command: Command, cycle: int) -> int:
        """See Unit: a program that is resumed is the same job."""
        return self.jobs.active if command.command == "start" and self._resumed else super().begin_job(command, cycle)

    def do_upstream_lost(self, cycle: int, *, source: str) -> None:
        """Watchdog: PLC, clock, an axis or a spindle has not published in time; the path stops."""
        if source in self._axes.nodes:
            self._motion.axis_failed(self._axes.nodes.index(source))
        way = "its axes stop without it" if source == CLOCK else ""  # which keeps them in step
        self._fault(cycle, UPSTREAM_LOST, f"no block of '{source}' came within the watchdog time", way=way)

    def waits_for(self) -> str:
        """What the program waits for that does not come with time alone; empty when it continues without help."""
        what = self._sequence.waits_for()
        return f"channel {self.name} waits in line {self._sequence.source.line} for {what}" if what else ""

    # one block

    def step(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> ChannelBlock:
        """Computes one block; `inputs` holds the previous blocks of the channel's axes and spindles.

        The first row is the state to which the previous block has led, so that commands act from exactly there; one
        row more than the block has leads to the next one.
        """
        first_cycle, count = tick
        self._sequence.stream.begin_cycles(count)
        self._read_feedback(first_cycle, inputs)
        errors = self._thread_errors.take(first_cycle, inputs)
        if unanswered := self._watch.unanswered(first_cycle, self._handshake_cycles, self._handshake_timeout):
            self._fault(first_cycle, unanswered.number, unanswered.text, unanswered.values)
        outgoing = self._sequence.take_outgoing(first_cycle)
        spindle = self._path_spindle.node
        on_path = self._unfinished or self._sequence.phase not in OFF_PATH
        rows = CycleRows(with_spindle=bool(spindle))
        self._add(rows, [self._motion.point], thread=self._motion.thread_places[-1:])
        self._fill(rows, first_cycle, count + 1)
        outgoing.commands += self._cutting_commands(first_cycle, rows, count)
        if self._sequence.phase not in (Phase.IDLE, Phase.RAMP_DOWN):
            self._sequence.stream.look_ahead()
        if slow := self._watch.interpreter():
            self._warn_of(first_cycle, slow)
        self._axes.give(rows.axes[count - 1][: len(self._axes.nodes)], on_path=on_path)
        self._element_begins = begins_element(*rows.distance_to_go[count - 1 :])
        self._update_progress()
        if self._sequence.finished:
            self._programs.finish()
        self._unfinished = self._sequence.phase in OFF_PATH and rows.axes[count - 1] != self._motion.states
        if self._sequence.phase is Phase.IDLE:
            self._offsets.rest(first_cycle + count, self._programs.state.modal)
        block = self._channel_block(tick, rows, outgoing, path_active=on_path)
        if spindle:
            add_spindle(block, spindle, rows.spindle[:count])
        add_thread(block, errors)
        self._thread_errors.note(first_cycle, count, rows.thread_places)
        return block

    def _cutting_commands(self, first_cycle: int, rows: CycleRows, count: int) -> list[Command]:
        """G96: the speed for the position of the axes in the middle of the block, or where their cut ends in it."""
        function, end = self._cutting_speed.function, rows.cut_end
        if function is None or end < 0:
            return []
        states = rows.axes[end if end < count - 1 else count // 2]
        radius = self._offsets.programmed([state[0] for state in states])[function.axis]
        commands = self._cutting_speed.commands(first_cycle, radius)
        if commands:
            self._sequence.speed_follows(self._cutting_speed.nodes)
        return commands

    def _update_progress(self) -> None:
        sequence = self._sequence
        if sequence.phase in (Phase.IDLE, Phase.RAMP_DOWN):
            self._progress.end(finished=sequence.finished)
            return
        loaded = self._programs.loaded
        in_file = loaded is not None and sequence.source.file == loaded.file
        line = sequence.source.line if in_file else 0
        if loaded is not None and loaded.streamed:
            line = sequence.stream.read + 1
        self._progress.update(sequence.stream.done, self._motion, line, begun=sequence.motion_begun)

    @property
    def program_view(self) -> ProgramView:
        """Which program the channel has, and where it is."""
        source = self._sequence.source
        return ProgramView(
            program="" if self._programs.loaded is None else self._programs.loaded.file,
            manual=self._programs.manual and self._sequence.phase is not Phase.IDLE,
            file=source.file,
            text=source.text.strip(),
            calls=self._sequence.calls,
        )

    def _channel_block(
        self, tick: CycleTick, rows: CycleRows, outgoing: Outgoing, *, path_active: bool
    ) -> ChannelBlock:
        count = tick.count
        for command in outgoing.commands:
            self._commands_sent += 1
            command.id = self._commands_sent
        axes = list(zip(*rows.axes[:count], strict=True))[: len(self._axes.nodes)]
        by_axis = [state for axis in axes for state in axis]
        position, velocity, acceleration, jerk = map(list, zip(*by_axis, strict=True)) if by_axis else ([], [], [], [])
        return ChannelBlock(
            first_cycle=tick.first_cycle,
            count=count,
            path_active=path_active,
            axes=self._axes.nodes,
            set_position=position,
            set_velocity=velocity,
            set_acceleration=acceleration,
            set_jerk=jerk,
            line=rows.line[:count],
            block_number=rows.block_number[:count],
            path_velocity=rows.path_velocity[:count],
            programmed_feed=rows.programmed_feed[:count],
            override_percent=rows.override_percent[:count],
            distance_to_go=rows.distance_to_go[:count],
            state=rows.state[:count],
            error_id=rows.error_id[:count],
            done=self._sequence.phase is Phase.IDLE and not self._unfinished and not self._axes.beside,
            blocks_done=self._sequence.stream.done,
            blocks_total=self._sequence.stream.total,
            programmed_position=self._offsets.shown([state[0] for state in rows.axes[count - 1]]),
            offsets=self._offsets.news(),
            progress=self._progress.now.share,
            time_left=self._progress.now.time_left,
            commands=outgoing.commands,
            requests=outgoing.requests,
        )

    def _fill(self, rows: CycleRows, first_cycle: int, wanted: int) -> None:
        """Adds rows up to `wanted`: of the path in a motion, else at a standstill."""
        while len(rows) < wanted:
            if self._sequence.phase in (Phase.MOTION, Phase.RAMP_DOWN):
                self._follow_path(rows, wanted - len(rows), first_cycle + len(rows))
            elif not self._go_on(first_cycle, first_cycle + len(rows)):
                self._motion.stand()
                self._add(rows, [self._motion.point])

    def _follow_path(self, rows: CycleRows, missing: int, cycle: int) -> None:
        """Rows of the active block; it ends early when its motion does, at the exact instant inside a cycle."""
        cuts = self._sequence.cuts
        try:
            points = self._motion.follow(missing)
        except CncError as error:
            self._fault_in_line(cycle, error)
            return
        self._add(rows, points, self._motion.spindle_states, self._motion.thread_places)
        if cuts and points:
            rows.cut_end = len(rows) - 1
        if self._motion.passes:
            self._sequence.pass_block(cycle + len(points))
            self._reach_offsets(cycle + len(points))
        elif self._motion.halted and self._sequence.phase is Phase.MOTION:
            self._sequence.halted()
        elif len(points) < missing or self._motion.stopped:
            self._sequence.motion_ended()
        self._warn(cycle + len(points))

    def _go_on(self, first_cycle: int, cycle: int) -> bool:
        try:
            goes_on = self._sequence.go_on(first_cycle, cycle)
        except ProgramError as error:
            self._fail_before(cycle, error)
            return True
        except CncError as error:
            self._fault_in_line(cycle, error)
            return True
        self._warn(cycle)
        self._reach_offsets(cycle)
        return goes_on

    def _reach_offsets(self, cycle: int) -> None:
        """The path has reached a block that changes them."""
        if self._sequence.offsets is not None:
            self._offsets.reach(cycle, self._sequence.source.line, self._sequence.offsets)
            self._sequence.offsets = None

    def _warn(self, cycle: int) -> None:
        line = self._sequence.source.line
        for severity, number, text, named in self._motion.take_notes():
            self.report(cycle, severity, number, f"channel {self.name}: {text} (line {line})", named, line)
        messages, self._sequence.messages = self._sequence.messages, []
        for number, text, line, values in messages:
            self.event(cycle, Severity.INFO, number, text, line, values)
        notes, self._sequence.notes = self._sequence.notes, []
        for number, note, line in notes:
            self.event(cycle, Severity.WARNING, number, f"channel {self.name}: {note}", line)

    def _add(
        self,
        rows: CycleRows,
        points: Sequence[PathPoint],
        spindle: Sequence[AxisState] = (),
        thread: Sequence[ThreadPlace | None] = (),
    ) -> None:
        """Adds the cycles of `points`, all of the same phase and program line.

        `spindle`: of that on the path; `thread`: those within a thread.
        """
        rows.note_thread(thread)
        count = len(points)
        state = self._state_code()
        held = state == C.RUNNING and self._motion.held
        if rows.with_spindle:
            rows.spindle += spindle or [self._motion.spindle_travel(axes) for axes, _, _ in points]
        for axes, velocity, distance_to_go in points:
            rows.axes.append(axes)
            rows.path_velocity.append(velocity)
            rows.distance_to_go.append(distance_to_go)
            rows.state.append(C.HOLD if held and velocity == 0.0 else state)
        rows.line += [self._sequence.source.line] * count
        rows.block_number += [self._sequence.source.block_number] * count
        rows.programmed_feed += [self._motion.feed] * count
        rows.override_percent += [self._override_percent] * count
        rows.error_id += [self._error_id] * count

    def _state_code(self) -> ChannelStateCode:
        """State of the channel; HOLD replaces RUNNING when feed hold or override 0 have brought the path to rest."""
        if self._error_id:
            return C.ERROR
        phase = self._sequence.phase
        if phase is Phase.MOTION and self._motion.on_path:
            return C.RUNNING
        if self._sequence.homing_held:
            return C.HOLD
        if phase is Phase.IDLE:
            return C.IDLE if self._programs.loaded is None else C.READY
        return PHASE_STATES[phase]

    def _begin(
        self, cycle: int, command: str, program: Program, state: ProgramState, begin: ProgramStart | None = None
    ) -> None:
        self._require_axes(command)
        unreferenced, manual = self._axes.unreferenced(self._feedback), command == "mdi"
        started = self._programs.start(program, self._motion.position, state, unreferenced, begin, manual=manual)
        self._offsets.begin(cycle, started.before.modal)
        self._progress = ProgramProgress(started.times, program.size)
        self._sequence.begin(started.stream, program=not manual)
        self._just_started = True

    def _require_axes(self, command: str) -> None:
        """The axes of the path stand, are where their coordinates say, and publish, as the spindles do."""
        for node, axis_state in self._axes.states.items():
            if axis_state != AxisStateCode.STANDSTILL:
                self._refuse(
                    command,
                    AXIS_NOT_READY,
                    f"axis {node} is in {state_name(axis_state)}, it must be in Standstill",
                    axis=node,
                )
        for node in self._axes.beside:
            self._refuse(
                command, NOT_NOW, f"{NOT_AT_END.format(node)}; try again when the program is finished", axis=node
            )
        for node in self.lost:
            if node in self._axes.nodes or any(node == spindle.node for spindle in self._parameters.spindles):
                self._refuse(command, AXIS_NOT_READY, f"'{node}' no longer publishes", unit=node)
        for node in self._axes.shifted(self._feedback):
            reason = f"the coordinates of axis {node} are not those of the machine (set_position)"
            self._refuse(command, COORDINATES_SHIFTED, f"{reason}; shift them back or home the axis", axis=node)

    # override, feedback, faults

    def _apply_override(self) -> None:
        held = self._feed_hold or bool(self._axes.withheld)
        percent = min(self._override_percent * self._path_spindle.override, self._parameters.max_override_percent)
        self._motion.set_override(0.0 if held else percent / 100.0, held=held)
        self._sequence.set_override(0.0 if self._feed_hold else min(100.0, self._override_percent))

    def _read_releases(self, cycle: int, inputs: Mapping[str, CycleBlock]) -> None:
        """An axis on the path without feed release in its direction holds the path; one warning per element.

        An element that brakes for its end continues; the next one is held if it goes in that direction, too.
        """
        can_be_held = self._motion.can_be_held and not self._element_begins
        line, before = self._sequence.source.line, self._axes.withheld
        for node in self._axes.read_releases(inputs, can_be_held=can_be_held):
            reason = f"the path stops in line {line} and waits for the feed release of axis {node}"
            self._warn_of(cycle, Finding(FEED_WITHHELD, reason))
        if self._axes.withheld != before:
            self._apply_override()

    def _read_feedback(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> None:
        """Takes over what axes and spindles reported for the previous block."""
        self._feedback = inputs
        self._read(self._motion.read_spindles, first_cycle)
        self._read_releases(first_cycle, inputs)
        for reason in self._axes.read(inputs, just_started=self._just_started):
            self._fault(first_cycle, AXIS_NOT_READY, reason)
        self._just_started = False
        for finding in self._watch.faults(inputs):
            self._fault(first_cycle, finding.number, finding.text, finding.values)
        self._read(self._sequence.read, first_cycle)
        self._read(self._read_path_spindle, first_cycle)
        self._motion.follow_spindle()
        self._warn(first_cycle)
        for finding in self._watch.waiting(first_cycle, self._override_percent, feed_hold=self._feed_hold):
            self._warn_of(first_cycle, finding)

    def _read(self, read: Callable[[int, Mapping[str, CycleBlock]], None], first_cycle: int) -> None:
        """What the path or the program reads of the reports, which may be a fault of the active block."""
        try:
            read(first_cycle, self._feedback)
        except CncError as error:
            self._fault_in_line(first_cycle, error)

    def _read_path_spindle(self, first_cycle: int, feedback: Mapping[str, CycleBlock]) -> None:
        """The spindle on the path, whose travel counts from where it follows; its override acts on all of it."""
        before = self._path_spindle.node
        if self._path_spindle.read(first_cycle):
            self._apply_override()
        if self._path_spindle.node and not before:
            self._motion.take_spindle()

    @property
    def interpreter(self) -> RunningBlocks | None:
        """That of a program that is interpreted while it runs."""
        running = self._sequence.stream.running
        return running if isinstance(running, RunningBlocks) else None

    @property
    def runs_out(self) -> bool:
        """The path is slower because the interpreter does not keep up."""
        return self._watch.runs_out

    @property
    def blocks_ahead(self) -> tuple[float, float]:
        """How full the buffer of interpreted blocks is (0 … 1), and the length of the path that is known, mm."""
        return self._sequence.stream.fill, self._motion.path_ahead

    def _warn_of(self, cycle: int, finding: Finding) -> None:
        text, line = f"channel {self.name}: {finding.text}", self._sequence.source.line
        self.report(cycle, Severity.WARNING, finding.number, text, finding.values, line)

    def _fault_in_line(self, cycle: int, error: CncError) -> None:
        """Error of the active block; what the program has told before comes before it."""
        self._warn(cycle)
        where = line_of_program(self._sequence.source, self._sequence.calls)
        self._fault(cycle, error.number, f"{error.message} in {where}", error.values)

    def _fault(
        self, cycle: int, error_id: int, reason: str, values: Mapping[str, Value] = NO_VALUES, *, way: str = ""
    ) -> None:
        """Error reaction: the path ramps down, the program is aborted, its spindles stop; state ERROR until reset.

        `way`: how the axes stop, if not along the path.
        """
        if self._error_id:
            return
        idle = self._sequence.phase is Phase.IDLE
        way = way or self._motion.stop_text or "the path stops on its ramp"
        effect = f"{way} and the program is aborted"
        if idle:
            effect = "its spindles stop" if self._sequence.spindles_move else "nothing moves"
        line = 0 if idle else self._sequence.source.line
        self._error_id = error_id
        self.report(cycle, Severity.ERROR, error_id, f"channel {self.name}: {reason}; {effect}", values, line)
        self._sequence.ramp_down()

    def _fail_before(self, cycle: int, error: ProgramError) -> None:
        """Error reaction to a block that is not executed: all before it has been done, and the path stands."""
        line, text = self._sequence.source.line, self._sequence.source.text.strip()
        where = f"the path stands behind line {line} '{text}'" if line else "nothing has moved"
        self._error_id = error.number
        reason = f"{error.full_message}; {where} and the program is aborted"
        self.report(cycle, Severity.ERROR, error.number, f"channel {self.name}: {reason}", error.values, error.line)
        self._sequence.ramp_down()

    def _require_idle(self, command: str) -> None:
        if self._error_id:
            self._refuse(
                command,
                NOT_NOW,
                f"the channel is in error P-ERR-{self._error_id}; reset it first",
                error=self._error_id,
            )
        if self._sequence.phase is not Phase.IDLE:
            line = self._sequence.source.line
            self._refuse(command, NOT_NOW, f"a program is running (line {line})", line=line)

    def _refuse(self, command: str, number: int, reason: str, /, **values: Value) -> NoReturn:
        where = f"channel {self.name}: {command} refused"
        raise CncError(number, reason, "nothing was changed", where=where, **values)


def add_spindle(block: ChannelBlock, node: str, states: Sequence[AxisState]) -> None:
    """The setpoints of the spindle on the path."""
    block.path_spindles = [node]
    travel, speed, acceleration, jerk = map(list, zip(*states, strict=True))
    block.spindle_travel, block.spindle_speed = travel, speed
    block.spindle_acceleration, block.spindle_jerk = acceleration, jerk


PHASE_STATES = {
    Phase.NEXT: C.RUNNING,
    Phase.WAIT_GEAR: C.WAITING,
    Phase.WAIT_END: C.WAITING,
    Phase.MOTION: C.WAITING,
    Phase.HOMING: C.RUNNING,
    Phase.WAIT_SIGNAL: C.WAITING,
    Phase.WAIT_BEFORE: C.WAITING,
    Phase.WAIT_AFTER: C.WAITING,
    Phase.STOPPED: C.STOPPED,
    Phase.RAMP_DOWN: C.STOPPING,
}
"""State shown in each phase; MOTION without an element is a dwell."""
