"""`axis MACHINE.yaml NAME`: the node of one axis with position controller and drive."""

from __future__ import annotations

import math
from typing import Any

from sensor_msgs.msg import JointState

from cnc_ptp import action
from cnc_ptp.machine.axis_unit import AxisUnit
from cnc_ptp.machine.blocks import AxisBlock, AxisStateCode, Block, Command, StatusBit
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import arguments
from cnc_ptp.nodes.jobs import JobServer
from cnc_ptp.nodes.topics import JOINT_STATES, PLC_INPUT
from cnc_ptp.nodes.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters

JOINT_STATE_HZ = 50.0
MOVING = (AxisStateCode.DISCRETE_MOTION, AxisStateCode.STOPPING)
NOT_DONE = StatusBit.HAS_BEEN_STOPPED | StatusBit.ERROR


class AxisNode(UnitNode):
    """UnitNode of an axis.

    Publishes besides: /joint_states (sensor_msgs/JointState, m or rad, about 50 Hz).
    Action: /<axis>/move (MoveAxis); cancel = halt.
    """

    def __init__(self, machine: MachineParameters, name: str, **options: Any) -> None:
        arguments.require_unit(machine, name, ["axis"])
        super().__init__(machine, build_unit(machine, name), **options)
        self._following_error = 0.0
        self._to_si = math.pi / 180.0 if machine.axes[name].rotary else 1e-3
        block_time = machine.block_cycles * machine.cycle_time_us * 1e-6
        self._joint_blocks = max(1, round(1.0 / (JOINT_STATE_HZ * block_time)))
        self._joint_publisher = self.create_publisher(JointState, JOINT_STATES, PLC_INPUT)
        self._move_job = JobServer(
            self,
            action.MoveAxis,
            f"/{name}/move",
            start=self._start_move,
            halt=Command(name, "halt", {}),
            feedback=self._move_feedback,
            result=self._move_result,
        )

    def _start_move(self, goal: Any) -> list[Command]:
        return [Command(self.unit.name, "move_absolute", self.arguments("move_absolute", goal))]

    def _move_feedback(self, block: Block, feedback: Any) -> None:
        if isinstance(block, AxisBlock) and isinstance(self.unit, AxisUnit):
            feedback.set_position, feedback.state = block.set_position[-1], block.state[-1]
            feedback.remaining_distance = self.unit.remaining_distance(block.first_cycle + block.count)

    def _move_result(self, block: Block, result: Any) -> bool | None:
        """The move has ended when the axis has neither job nor motion; in full unless it was stopped or has an error.

        Where it ends may be changed on the way: by a new target, a compensation, external setpoints.
        """
        if not isinstance(block, AxisBlock) or block.state[-1] in MOVING or block.set_velocity[-1] != 0.0:
            return None
        result.position, result.error_id = block.set_position[-1], block.error_id[-1]
        done = not block.status_bits[-1] & NOT_DONE
        result.message = "" if done else f"the axis was stopped at {result.position}"
        return done

    def run_ended(self) -> None:
        self._move_job.end()

    def after_block(self, block: Block) -> None:
        if not isinstance(block, AxisBlock):
            return
        self._move_job.after_block(block)
        self._following_error = max(self._following_error, max(block.following_error), -min(block.following_error))
        if block.first_cycle // block.count % self._joint_blocks:
            return
        message = JointState(name=[self.unit.name])
        message.header.stamp = self.stamp(block.first_cycle + block.count - 1)
        message.position = [block.actual_position[-1] * self._to_si]
        message.velocity = [block.actual_velocity[-1] * self._to_si]
        self._joint_publisher.publish(message)

    def extra_diagnostics(self) -> dict[str, object]:
        return {"following_error_max": self._following_error}


main = arguments.unit_main(AxisNode, "axis")

if __name__ == "__main__":
    main()
