"""Jogging of an axis: ramps and limits by re-integration and Ruckig, the soft limit, changes on the fly, refusals."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from axis_motion_support import motion, ramp_time, ramp_way, run_to_standstill
from axis_states_support import A, J
from error_support import Refused, refused
from long_support import long
from machine_support import CYCLE_TIME, PTP, MachineBench, UnitBench, assert_axis_smooth, axis_bench, seven_phases
from ruckig import ControlInterface, InputParameter, Result, Ruckig, Trajectory
from superposition_support import feed, generator

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit


def fastest_change(v: float, a: float, wanted: float) -> Trajectory:
    """Ruckig's way from a velocity and an acceleration to another velocity."""
    inputs = InputParameter(1)
    inputs.control_interface = ControlInterface.Velocity
    inputs.current_position, inputs.current_velocity, inputs.current_acceleration = [0.0], [v], [a]
    inputs.target_velocity, inputs.target_acceleration = [wanted], [0.0]
    inputs.max_acceleration, inputs.max_jerk = [A], [J]
    trajectory = Trajectory(1)
    assert Ruckig(1).calculate(inputs, trajectory) in (Result.Working, Result.Finished)
    return trajectory


def limited(low: float, high: float, **more: object) -> UnitBench:
    return axis_bench(soft_limit_negative=low, soft_limit_positive=high, **more)


# ---------------------------------------------------------------- ramps


@pytest.mark.parametrize("velocity", [-5.0, 333.3, *long([5.0, -2000.0])])
@pytest.mark.parametrize("modulo", [False, True])
def test_it_ramps_up_goes_on_and_halts(velocity: float, modulo: bool) -> None:
    """Against the closed form of both ramps."""
    endless = {"modulo": True, "modulo_high": 360.0, "soft_limit_negative": -math.inf, "soft_limit_positive": math.inf}
    bench = axis_bench(**(endless if modulo else {}))
    assert bench.accepted("jog", velocity=velocity) == ""
    bench.run(5000)
    assert bench.state == S.CONTINUOUS_MOTION
    assert bench.column("set_velocity")[-1] == pytest.approx(velocity, rel=1e-12)
    assert bench.last.status_bits[-1] & StatusBit.HAS_JOB and bench.last.status_bits[-1] & StatusBit.CONSTANT_VELOCITY
    reached = next(n for n, v in enumerate(bench.column("set_velocity")) if abs(v - velocity) < 1e-9 * abs(velocity))
    assert reached * CYCLE_TIME == pytest.approx(ramp_time(abs(velocity)), abs=1.1 * CYCLE_TIME)
    begin = motion(bench)[-1][0] + velocity * CYCLE_TIME
    assert bench.accepted("jog", velocity=0.0) == ""
    bench.run(10)
    assert bench.state == S.DISCRETE_MOTION
    run_to_standstill(bench)
    distance = math.copysign(ramp_way(abs(velocity), 0.0), velocity)
    assert motion(bench)[-1][0] == pytest.approx(begin + distance, abs=1e-7)
    assert bench.last.status_bits[-1] & StatusBit.HAS_BEEN_STOPPED
    assert_axis_smooth(bench, acceleration=A, jerk=J)
    assert bench.event_texts() == []


@pytest.mark.parametrize("second", [900.0, 100.0, -100.0, -700.0])
@pytest.mark.parametrize("at", [120, *long([40, 1000])])
@pytest.mark.parametrize("modulo", [False, True])
def test_velocity_and_direction_change_on_the_fly(second: float, at: int, modulo: bool) -> None:
    """Endless: as Ruckig changes the velocity. Towards a limit: no slower than a stop and a new start."""
    endless = {"modulo": True, "modulo_high": 360.0, "soft_limit_negative": -math.inf, "soft_limit_positive": math.inf}
    bench = axis_bench(**(endless if modulo else {}))
    bench.accepted("jog", velocity=500.0)
    bench.run(at)
    bench.accepted("jog", velocity=second)
    bench.run(3000)
    _, v, a = motion(bench)[at]
    velocity = np.array(bench.column("set_velocity"))
    longest = fastest_change(v, a, second).duration
    if not modulo and second < 0.0:
        longest = fastest_change(v, a, 0.0).duration + ramp_time(abs(second))
    assert abs(velocity[at + math.ceil(longest / CYCLE_TIME) + 1 :] - second).max() <= 1e-9
    if modulo:
        change = fastest_change(v, a, second)
        for k in range(math.ceil(longest / CYCLE_TIME)):
            _, (expected,), _ = change.at_time(min(k * CYCLE_TIME, change.duration))
            assert velocity[at + k] == pytest.approx(expected, abs=1e-5)
    assert bench.state == S.CONTINUOUS_MOTION
    assert_axis_smooth(bench, acceleration=A, jerk=J)


def test_it_may_be_led_on_while_it_halts() -> None:
    bench = axis_bench()
    bench.accepted("jog", velocity=500.0)
    bench.run(1000)
    bench.accepted("jog", velocity=0.0)
    bench.run(60)
    bench.accepted("jog", velocity=200.0)
    bench.run(2000)
    assert bench.state == S.CONTINUOUS_MOTION and motion(bench)[-1][1] == pytest.approx(200.0)
    assert min(bench.column("set_velocity")[1000:]) > 150.0
    assert not bench.last.status_bits[-1] & StatusBit.HAS_BEEN_STOPPED
    assert_axis_smooth(bench, acceleration=A, jerk=J)


def test_the_override_acts_and_a_new_target_ends_the_jog() -> None:
    bench = axis_bench()
    bench.accepted("jog", velocity=400.0)
    bench.run(500)
    for percent in (25.0, 0.0, 100.0):
        bench.accepted("set_override", percent=percent)
        bench.run(1000)
        assert motion(bench)[-1][1] == pytest.approx(4.0 * percent, abs=1e-9)
        assert bench.state == S.CONTINUOUS_MOTION
    bench.accepted("new_target", target=2500.0)
    bench.run(10)
    assert bench.state == S.DISCRETE_MOTION
    run_to_standstill(bench)
    assert motion(bench)[-1] == (2500.0, 0.0, 0.0)
    assert_axis_smooth(bench, acceleration=A, jerk=J)


def test_the_end_of_a_jog_leaves_other_motion_alone() -> None:
    """Somebody else may have taken the axis over meanwhile."""
    alone, disturbed = axis_bench(), axis_bench()
    for bench in (alone, disturbed):
        bench.accepted("jog", velocity=100.0)
        bench.run(300)
        bench.accepted("new_target", target=500.0)
        bench.run(100)
        if bench is disturbed:
            assert bench.accepted("jog", velocity=0.0) == ""
        bench.run(6000)
        assert bench.accepted("jog", velocity=0.0) == ""
    assert alone.columns() == disturbed.columns()
    assert motion(alone)[-1][0] == 500.0


# ---------------------------------------------------------------- soft limits


@pytest.mark.parametrize(("velocity", "limit"), [(100.0, 300.0), (2000.0, 300.0), (-37.5, -120.125), (-4000.0, -0.5)])
@pytest.mark.parametrize("count", [7, *long([1, 10])])
def test_it_stands_at_the_soft_limit_and_says_so(velocity: float, limit: float, count: int) -> None:
    low, high = (-1000.0, limit) if velocity > 0.0 else (limit, 1000.0)
    bench = limited(low, high, count=count)
    bench.accepted("jog", velocity=velocity)
    run_to_standstill(bench)
    positions = bench.column("set_position")
    assert positions[-1] == limit and motion(bench)[-1][1:] == (0.0, 0.0)
    assert max(abs(p) for p in positions) <= abs(limit) * (1.0 + 1e-12)
    name, parameter = ("positive", "P-AXIS-00178") if velocity > 0.0 else ("negative", "P-AXIS-00177")
    assert bench.event_texts() == [
        f"P-ERR-23070 axis x: the jog has reached the {name} soft limit {limit} mm ({parameter}); the axis is at a standstill"
    ]
    assert [event.severity for event in bench.events] == [1]
    assert_axis_smooth(bench, acceleration=A, jerk=J)
    number = 120002 if velocity > 0.0 else 120003
    assert bench.refused("jog", velocity=velocity) == (
        f"P-ERR-{number} axis x: jog refused: the axis is at its {name} soft limit {limit} mm ({parameter}); "
        "nothing was changed"
    )
    assert bench.accepted("jog", velocity=-velocity) == ""
    bench.run(200)
    assert bench.state == S.CONTINUOUS_MOTION and motion(bench)[-1][1] * velocity < 0.0


def test_in_the_brake_phase_to_the_limit_only_the_other_direction_counts() -> None:
    bench = limited(-1000.0, 300.0)
    bench.accepted("jog", velocity=400.0)
    while motion(bench)[-1][2] >= 0.0 if bench.blocks else True:
        bench.run(10)
    told = "axis x: jog changes nothing: the axis brakes to its soft limit 300.0 mm"
    assert [bench.accepted("jog", velocity=v) for v in (400.0, 5.0, 800.0)] == [told] * 3
    bench.run(20)
    assert bench.accepted("jog", velocity=-50.0) == ""
    bench.run(1000)
    assert motion(bench)[-1][1] == pytest.approx(-50.0)
    assert max(bench.column("set_position")) < 300.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize(("start", "back"), [(350.0, -20.0), (-1020.0, 20.0)])
def test_an_axis_beyond_its_limit_may_jog_back_only(start: float, back: float) -> None:
    bench = limited(-1000.0, 300.0, start_position=start)
    name, limit = ("positive", "300.0 mm (P-AXIS-00178)") if start > 0.0 else ("negative", "-1000.0 mm (P-AXIS-00177)")
    assert bench.refused("jog", velocity=-back).endswith(
        f"jog refused: the axis is at {start} mm, beyond its {name} soft limit {limit}; nothing was changed"
    )
    bench.accepted("jog", velocity=back)
    bench.run(1000)
    assert bench.state == S.CONTINUOUS_MOTION and len(bench.events) == 1  # that refusal


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("cycles", [1, 5, 100, 1000])
def test_from_beyond_the_limit_only_the_other_direction_is_taken_in_motion_too(sign: float, cycles: int) -> None:
    """At 600 mm, limit 500 mm: a jog outwards would drive back to the limit with the velocity asked for."""
    benches = [limited(-500.0, 500.0, start_position=sign * 600.0) for _ in range(2)]
    for bench in benches:
        bench.accepted("jog", velocity=sign * -10.0)
        bench.run(cycles)
    name, number, parameter = (
        ("positive", 120002, "P-AXIS-00178") if sign > 0.0 else ("negative", 120003, "P-AXIS-00177")
    )
    position = benches[0].unit._axis.setpoint(benches[0].cycle)[0]
    assert benches[0].refused("jog", velocity=sign * 50.0) == (
        f"P-ERR-{number} axis x: jog refused: the axis is at {position} mm, beyond its {name} soft limit "
        f"{sign * 500.0} mm ({parameter}); nothing was changed"
    )
    assert benches[1].accepted("jog", velocity=sign * -20.0) == ""
    benches[1].accepted("jog", velocity=0.0)
    benches[1].run(500)
    assert benches[1].refused("jog", velocity=sign * 50.0)[:12] == f"P-ERR-{number}"
    benches[0].run(500)
    assert motion(benches[0])[-1][1] == pytest.approx(sign * -10.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_compensation_comes_to_rest_after_the_jog_has_come_to_the_limit(sign: float) -> None:
    """It reverses the axis with 50 mm/s² and ends with 300 mm/s², in closed form; only then the axis is at rest."""
    bench = limited(-1000.0, 1000.0)
    bench.accepted("jog", velocity=sign * 500.0)
    bench.run(500)
    values = {"process_velocity": 400.0, "velocity_increase": 200.0, "acceleration": 300.0, "deceleration": 50.0}
    bench.accepted("compensation_start", length=5000.0, difference=-300.0, **values)
    basic = seven_phases(1000.0, 500.0, A, A, J)
    end = math.ceil(sum(duration for duration, _ in basic) / CYCLE_TIME)
    bench.run(end + 1 - 500)
    p, v, _ = motion(bench)[end]
    assert sign * v < -30.0 and bench.state == S.CONTINUOUS_MOTION and bench.event_texts() == []
    bench.run(500)
    rest = p + sign * -(v * v) / 600.0
    assert motion(bench)[-1] == (pytest.approx(rest, abs=1e-3), 0.0, 0.0)
    stands = bench.column("state").index(S.STANDSTILL)
    assert stands == pytest.approx(end + abs(v) / 300.0 / CYCLE_TIME, abs=1.1) and not any(
        bench.column("set_velocity")[stands:]
    )
    assert not bench.last.status_bits[-1] & (StatusBit.COMPENSATING | StatusBit.HAS_JOB)
    name, parameter = ("positive", "P-AXIS-00178") if sign > 0.0 else ("negative", "P-AXIS-00177")
    (text,) = bench.event_texts()
    assert text == (
        f"P-ERR-23070 axis x: the jog has reached the {name} soft limit {sign * 1000.0} mm ({parameter}); the axis "
        f"is at a standstill at {motion(bench)[-1][0]:g} mm"
    )
    assert bench.accepted("jog", velocity=sign * 20.0) == "" and bench.accepted("stop") == ""


@pytest.mark.parametrize("command", ["stop", "emergency_stop", "jog"])
def test_a_stop_acts_while_the_compensation_of_a_jog_comes_to_rest(command: str) -> None:
    bench = limited(-1000.0, 1000.0)
    bench.accepted("jog", velocity=500.0)
    bench.run(500)
    values = {"process_velocity": 400.0, "velocity_increase": 200.0, "acceleration": 300.0, "deceleration": 50.0}
    bench.accepted("compensation_start", length=5000.0, difference=-300.0, **values)
    bench.run(1730)
    given = {"emergency_stop": {"deceleration": 20_000.0, "jerk": 5e6}, "jog": {"velocity": 0.0}}
    assert bench.state == S.CONTINUOUS_MOTION
    assert bench.accepted(command, **given.get(command, {})) == ""
    bench.run(500)
    assert bench.state == S.STANDSTILL and bench.last.set_velocity[-1] == 0.0
    assert bench.last.status_bits[-1] & StatusBit.HAS_BEEN_STOPPED and bench.event_texts() == []


def test_a_jog_below_external_setpoints_ends_once_at_the_limit() -> None:
    """They continue alone: one event, no job, and the limit is watched for them."""
    bench = limited(-1000.0, 300.0)
    bench.accepted("jog", velocity=200.0)
    bench.run(200)
    bench.accepted("external_enable", mode="relative")
    bench.run(2500)
    assert bench.event_texts() == [
        "P-ERR-23070 axis x: the jog has reached the positive soft limit 300.0 mm (P-AXIS-00178); external "
        "setpoints move the axis now"
    ]
    assert bench.state == S.CONTINUOUS_MOTION and motion(bench)[-1] == (300.0, 0.0, 0.0)
    assert bench.last.status_bits[-1] & (StatusBit.HAS_JOB | StatusBit.EXT_SETPOINT) == StatusBit.EXT_SETPOINT
    feed(bench, generator(-100.0, first_cycle=bench.cycle + 10, velocity=200.0), 700)
    assert motion(bench)[-1] == (pytest.approx(200.0), 0.0, 0.0)
    feed(bench, generator(150.0, first_cycle=bench.cycle + 10, velocity=200.0, start=-100.0), 700)
    assert [text[:12] for text in bench.event_texts()] == ["P-ERR-23070 ", "P-ERR-120002"]


def test_a_jog_comes_to_the_limit_while_disabled_external_setpoints_come_to_rest() -> None:
    bench = limited(-1000.0, 300.0)
    bench.accepted("jog", velocity=200.0)
    bench.run(200)
    bench.accepted("external_enable", mode="relative")
    feed(bench, generator(-2000.0, first_cycle=bench.cycle, velocity=900.0), 1320)
    bench.accepted("external_disable")
    bench.run(1000)
    assert bench.state == S.STANDSTILL and len(bench.event_texts()) == 1


@pytest.mark.long
def test_random_jogs_stay_within_all_limits() -> None:
    """Seeded: changes of velocity, direction and override at any time; never beyond a limit, never a step."""
    for seed in range(15):
        chance = random.Random(seed)
        high, low = chance.uniform(20.0, 400.0), -chance.uniform(20.0, 400.0)
        bench = limited(low, high, count=chance.choice([1, 7, 10]))
        for _ in range(30):
            velocity = chance.choice([0.0, 1.0, -1.0]) * 10.0 ** chance.uniform(-1.0, 3.3)
            command, value = chance.choice(
                [("jog", velocity)] * 3 + [("set_override", chance.choice([0.0, 30.0, 100.0]))]
            )
            bench.give(command, **{"velocity" if command == "jog" else "percent": value})
            bench.run(chance.randrange(1, 400))
        bench.give("set_override", percent=100.0)
        bench.give("jog", velocity=0.0)
        run_to_standstill(bench)
        position = bench.column("set_position")
        assert low - 1e-9 <= min(position) and max(position) <= high + 1e-9, seed
        assert_axis_smooth(bench, acceleration=A, jerk=J)
        assert not [event for event in bench.events if event.severity == 2], (seed, bench.event_texts())


# ---------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("velocity", "wanted"),
    [
        (150.0, refused(23004, velocity=150.0, limit=100.0)),
        (-150.0, refused(23004, velocity=150.0, limit=100.0)),
        (90.0, refused(23011, velocity=90.0, limit=80.0)),
        (1e-12, refused(23003, argument="velocity", value=1e-12, limit=1e-09)),
    ],
)
@pytest.mark.parametrize("moving", [False, True])
def test_a_velocity_out_of_range_changes_nothing(velocity: float, wanted: Refused, moving: bool) -> None:
    benches = [axis_bench(max_velocity=100.0, reference_velocity=80.0) for _ in range(2)]
    for bench in benches:
        if moving:
            bench.accepted("jog", velocity=20.0)
        bench.run(100)
    assert benches[0].refusal("jog", velocity=velocity) == wanted
    for bench in benches:
        bench.run(500)
    assert benches[0].columns() == benches[1].columns()


def test_a_slave_and_a_compensated_jog_are_refused() -> None:
    bench = axis_bench()
    bench.accepted("jog", velocity=100.0)
    bench.run(500)
    bench.accepted("compensation_start", length=50.0, difference=-1.0, process_velocity=100.0, velocity_increase=20.0)
    bench.run(50)
    assert bench.refusal("jog", velocity=50.0) == refused(23015)
    bench.run(2000)
    assert bench.accepted("jog", velocity=50.0) == ""
    bench.run(500)
    assert motion(bench)[-1][1] == pytest.approx(50.0)
    machine = MachineBench(scenario='[{at: 0, to: "y", do: couple, master: x, factor: 1}]', machine=PTP).run(0.1)
    assert machine.refusal("y", "jog", velocity=1.0) == refused(23040, master="x")


def test_a_jerk_above_a_over_t_is_rescaled_with_a_warning() -> None:
    bench = axis_bench(jerk=1e8)
    assert bench.accepted("jog", velocity=20.0) == (
        "P-WARN-23012 axis x: jog: jerk 100000000.0 mm/s³ is above A/T, the acceleration over one cycle; "
        "5000000.0 mm/s³ is used"
    )


# ---------------------------------------------------------------- scenario


def test_a_scenario_runs_as_long_as_its_jog() -> None:
    """A jog that is ended ends the run; so does the soft limit, 100 m away here; a round axis continues endlessly."""
    ended = MachineBench(
        scenario="[{at: 0, to: x, do: jog, velocity: 50}, {at: 1, to: x, do: jog, velocity: 0}]", machine=PTP
    ).run()
    assert 45.0 < ended.position("x") < 60.0 and ended.last("plc").first_cycle < 2000
    forgotten = "[{at: 0, to: c, do: jog, velocity: -90}]"
    aborted = MachineBench(scenario=forgotten, machine=PTP).run()
    assert aborted.errors() == [
        "P-ERR-22014 plc plc: axis c moves endlessly, but the scenario is finished; everything is stopped and the "
        "run ends"
    ]
    endless = MachineBench(scenario=forgotten, machine=PTP).run(20.0)
    assert not endless.last("plc").run_done and endless.position("c") == pytest.approx(-1800.0, abs=5.0)
