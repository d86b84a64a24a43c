"""Trajectories of several axes: they begin in the same cycle, and one that fails stops the others on their ramps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cnc_ptp.axis.faults import BAD_TRAJECTORY
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import AxisBlock, Command, CycleBlock
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.unit import PLC

FOLLOW, BEGIN = "follow_trajectory", "begin_trajectory"
"""The command to the PLC, and that of the PLC to each axis."""
QUANTITIES = ("positions", "velocities", "accelerations")


@dataclass
class Member:
    """One axis of a trajectory, and what it has told of its job."""

    command: Command
    job: int = 0
    ended: JobStatus | None = None
    error_id: int = 0
    message: str = ""
    """Why the axis has refused it."""
    cycle: int = 0
    """In which it has ended."""
    stopped: bool = False
    """The PLC has stopped it, because another one has failed."""

    def report(self, block: AxisBlock) -> None:
        """Takes the answer and the end of the job from a block."""
        for answer in block.answers:
            if self.command.id and answer.id == self.command.id:
                self.job, self.error_id, self.message = answer.job, answer.error_id, answer.message
                self.ended = JobStatus.FAILED if answer.error_id else None
                self.cycle = block.first_cycle
        for event in block.job_events:
            if self.job and event.job == self.job and event.status != JobStatus.ACTIVE:
                self.ended, self.error_id, self.cycle = JobStatus(event.status), event.error_id, event.cycle


@dataclass
class FollowedTrajectory:
    """A trajectory on its way, or at its end."""

    members: dict[str, Member]
    sent: bool = False
    lost: str = ""
    """An axis that no longer reports anything."""

    @property
    def over(self) -> bool:
        """All axes are at rest."""
        return bool(self.lost) or all(member.ended is not None for member in self.members.values())

    @property
    def first_failed(self) -> str:
        """The axis that has not done it in full, and was not stopped for another one; empty if there is none."""
        failed = [
            (member.cycle, name)
            for name, member in self.members.items()
            if member.ended not in (None, JobStatus.DONE) and not member.stopped
        ]
        return self.lost or (min(failed)[1] if failed else "")

    def report(self, inputs: Mapping[str, CycleBlock]) -> Iterator[Command]:
        """Takes the blocks of the axes; gives the stops that follow from them."""
        for name, member in self.members.items():
            block = inputs.get(name)
            if isinstance(block, AxisBlock):
                member.report(block)
            elif member.command.id:
                self.lost = self.lost or name
        if self.first_failed:
            for name, member in self.members.items():
                if member.ended is None and not member.stopped:
                    member.stopped = True
                    yield Command(name, "stop", {})


class Trajectories:
    """Gives the commands of a trajectory to its axes, and watches them until all are at rest."""

    def __init__(self, axes: Sequence[str]) -> None:
        """`axes` of the machine."""
        self._axes = axes
        self._active: list[FollowedTrajectory] = []

    def begin(
        self,
        axes: Sequence[Any],
        points: Sequence[Any],
        path_tolerance: Sequence[Any],
        goal_tolerance: Sequence[Any],
        goal_time: float,
    ) -> FollowedTrajectory:
        """The trajectory, whose commands are to go out with one block. Raises 23064; the axes check all else."""
        self._check_axes(axes)
        columns = [column(axes, points, index) for index in range(len(axes))]
        tolerances = [
            tolerances_of(name, axes, given)
            for name, given in (("path_tolerance", path_tolerance), ("goal_tolerance", goal_tolerance))
        ]
        members = {}
        for index, axis in enumerate(axes):
            path, goal = tolerances[0][index], tolerances[1][index]
            values = {"path_tolerance": path, "goal_tolerance": goal, "goal_time": goal_time}
            members[axis] = Member(Command(axis, BEGIN, {"points": columns[index], **values, "delay": 0.0}))
        trajectory = FollowedTrajectory(members)
        self._active.append(trajectory)
        return trajectory

    def _check_axes(self, axes: Sequence[Any]) -> None:
        if not axes:
            raise refusal("axes is empty; known are: " + ", ".join(self._axes))
        for axis in axes:
            if axis not in self._axes:
                raise refusal(f"there is no axis {axis!r}; known are: {', '.join(self._axes)}")
            if list(axes).count(axis) > 1:
                raise refusal(f"axis {axis} appears twice in axes")
            if any(axis in each.members for each in self._active):
                raise refusal(f"axis {axis} follows another trajectory; stop it first")

    def place(self, block_time: float) -> None:
        """The commands go out with the block that begins: several axes wait for one block (s), so that none has moved
        if another one refuses."""
        for trajectory in self._active:
            if not trajectory.sent and len(trajectory.members) > 1:
                for member in trajectory.members.values():
                    member.command.arguments["delay"] = block_time
            trajectory.sent = True

    def report(self, inputs: Mapping[str, CycleBlock]) -> list[Command]:
        """Takes the blocks of the axes; the stops that follow from them."""
        stops = [stop for trajectory in self._active for stop in trajectory.report(inputs)]
        self._active = [trajectory for trajectory in self._active if not trajectory.over]
        return stops


def column(axes: Sequence[str], points: Sequence[Any], index: int) -> list[list[Any]]:
    """The points of one axis: time, position, velocity, acceleration. Raises 23064 for points of another form."""
    rows = []
    for number, row in enumerate(points, 1):
        if not isinstance(row, (list, tuple)) or not 2 <= len(row) <= 1 + len(QUANTITIES):
            names = f"time, {', '.join(QUANTITIES)} (the last two may be left out)"
            raise refusal(f"point {number} = {row!r} is not a list of {names}")
        for name, values in zip(QUANTITIES, row[1:], strict=False):
            if not isinstance(values, (list, tuple)) or len(values) != len(axes):
                raise refusal(f"{name} of point {number} = {values!r} has not one value of each of {', '.join(axes)}")
        rows.append([row[0], *[values[index] for values in row[1:]]])
    if not rows:
        raise refusal("points is empty")
    return rows


def tolerances_of(name: str, axes: Sequence[str], given: Sequence[Any]) -> list[float]:
    """One of each axis, 0 where there is none. Raises 23064."""
    if not given:
        return [0.0] * len(axes)
    if len(given) != len(axes):
        raise refusal(f"{name} has {len(given)} values for {len(axes)} axes ({', '.join(axes)})")
    for axis, value in zip(axes, given, strict=True):
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 <= value < float("inf"):
            raise refusal(f"{name} = {value!r} of {axis} is not a number from 0 on")
    return [float(value) for value in given]


def refusal(reason: str) -> CncError:
    return CncError(BAD_TRAJECTORY, reason, "nothing was changed", where=f"plc {PLC}: {FOLLOW} refused")
