"""A client that gives trajectories to the axes of a graph, and waits for what comes of them."""

import math

from builtin_interfaces.msg import Duration
from client_support import Client
from rclpy.action import ActionClient
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from cnc_ptp import action
from cnc_ptp.nodes.topics import TRAJECTORY_ACTION
from cnc_ptp.protocol.axis_states import AxisStateCode


def duration(seconds):
    return Duration(sec=int(seconds), nanosec=round(math.modf(seconds)[0] * 1e9))


def trajectory(joints, rows):
    """Rows of time, positions and velocities, in SI units."""
    points = [
        JointTrajectoryPoint(time_from_start=duration(time), positions=positions, velocities=velocities)
        for time, positions, velocities in rows
    ]
    return JointTrajectory(joint_names=joints, points=points)


class TrajectoryClient(Client):
    """`follow` sends a goal and returns its handle; `feedback` has what came of the last one."""

    def __init__(self, machine):
        super().__init__(machine)
        self.action = ActionClient(self, action.FollowTrajectory, TRAJECTORY_ACTION)
        self.feedback = []

    def follow(self, joints, rows, **options):
        self.spin_until(self.action.server_is_ready, "the action")
        self.feedback.clear()
        goal = action.FollowTrajectory.Goal(trajectory=trajectory(joints, rows), **options)
        asked = self.action.send_goal_async(goal, feedback_callback=lambda told: self.feedback.append(told.feedback))
        self.spin_until(asked.done, "the answer to the goal")
        return asked.result()

    def result(self, handle):
        told = handle.get_result_async()
        self.spin_until(told.done, "the result")
        return told.result().result

    def at_rest(self, *axes):
        """And the PLC, which learns of the end of a job a block later, knows it."""
        for axis in axes:
            self.shows(axis, "state", AxisStateCode.STANDSTILL)
        self.wait_blocks("plc", 3)
