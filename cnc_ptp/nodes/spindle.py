"""`spindle MACHINE.yaml NAME`: the node of one spindle."""

from __future__ import annotations

from functools import partial
from typing import Any

from cnc_ptp import action
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import node_command_line
from cnc_ptp.nodes.unit.jobs import JobServer
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import Command, CycleBlock, SpindleBlock
from cnc_ptp.spindle.spindle_unit import SpindleUnit


class SpindleNode(UnitNode):
    """UnitNode of a spindle.

    Actions: /<spindle>/position (OrientSpindle), /<spindle>/homing (Home); cancel = stop.
    """

    def __init__(self, machine: MachineParameters, name: str, **options: Any) -> None:
        node_command_line.require_unit(machine, name, ["spindle"])
        super().__init__(machine, build_unit(machine, name), **options)
        self._numbers: dict[str, int] = {}

    def setup(self) -> None:
        """As UnitNode, and the actions."""
        super().setup()
        name = self.unit.name
        stop = Command(name, "stop", {})
        self._jobs = (
            JobServer(
                self,
                action.OrientSpindle,
                f"{name}/position",
                start=lambda goal: self._begin("orient", self.arguments("orient", goal)),
                halt=stop,
                feedback=positioning_feedback,
                result=partial(self._result, "orient"),
            ),
            JobServer(
                self,
                action.Home,
                f"{name}/homing",
                start=lambda goal: self._begin("home", {}),
                halt=stop,
                feedback=homing_feedback,
                result=partial(self._result, "home"),
            ),
        )

    @property
    def spindle(self) -> SpindleUnit:
        assert isinstance(self.unit, SpindleUnit)
        return self.unit

    def _begin(self, command: str, arguments: dict[str, Any]) -> list[Command]:
        self._numbers[command] = self.spindle.next_number
        return [Command(self.spindle.name, command, arguments)]

    def _result(self, command: str, block: CycleBlock, result: Any) -> bool | None:
        """In full when the job is finished; not when another job has replaced it, or it was refused."""
        number = self._numbers[command]
        done = self.spindle.outcome(number)
        if done is None or not isinstance(block, SpindleBlock):
            return None
        refusal = self.spindle.refusal(number)
        result.error_id = refusal.number if refusal else block.error_id[-1]
        if command == "orient":
            result.position_deg = block.actual_position_deg[-1]
        if not done:
            result.message = refusal.message if refusal else ENDED[command](block)
        return done

    def run_ended(self) -> None:
        for job in self._jobs:
            job.end()

    def after_block(self, block: CycleBlock) -> None:
        for job in self._jobs:
            job.after_block(block)


def positioning_feedback(block: CycleBlock, feedback: Any) -> None:
    if isinstance(block, SpindleBlock):
        feedback.remaining_deg = block.distance_to_go_deg[-1]
        feedback.actual_speed_rpm = block.actual_speed_rpm[-1]


def homing_feedback(block: CycleBlock, feedback: Any) -> None:
    if isinstance(block, SpindleBlock):
        feedback.state = block.state[-1]


def positioning_ended(block: SpindleBlock) -> str:
    return f"the positioning has ended at {block.actual_position_deg[-1]} deg"


def homing_ended(block: SpindleBlock) -> str:
    if block.referenced[-1]:
        return "the homing was aborted, the previous reference point remains valid"
    return "the homing has ended without a reference"


ENDED = {"orient": positioning_ended, "home": homing_ended}
"""The message about a job that something else has ended."""

main = node_command_line.unit_main(SpindleNode, "spindle")

if __name__ == "__main__":
    main()
