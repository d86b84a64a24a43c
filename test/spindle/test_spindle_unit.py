"""The spindle: speeds in every cycle, monitoring, override, direction, reset and faults."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from error_support import Refused, refused
from machine_support import CYCLE_TIME, MILL, MachineBench, UnitBench, spindle_bench

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.spindle_states import SpindleMode

UP, DOWN, RPM = 36_000.0, 40_000.0, 6.0


def ramp(speed: float, wanted: float, t: float) -> float:
    """Speed in deg/s at t of a ramp without reversal."""
    rate = UP if abs(wanted) > abs(speed) else DOWN
    change = math.copysign(min(rate * t, abs(wanted - speed)), wanted - speed)
    return speed + change


def assert_speeds(bench: UnitBench, begin: int, end: int, speed: float, wanted: float) -> None:
    """From `speed` to `wanted` (rpm) between two cycles, with its acceleration column and position."""
    set_speed = bench.column("set_speed_rpm")
    for cycle in range(begin, end):
        expected = ramp(speed * RPM, wanted * RPM, (cycle - begin) * CYCLE_TIME)
        assert set_speed[cycle] * RPM == pytest.approx(expected, abs=1e-7)


def integral(values: list[float]) -> float:
    return sum(0.5 * (a + b) for a, b in pairwise(values)) * CYCLE_TIME


@pytest.mark.parametrize(("direction", "sign", "mode"), [("cw", 1.0, SpindleMode.CW), ("ccw", -1.0, SpindleMode.CCW)])
def test_start_and_stop_in_every_cycle(direction: str, sign: float, mode: SpindleMode) -> None:
    bench = spindle_bench()
    bench.run(20)
    bench.accepted("start", direction=direction, speed_rpm=3000.0)
    bench.run(800)
    bench.accepted("stop")
    bench.run(700)
    assert_speeds(bench, 20, 820, 0.0, sign * 3000.0)
    assert_speeds(bench, 820, 1520, sign * 3000.0, 0.0)
    columns = bench.columns()
    assert set(columns["set_acceleration_deg_s2"][20:519]) == {sign * UP}
    assert set(columns["set_acceleration_deg_s2"][521:820]) == {0.0}
    assert set(columns["set_acceleration_deg_s2"][820:1269]) == {-sign * DOWN}
    assert columns["mode"][19:21] == [SpindleMode.STOP, mode] and columns["mode"][820] == SpindleMode.STOP
    assert columns["state"][19:21] == [S.STANDSTILL, S.CONTINUOUS_MOTION]
    assert columns["state"][819:821] == [S.CONTINUOUS_MOTION, S.STOPPING]
    assert columns["state"].index(S.STANDSTILL, 820) == pytest.approx(820 + 450, abs=1)
    speeds = [rpm * RPM for rpm in columns["set_speed_rpm"]]
    assert columns["set_position_deg"][-1] == pytest.approx(integral(speeds), abs=0.05)
    assert columns["set_position_deg"][-1] > 360.0 * 10 or sign < 0  # absolute, never wrapped


def test_reversal_goes_through_zero_with_both_ramps() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=2000.0)
    bench.run(500)
    bench.accepted("start", direction="ccw", speed_rpm=1500.0)
    bench.run(800)
    assert_speeds(bench, 500, 800, 2000.0, 0.0)
    assert_speeds(bench, 800, 1300, 0.0, -1500.0)
    acceleration = bench.column("set_acceleration_deg_s2")
    assert set(acceleration[500:799]) == {-DOWN} and set(acceleration[801:1049]) == {-UP}
    assert set(bench.column("mode")[500:]) == {SpindleMode.CCW}
    assert set(bench.column("state")) == {S.CONTINUOUS_MOTION}


def test_a_new_speed_in_the_midst_of_a_ramp() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=3000.0)
    bench.run(250)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(400)
    bench.accepted("start", direction="cw", speed_rpm=1200)
    bench.run(100)
    assert_speeds(bench, 250, 650, 1500.0, 1000.0)
    assert_speeds(bench, 650, 750, 1000.0, 1200.0)


def test_speed_reached_within_the_band_of_the_commanded_speed() -> None:
    """P-AXIS-00217: 0.9 … 1.1 times; of the actual speed, which lags behind."""
    bench = spindle_bench(speed_reached_band=0.1)
    bench.accepted("start", direction="ccw", speed_rpm=2000.0)
    bench.run(800)
    bench.accepted("start", direction="ccw", speed_rpm=1000.0)
    bench.run(500)
    actual, reached = bench.column("actual_speed_rpm"), bench.column("speed_reached")
    for cycle in range(1300):
        wanted = -2000.0 if cycle < 800 else -1000.0
        assert reached[cycle] is (0.9 * abs(wanted) <= -actual[cycle] <= 1.1 * abs(wanted))
    assert reached.index(True) > 300 and not reached[800] and reached[-1]


def test_speed_zero_and_the_end_of_m05() -> None:
    """P-AXIS-00216; with M05 the zero speed is the commanded one."""
    bench = spindle_bench(zero_speed=120.0)
    bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.run(300)
    bench.accepted("stop")
    bench.run(300)
    actual, zero, reached = (bench.column(name) for name in ("actual_speed_rpm", "speed_zero", "speed_reached"))
    for cycle in range(600):
        assert zero[cycle] is (abs(actual[cycle]) * RPM <= 120.0)
        if cycle >= 300:
            assert reached[cycle] is zero[cycle]
    assert zero[0] and not zero[299] and zero[-1]


@pytest.mark.parametrize(("rate", "cycles"), [(3707.4, 40), (3655.0, 10), (4359.8, 30), (2413.1, 30)])
def test_a_spindle_that_stands_does_not_accelerate(rate: float, cycles: int) -> None:
    """Up and down with one acceleration: where the speed is 0 again, rounding may leave a rest of the ramp."""
    bench = MachineBench(machine=MILL, end_when_idle=False)
    bench.run(0.01)
    assert bench.give("s", "set_limits", max_acceleration=rate).accepted
    assert bench.give("s", "start", speed_rpm=3000.0, direction="cw").accepted
    bench.run(0.001 * cycles)
    assert bench.give("s", "stop").accepted
    bench.run(0.001 * cycles + 0.02)
    stands = np.array(bench.column("s", "state")) == S.STANDSTILL
    assert stands[-10:].all() and not stands[-20 - cycles]
    assert not np.array(bench.column("s", "set_acceleration_deg_s2"))[stands].any()


@pytest.mark.parametrize("rate", [1227.2, 2755.4, 3453.9, 4830.8])
def test_a_spindle_that_comes_to_rest_in_the_last_cycle_of_a_block_stands_there(rate: float) -> None:
    """From the speed that it reaches in 29 ms; there, too, rounding leaves a rest of the ramp."""
    bench = MachineBench(machine=MILL, end_when_idle=False)
    bench.run(0.01)
    assert bench.give("s", "set_limits", max_acceleration=rate).accepted
    bench.run(0.01)
    assert bench.give("s", "start", speed_rpm=rate * 0.029 / 6.0, direction="cw").accepted
    bench.run(0.05)
    assert bench.give("s", "stop").accepted
    bench.run(0.06)
    speed, state = np.array(bench.column("s", "set_speed_rpm")), np.array(bench.column("s", "state"))
    rest = np.flatnonzero(speed)[-1] + 1
    assert rest % 10 == 9 and (state[rest:] == S.STANDSTILL).all()
    assert not np.array(bench.column("s", "set_acceleration_deg_s2"))[rest:].any()


def test_a_zero_speed_of_0_is_still_reached() -> None:
    bench = spindle_bench(zero_speed=0.0)
    bench.run(10)
    assert set(bench.column("speed_zero")) == {True}


def test_m03_with_speed_0_is_reached_at_standstill() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=0.0)
    bench.run(10)
    assert set(bench.column("speed_reached")) == {True} and set(bench.column("set_speed_rpm")) == {0.0}


def test_following_error_is_speed_over_kv() -> None:
    bench = spindle_bench(kv=50.0)
    bench.accepted("start", direction="cw", speed_rpm=1200.0)
    bench.run(3000)
    assert bench.column("following_error_deg")[-1] == pytest.approx(1200.0 * RPM / 50.0, abs=1e-3)
    assert bench.column("actual_speed_rpm")[-1] == pytest.approx(1200.0, abs=0.01)
    columns = bench.columns()
    for cycle in range(3000):
        difference = columns["set_position_deg"][cycle] - columns["actual_position_deg"][cycle]
        assert columns["following_error_deg"][cycle] == difference


def test_constant_columns() -> None:
    bench = spindle_bench(gear=3)
    bench.run(10)
    assert set(bench.column("gear")) == {3} and set(bench.column("referenced")) == {True}
    assert set(spindle_columns(referenced_at_start=False)["referenced"]) == {False}
    assert set(spindle_columns(start_position=12.5, encoder_increment=0.0)["actual_position_deg"]) == {12.5}
    assert set(spindle_columns(start_position=12.5)["set_position_deg"]) == {12.5}


def spindle_columns(**changes: Any) -> dict[str, list[Any]]:
    bench = spindle_bench(**changes)
    bench.run(10)
    return bench.columns()


# ---------------------------------------------------------------- override


def test_override_scales_the_running_and_the_next_speed() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=2000.0)
    bench.run(500)
    bench.accepted("set_override", percent=50.0)
    bench.run(300)
    bench.accepted("start", direction="cw", speed_rpm=3000)
    bench.run(300)
    bench.accepted("set_override", percent=120)
    bench.run(700)
    assert_speeds(bench, 500, 800, 2000.0, 1000.0)
    assert_speeds(bench, 800, 1100, 1000.0, 1500.0)
    assert_speeds(bench, 1100, 1800, 1500.0, 3600.0)
    assert bench.column("override_percent")[499:501] == [100.0, 50.0] and bench.column("override_percent")[-1] == 120.0
    assert bench.column("speed_reached")[-1] is True


def test_override_never_lifts_the_speed_above_the_maximum() -> None:
    bench = spindle_bench(max_speed=18_000.0)
    bench.accepted("start", direction="ccw", speed_rpm=2900.0)
    bench.accepted("set_override", percent=150.0)
    bench.run(1000)
    assert bench.column("set_speed_rpm")[-1] == -3000.0 and bench.column("speed_reached")[-1]


def test_override_0_holds_and_is_not_the_speed_reached() -> None:
    """The path must not start on a spindle that is held because of its override."""
    bench = spindle_bench()
    bench.accepted("set_override", percent=0.0)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(50)
    assert set(bench.column("set_speed_rpm")) == {0.0} and set(bench.column("speed_reached")) == {False}
    bench.accepted("set_override", percent=100.0)
    bench.run(400)
    assert_speeds(bench, 50, 450, 0.0, 1000.0)
    assert bench.column("speed_reached")[-1]


def test_override_does_not_touch_a_stop() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(300)
    bench.accepted("stop")
    bench.run(50)
    bench.accepted("set_override", percent=50.0)
    bench.run(300)
    assert_speeds(bench, 300, 650, 1000.0, 0.0)


@pytest.mark.parametrize("percent", [-1.0, 150.1])
def test_override_out_of_range(percent: float) -> None:
    assert spindle_bench().refusal("set_override", percent=percent) == refused(24005, percent=percent, limit=150.0)


def test_a_largest_override_below_100_percent_holds_from_the_start() -> None:
    bench = spindle_bench(max_override_percent=80.0)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(500)
    assert bench.column("set_speed_rpm")[-1] == pytest.approx(800.0)


# ---------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        (
            {"direction": "cw", "speed_rpm": -1.0},
            refused(24001, speed=-1.0),
        ),
        (
            {"direction": "ccw", "speed_rpm": 12000.5},
            refused(24002, speed=12000.5, limit=12000.0, gear=1),
        ),
        (
            {"direction": "left", "speed_rpm": 1.0},
            refused(22001, argument="direction"),
        ),
        (
            {"direction": 3, "speed_rpm": 1.0},
            refused(22001, argument="direction"),
        ),
        ({"direction": "cw"}, refused(22001, argument="speed_rpm")),
        (
            {"direction": "cw", "speed_rpm": math.nan},
            refused(22001, argument="speed_rpm"),
        ),
    ],
)
def test_refused_starts_change_nothing(arguments: dict[str, Any], wanted: Refused) -> None:
    bench, undisturbed = spindle_bench(), spindle_bench()
    for each in (bench, undisturbed):
        each.accepted("start", direction="cw", speed_rpm=1000.0)
        each.run(100)
    assert bench.refusal("start", **arguments) == wanted
    for each in (bench, undisturbed):
        each.run(500)
    assert bench.columns() == undisturbed.columns()


def test_a_speed_alone_keeps_the_direction_and_starts_nothing() -> None:
    """An S word after the PLC has stopped the spindle must not start it again."""
    bench = spindle_bench()
    assert bench.give("set_speed", speed_rpm=500.0).message == "spindle s: set_speed without effect in Standstill"
    bench.give("start", direction="ccw", speed_rpm=1000.0)
    bench.run(1000)
    bench.give("set_speed", speed_rpm=400.0)
    bench.run(1000)
    assert bench.column("set_speed_rpm")[-1] == -400.0
    assert bench.refusal("set_speed", speed_rpm=-1.0) == refused(24001, speed=-1.0)


def test_unknown_command() -> None:
    assert spindle_bench().refusal("turn") == refused(22002, command="turn")


@pytest.mark.parametrize(("preferred", "wrong", "word"), [(1, "ccw", "positive"), (-1, "cw", "negative")])
def test_against_the_preferred_direction(preferred: int, wrong: str, word: str) -> None:
    """60254: refused and error state; from motion on the spindle's ramp."""
    right = "cw" if preferred > 0 else "ccw"
    bench = spindle_bench(preferred_direction=preferred)
    bench.accepted("start", direction=right, speed_rpm=1200.0)
    bench.run(300)
    reason = f"{wrong} contradicts the preferred direction of rotation (P-AXIS-00224, P-AXIS-00031: {word})"
    assert bench.refusal("start", direction=wrong, speed_rpm=500.0) == refused(60254, direction=wrong, preferred=word)
    bench.run(400)
    assert bench.event_texts()[0] == f"P-ERR-60254 spindle s: {reason}; the spindle stops on its ramp (ErrorStop)"
    assert_speeds(bench, 300, 700, preferred * 1200.0, 0.0)
    assert set(bench.column("state")[300:]) == {S.ERROR_STOP} and set(bench.column("error_id")[300:]) == {60254}
    assert set(bench.column("mode")[300:]) == {SpindleMode.STOP}


# ---------------------------------------------------------------- reset and faults


def turning_in_error(**changes: Any) -> UnitBench:
    bench = spindle_bench(**changes)
    bench.accepted("start", direction="cw", speed_rpm=1200.0)
    bench.run(300)
    bench.accepted("upstream_lost", source="channel")
    return bench


def test_watchdog_stops_on_the_ramp_of_the_spindle() -> None:
    bench = turning_in_error()
    bench.run(300)
    assert bench.event_texts() == [
        "P-ERR-26101 spindle s: no block of 'channel' came within the watchdog time; the spindle stops on its ramp "
        "(ErrorStop)"
    ]
    assert_speeds(bench, 300, 600, 1200.0, 0.0)
    bench.accepted("upstream_lost", source="plc")
    bench.run(10)
    assert len(bench.events) == 1


def test_commands_in_error_stop() -> None:
    bench = turning_in_error()
    bench.run(50)
    assert bench.refusal("start", direction="cw", speed_rpm=100.0) == refused(24003, state="ErrorStop", error=26101)
    assert bench.refusal("reset") == refused(24004)
    assert bench.accepted("stop") == "" and bench.accepted("set_override", percent=50.0) == ""
    bench.run(300)
    assert_speeds(bench, 300, 650, 1200.0, 0.0)
    assert bench.state == S.ERROR_STOP
    bench.accepted("reset")
    bench.run(10)
    assert (bench.state, bench.column("error_id")[-1]) == (S.STANDSTILL, 0)
    bench.accepted("start", direction="cw", speed_rpm=100.0)


def test_reset_without_error_stops_the_spindle() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="ccw", speed_rpm=600.0)
    bench.run(200)
    bench.accepted("reset")
    bench.run(300)
    assert_speeds(bench, 200, 500, -600.0, 0.0)
    assert bench.state == S.STANDSTILL


def test_following_error_fault() -> None:
    bench = spindle_bench(kv=50.0, following_error_monitoring=True, following_error_limit=100.0)
    bench.accepted("start", direction="cw", speed_rpm=1200.0)
    bench.run(600)
    cycle = bench.events[0].cycle
    error = bench.column("following_error_deg")
    assert error[cycle - 1] <= 100.0 < error[cycle]
    assert bench.event_texts() == [
        f"P-ERR-17744 spindle s: following error {error[cycle]:.4f} deg exceeds 100.0 deg (P-AXIS-00168); "
        "the spindle stops on its ramp (ErrorStop)"
    ]
    assert bench.column("state")[cycle] == S.ERROR_STOP and bench.column("set_speed_rpm")[-1] == 0.0


def test_a_spindle_without_power() -> None:
    bench = spindle_bench(powered_at_start=False)
    assert bench.refusal("start", direction="cw", speed_rpm=100.0) == refused(24003, state="Disabled")
    for command in ("stop", "reset"):
        assert bench.accepted(command) == ""
    bench.accepted("upstream_lost", source="plc")
    bench.run(10)
    assert set(bench.column("state")) == {S.DISABLED} and len(bench.events) == 1  # of the refusal


@pytest.mark.parametrize("count", [1, 7, 50])
def test_the_block_size_changes_no_number(count: int) -> None:
    benches = [spindle_bench(count=n) for n in (10, count)]
    for bench in benches:
        bench.accepted("start", direction="cw", speed_rpm=1234.5)
        bench.run(350)
        bench.accepted("stop")
        bench.run(350)
    assert benches[0].columns() == benches[1].columns()
