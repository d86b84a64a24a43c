"""Early ends of a position compensation: compensation stop, stop, halt, emergency stop, fault, power off."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from error_support import refused
from long_support import long
from machine_support import CYCLE_TIME, UnitBench
from superposition_support import (
    COMPENSATING,
    HAS_JOB,
    A,
    J,
    assert_no_steps,
    column,
    has_bit,
    moving_axis,
    settle,
)

RISE, FALL = 500.0, 1000.0
VALUES: dict[str, float] = {
    "length": 4000.0,
    "difference": 345.0,  # 200 mm/s: 200·2 - 200²·0.0015 = 340; VK = 200 cuts it to that
    "process_velocity": 2000.0,
    "velocity_increase": 200.0,
    "acceleration": RISE,
    "deceleration": FALL,
}
PEAK = 200.0
PHASES = {"begin": 0, "first cycle": 1, "rise": 150, "hold": 1000, "fall": 1900, "last cycle": 1999}
"""Cycles after the start of the compensation; rise and fall take 0.4 and 0.2 s (0.2 and 0.4 s for D < 0)."""
SMOOTH = {"acceleration": A * 1.1 + FALL, "jerk": J * 1.1 + 2.0 * FALL * A / 2000.0}


def compensating_axis(cycles: int, *, sign: float = 1.0, side: float = 1.0, **changes: Any) -> UnitBench:
    """An axis at 2000 mm/s, `cycles` after the start of its compensation in cycle 1000."""
    bench = moving_axis(target=side * 20_000.0, **changes)
    bench.accepted("compensation_start", **VALUES | {"difference": sign * VALUES["difference"]})
    if cycles:
        bench.run(cycles)
    return bench


def rates(sign: float) -> tuple[float, float]:
    return (RISE, FALL) if sign > 0.0 else (FALL, RISE)


def additional(t: float, sign: float) -> tuple[float, float]:
    """(way, velocity) of the trapezoid after t s, as magnitudes, from its three triangles and rectangles."""
    first, last = rates(sign)
    if t < PEAK / first:
        return 0.5 * first * t * t, first * t
    if t < 2.0 - PEAK / last:
        return PEAK * (t - 0.5 * PEAK / first), PEAK
    left = 2.0 - t
    return PEAK * (2.0 - 0.5 * PEAK / first - 0.5 * PEAK / last) - 0.5 * last * left * left, last * left


# compensation stop


@pytest.mark.parametrize("phase", ["first cycle", "rise", "hold"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("side", [-1.0, *long([1.0])])
def test_compensation_stop_ramps_down_at_once(phase: str, sign: float, side: float) -> None:
    """D becomes what is reached then: the distance so far and w²/(2·last rate)."""
    cycles = PHASES[phase]
    bench = compensating_axis(cycles, sign=sign, side=side)
    assert bench.accepted("compensation_stop") == ""
    settle(bench)
    way, w = additional(cycles * CYCLE_TIME, sign)
    last = rates(sign)[1]
    end = side * (20_000.0 + sign * (way + 0.5 * w * w / last))
    assert bench.column("set_position")[-1] == pytest.approx(end, abs=1e-9)
    stopped = 1000 + cycles
    t = np.arange(1000) * CYCLE_TIME
    expected = 2000.0 + sign * np.maximum(0.0, w - last * t)
    assert side * column(bench, "set_velocity")[stopped : stopped + 1000] == pytest.approx(expected, abs=1e-8)
    over = stopped + max(1, int(np.ceil(round(w / last / CYCLE_TIME, 6))))
    assert np.flatnonzero(has_bit(bench, COMPENSATING))[[0, -1]].tolist() == [1000, over - 1]
    assert_no_steps(bench, **SMOOTH, corners=4)


@pytest.mark.parametrize("phase", ["fall", "last cycle"])
def test_compensation_stop_in_its_brake_phase_is_without_effect(phase: str) -> None:
    bench, undisturbed = (compensating_axis(PHASES[phase]) for _ in range(2))
    assert bench.accepted("compensation_stop") == (
        "axis x: compensation_stop without effect: the compensation is in its brake phase"
    )
    for each in (bench, undisturbed):
        each.run(1000)
    assert bench.columns() == undisturbed.columns()


def test_a_second_compensation_stop_is_without_effect() -> None:
    bench = compensating_axis(1000)
    assert bench.accepted("compensation_stop") == ""
    bench.run(100)
    assert "in its brake phase" in bench.accepted("compensation_stop")
    bench.run(200)
    assert bench.accepted("compensation_stop") == (
        "axis x: compensation_stop without effect: no compensation is active"
    )


def test_compensation_stop_right_at_the_begin_leaves_nothing() -> None:
    bench = compensating_axis(0)
    bench.accepted("compensation_stop")
    settle(bench)
    assert bench.column("set_position")[-1] == 20_000.0
    assert not has_bit(bench, COMPENSATING).any()
    assert_no_steps(bench, acceleration=A, jerk=J, corners=0)


def test_compensation_stop_while_override_0_holds_the_axis() -> None:
    """The ramp down belongs to the way too: it waits for the motion."""
    bench = compensating_axis(1000)
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)
    bench.accepted("compensation_stop")
    bench.run(500)
    assert has_bit(bench, COMPENSATING)[-1]
    assert not column(bench, "set_velocity")[-500:].any()
    bench.accepted("set_override", percent=100.0)
    bench.run(300)
    assert not has_bit(bench, COMPENSATING)[-1]
    settle(bench)
    assert_no_steps(bench, **SMOOTH, corners=4)


@pytest.mark.parametrize("command", ["compensation_stop", "stop"])
def test_a_stop_acts_in_its_own_cycle(command: str) -> None:
    """The setpoint of the cycle itself is still that of the motion before."""
    bench, undisturbed = (compensating_axis(700) for _ in range(2))
    bench.accepted(command)
    for each in (bench, undisturbed):
        each.run(20)
    for name in ("set_position", "set_velocity"):
        assert bench.column(name)[1700] == undisturbed.column(name)[1700]
        assert bench.column(name)[1701] != undisturbed.column(name)[1701]


# ends of the basic motion


@pytest.mark.parametrize("phase", ["rise", "hold", "fall"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("command", ["stop", "halt"])
def test_a_stop_takes_the_compensation_down_with_it(command: str, phase: str, sign: float) -> None:
    """It comes down with its last rate, no faster; the basic motion takes longer. Way: w²/(2·last rate)."""
    cycles = PHASES[phase]
    bench = compensating_axis(cycles, sign=sign)
    bench.accepted(command)
    settle(bench)
    way, w = additional(cycles * CYCLE_TIME, sign)
    last = rates(sign)[1]
    way += 0.5 * w * w / last
    basic = 2000.0 * (1.0 + cycles * CYCLE_TIME - 0.25) + 500.0
    assert bench.column("set_position")[-1] == pytest.approx(basic + sign * way, abs=1e-5)
    assert bench.state == 1 and not has_bit(bench, COMPENSATING | HAS_JOB)[-1]
    assert_no_steps(bench, **SMOOTH, corners=4)


def fault(bench: UnitBench) -> None:
    bench.accepted("upstream_lost", source="plc")


def power_off(bench: UnitBench) -> None:
    bench.accepted("power", enabled=False)


def emergency_stop(bench: UnitBench) -> None:
    bench.accepted("emergency_stop", deceleration=20_000.0, jerk=400_000.0)


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("sign", [-1.0, *long([1.0])])
@pytest.mark.parametrize(("end", "state"), [(fault, 7), (power_off, 0), (emergency_stop, 1)])
@pytest.mark.parametrize("side", [1.0, *long([-1.0])])
def test_every_end_in_every_phase_comes_to_rest_without_a_step(
    end: Any, state: int, phase: str, sign: float, side: float
) -> None:
    bench = compensating_axis(PHASES[phase], sign=sign, side=side)
    end(bench)
    settle(bench)
    stopped = 1000 + PHASES[phase]
    assert bench.state == state
    assert not has_bit(bench, COMPENSATING | HAS_JOB)[-1]
    speed = side * column(bench, "set_velocity")[stopped:]
    assert speed.max() <= 2000.0 + PEAK + 1e-9 and speed.min() >= -1e-9
    strong = {"acceleration": 20_000.0 * 1.1 + FALL, "jerk": 400_000.0 * 1.1}
    assert_no_steps(bench, **(strong if end is emergency_stop else SMOOTH), corners=4)
    standing = column(bench, "set_position")[-100:]
    assert (standing == standing[0]).all()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_fault_takes_over_the_velocity_of_both_and_the_acceleration_of_the_basic_motion(sign: float) -> None:
    """One jerk-limited ramp from v + w, without AK: v/2·(v/A + A/J)."""
    bench = compensating_axis(100, sign=sign)
    fault(bench)
    settle(bench)
    v = 2000.0 + sign * rates(sign)[0] * 0.1
    way = 0.5 * v * (v / A + A / J)
    begin = bench.column("set_position")[1100]
    assert bench.column("set_position")[-1] == pytest.approx(begin + way, abs=1e-7)
    assert bench.event_texts() == [
        "P-ERR-26101 axis x: no block of 'plc' came within the watchdog time; the axis stops on its own ramp (ErrorStop)"
    ]


def test_after_a_fault_the_axis_starts_from_where_it_is() -> None:
    bench = compensating_axis(1000)
    fault(bench)
    settle(bench)
    here = bench.column("set_position")[-1]
    bench.accepted("reset")
    bench.accepted("move_relative", distance=100.0)
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(here + 100.0, abs=1e-9)


def test_a_stop_with_motion_reversal_comes_to_rest() -> None:
    """The compensation has turned the axis round when the stop comes."""
    bench = moving_axis(target=20_000.0)
    bench.accepted(
        "compensation_start",
        length=8000.0,
        difference=-8000.0,
        process_velocity=2000.0,
        velocity_increase=3000.0,
        acceleration=4000.0,
        deceleration=4000.0,
    )
    bench.run(2000)
    assert bench.column("set_velocity")[-1] < -300.0
    bench.accepted("stop")
    settle(bench)
    assert bench.state == 1
    assert_no_steps(bench, acceleration=2.5 * A + 4000.0, jerk=2.5 * J + 4.0 * A, corners=4)


def test_a_new_target_waits_for_the_end_of_the_compensations_ramp_too() -> None:
    """After a halt a new target acts immediately, but not during a compensation."""
    bench = compensating_axis(1000)
    bench.accepted("halt")
    bench.run(100)
    assert bench.refusal("new_target", target=100.0) == refused(23015)
    bench.run(150)
    bench.accepted("new_target", target=100.0)
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(100.0, abs=1e-9)
    assert_no_steps(bench, **SMOOTH, corners=4)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_natural_brake_phase_goes_on_under_a_stop(sign: float) -> None:
    """A compensation that reaches into the brake phase; a stop there ends it, the basic motion arrives."""
    bench = moving_axis(target=5000.0)
    bench.accepted("compensation_start", **VALUES | {"difference": sign * 100.0})
    bench.run(1600)
    assert column(bench, "set_acceleration")[-1] < -1000.0
    way = bench.column("set_position")[-1]
    bench.accepted("stop")
    settle(bench)
    assert bench.state == 1
    assert 0.0 < sign * (bench.column("set_position")[-1] - 5000.0) < 100.0
    assert way < bench.column("set_position")[-1]
    assert_no_steps(bench, **SMOOTH, corners=6)  # two where min(1, v/VP) falls faster than the rates
