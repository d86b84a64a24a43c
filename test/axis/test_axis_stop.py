"""Stop, halt and emergency stop against closed forms. Source: TX1250 2.2."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import inf, nan

import pytest
from axis_motion_support import expected, motion, ramp_way, run_to_standstill, start, started, to_rest
from axis_states_support import A, J, V, error_ramp, held
from error_support import refused
from machine_support import CYCLE_TIME, UnitBench, assert_axis_smooth, axis_bench, position_after, seven_phases
from superposition_support import feed, generator

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.blocks import arguments_of

JOB, STOPPED = StatusBit.HAS_JOB, StatusBit.HAS_BEEN_STOPPED

# ---------------------------------------------------------------- stop


@pytest.mark.parametrize("cycle", [10, 90, 250, 450, 800])
def test_stop_takes_the_ramp_of_the_start(cycle: int) -> None:
    """The axis' own deceleration (1000) is weaker than the one that the start asked for."""
    bench = axis_bench(deceleration=1000.0, jerk=10_000.0)
    start(bench, 5000.0)
    bench.run(cycle)
    velocity = position_after(seven_phases(5000.0, V, A, A, J), cycle * CYCLE_TIME)[1]
    bench.accepted("stop")
    bench.run(1500)
    states = bench.column("state")
    assert states[cycle] == S.STOPPING
    standing = states.index(S.STANDSTILL, cycle)
    assert bench.column("set_velocity")[standing - 1 :][:2][1] == 0.0
    assert (standing - cycle) * CYCLE_TIME <= velocity / A + 3 * A / J + CYCLE_TIME
    bits = bench.column("status_bits")
    assert not bits[cycle] & JOB and bits[cycle] & STOPPED and bits[-1] & STOPPED
    assert_axis_smooth(bench, acceleration=A, jerk=J)


def test_stop_in_the_cruise_takes_the_closed_form_way() -> None:
    bench = axis_bench()
    start(bench, 5000.0)
    bench.run(1000)
    before = ramp_way(0.0, V) + 0.5 * V
    bench.accepted("stop")
    bench.run(1000)
    assert bench.column("set_position")[-1] == pytest.approx(before + ramp_way(V, 0.0), abs=1e-9)
    assert bench.column("state").index(S.STANDSTILL) == pytest.approx(1500, abs=1)


def test_stop_in_the_brake_phase_ends_exactly_at_the_target() -> None:
    bench = axis_bench()
    start(bench, 1000.0)
    bench.run(800)
    bench.accepted("stop")
    bench.run(500)
    assert bench.column("set_position")[-1] == 1000.0 and bench.state == S.STANDSTILL


def test_a_start_after_a_stop_begins_where_the_axis_stands_and_clears_the_bit() -> None:
    bench = axis_bench()
    start(bench, 5000.0)
    bench.run(600)
    bench.accepted("stop")
    bench.run(1000)
    stand = bench.column("set_position")[-1]
    start(bench, 0.0)
    bench.run(3000)
    assert bench.column("set_position")[1600] == stand and bench.column("set_position")[-1] == 0.0
    assert bench.column("status_bits")[1599] & STOPPED and not bench.column("status_bits")[1600] & STOPPED


def test_stop_while_override_0_holds_the_job() -> None:
    bench = axis_bench()
    bench.accepted("set_override", percent=0.0)
    start(bench, 1000.0)
    bench.run(10)
    bench.accepted("stop")
    bench.run(10)
    assert bench.state == S.STANDSTILL and not bench.column("status_bits")[-1] & JOB
    bench.accepted("set_override", percent=100.0)
    bench.run(10)
    assert bench.column("set_position")[-1] == 0.0


def test_override_does_not_change_a_stop() -> None:
    bench, undisturbed = axis_bench(), axis_bench()
    for each in (bench, undisturbed):
        start(each, 5000.0)
        each.run(700)
        each.accepted("stop")
        each.run(50)
    assert bench.accepted("set_override", percent=10.0) == (
        "axis x: override 10.0 % does not change the active motion (the axis stops)"
    )
    for each in (bench, undisturbed):
        each.run(1000)
    assert bench.column("set_position") == undisturbed.column("set_position")


@pytest.mark.parametrize("first", ["stop", "halt"])
@pytest.mark.parametrize("cycle", [800, 990])
def test_in_the_brake_phase_the_table_stays_to_the_bit(first: str, cycle: int) -> None:
    bench, undisturbed = started(1000.0, cycle), started(1000.0, cycle)
    bench.accepted(first)
    for each in (bench, undisturbed):
        each.run(1)
    bench.accepted("stop")
    for each in (bench, undisturbed):
        each.run(500)
    assert motion(bench) == motion(undisturbed) and bench.column("set_position")[-1] == 1000.0


# ---------------------------------------------------------------- halt


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("cycle", [10, 90, 250, 450, 800])
def test_a_halt_is_the_ramp_of_a_stop_without_its_lock(cycle: int, direction: float) -> None:
    halted, stopped = started(direction * 5000.0, cycle), started(direction * 5000.0, cycle)
    halted.accepted("halt")
    stopped.accepted("stop")
    for each in (halted, stopped):
        each.run(1000)
    assert motion(halted) == motion(stopped)
    states, bits = halted.column("state"), halted.column("status_bits")
    assert S.STOPPING not in states and states[cycle] == S.DISCRETE_MOTION and states[-1] == S.STANDSTILL
    assert states.index(S.STANDSTILL) == stopped.column("state").index(S.STANDSTILL)
    assert not bits[cycle] & JOB and bits[cycle] & STOPPED and bits[-1] & STOPPED


def test_after_a_halt_a_start_is_possible_and_a_new_target_is_not() -> None:
    bench = started(3000.0, 700)
    bench.accepted("halt")
    run_to_standstill(bench)
    assert "no positioning is active (the axis is in Standstill)" in bench.refused("new_target", target=0.0)
    start(bench, 0.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 0.0


# ---------------------------------------------------------------- emergency stop


STRONG = {"deceleration": 20_000.0, "jerk": 500_000.0}


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("cycle", [10, 90, 250, 450, 480, 800])
def test_the_ramp_of_an_emergency_stop(cycle: int, direction: float) -> None:
    """Every cycle against Ruckig's stop; from 2000 mm/s it takes 2000/20000 + 20000/500000 s."""
    bench = started(direction * 5000.0, cycle)
    assert bench.accepted("emergency_stop", **STRONG) == ""
    bench.run(600)
    state = position_after(seven_phases(5000.0, V, A, A, J), cycle * CYCLE_TIME)
    p, v, a = (direction * x for x in state)
    ours = motion(bench)[cycle:]
    for k, (place, velocity, _) in enumerate(expected([to_rest((p, v, a), 20_000.0, 500_000.0)], len(ours))):
        assert ours[k][0] == pytest.approx(place, abs=1e-6) and ours[k][1] == pytest.approx(velocity, abs=1e-3)
    states = bench.column("state")
    assert states[cycle] == S.STOPPING and states[-1] == S.STANDSTILL
    assert bench.column("status_bits")[-1] & STOPPED
    if cycle == 800:
        assert states.index(S.STANDSTILL) == pytest.approx(cycle + 140, abs=1.1)
        distance = ramp_way(V, 0.0, 20_000.0, 500_000.0)
        assert bench.column("set_position")[-1] == pytest.approx(
            direction * (ramp_way(0, V) + 0.3 * V + distance), abs=1e-6
        )
    assert_axis_smooth(bench, acceleration=20_000.0, jerk=500_000.0)


def correction(name: str, value: object, used: float) -> str:
    """The warning about a value that the ramp does not have."""
    unit = "mm/s²" if name == "deceleration" else "mm/s³"
    if value is None:
        return f"{name} is not given; {used} {unit} of the start is used"
    if isinstance(value, float) and value > 0.0:
        return f"{name} {value} {unit} is less than {used} {unit} of the start, which is used"
    return f"{name} = {value} must be greater than 0; {used} {unit} of the start is used"


WARNING = "P-WARN-23016 axis x: emergency_stop: "
WEAK_OR_INVALID = [4999.9, 1e-300, 0.0, -1.0, -0.0, nan, -inf, None, "", "fast", [1.0]]


@pytest.mark.parametrize("jerk", [50_000.0, 500_000.0, 1.0, 0.0, nan, None])
@pytest.mark.parametrize("deceleration", [5000.0, 10_000.0, *WEAK_OR_INVALID])
def test_an_emergency_stop_stops_with_the_larger_of_what_is_given_and_the_start(
    deceleration: object, jerk: object
) -> None:
    """10,000 mm/s² with the jerk of the start (5000, 50,000) is one of them. The distance is that of the closed form."""
    bench = started(5000.0, 800)
    given = {"deceleration": deceleration, "jerk": jerk}
    a, j = (
        x if isinstance(x, float) and x >= least else least for x, least in zip(given.values(), (A, J), strict=True)
    )
    values = {name: value for name, value in given.items() if value is not None}
    corrections = [
        correction(name, value, used)
        for (name, value), used in zip(given.items(), (a, j), strict=True)
        if value != used
    ]
    assert bench.accepted("emergency_stop", **values) == (WARNING + "; ".join(corrections) if corrections else "")
    run_to_standstill(bench)
    distance = ramp_way(V, 0.0, a, j)
    assert bench.column("set_position")[-1] == pytest.approx(ramp_way(0.0, V) + 0.3 * V + distance, abs=1e-6)
    assert bench.column("state")[800] == S.STOPPING and bench.column("status_bits")[-1] & STOPPED
    assert_axis_smooth(bench, acceleration=a, jerk=j)


@pytest.mark.parametrize("start_values", [(30_000.0, 600_000.0), (100.0, 2000.0)])
@pytest.mark.parametrize("given", [(20_000.0, 1e6), (40_000.0, 500_000.0), (1.0, 1.0), (45_000.0, 2e6)])
def test_the_dynamics_of_the_start_count_and_not_those_of_the_axis(
    start_values: tuple[float, float], given: tuple[float, float]
) -> None:
    bench = axis_bench(count=100)
    start(bench, 20_000.0, deceleration=start_values[0], jerk=start_values[1])
    bench.run(700)
    bench.accepted("emergency_stop", deceleration=given[0], jerk=given[1])
    run_to_standstill(bench)
    used = tuple(map(max, given, start_values))
    cycles = to_rest(motion(bench)[700], *used).duration / CYCLE_TIME
    assert bench.column("state").index(S.STANDSTILL) == pytest.approx(700 + cycles, abs=1.1)
    assert_axis_smooth(bench, acceleration=max(used[0], A), jerk=used[1])


def test_an_emergency_deceleration_above_the_maximum_is_the_maximum() -> None:
    bench = started(5000.0, 800)
    assert bench.accepted("emergency_stop", deceleration=50_000.5, jerk=5e5) == (
        WARNING + "deceleration 50000.5 mm/s² is above the maximum 50000.0 mm/s² (P-AXIS-00008, P-AXIS-00003), which "
        "is used"
    )
    run_to_standstill(bench)
    assert_axis_smooth(bench, acceleration=50_000.0, jerk=5e5)


def test_a_recorded_emergency_stop_with_nan_and_infinity_stops_in_the_same_way() -> None:
    """JSON has no such numbers; recordings before November 2026 have texts."""
    benches = []
    values = {"deceleration": nan, "jerk": inf}
    shown = {"deceleration": {"$numberDouble": "NaN"}, "jerk": {"$numberDouble": "Infinity"}}
    texts = {"deceleration": "nan", "jerk": "inf"}
    for given, recorded in ((values, shown), (arguments_of(json.dumps(shown)), shown), (texts, texts)):
        bench = started(5000.0, 800)
        record = bench.give("emergency_stop", **given)
        assert record.accepted and json.loads(record.arguments_json) == recorded
        assert record.message == (
            WARNING + "deceleration = nan must be greater than 0; 5000.0 mm/s² of the start is used; "
            "P-WARN-23012 axis x: emergency_stop: jerk inf mm/s³ is above A/T, the acceleration over one cycle; "
            "5000000.0 mm/s³ is used"
        )
        bench.run(1000)
        benches.append(bench)
    assert benches[0].columns() == benches[1].columns() == benches[2].columns() and benches[0].state == S.STANDSTILL


def test_a_number_that_is_too_long_is_the_maximum() -> None:
    bench = started(5000.0, 800)
    assert "which is used" in bench.accepted("emergency_stop", deceleration=10**400, jerk=10**400)
    bench.run(100)
    assert bench.state == S.STANDSTILL and min(bench.column("set_acceleration")) == pytest.approx(-50_000.0)


def test_the_emergency_deceleration_of_the_axis_may_be_above_its_largest_acceleration() -> None:
    bench = axis_bench(max_acceleration=10_000.0, emergency_deceleration=30_000.0)
    start(bench, 5000.0)
    bench.run(700)
    assert bench.accepted("emergency_stop", deceleration=30_000.0, jerk=1e6) == ""


@pytest.mark.parametrize("command", ["halt", "stop"])
@pytest.mark.parametrize(("weak", "strong"), [(500.0, 20_000.0), (1000.0, 8000.0)])
def test_an_emergency_stop_makes_the_ramp_of_a_stop_or_halt_stronger(command: str, weak: float, strong: float) -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=5000.0, velocity=1000.0, acceleration=A, deceleration=weak, jerk=50_000.0)
    bench.run(900)
    bench.accepted(command)
    bench.run(100)
    p, v, _ = motion(bench)[-1]
    assert bench.accepted("emergency_stop", deceleration=strong, jerk=500_000.0) == ""
    bench.run(5)
    assert bench.state == S.STOPPING
    assert bench.accepted("new_target", target=0.0) == "axis x: new_target waits for the end of the stop"
    bench.accepted("emergency_stop", deceleration=strong, jerk=500_000.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] < p + ramp_way(v, 0.0, strong, 500_000.0) + v * 0.002
    assert min(bench.column("set_acceleration")) == pytest.approx(-strong)
    assert_axis_smooth(bench, acceleration=strong, jerk=500_000.0)


def test_an_emergency_stop_takes_a_waiting_target_back_and_makes_the_ramp_stronger() -> None:
    """In one command: 40,000 mm/s² from where the ramp of the stop has led, in closed form, and both remarks."""
    bench = started(5000.0, 800, count=10)
    bench.accepted("stop")
    bench.accepted("new_target", target=0.0)
    bench.run(200)
    taken_back = "axis x: emergency_stop cancels the waiting new target; the axis stops"
    p, v, a = motion(bench)[-1]
    p, v = p + v * CYCLE_TIME + 0.5 * a * CYCLE_TIME**2, v + a * CYCLE_TIME
    assert bench.accepted("emergency_stop", deceleration=40_000.0, jerk=1e7) == taken_back
    run_to_standstill(bench)
    stop = to_rest((p, v, a), 40_000.0, 1e7)
    assert bench.column("set_position")[-1] == pytest.approx(stop.at_time(stop.duration)[0][0], abs=1e-6)
    assert bench.column("state").index(S.STANDSTILL) == pytest.approx(1000 + stop.duration / CYCLE_TIME, abs=1.1)
    assert S.DISCRETE_MOTION not in bench.column("state")[800:]


def test_what_was_corrected_is_told_with_the_target_that_was_taken_back() -> None:
    bench = started(5000.0, 800, count=10)
    bench.accepted("stop")
    bench.accepted("new_target", target=0.0)
    assert bench.accepted("emergency_stop", deceleration=4000.0, jerk=1e6) == (
        WARNING + correction("deceleration", 4000.0, A) + "; "
        "axis x: emergency_stop cancels the waiting new target; the axis stops"
    )


def test_no_emergency_stop_in_the_natural_brake_phase() -> None:
    bench, undisturbed = started(1000.0, 501), started(1000.0, 501)
    assert bench.refusal("emergency_stop", **STRONG) == refused(23017)
    for each in (bench, undisturbed):
        each.run(1000)
    assert bench.columns() == undisturbed.columns()


@pytest.mark.parametrize("mode", ["they move", "they are still to come", "they come to rest"])
def test_an_emergency_stop_in_the_brake_phase_below_external_setpoints(mode: str) -> None:
    """The positioning brakes to 1000 mm; external setpoints at 500 mm/s on top would move the axis on."""
    bench = started(1000.0, 400, count=10)
    bench.accepted("external_enable", mode="relative")
    rows = generator(2000.0, first_cycle=410, velocity=500.0)
    feed(bench, [] if mode == "they are still to come" else rows, 300)
    if mode == "they come to rest":
        bench.accepted("external_disable")
        bench.run(10)
    cycle, (_, v, _) = bench.cycle, motion(bench)[-1]
    assert bench.column("set_acceleration")[-1] < 0.0 and v > 500.0
    assert bench.accepted("emergency_stop", **STRONG) == ""
    feed(bench, rows, 400)
    states, velocity = bench.column("state"), bench.column("set_velocity")
    assert states[cycle] == S.STOPPING and states[-1] == S.STANDSTILL
    assert not any(velocity[cycle + round((v / 20_000.0 + 0.04 + 0.001) / CYCLE_TIME) + 1 :])
    assert bench.column("set_position")[-1] < motion(bench)[cycle][0] + ramp_way(v, 0.0, 20_000.0, 500_000.0) + 1.0


def test_the_brake_phase_begins_where_the_velocity_falls() -> None:
    """168 mm without a stretch at 700 mm/s: at 200 ms the acceleration falls already, at 240 ms the velocity does."""
    for cycle, accepted in ((200, True), (239, True), (241, False)):
        bench = started(168.0, cycle, velocity=1000.0)
        assert bench.give("emergency_stop", **STRONG).accepted is accepted
        run_to_standstill(bench)
        assert (bench.column("set_position")[-1] < 168.0 - 10.0) is accepted
        assert_axis_smooth(bench, acceleration=20_000.0, jerk=500_000.0)


def test_an_emergency_stop_while_override_0_brakes_or_holds() -> None:
    """A hold is no brake phase: the job continues later."""
    for pause in (100, 1000):
        bench = started(5000.0, 700)
        bench.accepted("set_override", percent=0.0)
        bench.run(pause)
        bench.accepted("emergency_stop", **STRONG)
        run_to_standstill(bench)
        assert not bench.column("status_bits")[-1] & JOB
        bench.accepted("set_override", percent=100.0)
        rest = bench.column("set_position")[-1]
        bench.run(500)
        assert bench.column("set_position")[-1] == rest
        assert_axis_smooth(bench, acceleration=20_000.0, jerk=500_000.0)


def test_an_emergency_stop_of_an_axis_that_returns() -> None:
    """The stop that a new target causes is none of the user and may be made stronger."""
    bench = started(5000.0, 700)
    bench.accepted("new_target", target=0.0)
    bench.run(100)
    p, v, a = motion(bench)[-1]
    p, v, a = p + v * CYCLE_TIME, v + a * CYCLE_TIME, a
    assert bench.accepted("emergency_stop", **STRONG) == ""
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] < p + ramp_way(v, 0.0, 20_000.0, 500_000.0) + 1.0
    assert min(bench.column("set_velocity")) >= 0.0


def test_a_waiting_target_after_an_emergency_stop_goes_with_the_dynamics_of_the_start() -> None:
    bench = started(5000.0, 700)
    bench.accepted("emergency_stop", **STRONG)
    bench.run(10)
    assert bench.accepted("new_target", target=0.0) == "axis x: new_target waits for the end of the stop"
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 0.0
    back = bench.column("state").index(S.DISCRETE_MOTION, 700)
    assert max(map(abs, bench.column("set_acceleration")[back:])) <= A * (1 + 1e-12)


@pytest.mark.parametrize(("jerk", "used"), [(1e9, 40_000_000.0), (1e300, 40_000_000.0)])
def test_an_emergency_jerk_above_deceleration_over_cycle_is_rescaled(jerk: float, used: float) -> None:
    """A weak acceleration of the start (10 mm/s²) does not weaken it: the ramp has only a deceleration."""
    bench = axis_bench(count=100)
    start(bench, 30_000.0, acceleration=100.0, deceleration=100.0, jerk=1000.0)
    bench.run(4000)
    assert bench.accepted("emergency_stop", deceleration=40_000.0, jerk=jerk) == (
        f"P-WARN-23012 axis x: emergency_stop: jerk {jerk} mm/s³ is above A/T, the acceleration over one cycle; "
        f"{used} mm/s³ is used"
    )
    velocity = bench.column("set_velocity")[-1]
    bench.run(500)
    assert bench.column("state").index(S.STANDSTILL) - 4000 == pytest.approx(1000.0 * velocity / 40_000.0 + 1, abs=2)


@pytest.mark.parametrize("prepare", [held, error_ramp])
def test_a_stop_never_moves_what_stands_or_weakens_an_error_ramp(prepare: Callable[[UnitBench], None]) -> None:
    bench = axis_bench()
    prepare(bench)
    before = motion(bench)[-1]
    bench.give("stop")
    bench.give("emergency_stop", **STRONG)
    bench.run(1000)
    assert bench.column("set_velocity")[-1] == 0.0
    if prepare is held:
        assert motion(bench)[-1] == before
    assert_axis_smooth(bench, acceleration=A, jerk=J)
