"""A channel hears of it when somebody else commands what it has set turning."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping

from cnc_ptp.machine.blocks import Block, SpindleBlock
from cnc_ptp.machine.spindle_reports import Condition, carries_out, must_wait, what_it_does, what_it_was_told
from cnc_ptp.machine.waits import Wait


class SpindleWatch:
    """The last command of a channel to each of its spindles."""

    def __init__(self) -> None:
        self._told: dict[str, Wait] = {}

    def note(self, told: Iterable[Wait], first_cycle: int) -> None:
        """What goes out with the block that begins at `first_cycle`."""
        for wait in told:
            wait.sent_cycle = first_cycle
            self._told[wait.spindle] = wait

    def forget(self) -> None:
        """What earlier programs have commanded is of no concern any more."""
        self._told.clear()

    def lost(self, cycle: int, spindles: Mapping[str, Block], waited_for: Container[str]) -> Iterator[str]:
        """A text for each spindle that does not turn any more as it was told, once; not for those of `waited_for`."""
        for node, told in list(self._told.items()):
            block = spindles.get(node)
            if not isinstance(block, SpindleBlock) or node in waited_for or not told.sent_before(cycle):
                continue
            if (
                told.condition is Condition.SPEED
                and not carries_out(block, told.condition, told.value)
                and not must_wait(block)
            ):
                del self._told[node]
                yield f"{what_it_was_told(node, told.condition, told.value)}, {what_it_does(block)}"
