"""The gate of a unit: holds ticks and blocks back until all that one cycle block needs is there."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from cnc_ptp.machine.wiring import Inputs
from cnc_ptp.protocol.blocks import CycleBlock, CycleTick
from cnc_ptp.protocol.unit import CLOCK


class BlockGate:
    """Collects ticks and blocks in any order of arrival; gives out one computation after the other, in order of cycles.

    `begin` opens a tick when the blocks are there that commands come in; `complete` closes it when the block of the
    master is there too, which may have been named by one of these commands. A source whose needed block was skipped (a
    later one came) or that its watchdog gave up is dropped permanently.
    """

    def __init__(self, inputs: Inputs) -> None:
        self._upstream = list(inputs.upstream)
        self._feedback = list(inputs.feedback)
        self._blocks: dict[str, dict[int, CycleBlock]] = {name: {} for name in [*inputs.upstream, *inputs.feedback]}
        self._ticks: deque[CycleTick] = deque()
        self._next_cycle = 0
        self._closed = False
        self._last_tick_came = False
        self._open: tuple[CycleTick, dict[str, CycleBlock]] | None = None
        self._master: str | None = None
        self._master_blocks: dict[str, dict[int, CycleBlock]] = {}
        self.duplicates = 0
        """Ticks and blocks that came a second time and were not used again."""

    def add_tick(self, tick: CycleTick) -> bool:
        """Takes a tick; False when ticks before it are missing: then it is not used.

        A tick without cycles ends the run once the ticks before it are computed.
        """
        expected = self._ticks[-1].first_cycle + self._ticks[-1].count if self._ticks else self._next_cycle
        if tick.first_cycle > expected:
            return False
        if tick.count == 0:
            self._last_tick_came = True
        elif tick.first_cycle < expected:
            self.duplicates += 1
        else:
            self._ticks.append(tick)
        return True

    def add_block(self, source: str, block: CycleBlock) -> None:
        """Takes a block of an upstream or feedback unit; blocks of dropped sources are ignored."""
        waiting = self._blocks.get(source)
        if waiting is None:
            return
        oldest = self._next_cycle - (block.count if source in self._feedback else 0)
        if block.first_cycle in waiting or block.first_cycle < oldest:
            self.duplicates += 1
            return
        waiting[block.first_cycle] = block

    def follow(self, master: str | None) -> None:
        """The axis whose blocks are needed from the open tick on; None: no axis."""
        self._master = master

    def add_master_block(self, master: str, block: CycleBlock) -> None:
        """Takes a block of an axis that is, was or will be the master; one of an earlier tick is not used."""
        if block.first_cycle >= self.needed_of_master:
            self._master_blocks.setdefault(master, {})[block.first_cycle] = block

    @property
    def needed_of_master(self) -> int:
        """First cycle of the oldest block of a master that is still of use."""
        return self._next_cycle if self._open is None else self._open[0].first_cycle

    def _of_master(self) -> dict[int, CycleBlock]:
        return {} if self._master is None else self._master_blocks.get(self._master, {})

    def missing(self) -> list[str]:
        """Sources that the next tick waits for; [clock] when no tick is there; empty when it can be computed."""
        if self._open is not None:
            waits = self._master is not None and self.needed_of_master not in self._of_master()
            return [self._master] if waits and self._master is not None else []
        if not self._ticks:
            return [CLOCK]
        tick = self._ticks[0]
        before = tick.first_cycle - tick.count
        missing = [name for name in self._upstream if tick.first_cycle not in self._blocks[name]]
        if before >= 0:
            missing += [name for name in self._feedback if before not in self._blocks[name]]
        return missing

    def waits_for_others(self, sources: Iterable[str]) -> bool:
        """All of `sources` have come for the next tick, and something else is missing.

        One that was dropped comes no more: the tick stands for it.
        """
        if self._closed or self._open is not None:
            return False
        for source in sources:
            if source in self._blocks:
                if not self._blocks[source]:
                    return False
            elif not self._ticks:
                return False
        return bool(self.missing())

    def skipped(self) -> list[str]:
        """Of the missing sources, those that have sent a later block already: the needed one is lost."""
        if self._open is not None:
            return self.missing() if self._of_master() else []
        if not self._ticks:
            return []
        tick = self._ticks[0]
        needed = dict.fromkeys(self._upstream, tick.first_cycle)
        needed |= dict.fromkeys(self._feedback, tick.first_cycle - tick.count)
        return [name for name in self.missing() if any(cycle > needed[name] for cycle in self._blocks[name])]

    @property
    def opened(self) -> bool:
        """True between `begin` and `complete` of a tick."""
        return self._open is not None

    def begin(self) -> tuple[CycleTick, dict[str, CycleBlock]] | None:
        """Opens the next tick: its inputs in the order of the wiring; None while something is missing."""
        if self.closed or self._open is not None or self.missing():
            return None
        tick = self._ticks.popleft()
        inputs = {name: self._blocks[name].pop(tick.first_cycle) for name in self._upstream}
        before = tick.first_cycle - tick.count
        inputs |= {name: self._blocks[name].pop(before) for name in self._feedback if before >= 0}
        self._next_cycle = tick.first_cycle + tick.count
        self._open = tick, inputs
        return self._open

    def complete(self) -> tuple[CycleTick, dict[str, CycleBlock]] | None:
        """Closes the open tick, with the block of the master among the inputs; None while that is missing."""
        if self._open is None or self.missing():
            return None
        tick, inputs = self._open
        self._open = None
        if self._master is not None:
            inputs = {**inputs, self._master: self._of_master()[tick.first_cycle]}
        for blocks in self._master_blocks.values():
            for cycle in [cycle for cycle in blocks if cycle <= tick.first_cycle]:
                del blocks[cycle]
        return tick, inputs

    def drop(self, source: str) -> None:
        """Continues without `source` from now on."""
        self._upstream = [name for name in self._upstream if name != source]
        self._feedback = [name for name in self._feedback if name != source]
        self._blocks.pop(source, None)
        if source == self._master:
            self.follow(None)

    def close(self) -> None:
        """The run has ended: no more block is computed."""
        self._closed = True

    @property
    def closed(self) -> bool:
        """True when the run has ended and all that belongs to it is computed."""
        return self._closed or (self._last_tick_came and not self._ticks and self._open is None)

    @property
    def next_cycle(self) -> int:
        """First cycle of the next block to be computed."""
        return self._next_cycle

    @property
    def sources(self) -> tuple[str, ...]:
        return tuple(self._blocks)
