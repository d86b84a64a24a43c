"""Random motions of PLCopen at random moments: limits kept, targets exact, every accepted job ends exactly once."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from job_support import DONE, assert_each_ends_once, job_events
from long_support import examples
from machine_support import UnitBench, assert_smooth, axis_bench

from cnc_ptp.protocol.axis_states import AxisStateCode as S

A, J, V = 5000.0, 50_000.0, 2000.0
ADDED_A, ADDED_J, ADDED_V = 1000.0, 10_000.0, 200.0
LIMITS = {"max_velocity": V, "reference_velocity": V, "soft_limit_negative": -2000.0, "soft_limit_positive": 2000.0}
QUICK = settings(
    max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
Commands = list[tuple[tuple[str, dict[str, Any]], int]]

modes = st.sampled_from(
    ["aborting", "aborting", "buffered", "blending_low", "blending_previous", "blending_next", "blending_high"]
)
dynamics = {
    "velocity": st.floats(20.0, V),
    "acceleration": st.floats(300.0, A),
    "deceleration": st.floats(300.0, A),
    "jerk": st.floats(3000.0, J),
}
positions = st.floats(-300.0, 300.0)


def motions(command: str, argument: str, values: st.SearchStrategy[float]) -> st.SearchStrategy[Any]:
    arguments = {**dynamics, argument: values, "buffer_mode": modes}
    return st.tuples(st.just(command), st.fixed_dictionaries(arguments))


absolute = motions("move_absolute", "target", positions)
moves = st.one_of(
    absolute,
    absolute,
    motions("move_relative", "distance", positions),
    motions("move_additive", "distance", positions),
    motions("move_velocity", "velocity", st.one_of(st.just(0.0), st.floats(-V, -10.0), st.floats(10.0, V))),
)
additions = st.one_of(
    st.tuples(
        st.just("move_superimposed"),
        st.fixed_dictionaries(
            {
                "distance": st.floats(-100.0, 100.0),
                "velocity_difference": st.floats(1.0, ADDED_V),
                "acceleration": st.floats(100.0, ADDED_A),
                "deceleration": st.floats(100.0, ADDED_A),
                "jerk": st.floats(1000.0, ADDED_J),
            }
        ),
    ),
    st.just(("halt_superimposed", {})),
)
overrides = st.tuples(st.just("set_override"), st.fixed_dictionaries({"percent": st.sampled_from([0.0, 30.0, 100.0])}))
releases = st.tuples(
    st.just("set_feed_release"), st.fixed_dictionaries({"forward": st.booleans(), "backward": st.booleans()})
)
others = st.sampled_from(
    [
        ("stop", {}),
        ("halt", {}),
        ("halt", {}),
        ("reset", {}),
        ("new_target", {"target": 55.0}),
        ("jog", {"velocity": 300.0}),
        ("jog", {"velocity": 0.0}),
        ("emergency_stop", {"deceleration": A, "jerk": J}),
        ("power", {"enabled": False}),
        ("power", {"enabled": True}),
        ("upstream_lost", {"source": "plc"}),
    ]
)
pauses = st.integers(0, 400)


def play(bench: UnitBench, commands: Commands) -> dict[int, tuple[str, dict[str, Any]]]:
    """Gives the commands; the accepted jobs by number."""
    jobs = {}
    for (name, arguments), pause in commands:
        record = bench.give(name, **arguments)
        if record.job:
            jobs[record.job] = (name, arguments)
        bench.run(pause)
    return jobs


def settle(bench: UnitBench, jobs: dict[int, tuple[str, dict[str, Any]]], *, stop: bool) -> None:
    """To standstill: what is endless, or held, is stopped."""
    bench.give("set_feed_release", forward=True, backward=True)
    bench.give("set_override", percent=100.0)
    for _ in range(100):
        bench.run(1000)
        if bench.state in (S.STANDSTILL, S.DISABLED, S.ERROR_STOP) and not bench.column("set_velocity")[-1]:
            return
        if stop or bench.state == S.CONTINUOUS_MOTION:
            jobs[bench.give("stop").job] = ("stop", {})
    raise AssertionError("the axis does not come to rest")


def check(bench: UnitBench, *, added: bool) -> None:
    """Smooth but for the position that an enable takes over; V and A of the axis hold at any time."""
    states = bench.column("state")
    p, v, a = (bench.column(f"set_{name}") for name in ("position", "velocity", "acceleration"))
    most, jerk = (A + ADDED_A, J + ADDED_J) if added else (A, J)
    cuts = [k for k in range(1, len(states)) if states[k - 1] == S.DISABLED != states[k]]
    for begin, end in zip([0, *cuts], [*cuts, len(p)], strict=True):
        assert_smooth(p[begin:end], v[begin:end], a[begin:end], acceleration=most, jerk=jerk)
    assert max(map(abs, v)) <= V * (1.0 + 1e-9)
    assert max(map(abs, p)) <= 2000.0 + 1e-6


@QUICK
@given(
    commands=st.lists(st.tuples(st.one_of(moves, moves, additions, overrides, releases, others), pauses), max_size=14)
)
def test_limits_are_kept_and_every_job_ends_once(commands: Commands) -> None:
    bench = axis_bench(count=1000, **LIMITS)
    jobs = play(bench, commands)
    settle(bench, jobs, stop=False)
    check(bench, added=True)
    assert_each_ends_once(bench, set(jobs))
    assert {event.error_id for event in bench.events if event.severity == 2} <= {26101, 23058}


@QUICK
@given(commands=st.lists(st.tuples(st.one_of(moves, moves, overrides), pauses), min_size=1, max_size=10))
def test_whatever_has_been_done_is_exactly_at_its_target(commands: Commands) -> None:
    """A positioning is done in its target, or passes it within a cycle where the next one is blended."""
    bench = axis_bench(count=1000, **LIMITS)
    jobs = play(bench, commands)
    settle(bench, jobs, stop=False)
    check(bench, added=False)
    p, v = bench.column("set_position"), bench.column("set_velocity")
    for event in job_events(bench):
        name, arguments = jobs[event.job]
        if event.status != DONE or name != "move_absolute":
            continue
        place, speed, target = p[event.cycle], v[event.cycle], arguments["target"]
        if speed == 0.0:
            assert place == target
        else:
            assert 0.0 <= (place - target) * (1.0 if speed > 0.0 else -1.0) <= abs(speed) * 0.001 * (1.0 + 1e-6) + 1e-6


@QUICK
@given(
    commands=st.lists(st.tuples(st.one_of(absolute, absolute, additions), pauses), min_size=1, max_size=10),
    last=absolute,
)
def test_the_last_target_is_reached_under_superimposed_motion(
    commands: Commands, last: tuple[str, dict[str, Any]]
) -> None:
    """An aborting motion ends where it was sent, up to rounding, whatever was being added."""
    bench = axis_bench(count=1000, **LIMITS)
    jobs = play(bench, commands)
    record = bench.give(last[0], **{**last[1], "buffer_mode": "aborting"})
    jobs[record.job] = last
    settle(bench, jobs, stop=False)
    check(bench, added=True)
    assert abs(bench.column("set_position")[-1] - last[1]["target"]) <= 1e-10
    assert_each_ends_once(bench, set(jobs))


@pytest.mark.long
@QUICK
@given(
    commands=st.lists(st.tuples(st.one_of(moves, additions, overrides, others), pauses), min_size=1, max_size=10),
    count=st.sampled_from([1, 7, 10]),
)
def test_blocks_of_any_size_give_the_same_motion_and_the_same_jobs(commands: Commands, count: int) -> None:
    benches = axis_bench(count=1000, **LIMITS), axis_bench(count=count, **LIMITS)
    for bench in benches:
        play(bench, commands)
        bench.run(500)
    assert benches[0].columns() == benches[1].columns()
    assert sorted(job_events(benches[0])) == sorted(job_events(benches[1]))
    assert benches[0].events == benches[1].events


@QUICK
@given(
    commands=st.lists(
        st.tuples(st.one_of(moves, additions, overrides, releases, others), pauses), min_size=1, max_size=12
    )
)
def test_what_is_refused_changes_nothing(commands: Commands) -> None:
    """The same sequence without its refused commands gives the same bits and the same jobs."""
    bench, twin = axis_bench(count=1000, **LIMITS), axis_bench(count=1000, **LIMITS)
    for (name, arguments), pause in commands:
        if bench.give(name, **arguments).accepted:
            assert twin.give(name, **arguments).accepted
        for each in (bench, twin):
            each.run(pause + 1)
    assert bench.columns() == twin.columns() and job_events(bench) == job_events(twin)
