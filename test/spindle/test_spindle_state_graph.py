"""Figures 9 and 10: every edge of the two state graphs, with homing, control limit and velocity control."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from error_support import refused
from loop_support import feedforward
from machine_support import UnitBench, spindle_bench, spindle_parameters
from spindle_support import DOWN, RPM, StuckDrive, bench_of, first_cycle, states, two_gears

from cnc_ptp.parameters.view.control_view import VEL
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.spindle_states import SpindleBit, SpindleMode

LIMIT = 1000.0 * RPM
NO_REFERENCE = (
    "the spindle has no reference point and does not home automatically (P-AXIS-00015 0x100); home it first (G74)"
)


def analogue(**changes: Any) -> UnitBench:
    return spindle_bench(zero_pulse=33.25, control_limit=LIMIT, **changes)


def digital(**changes: Any) -> UnitBench:
    return spindle_bench(automatic_homing=False, zero_pulse=33.25, **changes)


def turn(bench: UnitBench, rpm: float, cycles: int = 400, direction: str = "cw") -> None:
    bench.accepted("start", direction=direction, speed_rpm=rpm)
    bench.run(cycles)


# ---------------------------------------------------------------- edges that both graphs have


@pytest.mark.parametrize("make", [analogue, digital])
def test_rotation_stop_and_positioning(make: Any) -> None:
    bench = make()
    turn(bench, 500.0)
    bench.accepted("stop")
    bench.run(200)
    bench.accepted("orient", position_deg=90.0, speed_rpm=200.0)
    bench.run(400)
    turn(bench, 500.0)
    bench.accepted("orient", position_deg=90.0, speed_rpm=200.0)
    bench.run(600)
    assert states(bench) == [
        S.CONTINUOUS_MOTION,
        S.STOPPING,
        S.STANDSTILL,
        S.DISCRETE_MOTION,
        S.STANDSTILL,
        S.CONTINUOUS_MOTION,
        S.DISCRETE_MOTION,
        S.STANDSTILL,
    ]
    assert set(bench.column("referenced")) == {True}


@pytest.mark.parametrize("make", [analogue, digital])
@pytest.mark.parametrize("reference", [0.0, 123.4, -50.0])
def test_homing_from_standstill(make: Any, reference: float) -> None:
    """The zero pulse at 33.25 deg of the encoder becomes P-AXIS-00152; nothing steps but the coordinates."""
    bench = make(referenced_at_start=False, reference_position=reference, encoder_increment=0.0)
    bench.accepted("home")
    bench.run(600)
    assert states(bench) == [S.HOMING, S.STANDSTILL]
    found = first_cycle(bench, "referenced", bool)
    column = bench.columns()
    assert set(column["mode"]) == {SpindleMode.HOMING, SpindleMode.STOP}
    assert column["set_speed_rpm"][found - 1] == 60.0 and column["set_speed_rpm"][-1] == 0.0
    shift = (reference - 33.25) % 360.0
    shift -= 360.0 if shift > 180.0 else 0.0
    step = column["set_position_deg"][found] - column["set_position_deg"][found - 1] - 0.36
    assert step == pytest.approx(shift, abs=1e-9)
    assert column["following_error_deg"][found] == pytest.approx(column["following_error_deg"][found - 1], abs=1e-3)
    encoder = column["actual_position_deg"][-1] - shift
    assert encoder == pytest.approx(bench.unit.spindle.loop.control.drive.position, abs=1e-9)


def test_the_pulse_is_latched_at_its_place() -> None:
    """Wherever in a cycle it comes, M19 afterwards is exactly there (ideal encoder)."""
    for pulse in (0.0, 33.2501, 77.123, 359.9):
        bench = spindle_bench(referenced_at_start=False, zero_pulse=pulse, encoder_increment=0.0)
        bench.accepted("orient", position_deg=0.0, speed_rpm=100.0)
        bench.run(2500)
        assert bench.column("in_position")[-1]
        away = math.remainder(bench.unit.spindle.loop.control.drive.position - pulse, 360.0)
        assert away == pytest.approx(0.0, abs=1e-6)


def test_homing_takes_the_direction_of_rotation_or_the_preferred_one() -> None:
    bench = analogue(referenced_at_start=False)
    turn(bench, 30.0, 100, "ccw")
    bench.accepted("home")
    bench.run(1400)
    assert max(bench.column("set_speed_rpm")) == 0.0 and bench.column("referenced")[-1]
    bench = analogue(referenced_at_start=False, preferred_direction=-1)
    bench.accepted("home")
    bench.run(1200)
    assert max(bench.column("set_speed_rpm")) == 0.0 and bench.column("referenced")[-1]


def test_error_and_reset() -> None:
    bench = digital()
    turn(bench, 500.0)
    bench.accepted("upstream_lost", source="plc")
    bench.run(200)
    bench.accepted("reset")
    bench.run(10)
    assert states(bench) == [S.CONTINUOUS_MOTION, S.ERROR_STOP, S.STANDSTILL]


# ---------------------------------------------------------------- analogue: automatic homing


def test_m19_without_reference_homes_first() -> None:
    bench = analogue(referenced_at_start=False)
    bench.accepted("orient", position_deg=100.0, speed_rpm=200.0)
    bench.run(1500)
    assert states(bench) == [S.HOMING, S.DISCRETE_MOTION, S.STANDSTILL]
    assert bench.column("in_position")[-1] and bench.column("referenced")[-1]
    homing_ends = first_cycle(bench, "state", lambda state: state == S.DISCRETE_MOTION)
    assert bench.column("set_speed_rpm")[homing_ends] == 60.0  # no standstill in between


def test_g74_from_rotation_homes_without_standstill() -> None:
    bench = analogue(referenced_at_start=False)
    turn(bench, 500.0)
    bench.accepted("home")
    bench.run(1600)
    assert states(bench) == [S.CONTINUOUS_MOTION, S.HOMING, S.STANDSTILL]
    found = first_cycle(bench, "referenced", bool)
    assert min(bench.column("set_speed_rpm")[10:found]) == 60.0


@pytest.mark.parametrize("command", ["stop", "orient", "home"])
def test_after_the_control_limit_the_spindle_homes_first(command: str) -> None:
    bench = analogue()
    turn(bench, 2000.0, 700)
    bench.accepted(command, **({"position_deg": 100.0, "speed_rpm": 200.0} if command == "orient" else {}))
    bench.run(2200)
    expected = [S.CONTINUOUS_MOTION, S.HOMING, S.STANDSTILL]
    if command == "orient":
        expected.insert(2, S.DISCRETE_MOTION)
        assert bench.column("in_position")[-1]
    assert states(bench) == expected and bench.column("referenced")[-1]


def test_the_control_limit_opens_the_loop_and_loses_the_reference() -> None:
    bench = analogue()
    turn(bench, 2000.0, 700)
    bench.accepted("set_speed", speed_rpm=500.0)
    bench.run(600)
    column = bench.columns()
    for cycle in range(700):
        beyond = abs(column["set_speed_rpm"][cycle]) > 1000.0
        bits = column["status_bits"][cycle]
        assert bool(bits & SpindleBit.POSITION_CONTROL) is not beyond
        assert bool(bits & SpindleBit.MONITORING_INVALID) is beyond
        if beyond:  # actual values are simulated: the lag of the speed, on a ramp as that of the position controller
            lag = column["actual_speed_rpm"][cycle + 1] * RPM / 50.0
            assert column["following_error_deg"][cycle] == pytest.approx(lag)
    assert column["following_error_deg"][699] == pytest.approx(2000.0 * RPM / 50.0)
    assert column["actual_speed_rpm"][699] == pytest.approx(2000.0)
    lost = first_cycle(bench, "referenced", lambda referenced: not referenced)
    assert lost == first_cycle(bench, "set_speed_rpm", lambda speed: speed > 1000.0)
    assert not any(column["referenced"][lost:])
    closed = first_cycle(bench, "status_bits", lambda bits: bool(bits & SpindleBit.POSITION_CONTROL), 700)
    assert column["set_speed_rpm"][closed] == pytest.approx(1000.0, abs=1e-9)


FEEDFORWARD = {"off": 0.0, "half": 50.0, "full": 100.0}


@pytest.mark.parametrize("direction", ["cw", "ccw"])
@pytest.mark.parametrize("weight", FEEDFORWARD)
def test_the_drive_notices_nothing_of_the_control_limit(weight: str, direction: str) -> None:
    """Speed and output of the drive are those of a spindle that has no such limit, up and down again on ramps.

    With feedforward as well as its part is known, to less than the speed that the ramp gains in two cycles.
    """
    columns = []
    for limit in (math.inf, LIMIT):
        ideal = {"encoder_increment": 0.0, "drive_time_constant": 0.0}
        bench = spindle_bench(control_limit=limit, **ideal, feedforward=feedforward(VEL))
        bench.accepted("set_feedforward", enabled=weight != "off", weight_percent=FEEDFORWARD[weight])
        turn(bench, 2000.0, 600, direction)
        bench.accepted("set_speed", speed_rpm=500.0)
        bench.run(600)
        columns.append(bench.columns())
    free, limited = columns
    assert len({bool(bits & SpindleBit.POSITION_CONTROL) for bits in limited["status_bits"]}) == 2
    slack = 1e-6 if weight == "off" else 2.0 * DOWN * 0.001
    digits = max(map(abs, free["drive_output"])) / (2000.0 * RPM)
    assert limited["drive_output"] == pytest.approx(free["drive_output"], abs=1.0 + slack * digits)
    assert limited["actual_speed_rpm"] == pytest.approx(free["actual_speed_rpm"], abs=slack / RPM)
    assert limited["following_error_deg"] == pytest.approx(free["following_error_deg"], abs=slack / 50.0)


def test_a_drive_with_its_own_time_and_encoder_passes_the_control_limit_without_a_jump() -> None:
    bench = spindle_bench(control_limit=LIMIT, drive_time_constant=0.002, encoder_increment=0.05)
    turn(bench, 2000.0, 600)
    bench.accepted("stop")
    bench.run(1500)
    output = bench.column("drive_output")
    digits = max(output) / (2000.0 * RPM)
    steps = [abs(after - before) / digits for before, after in pairwise(output)]
    assert max(steps) < 2.0 * DOWN * 0.001 and bench.column("in_position")[-1] is False
    assert bench.column("referenced")[-1] and bench.state == S.STANDSTILL


@pytest.mark.parametrize("limit", [400.0, 401.7, 433.3, 1234.567, 1799.999])
@pytest.mark.parametrize("direction", ["cw", "ccw"])
def test_a_positioning_stays_below_the_control_limit(limit: float, direction: str) -> None:
    """Above it the measuring system fails: the spindle would not stop where commanded."""
    bench = spindle_bench(control_limit=limit, homing_speed=100.0)
    shown = f"{limit / RPM:g} rpm"
    assert bench.accepted("orient", position_deg=90.0, speed_rpm=300.0, direction=direction) == (
        f"P-WARN-24029 spindle s: speed 300 rpm is above the control limit {shown} (P-AXIS-00220), {shown} is used"
    )
    bench.run(1500)
    assert max(map(abs, bench.column("set_speed_rpm"))) == pytest.approx(limit / RPM)
    assert set(bench.column("referenced")) == {True} and bench.column("in_position")[-1]
    assert bench.unit.spindle.loop.encoder % 360.0 == pytest.approx(90.0, abs=0.06)


def test_a_rapid_traverse_above_the_control_limit_and_an_override_above_100() -> None:
    bench = spindle_bench(control_limit=600.0, homing_speed=100.0, positioning_speed=900.0, max_override_percent=200.0)
    shown = "speed 150 rpm is above the control limit 100 rpm (P-AXIS-00220), 100 rpm is used"
    assert bench.accepted("orient", position_deg=90.0) == f"P-WARN-24029 spindle s: {shown}"
    bench.accepted("set_override", percent=200.0)
    bench.run(600)
    assert bench.accepted("orient", position_deg=0.0, speed_rpm=90.0) == ""
    bench.run(600)
    assert max(map(abs, bench.column("set_speed_rpm"))) == pytest.approx(100.0)
    assert set(bench.column("referenced")) == {True} and bench.column("in_position")[-1]


def test_the_change_position_is_approached_below_the_control_limit() -> None:
    bench = bench_of(two_gears(change_position=90.0, control_limit=400.0, homing_speed=100.0, positioning_speed=1800.0))
    text = "speed 300 rpm is above the control limit 66.6667 rpm (P-AXIS-00220), 66.6667 rpm is used"
    assert bench.accepted("select_gear", stage=2) == f"P-WARN-24029 spindle s: {text}"
    bench.run(800)
    assert bench.last.gear_request == 2 and bench.last.referenced[-1]
    assert bench.unit.spindle.loop.encoder == pytest.approx(90.0, abs=0.06)


@pytest.mark.parametrize("command", ["orient", "select_gear"])
def test_a_positioning_in_the_cycle_that_passes_the_control_limit_homes_first(command: str) -> None:
    bench = bench_of(two_gears(control_limit=LIMIT, zero_pulse=33.25), count=1)
    bench.accepted("start", direction="cw", speed_rpm=2000.0)
    while bench.unit.spindle.motion(bench.cycle)[1] <= LIMIT:
        bench.run(1)
    assert bench.last.referenced[-1]
    bench.accepted(command, **({"position_deg": 100.0, "speed_rpm": 200.0} if command == "orient" else {"stage": 2}))
    bench.run(2500)
    assert S.HOMING in states(bench) and bench.last.referenced[-1] and bench.state == S.STANDSTILL
    assert bench.unit.spindle.loop.encoder % 360.0 == pytest.approx(133.25 if command == "orient" else 33.25, abs=0.06)


def test_a_spindle_that_does_not_home_by_itself_has_lost_its_reference_in_that_cycle() -> None:
    bench = spindle_bench(count=1, control_limit=LIMIT, automatic_homing=False)
    bench.accepted("start", direction="cw", speed_rpm=2000.0)
    while bench.unit.spindle.motion(bench.cycle)[1] <= LIMIT:
        bench.run(1)
    assert bench.refusal("orient", position_deg=100.0) == refused(24007)


def test_below_the_control_limit_m05_simply_stops() -> None:
    bench = analogue()
    turn(bench, 999.0)
    bench.accepted("stop")
    bench.run(300)
    assert states(bench) == [S.CONTINUOUS_MOTION, S.STOPPING, S.STANDSTILL] and bench.column("referenced")[-1]


def test_a_reset_after_the_control_limit_does_not_home() -> None:
    bench = analogue()
    turn(bench, 2000.0, 700)
    bench.accepted("reset")
    bench.run(400)
    assert states(bench) == [S.CONTINUOUS_MOTION, S.STOPPING, S.STANDSTILL] and not bench.column("referenced")[-1]


def test_no_zero_pulse() -> None:
    bench = bench_of(spindle_parameters(referenced_at_start=False), drive=StuckDrive())
    bench.accepted("home")
    bench.run(2300)
    assert bench.event_texts() == [
        "P-ERR-24010 spindle s: no zero pulse came in 720 deg at homing speed 360 deg/s (P-AXIS-00218); the spindle stops "
        "on its ramp (ErrorStop)"
    ]
    assert states(bench) == [S.HOMING, S.ERROR_STOP]
    assert bench.events[0].cycle == pytest.approx(10 + 720.0 / 0.36, abs=2)


def test_a_stop_during_homing_gives_it_up() -> None:
    bench = analogue(referenced_at_start=False)
    bench.accepted("home")
    bench.run(40)
    bench.accepted("stop")
    bench.run(200)
    assert states(bench) == [S.HOMING, S.STOPPING, S.STANDSTILL] and not bench.column("referenced")[-1]


# ---------------------------------------------------------------- digital: no automatic homing


@pytest.mark.parametrize("rotates", [False, True])
@pytest.mark.parametrize("command", ["orient", "select_gear"])
def test_without_reference_m19_and_gear_changes_are_an_error(rotates: bool, command: str) -> None:
    parameters = spindle_parameters(automatic_homing=False, referenced_at_start=False)
    gears = {1: parameters.gears[1], 2: replace(parameters.gears[1], stage=2)}
    bench = bench_of(replace(parameters, gears=gears))
    if rotates:
        turn(bench, 500.0)
    arguments: dict[str, Any] = {"position_deg": 0.0} if command == "orient" else {"stage": 2}
    assert bench.refusal(command, **arguments) == refused(24007)
    bench.run(200)
    assert bench.event_texts()[0] == f"P-ERR-24007 spindle s: {NO_REFERENCE}; the spindle stops on its ramp (ErrorStop)"
    assert bench.state == S.ERROR_STOP and bench.column("set_speed_rpm")[-1] == 0.0
    bench.accepted("reset")
    bench.accepted("home")
    bench.run(1300)
    bench.accepted("orient", position_deg=0.0)
    bench.run(600)
    assert bench.column("in_position")[-1]


def test_g74_from_motion_is_refused() -> None:
    bench = digital()
    turn(bench, 500.0)
    assert bench.refusal("home") == refused(24009)
    bench.run(10)
    assert bench.state == S.CONTINUOUS_MOTION


# ---------------------------------------------------------------- velocity control (P-AXIS-00265, 00266)


def switched(**changes: Any) -> UnitBench:
    limits = {"velocity_control_on": 1200.0 * RPM, "velocity_control_off": 300.0 * RPM, **changes}
    return digital(**limits)


def under_velocity_control(bench: UnitBench) -> list[bool]:
    return [bool(bits & SpindleBit.VELOCITY_CONTROL) for bits in bench.column("status_bits")]


def test_a_speed_above_00265_is_velocity_controlled_and_m19_comes_down_to_00266_first() -> None:
    bench = switched()
    turn(bench, 1200.0, 300)
    turn(bench, 3000.0, 700)
    bench.accepted("orient", position_deg=10.0, speed_rpm=600.0)
    bench.run(900)
    control = under_velocity_control(bench)
    assert not any(control[:300]) and all(control[300:1000])
    back = control.index(False, 1000)
    assert bench.column("set_speed_rpm")[back] == pytest.approx(300.0)
    assert bench.column("actual_speed_rpm")[back] <= 330.0 < bench.column("actual_speed_rpm")[back - 1]
    assert bench.column("following_error_deg")[back] == pytest.approx(300.0 * RPM / 50.0)
    assert bench.column("in_position")[-1] and set(bench.column("referenced")) == {True}
    assert bench.column("actual_position_deg")[-1] % 360.0 == pytest.approx(10.0, abs=0.01)


def test_m05_switches_back_on_its_way_down() -> None:
    bench = switched()
    turn(bench, 3000.0, 700)
    bench.accepted("stop")
    bench.run(600)
    back = under_velocity_control(bench).index(False, 700)
    assert 0.0 < bench.column("set_speed_rpm")[back] <= 300.0
    assert bench.state == S.STANDSTILL
    assert bench.column("actual_position_deg")[-1] == pytest.approx(bench.column("set_position_deg")[-1], abs=1e-3)


def test_a_lower_speed_between_the_limits_stays_under_velocity_control() -> None:
    bench = switched()
    turn(bench, 3000.0, 700)
    turn(bench, 800.0, 400)
    assert all(under_velocity_control(bench))
    turn(bench, 200.0, 400)
    assert not under_velocity_control(bench)[-1] and bench.column("speed_reached")[-1]


def test_with_00266_of_0_it_is_switched_back_at_standstill() -> None:
    bench = switched(velocity_control_off=0.0)
    turn(bench, 3000.0, 700)
    bench.accepted("orient", position_deg=10.0, speed_rpm=600.0)
    bench.run(1000)
    assert bench.column("in_position")[-1]
    assert bench.column("set_speed_rpm")[under_velocity_control(bench).index(False)] == 0.0


# ---------------------------------------------------------------- enable


def test_power() -> None:
    bench = spindle_bench(powered_at_start=False)
    bench.accepted("power", enabled=True)
    assert bench.accepted("power", enabled=True) == "spindle s: power is on already"
    turn(bench, 500.0)
    bench.accepted("power", enabled=False)
    bench.run(200)
    assert bench.event_texts() == [
        "P-ERR-24011 spindle s: the enable was removed in motion; the spindle stops on its ramp (ErrorStop)"
    ]
    bench.accepted("reset")
    bench.run(10)
    assert states(bench) == [S.CONTINUOUS_MOTION, S.ERROR_STOP, S.DISABLED]
    bench.accepted("power", enabled=True)
    bench.run(50)
    bench.accepted("power", enabled=False)
    bench.run(10)
    assert states(bench)[-2:] == [S.STANDSTILL, S.DISABLED] and len(bench.events) == 1


def test_power_takes_the_place_where_the_spindle_was_turned_by_hand() -> None:
    bench = spindle_bench(powered_at_start=False)
    bench.run(10)
    bench.unit.spindle.loop.control.drive._true_position = 45.0
    bench.run(10)
    bench.accepted("power", enabled=True)
    bench.run(10)
    assert bench.column("set_position_deg")[-1] == pytest.approx(45.0) == bench.column("actual_position_deg")[-1]
