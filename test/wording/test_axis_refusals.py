"""The exact text and the values of the refusals of an axis: the one place to change when a text gets better."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from machine_support import AXIS_COMMANDS, MachineBench, UnitBench, axis_bench
from slave_support import SlaveBench
from superposition_support import moving_axis

from cnc_ptp.protocol.blocks import CommandRecord

Ask = Callable[[], CommandRecord]
"""Brings an axis to a state and gives it a command that it must refuse."""
COMPENSATION = {
    "length": 4000.0,
    "difference": 250.0,
    "process_velocity": 2000.0,
    "velocity_increase": 300.0,
    "acceleration": 500.0,
    "deceleration": 1000.0,
}
SOFT = {"soft_limit_negative": -50.0, "soft_limit_positive": 100.0}
POINTS = [[0.0, 0.0], [100.0, 50.0], [200.0, 0.0]]


def stopping() -> UnitBench:
    bench = moving_axis()
    bench.accepted("stop")
    bench.run(10)
    return bench


def braking() -> UnitBench:
    return moving_axis(target=1000.0, cycles=501)


def on_error_ramp() -> UnitBench:
    bench = moving_axis()
    bench.accepted("upstream_lost", source="plc")
    bench.run(10)
    return bench


def compensating() -> UnitBench:
    bench = moving_axis()
    bench.accepted("compensation_start", **COMPENSATION)
    bench.run(10)
    return bench


def adding() -> UnitBench:
    bench = moving_axis()
    bench.accepted("move_superimposed", distance=50.0, velocity_difference=20.0)
    bench.run(10)
    return bench


def buffering() -> UnitBench:
    bench = moving_axis()
    bench.accepted("move_absolute", target=5.0, buffer_mode="buffered")
    return bench


def external(mode: str = "relative") -> UnitBench:
    bench = axis_bench()
    bench.accepted("external_enable", mode=mode)
    bench.run(10)
    return bench


def half_released() -> UnitBench:
    bench = axis_bench()
    bench.accepted("set_feed_release", forward=True, backward=False)
    return bench


def slave(command: str = "couple", **arguments: Any) -> SlaveBench:
    """y is a slave of x."""
    bench = SlaveBench()
    bench.do("y", command, master="x", **({"factor": 1.0} if command == "couple" else {}), **arguments)
    return bench


def moving_slave() -> SlaveBench:
    bench = slave()
    bench.do("x", "move_absolute", target=1000.0)
    bench.run(0.1)
    return bench


def on_path() -> MachineBench:
    return MachineBench("%P\nG01 X100 F6000\nM30", end_when_idle=False).run(0.2)


def of_unit(bench: Callable[[], UnitBench], command: str, **arguments: Any) -> Ask:
    return lambda: bench().give(command, **arguments)


def of_x(command: str, parameters: dict[str, Any] | None = None, **arguments: Any) -> Ask:
    """A standing axis with these parameters."""
    return lambda: axis_bench(**parameters or {}).give(command, **arguments)


def of_y(bench: Callable[[], SlaveBench], command: str, **arguments: Any) -> Ask:
    return lambda: bench().send("y", command, **arguments)


def of_path(command: str, **arguments: Any) -> Ask:
    return lambda: on_path().give("x", command, **arguments)


MOVE = {"target": 1.0}
CASES: list[tuple[int, Ask, str, dict[str, Any]]] = [
    # what every command is asked
    (
        22002,
        of_x("jump"),
        f"axis x: unknown command 'jump'; nothing was changed. Known: {AXIS_COMMANDS}",
        {"command": "jump"},
    ),
    (
        22001,
        of_x("move_absolute", **MOVE, speed=5.0),
        "axis x: move_absolute refused: unknown argument 'speed'; nothing was changed. Known: target, velocity, "
        "acceleration, deceleration, jerk, buffer_mode",
        {"argument": "speed"},
    ),
    (
        22001,
        of_x("stop", now=True),
        "axis x: stop refused: unknown argument 'now'; nothing was changed. Known: none",
        {"argument": "now"},
    ),
    (
        22001,
        of_x("move_absolute"),
        "axis x: move_absolute refused: argument 'target' is missing; nothing was changed",
        {"argument": "target"},
    ),
    (
        22001,
        of_x("move_absolute", target="5"),
        "axis x: move_absolute refused: target = '5' is not a number; nothing was changed",
        {"argument": "target"},
    ),
    (
        22001,
        of_x("power", enabled=1),
        "axis x: power refused: enabled = 1 is not a switch; nothing was changed",
        {"argument": "enabled"},
    ),
    (
        22001,
        of_x("set_override_type", type=1.5),
        "axis x: set_override_type refused: type = 1.5 is not an integer; nothing was changed",
        {"argument": "type"},
    ),
    (
        22001,
        of_x("move_absolute", target=float("nan")),
        "axis x: move_absolute refused: target = nan is not finite; nothing was changed",
        {"argument": "target"},
    ),
    (
        22001,
        of_x("move_absolute", target=10**400),
        "axis x: move_absolute refused: target = an integer that long is not finite; nothing was changed",
        {"argument": "target"},
    ),
    (
        22001,
        of_x("external_enable", mode="both"),
        "axis x: external_enable refused: mode = 'both' is not absolute or relative; nothing was changed",
        {"argument": "mode"},
    ),
    # limits
    (
        23002,
        of_x("move_absolute", {"soft_limit_positive": 1e300}, target=1e13),
        "axis x: move_absolute refused: target 10000000000000.0 mm is not within ±1e+12 mm; nothing was changed",
        {"target": 1e13, "limit": 1e12},
    ),
    (
        23003,
        of_x("move_absolute", **MOVE, jerk=-1.0),
        "axis x: move_absolute refused: jerk = -1.0 must be greater than 0; nothing was changed",
        {"argument": "jerk", "value": -1.0},
    ),
    (
        23003,
        of_x("move_absolute", **MOVE, velocity=1e-300),
        "axis x: move_absolute refused: velocity = 1e-300 must be at least 1e-09; nothing was changed",
        {"argument": "velocity", "value": 1e-300, "limit": 1e-9},
    ),
    (
        23004,
        of_x("move_absolute", {"max_velocity": 2000.0}, **MOVE, velocity=2000.5),
        "axis x: move_absolute refused: velocity 2000.5 mm/s is above the maximum 2000.0 mm/s (P-AXIS-00212); nothing "
        "was changed",
        {"velocity": 2000.5, "limit": 2000.0},
    ),
    (
        23011,
        of_x("move_absolute", {"reference_velocity": 1500.0}, **MOVE, velocity=1500.5),
        "axis x: move_absolute refused: velocity 1500.5 mm/s is above the reference velocity 1500.0 mm/s "
        "(P-MACH-00008); nothing was changed",
        {"velocity": 1500.5, "limit": 1500.0},
    ),
    (
        23013,
        of_x("move_absolute", {"max_acceleration": 50_000.0}, **MOVE, deceleration=50_000.5),
        "axis x: move_absolute refused: deceleration 50000.5 mm/s² is above the maximum 50000.0 mm/s² (P-AXIS-00008); "
        "nothing was changed",
        {"argument": "deceleration", "value": 50_000.5, "limit": 50_000.0},
    ),
    (
        120002,
        of_x("move_absolute", SOFT, target=100.5),
        "axis x: move_absolute refused: target 100.5 mm lies beyond the positive soft limit 100.0 mm (P-AXIS-00178); "
        "nothing was changed",
        {"target": 100.5, "limit": 100.0},
    ),
    (
        120003,
        of_x("move_absolute", SOFT, target=-50.5),
        "axis x: move_absolute refused: target -50.5 mm lies beyond the negative soft limit -50.0 mm (P-AXIS-00177); "
        "nothing was changed",
        {"target": -50.5, "limit": -50.0},
    ),
    (
        120002,
        of_x("jog", SOFT | {"start_position": 100.0}, velocity=5.0),
        "axis x: jog refused: the axis is at its positive soft limit 100.0 mm (P-AXIS-00178); nothing was changed",
        {"limit": 100.0},
    ),
    (
        120003,
        of_x("jog", SOFT | {"start_position": -80.0}, velocity=-5.0),
        "axis x: jog refused: the axis is at -80.0 mm, beyond its negative soft limit -50.0 mm (P-AXIS-00177); nothing "
        "was changed",
        {"position": -80.0, "limit": -50.0},
    ),
    (
        23004,
        of_x("move_absolute", {"rotary": True, "max_velocity": 360.0}, **MOVE, velocity=361.0),
        "axis x: move_absolute refused: velocity 361.0 deg/s is above the maximum 360.0 deg/s (P-AXIS-00212); nothing "
        "was changed",
        {"velocity": 361.0, "limit": 360.0},
    ),
    # states
    (
        23005,
        of_unit(stopping, "move_absolute", **MOVE),
        "axis x: move_absolute refused: the axis is in Stopping, it must be in Standstill; nothing was changed",
        {"state": "Stopping"},
    ),
    (
        23005,
        of_unit(on_error_ramp, "jog", velocity=5.0),
        "axis x: jog refused: the axis is in ErrorStop, it must be in Standstill or jogging; nothing was changed",
        {"state": "ErrorStop"},
    ),
    (
        23005,
        of_unit(stopping, "external_enable", mode="relative"),
        "axis x: external_enable refused: the axis is in Stopping; nothing was changed",
        {"state": "Stopping"},
    ),
    (
        23005,
        of_path("stop"),
        "axis x: stop refused: the channel path moves the axis; use feed_hold or reset of the channel; nothing was "
        "changed",
        {},
    ),
    (
        23008,
        of_unit(on_error_ramp, "reset"),
        "axis x: reset refused: the axis still moves on its error ramp; wait for standstill; nothing was changed",
        {},
    ),
    (
        23006,
        of_x("set_override", percent=100.5),
        "axis x: set_override refused: percent = 100.5 is not within 0 ... 100 (P-AXIS-00109, at most 100); nothing was "
        "changed",
        {"percent": 100.5, "limit": 100.0},
    ),
    (
        23035,
        of_x("set_override_type", type=5),
        "axis x: set_override_type refused: type = 5 is not one of 1, 2, 3, 4; nothing was changed",
        {"type": 5},
    ),
    (
        23024,
        of_x("move_modulo", position=5.0),
        "axis x: move_modulo refused: the axis does not count modulo (P-AXIS-00015); nothing was changed",
        {},
    ),
    (
        23014,
        of_x("new_target", target=5.0),
        "axis x: new_target refused: no positioning is active (the axis is in Standstill); start one; nothing was "
        "changed",
        {"state": "Standstill"},
    ),
    (
        23015,
        of_unit(compensating, "new_target", target=5.0),
        "axis x: new_target refused: a position compensation is active; nothing was changed",
        {},
    ),
    (
        23017,
        of_unit(braking, "emergency_stop", deceleration=10_000.0, jerk=1e6),
        "axis x: emergency_stop refused: the axis is in its brake phase; nothing was changed",
        {},
    ),
    # position compensation
    (
        23018,
        of_unit(moving_axis, "compensation_start", **COMPENSATION | {"length": 0.0}),
        "axis x: compensation_start refused: length = 0.0 must be greater than 0; nothing was changed",
        {"argument": "length", "value": 0.0},
    ),
    (
        23018,
        of_unit(moving_axis, "compensation_start", **COMPENSATION | {"length": 1e300}),
        "axis x: compensation_start refused: length = 1e+300 must be between 1e-09 and 1e+12; nothing was changed",
        {"argument": "length", "value": 1e300, "low": 1e-9, "high": 1e12},
    ),
    (
        23018,
        of_unit(moving_axis, "compensation_start", **COMPENSATION | {"difference": 0.0}),
        "axis x: compensation_start refused: difference = 0 must be different from 0; nothing was changed",
        {"argument": "difference", "value": 0.0},
    ),
    (
        23004,
        lambda: moving_axis(max_velocity=2100.0).give(
            "compensation_start", **COMPENSATION | {"velocity_increase": 1e4}
        ),
        "axis x: compensation_start refused: the axis would get up to 2139.62 mm/s, above the maximum 2100.0 mm/s "
        "(P-AXIS-00212); nothing was changed",
        {"velocity": pytest.approx(2139.62, abs=0.01), "limit": 2100.0},
    ),
    (
        23019,
        of_unit(compensating, "compensation_start", **COMPENSATION),
        "axis x: compensation_start refused: a position compensation is active; it cannot be started again; nothing was "
        "changed",
        {},
    ),
    (
        23020,
        of_unit(stopping, "compensation_start", **COMPENSATION),
        "axis x: compensation_start refused: the axis is stopping or in its brake phase; nothing was changed",
        {},
    ),
    (
        23021,
        of_x("compensation_start", **COMPENSATION),
        "axis x: compensation_start refused: no basic motion is active (the axis is in Standstill); nothing was "
        "changed",
        {"state": "Standstill"},
    ),
    (
        23021,
        of_y(slave, "compensation_start", **COMPENSATION),
        "axis y: compensation_start refused: the basic motion of the slave is at a standstill; nothing was changed",
        {},
    ),
    (
        23022,
        of_x("compensation_start", {"virtual": True}, **COMPENSATION),
        "axis x: compensation_start refused: a virtual axis cannot compensate (P-AXIS-00020); nothing was changed",
        {},
    ),
    # superimposed and buffered motion
    (
        23059,
        of_unit(adding, "external_enable", mode="relative"),
        "axis x: external_enable refused: a superimposed motion is active; nothing was changed",
        {},
    ),
    (
        23004,
        lambda: moving_axis(max_velocity=2100.0).give("move_superimposed", distance=1.0, velocity_difference=200.0),
        "axis x: move_superimposed refused: the axis would get up to 2200 mm/s, above the maximum 2100.0 mm/s "
        "(P-AXIS-00212); nothing was changed",
        {"velocity": 2200.0, "limit": 2100.0},
    ),
    (
        23058,
        of_unit(half_released, "move_superimposed", distance=-1.0),
        "axis x: move_superimposed refused: it leads backward, which is not released (set_feed_release); nothing was "
        "changed",
        {},
    ),
    (
        23063,
        of_unit(buffering, "move_absolute", **MOVE, buffer_mode="buffered"),
        "axis x: move_absolute refused: job 2 waits already, no other can; nothing was changed",
        {"job": 2},
    ),
    (
        23005,
        of_unit(stopping, "move_velocity", velocity=5.0, buffer_mode="aborting"),
        "axis x: move_velocity refused: the axis is in Stopping, it must be in Standstill, DiscreteMotion or "
        "ContinuousMotion; nothing was changed",
        {"state": "Stopping"},
    ),
    (
        22001,
        of_x("move_absolute", **MOVE, buffer_mode="queued"),
        "axis x: move_absolute refused: buffer_mode = 'queued' is not aborting, buffered, blending_low, "
        "blending_previous, blending_next or blending_high; nothing was changed",
        {"argument": "buffer_mode"},
    ),
    # other coordinates
    (
        23027,
        of_unit(external, "set_position", position=1.0),
        "axis x: set_position refused: external setpoints are enabled; disable them; nothing was changed",
        {},
    ),
    (
        23071,
        lambda: slave().send("x", "set_position", position=1.0),
        "axis x: set_position refused: the axis is the master of y; decouple first; nothing was changed",
        {"slaves": "y"},
    ),
    # external setpoints
    (
        23025,
        of_unit(external, "external_enable", mode="absolute"),
        "axis x: external_enable refused: external setpoints are enabled as relative; absolute does not match; nothing "
        "was changed",
        {"mode": "absolute", "enabled": "relative"},
    ),
    (
        23026,
        of_unit(moving_axis, "external_enable", mode="absolute"),
        "axis x: external_enable refused: absolute setpoints are not permitted during a PTP motion; use relative; "
        "nothing was changed",
        {},
    ),
    (
        23026,
        of_path("external_enable", mode="absolute"),
        "axis x: external_enable refused: absolute setpoints are not permitted on the path of a channel; use "
        "relative; nothing was changed",
        {},
    ),
    (
        23026,
        of_path("external_enable", mode="relative", target=12.5),
        "axis x: external_enable refused: a target (12.5) is not permitted on the path of a channel; leave it out; "
        "nothing was changed",
        {"target": 12.5},
    ),
    (
        23027,
        of_unit(external, "move_absolute", **MOVE),
        "axis x: move_absolute refused: external setpoints are enabled; a PTP start is not permitted at the same time; "
        "nothing was changed",
        {},
    ),
    (
        23028,
        of_x("external_enable", {"powered_at_start": False}, mode="relative"),
        "axis x: external_enable refused: the axis is not enabled; power it on; nothing was changed",
        {},
    ),
    (
        23028,
        of_unit(half_released, "external_enable", mode="relative"),
        "axis x: external_enable refused: both directions must be released (set_feed_release); nothing was changed",
        {},
    ),
    (
        23029,
        of_unit(on_error_ramp, "external_enable", mode="relative"),
        "axis x: external_enable refused: the axis has error 26101; reset it; nothing was changed",
        {"error": 26101},
    ),
    (
        23030,
        of_y(slave, "external_enable", mode="relative"),
        "axis y: external_enable refused: x is the master of the axis; nothing was changed",
        {"master": "x"},
    ),
    (
        23032,
        of_unit(external, "external_setpoints", setpoints=[[100, 0.0, 10_000.5, 0.0, 1]]),
        "axis x: external_setpoints refused: setpoint of cycle 100: velocity 10000.5 mm/s is above the maximum 10000.0 "
        "mm/s (P-AXIS-00212); nothing was changed",
        {"setpoint": 100, "argument": "velocity", "value": 10_000.5, "limit": 10_000.0},
    ),
    # couplings
    (
        23040,
        of_y(slave, "move_absolute", **MOVE),
        "axis y: move_absolute refused: the axis is a slave of x; decouple it; nothing was changed",
        {"master": "x"},
    ),
    (
        23040,
        of_y(slave, "stop"),
        "axis y: stop refused: the axis is a slave of x; stop x or decouple the axis; nothing was changed",
        {"master": "x"},
    ),
    (
        23041,
        of_y(SlaveBench, "couple", master="y", factor=1.0),
        "axis y: couple refused: an axis cannot be its own master; nothing was changed",
        {},
    ),
    (
        23042,
        of_y(SlaveBench, "couple", master="q", factor=1.0),
        "axis y: couple refused: there is no axis 'q'. Known: x, z, c; nothing was changed",
        {"master": "q"},
    ),
    (
        23043,
        of_y(SlaveBench, "couple", master="x", factor=0.0),
        "axis y: couple refused: factor = 0 must be different from 0; nothing was changed",
        {"argument": "factor", "value": 0.0},
    ),
    (
        23043,
        of_y(SlaveBench, "couple", master="x", factor=1e300),
        "axis y: couple refused: factor = 1e+300 must be between 1e-06 and 1e+06 or the negative of it; nothing was "
        "changed",
        {"argument": "factor", "value": 1e300, "low": 1e-6, "high": 1e6},
    ),
    (
        23044,
        of_y(slave, "couple", master="x", factor=1.0),
        "axis y: couple refused: the axis is in SynchronizedMotion, it must be in Standstill; nothing was changed",
        {"state": "SynchronizedMotion"},
    ),
    (
        23045,
        lambda: moving_slave().send("z", "couple", master="x", factor=1.0),
        "axis z: couple refused: the master x moves; both axes must be at a standstill; nothing was changed",
        {"master": "x"},
    ),
    (
        23046,
        lambda: slave().send("x", "couple", master="y", factor=1.0),
        "axis x: couple refused: y is a slave of the axis already (y -> x); nothing was changed",
        {"master": "y", "chain": "y -> x"},
    ),
    (
        23047,
        of_y(SlaveBench, "decouple"),
        "axis y: decouple refused: the axis is not coupled (it is in Standstill); nothing was changed",
        {"state": "Standstill"},
    ),
    (
        23047,
        of_y(SlaveBench, "set_coupling_factor", factor=1.0),
        "axis y: set_coupling_factor refused: the axis is not coupled (it is in Standstill); nothing was changed",
        {"state": "Standstill"},
    ),
    (
        23048,
        of_y(SlaveBench, "couple_cyclic", master="x", acc_bound=0.0),
        "axis y: couple_cyclic refused: acc_bound = 0.0 must be greater than 0; nothing was changed",
        {"acc_bound": 0.0},
    ),
    (
        23050,
        of_y(slave, "set_cyclic_factor", factor=1.0),
        "axis y: set_cyclic_factor refused: the axis is not coupled cyclically; nothing was changed",
        {},
    ),
    (
        23050,
        of_y(lambda: slave("couple_cam", table=POINTS, cyclic=False), "set_coupling_factor", factor=1.0),
        "axis y: set_coupling_factor refused: the coupling of the axis has no factor to set; nothing was changed",
        {},
    ),
    (
        23050,
        of_y(slave, "change_cam", table=POINTS),
        "axis y: change_cam refused: the axis is not coupled by a cyclic cam table; nothing was changed",
        {},
    ),
    (
        23052,
        of_y(SlaveBench, "couple_cam", master="x", table=[[0.0, 0.0]], cyclic=False),
        "axis y: couple_cam refused: a cam table needs 3 points or more, it has 1; nothing was changed",
        {"points": 1},
    ),
    (
        23052,
        of_y(SlaveBench, "couple_cam", master="x", table=[[0.0, 0.0], [-5.0, 0.0], [9.0, 0.0]], cyclic=False),
        "axis y: couple_cam refused: master position -5 comes after 0; a cam table must ascend by 1e-06 or more; nothing "
        "was changed",
        {"position": -5.0, "before": 0.0},
    ),
    (
        23052,
        of_y(SlaveBench, "couple_cam", master="x", table=[[0.0, 0.0], [5.0], [9.0, 0.0]], cyclic=False),
        "axis y: couple_cam refused: each point of a cam table needs two finite numbers, master and slave; nothing was "
        "changed",
        {},
    ),
    (
        23052,
        of_y(SlaveBench, "couple_cam", master="x", table=[[0.0, 0.0], [5.0, 1e13], [9.0, 0.0]], cyclic=False),
        "axis y: couple_cam refused: the points of a cam table must lie within ±1e+12; nothing was changed",
        {"limit": 1e12},
    ),
    (
        23054,
        of_y(SlaveBench, "couple_gantry", master="x", difference_limit=0.0),
        "axis y: couple_gantry refused: difference_limit = 0.0 must be greater than 0; nothing was changed",
        {"argument": "difference_limit", "value": 0.0},
    ),
    # below the setpoint
    (
        23060,
        of_x("set_feedforward", weight_percent=-0.5),
        "axis x: set_feedforward refused: weight_percent = -0.5 must be a number of 0 or more (G136); nothing was changed",
        {"weight_percent": -0.5},
    ),
    (
        70495,
        of_x("set_friction_compensation", enabled=True),
        "axis x: set_friction_compensation refused: friction compensation is not activated (P-AXIS-00522 "
        "lr_param.frict_comp = 0); nothing was changed",
        {},
    ),
]


@pytest.mark.parametrize(("number", "ask", "text", "values"), CASES, ids=[str(case[0]) for case in CASES])
def test_refusals_of_an_axis(number: int, ask: Ask, text: str, values: dict[str, Any]) -> None:
    record = ask()
    assert (record.accepted, record.error_id, record.message) == (False, number, text)
    assert record.values == values
