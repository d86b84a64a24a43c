"""/<unit>/function_block: the function blocks of PLCopen as one action, called by the PLC node block by block."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import GoalEvent

from cnc_ptp import action
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.unit.jobs import FEEDBACK_BLOCKS, Goal, conclude
from cnc_ptp.nodes.unit.requests import NOT_GIVEN, RUN_OVER
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.parameters.view.authority import OF_SERVICES
from cnc_ptp.plc.called_blocks import BlockCall, CalledBlocks
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.plcopen.catalogue import BLOCK_TYPES, UNCHANGED
from cnc_ptp.protocol.authority import STOP_BLOCKS
from cnc_ptp.protocol.blocks import AxisBlock, Command, CycleBlock, SpindleBlock
from cnc_ptp.protocol.commands import BAD_ARGUMENT

NAME = "function_block"
POINTS = ("master_points", "slave_points")
REACHED = ("in_velocity", "in_gear", "in_sync")
BLANK = action.FunctionBlock.Goal()
INPUTS = [name for name in BLANK.get_fields_and_field_types() if name not in (NAME, *POINTS)]


@dataclass(slots=True)
class OpenGoal:
    """A goal, the call that it stands for, and the feedback that it has got."""

    goal: Goal
    unit: str
    call: BlockCall
    told: tuple[bool, ...] = ()
    blocks: int = 0


class FunctionBlockActions:
    """One action server for each axis and spindle; a goal is open until its function block has ended.

    Every goal is accepted, also beside others: they abort each other as function blocks do, and a refusal is a result.
    """

    def __init__(self, node: UnitNode, plc: PlcUnit, kinds: dict[str, str], machine: MachineParameters) -> None:
        self._node = node
        self._plc = plc
        self._kinds = kinds
        self._blocks = CalledBlocks(kinds, machine.sets, plc.is_lost)
        plc.outside.append(self._blocks.cycle)
        self._open: list[OpenGoal] = []
        self._servers = {
            unit: ActionServer(
                node,
                action.FunctionBlock,
                f"{unit}/{NAME}",
                lambda goal: action.FunctionBlock.Result(),  # not asked: `_begin` takes every goal
                handle_accepted_callback=partial(self._begin, unit),
                cancel_callback=self._cancel,
            )
            for unit, kind in kinds.items()
            if kind in BLOCK_TYPES
        }

    def _begin(self, unit: str, goal: Goal) -> None:
        """As JobServer: the end follows from the blocks, without a coroutine."""
        goal._update_state(GoalEvent.EXECUTE)
        name = goal.request.function_block
        where = f"{self._kinds[unit]} {unit}: {name} refused"
        try:
            if self._node.is_over:
                raise CncError(RUN_OVER, "the run has ended", UNCHANGED, where=where)
            closed = None if name in STOP_BLOCKS else self._node.why_closed(Command(unit, name), OF_SERVICES)
            if closed is not None:
                raise closed
            call = self._blocks.start(unit, name, given_inputs(goal.request, where))
        except CncError as error:
            self._finish(unit, goal, failed(error.number, error.message))
            return
        self._open.append(OpenGoal(goal, unit, call))

    def _cancel(self, goal: Goal) -> CancelResponse:
        for each in self._open:
            if each.goal is goal:
                self._blocks.cancel(each.call)
                return CancelResponse.ACCEPT
        return CancelResponse.REJECT

    def after_block(self) -> None:
        """The function blocks have been called: results of those that have ended, feedback of the others."""
        if not self._open:
            return
        ended = [each for each in self._open if each.call.ended]
        self._open = [each for each in self._open if not each.call.ended]
        for each in ended:
            self._finish(each.unit, each.goal, result_of(each.call.block))
        for each in self._open:
            self._tell(each)

    def _tell(self, each: OpenGoal) -> None:
        """When an output has changed, and from time to time."""
        told = outputs(each.call.block)
        if told == each.told and each.blocks % FEEDBACK_BLOCKS:
            each.blocks += 1
            return
        each.told, each.blocks = told, 1
        each.goal.publish_feedback(feedback_of(each.call.block, self._plc.reported.get(each.unit)))

    def end(self) -> None:
        """The run has ended: open goals are answered as not finished."""
        for each in self._open:
            text = f"{self._kinds[each.unit]} {each.unit}: {each.call.name} without an end: the run has ended"
            self._finish(each.unit, each.goal, failed(RUN_OVER, text))
        self._open = []

    def _finish(self, unit: str, goal: Goal, result: Any) -> None:
        self._servers[unit].notify_execute(goal, lambda goal: conclude(goal, result, success=result.done))


def given_inputs(request: Any, where: str) -> dict[str, Any]:
    """The inputs of a goal that are not left out. Raises CncError 22001."""
    given = {name: getattr(request, name) for name in INPUTS if not is_left_out(name, getattr(request, name))}
    masters, slaves = (len(getattr(request, name)) for name in POINTS)
    if masters != slaves:
        reason = f"{masters} master_points and {slaves} slave_points are no pairs"
        raise CncError(BAD_ARGUMENT, reason, UNCHANGED, where=where)
    if masters:
        given["cam_table"] = [*zip(request.master_points, request.slave_points, strict=True)]
    return given


def is_left_out(name: str, value: Any) -> bool:
    """1e300, NaN, no text; a switch that is as in an empty message."""
    if isinstance(value, float):
        return math.isnan(value) or value == NOT_GIVEN
    return bool(value == getattr(BLANK, name))


def outputs(block: Any) -> tuple[bool, ...]:
    """`busy`, `active`, and what an endless motion has reached."""
    return block.busy, block.active, *(bool(getattr(block, name, False)) for name in REACHED)


def feedback_of(block: Any, reported: CycleBlock | None) -> Any:
    busy, active, *reached = outputs(block)
    feedback = action.FunctionBlock.Feedback(busy=busy, active=active, **dict(zip(REACHED, reached, strict=True)))
    if isinstance(reported, AxisBlock):
        feedback.set_position, feedback.set_velocity = reported.set_position[-1], reported.set_velocity[-1]
        feedback.state = reported.state[-1]
    elif isinstance(reported, SpindleBlock):
        feedback.set_position, feedback.set_velocity = reported.actual_position_deg[-1], reported.set_speed_rpm[-1]
        feedback.state = reported.state[-1]
    return feedback


def result_of(block: Any) -> Any:
    ends = {"done": block.done, "command_aborted": block.command_aborted, "error": block.error}
    return action.FunctionBlock.Result(error_id=block.error_id, error_text=block.error_text, **ends)


def failed(error_id: int, text: str) -> Any:
    return action.FunctionBlock.Result(error=True, error_id=error_id, error_text=text)
