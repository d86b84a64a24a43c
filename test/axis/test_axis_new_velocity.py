"""New velocity and new target: six cases, reduction, successive events, override. Source: TX1250 2.4."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from axis_motion_support import (
    assert_follows,
    legs_to,
    motion,
    ramp_time,
    ramp_way,
    reachable,
    run_to_standstill,
    start,
    started,
    time_of_arrival,
)
from axis_states_support import A, J, V
from error_support import Refused, refused
from long_support import long
from machine_support import CYCLE_TIME, UnitBench, assert_axis_smooth, axis_bench, position_after, seven_phases

from cnc_ptp.protocol.axis_states import AxisStateCode as S

OLD = 1000.0
"""Velocity of the start, mm/s; its ramps take 300 ms and 150 mm."""
UNDER_WAY = 500
"""Cycle of the request: at 1000 mm/s since 300 ms, at 350 mm."""
THERE = ramp_way(0.0, OLD) + OLD * 0.2


def request(bench: UnitBench, velocity: float, target: float, activation: float, direction: float = 1.0) -> str:
    return bench.accepted(
        "new_velocity_and_target",
        velocity=velocity,
        target=direction * target,
        activation_position=direction * activation,
    )


def under_way(direction: float = 1.0, target: float = 3000.0, *, kind: int = 1, count: int = 100) -> UnitBench:
    """At 1000 mm/s towards ±3000, the position is ±350 mm."""
    bench = started(direction * target, UNDER_WAY, count=count, override_type=kind, velocity=OLD)
    assert bench.cycle == UNDER_WAY
    return bench


def finish(bench: UnitBench, target: float) -> list[float]:
    """On to the end; |v| of all cycles."""
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == target
    assert_axis_smooth(bench, acceleration=A, jerk=J)
    return [abs(velocity) for velocity in bench.column("set_velocity")]


def expected_end(stretches: list[tuple[float, float]]) -> float:
    """Seconds from rest to rest over stretches (velocity, its end in mm); velocities change where stretches end."""
    time, place, velocity = 0.0, 0.0, 0.0
    for wanted, end in stretches:
        time += ramp_time(abs(wanted - velocity))
        place += ramp_way(velocity, wanted)
        time += (end - place) / wanted
        place, velocity = end, wanted
    return time + ramp_time(velocity)


# ---------------------------------------------------------------- the six cases


@pytest.mark.parametrize("direction", [-1.0, *long([1.0])])
@pytest.mark.parametrize("new", [400.0, 2000.0, 1000.0])
@pytest.mark.parametrize("activation", [THERE, 351.0, 1000.0, 2345.678])
def test_case_1_later(direction: float, new: float, activation: float) -> None:
    """Up to the first cycle at or past the activation position nothing but the target is new."""
    bench = under_way(direction)
    assert request(bench, new, 4000.0, activation, direction) == ""
    velocities = finish(bench, direction * 4000.0)
    positions = [direction * p for p in bench.column("set_position")]
    crossing = next(k for k, p in enumerate(positions) if p >= activation)
    assert set(velocities[320 : crossing + 1]) == {OLD}
    if new != OLD:
        assert velocities[crossing + 1] != OLD and (velocities[crossing + 1] > OLD) is (new > OLD)
    rest = 4000.0 - ramp_way(new, 0.0)
    time = expected_end([(OLD, positions[crossing]), (new, rest)])
    assert time_of_arrival(bench) == pytest.approx(time, abs=1.1 * CYCLE_TIME)
    assert max(velocities[crossing:]) == pytest.approx(max(new, OLD))


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("new", [400.0, 2000.0])
@pytest.mark.parametrize("activation", [349.0, 0.0, -5000.0])
def test_case_2_at_once(direction: float, new: float, activation: float) -> None:
    bench = under_way(direction)
    request(bench, new, 4000.0, activation, direction)
    velocities = finish(bench, direction * 4000.0)
    assert velocities[UNDER_WAY] == OLD and (velocities[UNDER_WAY + 1] > OLD) is (new > OLD)
    time = expected_end([(OLD, THERE), (new, 4000.0 - ramp_way(new, 0.0))])
    assert time_of_arrival(bench) == pytest.approx(time, abs=1.1 * CYCLE_TIME)


@pytest.mark.parametrize("direction", [-1.0, *long([1.0])])
@pytest.mark.parametrize(
    ("target", "activation"),
    [
        (200.0, 100.0),  # 3: APos < EPos < Pos
        (100.0, 200.0),  # 5: EPos < APos < Pos
        (100.0, 500.0),  # 6: EPos < Pos < APos
        (THERE, 100.0),  # 3 before 2: EPos = Pos
        (100.0, THERE),  # 5, 6: APos = Pos
        (100.0, 100.0),  # 3 before 5
        (-2000.0, -1000.0),
        (400.0, 380.0),  # ahead, but the axis cannot stop before
        (400.0, 200.0),
        (499.0, 450.0),
    ],
)
@pytest.mark.parametrize("new", [50.0, 400.0, *long([2000.0])])
def test_cases_3_5_6_stop_and_return_with_the_old_velocity(
    direction: float, target: float, activation: float, new: float
) -> None:
    """If the return is too short for the old velocity and the new one can be reached on it, with the new one."""
    bench = under_way(direction)
    request(bench, new, target, activation, direction)
    finish(bench, direction * target)
    back = THERE + ramp_way(OLD, 0.0) - target
    velocity = OLD if reachable(back) >= OLD else new if reachable(back) >= new else reachable(back)
    first = (direction * THERE, direction * OLD, 0.0)
    stop = legs_to(first, direction * target)[0]
    rest = stop.at_time(stop.duration)[0][0]
    assert_follows(bench, UNDER_WAY, [stop, *legs_to((rest, 0.0, 0.0), direction * target, v=velocity)])


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("activation", [2500.001, 9e4, 1e300])
def test_case_4_never(direction: float, activation: float) -> None:
    """Pos <= EPos < APos: only the target is new."""
    bench, only_target = under_way(direction), under_way(direction)
    request(bench, 400.0, 2500.0, activation, direction)
    only_target.accepted("new_target", target=direction * 2500.0)
    finish(bench, direction * 2500.0)
    finish(only_target, direction * 2500.0)
    assert bench.columns() == only_target.columns()


def test_an_activation_at_the_target_itself_changes_nothing() -> None:
    bench, only_target = under_way(), under_way()
    request(bench, 400.0, 2500.0, 2500.0)
    only_target.accepted("new_target", target=2500.0)
    finish(bench, 2500.0)
    finish(only_target, 2500.0)
    assert bench.columns() == only_target.columns()


def test_both_directions_are_mirror_images_to_the_bit() -> None:
    benches = {}
    for direction in (1.0, -1.0):
        benches[direction] = under_way(direction)
        request(benches[direction], 1777.0, 3333.3, 1234.5, direction)
        finish(benches[direction], direction * 3333.3)
    assert motion(benches[1.0]) == [(-p, -v, -a) for p, v, a in motion(benches[-1.0])]


# ---------------------------------------------------------------- activation


@pytest.mark.parametrize("count", [7, *long([1, 1000])])
@pytest.mark.parametrize("activation", [351.3, 1000.0, *long([999.999, 2200.0])])
def test_the_activation_does_not_depend_on_blocks(count: int, activation: float) -> None:
    benches = []
    for size in (10, count):
        bench = under_way(count=size)
        request(bench, 1800.0, 4000.0, activation)
        bench.run(1234)
        bench.accepted("set_override", percent=70.0)
        bench.run(3000)
        benches.append(bench)
    assert benches[0].columns() == benches[1].columns()
    assert benches[0].column("set_position")[-1] == 4000.0


def test_a_position_that_is_passed_while_the_axis_still_accelerates() -> None:
    """At 50 ms with a > 0: the ramp to the new velocity begins from there without a step."""
    bench = started(3000.0, 50, velocity=OLD)
    request(bench, 300.0, 3000.0, 2.0)
    velocities = finish(bench, 3000.0)
    crossing = next(k for k, p in enumerate(bench.column("set_position")) if p >= 2.0)
    state = position_after(seven_phases(3000.0, OLD, A, A, J), crossing * CYCLE_TIME)
    assert state[2] > 0.0 and velocities[crossing] == pytest.approx(state[1])
    assert_follows(bench, crossing, legs_to(state, 3000.0, v=300.0))


# ---------------------------------------------------------------- reduction


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("target", [900.0, 1300.0, 2000.0])
def test_a_velocity_out_of_reach_is_reduced_in_at_most_eight_steps(kind: int, target: float) -> None:
    """Towards the old one: within (new - old)/2^8 of the highest that can be reached, and one of its multiples."""
    new = 9000.0
    bench = under_way(kind=kind)
    request(bench, new, target, 0.0)
    velocities = finish(bench, target)
    peak = max(velocities)
    step = (new - OLD) / 256
    assert ((peak - OLD) / step) == pytest.approx(round((peak - OLD) / step), abs=1e-6)
    low, high = OLD, 9000.0  # highest level v with ramps OLD -> v -> 0 within the way
    for _ in range(60):
        middle = 0.5 * (low + high)
        fits = ramp_way(OLD, middle) + ramp_way(middle, 0.0) <= target - THERE
        low, high = (middle, high) if fits else (low, middle)
    assert peak <= low * (1 + 1e-9) and low < peak + step


def test_a_slower_velocity_that_has_no_stretch_left_comes_as_near_as_it_can() -> None:
    """1 mm before the brake phase: what is left for a slower stretch lies close to the old velocity."""
    bench = under_way(target=THERE + 1.0 + ramp_way(OLD, 0.0))
    target = THERE + 1.0 + ramp_way(OLD, 0.0)
    request(bench, 10.0, target, 0.0)
    velocities = finish(bench, target)
    assert all(after <= before + 1e-9 for before, after in pairwise(velocities[UNDER_WAY:]))


@pytest.mark.parametrize(("cycle", "found"), [(2700, True), (2990, False), (3050, False), (3200, False)])
def test_the_old_table_stays_where_nothing_is_found(cycle: int, found: bool) -> None:
    """A faster velocity before and in the brake phase, which begins after 3000 ms at 2850 mm.

    The smallest step up, by 1000/256 mm/s, takes 2·√(3.9/50000) s there and back: 17.7 mm.
    """
    benches = []
    for command in ("new_velocity_and_target", "new_target"):
        bench = started(3000.0, cycle, velocity=OLD)
        extra = {"velocity": 2000.0, "activation_position": 0.0} if command == "new_velocity_and_target" else {}
        bench.accepted(command, target=3000.0, **extra)
        finish(bench, 3000.0)
        benches.append(bench)
    ours, theirs = (motion(bench) for bench in benches)
    assert (ours == theirs) is not found
    assert (max(v for _, v, _ in ours) > OLD * (1 + 1e-9)) is found


def test_a_reduced_velocity_becomes_reachable_with_a_later_target() -> None:
    """2.4: towards the velocity that the user asked for, also when it came with an earlier request."""
    bench = under_way()
    request(bench, 2000.0, 900.0, 0.0)
    bench.run(50)
    bench.accepted("new_target", target=9000.0)
    assert max(finish(bench, 9000.0)) == pytest.approx(2000.0)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_the_old_velocity_becomes_reachable_at_once_and_the_new_one_later(kind: int) -> None:
    """Start to 800 with V 2000 (1765 reachable); new target 6000, 500 mm/s from 4000 on."""
    bench = started(800.0, 250, override_type=kind)
    request(bench, 500.0, 6000.0, 4000.0)
    velocities = finish(bench, 6000.0)
    position = bench.column("set_position")
    crossing = next(k for k, p in enumerate(position) if p >= 4000.0)
    assert velocities[crossing] == pytest.approx(V) and max(velocities) == pytest.approx(V)
    rest = 6000.0 - ramp_way(500.0, 0.0)
    assert time_of_arrival(bench) == pytest.approx(
        expected_end([(V, position[crossing]), (500.0, rest)]), abs=1.1 * CYCLE_TIME
    )


# ---------------------------------------------------------------- successive events


def test_new_target_deletes_a_pending_activation() -> None:
    bench, without = under_way(), under_way()
    request(bench, 300.0, 3000.0, 1500.0)
    for each in (bench, without):
        each.run(100)
        each.accepted("new_target", target=3500.0)
        finish(each, 3500.0)
    for ours, theirs in zip(motion(bench), motion(without), strict=True):
        assert ours == pytest.approx(theirs, abs=1e-6)


def test_a_request_that_acts_at_once_deletes_a_pending_activation() -> None:
    """300 mm/s from 1500 on never comes; 1500 mm/s come immediately."""
    bench = under_way()
    request(bench, 300.0, 3000.0, 1500.0)
    bench.run(100)
    request(bench, 1500.0, 3000.0, 0.0)
    velocities = finish(bench, 3000.0)
    time = expected_end([(OLD, THERE + 100.0), (1500.0, 3000.0 - ramp_way(1500.0, 0.0))])
    assert max(velocities) == pytest.approx(1500.0)
    assert time_of_arrival(bench) == pytest.approx(time, abs=1.1 * CYCLE_TIME)


def test_a_later_two_stage_request_replaces_a_pending_one() -> None:
    bench = under_way()
    request(bench, 300.0, 3000.0, 1000.0)
    bench.run(100)
    request(bench, 1500.0, 3000.0, 1800.0)
    velocities = finish(bench, 3000.0)
    position = bench.column("set_position")
    crossing = next(k for k, p in enumerate(position) if p >= 1800.0)
    assert set(velocities[320 : crossing + 1]) == {OLD} and max(velocities) == pytest.approx(1500.0)


def test_one_after_the_other_both_act() -> None:
    bench = under_way()
    request(bench, 300.0, 3000.0, 1000.0)
    bench.run(1500)
    assert bench.column("set_velocity")[-1] == pytest.approx(300.0)
    request(bench, 1500.0, 3000.0, 1500.0)
    velocities = finish(bench, 3000.0)
    assert max(velocities[2000:]) == pytest.approx(1500.0)


@pytest.mark.parametrize("command", ["stop", "halt"])
def test_a_stop_deletes_a_pending_activation(command: str) -> None:
    """Also one that would be passed on the stop ramp; what follows goes at the old velocity."""
    bench, without = under_way(), under_way()
    request(bench, 300.0, 3000.0, 400.0)
    for each in (bench, without):
        each.run(10)
        each.accepted(command)
        each.run(100)
        each.accepted("new_target", target=2000.0)
        finish(each, 2000.0)
    for ours, theirs in zip(motion(bench), motion(without), strict=True):
        assert ours == pytest.approx(theirs, abs=1e-6)


def test_in_the_brake_phase_the_target_comes_at_once_and_the_velocity_at_its_position() -> None:
    """Braking to 3000 since 2850 mm; 5000 is the new target, 1500 mm/s from 4000 on."""
    bench = started(3000.0, 3100, velocity=OLD)
    place, speed, slope = motion(bench)[-1]
    assert place > 2850.0 and slope < 0.0 and speed < OLD
    request(bench, 1500.0, 5000.0, 4000.0)
    velocities = finish(bench, 5000.0)
    crossing = next(k for k, p in enumerate(bench.column("set_position")) if p >= 4000.0)
    assert velocities[crossing] == pytest.approx(OLD) and max(velocities) == pytest.approx(1500.0)
    assert min(velocities[3100:3300]) > 0.0


@pytest.mark.parametrize(("target", "activation"), [(4000.0, 2000.0), (-2000.0, -1000.0)])
def test_during_a_stop_it_waits_and_then_acts_in_both_stages(target: float, activation: float) -> None:
    bench = under_way()
    bench.accepted("stop")
    bench.run(50)
    assert request(bench, 400.0, target, activation) == (
        "axis x: new_velocity_and_target waits for the end of the stop"
    )
    velocities = finish(bench, target)
    states = bench.column("state")
    restart = states.index(S.DISCRETE_MOTION, UNDER_WAY)
    rest = THERE + ramp_way(OLD, 0.0)
    assert restart - UNDER_WAY == pytest.approx(1000.0 * ramp_time(OLD), abs=1.01)
    assert bench.column("set_position")[restart] == pytest.approx(rest, abs=1e-6)
    sign = math.copysign(1.0, target)
    position = bench.column("set_position")
    crossing = next(k for k in range(restart, len(position)) if sign * (position[k] - activation) >= 0.0)
    assert velocities[crossing] == pytest.approx(OLD)
    tail = abs(target - activation) - ramp_way(OLD, 400.0) - ramp_way(400.0, 0.0)
    expected = crossing * CYCLE_TIME + ramp_time(600.0) + tail / 400.0 + ramp_time(400.0)
    assert len(states) - states[::-1].index(S.DISCRETE_MOTION) == pytest.approx(1000.0 * expected, abs=3)


def test_short_successive_requests_do_not_stop_the_axis() -> None:
    """Incoherent instructions in every block; the axis continues and ends at the last target."""
    bench = under_way()
    for n in range(60):
        request(bench, 300.0 + (n * 631) % 1500, 2500.0 + (n * 977) % 2000, 300.0 + (n * 389) % 2500)
        bench.run(10)
    assert min(bench.column("set_velocity")[UNDER_WAY:]) > 100.0
    request(bench, 800.0, 4321.0, 0.0)
    finish(bench, 4321.0)


# ---------------------------------------------------------------- override


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("when", ["before", "pending", "after"])
def test_override_and_new_velocity_are_compatible(kind: int, when: str) -> None:
    """50 %: 500 mm/s of the old velocity, 300 of the new 600, whenever the override comes."""
    bench = under_way(kind=kind, target=3000.0)
    if when == "before":
        bench.accepted("set_override", percent=50.0)
        bench.run(200)
    request(bench, 600.0, 4000.0, 1500.0)
    if when == "pending":
        bench.run(200)
        bench.accepted("set_override", percent=50.0)
    if when == "after":
        bench.run(2000)
        bench.accepted("set_override", percent=50.0)
    velocities = finish(bench, 4000.0)
    crossing = next(k for k, p in enumerate(bench.column("set_position")) if p >= 1500.0)
    assert velocities[crossing] == pytest.approx(OLD if when == "after" else 500.0)
    assert velocities[-1000] == pytest.approx(300.0)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_override_0_while_pending_and_on_again(kind: int) -> None:
    bench = under_way(kind=kind)
    request(bench, 600.0, 4000.0, 1500.0)
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)
    assert bench.column("set_velocity")[-1] == 0.0
    bench.accepted("set_override", percent=100.0)
    velocities = finish(bench, 4000.0)
    crossing = next(k for k, p in enumerate(bench.column("set_position")) if p >= 1500.0)
    assert velocities[crossing] == pytest.approx(OLD) and velocities[crossing + 1] < OLD
    assert velocities[-1000] == pytest.approx(600.0)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_a_request_at_override_0_counts_when_the_axis_goes_on(kind: int) -> None:
    bench = axis_bench(count=100, override_type=kind)
    bench.accepted("set_override", percent=0.0)
    start(bench, 3000.0, velocity=OLD)
    bench.run(50)
    request(bench, 600.0, 4000.0, 1500.0)
    bench.run(50)
    bench.accepted("set_override", percent=100.0)
    velocities = finish(bench, 4000.0)
    crossing = next(k for k, p in enumerate(bench.column("set_position")) if p >= 1500.0)
    assert velocities[crossing] == pytest.approx(OLD) and velocities[-1000] == pytest.approx(600.0)


# ---------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        ({"velocity": 0.0}, refused(23003, argument="velocity", value=0.0)),
        ({"velocity": -5.0}, refused(23003, argument="velocity", value=-5.0)),
        ({"velocity": 1e-300}, refused(23003, argument="velocity", value=1e-300, limit=1e-09)),
        ({"velocity": 10_001.0}, refused(23004, velocity=10001.0, limit=10000.0)),
        (
            {"velocity": 9_000.0},
            refused(23011, velocity=9000.0, limit=8000.0),
        ),
        (
            {"target": 1e5 + 1},
            refused(120002, target=100001.0, limit=100000.0),
        ),
        (
            {"target": -1e300},
            refused(120003, target=-1e300, limit=-100000.0),
        ),
        ({"activation_position": math.inf}, refused(22001, argument="activation_position")),
    ],
)
@pytest.mark.parametrize("command", [None, "stop", "halt", "pending"])
def test_a_refused_request_leaves_the_motion_to_the_bit(
    arguments: dict[str, float], wanted: Refused, command: str | None
) -> None:
    benches = []
    for _ in range(2):
        bench = axis_bench(count=100, reference_velocity=8000.0)
        start(bench, 3000.0, velocity=OLD)
        bench.run(UNDER_WAY)
        if command == "pending":
            request(bench, 500.0, 3000.0, 1500.0)
        elif command is not None:
            bench.accepted(command)
            bench.run(50)
        benches.append(bench)
    given = {"velocity": 500.0, "target": 3000.0, "activation_position": 1000.0, **arguments}
    assert benches[0].refusal("new_velocity_and_target", **given) == wanted
    for bench in benches:
        bench.run(5500)
    assert benches[0].columns() == benches[1].columns()


def test_absurdly_slow_motions_do_not_count_their_cycles() -> None:
    """The activation position lies more cycles ahead than a machine word holds; the axis does not look for it."""
    no_limit = {"soft_limit_negative": -math.inf, "soft_limit_positive": math.inf}
    bench = axis_bench(count=10, **no_limit)
    bench.accepted("set_override", percent=0.0001)
    bench.accepted("move_absolute", target=9e11, velocity=1e-3)
    bench.run(20)
    bench.accepted("new_velocity_and_target", velocity=2e-3, target=9.1e11, activation_position=8e11)
    bench.run(20)
    assert bench.state == S.DISCRETE_MOTION and 0.0 < bench.column("set_position")[-1] < 1e-6
