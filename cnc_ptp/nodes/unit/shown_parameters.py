"""The parameters of a unit as ROS shows them: written by ROS as commands, followed when anybody else writes them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node

from cnc_ptp.nodes.unit.parameters import refusal, write_command, written_parameter
from cnc_ptp.parameters import ParameterSet
from cnc_ptp.protocol.blocks import Command, CommandRecord


class ShownParameters:
    """ROS has the values that the unit has; the unit alone decides about them."""

    def __init__(
        self,
        node: Node,
        unit: str,
        own: ParameterSet,
        *,
        give: Callable[[Command], CommandRecord],
        look: Callable[[], None],
    ) -> None:
        """`own`: parameters of `unit`. `give`: carries a command out. `look`: computes what can be computed then."""
        self._node = node
        self._unit = unit
        self._own = own
        self._give = give
        self._look = look
        self._takes_over = False
        """ROS takes over what the unit has already, or is about to have."""
        node.add_on_set_parameters_callback(self._write)

    def _write(self, wanted: Sequence[Any]) -> SetParametersResult:
        """ROS has found them in order: the unit takes them by a command, which is recorded, or refuses.

        Several at once are refused: the second one could fail when the first one has been taken already.
        """
        if self._takes_over:
            return SetParametersResult(successful=True)
        if len(wanted) != 1:
            return refusal(f"{self._unit}: parameters are set one by one; nothing was changed")
        self._takes_over = True
        record = self._give(write_command(self._unit, wanted[0]))
        self._takes_over = False
        if not record.accepted:
            return refusal(f"P-ERR-{record.error_id} {record.message}")
        self._look()
        return SetParametersResult(successful=True, reason=record.message)

    def follow(self, record: CommandRecord) -> None:
        """A parameter that somebody else has written is what ROS shows from now on."""
        shown = None if self._takes_over else written_parameter(self._own, record)
        if shown is not None and self._node.has_parameter(shown.name):
            self._takes_over = True
            Node.set_parameters_atomically(self._node, [shown])  # that of a unit refuses what cannot change
            self._takes_over = False
