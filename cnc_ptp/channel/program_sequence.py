"""The sequence of a program in a channel: block after block its functions, its motion and what the path waits for.

A block goes: gear change (and wait), functions before the motion, waits (its own; before a motion until feedforward and
compensations have gone out; before G01, G02, G03 those of MVS_SLM; at #EXPL SYN those of MVS_SLP; at the end of the
program all), motion (functions of MNE_SNS with the measuring event), functions after it, waits, stop or next block.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from enum import Enum, auto

from cnc_ptp.channel.function_output import FunctionOutput, Moment
from cnc_ptp.channel.spindle_reports import Condition
from cnc_ptp.channel.spindle_watch import SpindleWatch
from cnc_ptp.channel.waits import Outputs, Wait
from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove, ExplicitSynchronisation, LinearMove, Source
from cnc_ptp.path.path_motion import PathMotion
from cnc_ptp.protocol.blocks import Block, HandshakeRequest

ENDS = ("stop", "decouple")
"""Commands that go out although the program was aborted."""
NO_SOURCE = Source("", 0, 0, "")
NO_MEASURING_EVENT = 22017
COMMANDED_BY_OTHERS = 22022
SPEED_WITHOUT_EFFECT = 22023
COUPLING_ENDED = 22025


class Phase(Enum):
    """Where the channel is within its program."""

    IDLE = auto()
    NEXT = auto()
    WAIT_GEAR = auto()
    WAIT_BEFORE = auto()
    MOTION = auto()
    WAIT_AFTER = auto()
    WAIT_END = auto()
    STOPPED = auto()
    RAMP_DOWN = auto()


WAITING = (Phase.WAIT_GEAR, Phase.WAIT_BEFORE, Phase.WAIT_AFTER, Phase.WAIT_END)


class ProgramSequence:
    """Runs canonical blocks.

    `go_on` makes one step that takes no time; it returns False when only time, the PLC or a spindle can help. While
    `phase` is MOTION or RAMP_DOWN, PathMotion makes the cycles and `motion_ended` tells when it is through.
    """

    def __init__(self, motion: PathMotion, functions: FunctionOutput) -> None:
        self._motion = motion
        self._functions = functions
        self.phase = Phase.IDLE
        self.blocks: Sequence[CanonicalBlock] = ()
        self.blocks_done = 0
        self.source = NO_SOURCE
        """Where the running block comes from, after the end the last one."""
        self.single_block = False
        self.optional_stop = False
        self._block: CanonicalBlock | None = None
        self._keep: Container[str] = ()
        self._outputs = Outputs()
        self._unsent: list[Wait] = []
        self._waits: list[Wait] = []
        self._waits_after: list[Wait] = []
        self._waits_motion: list[Wait] = []
        self._waits_machining: list[Wait] = []
        self._waits_explicit: list[Wait] = []
        self._awaits_event = False
        """Functions of the block go out with the measuring event."""
        self.open_requests: set[int] = set()
        """Numbers of the handshake requests that the PLC has not acknowledged."""
        self._asked: dict[int, HandshakeRequest] = {}
        self._watch = SpindleWatch(functions.channel)
        self._feedback: Mapping[str, Block] = {}
        self.notes: list[tuple[int, str]] = []
        """What the channel is to warn of: number and text."""

    # from outside

    def begin(self, blocks: Sequence[CanonicalBlock], *, program: bool) -> None:
        """Starts from the first block; a `program` begins with feedforward off, MDI blocks with what is set."""
        if program:
            self._outputs.commands += self._functions.at_program_start()
            self._watch.forget()
        self.blocks = blocks
        self.blocks_done = 0
        self.phase = Phase.NEXT

    def resume(self) -> None:
        """Goes on after M00, M01 or in single block."""
        self.phase = Phase.NEXT

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
        self.phase = Phase.RAMP_DOWN
        self._awaits_event = False
        self._outputs = Outputs(commands=[command for command in self._outputs.commands if command.command in ENDS])
        self._functions.spindles.concern.withdraw()
        self._unsent = []
        if moving:
            self._motion.stop()
        else:
            self.motion_ended()

    @property
    def through(self) -> bool:
        """The program has been carried out to its end."""
        return self.phase is Phase.IDLE and self.blocks_done == len(self.blocks)

    def _stop_spindles(self) -> None:
        """M05 for the spindles that the channel has set in motion, except those to keep; its couplings end."""
        self._watch.forget(self._keep)
        self._queue(self._functions.at_abort(self.source, self._keep))

    @property
    def spindles_move(self) -> bool:
        """The channel has set spindles in motion."""
        return any(True for _ in self._functions.spindles.concern)

    def end_couplings(self) -> None:
        """Couplings that manual blocks have left end before a program begins."""
        self._outputs.commands += self._functions.spindles.decouple_all()

    def measuring_event(self) -> bool:
        """The functions of type MNE_SNS of the running motion go out; False when there are none."""
        if not self._awaits_event or self._block is None:
            return False
        self._awaits_event = False
        outputs = self._functions.of_block(self._block, Moment.EVENT)
        self._queue(outputs)
        self._waits_after += outputs.waits_after
        return True

    def overdue(self, cycle: int, limit: int) -> HandshakeRequest | None:
        """The oldest request that the PLC has left unacknowledged for `limit` cycles."""
        return next((request for request in self._asked.values() if cycle - request.cycle >= limit), None)

    def acknowledge(self, request_id: int) -> None:
        """The PLC has carried out what it was asked for."""
        self.open_requests.discard(request_id)
        request = self._asked.pop(request_id, None)
        if request is not None:
            self._functions.acknowledged(request)

    def take_outputs(self, first_cycle: int) -> Outputs:
        """What is to go out with the block that begins at `first_cycle`; from there on its waits count."""
        outputs, self._outputs = self._outputs, Outputs()
        for request in outputs.requests:
            request.cycle = first_cycle
            if request.id in self.open_requests:
                self._asked[request.id] = request
        for wait in self._unsent:
            wait.sent_cycle = first_cycle
        self._unsent = []
        self._watch.note(outputs.told, first_cycle)
        self._functions.spindles.send(first_cycle)
        return outputs

    def read(self, cycle: int, feedback: Mapping[str, Block]) -> None:
        """Blocks that the spindles have reported for the cycles before `cycle`."""
        self._feedback = feedback
        ended = self._functions.spindles.read(cycle, feedback)
        self.notes += [(COUPLING_ENDED, f"{text}, others have decoupled it; the program goes on") for text in ended]
        waited_for = {wait.spindle for wait in self._waits if wait.condition is Condition.SPEED}
        runs = self.phase not in (Phase.IDLE, Phase.RAMP_DOWN)
        lost = self._watch.read(cycle, feedback, waited_for, runs=runs)
        self.notes += [(COMMANDED_BY_OTHERS, f"{text}; the program goes on") for text in lost]

    def waits_for(self) -> str:
        """What the program waits for that does not come with time alone; empty when it goes on by itself."""
        if self.phase is Phase.STOPPED:
            return "start"
        if self.phase is Phase.MOTION and self._motion.held and self._motion.velocity == 0.0:
            return "an override above 0, the end of the feed hold or a feed release"
        if self.phase in WAITING:
            waits = [wait.text(self.open_requests) for wait in self._waits]
            return " and ".join(text for text in waits if text)
        return ""

    def held_by_override(self, cycle: int) -> list[str]:
        """What the program waits for of spindles that override 0 holds."""
        waits = self._waits if self.phase in WAITING else []
        return [text for wait in waits if (text := wait.held(cycle, self._feedback))]

    # from block to block

    def go_on(self, first_cycle: int) -> bool:
        """One step forward between motions; False when the path has to wait.

        Raises CncError of PathMotion.start, and 22019 and 22021 of Wait.fulfilled.
        """
        if self.phase is Phase.NEXT:
            self._begin_block()
            return True
        if self.phase not in WAITING:
            return False
        spindles, requests = self._feedback, self.open_requests
        self._waits = [wait for wait in self._waits if not wait.fulfilled(first_cycle, spindles, requests)]
        if self._waits:
            return False
        if self.phase is Phase.WAIT_GEAR:
            self._functions_before()
        elif self.phase is Phase.WAIT_BEFORE:
            self._start_motion()
        elif self.phase is Phase.WAIT_END:
            self._end_program()
        else:
            self._end_block()
        return True

    def motion_ended(self) -> None:
        """The motion of the block, or the ramp of an aborted program, is through: the axes stand."""
        if self.phase is Phase.RAMP_DOWN:
            self._motion.abandon()
            self._end_program()
            self._stop_spindles()
            return
        self._motion.finish()
        if self._awaits_event:
            text = "no measuring event has come in the block; its functions go out after the motion"
            self.notes.append((NO_MEASURING_EVENT, text))
            self.measuring_event()
        outputs = self._functions.of_block(self._block, Moment.AFTER) if self._block else Outputs()
        self._queue(outputs)
        self._waits, self._waits_after = self._waits_after + outputs.waits_after, []
        if self._block is not None and self._block.stop == "end":
            self._waits += self._answers()
        self.phase = Phase.WAIT_AFTER

    def _answers(self) -> list[Wait]:
        """The program ends when the spindles have had a block in which to refuse what they were told."""
        told = [*self._watch.told, *self._outputs.told]
        answers = [Wait(wait.spindle, sent_cycle=wait.sent_cycle) for wait in told]
        self._unsent += [answer for answer in answers if answer.sent_cycle is None]
        return answers

    def _begin_block(self) -> None:
        if self.blocks_done >= len(self.blocks):
            self._waits = self._late_waits(machining=True, explicit=True) + self._answers()
            self.phase = Phase.WAIT_END
            return
        self._block = block = self.blocks[self.blocks_done]
        self.source = block.source
        gear = self._functions.gear_change(block, self._feedback)
        if not gear.commands:
            self._functions_before()
            return
        self._queue(gear)
        self._waits = gear.waits_before
        self.phase = Phase.WAIT_GEAR

    def _functions_before(self) -> None:
        """Functions that go out before the motion, and all that the motion has to wait for."""
        block = self._block
        assert block is not None
        outputs = self._functions.of_block(block, Moment.BEFORE)
        self._queue(outputs)
        self._waits, self._waits_after = outputs.waits_before, outputs.waits_after
        if block.motion is not None:
            self._waits, self._waits_motion = self._waits + self._waits_motion, []
        end = block.stop == "end"
        machining = isinstance(block.motion, CircularMove) or (
            isinstance(block.motion, LinearMove) and not block.motion.rapid
        )
        explicit = any(isinstance(function, ExplicitSynchronisation) for function in block.before)
        self._waits += self._late_waits(machining=machining, explicit=explicit)
        if end:
            self._waits_after += self._late_waits(machining=True, explicit=True)
        self._awaits_event = any(self._functions.moment(function) is Moment.EVENT for function in block.before)
        self.phase = Phase.WAIT_BEFORE

    def _late_waits(self, *, machining: bool, explicit: bool) -> list[Wait]:
        """Waits of MVS_SLM and, or, MVS_SLP whose moment has come."""
        waits: list[Wait] = []
        if machining:
            waits, self._waits_machining = self._waits_machining, []
        if explicit:
            waits, self._waits_explicit = waits + self._waits_explicit, []
        return waits

    def _start_motion(self) -> None:
        motion = self._block.motion if self._block else None
        if motion is None:
            self.motion_ended()
            return
        self._motion.start(motion)
        self.phase = Phase.MOTION

    def _end_block(self) -> None:
        stop = self._block.stop if self._block else ""
        self.blocks_done += 1
        if stop == "end":
            self._queue(self._functions.at_program_end(self._feedback, self.source))
            self._end_program()
        elif stop == "M00" or (stop == "M01" and self.optional_stop) or self._stops_between_blocks():
            self.phase = Phase.STOPPED
        else:
            self.phase = Phase.NEXT

    def _stops_between_blocks(self) -> bool:
        return self.single_block and self.blocks_done < len(self.blocks)

    def _end_program(self) -> None:
        self._motion.feed = 0.0
        self._block = None
        self._waits, self._waits_after, self._waits_motion = [], [], []
        self._waits_machining, self._waits_explicit = [], []
        self._awaits_event = False
        self.open_requests.clear()
        self._asked.clear()
        self.phase = Phase.IDLE

    def _queue(self, outputs: Outputs) -> None:
        """Functions go out with the next block; the path waits for them if their synchronisation type says so."""
        self._outputs.commands += outputs.commands
        self._outputs.requests += outputs.requests
        self._outputs.told += outputs.told
        self._unsent += outputs.waits
        notes = [stored.note(self._feedback) for stored in outputs.stored]
        self.notes += [*((SPEED_WITHOUT_EFFECT, note) for note in notes if note), *outputs.notes]
        self._renew_old_waits(outputs)
        self._waits_motion += outputs.waits_motion
        self._waits_machining += outputs.waits_machining
        self._waits_explicit += outputs.waits_explicit
        self.open_requests |= {request.id for request in outputs.requests if request.acknowledge_needed}

    def _renew_old_waits(self, outputs: Outputs) -> None:
        """A newer function of a spindle takes the place of what the path is still to wait for."""
        for newer in outputs.told:
            waits_too = any(wait is newer for wait in outputs.waits)
            for wait in self._waits_after + self._waits_machining + self._waits_explicit:
                if wait.spindle == newer.spindle:
                    wait.renew(newer, waits_too=waits_too)
                    self._unsent += [wait] if wait.sent_cycle is None else []
