"""Closed forms of ramps and a second planner (Ruckig), against which the motion of an axis is held."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from axis_states_support import DYNAMICS, A, J, V
from machine_support import CYCLE_TIME, UnitBench, axis_bench
from ruckig import ControlInterface, InputParameter, Result, Ruckig, RuckigError, Trajectory

from cnc_ptp.protocol.axis_states import AxisStateCode as S

MotionState = tuple[float, float, float]
"""Position, velocity, acceleration."""


def start(bench: UnitBench, target: float, **dynamics: float) -> None:
    assert bench.accepted("move_absolute", target=target, **{**DYNAMICS, **dynamics}) == ""


def started(target: float, cycles: int, *, count: int = 100, override_type: int = 1, **dynamics: float) -> UnitBench:
    """A bench that has been under way to `target` for `cycles`."""
    bench = axis_bench(count=count, override_type=override_type)
    start(bench, target, **dynamics)
    bench.run(cycles)
    return bench


def run_to_standstill(bench: UnitBench, most: int = 30_000) -> None:
    """On until the axis has come to rest without a job."""
    end = bench.cycle + most
    while bench.cycle < end:
        bench.run(100)
        if bench.state in (S.STANDSTILL, S.DISABLED):
            return
    raise AssertionError(f"the axis is in state {bench.state} after {most} cycles")


def motion(bench: UnitBench) -> list[MotionState]:
    """Position, velocity and acceleration of every cycle."""
    names = ("position", "velocity", "acceleration")
    return list(zip(*(bench.column(f"set_{name}") for name in names), strict=True))


def ramp_time(change: float, a: float = A, j: float = J) -> float:
    """Time of a velocity change between two states without acceleration."""
    return change / a + a / j if change * j >= a * a else 2.0 * math.sqrt(change / j)


def ramp_way(v: float, to: float, a: float = A, j: float = J) -> float:
    return 0.5 * (v + to) * ramp_time(abs(to - v), a, j)


def reachable(distance: float, a: float = A, j: float = J) -> float:
    """Peak velocity between two standstills: d = v·(v/A + A/J), or d = 2v·√(v/J) while A is not reached."""
    v = 0.5 * a * (-a / j + math.sqrt((a / j) ** 2 + 4.0 * distance / a))
    return v if v * j >= a * a else (0.25 * j * distance * distance) ** (1.0 / 3.0)


def time_of_arrival(bench: UnitBench) -> float:
    """When DiscreteMotion has ended, s: the first cycle of Standstill after it."""
    states = bench.column("state")
    begin = states.index(S.DISCRETE_MOTION)
    return states.index(S.STANDSTILL, begin) * CYCLE_TIME


# ---------------------------------------------------------------- Ruckig


def _calculate(inputs: InputParameter) -> Trajectory:
    """Ruckig refuses some states on the very edge (the last jerk of a stop); next to it, it plans them."""
    trajectory = Trajectory(1)
    try:
        result = Ruckig(1).calculate(inputs, trajectory)
    except RuckigError:
        inputs.current_acceleration = [inputs.current_acceleration[0] * (1.0 - 1e-10)]
        result = Ruckig(1).calculate(inputs, trajectory)
    assert result in (Result.Working, Result.Finished), result
    return trajectory


def _inputs(state: MotionState, v: float, a: float, j: float) -> InputParameter:
    inputs = InputParameter(1)
    inputs.current_position, inputs.current_velocity, inputs.current_acceleration = ([x] for x in state)
    inputs.max_velocity, inputs.max_acceleration, inputs.max_jerk = [v], [a], [j]
    inputs.target_velocity = inputs.target_acceleration = [0.0]
    return inputs


def to_position(state: MotionState, target: float, v: float = V, a: float = A, j: float = J) -> Trajectory:
    inputs = _inputs(state, v, a, j)
    inputs.target_position = [target]
    return _calculate(inputs)


def to_rest(state: MotionState, a: float = A, j: float = J) -> Trajectory:
    inputs = _inputs(state, 1e9, a, j)
    inputs.control_interface = ControlInterface.Velocity
    return _calculate(inputs)


def to_velocity(state: MotionState, wanted: float, a: float = A, j: float = J) -> Trajectory:
    inputs = _inputs(state, 1e9, a, j)
    inputs.control_interface = ControlInterface.Velocity
    inputs.target_velocity = [wanted]
    return _calculate(inputs)


def at(trajectory: Trajectory, t: float) -> MotionState:
    p, v, a = trajectory.at_time(min(t, trajectory.duration))
    on = v[0] * (t - trajectory.duration) if t > trajectory.duration and abs(v[0]) > 1e-6 else 0.0
    return (p[0] + on, v[0], a[0])


def expected(legs: Sequence[Trajectory], cycles: int) -> list[MotionState]:
    """The states of `cycles` cycles along trajectories that follow each other."""
    states = []
    for k in range(cycles):
        t = k * CYCLE_TIME
        for leg in legs[:-1]:
            if t < leg.duration:
                break
            t -= leg.duration
        else:
            leg = legs[-1]
        states.append(at(leg, t))
    return states


def legs_to(state: MotionState, target: float, v: float = V, a: float = A, j: float = J) -> list[Trajectory]:
    """The motion to a new target: direct, or by a stop and from there back (TX1250 2.3)."""
    if abs(state[1]) > v:  # down to V first: Ruckig is slower there
        slower = to_velocity(state, math.copysign(v, state[1]), a, j)
        return [slower, *legs_to(at(slower, slower.duration), target, v * (1.0 + 1e-12), a, j)]
    stop = to_rest(state, a, j)
    rest = at(stop, stop.duration)[0]
    direction = math.copysign(1.0, rest - state[0])
    if rest != state[0] and direction * (rest - target) > 1e-9 * max(1.0, abs(target)):
        return [stop, to_position((rest, 0.0, 0.0), target, v, a, j)]
    return [to_position(state, target, v, a, j)]


def assert_follows(bench: UnitBench, cycle: int, legs: Sequence[Trajectory], *, position: float = 2e-5) -> None:
    """From `cycle` on the axis is where the trajectories are; Ruckig is some nanoseconds off on edges."""
    ours = np.array(motion(bench)[cycle:])
    theirs = np.array(expected(legs, len(ours)))
    off = np.abs(ours - theirs).max(axis=0)
    assert off[0] <= position and off[1] <= 1e3 * position, f"{off} at {np.abs(ours - theirs).argmax(axis=0)}"
    assert ours[-1][0] == theirs[-1][0] or abs(ours[-1][0] - theirs[-1][0]) <= 1e-9 * max(1.0, abs(theirs[-1][0]))
