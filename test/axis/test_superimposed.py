"""Superimposed motion (MC_MoveSuperimposed): two motions that are added, each with its own profile and job."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from axis_motion_support import run_to_standstill
from axis_states_support import DYNAMICS, STATES, A, J, follow_path
from error_support import refused
from job_support import ABORTED, ACTIVE, DONE, FAILED, end_of, job, start_of, told
from long_support import long
from machine_support import CYCLE_TIME, UnitBench, assert_axis_smooth, axis_bench, position_after, seven_phases
from slave_support import SlaveBench
from superposition_support import column

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.blocks import JobEvent

OWN = {"acceleration": 800.0, "deceleration": 800.0, "jerk": 8000.0}
"""Dynamics of the addition."""


def addition(distance: float, velocity: float, cycles: int) -> np.ndarray:
    """Position, velocity and acceleration of the addition in each cycle, by the textbook form; V must be reached."""
    phases = seven_phases(abs(distance), velocity, 800.0, 800.0, 8000.0)
    sign = np.sign(distance)
    return sign * np.array([position_after(phases, k * CYCLE_TIME) for k in range(cycles)])


def both(start: str, arguments: dict[str, Any], *, before: int = 200, **changes: Any) -> tuple[UnitBench, UnitBench]:
    """Two axes in the same motion."""
    benches = axis_bench(**changes), axis_bench(**changes)
    for bench in benches:
        bench.accepted(start, **arguments)
        bench.run(before)
    return benches


def difference(bench: UnitBench, alone: UnitBench, begin: int) -> np.ndarray:
    names = ("set_position", "set_velocity", "set_acceleration")
    return np.array([column(bench, name)[begin:] - column(alone, name)[begin:] for name in names]).T


@pytest.mark.parametrize("distance", [60.0, -60.0])
@pytest.mark.parametrize(
    ("start", "arguments"),
    [
        ("move_absolute", {"target": 3000.0, **DYNAMICS}),
        ("move_velocity", {"velocity": -700.0}),
        ("jog", {"velocity": 500.0}),
    ],
)
def test_it_is_the_sum_of_two_motions(start: str, arguments: dict[str, Any], distance: float) -> None:
    bench, alone = both(start, arguments)
    number = job(bench, "move_superimposed", distance=distance, velocity_difference=50.0, **OWN)
    for each in (bench, alone):
        each.run(2000)
    expected = addition(distance, 50.0, 2000)
    off = np.abs(difference(bench, alone, 200) - expected).max(axis=0)
    assert off[0] < 1e-9 and off[1] < 1e-9 and off[2] < 1e-7
    end = end_of(bench, number)
    seconds = sum(duration for duration, _ in seven_phases(60.0, 50.0, 800.0, 800.0, 8000.0))
    assert end.status == DONE and end.cycle == 200 + int(np.ceil(seconds / CYCLE_TIME - 1e-9))
    assert start_of(bench, number) == 200
    bits = np.array(bench.column("status_bits")) & StatusBit.COMPENSATING != 0
    assert not bits[:200].any() and bits[200 : end.cycle].all() and not bits[end.cycle :].any()


def test_each_job_ends_at_its_own_time_whichever_is_first() -> None:
    """A long addition goes on alone, in DiscreteMotion; a long basic motion does too."""
    for distance, velocity in ((400.0, 100.0), (4.0, 100.0)):
        bench, alone = both("move_absolute", {"target": 500.0, **DYNAMICS})
        number = job(bench, "move_superimposed", distance=distance, velocity_difference=velocity, **OWN)
        for each in (bench, alone):
            run_to_standstill(each)
        assert end_of(bench, 1) == end_of(alone, 1)
        assert bench.column("set_position")[-1] == 500.0 + distance
        ends = sorted([end_of(bench, 1).cycle, end_of(bench, number).cycle])
        assert set(bench.column("state")[: ends[1]]) == {S.DISCRETE_MOTION}
        assert bench.column("state")[ends[1]] == S.STANDSTILL
        assert_axis_smooth(bench, acceleration=A + 800.0, jerk=J + 8000.0)


def test_from_standstill_it_is_a_relative_motion() -> None:
    bench = axis_bench(start_position=10.0)
    number = job(bench, "move_superimposed", distance=60.0, velocity_difference=50.0, **OWN)
    run_to_standstill(bench)
    assert told(bench) == [(number, ACTIVE), (number, DONE)] and bench.column("state")[0] == S.DISCRETE_MOTION
    expected = addition(60.0, 50.0, len(bench.column("set_position")))
    assert np.abs(column(bench, "set_position") - 10.0 - expected[:, 0]).max() < 1e-9
    assert bench.column("set_position")[-1] == 70.0
    bench.accepted("move_absolute", target=0.0, **DYNAMICS)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 0.0


@pytest.mark.parametrize("count", [7, *long([1, 1000])])
def test_it_does_not_depend_on_the_size_of_blocks(count: int) -> None:
    benches = axis_bench(count=10), axis_bench(count=count)
    for bench in benches:
        bench.accepted("move_absolute", target=300.0, **DYNAMICS)
        bench.run(100)
        bench.accepted("move_absolute", target=500.0, buffer_mode="buffered", **DYNAMICS)
        bench.accepted("move_superimposed", distance=90.0, velocity_difference=60.0, **OWN)
        bench.run(3000)
    assert benches[0].columns() == benches[1].columns()
    assert told(benches[0]) == told(benches[1])


def test_a_buffered_motion_begins_under_it_and_ends_in_its_own_target() -> None:
    """A target is a position of the axis, whatever is added meanwhile."""
    bench = axis_bench()
    first = job(bench, "move_absolute", target=300.0, **DYNAMICS)
    bench.run(100)
    second = job(bench, "move_absolute", target=900.0, buffer_mode="buffered", **DYNAMICS)
    added = job(bench, "move_superimposed", distance=100.0, velocity_difference=50.0, **OWN)
    run_to_standstill(bench)
    assert end_of(bench, first).cycle == start_of(bench, second) < end_of(bench, added).cycle
    assert bench.column("set_position")[-1] == pytest.approx(900.0, abs=1e-11)
    assert_axis_smooth(bench, acceleration=A + 800.0, jerk=J + 8000.0)


def test_a_blended_motion_is_entered_so_that_it_can_still_end_in_its_target() -> None:
    """Of the 100 mm between the targets the addition takes 90."""
    bench = axis_bench()
    bench.accepted("move_absolute", target=800.0, **DYNAMICS)
    bench.run(100)
    bench.accepted("move_absolute", target=900.0, buffer_mode="blending_high", **DYNAMICS)
    bench.accepted("move_superimposed", distance=90.0, velocity_difference=200.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == pytest.approx(900.0, abs=1e-11)
    assert max(bench.column("set_position")) <= 900.0 + 1e-9


@pytest.mark.parametrize("target", [50.0, 1500.0])
def test_a_new_target_is_a_position_of_the_axis(target: float) -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=1000.0, **DYNAMICS)
    bench.run(100)
    bench.accepted("move_superimposed", distance=100.0, velocity_difference=50.0, **OWN)
    bench.run(100)
    bench.accepted("new_target", target=target)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == pytest.approx(target, abs=1e-11)


# ---------------------------------------------------------------- its end


def test_halt_superimposed_ends_it_on_its_ramp_and_nothing_else() -> None:
    bench, alone = both("move_absolute", {"target": 3000.0, **DYNAMICS})
    number = job(bench, "move_superimposed", distance=500.0, velocity_difference=80.0, **OWN)
    bench.run(500)
    halt = job(bench, "halt_superimposed")
    bench.run(3000)
    alone.run(3500)
    assert [event[0:2] for event in told(bench)] == [
        (1, ACTIVE), (number, ACTIVE), (number, ABORTED), (halt, ACTIVE), (halt, DONE), (1, DONE)
    ]  # fmt: skip
    added = difference(bench, alone, 0)
    ramp = 80.0 / 800.0 + 800.0 / 8000.0
    assert end_of(bench, halt).cycle == 700 + round(ramp / CYCLE_TIME)
    assert added[-1][0] == pytest.approx(added[700][0] + 0.5 * 80.0 * ramp, abs=1e-9)
    assert end_of(bench, 1) == end_of(alone, 1)


def test_halt_superimposed_without_any_is_done_immediately() -> None:
    bench = axis_bench()
    record = bench.give("halt_superimposed")
    bench.run(10)
    assert record.message == "axis x: halt_superimposed without effect: no superimposed motion is active"
    assert told(bench) == [(1, ACTIVE), (1, DONE)]


def test_a_distance_of_0_is_done_immediately() -> None:
    bench = axis_bench(encoder_increment=0.01)
    assert bench.accepted("move_superimposed", distance=0.0) == (
        "P-WARN-23007 axis x: move_superimposed over 0 mm: there is no distance to add; nothing is added"
    )
    bench.run(10)
    assert told(bench) == [(1, ACTIVE), (1, DONE)] and bench.state == S.STANDSTILL


def test_a_distance_below_an_increment_is_done_immediately() -> None:
    bench = axis_bench(encoder_increment=0.01)
    message = bench.accepted("move_superimposed", distance=0.005)
    assert message == (
        "P-WARN-23007 axis x: move_superimposed over 0.005 mm is below one encoder increment (0.01 mm); nothing is added"
    )
    bench.run(10)
    assert told(bench) == [(1, ACTIVE), (1, DONE)] and bench.state == S.STANDSTILL


ENDS = {
    "stop": ({}, S.STOPPING),
    "halt": ({}, S.DISCRETE_MOTION),
    "reset": ({}, S.STOPPING),
    "power": ({"enabled": False}, S.STOPPING),
    "emergency_stop": ({"deceleration": 8000.0, "jerk": 90_000.0}, S.STOPPING),
    "upstream_lost": ({"source": "plc"}, S.ERROR_STOP),
}


@pytest.mark.parametrize("command", ENDS)
@pytest.mark.parametrize("basic", [True, False])
def test_what_stops_the_axis_ends_it_too(command: str, basic: bool) -> None:
    """Each on its own ramp, an emergency stop and a fault with the sum; the state lasts until both are at rest."""
    bench = axis_bench()
    if basic:
        bench.accepted("move_absolute", target=3000.0, **DYNAMICS)
        bench.run(450)
    number = job(bench, "move_superimposed", distance=2000.0, velocity_difference=80.0, **OWN)
    bench.run(250)
    at, (arguments, state) = bench.cycle, ENDS[command]
    bench.accepted(command, **arguments)
    bench.run(3000)
    fault = command == "upstream_lost"
    assert end_of(bench, number) == JobEvent(number, FAILED if fault else ABORTED, at, 26101 if fault else 0)
    assert bench.column("state")[at] == state and bench.column("set_velocity")[-1] == 0.0
    moving = np.nonzero(column(bench, "set_velocity"))[0][-1]
    if not fault:
        assert bench.column("state")[moving] == state
    assert_axis_smooth(bench, acceleration=9000.0, jerk=98_000.0)


def test_an_aborting_motion_ends_it_and_takes_its_place() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=3000.0, **DYNAMICS)
    bench.run(450)
    added = job(bench, "move_superimposed", distance=2000.0, velocity_difference=80.0, **OWN)
    bench.run(250)
    at = bench.cycle
    bench.accepted("move_absolute", target=1000.0, buffer_mode="aborting", **DYNAMICS)
    run_to_standstill(bench)
    assert end_of(bench, added) == JobEvent(added, ABORTED, at)
    assert bench.column("set_position")[-1] == pytest.approx(1000.0, abs=1e-11)
    assert_axis_smooth(bench, acceleration=A + 800.0, jerk=J + 8000.0)


def test_without_its_feed_release_it_comes_to_rest_and_nothing_else_does() -> None:
    bench, alone = both("move_velocity", {"velocity": -300.0})
    number = job(bench, "move_superimposed", distance=900.0, velocity_difference=80.0, **OWN)
    for each in (bench, alone):
        each.run(500)
        each.accepted("set_feed_release", forward=False, backward=True)
        each.run(1000)
    assert end_of(bench, number) == JobEvent(number, ABORTED, 700)
    assert bench.event_texts() == [] and column(bench, "set_velocity")[-1] == column(alone, "set_velocity")[-1]
    assert bench.refusal("move_superimposed", distance=1.0) == refused(23058)


# ---------------------------------------------------------------- one after the other (PLCopen: the new one counts)


RAMP = 2.0 * (50.0 / 8000.0) ** 0.5
"""Seconds from rest to 50 mm/s with OWN: 800 mm/s² are not reached."""


def seconds_of(distance: float) -> float:
    """From rest to rest with OWN: by four equal phases of jerk below 50 mm/s, otherwise with constant velocity."""
    four = 4.0 * (distance / (2.0 * 8000.0)) ** (1.0 / 3.0)
    return four if 8000.0 * (four / 4.0) ** 2 < 50.0 else RAMP + distance / 50.0


@pytest.mark.parametrize("distance", [40.0, 3.0, 0.0, -60.0])
@pytest.mark.parametrize("basic", [True, False])
def test_a_second_one_takes_the_place_of_the_first(basic: bool, distance: float) -> None:
    """At its constant velocity: a distance that counts from there, and the rest of the first one is never covered."""
    bench, alone = axis_bench(), axis_bench()
    for each in (bench, alone) if basic else ():
        each.accepted("move_absolute", target=3000.0, **DYNAMICS)
        each.run(200)
    begin = bench.cycle
    first = job(bench, "move_superimposed", distance=200.0, velocity_difference=50.0, **OWN)
    bench.run(500)
    covered = 0.5 * 50.0 * RAMP + 50.0 * (500 * CYCLE_TIME - RAMP)
    at = bench.cycle
    second = job(bench, "move_superimposed", distance=distance, velocity_difference=50.0, **OWN)
    run_to_standstill(bench)
    alone.run(bench.cycle - alone.cycle)
    added = difference(bench, alone, begin)
    assert added[500][0] == pytest.approx(covered, abs=1e-9) and added[500][1] == pytest.approx(50.0, abs=1e-9)
    assert added[-1][0] == pytest.approx(covered + distance, abs=1e-9)
    events = [event for event in told(bench) if event[0] in (first, second)]
    assert events == [(first, ACTIVE), (first, ABORTED), (second, ACTIVE), (second, DONE)]
    stopping = 0.5 * 50.0 * RAMP
    seconds = RAMP + (distance - stopping) / 50.0 if distance > stopping else RAMP + seconds_of(stopping - distance)
    assert end_of(bench, first).cycle == start_of(bench, second) == at
    assert end_of(bench, second).cycle == at + int(np.ceil(seconds / CYCLE_TIME - 1e-9))
    assert added[:, 0].max() <= max(covered + stopping, covered + distance) + 1e-9
    assert_axis_smooth(bench, acceleration=(A if basic else 0.0) + 800.0, jerk=(J if basic else 0.0) + 8000.0)


def test_a_second_one_counts_while_the_first_comes_to_rest() -> None:
    """Behind halt_superimposed, too, and behind the end of the first as it ever did."""
    bench = axis_bench()
    bench.accepted("move_superimposed", distance=200.0, velocity_difference=50.0, **OWN)
    bench.run(500)
    bench.accepted("halt_superimposed")
    bench.run(100)
    where = bench.column("set_position")[-1] + CYCLE_TIME * bench.column("set_velocity")[-1]
    halt, second = 2, job(bench, "move_superimposed", distance=30.0, velocity_difference=50.0, **OWN)
    run_to_standstill(bench)
    assert (halt, ABORTED) in told(bench) and told(bench)[-1] == (second, DONE)
    assert bench.column("set_position")[-1] == pytest.approx(where + 30.0, abs=0.01)
    assert_axis_smooth(bench, acceleration=800.0, jerk=8000.0)


def test_a_weaker_ramp_leads_no_further_than_the_first_would_have() -> None:
    """With 10 mm/s² alone it would need 125 mm to stop: the ramp of the first counts where that is stronger."""
    bench = axis_bench(soft_limit_positive=60.0)
    bench.accepted("move_superimposed", distance=59.0, velocity_difference=50.0, **OWN)
    bench.run(1000)
    weak = {"acceleration": 10.0, "deceleration": 10.0, "jerk": 100.0}
    second = job(bench, "move_superimposed", distance=1.0, velocity_difference=5.0, **weak)
    run_to_standstill(bench)
    assert max(bench.column("set_position")) <= 59.0 and told(bench)[-1] == (second, DONE)
    assert_axis_smooth(bench, acceleration=800.0, jerk=8000.0)


def test_a_second_one_that_is_refused_leaves_the_first() -> None:
    """Its end and its direction are checked from where the first one is; a slower one fits beside the same motion."""
    bench = axis_bench(soft_limit_positive=1000.0, max_velocity=2000.0, reference_velocity=2000.0)
    bench.accepted("move_absolute", target=900.0, **DYNAMICS | {"velocity": 1000.0})
    bench.run(200)
    first = job(bench, "move_superimposed", distance=100.0, velocity_difference=50.0, **OWN)
    bench.run(500)
    covered = 0.5 * 50.0 * RAMP + 50.0 * (500 * CYCLE_TIME - RAMP)
    over = bench.refusal("move_superimposed", distance=100.0)
    assert over[0] == 120002 and over[1]["target"] == pytest.approx(1000.0 + covered, abs=1e-9)
    assert bench.refusal("move_superimposed", distance=1.0, velocity_difference=1500.0)[0] == 23004
    bench.accepted("set_feed_release", forward=True, backward=False)
    assert bench.refusal("move_superimposed", distance=-30.0) == refused(23058)
    assert bench.refusal("move_superimposed", distance=1.0, velocity_difference=50.0, **OWN) == refused(23058)
    bench.accepted("move_superimposed", distance=10.0, velocity_difference=20.0, **OWN)
    run_to_standstill(bench)
    assert (first, ABORTED) in told(bench)
    assert bench.column("set_position")[-1] == pytest.approx(900.0 + covered + 10.0, abs=1e-9)


@pytest.mark.parametrize("count", [1, 7, 1000])
def test_one_after_the_other_does_not_depend_on_the_size_of_blocks(count: int) -> None:
    benches = axis_bench(count=10), axis_bench(count=count)
    for bench in benches:
        bench.accepted("move_absolute", target=300.0, **DYNAMICS)
        for distance in (90.0, -20.0, 5.0):
            bench.accepted("move_superimposed", distance=distance, velocity_difference=60.0, **OWN)
            bench.run(137)
        bench.run(3000)
    assert benches[0].columns() == benches[1].columns()
    assert told(benches[0]) == told(benches[1])


def test_a_slave_and_an_axis_on_a_path_take_the_second_one_too() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=0.5)
    bench.do("x", "move_absolute", target=1000.0, velocity=500.0)
    bench.run(0.5)
    bench.do("y", "move_superimposed", distance=400.0, velocity_difference=50.0, **OWN)
    bench.run(0.5)
    bench.do("y", "move_superimposed", distance=-5.0, velocity_difference=50.0, **OWN)
    bench.run(4.0)
    covered = 0.5 * 50.0 * RAMP + 50.0 * (0.51 - RAMP)
    assert bench.position("y") == pytest.approx(500.0 + covered - 5.0, abs=1e-9)


# ---------------------------------------------------------------- limits


def test_the_sum_of_the_velocities_is_limited() -> None:
    bench = axis_bench(max_velocity=2000.0, reference_velocity=2000.0)
    bench.accepted("move_absolute", target=3000.0, **DYNAMICS | {"velocity": 1950.0})
    bench.run(400)
    assert bench.refusal("move_superimposed", distance=10.0, velocity_difference=51.0) == refused(
        23004, velocity=2001.0, limit=2000.0
    )
    bench.accepted("move_superimposed", distance=10.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 3010.0
    assert 1990.0 < max(bench.column("set_velocity")) <= 2000.0 * (1.0 + 1e-12)


def test_without_anything_left_the_difference_must_be_given_and_is_refused() -> None:
    bench = axis_bench(max_velocity=2000.0, reference_velocity=2000.0)
    bench.accepted("move_absolute", target=3000.0)
    bench.run(300)
    assert bench.refusal("move_superimposed", distance=10.0)[0] == 23004


def test_a_basic_motion_that_begins_meanwhile_leaves_it_its_velocity() -> None:
    """Up to 1900 mm/s while 100 are added, 2000 as soon as that has ended."""
    bench = axis_bench(max_velocity=2000.0, reference_velocity=2000.0)
    added = job(bench, "move_superimposed", distance=300.0, velocity_difference=100.0, **OWN)
    bench.run(500)
    bench.accepted("move_absolute", target=20_000.0, buffer_mode="buffered")
    bench.run(5000)
    velocity, end = column(bench, "set_velocity"), end_of(bench, added).cycle
    assert velocity.max() <= 2000.0 * (1.0 + 1e-12)
    assert velocity[2000] == pytest.approx(2000.0) and velocity[end] == pytest.approx(1900.0)
    assert velocity[end + 300] == pytest.approx(2000.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == pytest.approx(20_000.0, abs=1e-9)
    assert_axis_smooth(bench, acceleration=A + 800.0, jerk=J + 8000.0)


def test_a_motion_at_a_velocity_still_ends_at_the_soft_limit() -> None:
    bench = axis_bench(soft_limit_positive=1000.0)
    bench.accepted("move_velocity", velocity=500.0)
    bench.run(300)
    bench.accepted("move_superimposed", distance=200.0, velocity_difference=100.0, **OWN)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == pytest.approx(1000.0, abs=1e-9)
    assert max(bench.column("set_position")) <= 1000.0 + 1e-9
    assert bench.event_texts() == [
        "P-ERR-23070 axis x: the motion at a velocity has reached the positive soft limit 1000.0 mm (P-AXIS-00178); "
        "a superimposed motion moves the axis now"
    ]


def test_a_distance_away_from_the_soft_limit_lets_no_motion_end_beyond_it() -> None:
    """Seeds 400711 and 401393 of bench.random_commands: the motion ended later by a distance to come."""
    for stop in (False, True):
        bench = axis_bench(soft_limit_positive=1000.0)
        bench.accepted("move_velocity", velocity=500.0, deceleration=50.0)
        bench.run(300)
        bench.accepted("move_superimposed", distance=-200.0, velocity_difference=20.0, **OWN)
        if stop:
            bench.run(2000)
            bench.accepted("stop")
        run_to_standstill(bench)
        assert max(bench.column("set_position")) <= 1000.0 + 1e-9
    bench = axis_bench(soft_limit_positive=1000.0, soft_limit_negative=-1000.0)
    bench.accepted("move_velocity", velocity=500.0)
    bench.run(300)
    assert bench.refusal("move_superimposed", distance=-1e300) == refused(120003, target=-1e300, limit=-1000.0)


def test_it_is_refused_where_it_would_lead_beyond_a_soft_limit() -> None:
    bench = axis_bench(soft_limit_positive=1000.0)
    bench.accepted("move_absolute", target=950.0, **DYNAMICS)
    bench.run(100)
    assert bench.refusal("move_superimposed", distance=51.0) == refused(120002, target=1001.0, limit=1000.0)
    bench.accepted("move_relative", distance=30.0, buffer_mode="buffered")
    assert bench.refusal("move_superimposed", distance=30.0) == refused(120002, target=1010.0, limit=1000.0)
    near = axis_bench(soft_limit_positive=1000.0)
    near.accepted("move_velocity", velocity=1000.0)
    near.run(990)
    assert near.refusal("move_superimposed", distance=30.0) == refused(120002, target=1030.0, limit=1000.0)


# ---------------------------------------------------------------- other sources


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("disabled", 23005),
        ("stopping", 23005),
        ("error_stop", 23005),
        ("external", 23027),
        ("external_beside", 23027),
        ("compensating", 23015),
    ],
)
def test_where_it_is_not_permitted(name: str, number: int) -> None:
    bench = axis_bench()
    STATES[name][0](bench)
    assert bench.refusal("move_superimposed", distance=1.0)[0] == number


def test_nothing_else_is_superimposed_meanwhile() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=3000.0, **DYNAMICS)
    bench.run(100)
    bench.accepted("move_superimposed", distance=100.0, velocity_difference=50.0)
    compensation = {"length": 200.0, "difference": 5.0, "process_velocity": 1000.0, "velocity_increase": 100.0}
    assert bench.refusal("compensation_start", **compensation) == refused(23059)
    assert bench.refusal("external_enable", mode="relative") == refused(23059)
    bench.run(3000)
    bench.accepted("move_superimposed", distance=1.0)


def test_a_slave_adds_it_to_the_motion_of_its_master() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=0.5)
    bench.do("x", "move_absolute", target=1000.0, velocity=500.0)
    bench.run(0.5)
    bench.do("y", "move_superimposed", distance=-40.0, velocity_difference=50.0)
    bench.run(4.0)
    assert bench.position("y") == pytest.approx(500.0 - 40.0, abs=1e-9) and bench.position("x") == 1000.0
    events = [event for block in bench.blocks["y"] for event in block.job_events]
    assert [(event.job, event.status) for event in events] == [(1, ACTIVE), (2, ACTIVE), (2, DONE)]
    bench.do("y", "move_superimposed", distance=40.0, velocity_difference=50.0)
    bench.run(2.0)
    bench.do("y", "decouple")
    bench.do("y", "move_absolute", target=3.0)
    bench.run(3.0)
    assert bench.position("y") == 3.0


def test_a_slave_of_it_follows_the_sum() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=2.0)
    bench.do("x", "move_superimposed", distance=30.0, velocity_difference=50.0)
    bench.run(3.0)
    assert (bench.position("x"), bench.position("y")) == (30.0, 60.0)


def test_on_the_path_of_a_channel_it_shifts_the_axis() -> None:
    """The axis stays away from the path when the addition has ended."""
    bench = axis_bench()
    follow_path(bench, velocity=100.0)
    bench.accepted("move_superimposed", distance=5.0, velocity_difference=50.0)
    follow_path(bench, 100, velocity=100.0, begin=bench.cycle * 0.1)
    assert bench.state == S.SYNCHRONIZED_MOTION
    assert bench.column("set_position")[-1] == pytest.approx((bench.cycle - 1) * 0.1 + 5.0, abs=1e-9)
    assert told(bench) == [(1, ACTIVE), (1, DONE)]
