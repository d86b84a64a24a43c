"""Motion arithmetic against Ruckig, side by side.

Each figure is the median of several rounds over a few hundred seeded problems, in microseconds per call.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
import ruckig

from bench.figures import Effort, Figure, ShowProgress, medians_of, stopwatch
from cnc_ptp.motion import Limits, plan_rest_to_rest, plan_rest_to_rest_batch, plan_to_position, plan_to_velocity
from cnc_ptp.path import Arc, AxisLimits, Line, PathInterpolator

Problem = tuple[float, float, float, float, Limits]
Measure = Callable[[], float]
RUCKIG = "Ruckig"
ROUNDS = 3
"""Rounds for each run of the effort: one is short."""


def problems(count: int, *, moving: bool) -> list[Problem]:
    """Seeded problems of a machine axis; `moving` starts in either direction, up to 1.5 times the limits."""
    draw = random.Random(7)
    found = []
    for _ in range(count):
        acceleration = 10 ** draw.uniform(2, 4)
        limits = Limits(10 ** draw.uniform(1, 3.5), acceleration, acceleration, 10 ** draw.uniform(3, 5))
        v = draw.uniform(-1.5, 1.5) * limits.velocity if moving else 0.0
        a = draw.uniform(-1.5, 1.5) * min(acceleration, (limits.jerk * limits.velocity) ** 0.5) if moving else 0.0
        found.append((draw.uniform(-500.0, 500.0), v, a, draw.uniform(-1500.0, 1500.0), limits))
    return found


def calls(call: Callable[..., object], arguments: Sequence[tuple[object, ...]]) -> Measure:
    """Measures the mean time of one call, µs."""

    def measure() -> float:
        with stopwatch() as watch:
            for each in arguments:
                call(*each)
        return 1e6 * watch.wall / len(arguments)

    return measure


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


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Plans, evaluation, path."""
    peer = RuckigPeer()
    show("plans")
    yield from plans(effort, peer)
    show("evaluation")
    yield from evaluation(effort, peer)
    show("path")
    yield from path(effort)


def against_ruckig(
    effort: Effort, name: str, ours: Measure, theirs: Measure, goal: float | None = None
) -> Iterator[Figure]:
    """Both in turn; `goal` is one for the ratio."""
    value, peer_value = medians_of(ROUNDS * effort.runs, [ours, theirs])
    yield Figure(name, value, "µs", goal=goal, at_most=True, of_ratio=True, peer=RUCKIG, peer_value=peer_value)


def plans(effort: Effort, peer: RuckigPeer) -> Iterator[Figure]:
    """Planning, one by one and in one call. From any state also by a direct reversal, as Ruckig does it."""
    rest = problems(effort.scaled(300), moving=False)
    moving = [each for each in problems(effort.scaled(300), moving=True) if peer.solves(each)]
    theirs, theirs_moving = calls(peer.plan, rest), calls(peer.plan, moving)
    closed_form = calls(plan_rest_to_rest, [(p, target, limits) for p, _, _, target, limits in rest])
    yield from against_ruckig(effort, "plan from rest", closed_form, theirs)
    yield from against_ruckig(effort, "plan to position, at rest", calls(plan_to_position, rest), theirs)
    any_state = calls(plan_to_position, moving)
    yield from against_ruckig(effort, "plan from any state", any_state, theirs_moving, goal=1.5)
    direct = calls(partial(plan_to_position, direct=True), moving)
    yield from against_ruckig(effort, "plan from any state, direct reversal", direct, theirs_moving, goal=1.5)
    ramps = calls(plan_to_velocity, [(p, v, a, 0.0, limits) for p, v, a, _, limits in moving])
    yield Figure("plan to velocity 0", medians_of(ROUNDS * effort.runs, [ramps])[0], "µs")
    yield from many_in_one_call(effort, theirs)


def many_in_one_call(effort: Effort, theirs: Measure) -> Iterator[Figure]:
    """10,000 motions from rest in one call: µs a plan."""
    many = problems(effort.scaled(10_000), moving=False)
    columns = np.array([(p, target, *limits) for p, _, _, target, limits in many]).T.copy()
    batch = calls(plan_rest_to_rest_batch, [tuple(columns)])
    name = f"plan from rest, {len(many):,} in one call"
    value, peer_value = medians_of(ROUNDS * effort.runs, [lambda: batch() / len(many), theirs])
    yield Figure(name, value, "µs", goal=0.05, at_most=True, of_ratio=True, peer=RUCKIG, peer_value=peer_value)


def evaluation(effort: Effort, peer: RuckigPeer) -> Iterator[Figure]:
    """One cycle and a thousand cycles of one profile."""
    limits = Limits(2000.0, 5000.0, 5000.0, 50000.0)
    profile = plan_rest_to_rest(0.0, 1000.0, limits)
    peer.plan(0.0, 0.0, 0.0, 1000.0, limits)
    moments = [(0.001 * cycle,) for cycle in range(1000)]
    at_time = calls(peer.trajectory.at_time, moments)
    yield from against_ruckig(effort, "state_at, one cycle", calls(profile.state_at, moments), at_time, goal=0.5)
    sample = calls(profile.sample, [(np.arange(1000) * 0.001,)] * 50)
    yield from against_ruckig(effort, "sample, 1,000 cycles", sample, lambda: 1000.0 * at_time(), goal=0.05)


def path(effort: Effort) -> Iterator[Figure]:
    """Geometry and path interpolation."""
    line = Line((0.0, 0.0, 0.0), (10.0, 20.0, 30.0), (0, 1, 2))
    arc = Arc((10.0, 0.0, 0.0), (0.0, 10.0, 1.0), (0.0, 0.0), (0, 1), 10.0, 90.0, (0, 1, 2))
    states = [(0.01 * n, 100.0, 5.0, 7.0) for n in range(1000)]
    axes = [AxisLimits(500.0, 3000.0, 3000.0, 30000.0)] * 3
    of_line = line.limits(50.0, axes)

    def run() -> None:
        interpolator = PathInterpolator()
        interpolator.start(line, of_line)
        while not interpolator.done:
            interpolator.step(10, 0.001)

    cycles = line.length / 50.0 / 0.001
    whole = calls(run, [()])
    measures = {
        "line of 3 axes, one cycle": calls(line.evaluate, states),
        "arc of 3 axes, one cycle": calls(arc.evaluate, states),
        "limits of an arc": calls(arc.limits, [(50.0, axes)] * 300),
        "path interpolator, one cycle in blocks of 10": lambda: whole() / cycles,
    }
    goals = (1.0, 2.5, None, None)
    values = medians_of(ROUNDS * effort.runs, list(measures.values()))
    for name, value, goal in zip(measures, values, goals, strict=True):
        yield Figure(name, value, "µs", goal=goal, at_most=True)
