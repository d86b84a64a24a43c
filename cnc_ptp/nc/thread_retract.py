"""#THREAD RETRACT X-5: how the tool leaves a thread of this program that is broken off."""

from __future__ import annotations

from typing import Final

from cnc_ptp.nc import thread_faults
from cnc_ptp.nc.coordinates.commands import axis_index, bounded
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.flow.command_words import Words
from cnc_ptp.nc.flow.lines import Flow, Line, Statement
from cnc_ptp.nc.program import NcBlock

COMMAND: Final = "#THREAD RETRACT"
SYNTAX: Final = "#THREAD RETRACT X-5, in the direction of the axis, or #THREAD RETRACT OFF or DEFAULT"
AXES: Final = ("X", "Y", "Z")


class ThreadRetract(Statement):
    """One axis with its way, or none: the path stops in the thread. `default`: as the machine file has it."""

    def __init__(self, column: int, axis: str, way: Node | None, place: int, *, default: bool = False) -> None:
        super().__init__(column, independent=True)
        self.axis, self.way, self.place, self.default = axis, way, place, default

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        values = execution.values
        state, channel = values.state, values.channel
        retract = None if self.default else (0, 0.0)
        if self.way is not None:
            index = axis_index(channel, line, self.axis, self.place)
            retract = (index, bounded(self.way, values) * state.coordinates.unit)
        state.thread = state.thread._replace(retract=retract)
        return None


def read_thread_retract(line: Line, text: str, end: int, column: int) -> None:
    """#THREAD RETRACT."""
    words = Words(line, text, end, COMMAND, SYNTAX)
    for switch in ("OFF", "DEFAULT"):
        if words.takes(switch):
            words.require_end()
            line.statement = ThreadRetract(column, "", None, column, default=switch == "DEFAULT")
            return
    axes = words.axes()
    if not axes:
        raise words.missing("an axis with its way")
    for axis, _, place in axes[1:] or [each for each in axes if each[0] not in AXES]:
        raise thread_faults.RETRACT_AXIS.at(line.source, place, word=axis, syntax=SYNTAX)
    axis, way, place = axes[0]
    line.statement = ThreadRetract(column, axis, way, place)
    line.synchronises = words.reader.synchronises
