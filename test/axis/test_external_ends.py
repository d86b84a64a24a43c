"""Ends of external setpoints, and the target window afterwards."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from long_support import long
from machine_support import MILL, MachineBench, UnitBench, axis_bench, axis_parameters, machine
from superposition_support import (
    EXTERNAL,
    IN_TARGET,
    J,
    SetpointRow,
    column,
    external_axis,
    feed,
    generator,
    has_bit,
    moving_axis,
    settle,
)

from cnc_ptp.protocol.axis_states import AxisStateCode as S


def constant(velocity: float, *, first_cycle: int, count: int, start: float = 0.0) -> list[SetpointRow]:
    """Setpoints at a constant velocity from `start` on."""
    direction = 1 if velocity > 0.0 else -1
    return [[first_cycle + k, start + velocity * k * 0.001, velocity, 0.0, direction] for k in range(count)]


# ends


@pytest.mark.parametrize(
    ("command", "arguments", "state"),
    [
        ("stop", {}, S.STANDSTILL),
        ("halt", {}, S.STANDSTILL),
        ("power", {"enabled": False}, S.DISABLED),
        ("upstream_lost", {"source": "plc"}, S.ERROR_STOP),
        ("emergency_stop", {"deceleration": 20_000.0, "jerk": 400_000.0}, S.STANDSTILL),
        ("external_disable", {}, S.STANDSTILL),
    ],
)
@pytest.mark.parametrize("basic", [False, True], ids=["alone", "on a PTP motion"])
@pytest.mark.parametrize("after", [0, 250, 700, *long([100, 500, 900])])
def test_ends_of_external_setpoints(command: str, arguments: dict[str, Any], state: S, basic: bool, after: int) -> None:
    """In each phase of the generator the axis comes to rest and never gets faster again.

    The generator's acceleration ends in one step; setpoints that still come are ignored.
    """
    bench = moving_axis() if basic else axis_bench()
    begin = bench.cycle
    bench.accepted("external_enable", mode="relative")
    rows = generator(600.0, first_cycle=begin)
    feed(bench, rows, after)
    bench.accepted(command, **arguments)
    bench.give("external_setpoints", setpoints=rows[after + 1 : after + 11])  # in the same block
    bench.run(10)
    assert "P-WARN-23031" in bench.accepted("external_setpoints", setpoints=rows[after + 11 :])
    settle(bench)
    end = begin + after
    assert bench.state == state
    assert not has_bit(bench, EXTERNAL)[end:].any()
    v, a = column(bench, "set_velocity"), column(bench, "set_acceleration")
    highest, jerk = (25_000.0, 500_000.0) if command == "emergency_stop" else (10_000.0, 2.0 * J)
    assert np.abs(np.diff(v[end:])).max() <= highest * 0.001 * (1 + 1e-9)
    assert np.abs(np.diff(a[end + 1 :])).max() <= jerk * 0.001 * (1 + 1e-9)
    assert v[end:].max() <= v[end] * (1 + 1e-9)
    assert v[-1] == 0.0 and len(bench.events) == (command == "upstream_lost")


def test_reset_after_a_fault_leaves_them_disabled() -> None:
    bench = external_axis()
    feed(bench, constant(500.0, first_cycle=10, count=100), 50)
    bench.accepted("upstream_lost", source="plc")
    settle(bench)
    bench.accepted("reset")
    bench.run(10)
    assert bench.state == S.STANDSTILL and not has_bit(bench, EXTERNAL)[-1]
    here = bench.column("set_position")[-1]
    assert "P-WARN-23031" in bench.accepted("external_setpoints", setpoints=constant(1.0, first_cycle=9999, count=5))
    bench.accepted("external_enable", mode="absolute")
    bench.run(10)
    assert bench.column("set_position")[-1] == here


def test_power_off_at_rest_disables_them() -> None:
    bench = external_axis()
    bench.accepted("power", enabled=False)
    bench.run(5)
    assert bench.state == S.DISABLED and not has_bit(bench, EXTERNAL)[10:].any()
    bench.accepted("power", enabled=True)
    bench.run(5)
    assert bench.state == S.STANDSTILL


def test_the_path_of_a_channel_does_not_take_an_axis_with_external_setpoints() -> None:
    bench = MachineBench("%P\nG01 X100 F6000\nM30", start=False, end_when_idle=False).run(0.01)
    assert bench.give("x", "external_enable", mode="absolute").accepted
    bench.run(0.01)
    bench.give("channel", "start")
    bench.run(0.1)
    assert bench.errors() == [
        "P-ERR-22005 channel channel: axis x moved or was switched off while the program was started; "
        "the path stops on its ramp and the program is aborted"
    ]
    assert bench.last("x").state[-1] == S.CONTINUOUS_MOTION and bench.position("x") == 0.0


def test_a_path_begins_where_external_setpoints_ended() -> None:
    bench = MachineBench("%P\nG01 X100 F6000\nM30", start=False, end_when_idle=False, machine=machine(MILL)).run(0.01)
    bench.give("x", "external_enable", mode="absolute")
    begin = 10
    rows = [[begin + k, 0.01 * k, 10.0, 0.0, 1] for k in range(100)] + [[begin + 100, 1.0, 0.0, 0.0, 0]]
    bench.give("x", "external_setpoints", setpoints=rows)
    bench.run(0.3)
    bench.give("x", "external_disable")
    bench.run(0.1)
    bench.give("channel", "start")
    bench.run(3.0)
    assert bench.errors() == [] and bench.position("x") == 100.0


# target window

SLOW: dict[str, Any] = {"kv": 1.0, "following_error_limit": 1e9, "position_window": 0.01, "target_time": 0.05}
"""A position loop of 1 1/s: the axis needs seconds to come into its window."""


def warning(distance: str) -> str:
    return (
        f"P-ERR-70082 axis x: 0.05 s after its end the motion is {distance} mm away from its target, more than the "
        "position window 0.01 mm (P-AXIS-00236)"
    )


def lag(bench: UnitBench, cycle: int, target: float) -> str:
    return f"{abs(bench.column('actual_position')[cycle] - target):g}"


def test_the_window_is_watched_after_a_ptp_motion() -> None:
    bench = moving_axis(target=100.0, cycles=3000, **SLOW)
    arrived = bench.column("state").index(S.STANDSTILL)
    told = arrived + 50
    assert bench.event_texts() == [warning(lag(bench, told, 100.0))]
    assert bench.events[0].cycle == told and bench.events[0].severity == 1
    assert not has_bit(bench, IN_TARGET)[arrived:told].any()
    bench.run(12_000)
    inside = np.abs(column(bench, "actual_position") - 100.0) <= 0.01
    assert (has_bit(bench, IN_TARGET)[arrived:] == inside[arrived:]).all() and inside[-1]
    assert len(bench.events) == 1


def test_the_window_of_an_external_target() -> None:
    """The generator ends 2 mm before the target it has announced."""
    bench = axis_bench(position_window=0.01, target_time=0.05)
    bench.accepted("external_enable", mode="absolute", target=602.0)
    bench.run(500)
    feed(bench, generator(600.0, first_cycle=510), 2000)
    assert bench.event_texts() == [warning("2")]
    assert not has_bit(bench, IN_TARGET).any()
    bench.accepted("external_enable", mode="absolute", target=600.0)
    bench.run(100)
    assert has_bit(bench, IN_TARGET)[-100:].all() and len(bench.events) == 1


@pytest.mark.parametrize(("target", "reached"), [(600.0, True), (None, True), (600.2, False)])
@pytest.mark.parametrize("mode", ["absolute", "relative"])
@pytest.mark.parametrize("superposed", [False, True])
def test_target_bit(target: float | None, reached: bool, mode: str, superposed: bool) -> None:
    bench = moving_axis(target=1000.0, cycles=500) if superposed else axis_bench()
    if superposed and mode == "absolute":
        return
    arguments = {} if target is None else {"target": target}
    bench.accepted("external_enable", mode=mode, **arguments)
    feed(bench, generator(600.0, first_cycle=bench.cycle + 10), 3000)
    assert has_bit(bench, IN_TARGET)[-1] == reached
    assert len(bench.events) == (not reached)


def test_a_relative_target_counts_from_where_the_setpoints_count() -> None:
    """Enabled again in the middle of the way: 600 is still 600 from the first enable."""
    bench = axis_bench(start_position=100.0)
    bench.accepted("external_enable", mode="relative", target=50.0)
    rows = generator(600.0, first_cycle=10)
    feed(bench, rows, 400)
    bench.accepted("external_enable", mode="relative", target=600.0)
    feed(bench, rows, 3000)
    assert has_bit(bench, IN_TARGET)[-1] and bench.events == []


def test_a_stop_forgets_the_external_target() -> None:
    bench = axis_bench()
    bench.accepted("external_enable", mode="absolute", target=600.0)
    feed(bench, generator(600.0, first_cycle=10), 400)
    bench.accepted("stop")
    bench.run(4000)
    assert bench.events == [] and has_bit(bench, IN_TARGET)[-1]


def test_a_pause_before_the_motion_is_not_late() -> None:
    bench = axis_bench()
    bench.accepted("external_enable", mode="absolute", target=600.0)
    bench.run(5000)
    feed(bench, generator(600.0, first_cycle=5000), 4000)
    assert bench.events == [] and has_bit(bench, IN_TARGET)[-1]


def test_override_0_is_not_the_end_of_a_motion() -> None:
    bench = moving_axis(cycles=500, **(SLOW | {"kv": 50.0, "target_time": 0.01}))
    bench.accepted("set_override", percent=0.0)
    bench.run(4000)
    assert bench.events == []
    assert axis_parameters().position_window > 0.0
