"""New target on the fly against Ruckig and closed forms. Source: TX1250 2.3."""

from __future__ import annotations

import pytest
from axis_motion_support import (
    assert_follows,
    legs_to,
    motion,
    ramp_way,
    reachable,
    run_to_standstill,
    start,
    started,
    to_rest,
)
from axis_states_support import A, J, V
from error_support import Refused, refused
from long_support import long
from machine_support import UnitBench, assert_axis_smooth, axis_bench, position_after, seven_phases

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit

JOB, STOPPED = StatusBit.HAS_JOB, StatusBit.HAS_BEEN_STOPPED
FULL_STOP = ramp_way(V, 0.0)
"""Distance of a stop from 2000 mm/s: 500 mm."""


def check_end(bench: UnitBench, target: float) -> None:
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == target
    assert not bench.column("status_bits")[-1] & JOB
    assert max(map(abs, bench.column("set_velocity"))) <= V * (1 + 1e-12)
    assert_axis_smooth(bench, acceleration=A, jerk=J)


# ---------------------------------------------------------------- where the target lies


@pytest.mark.parametrize("direction", [1.0, *long([-1.0])])
@pytest.mark.parametrize("cycle", [1, 250, 700, 1700, *long([60, 450, 1200, 1600, 1890])])
@pytest.mark.parametrize("target", [3000.0, 2500.0, 2999.999, 3001.0, 6000.0, 1000.0, 0.0, -800.0])
def test_new_target_in_every_phase(cycle: int, target: float, direction: float) -> None:
    """Inside, beyond, behind, not to be stopped before; in the acceleration, at V and in the brake phase."""
    state = position_after(seven_phases(3000.0, V, A, A, J), 0.001 * cycle)
    bench = started(3000.0 * direction, cycle)
    assert bench.accepted("new_target", target=target * direction) == ""
    check_end(bench, target * direction)
    p, v, a = (direction * x for x in state)
    assert_follows(bench, cycle, legs_to((p, v, a), target * direction))
    assert set(bench.column("state")[: cycle + 1]) == {S.DISCRETE_MOTION}


@pytest.mark.parametrize("cycle", [1901, 1950, 1990, 1999])
@pytest.mark.parametrize("target", [2500.0, 2999.999, 0.0, 3000.001, 6000.0])
def test_new_target_in_the_last_jerk_of_a_stop(cycle: int, target: float) -> None:
    """There the axis is on the edge of a reversal, and rounding says whether it passes standstill with acceleration."""
    bench = started(3000.0, cycle)
    bench.accepted("new_target", target=target)
    check_end(bench, target)


@pytest.mark.parametrize("beyond", [1e-2, 1e-4])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_just_to_be_stopped_before_and_just_not(beyond: float, sign: float) -> None:
    """At V after 1000 ms the stop ends at 1500 + 500 mm."""
    stop_end = ramp_way(0.0, V) + 0.5 * V + FULL_STOP
    bench = started(5000.0, 1000)
    bench.accepted("new_target", target=stop_end + sign * beyond)
    check_end(bench, stop_end + sign * beyond)
    backwards = min(bench.column("set_velocity"))
    assert backwards >= -1e-9 if sign > 0.0 else backwards < -1e-6
    assert max(bench.column("set_position")) == pytest.approx(stop_end + max(sign, 0.0) * beyond, abs=1e-9)


def test_reversal_of_the_manual() -> None:
    """V 2000, start to 3000, at 2200 mm restart to 2000: the stop ends at 2700, the return of 700 mm reaches 1640."""
    bench = started(3000.0, 1350)
    assert bench.column("set_position")[-1] < 2200.0 <= bench.column("set_position")[-1] + 2.0
    bench.accepted("new_target", target=2000.0)
    check_end(bench, 2000.0)
    assert max(bench.column("set_position")) == pytest.approx(2200.0 + FULL_STOP, abs=1e-6)
    assert min(bench.column("set_velocity")) == pytest.approx(-reachable(200.0 + FULL_STOP), rel=1e-5)


def test_the_same_target_again_changes_the_motion_by_rounding_only() -> None:
    for cycle in (1, 100, 499, 500, 800, 1499, 1500, 1501, 1700, 1999):
        bench, undisturbed = started(3000.0, cycle), started(3000.0, cycle)
        bench.accepted("new_target", target=3000.0)
        for each in (bench, undisturbed):
            each.run(2100 - cycle)
        for ours, theirs in zip(motion(bench), motion(undisturbed), strict=True):
            assert ours[0] == pytest.approx(theirs[0], abs=1e-9) and ours[1] == pytest.approx(theirs[1], abs=1e-6)
        assert bench.column("set_position")[-1] == 3000.0 and bench.state == S.STANDSTILL


@pytest.mark.parametrize("cycle", [300, 1000, 1800])
def test_the_present_position_as_a_target(cycle: int) -> None:
    """It is passed when the command acts, so the axis stops and returns to it."""
    bench = started(3000.0, cycle)
    position = position_after(seven_phases(3000.0, V, A, A, J), 0.001 * cycle)[0]
    bench.accepted("new_target", target=position)
    check_end(bench, position)
    assert max(bench.column("set_position")) > position


def test_again_and_again() -> None:
    """Twenty new targets, also while it returns; the last one counts."""
    bench = started(3000.0, 200)
    for n in range(20):
        bench.accepted("new_target", target=(-1.0) ** n * 1500.0 + 17.0 * n)
        bench.run(90 + 13 * n)
    bench.accepted("new_target", target=123.456)
    check_end(bench, 123.456)


@pytest.mark.parametrize("target", [-200.0, 400.0, 2900.0])
def test_new_target_while_it_returns_from_another(target: float) -> None:
    """During the internal stop and the return."""
    for pause in (1, 50, 250, 420, 700):
        bench = started(3000.0, 400)
        bench.accepted("new_target", target=100.0)
        bench.run(pause)
        bench.accepted("new_target", target=target)
        check_end(bench, target)
        first = position_after(seven_phases(3000.0, V, A, A, J), 0.4)
        before = legs_to(first, 100.0)
        t = 0.001 * pause
        stop = before[0].duration
        state = before[0].at_time(t) if t < stop else before[1].at_time(t - stop)
        p, v, a = (x[0] for x in state)
        assert_follows(bench, 400 + pause, legs_to((p, v, a), target))


# ---------------------------------------------------------------- stop, halt


@pytest.mark.parametrize("cycle", [300, 800])
@pytest.mark.parametrize("pause", [100, *long([0, 250])])
@pytest.mark.parametrize("target", [3000.0, 5000.0, 0.0])
def test_during_a_stop_it_waits_until_the_axis_stands(cycle: int, pause: int, target: float) -> None:
    """Then it continues automatically with the dynamics of the start."""
    bench = started(3000.0, cycle)
    bench.accepted("stop")
    bench.run(pause)
    assert bench.accepted("new_target", target=target) == "axis x: new_target waits for the end of the stop"
    stop = to_rest(position_after(seven_phases(3000.0, V, A, A, J), 0.001 * cycle))
    rest = stop.at_time(stop.duration)[0][0]
    check_end(bench, target)
    position, states, bits = (bench.column(name) for name in ("set_position", "state", "status_bits"))
    restart = next(k for k in range(cycle, len(states)) if states[k] == S.DISCRETE_MOTION)
    assert set(states[cycle:restart]) == {S.STOPPING} and position[restart] == pytest.approx(rest, abs=1e-9)
    assert restart - cycle == pytest.approx(stop.duration * 1000.0, abs=1.01)
    assert all(bits[k] & STOPPED and not bits[k] & JOB for k in range(cycle, restart))
    assert bits[restart] & JOB and not bits[restart] & STOPPED
    sign = 1.0 if target > rest else -1.0
    phases = seven_phases(abs(target - rest), min(V, reachable(abs(target - rest))), A, A, J)
    for k in range(restart, len(position)):
        assert position[k] == pytest.approx(rest + sign * position_after(phases, 0.001 * (k - restart))[0], abs=1e-6)


@pytest.mark.parametrize("again", ["stop", "halt"])
def test_another_stop_takes_it_back(again: str) -> None:
    bench, undisturbed = started(3000.0, 700), started(3000.0, 700)
    for each in (bench, undisturbed):
        each.accepted("stop")
        each.run(50)
    bench.accepted("new_target", target=0.0)
    bench.run(50)
    assert bench.accepted(again) == f"axis x: {again} cancels the waiting new target; the axis stops"
    bench.run(1000)
    undisturbed.run(1050)
    assert bench.columns() == undisturbed.columns() and bench.state == S.STANDSTILL


def test_the_last_of_several_waiting_targets_counts() -> None:
    bench = started(3000.0, 700)
    bench.accepted("stop")
    for target in (10.0, -500.0, 4000.0):
        bench.accepted("new_target", target=target)
        bench.run(20)
    check_end(bench, 4000.0)
    assert min(bench.column("set_velocity")) >= -1e-9


def test_power_off_takes_it_back_and_the_axis_stays_where_it_stops() -> None:
    bench, undisturbed = started(3000.0, 700), started(3000.0, 700)
    for each in (bench, undisturbed):
        each.accepted("stop")
        each.run(50)
    bench.accepted("new_target", target=0.0)
    for each in (bench, undisturbed):
        each.accepted("power", enabled=False)
        each.run(2000)
    assert bench.columns() == undisturbed.columns() and bench.state == S.DISABLED


def test_an_error_takes_it_back() -> None:
    bench = started(3000.0, 700)
    bench.accepted("stop")
    bench.accepted("new_target", target=0.0)
    bench.accepted("upstream_lost", source="plc")
    bench.run(2000)
    assert bench.state == S.ERROR_STOP and bench.column("set_velocity")[-1] == 0.0
    assert bench.column("set_position")[-1] == pytest.approx(ramp_way(0, V) + 0.2 * V + FULL_STOP, abs=1e-6)


@pytest.mark.parametrize("target", [3000.0, 5000.0, 1000.0])
@pytest.mark.parametrize("pause", [0, 120, 499])
def test_during_a_halt_it_acts_at_once(target: float, pause: int) -> None:
    bench = started(3000.0, 700)
    bench.accepted("halt")
    bench.run(pause)
    assert bench.accepted("new_target", target=target) == ""
    check_end(bench, target)
    stop = to_rest(position_after(seven_phases(3000.0, V, A, A, J), 0.7))
    p, v, a = (x[0] for x in stop.at_time(0.001 * pause))
    assert_follows(bench, 700 + pause, legs_to((p, v, a), target))
    assert not bench.column("status_bits")[700 + pause] & STOPPED
    assert set(bench.column("state")[: 700 + pause + 1]) == {S.DISCRETE_MOTION}


def test_after_a_stop_that_follows_a_halt_it_waits() -> None:
    bench = started(3000.0, 700)
    bench.accepted("halt")
    bench.run(50)
    bench.accepted("stop")
    assert bench.accepted("new_target", target=0.0) == "axis x: new_target waits for the end of the stop"
    bench.run(400)
    assert bench.column("set_velocity")[-1] > 0.0 and bench.state == S.STOPPING
    check_end(bench, 0.0)


# ---------------------------------------------------------------- override


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("target", [4000.0, 500.0, -700.0])
def test_while_override_0_holds_the_job(kind: int, target: float) -> None:
    bench = started(3000.0, 700, override_type=kind)
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)
    rest = bench.column("set_position")[-1]
    assert bench.accepted("new_target", target=target) == ""
    bench.run(500)
    assert set(bench.column("set_position")[1700:]) == {rest} and bench.column("status_bits")[-1] & JOB
    bench.accepted("set_override", percent=100.0)
    check_end(bench, target)
    assert_follows(bench, 2200, legs_to((rest, 0.0, 0.0), target))


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_the_place_where_override_0_holds_it_as_a_target_ends_the_job(kind: int) -> None:
    bench = started(3000.0, 700, override_type=kind)
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)
    bench.accepted("new_target", target=bench.column("set_position")[-1])
    bench.run(10)
    assert bench.state == S.STANDSTILL and not bench.column("status_bits")[-1] & JOB


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("target", [6000.0, 0.0])
def test_the_override_lives_on_through_new_targets(kind: int, target: float) -> None:
    """50 % of 2000; during the return over 900 mm of these, or for types 1 and 3 of what this distance can reach."""
    bench = axis_bench(count=100, override_type=kind)
    bench.accepted("set_override", percent=50.0)
    start(bench, 3000.0)
    bench.run(900)
    bench.accepted("new_target", target=target)
    check_end(bench, target)
    velocity = bench.column("set_velocity")
    assert max(map(abs, velocity)) == pytest.approx(1000.0) and set(bench.column("override_percent")) == {50.0}
    back = target < 1000.0 and kind in (1, 3)
    assert max(map(abs, velocity[1500:])) == pytest.approx(0.5 * reachable(900.0) if back else 1000.0, rel=1e-6)


@pytest.mark.parametrize("kind", [1, 2])
def test_an_unreachable_velocity_becomes_reachable_again(kind: int) -> None:
    """800 mm reach 1765.56 of the 2000 mm/s asked for; 5000 mm reach them, and half of them with 50 %."""
    short, long = started(800.0, 250, override_type=kind), started(800.0, 250, override_type=kind)
    run_to_standstill(short)
    assert max(short.column("set_velocity")) == pytest.approx(reachable(800.0), rel=1e-6)
    long.accepted("new_target", target=5000.0)
    long.run(1000)
    assert max(long.column("set_velocity")) == pytest.approx(V)
    assert long.accepted("set_override", percent=50.0) == ""
    long.run(600)
    assert long.column("set_velocity")[-1] == pytest.approx(0.5 * V)
    check_end(long, 5000.0)


# ---------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("target", "wanted"),
    [
        (
            4000.5,
            refused(120002, target=4000.5, limit=4000.0),
        ),
        (
            -0.5,
            refused(120003, target=-0.5, limit=0.0),
        ),
        (float("nan"), refused(22001, argument="target")),
    ],
)
@pytest.mark.parametrize("command", [None, "stop", "halt"])
def test_a_refused_target_leaves_the_motion_to_the_bit(target: float, wanted: Refused, command: str | None) -> None:
    benches = []
    for _ in range(2):
        bench = axis_bench(count=100, soft_limit_negative=0.0, soft_limit_positive=4000.0)
        start(bench, 3000.0)
        bench.run(700)
        if command is not None:
            bench.accepted(command)
            bench.run(50)
        benches.append(bench)
    assert benches[0].refusal("new_target", target=target) == wanted
    for bench in benches:
        bench.run(2000)
    assert benches[0].columns() == benches[1].columns()


@pytest.mark.parametrize("command", [None, "stop"])
def test_a_target_out_of_all_range_on_an_axis_without_soft_limits(command: str | None) -> None:
    """It must neither be taken into the motion, nor wait for the end of a stop and fail there."""
    benches = []
    for _ in range(2):
        bench = axis_bench(count=100, soft_limit_negative=-float("inf"), soft_limit_positive=float("inf"))
        start(bench, 3000.0)
        bench.run(700)
        bench.accepted("new_velocity_and_target", velocity=500.0, target=3000.0, activation_position=2000.0)
        if command is not None:
            bench.accepted(command)
        benches.append(bench)
    assert benches[0].refusal("new_target", target=-1e300) == refused(23002, target=-1e300, limit=1000000000000.0)
    for bench in benches:
        bench.run(3000)
    assert benches[0].columns() == benches[1].columns()


# ---------------------------------------------------------------- blocks


@pytest.mark.parametrize("count", [1, 7, 1000])
def test_the_block_size_changes_no_number(count: int) -> None:
    benches = []
    for size in (10, count):
        bench = started(3000.0, 400, count=size)
        bench.accepted("new_target", target=100.0)
        bench.run(333)
        bench.accepted("stop")
        bench.accepted("new_target", target=2500.0)
        bench.run(711)
        bench.accepted("halt")
        bench.run(37)
        bench.accepted("new_target", target=-500.0)
        bench.run(2500)
        benches.append(bench)
    assert benches[0].columns() == benches[1].columns()
    assert benches[0].column("set_position")[-1] == -500.0
