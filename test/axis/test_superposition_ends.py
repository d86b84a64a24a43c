"""However superposed motions end, no axis gets faster by it: accelerations up to the permitted 50,000 mm/s²."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from long_support import examples
from machine_support import CYCLE_TIME, UnitBench
from superposition_support import A, J, SetpointRow, column, generator, moving_axis

from cnc_ptp.protocol.axis_states import AxisStateCode as S

MOST = 10_000.0
"""P-AXIS-00212 of the axis of the bench, mm/s."""
SILENCE = 20
"""Cycles for which the acceleration of a last setpoint counts at most."""
STRONG = {"deceleration": 20_000.0, "jerk": 500_000.0}
STOPS: dict[str, dict[str, Any]] = {"stop": {}, "halt": {}, "reset": {}, "power": {"enabled": False}}
FAULTS: dict[str, dict[str, Any]] = {"upstream_lost": {"source": "plc"}, "emergency_stop": STRONG}

slow = settings(
    max_examples=examples(40),
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow],
)
begins = st.integers(0, 900)
signs = st.sampled_from([1.0, -1.0])
accelerations = st.floats(1000.0, 50_000.0) | st.just(50_000.0)
compensations = st.fixed_dictionaries(
    {
        "length": st.floats(100.0, 4000.0),
        "difference": st.floats(-2000.0, 2000.0),
        "process_velocity": st.floats(500.0, 5000.0),
        "velocity_increase": st.floats(10.0, 4000.0),
        "acceleration": accelerations,
        "deceleration": accelerations,
    }
)


def external_rows(begin: int, sign: float, velocity: float, a: float, every: int = 1) -> list[SetpointRow]:
    """Up to the velocity, 300 ms on, and back to rest."""
    distance = sign * velocity * (velocity / a + 0.3)
    return generator(distance, first_cycle=begin, velocity=velocity, a=a, every=every)


def end(bench: UnitBench, how: str, rows: list[SetpointRow]) -> None:
    if how == "direction 0":
        row = next(row for row in rows if row[0] >= bench.cycle)
        bench.accepted("external_setpoints", setpoints=[[*row[:4], 0]])
    elif how != "silence":
        bench.accepted(how, **(STOPS | FAULTS).get(how, {}))


def first_fault(bench: UnitBench, begin: int) -> int | None:
    """The cycle from which the axis is on its error ramp."""
    errors = np.flatnonzero(np.array(bench.column("state"))[begin:] == S.ERROR_STOP)
    return begin + int(errors[0]) if len(errors) else None


def assert_takes_over_no_more_than(bench: UnitBench, cycle: int, basic_acceleration: float) -> None:
    """From `cycle` on |v| may rise by a²/2J of the basic motion, and not above the maximum by that."""
    speed = np.abs(column(bench, "set_velocity"))
    rise = 0.5 * basic_acceleration**2 / J
    assert speed[cycle:].max() <= max(speed[cycle], min(speed[cycle] + rise, MOST)) + 1e-6
    assert speed[-1] == 0.0


@slow
@given(
    basic=st.floats(100.0, 4500.0),
    cycles=begins,
    external=st.floats(50.0, 5000.0),
    a=accelerations,
    sign=signs,
    every=st.sampled_from([1, 2, 10]),
    dead_time=st.sampled_from([0.0, 0.0, 0.003]),
    after=st.integers(5, 400),
    how=st.sampled_from(["external_disable", "direction 0", *STOPS]),
)
def test_the_contribution_only_falls_after_its_end(
    basic: float,
    cycles: int,
    external: float,
    a: float,
    sign: float,
    every: int,
    dead_time: float,
    after: int,
    how: str,
) -> None:
    """What the axis does beside its basic motion, which a twin shows, falls on the ramp of the axis from the end on."""
    start: dict[str, Any] = {"target": 50_000.0, "velocity": basic, "cycles": cycles, "count": 50}
    bench, twin = moving_axis(external_dead_time=dead_time, **start), moving_axis(**start)
    rows = external_rows(bench.cycle, sign, external, a, every)
    after = min(after, int(rows[-1][0]) - bench.cycle - 1)
    bench.accepted("external_enable", mode="relative")
    bench.accepted("external_setpoints", setpoints=rows)
    for each in (bench, twin):
        each.run(after)
    end(bench, how, rows)
    if how in STOPS:
        twin.accepted(how, **STOPS[how])
    ended = next(int(row[0]) for row in rows if row[0] >= bench.cycle) if how == "direction 0" else bench.cycle
    for each in (bench, twin):
        each.run(2500)
    assert bench.events == []
    v = (column(bench, "set_velocity") - column(twin, "set_velocity"))[ended:]
    assert (np.diff(np.abs(v)) <= 1e-6).all() and abs(v[-1]) < 1e-6
    rest = (column(bench, "set_acceleration") - column(twin, "set_acceleration"))[ended + 1 :]
    assert np.abs(rest).max() <= A * (1 + 1e-9)
    assert np.abs(np.diff(rest)).max() <= J * CYCLE_TIME * (1 + 1e-6)


@slow
@given(
    basic=st.floats(100.0, 9000.0),
    cycles=begins,
    compensation=st.none() | compensations,
    external=st.none() | st.floats(50.0, 9000.0),
    a=accelerations,
    sign=signs,
    every=st.sampled_from([1, 1, 5, 20, 40]),
    after=st.integers(0, 400),
    how=st.sampled_from(["silence", *FAULTS]),
)
def test_a_fault_takes_over_no_more_than_the_basic_acceleration(
    basic: float,
    cycles: int,
    compensation: dict[str, float] | None,
    external: float | None,
    a: float,
    sign: float,
    every: int,
    after: int,
    how: str,
) -> None:
    """Whatever comes first: the fault of the test, a sum above the maximum, a jump, silence."""
    start: dict[str, Any] = {"target": 50_000.0, "velocity": basic, "cycles": cycles, "count": 50}
    bench, twin = moving_axis(**start), moving_axis(**start)
    begin = bench.cycle
    if compensation is not None:
        bench.give("compensation_start", **compensation)
    if external is not None:
        bench.accepted("external_enable", mode="relative")
        rows = external_rows(begin, sign, external, a, every)
        bench.accepted(
            "external_setpoints", setpoints=[row for row in rows if row[0] < begin + after or row[4] == 0][:-1]
        )
    bench.run(after)
    fault = first_fault(bench, begin)
    if fault is None and how != "silence":
        fault = bench.cycle
        end(bench, how, [])
    bench.run(1500)
    fault = first_fault(bench, begin) if fault is None else fault
    twin.run(1500 + after)
    speed = np.abs(column(bench, "set_velocity"))
    assert speed[:fault].max(initial=0.0) <= MOST * (1 + 1e-9)
    if fault is None:
        return
    bench.run(5000)
    assert_takes_over_no_more_than(bench, fault, twin.column("set_acceleration")[fault])
    v, ramp = column(bench, "set_velocity")[fault:], max(A, STRONG["deceleration"] if how == "emergency_stop" else A)
    assert np.abs(np.diff(v)).max() <= ramp * CYCLE_TIME * (1 + 1e-9) + 1e-9


@slow
@given(
    basic=st.floats(100.0, 3000.0),
    cycles=begins,
    external=st.floats(100.0, 4000.0),
    a=accelerations,
    sign=signs,
    every=st.sampled_from([1, 3, 10, 20]),
    after=st.integers(25, 300),
)
def test_silence_speeds_up_for_20_ms_at_most(
    basic: float, cycles: int, external: float, a: float, sign: float, every: int, after: int
) -> None:
    """From the last setpoint on, by a times the usual distance of the setpoints; then the velocity is kept."""
    start: dict[str, Any] = {"target": 50_000.0, "velocity": basic, "cycles": cycles, "count": 50}
    bench, twin = moving_axis(**start), moving_axis(**start)
    begin = bench.cycle
    rows = [row for row in external_rows(begin, sign, external, a, every) if row[0] < begin + after and row[4]]
    last = int(rows[-1][0])
    bench.accepted("external_enable", mode="relative")
    bench.accepted("external_setpoints", setpoints=rows)
    for each in (bench, twin):
        each.run(last - begin + 190)
    v = np.abs(column(bench, "set_velocity") - column(twin, "set_velocity"))[last : last + 190]
    rise = max(0.0, sign * rows[-1][3]) * CYCLE_TIME * min(every, SILENCE)
    assert v.max() <= abs(rows[-1][2]) + rise + 1e-6
    assert np.ptp(v[SILENCE:]) <= 1e-6
    assert bench.events == []
