"""`axis MACHINE.yaml NAME`: the node of one axis with position controller and drive."""

from __future__ import annotations

from typing import Any

from cnc_ptp import action
from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import node_command_line
from cnc_ptp.nodes.unit.jobs import JobServer
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.axis_states import AxisStateCode, StatusBit
from cnc_ptp.protocol.blocks import AxisBlock, Command, CycleBlock

MOVING = (AxisStateCode.DISCRETE_MOTION, AxisStateCode.STOPPING)
NOT_DONE = StatusBit.HAS_BEEN_STOPPED | StatusBit.ERROR


class AxisNode(UnitNode):
    """UnitNode of an axis.

    Action: /<axis>/move (MoveAxis); cancel = halt.
    """

    def __init__(self, machine: MachineParameters, name: str, **options: Any) -> None:
        node_command_line.require_unit(machine, name, ["axis"])
        super().__init__(machine, build_unit(machine, name), **options)

    def setup(self) -> None:
        """As UnitNode, and the action."""
        super().setup()
        name = self.unit.name
        self._move_job = JobServer(
            self,
            action.MoveAxis,
            f"{name}/move",
            start=self._start_move,
            halt=Command(name, "halt", {}),
            feedback=self._move_feedback,
            result=self._move_result,
        )

    def _start_move(self, goal: Any) -> list[Command]:
        return [Command(self.unit.name, "move_absolute", self.arguments("move_absolute", goal))]

    def _move_feedback(self, block: CycleBlock, feedback: Any) -> None:
        if isinstance(block, AxisBlock) and isinstance(self.unit, AxisUnit):
            feedback.set_position, feedback.state = block.set_position[-1], block.state[-1]
            feedback.remaining_distance = self.unit.remaining_distance(block.first_cycle + block.count)

    def _move_result(self, block: CycleBlock, result: Any) -> bool | None:
        """The move has ended when the axis has neither job nor motion; in full unless it was stopped or has an error.

        Its target may change on the fly: by a new target, a compensation, external setpoints.
        """
        if not isinstance(block, AxisBlock) or block.state[-1] in MOVING or block.set_velocity[-1] != 0.0:
            return None
        result.position, result.error_id = block.set_position[-1], block.error_id[-1]
        done = not block.status_bits[-1] & NOT_DONE
        result.message = "" if done else f"the axis was stopped at {result.position}"
        return done

    def run_ended(self) -> None:
        self._move_job.end()

    def after_block(self, block: CycleBlock) -> None:
        if isinstance(block, AxisBlock):
            self._move_job.after_block(block)


main = node_command_line.unit_main(AxisNode, "axis")

if __name__ == "__main__":
    main()
