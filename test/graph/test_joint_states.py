"""/joint_states in SI units: torque of the motor and force at the axis do the same work."""

import math
from types import SimpleNamespace

import pytest
import yaml
from builtin_interfaces.msg import Time
from graph_support import MILL, PTP

from cnc_ptp.machine.wiring import build_units
from cnc_ptp.nodes.bridge.joint_states import JointStates, load_per_motor_torque
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import CycleTick


class Publisher:
    """Stands for a publisher, and for the node that makes it."""

    def __init__(self, readers=1):
        self.readers, self.messages = readers, []

    def create_publisher(self, *_what):
        return SimpleNamespace(get_subscription_count=lambda: self.readers, publish=self.messages.append)


def joint_state(path, change):
    machine = read_machine(path)
    publisher = Publisher()
    blocks = {}
    for name, unit in build_units(machine).items():
        blocks[name] = unit.step(CycleTick(0, 10), {})
    change(blocks)
    JointStates(publisher, machine).publish(blocks, Time(sec=1, nanosec=2))
    (message,) = publisher.messages
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1, 2)
    return {
        name: (position, velocity, effort)
        for name, position, velocity, effort in zip(
            message.name, message.position, message.velocity, message.effort, strict=True
        )
    }


def test_the_last_cycle_of_all_axes_and_spindles():
    def change(blocks):
        x, spindle = blocks["x"], blocks["s"]
        x.actual_position[-1], x.actual_velocity[-1], x.actual_torque[-1] = 250.0, -40.0, 3.0
        spindle.actual_position_deg[-1], spindle.actual_speed_rpm[-1] = 540.0, -1200.0
        del blocks["y"]  # its node is lost

    states = joint_state(MILL, change)
    assert list(states) == ["x", "z", "s"]
    assert states["x"][:2] == pytest.approx((0.25, -0.04))
    assert states["x"][2] == pytest.approx(3.0 * load_per_motor_torque(read_machine(MILL), "x"))
    assert states["s"][:2] == pytest.approx((3.0 * math.pi, -40.0 * math.pi))
    assert math.isnan(states["s"][2])


def test_rotary_axes_in_radians():
    def change(blocks):
        blocks["c"].actual_position[-1], blocks["c"].actual_velocity[-1] = 90.0, -180.0

    assert joint_state(PTP, change)["c"][:2] == pytest.approx((math.pi / 2.0, -math.pi))


@pytest.mark.parametrize(
    ("axis", "feed_constant", "gear", "factor"),
    [
        ("x", 0, 1, 1.0),  # torques are forces of the axis itself
        ("c", 0, 1, 1.0),
        ("x", 100_000, 2, 2.0 * math.pi * 2.0 / 0.01),  # 10 mm a turn of the screw, two turns of the motor each
        ("c", 3_600_000, 3, 3.0),  # three turns of the motor for one of the table
    ],
)
def test_work_of_motor_and_axis_is_equal(tmp_path, axis, feed_constant, gear, factor):
    """Torque · angle of the motor is force · distance (torque · angle) of the axis."""
    document = yaml.load(PTP.read_text(), yaml.BaseLoader)
    parameters = document[f"/{axis}"]["ros__parameters"]
    if feed_constant:
        parameters["antr"] = {"feed_const_num": feed_constant, "feed_const_denom": 1}
        parameters["getriebe"]["0"] |= {"gear_fact_num": gear, "gear_fact_denom": 1}
    path = tmp_path / "machine.yaml"
    path.write_text(yaml.dump(document).replace("- y\n", '- "y"\n').replace("'", '"').replace('"', ""))
    assert load_per_motor_torque(read_machine(path), axis) == pytest.approx(factor)
