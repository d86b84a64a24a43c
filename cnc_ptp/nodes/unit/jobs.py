"""Long jobs as ROS actions: progress while active, cancel = controlled halt, the client's death has no effect."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import GoalEvent, ServerGoalHandle

from cnc_ptp.protocol.blocks import Command, CommandRecord, CycleBlock

if TYPE_CHECKING:
    from cnc_ptp.nodes.unit.unit_node import UnitNode

Goal: TypeAlias = "ServerGoalHandle[Any, Any, Any]"
FEEDBACK_BLOCKS = 10
"""Blocks between two feedback messages."""


class JobServer:
    """An action of a unit node: start commands, then block by block until the unit reports that the job has ended.

    One job at a time: a goal is rejected while another one is open, and ends as aborted with the run.
    """

    def __init__(
        self,
        node: UnitNode,
        action_type: Any,
        name: str,
        *,
        start: Callable[[Any], list[Command]],
        halt: Command | None,
        feedback: Callable[[CycleBlock, Any], None],
        result: Callable[[CycleBlock, Any], bool | None],
    ) -> None:
        """`start(goal)` gives the commands that start the job, `halt` ends it; `feedback(block, message)` fills in
        progress, `result(block, message)` the result: None while active, then whether it was done in full."""
        self._node = node
        self._type = action_type
        self._start = start
        self._halt = halt
        self._feedback = feedback
        self._result = result
        self._goal: Goal | None = None
        self._first_cycle = 0
        self._blocks = 0
        self._server = ActionServer(
            node,
            action_type,
            name,
            lambda goal: action_type.Result(),  # not asked: `_begin` takes every goal
            goal_callback=lambda goal: GoalResponse.ACCEPT if self._goal is None else GoalResponse.REJECT,
            handle_accepted_callback=self._begin,
            cancel_callback=self._cancel,
        )

    def _begin(self, goal: Goal) -> None:
        """Gives the start commands; the result follows from the blocks.

        No coroutine that awaits the end: EventsExecutor would poll it without a pause.
        """
        goal._update_state(GoalEvent.EXECUTE)
        self._goal, self._blocks = goal, 0
        for command in self._start(goal.request):
            record = self._node.command(command)
            if not record.accepted:
                self._finish(self.refused(record))
                return
        self._first_cycle = record.cycle

    def refused(self, record: CommandRecord) -> Any:
        """The result of a goal whose start was refused."""
        return self._type.Result(success=False, error_id=record.error_id, message=record.message)

    def halt(self) -> None:
        """Ends the job."""
        if self._halt is not None:
            self._node.command(self._halt)

    def cut_off(self, reason: str) -> Any:
        """The result of a job that is still active when the run ends."""
        return self._type.Result(message=reason)

    def _finish(self, result: Any) -> None:
        """Answers the goal; the next one may come."""
        goal, self._goal = self._goal, None
        assert goal is not None
        self._server.notify_execute(goal, lambda goal: conclude(goal, result, success=result.success))

    def _cancel(self, goal: Goal) -> CancelResponse:
        if goal is not self._goal:
            return CancelResponse.REJECT
        self.halt()
        return CancelResponse.ACCEPT

    def end(self) -> None:
        """The run has ended: an open job is answered as not finished."""
        if self._goal is not None:
            self._finish(self.cut_off("the run has ended"))

    def after_block(self, block: CycleBlock) -> None:
        """Called by the node with each block that it has computed."""
        if self._goal is None or block.first_cycle < self._first_cycle:
            return
        message = self._type.Result()
        succeeded = self._result(block, message)
        if succeeded is not None:
            message.success = succeeded and not self._goal.is_cancel_requested
            self._finish(message)
            return
        self._blocks += 1
        if self._blocks % FEEDBACK_BLOCKS == 0:
            feedback = self._type.Feedback()
            self._feedback(block, feedback)
            self._goal.publish_feedback(feedback)


def conclude(goal: Goal, result: Any, *, success: bool) -> Any:
    """Brings a goal into its last state."""
    if success:
        goal.succeed()
    elif goal.is_cancel_requested:
        goal.canceled()
    else:
        goal.abort()
    return result
