"""Random command sequences on an axis: no step, limits kept, always a standstill at the end."""

from __future__ import annotations

from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from long_support import examples
from machine_support import UnitBench, assert_smooth, axis_bench

from cnc_ptp.protocol.axis_states import AxisStateCode as S

A, J = 5000.0, 50_000.0
QUICK = settings(
    max_examples=examples(50), deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)

dynamics = st.fixed_dictionaries(
    {
        "velocity": st.floats(1.0, 2000.0),
        "acceleration": st.floats(100.0, A),
        "deceleration": st.floats(100.0, A),
        "jerk": st.floats(1000.0, J),
    }
)
moves = st.tuples(
    st.just("move_absolute"),
    st.builds(lambda target, limits: {"target": target, **limits}, st.floats(-200.0, 200.0), dynamics),
)
relative = st.tuples(st.just("move_relative"), st.fixed_dictionaries({"distance": st.floats(-50.0, 50.0)}))
overrides = st.tuples(
    st.just("set_override"),
    st.fixed_dictionaries(
        {"percent": st.one_of(st.sampled_from([0.0, 20.0, 50.0, 75.0, 100.0]), st.floats(0.0, 100.0))}
    ),
)
targets = st.floats(-200.0, 200.0)
redirections = st.one_of(
    st.tuples(st.just("new_target"), st.fixed_dictionaries({"target": targets})),
    st.tuples(
        st.just("new_velocity_and_target"),
        st.fixed_dictionaries({"velocity": st.floats(1.0, 2000.0), "target": targets, "activation_position": targets}),
    ),
)
modulo = st.tuples(st.just("move_modulo"), st.fixed_dictionaries({"position": st.floats(-400.0, 400.0)}))
types = st.tuples(st.just("set_override_type"), st.fixed_dictionaries({"type": st.integers(1, 4)}))
emergency = st.tuples(
    st.just("emergency_stop"),
    st.fixed_dictionaries({"deceleration": st.floats(1000.0, A), "jerk": st.floats(1000.0, J)}),
)
others = st.sampled_from(
    [
        ("stop", {}),
        ("stop", {}),
        ("halt", {}),
        ("halt", {}),
        ("reset", {}),
        ("power", {"enabled": False}),
        ("power", {"enabled": True}),
        ("upstream_lost", {"source": "plc"}),
    ]
)
pauses = st.integers(0, 120)
VELOCITY = {"max_velocity": 2000.0, "reference_velocity": 2000.0}
Commands = list[tuple[tuple[str, dict[str, Any]], int]]


def play(bench: UnitBench, commands: Commands) -> None:
    for (name, arguments), pause in commands:
        bench.give(name, **arguments)
        bench.run(pause)


def check(bench: UnitBench) -> None:
    """Smooth but for the positions where an enable takes over the actual position."""
    states = bench.column("state")
    p, v, a = (bench.column(f"set_{name}") for name in ("position", "velocity", "acceleration"))
    enabled = [k for k in range(1, len(states)) if states[k - 1] == S.DISABLED != states[k]]
    begin = 0
    for end in [*enabled, len(p)]:
        assert_smooth(p[begin:end], v[begin:end], a[begin:end], acceleration=A, jerk=J)
        begin = end
    for k in enabled:
        assert abs(p[k] - p[k - 1]) < 1e-2 and v[k] == v[k - 1] == 0.0
    assert max(map(abs, v)) <= 2000.0 * (1 + 1e-12) + 0.5 * A * A / J


@QUICK
@given(
    kind=st.sampled_from([1, 2, 3, 4]),
    steps=st.sampled_from([0, 200]),
    commands=st.lists(
        st.tuples(
            st.one_of(moves, relative, modulo, overrides, redirections, redirections, types, emergency, others), pauses
        ),
        max_size=20,
    ),
)
def test_random_commands_never_step_and_always_end_standing(kind: int, steps: int, commands: Commands) -> None:
    bench = axis_bench(count=1000, override_type=kind, override_steps=steps, modulo=True, modulo_high=360.0, **VELOCITY)
    play(bench, commands)
    bench.give("stop")
    for _ in range(40):
        bench.run(500)
        if bench.column("set_velocity")[-1] == 0.0 and bench.column("set_acceleration")[-1] == 0.0:
            break
    bench.run(1)
    assert bench.state in (S.DISABLED, S.STANDSTILL, S.ERROR_STOP)
    assert not bench.column("status_bits")[-1] & (1 << 8)
    check(bench)


@QUICK
@given(
    kind=st.sampled_from([1, 2, 3, 4]),
    target=st.floats(-200.0, 200.0),
    limits=dynamics,
    changes=st.lists(st.tuples(overrides, pauses), max_size=10),
)
def test_overrides_never_lose_the_target(kind: int, target: float, limits: dict[str, float], changes: Commands) -> None:
    """With 100 % at the end every job arrives exactly, without passing its target, in the direction of its start."""
    bench = axis_bench(count=1000, override_type=kind)
    bench.give("move_absolute", target=target, **limits)
    play(bench, changes)
    bench.give("set_override", percent=100.0)
    for _ in range(250):  # 200 mm at 1 mm/s
        bench.run(1000)
        if bench.state == S.STANDSTILL:
            break
    p, v = bench.column("set_position"), bench.column("set_velocity")
    percents = bench.column("override_percent")
    slowest = min([percent for percent in percents if percent], default=100.0)
    if bench.state != S.STANDSTILL:  # types 1 and 2 keep a slow table
        assert slowest < 100.0 and v[-1] != 0.0
        return
    assert p[-1] == target
    sign = 1.0 if target > 0.0 else -1.0
    tolerance = 1e-9 * max(1.0, abs(target))
    assert all(sign * velocity >= -1e-9 for velocity in v)
    assert all(-tolerance <= sign * position <= sign * target + tolerance for position in p)
    check(bench)


@QUICK
@given(
    kind=st.sampled_from([1, 2, 3, 4]),
    count=st.sampled_from([1, 7, 10, 333]),
    limits=dynamics,
    commands=st.lists(
        st.tuples(st.one_of(redirections, overrides, st.sampled_from([("stop", {}), ("halt", {})])), pauses),
        min_size=1,
        max_size=10,
    ),
)
def test_random_commands_on_the_fly_do_not_depend_on_blocks(
    kind: int, count: int, limits: dict[str, float], commands: Commands
) -> None:
    """Commands at the same cycles: activations, waiting targets and filtered overrides come at the same cycles too."""
    benches = []
    for size in (1000, count):
        bench = axis_bench(count=size, override_type=kind, override_steps=200, override_interval=0.05, **VELOCITY)
        bench.accepted("move_absolute", target=150.0, **limits)
        play(bench, commands)
        bench.run(700)
        benches.append(bench)
    assert benches[0].columns() == benches[1].columns()
    check(benches[1])


@QUICK
@given(
    kind=st.sampled_from([1, 2, 3, 4]),
    limits=dynamics,
    commands=st.lists(st.tuples(st.one_of(redirections, overrides), pauses), min_size=1, max_size=10),
    last=redirections,
)
def test_the_last_target_is_always_reached(
    kind: int, limits: dict[str, float], commands: Commands, last: tuple[str, dict[str, float]]
) -> None:
    """However often it was redirected: at override 100 % the axis ends exactly at its last target."""
    bench = axis_bench(count=1000, override_type=kind, **VELOCITY)
    bench.accepted("move_absolute", target=150.0, **limits)
    play(bench, commands)
    bench.give("set_override", percent=100.0)
    if not bench.give(last[0], **last[1]).accepted:  # it stands at its target already
        return
    for _ in range(600):
        bench.run(1000)
        if bench.state == S.STANDSTILL:
            break
    assert bench.state == S.STANDSTILL and bench.column("set_position")[-1] == last[1]["target"]
    check(bench)


@QUICK
@given(
    cycle=st.integers(0, 1200),
    percents=st.lists(st.floats(0.0, 100.0), min_size=1, max_size=4),
    pause=st.integers(1, 300),
)
def test_types_3_and_4_are_never_slower_than_1_and_2(cycle: int, percents: list[float], pause: int) -> None:
    times = {}
    for kind in (1, 2, 3, 4):
        bench = axis_bench(count=1000, override_type=kind)
        bench.give("move_absolute", target=1000.0, velocity=2000.0, acceleration=A, deceleration=A, jerk=J)
        bench.run(cycle)
        for percent in [*percents, 100.0]:
            bench.give("set_override", percent=percent)
            bench.run(pause)
        bench.run(1000)
        times[kind] = bench.column("set_position")[-1]
    assert times[3] >= times[1] - 1e-9 and times[4] >= times[2] - 1e-9
