"""Motion arithmetic against Ruckig, side by side. Prints figures, never fails on time: `python bench/motion.py`.

Each figure is the median of several rounds over a few hundred seeded problems, in microseconds a call.
"""

from __future__ import annotations

import random
import statistics
import time
from collections.abc import Callable, Sequence

import numpy as np
import ruckig

from cnc_ptp.motion import Limits, plan_rest_to_rest, plan_rest_to_rest_batch, plan_to_position, plan_to_velocity
from cnc_ptp.path import Arc, AxisLimits, Line, PathInterpolator

ROUNDS = 15
Problem = tuple[float, float, float, float, Limits]


def problems(count: int, *, moving: bool) -> list[Problem]:
    """Seeded problems of a machine axis; `moving` starts anywhere within the limits."""
    draw = random.Random(7)
    found = []
    for _ in range(count):
        acceleration = 10 ** draw.uniform(2, 4)
        limits = Limits(10 ** draw.uniform(1, 3.5), acceleration, acceleration, 10 ** draw.uniform(3, 5))
        v = draw.uniform(0.0, 0.7) * limits.velocity if moving else 0.0
        a = draw.uniform(-0.5, 0.5) * min(acceleration, (limits.jerk * limits.velocity * 0.3) ** 0.5) if moving else 0.0
        found.append((draw.uniform(-500.0, 500.0), v, a, draw.uniform(-1500.0, 1500.0), limits))
    return found


def microseconds(call: Callable[..., object], arguments: Sequence[tuple[object, ...]]) -> float:
    """Median over the rounds of the mean time of one call, µs."""
    rounds = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        for each in arguments:
            call(*each)
        rounds.append((time.perf_counter() - begin) / len(arguments))
    return statistics.median(rounds) * 1e6


class RuckigPeer:
    """Ruckig as a Python user calls it: set the inputs, calculate, sample."""

    def __init__(self) -> None:
        self.planner = ruckig.Ruckig(1)
        self.input = ruckig.InputParameter(1)
        self.input.target_velocity = [0.0]
        self.input.target_acceleration = [0.0]
        self.trajectory = ruckig.Trajectory(1)

    def plan(self, p: float, v: float, a: float, target: float, limits: Limits) -> object:
        """Inputs and calculation; a problem that Ruckig refuses is left out by the caller."""
        self.input.current_position = [p]
        self.input.current_velocity = [v]
        self.input.current_acceleration = [a]
        self.input.target_position = [target]
        self.input.max_velocity = [limits.velocity]
        self.input.max_acceleration = [limits.acceleration]
        self.input.max_jerk = [limits.jerk]
        return self.planner.calculate(self.input, self.trajectory)

    def solves(self, problem: Problem) -> bool:
        """False where Ruckig raises on a valid problem."""
        try:
            self.plan(*problem)
        except ruckig.RuckigError:
            return False
        return True


def report(name: str, ours: float, peer: float | None, goal: float | None = None) -> None:
    """One line: our time, the goal, Ruckig's time and the ratio."""
    aim = f"goal {goal:6.2f}" if goal is not None else " " * 11
    other = f"Ruckig {peer:8.3f} µs   ratio {ours / peer:7.2f}" if peer is not None else ""
    print(f"{name:48s} {ours:9.3f} µs   {aim}   {other}")


def bench_plans(peer: RuckigPeer) -> None:
    """Planning, one by one and in one call."""
    rest = problems(300, moving=False)
    moving = [each for each in problems(300, moving=True) if peer.solves(each)]
    ruckig_rest = microseconds(peer.plan, rest)
    ours = microseconds(plan_rest_to_rest, [(p, t, x) for p, _, _, t, x in rest])
    report("plan rest to rest", ours, ruckig_rest, 8.0)
    report("plan to position, at rest", microseconds(plan_to_position, rest), ruckig_rest)
    report("plan to position, moving", microseconds(plan_to_position, moving), microseconds(peer.plan, moving), 30.0)
    to_zero = [(p, v, a, 0.0, x) for p, v, a, _, x in moving]
    report("plan to velocity 0", microseconds(plan_to_velocity, to_zero), None)
    many = problems(10_000, moving=False)
    columns = np.array([(p, t, *x) for p, _, _, t, x in many]).T.copy()
    batch = microseconds(plan_rest_to_rest_batch, [tuple(columns)]) / len(many)
    report("plan rest to rest, 10,000 in one call", batch, ruckig_rest, ruckig_rest / 3.0)


def bench_evaluation(peer: RuckigPeer) -> None:
    """One cycle and a thousand cycles of one profile."""
    limits = Limits(2000.0, 5000.0, 5000.0, 50000.0)
    profile = plan_rest_to_rest(0.0, 1000.0, limits)
    peer.plan(0.0, 0.0, 0.0, 1000.0, limits)
    moments = [(0.001 * cycle,) for cycle in range(1000)]
    at_time = microseconds(peer.trajectory.at_time, moments)
    report("state_at, one cycle", microseconds(profile.state_at, moments), at_time, 1.0)
    times = np.arange(1000) * 0.001
    report("sample, 1,000 cycles", microseconds(profile.sample, [(times,)] * 50), 1000.0 * at_time, 30.0)


def bench_path() -> None:
    """Geometry and path interpolation."""
    line = Line((0.0, 0.0, 0.0), (10.0, 20.0, 30.0))
    arc = Arc((10.0, 0.0, 0.0), (0.0, 10.0, 1.0), (0.0, 0.0), (0, 1), 10.0, 90.0)
    states = [(0.01 * n, 100.0, 5.0, 7.0) for n in range(1000)]
    report("line, 3 axes, one cycle", microseconds(line.evaluate, states), None, 1.0)
    report("arc, 3 axes, one cycle", microseconds(arc.evaluate, states), None, 2.5)
    axes = [AxisLimits(500.0, 3000.0, 3000.0, 30000.0)] * 3
    report("limits of an arc", microseconds(arc.limits, [(50.0, axes)] * 300), None)

    def run() -> None:
        interpolator = PathInterpolator()
        interpolator.start(line, line.limits(50.0, axes))
        while not interpolator.done:
            interpolator.step(10, 0.001)

    cycles = line.length / 50.0 / 0.001
    report("path interpolator, one cycle of blocks of 10", microseconds(run, [()] * 5) / cycles, None)


if __name__ == "__main__":
    bench_plans(RuckigPeer())
    bench_evaluation(RuckigPeer())
    bench_path()
