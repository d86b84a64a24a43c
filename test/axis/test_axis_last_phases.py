"""Changes in the last phases of a motion: new targets behind the axis, overrides and stops just before the target.

x of config/ptp.yaml at 1500 mm/s, ±6000 mm/s², 100,000 mm/s³ from 0 to 2000 mm brakes from 1333.3 ms to 1643.3 ms.
"""

from __future__ import annotations

from itertools import pairwise
from math import inf

import pytest
from axis_motion_support import motion, ramp_time, run_to_standstill
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from long_support import examples, long
from machine_support import CYCLE_TIME, UnitBench, assert_axis_smooth, axis_bench, seven_phases

from cnc_ptp.protocol.axis_states import AxisStateCode as S

QUICK = settings(
    max_examples=examples(25), deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
V, A, J = 1500.0, 6000.0, 100_000.0
QUICKLY = {"velocity": V, "acceleration": A, "deceleration": A, "jerk": J}
NEW_VELOCITY = {"velocity": 700.0, "activation_position": 1900.0}


def started(
    target: float, cycles: int, *, override_type: int = 1, position: float = 0.0, **dynamics: float
) -> UnitBench:
    """A bench on its way to `target` since `cycles`."""
    bench = axis_bench(count=100, override_type=override_type, start_position=position)
    bench.accepted("move_absolute", target=target, **{**QUICKLY, **dynamics})
    bench.run(cycles)
    return bench


def reversals(bench: UnitBench) -> list[tuple[float, float]]:
    """The accelerations of the two cycles between which the velocity changes its sign."""
    return [(a, a1) for (_, v, a), (_, v1, a1) in pairwise(motion(bench)) if v * v1 < 0.0 or (v == 0.0 and a != 0.0)]


def assert_rests_before_every_reversal(bench: UnitBench, jerk: float = J) -> None:
    """Where the velocity changes its sign within a cycle, the acceleration is 0 at that instant.

    On both sides of an instant at rest it is no more than what the jerk makes of it in a cycle.
    """
    for before, after in reversals(bench):
        assert abs(before) + abs(after) <= jerk * CYCLE_TIME * (1.0 + 1e-6), (before, after)


# ---------------------------------------------------------------- new target behind the axis


def test_the_numbers_of_the_issue() -> None:
    """At 1620 ms (10 ms after the start at 10 ms) the axis is in the last jerk phase; it turns at 2000 mm exactly."""
    for command in ({}, NEW_VELOCITY):
        bench = axis_bench()
        bench.run(10)
        bench.accepted("move_absolute", target=2000.0, **QUICKLY)
        bench.run(1610)
        assert motion(bench)[-1][1] < 60.0 and motion(bench)[-1][2] > -3500.0
        bench.accepted("new_velocity_and_target" if command else "new_target", target=1850.0, **command)
        run_to_standstill(bench)
        assert_rests_before_every_reversal(bench)
        assert max(bench.column("set_position")) == pytest.approx(2000.0, abs=J * CYCLE_TIME**3)
        way_back = min(bench.column("set_velocity"))
        back = 0.5 * A * (-A / J + ((A / J) ** 2 + 4.0 * 150.0 / A) ** 0.5)
        assert way_back == pytest.approx(-700.0 if command else -back, abs=0.1)
        assert bench.column("set_position")[-1] == 1850.0
        assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("direction", [1.0, *long([-1.0])])
@pytest.mark.parametrize("how", ["brake", "halt", "override 0"])
@pytest.mark.parametrize("part", [0.5, 0.95, *long([0.0, 0.9, 0.999])])
@pytest.mark.parametrize("jerk", [J, 10_000.0])
def test_in_every_phase_of_a_brake_the_axis_rests_before_it_returns(
    part: float, how: str, direction: float, jerk: float
) -> None:
    ramp = ramp_time(V, A, jerk)
    bench = started(direction * 2500.0, round(2500.0 / V / CYCLE_TIME) if how == "brake" else 800, jerk=jerk)
    if how == "halt":
        bench.accepted("halt")
    elif how == "override 0":
        bench.accepted("set_override", percent=0.0)
    bench.run(int(part * ramp / CYCLE_TIME))
    bench.accepted("new_target", target=direction * 100.0)
    bench.accepted("set_override", percent=100.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == direction * 100.0 and len(reversals(bench)) <= 1
    assert_rests_before_every_reversal(bench, jerk)
    assert_axis_smooth(bench, acceleration=A, jerk=jerk)


@QUICK
@given(
    velocity=st.floats(20.0, 2000.0),
    up=st.floats(500.0, 9000.0),
    down=st.floats(500.0, 9000.0),
    jerk=st.floats(5000.0, 500_000.0),
    halt=st.booleans(),
    percent=st.sampled_from([100.0, 30.0, 0.01]),
    later=st.integers(0, 700),
    back=st.floats(1.0, 3000.0),
    new_velocity=st.none() | st.floats(1.0, 2000.0),
)
def test_any_new_target_behind_the_axis_is_reached_after_a_rest(
    velocity: float,
    up: float,
    down: float,
    jerk: float,
    halt: bool,
    percent: float,
    later: int,
    back: float,
    new_velocity: float | None,
) -> None:
    bench = started(3000.0, 300, velocity=velocity, acceleration=up, deceleration=down, jerk=jerk)
    if halt:
        bench.accepted("halt")
    elif percent < 1.0:
        bench.accepted("set_override", percent=percent)
    bench.run(later)
    target = bench.column("set_position")[-1] - back
    request = {"target": target}
    if new_velocity is not None:
        request |= {"velocity": new_velocity, "activation_position": target}
    if not bench.give("new_target" if new_velocity is None else "new_velocity_and_target", **request).accepted:
        assert bench.state == S.STANDSTILL
        return
    bench.run(20)
    bench.accepted("set_override", percent=100.0)
    run_to_standstill(bench, 3_200_000)
    assert bench.column("set_position")[-1] == target and len(reversals(bench)) <= 1
    assert_rests_before_every_reversal(bench, jerk)
    assert_axis_smooth(bench, acceleration=max(up, down), jerk=jerk)


# ---------------------------------------------------------------- far from zero


@pytest.mark.parametrize("position", [0.0, 99_999.0, -99_999.0])
@pytest.mark.parametrize("distance", [0.00009, 1e-7])
@pytest.mark.parametrize("command", ["stop", "halt", "hold", "slower", "emergency_stop"])
def test_a_short_way_far_from_zero_can_be_changed(position: float, distance: float, command: str) -> None:
    """0.00009 mm at 99,999 mm within 1 s: after half of it every command acts as it does at 0."""
    target = position + distance
    bench = started(target, 500, position=position, velocity=distance)
    if command == "hold":
        assert bench.accepted("set_override", percent=0.0) == ""
    elif command == "slower":
        assert bench.accepted("set_override", percent=10.0) == ""
    elif command == "emergency_stop":
        bench.accepted("emergency_stop", deceleration=20_000.0, jerk=200_000.0)
    else:
        bench.accepted(command)
    bench.run(400)
    end = bench.column("set_position")[-1]
    assert abs(end - position - (0.54 if command == "slower" else 0.5) * distance) <= 0.02 * distance + 3e-11
    if command == "slower":
        run_to_standstill(bench)
        assert bench.column("set_position")[-1] == target
    elif command == "hold":
        bench.accepted("set_override", percent=100.0)
        run_to_standstill(bench)
        assert bench.column("set_position")[-1] == target
    else:
        assert bench.state == S.STANDSTILL


def test_a_short_rest_on_a_modulo_axis_far_from_zero_can_be_stopped() -> None:
    """0.0009° at 1e6°."""
    bench = axis_bench(count=100, modulo=True, modulo_high=360.0, start_position=1e6, soft_limit_positive=inf)
    bench.accepted("move_absolute", target=1e6 + 0.0009, velocity=0.0009)
    bench.run(400)
    bench.accepted("stop")
    bench.run(700)
    assert bench.state == S.STANDSTILL
    assert bench.column("set_position")[-1] - 1e6 == pytest.approx(0.4 * 0.0009, rel=0.01)


@pytest.mark.parametrize("position", [0.0, 50_000.0, 99_000.0])
def test_the_brake_phase_begins_in_the_same_cycle_everywhere(position: float) -> None:
    """500 mm: the last cycle in which a stop acts, and the first one in which the table stays, are those at 0."""
    length = 500.0
    phases = seven_phases(length, V, A, A, J)
    begin = sum(duration for duration, _ in phases[:-3]) / CYCLE_TIME
    for cycle, acts in ((int(begin), True), (int(begin) + 1, False)):
        bench = started(position + length, cycle, position=position)
        bench.accepted("stop")
        run_to_standstill(bench)
        short = position + length - bench.column("set_position")[-1]
        assert (short > 0.0) is acts and short == pytest.approx(acts * (begin - cycle) * CYCLE_TIME * V, abs=1e-8)


@pytest.mark.parametrize("position", [0.0, 99_000.0])
@pytest.mark.parametrize("behind", [5e-5, 5e-6])
def test_a_compensation_is_refused_wherever_the_axis_returns(position: float, behind: float) -> None:
    """At 400 ms the stop ends at 367.5 + 232.5 mm, a little behind the target: the axis returns, at 99,000 mm too."""
    bench = started(position + 900.0, 400, position=position)
    bench.accepted("new_target", target=position + 600.0 - behind)
    reason = "the axis stops in order to return to its target"
    compensation = {"length": 10.0, "difference": 1.0, "process_velocity": V, "velocity_increase": 10.0}
    assert bench.refused("compensation_start", **compensation) == (
        f"P-ERR-23020 axis x: compensation_start refused: {reason}; nothing was changed"
    )


# ---------------------------------------------------------------- override just before the brake phase


def jerk_changes(bench: UnitBench) -> int:
    jerks = bench.column("set_jerk")
    return sum(a != b for a, b in pairwise(jerks))


def standing_at(bench: UnitBench) -> int:
    return bench.column("state").index(S.STANDSTILL, 1)


def assert_no_swing(bench: UnitBench) -> None:
    """Between two decelerations the velocity is held, be it for an instant: a comes back to 0."""
    values = bench.column("set_acceleration")
    for k in range(1, len(values) - 1):
        is_top = values[k - 1] < values[k] >= values[k + 1] and values[k] < 0.0
        assert not is_top or values[k] >= -J * CYCLE_TIME, f"a = {values[k]} in cycle {k}"


@pytest.mark.parametrize("kind", [3, 4])
@pytest.mark.parametrize("percent", [90.0, 60.0])
@pytest.mark.parametrize("cycle", [1200, 1320, 1341, 1343, *long([1290, 1335])])
def test_lowered_just_before_the_brake_phase(kind: int, percent: float, cycle: int) -> None:
    """Types 3 and 4 are no later and no rougher than 1 and 2: the level of the old table is the highest."""
    benches = []
    for each in (kind, kind - 2):
        bench = started(2000.0, cycle, override_type=each)
        bench.accepted("set_override", percent=percent)
        run_to_standstill(bench)
        assert_no_swing(bench)
        assert_axis_smooth(bench, acceleration=A, jerk=J)
        benches.append(bench)
    assert standing_at(benches[0]) <= standing_at(benches[1])
    assert jerk_changes(benches[0]) <= jerk_changes(benches[1])


@QUICK
@given(
    kind=st.sampled_from([3, 4]),
    target=st.floats(50.0, 1000.0),
    velocity=st.floats(500.0, 2000.0),
    cycle=st.integers(1, 1000),
    percent=st.floats(30.0, 100.0),
)
def test_types_3_and_4_never_arrive_later(
    kind: int, target: float, velocity: float, cycle: int, percent: float
) -> None:
    benches = []
    for each in (kind, kind - 2):
        bench = started(target, cycle, override_type=each, velocity=velocity)
        bench.give("set_override", percent=percent)
        run_to_standstill(bench, 20_000)
        assert bench.column("set_position")[-1] == target
        assert_no_swing(bench)
        assert_axis_smooth(bench, acceleration=A, jerk=J)
        benches.append(bench)
    assert standing_at(benches[0]) <= standing_at(benches[1]) + 1
