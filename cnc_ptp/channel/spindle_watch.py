"""A channel hears of it when somebody else commands what it has set turning."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping

from cnc_ptp.channel.spindle_reports import Condition, carries_out, orders_wait, what_it_does, what_it_was_told
from cnc_ptp.channel.waits import Wait
from cnc_ptp.protocol.blocks import Block, SpindleBlock


class SpindleWatch:
    """The last command of a channel to each of its spindles, and whether it has had its turn."""

    def __init__(self, channel: str) -> None:
        """`channel`: name of the channel, as spindles report for whom they are at work."""
        self._channel = channel
        self._told: dict[str, Wait] = {}
        self._turned: set[str] = set()
        """Spindles that have turned as they were told; a new speed for one of them does not change that."""

    def note(self, told: Iterable[Wait], first_cycle: int) -> None:
        """What goes out with the block that begins at `first_cycle`."""
        for wait in told:
            wait.sent_cycle = first_cycle
            self._told[wait.spindle] = wait
            if wait.condition is not Condition.SPEED:
                self._turned.discard(wait.spindle)

    @property
    def told(self) -> list[Wait]:
        """The last command to each spindle that has gone out."""
        return list(self._told.values())

    def forget(self, keep: Container[str] = ()) -> None:
        """What earlier programs have commanded is of no concern any more, except to the spindles in `keep`."""
        self._told = {node: told for node, told in self._told.items() if node in keep}
        self._turned &= set(self._told)

    def read(self, cycle: int, spindles: Mapping[str, Block], waited_for: Container[str], *, runs: bool) -> list[str]:
        """Notes which spindles turn as they were told, also while no program `runs`.

        Gives a text for each that does not any more, once and to a running program only; not for those of `waited_for`.
        A command that still waits behind others is not lost; one that was carried out is, in a gear change too.
        """
        lost = []
        for node, told, block in self._reports(cycle, spindles):
            waits = orders_wait(block)
            if carries_out(block, told.condition, told.value):
                if block.source == self._channel or not waits:
                    self._turned.add(node)
            elif runs and node not in waited_for and (node in self._turned or not waits):
                del self._told[node]
                self._turned.discard(node)
                lost.append(f"{what_it_was_told(node, told.condition, told.value)}, {what_it_does(block)}")
        return lost

    def _reports(self, cycle: int, spindles: Mapping[str, Block]) -> Iterator[tuple[str, Wait, SpindleBlock]]:
        """The spindles that were told a speed, with what they have reported since."""
        for node, told in list(self._told.items()):
            block = spindles.get(node)
            if isinstance(block, SpindleBlock) and told.condition is Condition.SPEED and told.sent_before(cycle):
                yield node, told, block
