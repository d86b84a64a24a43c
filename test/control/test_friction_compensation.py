"""Friction compensation: table against numpy.interp, weights around a reversal against figure 5 of the manual."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
import pytest
from loop_support import NO_FRICTION, MotionState, Phase, T, column, control, make_loop, motion, run, trapezoid
from numpy.typing import NDArray

from cnc_ptp.control.friction_compensation import FrictionTable
from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.view.control_view import FrictionParameters

VELOCITIES, CURRENTS = (0.0, 2.0, 5.0, 40.0), (90.0, 60.0, 70.0, 120.0)
FRICTION = replace(NO_FRICTION, permitted=True, active=True, velocities=VELOCITIES, currents=CURRENTS)


def friction(**changes: float) -> FrictionParameters:
    return replace(FRICTION, **changes)  # type: ignore[arg-type]


def currents(states: list[MotionState], of: FrictionParameters = FRICTION) -> NDArray[np.float64]:
    """The compensation current of every cycle."""
    return column(run(make_loop(control(friction=of)), states), "friction_current")


def from_table(states: list[MotionState]) -> NDArray[np.float64]:
    """Unweighted, with sign; 0 at standstill."""
    v = np.array([state[1] for state in states])
    return np.interp(np.abs(v), VELOCITIES, CURRENTS) * np.sign(v)


def behind(values: NDArray[np.float64], cycles: int) -> NDArray[np.float64]:
    """The same some cycles later; before that the first value."""
    return np.concatenate([np.full(cycles, values[0]), values[: len(values) - cycles]])


# ---------------------------------------------------------------- table


def test_the_table_is_numpys_linear_interpolation() -> None:
    draw = random.Random(5)
    for entries in (1, 2, 3, 20):
        velocities = tuple(sorted(draw.uniform(0.0, 300.0) for _ in range(entries)))
        values = tuple(draw.uniform(-4000.0, 4000.0) for _ in range(entries))
        table = FrictionTable(velocities, values)
        samples = [draw.uniform(-400.0, 400.0) for _ in range(300)] + [*velocities, 0.0, -velocities[-1]]
        for v in samples:
            assert table.current(v) == pytest.approx(np.interp(abs(v), velocities, values), rel=1e-12, abs=1e-9)


def test_the_current_has_the_sign_of_the_velocity_and_is_none_at_standstill() -> None:
    phases = trapezoid(25_000.0, 20, 10, 30, rest=20)
    states = motion(phases)
    forth = currents(states)
    back = currents([(-x, -v, -a, -j) for x, v, a, j in states])
    assert np.abs(forth - from_table(states)).max() < 1e-9
    assert np.array_equal(back, -forth)
    assert set(forth[-20:]) == {0.0} and forth[0] == 0.0 and forth.max() > 60.0


MANUAL = """
/machine: {ros__parameters: {axes: [x]}}
/x:
  ros__parameters:
    lr_param: {frict_comp: 1}
    frict_comp:
      mode: 3
      table_entries: 3
      position_delay: 30
      reversal_lookahead: 4
      scaling_factor: 10
      delay_cycles: 9
      table:
        "0": {in: 0, out: 0}
        "1": {in: 316, out: 3722}
        "2": {in: 333, out: 3884}
"""


def test_the_example_of_the_manual() -> None:
    """Friction 2.2: three entries, 1 %, 9 cycles of delay and 4 of looking ahead, built up over 3 µm."""
    control_of_x = load_machine(MANUAL, "m.yaml").axes["x"].control
    of = control_of_x.friction
    assert (of.velocities, of.position_delay) == ((0.0, 0.316, 0.333), pytest.approx(0.003))
    assert of.currents == pytest.approx((0.0, 37.22, 38.84))
    states = motion([(50, 100.0), (50, 0.0), (50, -100.0), (200, 0.0)])
    current = column(run(make_loop(control(friction=of)), states), "friction_current")
    v = np.array([state[1] for state in states])
    expected = np.interp(v, [0.0, 0.316, 0.333], [0.0, 37.22, 38.84])
    assert np.abs(current - behind(behind(expected, 4), 9)).max() < 1e-9
    assert current.max() == pytest.approx(38.84)


@pytest.mark.parametrize("factor", [-1000, 0, 500, 2500])
def test_the_scaling_factor_is_in_tenths_of_a_percent(factor: int) -> None:
    machine = load_machine(MANUAL.replace("scaling_factor: 10", f"scaling_factor: {factor}"), "m.yaml")
    expected = tuple(value * factor / 1000.0 for value in (0.0, 3722.0, 3884.0))
    assert machine.axes["x"].control.friction.currents == pytest.approx(expected)


# ---------------------------------------------------------------- reversal


def reversal(a: float, cycles: int = 60, offset: float = 0.3) -> list[MotionState]:
    """Turns back with constant acceleration, `offset` of a cycle after a setpoint."""
    states = []
    for n in range(-cycles, cycles):
        t = (n - offset) * T
        states.append((a * t * t / 2.0, a * t, a, 0.0))
    return states


@pytest.mark.parametrize("a", [40.0, 700.0, -3000.0])
@pytest.mark.parametrize("lookahead", [0, 1, 3, 4])
def test_before_a_reversal_the_weight_falls_by_cycles(a: float, lookahead: int) -> None:
    """1 until `lookahead` cycles before the first setpoint of the other direction, then 1/lookahead less in each."""
    states = reversal(a)
    weights = np.ones(len(states))
    turn = next(n for n, state in enumerate(states) if state[1] * a > 0.0)
    for cycles in range(1, lookahead + 1):
        weights[turn - cycles] = cycles / lookahead
    expected = behind(from_table(states) * weights, lookahead)
    got = currents(states, friction(reversal_lookahead=lookahead))
    assert np.abs(got[lookahead:] - expected[lookahead:]).max() < 1e-9


@pytest.mark.parametrize("a", [40.0, 700.0, -3000.0])
@pytest.mark.parametrize("distance", [0.0, 0.0005, 0.003, 0.5])
@pytest.mark.parametrize("offset", [0.0, 0.3, 0.97])
def test_after_a_reversal_the_weight_rises_by_way(a: float, distance: float, offset: float) -> None:
    """0 at the outermost position, 1 at `position_delay` from it; the outermost position is that of the setpoints."""
    states = reversal(a, offset=offset)
    positions = np.array([state[0] for state in states])
    outermost = min(positions) if a > 0.0 else max(positions)
    after = np.array([state[1] * a > 0.0 for state in states])
    way = np.abs(positions - outermost)
    weights = np.where(after & (way < distance), way / (distance or 1.0), 1.0)
    got = currents(states, friction(position_delay=distance))
    assert np.abs(got - from_table(states) * weights).max() < 1e-9
    # of the continuous motion the outermost position is 0, at most a·T²/8 away from the nearest setpoint
    assert abs(outermost) <= abs(a) * T * T / 2.0


def test_both_weights_as_in_figure_5() -> None:
    """From negative to positive velocity: down to 1/4 over 4 cycles, through 0, up over 30 µm."""
    states = reversal(50.0)
    got = currents(states, friction(reversal_lookahead=4, position_delay=0.03))[4:]
    weight = got / from_table(states)[:-4]
    assert weight[56:62] == pytest.approx([1.0, 1.0, 0.75, 0.5, 0.25, weight[61]], abs=1e-12)
    assert weight[61] < 1e-3 and np.all(np.diff(weight[61:95]) > 0.0) and weight[-1] == 1.0
    assert np.all(got[:61] < 0.0) and np.all(got[62:] > 0.0)


def through_zero(rest: int, sign: float) -> list[Phase]:
    """Slows down to rest, stays there, continues in the direction `sign`."""
    first = trapezoid(2000.0, 20, 0, 10, rest=rest)
    return [*first, *trapezoid(2000.0, 20, 0, 10, rest=5, sign=sign)]


@pytest.mark.parametrize("rest", [0, 1, 2, 40])
def test_slowing_down_and_going_on_is_no_reversal(rest: int) -> None:
    states = motion(through_zero(rest, 1.0))
    of = friction(reversal_lookahead=4, position_delay=0.1)
    assert np.abs(currents(states, of) - behind(from_table(states), 4)).max() < 1e-9
    slow = motion([(20, 2000.0), (20, -2000.0), (30, 0.0), (18, -2000.0), (36, 2000.0), (18, -2000.0), (20, 0.0)])
    assert min(state[1] for state in slow[40:]) > 0.0
    assert np.abs(currents(slow, of) - behind(from_table(slow), 4)).max() < 1e-9


@pytest.mark.parametrize("rest", [0, 1, 2, 3])
def test_a_short_rest_in_a_reversal_belongs_to_it(rest: int) -> None:
    """The return that is in sight makes the weight fall towards the rest, as far as it has been in sight."""
    states = motion(through_zero(rest, -1.0))
    of = friction(reversal_lookahead=4, position_delay=0.0)
    v = np.array([state[1] for state in states])
    last = max(n for n in range(len(v)) if v[n] > 0.0)
    turn = next(n for n in range(len(v)) if v[n] < 0.0)
    weights = np.ones(len(v))
    for n in range(turn - 4, last + 1):
        weights[n] = (last + 1 - n) / 4.0
    assert np.abs(currents(states, of) - behind(from_table(states) * weights, 4)).max() < 1e-9


def test_after_a_long_rest_a_reversal_is_still_one() -> None:
    states = motion(through_zero(100, -1.0))
    got = currents(states, friction(position_delay=0.01))
    turning_point = max(state[0] for state in states)
    way = turning_point - np.array([state[0] for state in states])
    begins = next(n for n, state in enumerate(states) if state[1] < 0.0)
    weights = np.where((np.arange(len(states)) >= begins) & (way < 0.01), way / 0.01, 1.0)
    assert np.abs(got - from_table(states) * weights).max() < 1e-9
    assert 0.0 > got[begins] > -1.0


def test_a_second_reversal_within_the_way_of_the_first_begins_anew() -> None:
    states = [(0.001 * np.cos(0.1 * n), -0.1 * np.sin(0.1 * n), 0.0, 0.0) for n in range(200)]
    got = currents(states, friction(position_delay=0.01))
    positions, last = np.array([state[0] for state in states]), 0
    v = np.array([state[1] for state in states])
    for n in range(40, 200):
        if v[n] * v[n - 1] < 0.0:
            last = n - 1 if abs(positions[n - 1]) > abs(positions[n]) else n
        if last:
            expected = from_table(states)[n] * abs(positions[n] - positions[last]) / 0.01
            assert got[n] == pytest.approx(expected, abs=1e-9)


# ---------------------------------------------------------------- delay, switching


@pytest.mark.parametrize("cycles", [1, 9, 248])
def test_delay_cycles_delay_every_value(cycles: int) -> None:
    states = motion([*through_zero(0, -1.0), (250, 0.0)])
    prompt = currents(states, friction(position_delay=0.01))
    late = currents(states, friction(position_delay=0.01, delay_cycles=cycles))
    assert np.array_equal(late, np.concatenate([np.zeros(cycles), prompt[:-cycles]]))


def test_switched_off_there_is_no_current_and_the_direction_is_known_all_the_same() -> None:
    """COMP OFF before a reversal, ON again within the way of the weighting after it; in between softly."""
    states = motion(through_zero(0, -1.0))
    loop = make_loop(control(friction=friction(position_delay=0.05)))
    always = currents(states, friction(position_delay=0.05))
    got = []
    for cycle, state in enumerate(states):
        if cycle in (50, 100):
            loop.friction.switch(cycle == 100)
        got.append(loop.step(state, True).friction_current)
    turns = next(cycle for cycle in range(50, 100) if states[cycle][1] < 0.0)
    assert got[:50] == always[:50].tolist()
    assert set(got[turns:100]) == {0.0} and np.count_nonzero(always[turns:100]) > 5
    assert np.all(np.abs(got[50:]) <= np.abs(always[50:])) and got[-10] == pytest.approx(always[-10] * 0.8, rel=0.1)


@pytest.mark.parametrize("of", [friction(active=False), replace(NO_FRICTION, permitted=True, active=True)])
def test_without_mode_or_table_there_is_never_a_current(of: FrictionParameters) -> None:
    loop = make_loop(control(friction=of))
    loop.friction.switch(True)
    assert not loop.friction.effective
    assert set(column(run(loop, motion(through_zero(0, -1.0))), "friction_current")) == {0.0}


def test_an_open_loop_forgets_the_direction_and_the_values_on_the_way() -> None:
    loop = make_loop(control(friction=friction(position_delay=0.05, delay_cycles=3)))
    forth, back = motion([(20, 2000.0), (20, 0.0)]), motion([(20, -2000.0), (20, 0.0)])
    run(loop, forth)
    assert run(loop, forth[-3:], closed=False)[-1].friction_current == 0.0
    got = column(run(loop, back), "friction_current")
    assert set(got[:4]) == {0.0}
    assert np.abs(got - behind(from_table(back), 3)).max() < 1e-9


@pytest.mark.parametrize("scale", [0.25, 500.0])
def test_the_current_goes_to_the_drive_as_torque(scale: float) -> None:
    """P-AXIS-00325, 00326, 00392: digits per Nm; with no scaling (110465) there is no output."""
    states = motion(through_zero(0, -1.0))
    cycles = run(make_loop(control(friction=FRICTION, torque_scale=scale)), states)
    assert np.abs(column(cycles, "additive_torque") * scale - column(cycles, "friction_current")).max() < 1e-9
    silent = run(make_loop(control(friction=FRICTION, torque_scale=0.0)), states)
    assert set(column(silent, "additive_torque")) == {0.0}


# ---------------------------------------------------------------- switched


def switched(
    states: list[MotionState], plan: dict[int, bool], of: FrictionParameters = FRICTION
) -> NDArray[np.float64]:
    loop = make_loop(control(friction=of))
    values = []
    for cycle, state in enumerate(states):
        if cycle in plan:
            loop.friction.switch(plan[cycle])
        values.append(loop.step(state, True).friction_current)
    return np.array(values)


@pytest.mark.parametrize("cycle", [60, 100, 400])
def test_switched_in_motion_the_current_goes_and_comes_without_a_step(cycle: int) -> None:
    """In 0.1 s: no cycle changes it by more than 1 % of the table's largest value beside what the velocity does."""
    states = motion([(40, 25_000.0), (40, -25_000.0), (900, 0.0)])
    steady = from_table(states)
    off = switched(states, {cycle: False})
    assert np.array_equal(off[:cycle], steady[:cycle]) and np.all(off[cycle + 100 :] == 0.0)
    back = switched(states, {cycle: False, cycle + 200: True})
    assert back[cycle + 300 :] == pytest.approx(steady[cycle + 300 :])
    for values in (off, back):
        assert np.abs(np.diff(values[80:])).max() <= 0.01 * max(CURRENTS) + 0.3
    share = switched(states, {cycle: False, cycle + 30: True})[400 if cycle < 400 else 500 :]
    assert share == pytest.approx(steady[-len(share) :])


@pytest.mark.parametrize("first", [5, 20])
def test_switched_at_a_standstill_it_is_there_at_once(first: int) -> None:
    """Also in the cycle in which the motion starts."""
    states = motion([(20, 0.0), *trapezoid(25_000.0, 40, 0, 100)])
    off = replace(FRICTION)
    values = switched(states, {0: False, first: True}, off)
    assert np.array_equal(values, switched(states, {}, off))
