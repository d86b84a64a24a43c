"""Controlled spindles in open position loop: three ways to acknowledge a speed, scaling, 70252 (TF5200 spindle 2.2.4)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from error_support import refused
from machine_support import UnitBench, spindle_bench, spindle_parameters
from spindle_support import bench_of, first_cycle, states

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.spindle_states import SpindleBit

TERMINAL = 32767 / 18_000.0
"""Page 17: 32767 digits (10 V) turn the motor at 3000 rpm; digits at 1 °/s."""
ONE_AN_RPM = 1 / 6.0
"""Page 18: 1 digit is 1 rpm."""


def open_loop(feedback: str, digits_per_deg_s: float = TERMINAL, **changes: Any) -> UnitBench:
    referenced = feedback == "POSITION"
    parameters = {
        "open_loop": True,
        "feedback": feedback,
        "digits_per_deg_s": digits_per_deg_s,
        "referenced_at_start": referenced,
        **changes,
    }
    return bench_of(spindle_parameters(**parameters))


@pytest.mark.parametrize(
    ("digits_per_deg_s", "rpm", "output"),
    [
        (TERMINAL, 3000.0, 32767),
        (TERMINAL, 1500.0, 16384),
        (TERMINAL, 300.0, 3277),
        (ONE_AN_RPM, 750.0, 750),
        (ONE_AN_RPM, 1.0, 1),
    ],
)
@pytest.mark.parametrize("direction", ["cw", "ccw"])
def test_the_drive_output_of_the_manuals_examples(
    digits_per_deg_s: float, rpm: float, output: int, direction: str
) -> None:
    bench = open_loop("NONE", digits_per_deg_s)
    bench.accepted("start", direction=direction, speed_rpm=rpm)
    bench.run(700)
    assert bench.column("drive_output")[-1] == (output if direction == "cw" else -output)
    assert bench.column("drive_output")[0] == 0


def test_the_drive_turns_as_fast_as_its_digital_value_says() -> None:
    bench = open_loop("SPEED", ONE_AN_RPM)
    bench.accepted("start", direction="cw", speed_rpm=750.4)
    bench.run(700)
    assert bench.column("drive_output")[-1] == 750 and bench.column("actual_speed_rpm")[-1] == pytest.approx(750.0)


def test_a_closed_loop_shows_its_output_in_digits_of_the_converter() -> None:
    """P-AXIS-00129 / 00128: 2000 digits at 1000 °/min."""
    bench = spindle_bench()
    bench.accepted("start", direction="ccw", speed_rpm=500.0)
    bench.run(700)
    assert bench.column("drive_output")[-1] == -2000 * 500 * 360 / 1000


def test_a_reversed_drive_gets_the_opposite_sign() -> None:
    plain, reversed_drive = spindle_bench(), spindle_bench(reversed=True)
    for bench in (plain, reversed_drive):
        bench.accepted("start", direction="cw", speed_rpm=500.0)
        bench.run(200)
        bench.accepted("orient", position_deg=90.0)
        bench.run(300)
    outputs = plain.columns(), reversed_drive.columns()
    assert outputs[0].pop("drive_output") == [-value for value in outputs[1].pop("drive_output")]
    assert outputs[0] == outputs[1]


def test_without_feedback_the_internal_speed_acknowledges() -> None:
    """Reached as soon as the setpoint is in the band, although the drive lags behind."""
    bench = open_loop("NONE", drive_time_constant=0.5)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(400)
    reached = first_cycle(bench, "speed_reached", bool)
    assert reached == first_cycle(bench, "set_speed_rpm", lambda speed: speed >= 900.0)
    column = bench.columns()
    assert column["actual_speed_rpm"] == column["set_speed_rpm"] and set(column["following_error_deg"]) == {0.0}
    assert all(bits & SpindleBit.MONITORING_INVALID for bits in column["status_bits"])


def test_with_speed_feedback_the_actual_speed_acknowledges() -> None:
    bench = open_loop("SPEED", drive_time_constant=0.5)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(2500)
    reached = first_cycle(bench, "speed_reached", bool)
    assert reached == first_cycle(bench, "actual_speed_rpm", lambda speed: speed >= 900.0) > 1000
    assert not any(bits & SpindleBit.MONITORING_INVALID for bits in bench.column("status_bits"))


def test_with_position_feedback_the_speed_comes_from_two_positions() -> None:
    bench = open_loop("POSITION", encoder_increment=0.01)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(500)
    actual, positions = bench.column("actual_speed_rpm"), bench.column("actual_position_deg")
    for k in range(1, 500):
        assert actual[k] * 6.0 == pytest.approx((positions[k] - positions[k - 1]) / 0.001, abs=1e-6)
    assert first_cycle(bench, "speed_reached", bool) == first_cycle(
        bench, "actual_speed_rpm", lambda speed: speed >= 900.0
    )
    assert not any(bits & SpindleBit.POSITION_CONTROL for bits in bench.column("status_bits"))


@pytest.mark.parametrize("feedback", ["SPEED", "NONE"])
def test_without_a_position_there_is_no_m19_and_no_homing(feedback: str) -> None:
    bench = open_loop(feedback)
    bench.accepted("start", direction="cw", speed_rpm=100.0)
    bench.run(100)
    assert bench.refusal("orient", position_deg=0.0) == refused(70252)
    assert bench.refusal("home") == refused(24008)
    bench.run(100)
    assert set(bench.column("state")) == {S.CONTINUOUS_MOTION} and bench.column("set_speed_rpm")[-1] == 100.0
    assert set(bench.column("referenced")) == {False}


def test_with_a_position_m19_closes_the_loop() -> None:
    bench = open_loop("POSITION", 60 / 0.036)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(500)
    bench.accepted("orient", position_deg=90.0, speed_rpm=200.0)
    bench.run(900)
    assert states(bench) == [S.CONTINUOUS_MOTION, S.DISCRETE_MOTION, S.STANDSTILL]
    assert bench.column("in_position")[-1]
    assert bench.column("actual_position_deg")[-1] % 360.0 == pytest.approx(90.0, abs=0.05)
    bench.accepted("home")
    bench.run(1500)
    assert bench.state == S.STANDSTILL and bench.column("referenced")[-1]


def test_the_control_limit_does_not_count_in_the_open_loop() -> None:
    bench = open_loop("POSITION", control_limit=600.0)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(500)
    assert set(bench.column("referenced")) == {True}


def test_a_gear_change_without_a_position_happens_at_rest() -> None:
    parameters = spindle_parameters(open_loop=True, feedback="NONE", referenced_at_start=False)
    parameters = replace(parameters, gears={1: parameters.gears[1], 2: replace(parameters.gears[1], stage=2)})
    bench = bench_of(parameters)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(400)
    bench.accepted("select_gear", stage=2)
    bench.run(300)
    assert bench.last.gear_request == 2 and bench.column("set_speed_rpm")[-1] == 0.0
    bench.accepted("gear_changed")
    bench.run(400)
    assert (bench.column("gear")[-1], bench.column("set_speed_rpm")[-1]) == (2, 1000.0)


@pytest.mark.parametrize("feedback", ["POSITION", "SPEED", "NONE"])
@pytest.mark.parametrize("count", [1, 7])
def test_the_block_size_changes_no_number(feedback: str, count: int) -> None:
    benches = [open_loop(feedback), open_loop(feedback)]
    benches[1].count = count
    for bench in benches:
        bench.accepted("start", direction="cw", speed_rpm=333.0)
        bench.run(350)
        bench.accepted("stop")
        bench.run(350)
    assert benches[0].columns() == benches[1].columns()
