"""Following-error monitoring: four types, standstill, filter time, and which parameter a limit comes from."""

from __future__ import annotations

import math
import random
from dataclasses import replace

import numpy as np
import pytest
from loop_support import (
    KV,
    NO_FRICTION,
    BlockedDrive,
    MotionState,
    T,
    control,
    feedforward,
    first_order,
    make_loop,
    motion,
    run,
    trapezoid,
)
from scipy.signal import lfilter

from cnc_ptp.control.following_error_monitor import FollowingErrorMonitor
from cnc_ptp.parameters.view.control_view import LagMonitoring

FIXED = LagMonitoring(kind=4, moving_limit=3.0, standstill_limit=0.5, dynamic=1000, filter_time=0.0)
SETTLING = 100
"""Cycles of 5/Kv at 50/s."""


def monitor(of: LagMonitoring = FIXED, kv: float = KV) -> FollowingErrorMonitor:
    return FollowingErrorMonitor(of, kv=kv, cycle_time=T)


def rest(watch: FollowingErrorMonitor, cycles: int, error: float = 0.0) -> None:
    for _ in range(cycles):
        watch.advance(error, 0.0)


# ---------------------------------------------------------------- types


@pytest.mark.parametrize("v", [0.0, 1e-9, 20.0, -500.0])
def test_type_4_has_one_limit_whatever_the_velocity(v: float) -> None:
    watch = monitor()
    for error in (3.0, -3.0):
        assert not watch.exceeded(error, v)
    for error in (3.0 + 1e-12, -3.0 - 1e-12, math.inf):
        assert watch.exceeded(error, v)
    assert (watch.limit(v), watch.source(v)) == (3.0, "P-AXIS-00168")


@pytest.mark.parametrize(("kv", "cycles"), [(50.0, 100), (20.0, 250), (33.3, 151)])
@pytest.mark.parametrize("kind", [4, 2])
def test_a_standing_axis_has_five_time_constants_to_settle(kind: int, kv: float, cycles: int) -> None:
    watch = monitor(replace(FIXED, kind=kind), kv)
    rest(watch, cycles - 1)
    assert (watch.limit(0.0), watch.source(0.0)) == (3.0, "P-AXIS-00168")
    rest(watch, 1)
    assert (watch.limit(0.0), watch.source(0.0)) == (0.5, "P-AXIS-00169")
    assert watch.limit(1e-6) == 3.0
    assert watch.exceeded(-0.5000001, 0.0) and not watch.exceeded(0.5, 0.0)
    watch.advance(0.0, 1.0)
    assert watch.limit(0.0) == 3.0


def test_an_open_loop_begins_to_settle_anew() -> None:
    watch = monitor()
    rest(watch, SETTLING)
    assert watch.limit(0.0) == 0.5
    watch.forget()
    assert watch.limit(0.0) == 3.0


@pytest.mark.parametrize(("dynamic", "slope"), [(0, 1.0), (512, 2.0), (768, 4.0), (1000, 1024.0 / 24.0)])
def test_type_2_rises_with_the_theoretical_lag(dynamic: int, slope: float) -> None:
    """v/Kv · 1024/(1024 - P-AXIS-00167), at least P-AXIS-00168."""
    watch = monitor(replace(FIXED, kind=2, dynamic=dynamic))
    for v in (0.1, 100.0, 170.0, -480.0):
        expected = max(3.0, abs(v) / KV * slope)
        assert watch.limit(v) == pytest.approx(expected, rel=1e-12)
        assert watch.source(v) == ("P-AXIS-00168" if expected == 3.0 else "P-AXIS-00167, linear")


def test_type_1_is_a_first_order_filter_of_the_velocity() -> None:
    """e(n) = e(n-1) · P-AXIS-00167/1024 + |v| · T within P-AXIS-00169 … P-AXIS-00168, against scipy's lfilter."""
    draw = random.Random(3)
    velocities = [draw.uniform(-300.0, 300.0) if n % 50 < 30 else 0.0 for n in range(600)]
    for dynamic in (700, 990, 1023):
        watch = monitor(replace(FIXED, kind=1, dynamic=dynamic))
        estimates = lfilter([T], [1.0, -dynamic / 1024.0], np.abs(velocities))
        for v, estimate in zip(velocities, estimates, strict=True):
            limit = min(3.0, max(0.5, estimate))
            assert watch.limit(v) == pytest.approx(limit, rel=1e-9)
            source = "P-AXIS-00168" if estimate >= 3.0 else "P-AXIS-00167, estimated"
            assert watch.source(v) == ("P-AXIS-00169" if estimate <= 0.5 else source)
            assert watch.exceeded(limit * 1.0001, v) and not watch.exceeded(-limit * 0.9999, v)
            watch.advance(0.0, v)


def test_type_1_gives_a_moving_axis_more_than_its_lag() -> None:
    """With 1000/1024 the estimate settles at 42.7 T·v, v/Kv is 20 T·v; the axis accelerates and brakes below it."""
    of = replace(FIXED, kind=1, moving_limit=20.0, standstill_limit=0.05)
    loop = make_loop(control(monitoring=of))
    for state in motion(trapezoid(25_000.0, 80, 40, 300, rest=400)):
        assert not loop.too_far(state)
        loop.step(state, True)
    assert loop.monitor.source(0.0) == "P-AXIS-00169"


@pytest.mark.parametrize("of", [replace(FIXED, kind=kind) for kind in (0, 3, 5)])
def test_other_types_are_off(of: LagMonitoring) -> None:
    watch = monitor(of)
    assert not watch.on and not watch.exceeded(1e9, 0.0)
    rest(watch, 300, 1e9)
    assert not watch.exceeded(1e9, 0.0)


@pytest.mark.parametrize("kind", [1, 2])
def test_1024_switches_the_dynamic_types_off(kind: int) -> None:
    watch = monitor(replace(FIXED, kind=kind, dynamic=1024))
    assert not watch.on and not watch.exceeded(1e9, 100.0)
    assert monitor(replace(FIXED, kind=kind, dynamic=1023)).on
    assert monitor(replace(FIXED, kind=4, dynamic=1024)).on


# ---------------------------------------------------------------- filter time


@pytest.mark.parametrize("filter_time", [0.0, 0.001, 0.005])
def test_the_error_must_be_too_large_for_the_filter_time(filter_time: float) -> None:
    watch, cycles = monitor(replace(FIXED, filter_time=filter_time)), round(filter_time / T)
    for _ in range(2):
        for _ in range(cycles):
            assert not watch.exceeded(4.0, 10.0)
            watch.advance(4.0, 10.0)
        assert watch.exceeded(4.0, 10.0)
        assert watch.exceeded(4.0, 10.0), "asking changes nothing"
        watch.advance(1.0, 10.0)  # below in between: it begins anew


def test_an_open_loop_forgets_what_was_too_large() -> None:
    watch = monitor(replace(FIXED, filter_time=0.003))
    for _ in range(10):
        watch.advance(9.0, 1.0)
    watch.forget()
    assert not watch.exceeded(9.0, 1.0)


# ---------------------------------------------------------------- in the loop


@pytest.mark.parametrize("kind", [1, 2, 4])
def test_a_blocked_axis_is_found_in_the_first_cycle_above_the_limit(kind: int) -> None:
    """The drive does not move: the following error is the set position."""

    of = replace(FIXED, kind=kind, dynamic=0 if kind == 2 else 900)
    loop = make_loop(control(monitoring=of), BlockedDrive())
    watch = monitor(of)
    for x, v, a, j in motion(trapezoid(25_000.0, 40, 0, 600)):
        expected = abs(x) > watch.limit(v)
        assert loop.too_far((x, v, a, j)) is expected
        if expected:
            break
        watch.advance(x, v)
        loop.step((x, v, a, j), True)
    assert 0.5 < x < 4.0


@pytest.mark.parametrize("lead", [0, 3])
def test_behind_a_delay_line_its_own_setpoint_is_monitored(lead: int) -> None:
    """The way of the delay is no following error; velocity and standstill are those of the delayed setpoint."""
    of = LagMonitoring(kind=2, moving_limit=0.25, standstill_limit=0.002, dynamic=512, filter_time=0.0)
    of_feedforward = feedforward(0x1, lead_cycles=lead)
    loop = make_loop(control(monitoring=of, of_feedforward=of_feedforward))
    states = [(0.0, 0.0, 0.0, 0.0)] * 10 + motion(trapezoid(3000.0, 100, 0, 300, rest=400))
    for n, state in enumerate(states):
        delayed = states[max(0, n - lead)]
        lag, velocity = loop.monitored(state)
        assert (lag, velocity) == (delayed[0] - loop.position, delayed[1])
        assert not loop.too_far(state), n
        loop.step(state, True)


def test_the_lag_of_the_delay_line_alone_never_faults() -> None:
    of = replace(FIXED, moving_limit=0.5)
    friction = replace(NO_FRICTION, permitted=True, reversal_lookahead=4)
    loop = make_loop(control(monitoring=of, friction=friction, of_feedforward=feedforward(0x3, always_active=True)))
    states: list[MotionState] = motion(trapezoid(25_000.0, 100, 40, 200, rest=100))
    for state in states:
        assert not loop.too_far(state)
        cycle = loop.step(state, True)
    assert max(abs(c.following_error) for c in run(make_loop(control(friction=friction)), states)) > 4 * T * 300.0
    assert abs(cycle.following_error) < 1e-6


def test_settling_in_the_loop() -> None:
    """After a motion the lag decays within the time that the axis has; a limit of 0.01 of the old lag holds."""
    of = replace(FIXED, moving_limit=10.0, standstill_limit=0.05)
    loop = make_loop(control(monitoring=of), first_order())
    for state in motion([(1, 0.0), *trapezoid(50_000.0, 60, 0, 300, rest=400)]):
        assert not loop.too_far(state)
        loop.step(state, True)
    assert loop.monitor.limit(0.0) == 0.05
