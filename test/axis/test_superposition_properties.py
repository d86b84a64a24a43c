"""Any sequence of PTP, compensation and external commands: no step, no fault, always an end at rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from long_support import examples
from machine_support import CYCLE_TIME, UnitBench, axis_bench
from superposition_support import COMPENSATING, EXTERNAL, HAS_JOB, A, column, generator, has_bit

V = 2000.0
"""Largest velocity of the basic motion, mm/s; largest VK; the generator's velocity and acceleration."""
VK = 600.0
EXTERNAL_V, EXTERNAL_A = 400.0, 4000.0
VP = 500.0
"""Smallest process velocity."""
RATE = 5000.0
"""Largest AK+ and AK-, mm/s²."""

slow = settings(
    max_examples=examples(60),
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow],
)

Step = tuple[str, dict[str, Any], int]

speeds = st.floats(50.0, V)
targets = st.floats(-3000.0, 3000.0)
pauses = st.integers(0, 700)
compensations = st.fixed_dictionaries(
    {
        "length": st.floats(1.0, 4000.0),
        "difference": st.floats(-500.0, 500.0),
        "process_velocity": st.floats(VP, 3000.0),
        "velocity_increase": st.floats(1.0, VK),
        "acceleration": st.floats(100.0, RATE),
        "deceleration": st.floats(100.0, RATE),
    }
)
commands = st.one_of(
    st.tuples(st.just("move_absolute"), st.fixed_dictionaries({"target": targets, "velocity": speeds})),
    st.tuples(st.just("move_relative"), st.fixed_dictionaries({"distance": targets, "velocity": speeds})),
    st.tuples(st.just("new_target"), st.fixed_dictionaries({"target": targets})),
    st.tuples(
        st.just("new_velocity_and_target"),
        st.fixed_dictionaries({"velocity": speeds, "target": targets, "activation_position": targets}),
    ),
    st.tuples(st.just("set_override"), st.fixed_dictionaries({"percent": st.sampled_from([0.0, 1.0, 40.0, 100.0])})),
    st.tuples(st.just("compensation_start"), compensations),
    st.tuples(st.just("compensation_start"), compensations),
    st.tuples(st.just("compensation_stop"), st.just({})),
    st.tuples(
        st.just("external_enable"),
        st.fixed_dictionaries({"mode": st.sampled_from(["absolute", "relative"]), "target": st.none() | targets}),
    ),
    st.tuples(st.just("external_enable"), st.just({"mode": "relative"})),
    st.tuples(st.just("external_disable"), st.just({})),
    st.tuples(st.just("generate"), st.fixed_dictionaries({"way": st.sampled_from([300.0, -300.0, 60.0])})),
    st.tuples(st.sampled_from(["stop", "halt", "reset"]), st.just({})),
    st.tuples(st.just("power"), st.fixed_dictionaries({"enabled": st.booleans()})),
    st.tuples(st.just("upstream_lost"), st.just({"source": "plc"})),
)
steps = st.lists(st.tuples(commands, pauses), min_size=3, max_size=14)


def play(bench: UnitBench, sequence: list[tuple[tuple[str, dict[str, Any]], int]]) -> None:
    for (command, arguments), pause in sequence:
        if command == "generate":
            generate(bench, arguments["way"])
        else:
            arguments = {name: value for name, value in arguments.items() if value is not None}
            bench.give(command, **arguments)
        if pause:
            bench.run(pause)


def generate(bench: UnitBench, distance: float) -> None:
    """A generator that starts from where the axis is, as absolute or relative setpoints, whatever the state."""
    axis = bench.unit._axis  # type: ignore[attr-defined]
    start = (
        axis.setpoint(bench.cycle)[0]
        if axis.external.mode == "absolute"
        else axis.external.contribution(bench.cycle)[0] + axis.external._reference
    )
    bench.give(
        "external_setpoints",
        setpoints=generator(distance, first_cycle=bench.cycle, velocity=EXTERNAL_V, a=EXTERNAL_A, start=start),
    )


def check(bench: UnitBench) -> None:
    p, v, a = (column(bench, f"set_{name}") for name in ("position", "velocity", "acceleration"))
    t = CYCLE_TIME
    highest = V + VK + EXTERNAL_V
    assert np.abs(v).max() <= highest * (1 + 1e-9)
    most = A + RATE + A
    assert np.abs(a).max() <= most * (1 + 1e-9)
    assert (np.abs(np.diff(v)) <= most * t * (1 + 1e-9)).all(), np.argmax(np.abs(np.diff(v)))
    error = np.abs(np.diff(p) - 0.5 * t * (v[1:] + v[:-1]))
    moved = np.array(bench.column("state"))[1:] != 0  # power on takes the actual position over
    assert (error <= (0.25 * most * t * t + 1e-9))[moved | (error < 1e-6)].all(), np.argmax(error)


def rest(bench: UnitBench) -> None:
    bench.give("stop")
    for _ in range(30):
        bench.run(300)
        if not column(bench, "set_velocity")[-200:].any():
            break
    assert bench.state in (0, 1, 7)
    assert not has_bit(bench, HAS_JOB | COMPENSATING | EXTERNAL)[-1]
    assert bench.column("set_velocity")[-1] == bench.column("set_acceleration")[-1] == 0.0


@slow
@given(kind=st.sampled_from([1, 2, 3, 4]), sequence=steps)
def test_any_sequence_is_smooth_and_ends_at_rest(kind: int, sequence: Any) -> None:
    bench = axis_bench(count=1000, override_type=kind)
    play(bench, sequence)
    rest(bench)
    check(bench)
    faults = {event.error_id for event in bench.events if event.severity == 2}
    assert faults <= {26101}


@pytest.mark.long
@slow
@given(sequence=steps, count=st.sampled_from([1, 7, 10]))
def test_any_sequence_is_the_same_in_blocks_of_any_size(sequence: Any, count: int) -> None:
    benches = [axis_bench(count=size) for size in (1000, count)]
    for bench in benches:
        play(bench, sequence)
        bench.run(500)
    assert list(map(repr, benches[0].columns().values())) == list(map(repr, benches[1].columns().values()))
    assert benches[0].events == benches[1].events


@slow
@given(sequence=steps)
def test_what_is_refused_changes_nothing(sequence: Any) -> None:
    """The same sequence without its refused commands gives the same bits."""
    bench, twin = axis_bench(count=1000), axis_bench(count=1000)
    for (command, arguments), pause in sequence:
        arguments = {name: value for name, value in arguments.items() if value is not None}
        if command != "generate" and bench.give(command, **arguments).accepted:
            assert twin.give(command, **arguments).accepted
        for each in (bench, twin):
            each.run(pause + 1)
    assert bench.columns() == twin.columns()
