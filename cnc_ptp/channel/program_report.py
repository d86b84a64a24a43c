"""Summary of the channels' programs at the end of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from cnc_ptp.protocol.channel_states import IN_PROGRAM, ChannelStateCode
from cnc_ptp.protocol.notes import Note

CUT_OFF = 26121
"""Warning: a program was not finished at the end of the run's duration."""


@dataclass
class ProgramReport:
    """The program of one channel: its cycles so far, and where it is."""

    cycles: int = 0
    done: bool = True
    line: int = 0
    state: int = ChannelStateCode.IDLE

    def add(self, block: Any) -> None:
        """`block`: the next ChannelBlock, or its message."""
        self.cycles += sum(state in IN_PROGRAM for state in block.state)
        self.done, self.line, self.state = block.done, block.line[-1], block.state[-1]


def time_lines(programs: Mapping[str, ProgramReport], cycle_time: float) -> Iterator[str]:
    """Program time, of each if there are several channels; `cycle_time` in s."""
    for name, program in programs.items():
        channel = f" {name}:" if len(programs) > 1 else ""
        yield f"program time{channel} {program.cycles * cycle_time:.3f} s"


def cut_off_notes(programs: Mapping[str, ProgramReport], duration: float | None) -> Iterator[Note]:
    """A warning for each program that was not finished after the `duration` (s)."""
    for name, program in programs.items():
        if duration is not None and not program.done:
            where = f"in line {program.line}, state {ChannelStateCode(program.state).name}"
            yield Note(CUT_OFF, f"channel {name}: --duration {duration:g} s has cut off the program {where}")
