"""What a channel watches in each block: its axes and spindles, the PLC's answers, what holds the path or slows it down.

Each finding is the number and the text of an event, without the name of the channel; the channel reacts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from cnc_ptp.channel.feed_per_turn import FeedPerTurn
from cnc_ptp.channel.path_axes import PathAxes
from cnc_ptp.channel.program_sequence import Phase, ProgramSequence
from cnc_ptp.errors import NO_VALUES, Value
from cnc_ptp.parameters import ChannelParameters
from cnc_ptp.path.path_motion import PathMotion
from cnc_ptp.protocol.axis_states import AxisStateCode, state_name
from cnc_ptp.protocol.blocks import AxisBlock, CycleBlock, SpindleBlock

MEMBER_IN_ERROR = 22012
AXIS_NOT_FOLLOWING = 22015
NOT_ACKNOWLEDGED = 22016
SPINDLE_REFUSED = 22018
HELD_BY_OVERRIDE = 22024
INTERPRETER_SLOW = 22036
SPINDLE_STANDS = 22140

ENOUGH = 0.5
"""Fill of the buffer of blocks at which the interpreter has kept up again."""


class Finding(NamedTuple):
    """Number and text of an event, and the numbers of the text by name."""

    number: int
    text: str
    values: Mapping[str, Value] = NO_VALUES


class Supervision:
    """Watches one channel.

    runs_out   the path is slower because the interpreter does not keep up, and a warning was given
    """

    def __init__(
        self,
        parameters: ChannelParameters,
        sequence: ProgramSequence,
        motion: PathMotion,
        axes: PathAxes,
        feed_per_turn: FeedPerTurn,
    ) -> None:
        self._parameters, self._sequence, self._motion, self._axes = parameters, sequence, motion, axes
        self._feed_per_turn = feed_per_turn
        self._held: Sequence[str] = ()
        """What the program waited for because of override 0, in the previous block."""
        self.runs_out = False

    # faults

    def faults(self, inputs: Mapping[str, CycleBlock]) -> list[Finding]:
        """Axes and spindles must be without error, and axes on the path that the previous block gave them."""
        if self._axes.on_path or self._sequence.phase is not Phase.IDLE:
            findings = [self._member_fault(node, block) for node, block in inputs.items()]
        else:
            findings = [self._refusal(node, block) for node, block in inputs.items()]
        return [finding for finding in findings if finding is not None]

    def _member_fault(self, node: str, block: CycleBlock) -> Finding | None:
        if not isinstance(block, (AxisBlock, SpindleBlock)):
            return None
        if block.error_id[-1]:
            if isinstance(block, AxisBlock):
                self._motion.axis_failed(self._axes.nodes.index(node))
            return Finding(MEMBER_IN_ERROR, f"{node} is in error P-ERR-{block.error_id[-1]}")
        if isinstance(block, SpindleBlock):
            return self._refusal(node, block)
        if self._axes.on_path and block.state[-1] != AxisStateCode.SYNCHRONIZED_MOTION:
            state = state_name(AxisStateCode(block.state[-1]))
            return Finding(AXIS_NOT_FOLLOWING, f"{node} does not follow the path, it is in {state}")
        return None

    def _refusal(self, node: str, block: CycleBlock) -> Finding | None:
        """A spindle has refused a command of this channel: it is active for another source, for instance."""
        if not isinstance(block, SpindleBlock):
            return None
        refusal = next((refusal for refusal in block.refused if refusal.source == self._parameters.name), None)
        if refusal is None:
            return None
        return Finding(SPINDLE_REFUSED, f"{node} has refused a command, P-ERR-{refusal.number} {refusal.text}")

    def unanswered(self, cycle: int, limit: int, seconds: float) -> Finding | None:
        """The PLC must acknowledge within P-MACH-00060: `limit` cycles, `seconds`; 0 is without limit."""
        request = self._sequence.handshake.overdue(cycle, limit) if limit else None
        if request is None:
            return None
        numbers = {"M": f"{request.number:02d}", "H": f"{request.number}"}
        function = f"{request.kind}{numbers.get(request.kind, '')}"
        what = f"{function}{f' of spindle {request.spindle}' if request.spindle else ''} in line {request.line}"
        waited = f"request {request.id} ({what}) within {seconds:g} s (P-MACH-00060)"
        return Finding(NOT_ACKNOWLEDGED, f"the PLC has not acknowledged {waited}", {"patience": seconds})

    # warnings

    def waiting(self, cycle: int, override_percent: float, *, feed_hold: bool) -> list[Finding]:
        """What the path waits for, perhaps without end; one warning for each."""
        line = self._sequence.source.line
        held = [f"{what}, which is held by override 0" for what in self._sequence.held_by_override(cycle)]
        if override_percent == 0.0 and not feed_hold and self._stands():
            held.append("a path override above 0")
        found = [
            Finding(HELD_BY_OVERRIDE, f"the program waits in line {line} for {what}")
            for what in dict.fromkeys(held)
            if what not in self._held
        ]
        self._held = held
        if node := self._feed_per_turn.awaited(self._motion):
            found.append(Finding(SPINDLE_STANDS, f"the path waits in line {line} for spindle {node} to turn (G95)"))
        return found

    def _stands(self) -> bool:
        """The override has stopped the path within an element."""
        return self._sequence.phase is Phase.MOTION and self._motion.held and self._motion.velocity == 0.0

    def interpreter(self) -> Finding | None:
        """The path becomes slower because too few blocks are known; another warning only after the buffer was full."""
        sequence = self._sequence
        if sequence.phase in (Phase.IDLE, Phase.RAMP_DOWN):
            self.runs_out = False
            return None
        known = 0.0 if sequence.starts_late else self._motion.runs_out
        if self.runs_out:
            self.runs_out = sequence.starts_late or sequence.stream.fill < ENOUGH
            return None
        if known < 0.0 or not sequence.awaits_blocks:
            return None
        self.runs_out = True
        line, limit = sequence.source.line, f"P-CHAN-90006 gives {self._parameters.blocks_per_cycle} in a cycle"
        if sequence.starts_late:
            text = f"the path stands before line {line}: the next block is still computed, {limit}"
            return Finding(INTERPRETER_SLOW, text)
        text = f"the path is slower in line {line}: blocks for {known:.3g} mm are known, {limit}"
        return Finding(INTERPRETER_SLOW, text, {"known": known})
