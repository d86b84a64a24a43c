"""One spindle as its channel knows it: what was commanded, and what the spindle has reported since.

A function counts from the block with which it goes out. It may be refused, overtaken or withdrawn, so only a report
of the spindle ends the channel's responsibility for it. Source: TF5200 spindle 2.4.3 (a reset always stops the
spindles), 2.8 (couplings).

| transition | direction | responsible | master | expectation |
|---|---|---|---|---|
| `turn` (M03, M04) | cw, ccw | from the next block | | |
| `hold` (M05, M19, G74) | none | from the next block | | |
| `hand_over` (M05 of the PLC's own spindle) | none | up to the next block | | |
| `change_gear` | kept, but starts again | from the next block | | |
| `couple`, `release` | | from `release`, if it was coupled | set, none | |
| `expect` | | | | from the next block |
| `withdraw` | | functions not sent yet are dropped | | functions not sent yet are dropped |
| `forget` | none | no longer | | |
| `read` | | until it is at a standstill | none once others have decoupled it | |
"""

from __future__ import annotations

from collections.abc import Iterator

from cnc_ptp.channel.spindle_reports import NOTHING, Condition, Expectation, commands_wait, current_activity, stands
from cnc_ptp.nc.canonical import SpindleFunction
from cnc_ptp.parameters import ChannelSpindle, SpindleParameters
from cnc_ptp.protocol.blocks import CycleBlock, SpindleBlock
from cnc_ptp.protocol.spindle_states import SpindleBit
from cnc_ptp.spindle.tool_limits import ToolLimits

BEFORE_THE_RUN = -1


class CommandedSpindle:
    """One spindle of a channel.

    direction        cw or ccw while it turns for the program, else empty
    starts_anew      a gear change has ended its rotation: the next speed starts it again
    full_override    G167 is active: its override is suppressed
    master           which spindle it follows, from the block with the coupling
    leader           its master in a coupling that has ended with the program
    expectation      what it is to report on the last command that has gone out
    """

    def __init__(
        self, parameters: ChannelSpindle, unit: SpindleParameters | None, *, channel: str, ranks: Iterator[int]
    ) -> None:
        """`unit` is None for a spindle that only the PLC knows; `channel`: its source name.

        `ranks`: numbers that all spindles of the channel draw from.
        """
        self.parameters = parameters
        self.unit = unit
        self.name, self.node = parameters.name, parameters.node
        self._channel = channel
        self._ranks = ranks
        self.block: SpindleBlock | None = None
        """Its last report."""
        self.direction = ""
        self.tool = ToolLimits()
        """Of the last tool that has some for it."""
        self.starts_anew = False
        self.full_override = False
        self.turning_rank = self.coupling_rank = 0
        """The order in which the channel's spindles have started to turn, or to follow their masters."""
        self.master: CommandedSpindle | None = None
        self.leader: CommandedSpindle | None = None
        self.coupled = False
        """It has reported its master."""
        self._link_sent = False
        self._sent_cycle: int | None = None
        """First cycle of the block with the last function for which the channel is responsible."""
        self._responsible_next: bool | None = None
        """The change of that with the next block; None is no change."""
        self.expectation = NOTHING
        self._expected_since: int | None = None
        """First cycle of the block with which the command has gone out; None while nothing is expected."""
        self._expected_next: list[Expectation] = []
        self._turned = False
        """It has turned as commanded; a new speed does not change that."""

    # questions

    @property
    def turns(self) -> bool:
        """It turns for the program."""
        return bool(self.direction)

    @property
    def follows(self) -> bool:
        """A slave: the PLC is notified of its master only (2.8.3)."""
        return self.master is not None

    @property
    def responsible(self) -> bool:
        """The channel has started it and has to stop it with its program."""
        return self._sent_cycle is not None

    @property
    def pending(self) -> bool:
        """A command has not gone out yet, or its outcome is not reported."""
        return self._responsible_next is not None or bool(self._expected_next) or (self.responsible and not self.turns)

    @property
    def unsent(self) -> bool:
        """A function of the program goes out with the next block."""
        return self._responsible_next is not None or bool(self._expected_next)

    @property
    def stops_at_program_end(self) -> bool:
        """The PLC wants it stopped with the program (2.4.3)."""
        return self.block is not None and bool(self.block.status_bits[-1] & SpindleBit.STOP_AT_PROGRAM_END)

    def in_gear(self, stage: int) -> bool:
        """As it reports, before its first report by the parameters."""
        if self.block is not None:
            return self.block.gear[-1] == stage and not self.block.gear_change_active[-1]
        return self.unit is not None and self.unit.gear == stage

    @property
    def reported_to_plc(self) -> bool:
        """The PLC gets every function of the spindle, whatever its synchronisation type says."""
        return self.unit is None or self.unit.plc_controlled

    @property
    def title(self) -> str:
        """The name by which the PLC knows it: its node, or its own name if it has none."""
        return self.node or self.parameters.own_name or self.name

    def acts(self, function: SpindleFunction) -> bool:
        """False for an S word while the spindle is at a standstill: the speed counts for the next M03 or M04."""
        return function.m is not None or (self.turns and function.speed_rpm is not None)

    def answers(self) -> Iterator[int | None]:
        """First cycles of the blocks with commands that the spindle may still refuse; None for the next block."""
        if self._expected_since is not None:
            yield self._expected_since
        yield from [None for _ in self._expected_next]

    # what the program commands

    def turn(self, direction: str) -> None:
        """M03, M04: `direction` is cw or ccw."""
        if not self.turns:
            self.turning_rank = next(self._ranks)
        self.direction = direction
        self._responsible_next = True

    def hold(self) -> None:
        """M05, M19, G74: it no longer turns, and is in motion until it reports a standstill."""
        self.direction = ""
        self._responsible_next = True

    def hand_over(self) -> None:
        """M05 of a spindle that only the PLC knows: nobody else knows when it is at a standstill."""
        self.direction = ""
        self._responsible_next = False

    def change_gear(self) -> None:
        """The rotation has ended then: the words of the block say what comes next."""
        self.starts_anew |= self.turns
        self._responsible_next = True

    def start(self) -> bool:
        """A speed goes out; true if it has to be a start, because a gear change has ended the rotation."""
        anew, self.starts_anew = self.starts_anew, False
        return anew

    def switch_override(self, *, full: bool) -> bool:
        """G167 applies to the commands of its block; true if that is a change."""
        changed, self.full_override = full != self.full_override, full
        return changed

    def expect(self, expectation: Expectation) -> None:
        """A command goes out with the next block, and this is what the spindle is to report of it."""
        self._expected_next.append(expectation)

    def couple(self, master: CommandedSpindle) -> None:
        """The coupling goes out with the next block."""
        if self.master is None:
            self.coupling_rank = next(self._ranks)
        self.master = master

    def release(self) -> None:
        """The coupling ends; whoever has coupled the slave is responsible for its further motion."""
        if self.coupled and self._sent_cycle is None:
            self._sent_cycle = BEFORE_THE_RUN
        self.master, self.coupled, self._link_sent = None, False, False

    # ends

    def withdraw(self) -> None:
        """Functions that have not gone out are dropped."""
        self._responsible_next = None
        self._expected_next = []

    def forget(self) -> None:
        """The channel is no longer responsible, and the spindle does not turn for its program."""
        self.dismiss()
        self.direction, self.starts_anew = "", False

    def dismiss(self) -> None:
        """The spindle was commanded to stop, or others are responsible for it."""
        self._responsible_next = self._sent_cycle = None

    def expect_nothing(self) -> None:
        """What earlier programs have commanded does not matter to this one."""
        self._expected_since, self._turned = None, False

    # from block to block

    def send(self, first_cycle: int) -> None:
        """The commands go out with the block that starts at `first_cycle`."""
        if self._responsible_next is not None:
            self._sent_cycle = first_cycle if self._responsible_next else None
        self._responsible_next = None
        self._link_sent = self.master is not None
        for expectation in self._expected_next:
            self.expectation, self._expected_since = expectation, first_cycle
            self._turned &= expectation.condition is Condition.SPEED
        self._expected_next = []

    def read(self, cycle: int, block: CycleBlock | None) -> str:
        """Reads the report for the cycles before `cycle`; a text when others have ended a coupling of the channel."""
        self.block = block if isinstance(block, SpindleBlock) else None
        if self.block is None:
            return ""
        if self._sent_cycle is not None and cycle > self._sent_cycle and stands(self.block, self._channel):
            self._sent_cycle = None
        return self._read_master(self.block) if self._link_sent else ""

    def _read_master(self, block: SpindleBlock) -> str:
        master = self.master
        assert master is not None
        if block.master == master.node:
            self.coupled = True
        elif self.coupled:
            self.release()
            return f"spindle {self.node} no longer follows {master.node}"
        return ""

    def lost_speed(self, cycle: int, *, watched: bool) -> str:
        """A text, once, when before `cycle` it no longer turned as commanded and the channel has `watched`.

        A command that still waits behind others is not lost; one that was carried out is, in a gear change too.
        """
        block, since = self.block, self._expected_since
        if block is None or since is None or cycle <= since or self.expectation.condition is not Condition.SPEED:
            return ""
        waits = commands_wait(block)
        if self.expectation.carried_out(block):
            self._turned |= block.source == self._channel or not waits
        elif watched and (self._turned or not waits):
            self.expect_nothing()
            return f"{self.expectation.missed()}, {current_activity(block)}"
        return ""
