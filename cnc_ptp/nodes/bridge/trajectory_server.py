"""/trajectory/follow_joint_trajectory: trajectories of several axes in SI units, as an action and as a topic."""

from __future__ import annotations

import math
from typing import Any

from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from cnc_ptp import action, msg
from cnc_ptp.axis.faults import GOAL_MISSED, PATH_DEVIATION
from cnc_ptp.nodes.bridge.joint_states import si_factors
from cnc_ptp.nodes.topics import EVENT, EVENTS, PLC_INPUT, TRAJECTORY_ACTION, TRAJECTORY_TOPIC
from cnc_ptp.nodes.unit.jobs import JobServer
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.parameters.view.authority import OF_TOPICS
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.trajectories import FOLLOW, FollowedTrajectory
from cnc_ptp.protocol.blocks import AxisBlock, Command, CommandRecord, CycleBlock
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.unit import PLC, UPSTREAM_LOST

PATIENCE_BLOCKS = 50
"""Blocks that a result waits for the text of an error, which comes on another topic."""
Result = action.FollowTrajectory.Result
TOLERANCES = {
    PATH_DEVIATION: Result.PATH_TOLERANCE_VIOLATED,
    GOAL_MISSED: Result.GOAL_TOLERANCE_VIOLATED,
}


class TrajectoryServer(JobServer):
    """One trajectory at a time: while one is active another goal is rejected, on the topic refused with an event.

    Joints are axes; m and rad become mm and deg here. The PLC unit gives it to the axes and watches them.
    """

    def __init__(self, node: UnitNode, plc: PlcUnit, machine: MachineParameters) -> None:
        super().__init__(
            node,
            action.FollowTrajectory,
            TRAJECTORY_ACTION,
            start=self._commands,
            halt=None,
            feedback=self._fill_feedback,
            result=self._fill_result,
        )
        self._plc = plc
        self._to_si = si_factors(machine)
        self._cycle_time = machine.cycle_time_us * 1e-6
        self._followed: FollowedTrajectory | None = None
        self._joints: list[str] = []
        self._texts: dict[tuple[str, int], str] = {}
        """Texts of events since its start, by axis and number."""
        self._waited = 0
        node.create_subscription(msg.Event, EVENT, self._on_event, EVENTS)
        node.create_subscription(JointTrajectory, TRAJECTORY_TOPIC, self._on_topic, PLC_INPUT)

    # begin

    def _on_topic(self, trajectory: JointTrajectory) -> None:
        """Without tolerances; a refusal is recorded, and an event of the PLC."""
        self._node.command(self._command(trajectory, {}), OF_TOPICS)

    def _commands(self, goal: Any) -> list[Command]:
        self._joints, self._waited, self._followed = list(goal.trajectory.joint_names), 0, None
        self._texts.clear()
        arguments: dict[str, Any] = {"goal_time": seconds(goal.goal_time_tolerance)}
        for name in ("path_tolerance", "goal_tolerance"):
            given = list(getattr(goal, name))
            arguments[name] = self._in_axis_units(given) if len(given) == len(self._joints) else given
        return [self._command(goal.trajectory, arguments)]

    def _command(self, trajectory: JointTrajectory, arguments: dict[str, Any]) -> Command:
        joints = list(trajectory.joint_names)
        points = [self._row(joints, point) for point in trajectory.points]
        return Command(PLC, FOLLOW, {"axes": joints, "points": points, **arguments})

    def _row(self, joints: list[str], point: JointTrajectoryPoint) -> list[Any]:
        """As the PLC takes it."""
        quantities = point.positions, point.velocities, point.accelerations
        given = [self._in_axis_units(values, joints) for values in quantities]
        while len(given) > 1 and not given[-1]:
            given.pop()
        return [seconds(point.time_from_start), *given]

    def _in_axis_units(self, values: Any, joints: list[str] | None = None) -> list[float]:
        """mm and deg of each joint; values without a joint stay, and are refused."""
        names = self._joints if joints is None else joints
        factors = [self._to_si.get(name, 1.0) for name in names]
        factors += [1.0] * (len(values) - len(factors))
        return [value / factor for value, factor in zip(values, factors, strict=False)]

    # end

    def refused(self, record: CommandRecord) -> Any:
        """See JobServer."""
        known = len(set(self._joints)) == len(self._joints) > 0 and set(self._joints) <= set(self._to_si)
        code = Result.INVALID_GOAL if known else Result.INVALID_JOINTS
        return Result(error_code=code, error_id=record.error_id, error_string=record.message)

    def halt(self) -> None:
        """Stops all axes that have not ended on their ramps."""
        followed = self._followed or self._plc.trajectory
        for name, member in [] if followed is None else followed.members.items():
            if member.ended is None:
                self._plc.input(Command(name, "stop", {}))

    def cut_off(self, reason: str) -> Any:
        """See JobServer."""
        return Result(error_code=Result.ABORTED, error_string=reason)

    def _on_event(self, event: msg.Event) -> None:
        if self._goal is not None and event.error_id:
            self._texts.setdefault((event.source, event.error_id), event.text)

    def _fill_result(self, block: CycleBlock, result: Any) -> bool | None:
        followed = self._plc.trajectory if self._followed is None else self._followed
        self._followed = followed
        if followed is None or not followed.over:
            return None
        failed = followed.first_failed
        if not failed:
            return True
        member = followed.members[failed]
        result.error_id = UPSTREAM_LOST if followed.lost else member.error_id
        result.error_string = self._reason(failed, followed)
        if not result.error_string and self._waited < PATIENCE_BLOCKS:
            self._waited += 1
            return None
        if member.message:
            result.error_code = Result.INVALID_GOAL
        else:
            result.error_code = TOLERANCES.get(member.error_id, Result.ABORTED)
        result.error_string = result.error_string or f"axis {failed}: error {member.error_id}"
        return False

    def _reason(self, axis: str, followed: FollowedTrajectory) -> str:
        """The text of the axis; empty while that of its error has not come."""
        member = followed.members[axis]
        if followed.lost:
            return f"axis {axis}: its node is lost; the other axes stop on their ramps"
        if member.ended == JobStatus.ABORTED:
            return f"axis {axis}: the trajectory was aborted by a stop or another command; all axes have stopped"
        return member.message or self._texts.get((axis, member.error_id), "")

    # on the way

    def _fill_feedback(self, block: CycleBlock, feedback: Any) -> None:
        """Of the last cycle that the axes have reported."""
        feedback.header = Header(stamp=self._node.stamp(max(0, block.first_cycle - 1)))
        feedback.joint_names = self._joints
        desired, actual = self._state("set"), self._state("actual")
        errors = [
            [wanted - there for wanted, there in zip(*pair, strict=True)] for pair in zip(desired, actual, strict=True)
        ]
        time = (block.first_cycle - self._first_cycle) * self._cycle_time
        for name, (positions, velocities) in (("desired", desired), ("actual", actual), ("error", errors)):
            point = JointTrajectoryPoint(positions=positions, velocities=velocities)
            point.time_from_start.sec, point.time_from_start.nanosec = int(time), int(math.modf(time)[0] * 1e9)
            setattr(feedback, name, point)

    def _state(self, which: str) -> list[list[float]]:
        """Positions and velocities of all joints, set or actual ones; NaN for an axis that reports nothing."""
        return [[self._value(name, f"{which}_{what}") for name in self._joints] for what in ("position", "velocity")]

    def _value(self, axis: str, column: str) -> float:
        block = self._plc.reported.get(axis)
        return getattr(block, column)[-1] * self._to_si[axis] if isinstance(block, AxisBlock) else math.nan


def seconds(duration: Any) -> float:
    """Of a builtin_interfaces/Duration."""
    return float(duration.sec) + float(duration.nanosec) * 1e-9
