"""The sequence of a program in a channel: block after block its functions, its motion and what the path waits for."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from enum import Enum, auto

from cnc_ptp.machine.blocks import Block
from cnc_ptp.machine.function_output import FunctionOutput, Outputs, Wait
from cnc_ptp.machine.path_motion import PathMotion
from cnc_ptp.nc.canonical import CanonicalBlock, Source

NO_SOURCE = Source("", 0, 0, "")


class Phase(Enum):
    """Where the channel is within its program."""

    IDLE = auto()
    NEXT = auto()
    WAIT_BEFORE = auto()
    MOTION = auto()
    WAIT_AFTER = auto()
    STOPPED = auto()
    RAMP_DOWN = auto()


class ProgramSequence:
    """Runs canonical blocks: functions before the motion, waits, motion, functions after it, waits, stop or next block.

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
        self.open_requests: set[int] = set()
        """Numbers of the handshake requests that the PLC has not acknowledged."""

    # from outside

    def begin(self, blocks: Sequence[CanonicalBlock], *, program: bool) -> None:
        """Starts from the first block; a `program` begins with feedforward off, MDI blocks with what is set."""
        if program:
            self._outputs.commands += self._functions.at_program_start()
        self.blocks = blocks
        self.blocks_done = 0
        self.phase = Phase.NEXT

    def resume(self) -> None:
        """Goes on after M00, M01 or in single block."""
        self.phase = Phase.NEXT

    def ramp_down(self, *, keep: Container[str] = ()) -> None:
        """Aborts the program: the path comes to rest on its ramp, then the channel's spindles stop, except `keep`."""
        self._keep = keep
        if self.phase in (Phase.IDLE, Phase.RAMP_DOWN):
            return
        moving = self.phase is Phase.MOTION and self._motion.on_path
        self.phase = Phase.RAMP_DOWN
        self._outputs = Outputs(commands=[command for command in self._outputs.commands if command.command == "stop"])
        self._unsent = []
        if moving:
            self._motion.stop()
        else:
            self.motion_ended()

    @property
    def through(self) -> bool:
        """The program has been carried out to its end."""
        return self.phase is Phase.IDLE and self.blocks_done == len(self.blocks)

    def stop_spindles(self, *, keep: Container[str] = ()) -> None:
        """M05 for the spindles that the channel has set turning, except the nodes in `keep`."""
        self._outputs.commands += self._functions.stop_spindles(keep)

    def take_outputs(self, first_cycle: int) -> Outputs:
        """What is to go out with the block that begins at `first_cycle`; from there on its waits count."""
        outputs, self._outputs = self._outputs, Outputs()
        for request in outputs.requests:
            request.cycle = first_cycle
        for wait in self._unsent:
            wait.sent_cycle = first_cycle
        self._unsent = []
        return outputs

    def waits_for(self) -> str:
        """What the program waits for that does not come with time alone; empty when it goes on by itself."""
        if self.phase is Phase.STOPPED:
            return "start"
        if self.phase is Phase.MOTION and self._motion.held and self._motion.velocity == 0.0:
            return "an override above 0 or the end of the feed hold"
        if self.phase in (Phase.WAIT_BEFORE, Phase.WAIT_AFTER):
            waits = [wait.text(self.open_requests) for wait in self._waits]
            return " and ".join(text for text in waits if text)
        return ""

    # from block to block

    def go_on(self, first_cycle: int, feedback: Mapping[str, Block]) -> bool:
        """One step forward between motions; False when the path has to wait. Raises CncError of PathMotion.start.

        `feedback`: blocks that the spindles have reported for the cycles before `first_cycle`.
        """
        if self.phase is Phase.NEXT:
            self._begin_block()
            return True
        if self.phase not in (Phase.WAIT_BEFORE, Phase.WAIT_AFTER):
            return False
        self._waits = [wait for wait in self._waits if not wait.fulfilled(first_cycle, feedback, self.open_requests)]
        if self._waits:
            return False
        if self.phase is Phase.WAIT_BEFORE:
            self._start_motion()
        else:
            self._end_block()
        return True

    def motion_ended(self) -> None:
        """The motion of the block, or the ramp of an aborted program, is through: the axes stand."""
        if self.phase is Phase.RAMP_DOWN:
            self._motion.abandon()
            self._end_program()
            self.stop_spindles(keep=self._keep)
            return
        self._motion.finish()
        outputs = self._functions.of_block(self._block, after_motion=True) if self._block else Outputs()
        self._queue(outputs)
        self._waits = self._waits_after + outputs.waits_after
        self.phase = Phase.WAIT_AFTER

    def _begin_block(self) -> None:
        if self.blocks_done >= len(self.blocks):
            self._end_program()
            return
        self._block = block = self.blocks[self.blocks_done]
        self.source = block.source
        outputs = self._functions.of_block(block, after_motion=False)
        self._queue(outputs)
        self._waits, self._waits_after = outputs.waits_before, outputs.waits_after
        self.phase = Phase.WAIT_BEFORE

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
        self._waits, self._waits_after = [], []
        self.open_requests.clear()
        self.phase = Phase.IDLE

    def _queue(self, outputs: Outputs) -> None:
        """Functions go out with the next block; the path waits for them if their synchronisation type says so."""
        self._outputs.commands += outputs.commands
        self._outputs.requests += outputs.requests
        self._unsent += outputs.waits_before + outputs.waits_after
        self.open_requests |= {request.id for request in outputs.requests if request.acknowledge_needed}
