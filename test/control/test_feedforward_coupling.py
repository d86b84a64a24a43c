"""Feedforward that is switched in motion: the axis' acceleration, jerk and velocity hold, and it always arrives."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from loop_support import (
    A_MAX,
    ACC,
    ADD_ACC,
    ADD_JERK,
    ADD_VEL,
    INERTIA,
    J_MAX,
    KV,
    TA,
    V_MAX,
    VEL,
    MotionState,
    T,
    control,
    feedforward,
    first_order,
    make_loop,
    motion,
    trapezoid,
)
from numpy.typing import NDArray

from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.control.feedforward import CouplingLimits

Switch = Callable[[int, ControlLoop], None]


class Record:
    """A run in which the feedforward is switched: what command and axis did, cycle by cycle."""

    def __init__(self, loop: ControlLoop, states: Sequence[MotionState], switch: Switch, time_constant: float) -> None:
        """`time_constant` of the drive; it makes a velocity of the additive torque."""
        velocity, command, share, lag = [0.0], [0.0], [], []
        for cycle, state in enumerate(states):
            switch(cycle, loop)
            row = loop.step(state, True)
            velocity.append(loop.drive.velocity)
            torque = row.additive_torque / INERTIA * time_constant
            command.append(row.command_velocity + row.additive_velocity + torque)
            share.append(row.feedforward_velocity + row.additive_velocity + torque)
            lag.append(row.following_error)
        self.acceleration = np.diff(velocity) / T
        self.velocity = np.array(velocity[1:])
        self.command_change = np.diff(command) / T
        self.share = np.array(share)
        """Output of the feedforward, all as velocity."""
        self.lag = np.array(lag)


def made_loop(
    mode: int, *, kv: float = KV, time_constant: float = TA, limits: CouplingLimits | None = None
) -> ControlLoop:
    parameters = control(kv=kv, of_feedforward=feedforward(mode, time_constant=time_constant))
    return make_loop(parameters, first_order(time_constant), limits or CouplingLimits(V_MAX, A_MAX, J_MAX))


def at(plan: dict[int, tuple[bool, float]]) -> Switch:
    """Selections by cycle: on, weight in percent."""

    def switch(cycle: int, loop: ControlLoop) -> None:
        if cycle in plan:
            loop.feedforward.select(*plan[cycle])

    return switch


def at_velocity(v: float, cycles: int = 1500) -> list[MotionState]:
    """Up to `v` within 160 ms, then on and on."""
    jerk = v / 0.0064
    return motion([(80, jerk), (80, -jerk), (cycles, 0.0)])


def settled_at(share: NDArray[np.float64], value: float) -> int:
    """The first cycle from which on the output of the feedforward is `value`."""
    off = np.flatnonzero(np.abs(share - value) > 1e-9 * max(1.0, abs(value)))
    return int(off[-1]) + 1 if len(off) else 0


@pytest.mark.parametrize("mode", [VEL, VEL | ACC, ADD_VEL, ADD_VEL | ADD_ACC])
@pytest.mark.parametrize("v", [0.4, 50.0, -300.0])
def test_in_and_out_at_constant_velocity(mode: int, v: float) -> None:
    """The rate of the feedforward velocity is a triangle or trapezium of the axis' jerk: 2·√(v/J), and no more."""
    states = at_velocity(v)
    record = Record(made_loop(mode), states, at({460: (True, 100.0), 1000: (False, 100.0)}), TA)
    rate, limit = np.diff(record.share) / T, (A_MAX, 1.13 * J_MAX)
    for window in (slice(455, 900), slice(995, 1600)):
        assert np.abs(rate[window]).max() <= limit[0] * (1.0 + 1e-9)
        assert np.abs(np.diff(rate[window])).max() / T <= limit[1]
        assert np.abs(record.acceleration[window]).max() <= limit[0]
    duration = 2.0 * math.sqrt(abs(v) / J_MAX)
    assert (settled_at(record.share[:900], v) - 460) * T == pytest.approx(duration, abs=4 * T)
    assert (settled_at(record.share, 0.0) - 1000) * T == pytest.approx(duration, abs=4 * T)
    assert abs(record.lag[999]) < 1e-6 and record.lag[-1] == pytest.approx(v / KV, abs=1e-6)


def test_at_standstill_it_is_there_at_once() -> None:
    loop = made_loop(VEL | ACC)
    states = motion([(20, 0.0), *trapezoid(25_000.0, 80, 0, 10)])
    record = Record(loop, states, at({10: (True, 100.0)}), TA)
    settled = Record(made_loop(VEL | ACC), states, at({0: (True, 100.0)}), TA)
    assert np.array_equal(record.velocity, settled.velocity)
    assert abs(record.lag).max() < 1e-4


@pytest.mark.parametrize("second", [(False, 100.0), (True, 30.0)])
@pytest.mark.parametrize("after", [1, 30, 60, 78, 100, 150])
def test_a_change_of_mind_half_way_makes_no_step(second: tuple[bool, float], after: int) -> None:
    """G135 and soon after G137 or a smaller weight: the rate turns round with the axis' jerk."""
    record = Record(made_loop(VEL), at_velocity(300.0), at({460: (True, 100.0), 460 + after: second}), TA)
    rate = np.diff(record.share) / T
    assert np.abs(np.diff(rate[455:1200])).max() / T <= 1.13 * J_MAX
    assert np.abs(record.acceleration[455:1200]).max() <= A_MAX
    assert record.share[455:].min() >= -J_MAX * T**2 and record.share[455:].max() <= 300.0 + J_MAX * T**2
    assert record.share[-1] == pytest.approx(300.0 * (0.3 if second[0] else 0.0), abs=1e-9)


def test_weights_change_softly_too() -> None:
    """G136 X80, X95, X0 in motion."""
    plan = {300: (True, 80.0), 800: (True, 95.0), 1200: (True, 0.0)}
    record = Record(made_loop(VEL), at_velocity(300.0, 1600), at(plan), TA)
    assert record.share[[799, 1199, 1759]] == pytest.approx([240.0, 285.0, 0.0], abs=1e-9)
    assert record.lag[[799, 1199, 1759]] == pytest.approx([1.2, 0.3, 6.0], abs=1e-6)
    assert np.abs(np.diff(record.share, 2))[250:].max() / T**2 <= 1.13 * J_MAX


def random_motion(draw: random.Random) -> list[MotionState]:
    """Three trapezia with accelerations up to the axis' limit, some without any rest between them."""
    phases = []
    for _ in range(3):
        jerk = draw.choice([J_MAX, 20_000.0, 5000.0])
        rise = int(draw.uniform(5, A_MAX / jerk / T))
        hold = draw.randrange(0, 60)
        while jerk * rise * T * (rise + hold) * T > 0.95 * V_MAX:
            rise, hold = (rise, hold - 1) if hold else (rise - 1, 0)
        cruise, rest = draw.randrange(0, 200), draw.randrange(0, 50)
        phases += trapezoid(jerk, rise, hold, cruise, rest=rest, sign=draw.choice([1.0, -1.0]))
    return motion(phases)


def random_plan(draw: random.Random, cycles: int) -> dict[int, tuple[bool, float]]:
    plan, cycle = {}, draw.randrange(10, 300)
    while cycle < cycles:
        plan[cycle] = (draw.random() < 0.6, draw.choice([0.0, 30.0, 80.0, 95.0, 100.0]))
        cycle += draw.randrange(5, 200)
    return plan


@pytest.mark.long
@pytest.mark.parametrize(
    "mode", [VEL, ACC, VEL | ACC, ADD_VEL, ADD_ACC, ADD_VEL | ADD_ACC, ADD_VEL | ADD_ACC | ADD_JERK]
)
@pytest.mark.parametrize(("kv", "time_constant"), [(50.0, 0.003), (50.0, 0.0), (20.0, 0.003), (80.0, 0.003)])
def test_random_switching_in_random_motions_keeps_the_acceleration(mode: int, kv: float, time_constant: float) -> None:
    """P-AXIS-00008, or what the same feedforward takes where it is on or off all the time, and 4 % at most."""
    for seed in range(5):
        draw = random.Random(seed)
        states = random_motion(draw)
        plan = random_plan(draw, len(states))
        limit = A_MAX
        for steady in (False, True):
            loop = made_loop(mode, kv=kv, time_constant=time_constant)
            loop.feedforward.select(steady, 100.0)
            record = Record(loop, states, at({}), time_constant)
            limit = max(limit, np.abs(record.acceleration).max())
        record = Record(made_loop(mode, kv=kv, time_constant=time_constant), states, at(plan), time_constant)
        assert np.abs(record.acceleration).max() <= 1.04 * limit, f"seed {seed}"
        assert np.abs(record.velocity).max() <= 1.01 * V_MAX, f"seed {seed}"
        assert np.isfinite(record.share).all()


@pytest.mark.parametrize("mode", [ADD_ACC, ADD_VEL | ADD_ACC])
def test_an_additive_torque_comes_softly_in_the_middle_of_an_acceleration(mode: int) -> None:
    """Full torque at once would be twice the acceleration."""
    states = motion([(60, J_MAX), (80, 0.0), (60, -J_MAX), (200, 0.0)])
    record = Record(made_loop(mode), states, at({100: (True, 100.0)}), TA)
    assert record.acceleration[100:].max() <= A_MAX
    assert np.diff(record.acceleration[95:140]).max() < 0.06 * A_MAX


def test_near_the_largest_velocity_it_takes_its_time_and_at_it_it_waits() -> None:
    """Making up a lag costs r·F/Kv of velocity; P-AXIS-00212 must not be passed for it."""
    for v, arrives in ((480.0, True), (500.0, False)):
        record = Record(made_loop(VEL), at_velocity(v, 2500), at({460: (True, 100.0)}), TA)
        assert record.velocity[460:].max() <= V_MAX + 1e-9
        assert bool(abs(record.lag[-1]) < 1e-6) is arrives


def test_what_waited_at_the_largest_velocity_goes_on_when_the_axis_gets_slower() -> None:
    jerk = 500.0 / 0.0064 / 4.0
    states = motion([(160, jerk), (160, -jerk), (600, 0.0), (40, -jerk), (40, jerk), (800, 0.0)])
    record = Record(made_loop(VEL), states, at({500: (True, 100.0)}), TA)
    v = states[-1][1]
    assert 450.0 < v < 480.0 and abs(record.lag[-1]) < 1e-6 and record.share[-1] == pytest.approx(v)
    assert record.share[800] == 0.0 and record.velocity[500:].max() <= V_MAX + 1e-9


@pytest.mark.parametrize("mode", [VEL, VEL | ACC, ADD_VEL | ADD_ACC, ADD_ACC])
@pytest.mark.parametrize("cycle", [100, 700, 1090])
def test_no_waiting_beyond_standstill(mode: int, cycle: int) -> None:
    """Whatever was in the way, at rest the selection holds: the next motion has it from its first cycle."""
    jerk = 500.0 / 0.0064 / 4.0
    there = [(160, jerk), (160, -jerk), (600, 0.0), (160, -jerk), (160, jerk), (5, 0.0)]
    back = [(160, -jerk), (160, jerk), (300, 0.0)]
    states = motion([*there, *back])
    record = Record(made_loop(mode), states, at({cycle: (True, 100.0)}), TA)
    settled = Record(made_loop(mode), states, at({0: (True, 100.0)}), TA)
    assert np.array_equal(record.share[1245:], settled.share[1245:])


def test_a_prefilter_forgets_while_the_feedforward_is_off() -> None:
    """Old mean values must not move the standing axis when it is switched on again."""
    states = motion([*trapezoid(25_000.0, 80, 0, 200, rest=300), (300, 0.0)])
    parameters = control(of_feedforward=feedforward(VEL | ACC, prefilter_cycles=16))
    plan = {0: (True, 100.0), 200: (False, 100.0), 700: (True, 100.0)}
    record = Record(make_loop(parameters), states, at(plan), TA)
    assert record.share[199] == pytest.approx(160.0) and record.share[500] == 0.0
    assert np.array_equal(record.share[700:], np.zeros(len(states) - 700))


def test_without_a_limit_of_the_jerk_the_acceleration_still_holds() -> None:
    """A spindle: 160 mm/s at 4000 mm/s² take 40 ms."""
    limits = CouplingLimits(V_MAX, A_MAX, math.inf)
    record = Record(made_loop(VEL, limits=limits), at_velocity(160.0), at({460: (True, 100.0)}), TA)
    rate = np.diff(record.share[455:]) / T
    assert rate.max() == pytest.approx(A_MAX) and np.abs(record.acceleration[455:]).max() <= A_MAX
    assert settled_at(record.share, 160.0) == pytest.approx(500, abs=2)


def test_an_open_loop_takes_the_selection_over_at_once() -> None:
    loop = made_loop(VEL)
    states = at_velocity(100.0)
    loop.feedforward.select(True, 50.0)
    for state in states[:300]:
        assert loop.step(state, False).feedforward_velocity == 0.0
    assert loop.step(states[300], True).feedforward_velocity == pytest.approx(50.0)


def waited(v: float, cycles: int = 1500, at_cycle: int = 460) -> tuple[ControlLoop, list[tuple[int, float]]]:
    """Selected at the constant velocity `v`; where and with what the wait was reported."""
    loop, told = made_loop(VEL), []
    for cycle, state in enumerate(at_velocity(v, cycles)):
        if cycle == at_cycle:
            loop.select_feedforward(True, 100.0)
        loop.step(state, True)
        limit = loop.feedforward.take_wait()
        if limit is not None:
            told.append((cycle, limit))
    return loop, told


@pytest.mark.parametrize("v", [500.0, 499.999])
def test_a_selection_that_never_comes_into_force_is_told_once(v: float) -> None:
    """At P-AXIS-00212 no room is left; after half a second that is worth a warning."""
    loop, told = waited(v)
    assert [limit for _, limit in told] == [V_MAX] and 955 <= told[0][0] <= 970
    assert loop.feedforward.percent < 1.0


@pytest.mark.parametrize("v", [480.0, 300.0, 20.0])
def test_one_that_does_is_not(v: float) -> None:
    loop, told = waited(v)
    assert told == [] and loop.feedforward.percent == 100.0
