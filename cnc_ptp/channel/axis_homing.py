"""G74 of a channel: its axes are off the path and home themselves, group after group.

The commands go out when the axes have reported that the path has let them go. An axis that has
begun reports the state Homing at once, so that one without it has refused; one that ends without a reference point was
stopped.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.axis_states import AxisStateCode, StatusBit, state_name
from cnc_ptp.protocol.blocks import AxisBlock, Command, CycleBlock

HOMING_FAILED = 22035
FULL = 100.0


class AxisHoming:
    """The homing of the axes of one block.

    held   override 0 or a feed hold of the channel
    """

    def __init__(self, nodes: Mapping[str, str], absolute: Collection[str]) -> None:
        """`nodes` of the channel's axes by name; `absolute`: names of those that G74 leaves out (P-AXIS-00299)."""
        self._nodes, self._absolute = nodes, absolute
        self._groups: list[list[str]] = []
        self._began: dict[str, bool] = {}
        """The axes that home, by node; True when they have reported that they home."""
        self._on_path = False
        self._percent = FULL

    @property
    def held(self) -> bool:
        return self._percent == 0.0

    def begin(self, groups: Sequence[Sequence[str]]) -> None:
        """Axes by name, those of one group at once."""
        named = [[self._nodes[name] for name in group if name not in self._absolute] for group in groups]
        self._groups = [group for group in named if group]
        self._began = {}
        self._on_path = True

    def done(self) -> bool:
        return not (self._groups or self._began or self._on_path)

    def go_on(self, feedback: Mapping[str, CycleBlock]) -> list[Command]:
        """Reads the axes' blocks; returns the commands for the next group. Raises CncError 22035."""
        if self._on_path and any(on_path(feedback.get(node)) for group in self._groups for node in group):
            return []
        self._on_path = False
        for node in list(self._began):
            self._read(node, feedback.get(node))
        if self._began or not self._groups:
            return []
        group = self._groups.pop(0)
        self._began = dict.fromkeys(group, False)
        return [Command(node, "home", {}) for node in group] + ([] if self._percent == FULL else self._overrides())

    def _read(self, node: str, block: CycleBlock | None) -> None:
        if not isinstance(block, AxisBlock):
            return
        state = AxisStateCode(block.state[-1])
        if not self._began[node]:
            if AxisStateCode.HOMING not in block.state:
                reason = f"axis {node} has refused to home, it is in {state_name(state)}"
                raise CncError(HOMING_FAILED, reason, axis=node)
            self._began[node] = True
        if state == AxisStateCode.HOMING:
            return
        if state != AxisStateCode.STANDSTILL or block.status_bits[-1] & StatusBit.NOT_REFERENCED:
            reason = f"the homing of axis {node} was aborted, it is in {state_name(state)}"
            raise CncError(HOMING_FAILED, reason, axis=node)
        del self._began[node]

    def set_override(self, percent: float) -> list[Command]:
        """The override of the channel, 0 is a feed hold; also for the axes that home."""
        if percent == self._percent:
            return []
        self._percent = percent
        return self._overrides()

    def _overrides(self) -> list[Command]:
        return [Command(node, "set_homing_override", {"percent": self._percent}) for node in self._began]

    def stop(self, feedback: Mapping[str, CycleBlock]) -> list[Command]:
        """The program was aborted: the axes that home stop, except those in error, which have stopped already."""
        began, self._began, self._groups = self._began, {}, []
        return [Command(node, "stop", {}) for node in began if not in_error(feedback.get(node))]


def on_path(block: CycleBlock | None) -> bool:
    """True until an axis has reported that the path has let it go; a slave never does, it refuses to home."""
    return isinstance(block, AxisBlock) and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION and not block.master


def in_error(block: CycleBlock | None) -> bool:
    return isinstance(block, AxisBlock) and block.state[-1] == AxisStateCode.ERROR_STOP
