"""/joint_states: where all axes and spindles of a machine are, in SI units, for robot_state_publisher and RViz."""

from __future__ import annotations

import math
from collections.abc import Mapping

from builtin_interfaces.msg import Time
from rclpy.node import Node
from sensor_msgs.msg import JointState

from cnc_ptp.nodes.topics import JOINT_STATES, PLC_INPUT
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.parameters.view.control_view import torque_per_acceleration
from cnc_ptp.parameters.view.gears import active_gear
from cnc_ptp.protocol.blocks import AxisBlock, CycleBlock, SpindleBlock

MILLIMETRE = 1e-3
DEGREE = math.pi / 180.0
REVOLUTION_PER_MINUTE = math.pi / 30.0


class JointStates:
    """One message for the machine: position (m, rad), velocity (m/s, rad/s), effort (N, Nm; NaN of spindles)."""

    def __init__(self, node: Node, machine: MachineParameters) -> None:
        self._to_si = si_factors(machine)
        self._to_load = {name: load_per_motor_torque(machine, name) for name in machine.axes}
        self._names = [*machine.axes, *machine.spindles]
        self._publisher = node.create_publisher(JointState, JOINT_STATES, PLC_INPUT)

    @property
    def wanted(self) -> bool:
        """Somebody subscribes."""
        return bool(self._publisher.get_subscription_count())

    def publish(self, blocks: Mapping[str, CycleBlock], stamp: Time) -> None:
        """The last cycle of `blocks`; units that are lost are missing. `stamp`: of that cycle."""
        message = JointState()
        message.header.stamp = stamp
        for name in self._names:
            row = self._row(name, blocks.get(name))
            if row is not None:
                message.name.append(name)
                for values, value in zip((message.position, message.velocity, message.effort), row, strict=True):
                    values.append(value)
        self._publisher.publish(message)

    def _row(self, name: str, block: CycleBlock | None) -> tuple[float, float, float] | None:
        if isinstance(block, AxisBlock):
            to_si, torque = self._to_si[name], block.actual_torque[-1]
            return block.actual_position[-1] * to_si, block.actual_velocity[-1] * to_si, torque * self._to_load[name]
        if isinstance(block, SpindleBlock):
            position, speed = block.actual_position_deg[-1], block.actual_speed_rpm[-1]
            return position * DEGREE, speed * REVOLUTION_PER_MINUTE, math.nan
        return None


def si_factors(machine: MachineParameters) -> dict[str, float]:
    """Axis -> metres per mm, or radians per degree."""
    return {name: DEGREE if axis.rotary else MILLIMETRE for name, axis in machine.axes.items()}


def load_per_motor_torque(machine: MachineParameters, axis: str) -> float:
    """N (Nm) at the axis for 1 Nm at the motor shaft, the gear without losses; 1 where torques are the axis' own.

    Power is the same on both sides, F · v = M · ω, and ω / v is the torque that accelerates 1 kg·m².
    """
    parameters = machine.raw(axis)
    motor = torque_per_acceleration(parameters, active_gear(parameters), load=1.0)
    return motor / (DEGREE if machine.axes[axis].rotary else MILLIMETRE)
