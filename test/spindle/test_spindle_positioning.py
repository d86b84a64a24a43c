"""M19: direction rules, speeds, override, in position, override 0, both ends of a positioning; refusals word for word."""

from __future__ import annotations

import math
import random
from typing import Any

import pytest
from error_support import Refused, refused
from machine_support import UnitBench, spindle_bench, spindle_parameters
from spindle_support import RPM, StuckDrive, bench_of, first_cycle, states, trapezoid

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.spindle_states import SpindleMode


def ended(bench: UnitBench) -> float:
    """Where the spindle has come to rest, in position."""
    assert bench.state == S.STANDSTILL and bench.column("in_position")[-1]
    assert bench.column("actual_position_deg")[-1] == pytest.approx(bench.column("set_position_deg")[-1], abs=0.051)
    assert bench.column("target_position_deg")[-1] == bench.column("set_position_deg")[-1]
    assert bench.column("distance_to_go_deg")[-1] == 0.0
    return float(bench.column("set_position_deg")[-1])


@pytest.mark.parametrize(
    ("start", "position", "direction", "end"),
    [
        (0.0, 100.0, {}, 100.0),
        (0.0, 260.0, {}, -100.0),
        (0.0, 180.0, {}, 180.0),
        (0.0, 260.0, {"direction": "cw"}, 260.0),
        (0.0, 100.0, {"direction": "ccw"}, -260.0),
        (350.0, 10.0, {"direction": "shortest"}, 370.0),
        (725.0, 5.0, {"direction": "cw"}, 725.0),
        (-90.0, 630.0, {}, -90.0),
        (0.0, -45.0, {"direction": "cw"}, 315.0),
    ],
)
def test_from_rest(start: float, position: float, direction: dict[str, str], end: float) -> None:
    """2.3.2: the given direction; none given, the shortest distance."""
    bench = spindle_bench(start_position=start)
    bench.accepted("orient", position_deg=position, speed_rpm=200.0, **direction)
    bench.run(700)
    assert ended(bench) == pytest.approx(end)
    assert states(bench) in ([S.DISCRETE_MOTION, S.STANDSTILL], [S.STANDSTILL])
    assert set(bench.column("mode")) == {SpindleMode.POSITION}


def test_the_time_is_that_of_a_trapezoid() -> None:
    bench = spindle_bench()
    bench.accepted("orient", position_deg=170.0, speed_rpm=400.0)
    bench.run(400)
    stands = first_cycle(bench, "set_position_deg", lambda position: position == 170.0)
    assert stands == math.ceil(trapezoid(170.0, 400.0 * RPM) * 1000.0)
    assert max(bench.column("set_speed_rpm")) == pytest.approx(400.0)


def test_without_a_speed_the_rapid_traverse_counts() -> None:
    bench = spindle_bench(positioning_speed=900.0)
    bench.accepted("orient", position_deg=180.0)
    bench.run(400)
    assert max(bench.column("set_speed_rpm")) == pytest.approx(150.0)
    assert bench.column("programmed_speed_rpm")[10] == 150.0


@pytest.mark.parametrize("direction", ["cw", "ccw"])
def test_from_rotation_in_the_current_direction(direction: str) -> None:
    bench = spindle_bench()
    sign = 1.0 if direction == "cw" else -1.0
    bench.accepted("start", direction=direction, speed_rpm=3000.0)
    bench.run(700)
    bench.accepted("orient", position_deg=100.0, speed_rpm=200.0)
    bench.run(1200)
    speeds = bench.column("set_speed_rpm")[701:]
    assert all(speed * sign >= 0.0 for speed in speeds)
    begin, end = bench.column("set_position_deg")[700], ended(bench)
    least = (3000.0 * RPM) ** 2 / (2.0 * 40_000.0)
    assert least <= (end - begin) * sign < least + 360.0 and math.remainder(end - 100.0, 360.0) == pytest.approx(0.0)


def test_from_rotation_against_the_current_direction() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.run(300)
    bench.accepted("orient", position_deg=30.0, direction="ccw", speed_rpm=200.0)
    bench.run(800)
    speeds = bench.column("set_speed_rpm")[300:]
    turned = next(k for k, speed in enumerate(speeds) if speed < 0.0)
    assert all(speed >= 0.0 for speed in speeds[:turned]) and all(speed <= 0.0 for speed in speeds[turned:])
    assert ended(bench) % 360.0 == pytest.approx(30.0)


@pytest.mark.parametrize("returns", [False, True])
def test_shortest_from_rotation_counts_from_where_it_can_stop(returns: bool) -> None:
    """A goal 100 deg ahead of the stop is reached directly, one 100 deg behind it by a return."""
    bench = spindle_bench(start_position=0.0)
    bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.run(300)
    begin = bench.column("set_position_deg")[-1]
    speed = 600.0 * RPM
    rest = begin + speed * 0.001 + speed**2 / 80_000.0
    goal = rest + (-100.0 if returns else 100.0)
    bench.accepted("orient", position_deg=goal, direction="shortest", speed_rpm=600.0)
    bench.run(800)
    assert ended(bench) == pytest.approx(goal)
    assert (min(bench.column("set_speed_rpm")[300:]) < 0.0) is returns


def test_the_preferred_direction_is_taken_instead_of_the_shorter_way() -> None:
    bench = spindle_bench(preferred_direction=1)
    bench.accepted("orient", position_deg=350.0, speed_rpm=300.0)
    bench.run(700)
    assert ended(bench) == pytest.approx(350.0)


def test_in_position_ends_with_the_next_motion_and_with_a_window_that_is_left() -> None:
    bench = spindle_bench()
    bench.accepted("orient", position_deg=90.0, speed_rpm=200.0)
    bench.run(400)
    reached = first_cycle(bench, "in_position", bool)
    error = bench.column("following_error_deg")
    assert error[reached - 21] > 0.05 >= error[reached - 20] and all(bench.column("in_position")[reached:])
    bench.accepted("start", direction="cw", speed_rpm=100.0)
    bench.run(10)
    assert not any(bench.column("in_position")[400:])


def test_one_positioning_follows_another_in_motion() -> None:
    bench = spindle_bench()
    bench.accepted("orient", position_deg=170.0, speed_rpm=300.0, direction="cw")
    bench.run(50)
    assert 36.0 < bench.column("set_position_deg")[-1] < 45.0  # 40 is too near to stop there
    bench.accepted("orient", position_deg=40.0, speed_rpm=300.0)
    bench.run(600)
    assert ended(bench) == pytest.approx(400.0)


# ---------------------------------------------------------------- override


def test_the_override_scales_the_positioning_speed() -> None:
    bench = spindle_bench()
    bench.accepted("set_override", percent=50.0)
    bench.accepted("orient", position_deg=179.0, speed_rpm=200.0)
    bench.run(150)
    bench.accepted("set_override", percent=100.0)
    bench.run(500)
    speeds = bench.column("set_speed_rpm")
    assert max(speeds[:150]) == pytest.approx(100.0) and max(speeds) == pytest.approx(200.0)
    assert ended(bench) == pytest.approx(179.0)


def test_override_0_holds_the_positioning_and_lets_it_go_on() -> None:
    bench = spindle_bench()
    bench.accepted("orient", position_deg=179.0, speed_rpm=200.0)
    bench.run(60)
    bench.accepted("set_override", percent=0.0)
    bench.run(300)
    held = bench.column("set_position_deg")[-1]
    assert bench.column("set_speed_rpm")[-1] == 0.0 and bench.state == S.DISCRETE_MOTION
    assert 0.0 < held < 179.0 and bench.column("distance_to_go_deg")[-1] == pytest.approx(179.0 - held)
    bench.accepted("set_override", percent=100.0)
    bench.run(400)
    assert ended(bench) == pytest.approx(179.0)


def test_an_override_in_the_brake_phase_changes_nothing() -> None:
    bench, undisturbed = spindle_bench(), spindle_bench()
    for each in (bench, undisturbed):
        each.accepted("orient", position_deg=90.0, speed_rpm=1200.0, direction="cw")
        each.run(60)
    assert bench.column("set_acceleration_deg_s2")[-1] < 0.0
    assert bench.accepted("set_override", percent=20.0) == ""
    bench.run(200)
    undisturbed.run(200)
    assert bench.column("set_position_deg") == pytest.approx(undisturbed.column("set_position_deg"), abs=1e-7)


def test_suppressed_override() -> None:
    """G167, page 26: at 50 % the spindle turns at 500, then 1000, then 3000 at 50 % = 1500 rpm."""
    bench = spindle_bench()
    bench.accepted("set_override", percent=50.0)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(300)
    bench.accepted("suppress_override", enabled=True)
    bench.run(300)
    bench.accepted("suppress_override", enabled=False)
    bench.accepted("start", direction="cw", speed_rpm=3000.0)
    bench.run(400)
    speeds = bench.column("set_speed_rpm")
    assert (speeds[299], speeds[599], speeds[999]) == (500.0, 1000.0, 1500.0)
    suppressed = [bool(bits & 16) for bits in bench.column("status_bits")]
    assert suppressed == [False] * 300 + [True] * 300 + [False] * 400
    assert set(bench.column("override_percent")) == {50.0}


# ---------------------------------------------------------------- refusals and faults


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        (
            {"position_deg": 214_748.4},
            refused(24006, position=214748.4, limit=214748.3647),
        ),
        (
            {"position_deg": 0.0, "speed_rpm": 0.0},
            refused(24001, speed=0.0),
        ),
        (
            {"position_deg": 0.0, "speed_rpm": -5.0},
            refused(24001, speed=-5.0),
        ),
        (
            {"position_deg": 0.0, "speed_rpm": 12_001.0},
            refused(24002, speed=12001.0, limit=12000.0, gear=1),
        ),
        (
            {"position_deg": 0.0, "direction": "left"},
            refused(22001, argument="direction"),
        ),
    ],
)
def test_refused_positionings_change_nothing(arguments: dict[str, Any], wanted: Refused) -> None:
    bench, undisturbed = spindle_bench(), spindle_bench()
    for each in (bench, undisturbed):
        each.accepted("start", direction="cw", speed_rpm=1000.0)
        each.run(100)
    assert bench.refusal("orient", **arguments) == wanted
    for each in (bench, undisturbed):
        each.run(300)
    assert bench.columns() == undisturbed.columns()


def test_positioning_against_the_preferred_direction() -> None:
    bench = spindle_bench(preferred_direction=-1)
    assert bench.refusal("orient", position_deg=0.0, direction="cw") == refused(
        60254, direction="cw", preferred="negative"
    )
    bench.run(10)
    assert bench.state == S.ERROR_STOP
    assert bench.refusal("orient", position_deg=0.0) == refused(24003, state="ErrorStop", error=60254)


def test_a_position_that_is_not_reached_in_time() -> None:
    bench = bench_of(spindle_parameters(target_time=0.3), drive=StuckDrive())
    bench.accepted("orient", position_deg=90.0, speed_rpm=600.0)
    bench.run(800)
    end = trapezoid(90.0, 3600.0) + 0.3
    (event,) = bench.events
    assert event.cycle == math.ceil(end * 1000.0)
    assert bench.event_texts() == [
        "P-ERR-70082 spindle s: 0.3 s after its end the positioning is 90 deg away from its target, more than the "
        "position window 0.05 deg (P-AXIS-00236); the spindle stops on its ramp (ErrorStop)"
    ]
    assert bench.state == S.ERROR_STOP and bench.column("status_bits")[-1] & 128
    bench.accepted("reset")
    bench.run(10)
    assert not bench.column("status_bits")[-1] & 128


def test_a_stop_gives_the_positioning_up() -> None:
    bench = spindle_bench()
    bench.accepted("orient", position_deg=180.0, speed_rpm=300.0)
    bench.run(50)
    bench.accepted("stop")
    bench.run(200)
    assert states(bench) == [S.DISCRETE_MOTION, S.STOPPING, S.STANDSTILL]
    assert not any(bench.column("in_position")) and bench.column("set_position_deg")[-1] < 180.0


def test_seeded_jumps_between_rotation_and_positioning_are_smooth() -> None:
    """Whatever is commanded when: the speed changes by at most A·T a cycle, the position is its integral."""
    draw = random.Random(8)
    bench = spindle_bench()
    for _ in range(60):
        kind = draw.choice(("start", "orient", "orient", "stop", "set_override"))
        if kind == "start":
            bench.accepted("start", direction=draw.choice(("cw", "ccw")), speed_rpm=draw.uniform(0.0, 3000.0))
        elif kind == "orient":
            direction = draw.choice(({}, {"direction": "cw"}, {"direction": "ccw"}, {"direction": "shortest"}))
            bench.accepted(
                "orient", position_deg=draw.uniform(0, 360), speed_rpm=draw.uniform(10.0, 900.0), **direction
            )
        elif kind == "stop":
            bench.accepted("stop")
        else:
            bench.give("set_override", percent=draw.choice((0.0, 30.0, 100.0, 140.0)))
        bench.run(draw.randint(5, 300))
    speeds, positions = bench.column("set_speed_rpm"), bench.column("set_position_deg")
    for k in range(len(speeds) - 1):
        assert abs(speeds[k + 1] - speeds[k]) * RPM <= 40.0 * (1.0 + 1e-9) + 1e-7, k
        distance = 0.0005 * RPM * (speeds[k] + speeds[k + 1])
        assert positions[k + 1] - positions[k] == pytest.approx(distance, abs=0.25 * 76_000.0 * 1e-6 + 1e-7), k


@pytest.mark.parametrize("count", [1, 7, 50])
def test_the_block_size_changes_no_number(count: int) -> None:
    benches = [spindle_bench(count=n, referenced_at_start=False, zero_pulse=50.0) for n in (10, count)]
    for bench in benches:
        bench.accepted("start", direction="cw", speed_rpm=1234.5)
        bench.run(350)
        bench.accepted("orient", position_deg=77.0)
        bench.run(2100)
    assert benches[0].columns() == benches[1].columns()
    assert benches[0].column("in_position")[-1]
