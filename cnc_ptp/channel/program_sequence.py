"""Program sequence: the functions, motion and waits of one NC block after the other.

| phase | what happens | next |
|---|---|---|
| NEXT | the next block is taken; its gear change goes out | WAIT_GEAR, WAIT_BEFORE, at the end WAIT_END |
| WAIT_GEAR | the path waits for the gear; then the functions before the motion go out | WAIT_BEFORE |
| WAIT_BEFORE | the path waits for all that must precede the motion | MOTION, without one WAIT_AFTER |
| MOTION | PathMotion makes the cycles; functions of MNE_SNS go out with the measuring event | WAIT_AFTER |
| HOMING | G74: the axes are off the path and home themselves | WAIT_AFTER |
| WAIT_SIGNAL | a measuring run is at its end without a signal; the axes still follow the path | WAIT_AFTER |
| WAIT_AFTER | functions after the motion have gone out; the block's last waits | NEXT, STOPPED, at M30 IDLE |
| WAIT_END | no M30, or a fault in the next block: the path waits for all that is pending | IDLE, RAMP_DOWN |
| STOPPED | M00, M01, single block: `resume` continues | NEXT |
| RAMP_DOWN | the program was aborted, the path stops on its ramp | IDLE |
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from enum import Enum, auto
from typing import NamedTuple

from cnc_ptp.channel.axis_homing import AxisHoming
from cnc_ptp.channel.block_stream import BlockStream
from cnc_ptp.channel.following_blocks import FollowingBlocks
from cnc_ptp.channel.function_output import FunctionOutput
from cnc_ptp.channel.handshake import Handshake
from cnc_ptp.channel.measuring import STROKE_SHORT, Measuring
from cnc_ptp.channel.path_spindle import PathSpindle
from cnc_ptp.channel.spindle_reports import Condition, Expectation
from cnc_ptp.channel.timers import Timers
from cnc_ptp.channel.waits import Moment, Outgoing, Wait
from cnc_ptp.errors import CncError
from cnc_ptp.nc.canonical import (
    BUSY,
    CanonicalBlock,
    CircularMove,
    ExplicitSynchronisation,
    HomeAxes,
    LanguageWarning,
    LinearMove,
    Message,
    OffsetReport,
    OrderedError,
    Source,
    Timer,
    WaitForPath,
    led_by_spindle,
)
from cnc_ptp.nc.faults import ProgramError, line_of_program
from cnc_ptp.nc.measuring import measures
from cnc_ptp.path.path_motion import PathMotion
from cnc_ptp.protocol.blocks import AxisBlock, CycleBlock, EventValue
from cnc_ptp.protocol.notes import MEASURED, ORDERED_ERROR, PROGRAM_MESSAGE

ENDS = ("stop", "decouple")
"""Commands that are sent although the program was aborted."""
NO_SOURCE = Source("", 0, 0, "")
NO_MEASURING_EVENT = 22017
COMMANDED_BY_OTHERS = 22022
COUPLING_ENDED = 22025


class Phase(Enum):
    """Where the channel is within its program."""

    IDLE = auto()
    NEXT = auto()
    WAIT_GEAR = auto()
    WAIT_BEFORE = auto()
    MOTION = auto()
    HOMING = auto()
    WAIT_SIGNAL = auto()
    WAIT_AFTER = auto()
    WAIT_END = auto()
    STOPPED = auto()
    RAMP_DOWN = auto()


OFF_PATH = (Phase.IDLE, Phase.HOMING)
"""Others may move the channel's axes."""
WAITING = (Phase.WAIT_GEAR, Phase.WAIT_BEFORE, Phase.WAIT_AFTER, Phase.WAIT_END)
ORDER = {moment: rank for rank, moment in enumerate(Moment)}
ALL_LATE = frozenset((Moment.NEXT_CUT, Moment.EXPLICIT))
"""What the path waits for at the end of the program, but not in its own block."""


class Told(NamedTuple):
    """An event for the operator: its number, text, program line and the numbers in the text."""

    number: int
    text: str
    line: int
    values: Sequence[EventValue] = ()


class ProgramSequence:
    """Runs canonical blocks.

    `go_on` makes one step that takes no time; it returns False when only time, the PLC or a spindle can help. While
    `phase` is MOTION or RAMP_DOWN, PathMotion makes the cycles and `motion_ended` reports that it has finished.
    """

    def __init__(
        self,
        motion: PathMotion,
        functions: FunctionOutput,
        axes: Sequence[str],
        homing: AxisHoming,
        measuring: Measuring,
        timers: Timers,
        path_spindle: PathSpindle,
    ) -> None:
        """`axes`: nodes of the channel's axes, in its order."""
        self._path_spindle = path_spindle
        self._motion = motion
        self._homing = homing
        self._measuring = measuring
        self._timers = timers
        self._axes = axes
        self._functions = functions
        self.phase = Phase.IDLE
        self.finished = False
        """The program has been carried out to its end."""
        self.source = NO_SOURCE
        """Source of the active block; after the end, of the last one."""
        self.calls: tuple[str, ...] = ()
        """From where the subroutine of the active block was called, the innermost first."""
        self.single_block = ""
        """As set_single_block has it."""
        self._block: CanonicalBlock | None = None
        self._following = FollowingBlocks(functions, self._open_waits)
        self._keep: Container[str] = ()
        self._outgoing = Outgoing()
        self._waits: list[Wait] = []
        self._waited_at = -1
        """The block in which a wait for the path ended: the next one has newer reports."""
        self._due: frozenset[Moment] = frozenset()
        """The moments that have come: the path waits for the functions of these moments."""
        self.starts_late = False
        """The motion of the active block waits until the interpreter has found the block with which it is linked."""
        self._awaits_event = False
        """Functions of the block go out with the measuring event."""
        self._fault: CncError | None = None
        """Of the next block (ProgramError), or of the active one."""
        self._fault_found = -1
        """The cycle block in which it was found: its functions go out with the next one."""
        self.handshake = Handshake()
        self._feedback: Mapping[str, CycleBlock] = {}
        self._read_at = 0
        """First cycle of the last block."""
        self.notes: list[tuple[int, str, int]] = []
        """Warnings for the channel to publish: number, text and line."""
        self.messages: list[Told] = []
        """Messages of the program for the channel to publish."""
        self.offsets: OffsetReport | None = None
        """Offsets that count from the active block on, for the channel to publish."""

    @property
    def stream(self) -> BlockStream:
        """The blocks of the program."""
        return self._following.stream

    # from outside

    def begin(self, stream: BlockStream, *, program: bool) -> None:
        """Starts from the first block; a `program` starts with feedforward off, MDI blocks leave it unchanged."""
        if program:
            self._outgoing.commands += self._functions.at_program_start()
            self._functions.expect_nothing()
        self.finished = self.starts_late = False
        self._fault = None
        self._following.begin(stream)
        self.phase = Phase.NEXT

    def resume(self) -> None:
        """Resumes after M00, M01 or in single block."""
        if not self._motion.halted:
            self.phase = Phase.NEXT
            return
        self.phase = Phase.MOTION
        self._motion.resume()
        if self.single_block:
            self._motion.halt()

    def set_single_block(self, mode: str) -> None:
        """`block`: the program stops behind each block, `motion`: behind each motion, "": behind none."""
        self.single_block = mode
        if self.phase is Phase.MOTION:
            if mode:
                self._motion.halt()
            else:
                self._motion.resume()

    @property
    def optional_stop(self) -> bool:
        """M01 stops like M00."""
        return self._following.optional_stop

    @optional_stop.setter
    def optional_stop(self, enabled: bool) -> None:
        self._following.optional_stop = enabled

    def halted(self) -> None:
        """The path has halted at the end of the active block."""
        self.phase = Phase.STOPPED

    def ramp_down(self, *, keep: Container[str] = ()) -> None:
        """Aborts the program: the path comes to rest on its ramp, then the channel's spindles stop, except `keep`.

        Without a program only the spindles are left to stop.
        """
        self._keep = keep
        if self.phase is Phase.RAMP_DOWN:
            return
        if self.phase is Phase.IDLE:
            self._stop_spindles()
            return
        moving = self.phase is Phase.MOTION and self._motion.on_path
        homes = self.phase is Phase.HOMING
        self.phase = Phase.RAMP_DOWN
        self._awaits_event = False
        self._measuring.end()
        self._outgoing = Outgoing(commands=[command for command in self._outgoing.commands if command.command in ENDS])
        if homes:
            self._outgoing.commands += self._homing.stop(self._feedback)
        self._functions.withdraw()
        self._waits = []
        if moving:
            self._motion.stop()
        else:
            self.motion_ended()

    @property
    def cuts(self) -> bool:
        """The path moves at a feed, in no thread."""
        motion = self._block.motion if self._block is not None and self.phase is Phase.MOTION else None
        if led_by_spindle(motion):
            return False
        return isinstance(motion, CircularMove) or (isinstance(motion, LinearMove) and not motion.rapid)

    def speed_follows(self, spindles: Container[str]) -> None:
        """Nothing waits any longer for a programmed speed of these spindles (nodes): the facing axis changes it."""
        for wait in self._waits:
            if wait.expected.condition is Condition.SPEED and wait.expected.spindle in spindles:
                wait.expected = Expectation(wait.expected.spindle)

    def _stop_spindles(self) -> None:
        """M05 for the spindles that the channel has started, except those to keep; its couplings end."""
        self._path_spindle.release(self._motion)
        self._functions.expect_nothing(self._keep)
        self._queue(self._functions.at_abort(self.source, self._keep))

    @property
    def spindles_move(self) -> bool:
        """The channel has started spindles."""
        return any(spindle.responsible for spindle in self._functions.spindles)

    def end_couplings(self) -> None:
        """Ends the couplings that MDI blocks have left, before a program starts."""
        self._outgoing.commands += self._functions.spindles.decouple_all()

    def measuring_event(self) -> bool:
        """The signal of the PLC: a measuring run ends, functions of type MNE_SNS go out; False without either.

        A measuring run reads the newest blocks of the axes first.
        """
        if self._block is not None and measures(self._block.motion):
            self._measuring.commanded = self._measuring.awaits
            return self._measuring.awaits
        return self._send_at_event()

    def _touch(self) -> None:
        """The probe has switched: the path stops on its ramp, its distance to go is deleted."""
        self._send_at_event()
        if self.phase is Phase.MOTION:
            self._motion.stop()
        measuring = self._measuring
        self.messages.append(Told(MEASURED, measuring.text(), self.source.line, measuring.values()))
        measuring.overrun(self._motion.rest)
        if self.phase is Phase.WAIT_SIGNAL:
            self._end_motion()

    def _send_at_event(self) -> bool:
        """The functions of type MNE_SNS of the active block go out; False when there are none."""
        if not self._awaits_event or self._block is None:
            return False
        self._awaits_event = False
        self._queue(self._functions.of_block(self._block, Moment.EVENT))
        return True

    def acknowledge(self, request_id: int) -> None:
        """The PLC has acknowledged a request."""
        request = self.handshake.acknowledge(request_id)
        if request is not None:
            self._functions.acknowledged(request)

    def take_outgoing(self, first_cycle: int) -> Outgoing:
        """Commands and requests of the cycle block that starts at `first_cycle`; its waits count from there."""
        outgoing, self._outgoing = self._outgoing, Outgoing()
        for request in outgoing.requests:
            request.cycle = first_cycle
        outgoing.commands = self._path_spindle.take_commands(first_cycle) + outgoing.commands
        for wait in self._waits:
            if wait.sent_cycle is None:
                wait.sent_cycle = first_cycle
        self._functions.spindles.send(first_cycle)
        return outgoing

    def set_override(self, percent: float) -> None:
        """Override of the channel for axes that home; PathMotion has its own."""
        self._outgoing.commands += self._homing.set_override(percent)

    @property
    def homing_held(self) -> bool:
        """Axes that are to home are held by the override of the channel."""
        return self.phase is Phase.HOMING and self._homing.held

    def _home(self) -> None:
        self._outgoing.commands += self._homing.go_on(self._feedback)
        if self._homing.done():
            self.motion_ended()

    def read(self, cycle: int, feedback: Mapping[str, CycleBlock]) -> None:
        """Reads the blocks of spindles, homing and measuring axes for the cycles before `cycle`.

        Raises CncError 22035, 22051, 22052.
        """
        passed, self._read_at = cycle - self._read_at, cycle
        self._feedback = feedback
        if self.phase is Phase.HOMING:
            self._home()
        elif self._measuring.awaits:
            self._measure(passed)
        spindles = self._functions.spindles
        ended = spindles.read(cycle, feedback)
        for text in ended:
            self._note(COUPLING_ENDED, f"{text}, others have decoupled it; the program continues")
        runs = self.phase not in (Phase.IDLE, Phase.RAMP_DOWN)
        waited_for = self._speeds_waited_for()
        for spindle in spindles:
            if lost := spindle.lost_speed(cycle, watched=runs and spindle.node not in waited_for):
                self._note(COMMANDED_BY_OTHERS, f"{lost}; the program continues")

    def _measure(self, passed: int) -> None:
        """A measuring run waits for its signal; `passed`: cycles since the last block."""
        measuring, feedback = self._measuring, self._feedback
        if measuring.read(feedback):
            self._touch()
        elif self.phase is not Phase.WAIT_SIGNAL:
            measuring.follow(feedback)
        elif measuring.settled(feedback, passed):
            self._end_motion()

    def _holds(self, wait: Wait) -> bool:
        """The path waits for it now."""
        return self.phase in WAITING and wait.until in self._due

    def _waited_for(self) -> list[Wait]:
        return [wait for wait in self._waits if self._holds(wait)]

    def _speeds_waited_for(self) -> set[str]:
        """Nodes of the spindles whose speed the path waits for: a missed speed is noticed there."""
        expected = [wait.expected for wait in self._waited_for()]
        return {expectation.spindle for expectation in expected if expectation.condition is Condition.SPEED}

    def waits_for(self) -> str:
        """What the program waits for that does not come with time alone; empty when it continues without help."""
        if self.phase is Phase.STOPPED:
            return "start"
        if self.phase is Phase.MOTION and self._motion.awaited_spindle:
            return f"spindle {self._functions.spindles[self._motion.awaited_spindle].node} to turn (G95)"
        if self.phase is Phase.MOTION and self._motion.held and self._motion.velocity == 0.0:
            return "an override above 0, the end of the feed hold or a feed release"
        if self.phase is Phase.MOTION and self._motion.waits_for:
            return self._motion.waits_for
        if self.homing_held:
            return "an override above 0 or the end of the feed hold"
        waits = [wait.text(self.handshake) for wait in self._waited_for()]
        return " and ".join(text for text in waits if text)

    def held_by_override(self, cycle: int) -> list[str]:
        """What the program waits for of spindles that override 0 holds."""
        return [text for wait in self._waited_for() if (text := wait.held(cycle, self._feedback))]

    # from block to block

    def go_on(self, first_cycle: int, cycle: int) -> bool:
        """One step forward between motions at `cycle` of the block; False when the path has to wait.

        Raises ProgramError of the next block, CncError of PathMotion.start, and 22019 and 22021 of Wait.fulfilled.
        """
        if self.phase is Phase.NEXT:
            return self._begin_block(first_cycle, cycle)
        if self.phase not in WAITING:
            return False
        waits = self._waited_for()
        done = [wait for wait in waits if wait.fulfilled(first_cycle, self._feedback, self.handshake)]
        if done:
            self._waits = [wait for wait in self._waits if wait not in done]
        if len(done) < len(waits):
            return False
        if self.phase is Phase.WAIT_GEAR:
            self._functions_before(first_cycle, cycle)
        elif self.phase is Phase.WAIT_BEFORE:
            return self._start_motion(first_cycle, cycle)
        elif self.phase is Phase.WAIT_END:
            return self._finish_if_good(first_cycle)
        else:
            self._end_block(first_cycle)
        return True

    def _wait(self, phase: Phase, *moments: Moment) -> None:
        """From now on the path waits for the functions of these moments."""
        self.phase, self._due = phase, frozenset(moments)

    def motion_ended(self) -> None:
        """The motion of the block, or the ramp of an aborted program, has finished: the axes are at a standstill."""
        if self.phase is Phase.RAMP_DOWN:
            self._motion.abandon()
            self._end_program()
            self._stop_spindles()
            return
        if self._measuring.awaits:
            self._motion.finish()
            self.phase = Phase.WAIT_SIGNAL
            return
        self._end_motion()

    def _end_motion(self) -> None:
        """The motion has finished; what comes after it goes out."""
        if self._measuring.reached:
            self._motion.abandon()
        else:
            self._motion.finish()
        self._measuring.end()
        if self._awaits_event:
            text = "no measuring event has come in the block; its functions go out after the motion"
            self._note(NO_MEASURING_EVENT, text)
            self._send_at_event()
        if self._block is not None:
            self._queue(self._functions.of_block(self._block, Moment.AFTER))
        if self._block is not None and self._block.stop == "end":
            self._await_answers()
            self._wait(Phase.WAIT_AFTER, Moment.AFTER, *ALL_LATE)
        else:
            self._wait(Phase.WAIT_AFTER, Moment.AFTER)

    def _await_answers(self) -> None:
        """The program ends when the spindles have had one block in which to refuse their commands."""
        for spindle in self._functions.spindles:
            expected = Expectation(spindle.node)
            self._add_waits([Wait(Moment.AFTER, expected, sent_cycle=cycle) for cycle in spindle.answers()])

    def _begin_block(self, first_cycle: int, cycle: int) -> bool:
        """False while the interpreter computes, and behind a wait for the path.

        A fault counts when all that precedes it has been done.
        """
        if first_cycle == self._waited_at:
            return False  # the axes report where they are once in a block
        if self.stream.awaited:
            actual = self._actual_positions()
            override = round(100.0 * self._motion.override, 9)
            self.stream.give(actual, self._motion.position, self._timers.read, self._measuring.touch, override)
        block: CanonicalBlock | None = None
        try:
            block = self._following.take()
        except ProgramError as fault:
            self._fault, self._fault_found = fault, first_cycle
        if block is BUSY:
            return False
        if block is None:
            self._await_answers()
            self._wait(Phase.WAIT_END, Moment.AFTER, *ALL_LATE)
            return True
        self._reach(block)
        self._path_spindle.leave_before(block, self._motion)
        gear = self._functions.gear_change(block)
        if not gear.commands:
            self._functions_before(first_cycle, cycle)
            return True
        self._queue(gear)
        self._wait(Phase.WAIT_GEAR, Moment.BEFORE)
        return True

    def _actual_positions(self) -> tuple[float, ...]:
        """As the axes have reported them last, 0 for one that has not yet; of the C axis as it is set."""
        set_positions = self._motion.position[len(self._axes) :]
        return (*actual_positions(self._feedback, self._axes), *set_positions)

    def _reach(self, block: CanonicalBlock) -> None:
        """The block is the active one."""
        self._block = block
        self.source, self.calls = block.source, block.calls
        if block.offsets is not None:
            self.offsets = block.offsets

    def _functions_before(self, first_cycle: int, cycle: int) -> None:
        """Sends the functions that precede the motion; the path waits for all that the motion needs."""
        block = self._block
        assert block is not None
        try:
            self._tell(block, cycle)
        except CncError as error:
            self._fail(error, first_cycle)
            return
        self._queue(self._functions.of_block(block, Moment.BEFORE))
        self._awaits_event = any(self._functions.moment(function) is Moment.EVENT for function in block.functions)
        self._wait(Phase.WAIT_BEFORE, *moments_before(block))

    def _tell(self, block: CanonicalBlock, cycle: int) -> None:
        """Messages, warnings and timers of the block. Raises CncError 22029 for an error that the program orders."""
        for function in block.functions:
            if isinstance(function, Message):
                self.messages.append(Told(PROGRAM_MESSAGE, function.text, self.source.line))
            elif isinstance(function, Timer):
                self._timers.carry_out(function, cycle)
            elif isinstance(function, OrderedError):
                if function.severe:
                    raise CncError(ORDERED_ERROR, function.text)
                self._note(ORDERED_ERROR, f"{function.text} in {line_of_program(self.source, self.calls)}")
            elif isinstance(function, LanguageWarning):
                self._note(function.number, function.text)

    def _start_motion(self, first_cycle: int, cycle: int) -> bool:
        """False while the interpreter computes the block with which it is linked, while a spindle becomes an axis of
        the path, and while a measuring run waits for the next block: then all cycles before it have been reported.
        """
        if self._block is not None and not self._path_spindle.taken_for(self._block, self._motion):
            return False
        motion = self._block.motion if self._block else None
        if motion is None:
            self.motion_ended()
        elif isinstance(motion, HomeAxes):
            self._homing.begin(motion.groups)
            self.phase = Phase.HOMING
        elif not (isinstance(motion, LinearMove) and motion.measures):
            self.starts_late = self._following.awaits_next(motion)
            if self.starts_late:
                return False
            try:
                self._motion.start(motion, self._following)
                self.phase = Phase.MOTION
            except CncError as error:
                self._fail(error, first_cycle)
        elif cycle != first_cycle + 1 or not self._measuring.ready(motion, self._feedback):
            return False
        else:
            self._start_measuring(motion)
        return True

    def _fail(self, error: CncError, first_cycle: int) -> None:
        """Raises the error of the active block, or notes it until the functions before it have gone out."""
        if not (self._outgoing.commands or self._outgoing.requests):
            raise error
        self._fault, self._fault_found = error, first_cycle
        self._wait(Phase.WAIT_END)

    def _start_measuring(self, motion: LinearMove) -> None:
        """Raises CncError 50052, and those of PathMotion.start."""
        self._measuring.begin(motion, self._feedback)
        if short := self._measuring.short_strokes(self._motion.braking(motion)):
            self._note(STROKE_SHORT, short)
        self._motion.start(motion)
        self.phase = Phase.MOTION

    def _open_waits(self) -> Container[Moment]:
        """The moments before which the path has to stop; all in single block, but not within a thread."""
        threads = self._block is not None and led_by_spindle(self._block.motion)
        return list(Moment) if self.single_block and not threads else [wait.until for wait in self._waits]

    def pass_block(self, cycle: int) -> None:
        """The path continues in the next block without a stop; blocks without motion in between are done at once.

        On the ramp of an aborted program their functions no longer go out.
        """
        moves = False
        while not moves:
            self.stream.finish_block()
            block = self._following.take()
            assert block is not None
            self._reach(block)
            if self.phase is Phase.MOTION:
                self._tell(block, cycle)
                self._queue(self._functions.of_block(block, Moment.BEFORE))
            moves = block.motion is not None
        self._motion.pass_block()

    def _end_block(self, first_cycle: int) -> None:
        stop = self._block.stop if self._block else ""
        self.stream.finish_block()
        if self._block is not None and any(isinstance(function, WaitForPath) for function in self._block.functions):
            self._waited_at = first_cycle
        if stop == "end":
            self._queue(self._functions.at_program_end(self.source))
            self._finish()
        elif stop == "M00" or (stop == "M01" and self.optional_stop) or self._stops_between_blocks():
            self.phase = Phase.STOPPED
        else:
            self.phase = Phase.NEXT

    def _stops_between_blocks(self) -> bool:
        """The program is not at its end then."""
        by_motion = self.single_block == "motion"
        moved = self._block is not None and isinstance(self._block.motion, LinearMove | CircularMove)
        return self.single_block != "" and (moved or not by_motion) and self.stream.done < self.stream.total

    @property
    def awaits_blocks(self) -> bool:
        """The path would continue if the interpreter knew how."""
        return self._following.busy

    @property
    def motion_begun(self) -> bool:
        """The motion of the block that is not through yet is active, or has finished."""
        return self.phase in (Phase.MOTION, Phase.WAIT_SIGNAL, Phase.WAIT_AFTER)

    def _finish_if_good(self, first_cycle: int) -> bool:
        """False while functions before a fault are still to go out. Raises the fault then."""
        if self._fault is None:
            self._finish()
            return True
        if first_cycle > self._fault_found:
            raise self._fault
        return False

    def _finish(self) -> None:
        """The program has been carried out to its end."""
        self._end_program()
        self.stream.end()
        self.finished = True

    def _end_program(self) -> None:
        self._path_spindle.release(self._motion)
        self._motion.feed = 0.0
        self._block = None
        self._waits = []
        self._awaits_event = False
        self.handshake.clear()
        self.phase = Phase.IDLE

    def _queue(self, outgoing: Outgoing) -> None:
        """Functions go out with the next block; the path waits for them if their synchronisation type says so.

        A newer function of a spindle replaces the wait for an older one, unless that holds the path now: then a
        measuring event would start a motion whose spindle does something else.
        """
        self._outgoing.commands += outgoing.commands
        self._outgoing.requests += outgoing.requests
        for number, text in outgoing.notes:
            self._note(number, text)
        later = [wait for wait in self._waits if not self._holds(wait)]
        for newer in outgoing.expected:
            waits_too = any(wait.expected is newer for wait in outgoing.waits)
            for wait in later:
                wait.renew(newer, waits_too=waits_too)
        self._add_waits(outgoing.waits)
        self.handshake.add(outgoing.requests)

    def _note(self, number: int, text: str) -> None:
        self.notes.append((number, text, self.source.line))

    def _add_waits(self, waits: Sequence[Wait]) -> None:
        """The list is in the order of the moments."""
        self._waits = sorted([*self._waits, *waits], key=lambda wait: ORDER[wait.until])


def actual_positions(feedback: Mapping[str, CycleBlock], axes: Sequence[str]) -> tuple[float, ...]:
    """As the axes have reported them last; 0 for one that has not yet."""
    blocks = (feedback.get(axis) for axis in axes)
    return tuple(block.actual_position[-1] if isinstance(block, AxisBlock) else 0.0 for block in blocks)


def moments_before(block: CanonicalBlock) -> list[Moment]:
    """The moments that have come when the motion of the block may start."""
    moments = [Moment.BEFORE]
    if block.motion is not None:
        moments.append(Moment.NEXT_MOTION)
    if isinstance(block.motion, CircularMove) or (isinstance(block.motion, LinearMove) and not block.motion.rapid):
        moments.append(Moment.NEXT_CUT)
    if any(isinstance(function, ExplicitSynchronisation) for function in block.functions):
        moments.append(Moment.EXPLICIT)
    return moments
