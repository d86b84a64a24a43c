"""Random commands on groups of slaves: the relation holds, nothing jumps, all comes to rest, a replay gives the bits."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from long_support import examples
from replay_support import bits, replay
from slave_support import COMPENSATING, COMPENSATION, DYNAMICS, PROTECTED, SlaveBench, axes_named

from cnc_ptp.protocol.axis_states import AxisStateCode as S

NAMES = ("b", "d", "a", "c")
T = 0.001
QUICK = settings(max_examples=examples(40), deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)

Step = tuple[int, str, str, dict[str, Any]]
"""Blocks before it, axis, command, arguments."""

factors = st.one_of(st.sampled_from([1.0, -1.0, 0.5, 0.0]), st.floats(-1.2, 1.2))
targets = st.floats(-3000.0, 3000.0)
commands = st.one_of(
    st.tuples(st.just("couple"), st.fixed_dictionaries({"master": st.sampled_from(NAMES), "factor": factors})),
    st.tuples(st.just("couple"), st.fixed_dictionaries({"master": st.sampled_from(NAMES), "factor": factors})),
    st.tuples(st.just("set_coupling_factor"), st.fixed_dictionaries({"factor": factors})),
    st.tuples(
        st.just("decouple"),
        st.fixed_dictionaries({}, optional={"target": targets, "velocity": st.floats(1.0, 2000.0)}),
    ),
    st.tuples(
        st.just("move_absolute"), st.builds(lambda t, v: {**DYNAMICS, "target": t, "velocity": v}, targets, st.floats(10.0, 2000.0))
    ),
    st.tuples(
        st.just("move_absolute"), st.builds(lambda t, v: {**DYNAMICS, "target": t, "velocity": v}, targets, st.floats(10.0, 2000.0))
    ),
    st.tuples(st.just("new_target"), st.fixed_dictionaries({"target": targets})),
    st.tuples(st.just("set_override"), st.fixed_dictionaries({"percent": st.sampled_from([0.0, 20.0, 50.0, 100.0])})),
    st.tuples(
        st.just("compensation_start"),
        st.builds(
            lambda d, n: {**COMPENSATION, "difference": d, "length": n},
            st.sampled_from([50.0, -50.0, 20.0]),
            st.floats(100.0, 2000.0),
        ),
    ),
    st.sampled_from(
        [
            ("stop", {}),
            ("halt", {}),
            ("reset", {}),
            ("compensation_stop", {}),
            ("power", {"enabled": False}),
            ("power", {"enabled": True}),
        ]
    ),
)  # fmt: skip
steps = st.lists(
    st.builds(lambda n, axis, c: (n, axis, *c), st.integers(0, 40), st.sampled_from(NAMES), commands), max_size=25
)


def played(sequence: list[Step], *, delayed: bool = False) -> SlaveBench:
    """A group to begin with, the steps, then an end by stop and reset."""
    late = {"error_propagation_delayed": True, "error_propagation_delay": 0.1} if delayed else {}
    bench = SlaveBench(machine=axes_named(*NAMES, **late))
    bench.send_all([("c", "couple", {"master": "b", "factor": -0.7}), ("b", "couple", {"master": "a", "factor": 0.8})])
    bench.send("a", "move_absolute", target=1500.0, **DYNAMICS)
    for blocks, axis, command, arguments in sequence:
        for _ in range(blocks):
            bench.tick()
        bench.send(axis, command, **arguments)
    bench.send_all([(axis, "stop", {}) for axis in NAMES])
    bench.settle()
    for axis in NAMES:
        bench.send(axis, "decouple")
        bench.send(axis, "power", enabled=True)
        bench.send(axis, "reset")
        bench.send(axis, "stop")
    bench.run(0.1)
    return bench


def assert_nothing_jumps(bench: SlaveBench, axis: str) -> None:
    """The distance of a cycle lies between what its velocities at both ends make; except where power on places the axis."""
    p, v = bench.values(axis), bench.values(axis, "set_velocity")
    fastest = np.maximum(np.abs(v[1:]), np.abs(v[:-1]))
    jumps = np.abs(np.diff(p)) > T * fastest + 0.02
    assert not jumps.any(), f"{axis} at {np.flatnonzero(jumps)[:3]}"


def assert_relation(bench: SlaveBench, axis: str) -> None:
    """While an axis is a slave and does not compensate, each of its ways is the factor times that of its master."""
    factor: dict[int, tuple[str, float]] = {}
    master = ""
    for record in bench.records:
        if record.target == axis and record.accepted and record.command in ("couple", "set_coupling_factor"):
            arguments = json.loads(record.arguments_json)
            master = arguments.get("master", master)
            factor[record.cycle] = (master, arguments["factor"])
    follows = bench.bits(axis, PROTECTED) & ~bench.bits(axis, COMPENSATING)
    follows &= np.array(bench.column(axis, "state")) == S.SYNCHRONIZED_MOTION
    p = bench.values(axis)
    begins = [*factor, len(p)]
    for begin, end in pairwise(begins):
        name, f = factor[begin]
        m, standing = bench.values(name), bench.values(name, "set_velocity") == 0.0
        error = np.abs(np.diff(p) - f * np.diff(m))
        checked = follows[1:] & follows[:-1] & ~(standing[1:] & standing[:-1])
        assert not (error[begin : end - 1] * checked[begin : end - 1] > 1e-9).any(), (axis, name, f)


@pytest.mark.long
@given(steps)
@QUICK
def test_random_commands(sequence: list[Step]) -> None:
    bench = played(sequence)
    for axis in NAMES:
        assert bench.state(axis) == S.STANDSTILL, axis
        assert_nothing_jumps(bench, axis)
        assert_relation(bench, axis)


@given(steps)
@settings(QUICK, max_examples=examples(10))
@pytest.mark.long
def test_random_commands_with_delayed_errors_and_their_replay(sequence: list[Step]) -> None:
    bench = played(sequence, delayed=True)
    for axis in NAMES:
        assert bench.state(axis) == S.STANDSTILL, axis
        assert_nothing_jumps(bench, axis)
        assert_relation(bench, axis)
    texts, expected = replay(bench.machine, bench.records, len(bench.blocks["plc"])), bits(bench)
    for axis in NAMES:
        assert texts[axis] == expected[axis], axis


def test_replay_of_a_rich_run() -> None:
    """Cascade, factors, compensations, decoupling, an error of the group and a lost master."""
    bench = SlaveBench(machine=axes_named("z", "c", "y", "x"))
    bench.send_all([("z", "couple", {"master": "y", "factor": -0.4}), ("y", "couple", {"master": "x", "factor": 0.8})])
    bench.send("x", "move_absolute", target=20_000.0, **DYNAMICS)
    bench.denied("y", "stop")
    bench.run(0.6)
    for axis, command, arguments in (
        ("y", "compensation_start", {**COMPENSATION, "length": 800.0, "difference": 20.0}),
        ("y", "set_coupling_factor", {"factor": 0.1 + 0.2}),
        ("z", "compensation_start", {**COMPENSATION, "length": 100.0, "difference": -3.0}),
        ("z", "decouple", {"velocity": 77.7}),
        ("z", "set_override", {"percent": 33.3}),
        ("x", "set_override", {"percent": 12.5}),
        ("y", "power", {"enabled": False}),
    ):
        bench.send(axis, command, **arguments)
        bench.run(0.3)
    bench.settle(1.0) if bench.send("z", "stop").accepted else None
    for axis in "xyz":
        bench.send(axis, "reset")
    bench.do("z", "couple", master="x", factor=1.0)
    bench.do("x", "move_relative", distance=100.0)
    bench.give("z", "upstream_lost", source="x")
    bench.run(1.0)
    assert {event.error_id for event in bench.events} >= {23010, 23056, 26101, 23040}
    texts, expected = replay(bench.machine, bench.records, len(bench.blocks["plc"])), bits(bench)
    for axis in "xyzc":
        assert texts[axis] == expected[axis], axis
