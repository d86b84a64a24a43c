"""Whatever comes in, finite values go out; what is switched off does not change a bit."""

from __future__ import annotations

import math
import struct
from dataclasses import replace

from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st
from long_support import examples
from loop_support import (
    A_MAX,
    ACC,
    ADD_ACC,
    ADD_JERK,
    ADD_VEL,
    J_MAX,
    JERK,
    NO_FRICTION,
    PLANT,
    V_MAX,
    VEL,
    MotionState,
    T,
    control,
    feedforward,
    first_order,
    make_loop,
)

from cnc_ptp.control.control_loop import ControlCycle
from cnc_ptp.control.drives import make_drive
from cnc_ptp.control.feedforward import CouplingLimits

QUIET = settings(max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.too_slow], database=None)
MODES = st.sampled_from([0, VEL, ACC, JERK, VEL | ACC | JERK, ADD_VEL | ADD_ACC | ADD_JERK, ADD_VEL | ACC, 0x300])
SMALL = st.floats(-1.0, 1.0)
STATES = st.lists(
    st.tuples(SMALL, SMALL, SMALL, SMALL, st.sampled_from([0.0, 1e-12, 1.0, 1e3, 1e6])), min_size=5, max_size=60
)


@st.composite
def motions(draw: st.DrawFn) -> list[MotionState]:
    """Setpoints without any connection, up to 1e6 times what an axis can do, standstill among them."""
    rows = draw(STATES)
    return [(x * size, v * V_MAX * size, a * A_MAX * size, j * J_MAX * size) for x, v, a, j, size in rows]


@st.composite
def loops(draw: st.DrawFn) -> object:
    of_feedforward = feedforward(
        draw(MODES),
        weight=draw(st.floats(0.0, 2.0)),
        velocity_delay=draw(st.floats(0.0, 0.005999)),
        acceleration_delay=draw(st.floats(0.0, 0.005999)),
        lead_cycles=draw(st.integers(0, 4)),
        prefilter_cycles=draw(st.integers(1, 16)),
        always_active=draw(st.booleans()),
    )
    friction = replace(
        NO_FRICTION,
        permitted=True,
        active=draw(st.booleans()),
        velocities=(0.0, 1.0, 50.0),
        currents=(0.3, 0.2, 0.4),
        position_delay=draw(st.sampled_from([0.0, 1e-4, 0.01])),
        reversal_lookahead=draw(st.integers(0, 4)),
        delay_cycles=draw(st.integers(0, 20)),
    )
    interface = draw(st.sampled_from(["velocity", "position", "lag", "torque"]))
    jerk = draw(st.sampled_from([J_MAX, 1.0, math.inf]))
    limits = CouplingLimits(V_MAX, A_MAX, jerk)
    plant = replace(PLANT, cascaded=draw(st.booleans()) or interface == "torque", coulomb=0.2, static=0.3)
    parameters = control(of_feedforward=of_feedforward, friction=friction, interface=interface, plant=plant)
    return make_loop(parameters, make_drive(parameters, T), limits)


@seed(20260801)
@QUIET
@given(loops(), motions(), st.lists(st.tuples(st.integers(0, 59), st.booleans(), st.floats(0.0, 100.0)), max_size=6))
def test_outputs_are_finite(loop, states, switches) -> None:  # type: ignore[no-untyped-def]
    """Also when switched, opened and closed at any time; the factor of the feedforward stays near 0 … 1."""
    plan = {cycle: (on, weight) for cycle, on, weight in switches}
    for cycle, state in enumerate(states):
        if cycle in plan:
            loop.feedforward.select(*plan[cycle])
            loop.friction.switch(plan[cycle][0])
        assert loop.too_far(state) is False
        row = loop.step(state, cycle % 17 != 13)
        assert all(math.isfinite(value) for value in row)


def bits(row: ControlCycle) -> bytes:
    return struct.pack("<10d", *(value + 0.0 for value in row))


@seed(20260802)
@QUIET
@given(motions(), MODES, st.floats(0.0, 0.005999), st.integers(1, 16), st.integers(0, 20))
def test_switched_off_is_as_if_it_were_not_there(states, mode, delay, prefilter, late) -> None:  # type: ignore[no-untyped-def]
    """To the bit, with friction compensation permitted but off (no lookahead, which costs a delay), too."""
    of_feedforward = feedforward(mode, velocity_delay=delay, acceleration_delay=delay, prefilter_cycles=prefilter)
    friction = replace(
        NO_FRICTION, permitted=True, velocities=(0.0,), currents=(5.0,), position_delay=0.1, delay_cycles=late
    )
    plain = make_loop(control())
    off = make_loop(control(of_feedforward=of_feedforward, friction=friction), first_order())
    for cycle, state in enumerate(states):
        closed = cycle % 17 != 13
        assert bits(plain.step(state, closed)) == bits(off.step(state, closed))


@seed(20260803)
@QUIET
@given(motions(), MODES.filter(bool), st.integers(1, 30), st.integers(1, 30))
def test_switched_off_in_the_end_is_as_if_it_had_never_been_on(states, mode, begin, rest) -> None:  # type: ignore[no-untyped-def]
    """At standstill it is off within one cycle; what goes out then is of the position controller alone."""
    loop = make_loop(control(of_feedforward=feedforward(mode, prefilter_cycles=5)))
    for cycle, state in enumerate(states):
        if cycle == begin:
            loop.feedforward.select(True, 100.0)
        loop.step(state, True)
    standing = (states[-1][0], 0.0, 0.0, 0.0)
    for _ in range(16 + rest):
        loop.step(standing, True)
    loop.feedforward.select(False, 100.0)
    loop.step(standing, True)
    lag = loop.monitored(standing)[0]
    row = loop.step(standing, True)
    assert row[4:8] == (0.0, 0.0, 0.0, 0.0) and row.command_velocity == 50.0 * lag
    assert not loop.feedforward.active
