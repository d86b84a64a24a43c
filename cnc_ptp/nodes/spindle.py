"""`spindle MACHINE.yaml NAME`: the node of one spindle."""

from __future__ import annotations

from typing import Any

from cnc_ptp import action
from cnc_ptp.machine.blocks import AxisStateCode, Block, Command, SpindleBlock
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import arguments
from cnc_ptp.nodes.jobs import JobServer
from cnc_ptp.nodes.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters

AT_WORK = (AxisStateCode.DISCRETE_MOTION, AxisStateCode.HOMING, AxisStateCode.STOPPING)


class SpindleNode(UnitNode):
    """UnitNode of a spindle.

    Actions: /<spindle>/position (OrientSpindle), /<spindle>/homing (Home); cancel = stop.
    """

    def __init__(self, machine: MachineParameters, name: str, **options: Any) -> None:
        arguments.require_unit(machine, name, ["spindle"])
        super().__init__(machine, build_unit(machine, name), **options)
        stop = Command(name, "stop", {})
        self._jobs = (
            JobServer(
                self,
                action.OrientSpindle,
                f"/{name}/position",
                start=lambda goal: [Command(name, "orient", self.arguments("orient", goal))],
                halt=stop,
                feedback=positioning_feedback,
                result=positioning_result,
            ),
            JobServer(
                self,
                action.Home,
                f"/{name}/homing",
                start=lambda goal: [Command(name, "home", {})],
                halt=stop,
                feedback=homing_feedback,
                result=homing_result,
            ),
        )

    def run_ended(self) -> None:
        for job in self._jobs:
            job.end()

    def after_block(self, block: Block) -> None:
        for job in self._jobs:
            job.after_block(block)


def positioning_feedback(block: Block, feedback: Any) -> None:
    if isinstance(block, SpindleBlock):
        feedback.remaining_deg = block.distance_to_go_deg[-1]
        feedback.actual_speed_rpm = block.actual_speed_rpm[-1]


def positioning_result(block: Block, result: Any) -> bool | None:
    """In full when the spindle has come into position; not when something else has ended the motion."""
    if not isinstance(block, SpindleBlock) or block.state[-1] in AT_WORK:
        return None
    result.position_deg, result.error_id = block.actual_position_deg[-1], block.error_id[-1]
    done = bool(block.in_position[-1])
    result.message = "" if done else f"the positioning has ended at {result.position_deg} deg"
    return done


def homing_feedback(block: Block, feedback: Any) -> None:
    if isinstance(block, SpindleBlock):
        feedback.state = block.state[-1]


def homing_result(block: Block, result: Any) -> bool | None:
    if not isinstance(block, SpindleBlock) or block.state[-1] in AT_WORK:
        return None
    result.error_id = block.error_id[-1]
    done = bool(block.referenced[-1]) and not result.error_id
    result.message = "" if done else "the homing has ended without a reference"
    return done


main = arguments.unit_main(SpindleNode, "spindle")

if __name__ == "__main__":
    main()
