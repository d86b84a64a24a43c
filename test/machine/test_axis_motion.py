"""PTP motion of an axis in every cycle: starts, overrides, stops against closed forms."""

from __future__ import annotations

import pytest
from machine_support import (
    CYCLE_TIME,
    UnitBench,
    assert_axis_smooth,
    axis_bench,
    position_after,
    seven_phases,
)

from cnc_ptp.machine.blocks import AxisStateCode as S
from cnc_ptp.machine.blocks import StatusBit

DYNAMICS = {"velocity": 2000.0, "acceleration": 5000.0, "deceleration": 5000.0, "jerk": 50_000.0}
V, A, J = 2000.0, 5000.0, 50_000.0
JOB, STOPPED, CONSTANT, ERROR = (
    StatusBit.HAS_JOB,
    StatusBit.HAS_BEEN_STOPPED,
    StatusBit.CONSTANT_VELOCITY,
    StatusBit.ERROR,
)


def start(bench: UnitBench, target: float, **dynamics: float) -> None:
    assert bench.accepted("move_absolute", target=target, **{**DYNAMICS, **dynamics}) == ""


def duration(phases: list[tuple[float, float]]) -> float:
    return sum(d for d, _ in phases)


def ramp_time(change: float, a: float = A) -> float:
    """Time of a velocity change that reaches a."""
    assert change >= a * a / J
    return change / a + a / J


def ramp_way(v: float, to: float, a: float = A) -> float:
    return 0.5 * (v + to) * ramp_time(abs(to - v), a)


def time_of_arrival(bench: UnitBench) -> float:
    """When DiscreteMotion has ended, s: the first cycle of Standstill after it."""
    states = bench.column("state")
    begin = states.index(S.DISCRETE_MOTION)
    return states.index(S.STANDSTILL, begin) * CYCLE_TIME


# ---------------------------------------------------------------- starts


@pytest.mark.parametrize(
    ("target", "dynamics"),
    [
        (1000.0, {}),  # TX1250 dynamics 1.1: reaches V just so
        (1000.0, {"deceleration": 10_000.0}),  # 1.2
        (1500.0, {"jerk": 100_000.0}),
        (2000.0, {"acceleration": 4000.0, "deceleration": 3000.0, "jerk": 20_000.0}),
        (30.0, {"velocity": 50.0}),  # A is not reached
        (-1000.0, {"deceleration": 10_000.0}),
        (-300.0, {"velocity": 400.0, "jerk": 12_345.0}),
    ],
)
@pytest.mark.parametrize("begin", [0, 20, 130])
def test_every_cycle_is_the_seven_phase_profile(target: float, dynamics: dict[str, float], begin: int) -> None:
    """The setpoint of the command's cycle c stays, set_position[c + k] = profile(k·T)."""
    bench = axis_bench(start_position=7.0)
    bench.run(begin)
    given = {**DYNAMICS, **dynamics}
    start(bench, 7.0 + target, **dynamics)
    phases = seven_phases(abs(target), given["velocity"], given["acceleration"], given["deceleration"], given["jerk"])
    bench.run(2000)
    sign = 1.0 if target > 0.0 else -1.0
    columns = bench.columns()
    for k in range(2000):
        p, v, a = position_after(phases, k * CYCLE_TIME)
        assert abs(columns["set_position"][begin + k] - (7.0 + sign * p)) <= 1e-8
        assert abs(columns["set_velocity"][begin + k] - sign * v) <= 1e-8
        assert abs(columns["set_acceleration"][begin + k] - sign * a) <= 1e-6
    assert time_of_arrival(bench) == pytest.approx(begin * CYCLE_TIME + duration(phases), abs=1.1 * CYCLE_TIME)
    assert bench.column("set_position")[-1] == 7.0 + target
    assert bench.columns()["set_velocity"][-1] == 0.0


def test_jerk_column_is_the_third_derivative() -> None:
    bench = axis_bench()
    start(bench, 1000.0)
    bench.run(1000)
    jerk = bench.column("set_jerk")
    assert jerk[50] == J and jerk[200] == 0.0 and jerk[450] == -J and jerk[550] == -J and jerk[950] == J
    assert set(jerk) == {J, 0.0, -J}


def test_dynamics_left_out_come_from_the_axis_parameters() -> None:
    bench = axis_bench(max_velocity=100.0, reference_velocity=80.0, acceleration=700.0, deceleration=900.0, jerk=9000.0)
    bench.accepted("move_absolute", target=50.0)
    bench.run(2000)
    phases = seven_phases(50.0, 80.0, 700.0, 900.0, 9000.0)
    position = bench.column("set_position")
    for k in range(2000):
        assert position[k] == pytest.approx(position_after(phases, k * CYCLE_TIME)[0], abs=1e-9)


def test_relative_moves_add_up() -> None:
    bench = axis_bench(start_position=-3.5)
    for distance in (10.0, -4.25, 0.5):
        bench.accepted("move_relative", distance=distance, **DYNAMICS)
        bench.run(500)
    assert bench.column("set_position")[-1] == -3.5 + 10.0 - 4.25 + 0.5
    assert bench.state == S.STANDSTILL


def test_numbers_of_yaml_may_be_integers() -> None:
    whole, real = axis_bench(), axis_bench()
    whole.accepted("move_absolute", target=100, velocity=200, acceleration=500, deceleration=500, jerk=5000)
    real.accepted("move_absolute", target=100.0, velocity=200.0, acceleration=500.0, deceleration=500.0, jerk=5000.0)
    whole.accepted("set_override", percent=50)
    real.accepted("set_override", percent=50.0)
    for bench in (whole, real):
        bench.run(200)
    assert whole.columns() == real.columns()
    assert all(type(value) is float for value in whole.column("override_percent"))


def test_status_bits_and_states_of_a_move() -> None:
    bench = axis_bench()
    start(bench, 2000.0)  # ramps of 0.5 s, 0.5 s at V
    bench.run(2000)
    bits, states, velocity = bench.column("status_bits"), bench.column("state"), bench.column("set_velocity")
    for cycle in set(range(2000)) - {500, 1000, 1500}:  # not where a phase ends
        moving = cycle < 1500
        assert states[cycle] == (S.DISCRETE_MOTION if moving else S.STANDSTILL)
        assert bool(bits[cycle] & JOB) is moving
        assert bool(bits[cycle] & CONSTANT) is (500 < cycle < 1000)
        assert not bits[cycle] & (STOPPED | ERROR)
        assert velocity[cycle] <= V


@pytest.mark.parametrize("count", [1, 5, 20, 25])
def test_the_block_size_changes_no_number(count: int) -> None:
    benches = [axis_bench(count=n) for n in (10, count)]
    for bench in benches:
        start(bench, 800.0)
        bench.run(300)
        bench.accepted("set_override", percent=40.0)
        bench.run(200)
        bench.accepted("stop")
        bench.run(500)
    assert benches[0].columns() == benches[1].columns()


# ---------------------------------------------------------------- drive and following error


def test_following_error_at_constant_velocity_is_v_over_kv() -> None:
    bench = axis_bench(kv=50.0)
    start(bench, 5000.0)
    bench.run(2000)
    assert bench.column("following_error")[1900] == pytest.approx(V / 50.0, abs=1e-9)
    assert bench.column("actual_velocity")[1900] == pytest.approx(V, abs=1e-9)
    for name in ("feedforward_velocity", "additive_velocity", "additive_torque", "friction_current"):
        assert set(bench.column(name)) == {0.0}


def test_actual_values_command_and_following_error_belong_to_one_cycle() -> None:
    bench = axis_bench(kv=80.0, drive_time_constant=0.004, encoder_increment=0.001)
    start(bench, 300.0)
    bench.run(800)
    columns = bench.columns()
    for k in range(800):
        error = columns["set_position"][k] - columns["actual_position"][k]
        assert columns["following_error"][k] == error
        assert columns["command_velocity"][k] == 80.0 * error
    assert columns["actual_position"][-1] == pytest.approx(300.0, abs=0.0011)


def test_following_error_limit_stops_the_axis_on_its_own_ramp() -> None:
    bench = axis_bench(kv=50.0, following_error_monitoring=True, following_error_limit=20.0)
    start(bench, 5000.0)
    bench.run(2000)
    assert bench.event_texts() == [
        "P-ERR-17744 axis x: following error 20.0501 mm exceeds 20.0 mm (P-AXIS-00168); the axis stops on its own ramp "
        "(ErrorStop)"
    ]
    event, columns = bench.events[0], bench.columns()
    assert event.severity == 2 and event.source == "x"
    cycle = event.cycle
    assert abs(columns["following_error"][cycle - 1]) <= 20.0 < abs(columns["following_error"][cycle])
    assert columns["state"][cycle - 1] == S.DISCRETE_MOTION and columns["state"][cycle] == S.ERROR_STOP
    assert columns["error_id"][cycle - 1] == 0 and set(columns["error_id"][cycle:]) == {17744}
    assert columns["status_bits"][cycle] & ERROR and not columns["status_bits"][cycle] & JOB
    assert columns["set_velocity"][-1] == 0.0 and columns["following_error"][-1] == pytest.approx(0.0, abs=1e-6)
    assert_axis_smooth(bench, acceleration=A, jerk=J)


def test_without_monitoring_the_following_error_may_be_large() -> None:
    bench = axis_bench(kv=5.0, following_error_monitoring=False, following_error_limit=1.0)
    start(bench, 5000.0)
    bench.run(2000)
    assert max(bench.column("following_error")) > 100.0 and bench.events == []


# ---------------------------------------------------------------- override


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_override_20_to_100_takes_the_closed_form_time(kind: int) -> None:
    """TX1250 2.2: V 2000, 0 to 5000 mm, start with 20 %, 100 % in the cruise after 2 s."""
    bench = axis_bench(override_type=kind)
    bench.accepted("set_override", percent=20.0)
    start(bench, 5000.0)
    bench.run(2000)
    velocity = bench.column("set_velocity")
    assert velocity[1000] == pytest.approx(400.0) and max(velocity) <= 400.0 * (1 + 1e-12)
    bench.accepted("set_override", percent=100.0)
    bench.run(4000)
    slow = 0.5 * 400.0 * 2.0 * (400.0 / J) ** 0.5  # A is not reached up to 400 mm/s
    before = slow + 400.0 * (2.0 - 2.0 * (400.0 / J) ** 0.5)
    rest = 5000.0 - before - ramp_way(400.0, V) - ramp_way(V, 0.0)
    expected = 2.0 + ramp_time(1600.0) + rest / V + ramp_time(V)
    assert time_of_arrival(bench) == pytest.approx(expected, abs=1.1 * CYCLE_TIME)
    assert max(bench.column("set_velocity")) == pytest.approx(V)
    assert bench.column("set_position")[-1] == 5000.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("target", [5000.0, -5000.0])
def test_override_100_75_100_takes_the_closed_form_time(kind: int, target: float) -> None:
    bench = axis_bench(override_type=kind)
    start(bench, target)
    bench.run(1000)
    bench.accepted("set_override", percent=75.0)
    bench.run(700)
    assert abs(bench.column("set_velocity")[-1]) == pytest.approx(1500.0)
    bench.accepted("set_override", percent=100.0)
    bench.run(3000)
    before = ramp_way(0.0, V) + V * 0.5 + ramp_way(V, 1500.0) + 1500.0 * (0.7 - ramp_time(500.0))
    rest = 5000.0 - before - ramp_way(1500.0, V) - ramp_way(V, 0.0)
    assert rest > 0.0
    expected = 1.7 + ramp_time(500.0) + rest / V + ramp_time(V)
    assert time_of_arrival(bench) == pytest.approx(expected, abs=1.1 * CYCLE_TIME)
    assert bench.column("set_position")[-1] == target
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_override_0_at_the_start_keeps_the_job_and_waits(kind: int) -> None:
    bench = axis_bench(override_type=kind)
    bench.accepted("set_override", percent=0.0)
    start(bench, 1000.0)
    bench.run(500)
    assert set(bench.column("set_position")) == {0.0} and set(bench.column("state")) == {S.DISCRETE_MOTION}
    assert all(bits & JOB for bits in bench.column("status_bits"))
    bench.accepted("set_override", percent=100.0)
    bench.run(1500)
    phases = seven_phases(1000.0, V, A, A, J)
    position = bench.column("set_position")
    for k in range(1500):
        assert abs(position[500 + k] - position_after(phases, k * CYCLE_TIME)[0]) <= 1e-8
    assert time_of_arrival(bench) == pytest.approx(1.5, abs=2 * CYCLE_TIME)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("cycle", [30, 250, 470, 700, 1100])
def test_override_0_in_motion_holds_and_100_goes_on(kind: int, cycle: int) -> None:
    bench = axis_bench(override_type=kind)
    start(bench, 3000.0)
    bench.run(cycle)
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)
    assert bench.column("set_velocity")[-1] == 0.0 and bench.column("set_position")[-1] < 3000.0
    assert bench.column("status_bits")[-1] & JOB and bench.state == S.DISCRETE_MOTION
    bench.accepted("set_override", percent=100.0)
    bench.run(4000)
    assert bench.state == S.STANDSTILL and bench.column("set_position")[-1] == 3000.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_a_hold_that_is_taken_back_during_its_ramp_still_ends_at_the_target(kind: int) -> None:
    """Also where the level is out of reach from there: a hold is no table that could be kept."""
    bench = axis_bench(override_type=kind)
    start(bench, 800.0)  # V is not reached
    bench.run(350)
    bench.accepted("set_override", percent=0.0)
    bench.run(50)
    bench.accepted("set_override", percent=100.0)
    bench.run(3000)
    assert bench.state == S.STANDSTILL and bench.column("set_position")[-1] == 800.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("percent", [0.0, 10.0, 99.0])
def test_override_in_the_brake_phase_counts_for_the_next_start_only(kind: int, percent: float) -> None:
    bench, undisturbed = axis_bench(override_type=kind), axis_bench(override_type=kind)
    for each in (bench, undisturbed):
        start(each, 1000.0)
        each.run(700)
    warning = bench.accepted("set_override", percent=percent)
    assert warning == (
        f"axis x: override {percent} % does not change the motion in work (brake phase or level out of reach)"
    )
    bench.run(100)
    bench.accepted("set_override", percent=50.0)
    bench.run(700)
    undisturbed.run(800)
    assert bench.column("set_position") == undisturbed.column("set_position")
    assert bench.state == S.STANDSTILL


@pytest.mark.parametrize(("kind", "level"), [(1, 0.5 * 1765.56), (2, 1000.0), (3, 0.5 * 1765.56), (4, 1000.0)])
def test_override_refers_to_the_reduced_or_to_the_users_velocity(kind: int, level: float) -> None:
    """800 mm reach 1765.56 mm/s: v²/A + v·A/J = 800; types 1 and 3 halve this, 2 and 4 the 2000 of the user."""
    reduced = A * (-A / J + ((A / J) ** 2 + 4.0 * 800.0 / A) ** 0.5) / 2.0
    assert reduced == pytest.approx(1765.56, abs=0.01)
    bench = axis_bench(override_type=kind)
    bench.accepted("set_override", percent=50.0)
    start(bench, 800.0)
    bench.run(3000)
    assert max(bench.column("set_velocity")) == pytest.approx(level, rel=1e-5)
    assert bench.column("set_position")[-1] == 800.0


def test_original_override_has_no_effect_while_the_velocity_is_out_of_reach() -> None:
    """Asked 2000 mm/s, reachable 1765: type 2 acts below 88 % only, from a start and from a change."""
    full, ninety = axis_bench(override_type=2), axis_bench(override_type=2)
    ninety.accepted("set_override", percent=90.0)
    for bench in (full, ninety):
        start(bench, 800.0)
        bench.run(2000)
    assert full.column("set_position") == ninety.column("set_position")


@pytest.mark.parametrize(("kind", "acts"), [(1, False), (2, False), (3, True), (4, True)])
def test_a_level_out_of_reach_keeps_the_old_table_or_takes_the_highest_that_is_left(kind: int, acts: bool) -> None:
    bench, undisturbed = axis_bench(override_type=kind), axis_bench(override_type=kind)
    for each in (bench, undisturbed):
        each.accepted("set_override", percent=20.0)
        start(each, 1000.0)
        each.run(1500)
    warning = bench.accepted("set_override", percent=100.0)
    for each in (bench, undisturbed):
        each.run(2500)
    if acts:
        assert warning == ""
        assert 400.0 < max(bench.column("set_velocity")) < V
        assert time_of_arrival(bench) < time_of_arrival(undisturbed)
    else:
        reason = "does not change the motion in work (brake phase or level out of reach)"
        assert warning == f"axis x: override 100.0 % {reason}"
        assert bench.column("set_position") == undisturbed.column("set_position")
    assert bench.column("set_position")[-1] == 1000.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize(("percent", "shown"), [(0.0001, 0.0001), (0.00009, 0.0), (100.0, 100.0), (33.33333, 33.33333)])
def test_override_steps(percent: float, shown: float) -> None:
    """One step is 1/1,000,000; less is 0 and holds the axis."""
    bench = axis_bench()
    bench.accepted("set_override", percent=percent)
    start(bench, 1000.0)
    bench.run(100)
    assert bench.column("override_percent")[-1] == shown
    assert (bench.column("set_position")[-1] == 0.0) is (shown == 0.0)


def test_override_acts_on_very_slow_moves_too() -> None:
    """A level below what a table can be made for (1e-9 mm/s) is raised to it; nothing is refused."""
    bench = axis_bench()
    bench.accepted("set_override", percent=0.01)
    start(bench, 1000.0, velocity=1e-6)
    bench.run(100)
    bench.accepted("set_override", percent=0.02)
    bench.run(100)
    assert bench.state == S.DISCRETE_MOTION and 0.0 < bench.column("set_position")[-1] < 1e-6


@pytest.mark.parametrize("percent", [-0.1, 100.01])
def test_override_outside_0_to_100_is_refused(percent: float) -> None:
    bench = axis_bench()
    start(bench, 1000.0)
    bench.run(100)
    assert bench.refused("set_override", percent=percent) == (
        f"P-ERR-23006 axis x: set_override refused: percent = {percent} is not within 0 ... 100 (P-AXIS-00109, at most 100); nothing was changed"
    )
    bench.run(10)
    assert set(bench.column("override_percent")) == {100.0}


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
        "axis x: override 10.0 % does not change the motion in work (the axis stops)"
    )
    for each in (bench, undisturbed):
        each.run(1000)
    assert bench.column("set_position") == undisturbed.column("set_position")


# ---------------------------------------------------------------- jerk and small ways


def test_a_jerk_above_a_over_t_is_rescaled_with_a_warning() -> None:
    bench = axis_bench()
    warning = bench.accepted("move_absolute", target=1000.0, **{**DYNAMICS, "jerk": 1e8, "deceleration": 4000.0})
    assert warning == (
        "P-WARN-23012 axis x: move_absolute: jerk 100000000.0 mm/s³ is above A/T, the acceleration over one cycle; "
        "4000000.0 mm/s³ is used"
    )
    bench.run(2000)
    assert max(map(abs, bench.column("set_jerk"))) == 4e6
    assert bench.column("set_position")[-1] == 1000.0


def test_a_way_below_an_encoder_increment_does_not_start() -> None:
    bench = axis_bench(encoder_increment=0.001, start_position=5.0)
    before = bench.accepted("move_absolute", target=5.0009)
    assert before == (
        "P-WARN-23007 axis x: move_absolute over 0.0009 mm is below one encoder increment (0.001 mm); "
        "the axis does not move"
    )
    assert bench.accepted("move_relative", distance=-0.0005).startswith(
        "P-WARN-23007 axis x: move_relative over 0.0005"
    )
    bench.run(20)
    assert set(bench.column("set_position")) == {5.0} and set(bench.column("state")) == {S.STANDSTILL}
    assert bench.accepted("move_absolute", target=5.0011) == ""


def test_an_ideal_encoder_refuses_only_the_way_0() -> None:
    bench = axis_bench(start_position=0.3)
    assert "over 0 mm is below one encoder increment (0.0 mm)" in bench.accepted("move_absolute", target=0.3)
    assert bench.accepted("move_absolute", target=0.1 + 0.2) == ""  # 5.6e-17 further
    bench.run(10)
    assert bench.state == S.STANDSTILL and bench.column("set_position")[-1] == 0.1 + 0.2
