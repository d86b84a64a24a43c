"""Arguments, dynamics and soft limits of the commands of an axis."""

from __future__ import annotations

import math
from typing import Any

import pytest
from axis_states_support import DYNAMICS
from error_support import Refused, refused
from machine_support import CYCLE_TIME, assert_axis_smooth, axis_bench

from cnc_ptp.protocol.axis_states import AxisStateCode as S

# ---------------------------------------------------------------- arguments


TWO_STAGE = ("velocity", "target", "activation_position")
BAD_NUMBERS: list[Any] = [math.nan, math.inf, -math.inf, 10**400, "5", True, None, [1.0]]
NUMBERS = [
    ("move_absolute", "target", {}),
    ("move_relative", "distance", {}),
    ("move_modulo", "position", {}),
    ("set_override", "percent", {}),
    ("new_target", "target", {}),
    *[("new_velocity_and_target", name, {other: 1.0 for other in TWO_STAGE if other != name}) for name in TWO_STAGE],
    *[("move_absolute", name, {"target": 1.0}) for name in DYNAMICS],
]


@pytest.mark.parametrize("value", BAD_NUMBERS)
@pytest.mark.parametrize(("command", "name", "others"), NUMBERS)
def test_bad_numbers(command: str, name: str, others: dict[str, float], value: Any) -> None:
    bench = axis_bench()
    assert bench.refusal(command, **others, **{name: value}) == refused(22001, argument=name)
    bench.run(10)
    assert bench.state == S.STANDSTILL and bench.column("status_bits")[-1] == 0


@pytest.mark.parametrize("name", DYNAMICS)
@pytest.mark.parametrize("value", [0.0, -1.0, 0, -0.0])
def test_dynamics_must_be_above_0(name: str, value: float) -> None:
    assert axis_bench().refusal("move_absolute", target=1.0, **{name: value}) == refused(
        23003, argument=name, value=value
    )


@pytest.mark.parametrize("command", ["move_absolute", "move_relative", "move_modulo"])
@pytest.mark.parametrize("name", ["acceleration", "deceleration", "velocity", "jerk"])
@pytest.mark.parametrize("value", [1e-9, 1e-6, 1e12, 1e300])
def test_absurd_dynamics_end_in_a_refusal_or_in_a_motion_without_steps(command: str, name: str, value: float) -> None:
    """Never in an exception of the unit, and never beyond the limits of the axis."""
    bench = axis_bench(modulo=True, modulo_high=360.0)
    first = {"move_absolute": "target", "move_relative": "distance", "move_modulo": "position"}[command]
    bench.give(command, **{first: 90.0, **DYNAMICS, name: value})
    bench.run(300)
    bench.give("set_override", percent=0.0001)
    bench.run(300)
    bench.give("new_velocity_and_target", velocity=1e-9, target=90.5, activation_position=1.0)
    bench.run(300)
    bench.give("stop")
    bench.give("new_target", target=-90.0)
    bench.run(300)
    assert_axis_smooth(bench, acceleration=DYNAMICS["acceleration"], jerk=DYNAMICS["acceleration"] / CYCLE_TIME)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("override", [0.0, 50.0])
@pytest.mark.parametrize("name", ["acceleration", "deceleration", "velocity"])
def test_dynamics_that_no_table_can_be_made_for_leave_no_job(name: str, kind: int, override: float) -> None:
    bench = axis_bench(override_type=kind)
    bench.accepted("set_override", percent=override)
    assert bench.refusal("move_absolute", target=1.0, **{name: 1e-300}) == refused(
        23003, argument=name, value=1e-300, limit=1e-09
    )
    bench.run(10)
    assert bench.state == S.STANDSTILL and bench.column("status_bits")[-1] == 0
    assert set(bench.column("set_position")) == {0.0}


@pytest.mark.parametrize(
    ("command", "arguments", "wanted"),
    [
        ("move_absolute", {}, refused(22001, argument="target")),
        (
            "move_absolute",
            {"target": 1.0, "speed": 5.0},
            refused(22001, argument="speed"),
        ),
        ("move_modulo", {}, refused(22001, argument="position")),
        ("new_target", {}, refused(22001, argument="target")),
        (
            "emergency_stop",
            {"deceleration": 1e4, "now": True},
            refused(22001, argument="now"),
        ),
        (
            "new_velocity_and_target",
            {"velocity": 1.0, "target": 1.0},
            refused(22001, argument="activation_position"),
        ),
        ("halt", {"now": True}, refused(22001, argument="now")),
        ("stop", {"now": True}, refused(22001, argument="now")),
        ("power", {"enabled": 1}, refused(22001, argument="enabled")),
        (
            "power",
            {"enabled": "on"},
            refused(22001, argument="enabled"),
        ),
        (
            "jump",
            {},
            refused(22002, command="jump"),
        ),
    ],
)
def test_what_an_axis_does_not_understand(command: str, arguments: dict[str, Any], wanted: Refused) -> None:
    assert axis_bench().refusal(command, **arguments) == wanted


# ---------------------------------------------------------------- velocity and soft limits


def test_velocity_above_the_maximum_and_above_the_reference_velocity() -> None:
    bench = axis_bench(max_velocity=2000.0, reference_velocity=1500.0)
    assert bench.refusal("move_absolute", target=1.0, velocity=2000.5) == refused(23004, velocity=2000.5, limit=2000.0)
    assert bench.refusal("move_relative", distance=1.0, velocity=1500.5) == refused(
        23011, velocity=1500.5, limit=1500.0
    )
    assert bench.accepted("move_absolute", target=1.0, velocity=1500) == ""


def test_rotary_axes_speak_of_degrees() -> None:
    bench = axis_bench(rotary=True, max_velocity=360.0, reference_velocity=360.0)
    assert "velocity 361.0 deg/s is above the maximum 360.0 deg/s" in bench.refused(
        "move_absolute", target=1.0, velocity=361.0
    )


@pytest.mark.parametrize(
    ("command", "argument", "wanted"),
    [
        (
            "move_absolute",
            {"target": 100.001},
            refused(120002, target=100.001, limit=100.0),
        ),
        (
            "move_relative",
            {"distance": 60.5},
            refused(120002, target=100.5, limit=100.0),
        ),
        (
            "move_absolute",
            {"target": -50.1},
            refused(120003, target=-50.1, limit=-50.0),
        ),
        (
            "move_relative",
            {"distance": -91},
            refused(120003, target=-51.0, limit=-50.0),
        ),
    ],
)
def test_soft_limits(command: str, argument: dict[str, float], wanted: Refused) -> None:
    bench = axis_bench(soft_limit_negative=-50.0, soft_limit_positive=100.0, start_position=40.0)
    assert bench.refusal(command, **argument) == wanted
    bench.run(10)
    assert bench.state == S.STANDSTILL


@pytest.mark.parametrize("target", [100.0, -50.0])
def test_the_soft_limits_themselves_can_be_reached(target: float) -> None:
    bench = axis_bench(soft_limit_negative=-50.0, soft_limit_positive=100.0)
    bench.accepted("move_absolute", target=target)
    bench.run(1000)
    assert bench.column("set_position")[-1] == target


@pytest.mark.parametrize("outside", [150.0, -80.0])
def test_from_outside_the_soft_limits_only_inwards(outside: float) -> None:
    bench = axis_bench(soft_limit_negative=-50.0, soft_limit_positive=100.0, start_position=outside)
    bench.refused("move_relative", distance=10.0 if outside > 0.0 else -10.0)
    bench.refused("move_absolute", target=outside * 0.9)
    bench.accepted("move_absolute", target=20.0)
    bench.run(1000)
    assert bench.column("set_position")[-1] == 20.0


@pytest.mark.parametrize("name", ["acceleration", "deceleration"])
def test_an_acceleration_above_that_of_the_axis_is_refused(name: str) -> None:
    bench = axis_bench(max_acceleration=50000.0)
    assert bench.refusal("move_absolute", target=5.0, **{name: 50000.5}) == refused(
        23013, argument=name, value=50000.5, limit=50000.0
    )
