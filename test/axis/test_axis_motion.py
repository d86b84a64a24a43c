"""PTP motion of an axis in every cycle: starts, reduced velocity, modulo starts against closed forms."""

from __future__ import annotations

import pytest
from axis_motion_support import ramp_way, reachable, start, time_of_arrival
from axis_states_support import DYNAMICS, A, J, V
from error_support import refused
from long_support import long
from machine_support import (
    CYCLE_TIME,
    PTP,
    UnitBench,
    assert_axis_smooth,
    axis_bench,
    changed,
    position_after,
    seven_phases,
)

from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit

JOB, STOPPED, CONSTANT, ERROR = (
    StatusBit.HAS_JOB,
    StatusBit.HAS_BEEN_STOPPED,
    StatusBit.CONSTANT_VELOCITY,
    StatusBit.ERROR,
)


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
@pytest.mark.parametrize("begin", [20, *long([0, 130])])
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
    assert time_of_arrival(bench) == pytest.approx(begin * CYCLE_TIME + sum(d for d, _ in phases), abs=1.1 * CYCLE_TIME)
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


# ---------------------------------------------------------------- reduced velocity


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize(("up", "down"), [(5000.0, 10_000.0), (10_000.0, 5000.0), (3000.0, 20_000.0)])
@pytest.mark.parametrize("part", [0.999, 0.9, 0.5, 0.01])
def test_a_velocity_out_of_reach_is_reduced_for_min_of_both_ramps(
    kind: int, up: float, down: float, part: float
) -> None:
    """The ramps stay those of the user; what the symmetric reduction leaves of the distance is driven at the velocity.

    Just below the distance that the user's ramps need it falls in proportion, so that it does not jump.
    """
    distance = part * (ramp_way(0.0, V, up) + ramp_way(V, 0.0, down))
    velocity = max(reachable(distance, min(up, down)), part * V)
    assert (velocity == part * V) is (part > 0.8) and velocity < V
    bench = axis_bench(count=100, override_type=kind)
    start(bench, distance, acceleration=up, deceleration=down)
    bench.run(2500)
    phases = seven_phases(distance, velocity, up, down, J)
    for k, position in enumerate(bench.column("set_position")):
        assert abs(position - position_after(phases, k * CYCLE_TIME)[0]) <= 1e-7
    assert bench.column("set_position")[-1] == distance


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_a_velocity_that_the_users_own_ramps_reach_is_not_reduced(kind: int) -> None:
    """950 mm: with A+ 5000 and A- 10000 both ramps take 900 mm; with 5000 twice they would take 1000."""
    bench = axis_bench(count=100, override_type=kind)
    start(bench, 950.0, deceleration=10_000.0)
    bench.run(2000)
    phases = seven_phases(950.0, V, A, 10_000.0, J)
    for k, position in enumerate(bench.column("set_position")):
        assert abs(position - position_after(phases, k * CYCLE_TIME)[0]) <= 1e-8


# ---------------------------------------------------------------- modulo start


def rotary_bench(start_position: float = 0.0, **changes: object) -> UnitBench:
    """The c axis of config/ptp.yaml: 360 degrees, V 3600 °/s, A 5000 °/s², J 50000 °/s³."""
    parameters = changed(PTP.axes["c"], start_position=start_position, **changes)  # type: ignore[arg-type]
    return UnitBench(AxisUnit(parameters, cycle_time=CYCLE_TIME), count=100)


@pytest.mark.parametrize(
    ("begin", "position", "target"),
    [(0.0, 540.0, 540.0), (100.0, 90.0, 450.0), (100.0, -90.0, 90.0), (50.0, 0.0, 360.0), (50.0, -1e-6, 1e-6)],
)
def test_modulo_starts_go_the_way_of_their_sign(begin: float, position: float, target: float) -> None:
    bench = rotary_bench(begin)
    assert bench.accepted("move_modulo", position=position, **DYNAMICS) == ""
    bench.run(2000)
    sign = 1.0 if target > begin else -1.0
    distance = abs(target - begin)
    phases = seven_phases(distance, min(V, reachable(distance)), A, A, J)
    for k, place in enumerate(bench.column("set_position")):
        assert abs(place - begin - sign * position_after(phases, k * CYCLE_TIME)[0]) <= 1e-8
    assert bench.state == S.STANDSTILL and bench.column("set_position")[-1] == pytest.approx(target, abs=1e-12)


def test_modulo_starts_in_a_row_stay_congruent() -> None:
    bench = rotary_bench(12.3)
    for position in (77.7, -77.7, 437.7, -1e-6, 0.0, -359.9, 359.9):
        bench.accepted("move_modulo", position=position)
        bench.run(1500)
        off = (bench.column("set_position")[-1] - abs(position)) % 360.0
        assert min(off, 360.0 - off) < 1e-9 and bench.state == S.STANDSTILL


@pytest.mark.parametrize("position", [90.0, -90.0])
def test_an_axis_at_its_modulo_position_does_not_move(position: float) -> None:
    bench = rotary_bench(90.0 + 360.0)
    assert bench.accepted("move_modulo", position=position) == (
        "P-WARN-23007 axis c: move_modulo over 0 deg: the axis is at its target already; the axis does not move"
    )
    bench.run(100)
    assert set(bench.column("set_position")) == {450.0}


def test_an_axis_that_does_not_count_modulo_refuses_a_modulo_start() -> None:
    bench = axis_bench()
    assert bench.refusal("move_modulo", position=90.0) == refused(23024)
    bench.run(10)
    assert bench.state == S.STANDSTILL


@pytest.mark.parametrize(
    ("command", "argument", "target"),
    [
        ("move_modulo", {"position": 1e300}, 1e300),
        ("move_modulo", {"position": -3.6e14}, -3.6e14),
        ("move_absolute", {"target": 2e12}, 2e12),
        ("move_relative", {"distance": -1.7e308}, -1.7e308),
    ],
)
def test_targets_out_of_all_range(command: str, argument: dict[str, float], target: float) -> None:
    """An axis that counts modulo has no soft limits; beyond ±1e12 degrees no table can be made."""
    bench = rotary_bench()
    assert bench.refusal(command, **argument) == refused(23002, target=target, limit=1e12)
    bench.run(10)
    assert bench.state == S.STANDSTILL and set(bench.column("set_position")) == {0.0}


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
    assert bench.accepted("move_absolute", target=0.3) == (
        "P-WARN-23007 axis x: move_absolute over 0 mm: the axis is at its target already; the axis does not move"
    )
    assert bench.accepted("move_absolute", target=0.1 + 0.2) == ""  # 5.6e-17 further
    bench.run(10)
    assert bench.state == S.STANDSTILL and bench.column("set_position")[-1] == 0.1 + 0.2
