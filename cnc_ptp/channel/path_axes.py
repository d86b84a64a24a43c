"""The axes of a channel: on its path, off it, or moved by others; and those without feed release.

While the channel has no motion, its axes are where others have put them, and the next program starts there. On the path
a superposition (external setpoints, a flying saw) may move an axis off its setpoint; it is taken over from where it
is when the program has finished.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cnc_ptp.parameters import AxisParameters
from cnc_ptp.path.path_motion import PathMotion
from cnc_ptp.path.shape import AxisStates
from cnc_ptp.protocol.axis_states import AxisStateCode, StatusBit
from cnc_ptp.protocol.blocks import AxisBlock, CycleBlock

NOT_AT_END = "axis {} was moved away from the end of the previous path"


class PathAxes:
    """The path axes of one channel, in its order.

    on_path    the previous block was one of path motion: the axes are where its last setpoint has put them
    beside     axes that are not, until the channel has taken over where they are
    withheld   axes whose feed release the path waits for
    """

    def __init__(self, nodes: Sequence[str], axes: Mapping[str, AxisParameters], motion: PathMotion) -> None:
        """`nodes` of the channel's axes, `axes` of the machine by node name."""
        self.nodes = list(nodes)
        self._motion = motion
        self.states = {
            node: AxisStateCode.STANDSTILL if axes[node].powered_at_start else AxisStateCode.DISABLED for node in nodes
        }
        self.on_path = False
        self.beside: list[str] = []
        self.withheld: list[str] = []
        self._given = motion.states[: len(self.nodes)]
        self._referenced_at_start = {node: axes[node].referenced_at_start for node in nodes}

    def give(self, setpoints: AxisStates, *, on_path: bool) -> None:
        """Keeps the last setpoints of a block, one for each axis."""
        self.on_path, self._given = on_path, setpoints

    def read(self, inputs: Mapping[str, CycleBlock], *, just_started: bool) -> Iterator[str]:
        """Reads the axes' reports for the previous block; gives reasons for a fault of a program just started."""
        read = self._read_on_path if self.on_path else self._read_at_rest
        yield from read(inputs, just_started)

    def _read_on_path(self, inputs: Mapping[str, CycleBlock], just_started: bool) -> Iterator[str]:
        """Finds the axes that are not where the path has put them."""
        setpoints = zip(self.nodes, self._given, strict=True)
        self.beside = [node for node, given in setpoints if is_beside(inputs.get(node), given[0])]
        if self.beside and just_started:
            yield NOT_AT_END.format(self.beside[0])

    def _read_at_rest(self, inputs: Mapping[str, CycleBlock], just_started: bool) -> Iterator[str]:
        """Position and state of axes that the channel did not move; a start that did not know them yet is a fault."""
        self.beside = []
        for index, node in enumerate(self.nodes):
            block = inputs.get(node)
            if not isinstance(block, AxisBlock):
                continue
            state, position = AxisStateCode(block.state[-1]), block.set_position[-1]
            if just_started and (state != AxisStateCode.STANDSTILL or position != self._motion.position[index]):
                yield f"axis {node} moved or was switched off while the program was started"
            self.states[node] = state
            self._motion.place(index, position)

    def unreferenced(self, feedback: Mapping[str, CycleBlock]) -> list[str]:
        """Nodes of the axes whose reference point is not known."""
        at_start = self._referenced_at_start.items()
        return [node for node, referenced in at_start if not is_referenced(feedback.get(node), referenced)]

    def shifted(self, feedback: Mapping[str, CycleBlock]) -> list[str]:
        """Nodes of the axes whose coordinates are not those of the machine (set_position)."""
        return [node for node in self.nodes if is_shifted(feedback.get(node))]

    def read_releases(self, inputs: Mapping[str, CycleBlock], *, can_be_held: bool) -> list[str]:
        """Finds the axes on the path without feed release in their direction; returns those that had it before."""
        before, nodes = self.withheld, self.nodes if can_be_held and self.on_path else ()
        self.withheld = [node for node in nodes if lacks_release(inputs.get(node))]
        return [node for node in self.withheld if node not in before]


def is_beside(block: CycleBlock | None, position: float) -> bool:
    """True for an axis that follows its path, but not at `position`."""
    if not isinstance(block, AxisBlock) or block.state[-1] != AxisStateCode.SYNCHRONIZED_MOTION:
        return False
    return block.set_position[-1] != position


def is_referenced(block: CycleBlock | None, at_start: bool) -> bool:
    """True for an axis whose reference point is known; `at_start` counts until it has reported."""
    return not block.status_bits[-1] & StatusBit.NOT_REFERENCED if isinstance(block, AxisBlock) else at_start


def is_shifted(block: CycleBlock | None) -> bool:
    """True for an axis whose coordinates were moved against those of the machine."""
    return isinstance(block, AxisBlock) and bool(block.status_bits[-1] & StatusBit.COORDINATES_SHIFTED)


def lacks_release(block: CycleBlock | None) -> bool:
    """True for an axis that waits for its feed release."""
    return isinstance(block, AxisBlock) and bool(block.status_bits[-1] & StatusBit.FEED_WITHHELD)
