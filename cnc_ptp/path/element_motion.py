"""Motions with an exact stop: a single element, one with a spindle on the path (G63), and a dwell."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cnc_ptp.path.active_motion import ActiveMotion, PathPoint
from cnc_ptp.path.geometry import Arc, Line
from cnc_ptp.path.interpolator import PathInterpolator
from cnc_ptp.path.motion_plan import Plan
from cnc_ptp.path.shape import AxisStates, standing, without_jerk
from cnc_ptp.path.thread.thread_check import TURN
from cnc_ptp.path.thread_place import ThreadPlace

Evaluation = Callable[[float, float, float, float], AxisStates]
"""States of the axes from path length, velocity, acceleration and jerk."""


class ElementMotion(ActiveMotion):
    """One element from rest to rest, after another one at its exact end inside a cycle."""

    def __init__(self, interpolator: PathInterpolator, cycle_time: float, plan: Plan) -> None:
        """Starts it. Raises CncError 22110, 22111, 23001; then nothing is started."""
        super().__init__()
        self._interpolator, self._cycle_time = interpolator, cycle_time
        self._element, self._feed = plan.element, plan.feed
        self._evaluate = evaluation(plan.element, steps=plan.steps)
        interpolator.start(plan.element, plan.limits, plan.feed, planner=plan.planner)

    def follow(self, count: int) -> list[PathPoint]:
        evaluate, length = self._evaluate, self._element.length
        rows = self._interpolator.step(count, self._cycle_time)
        return [(evaluate(*row[:4]), row[1], length - row[0]) for row in rows]

    def stop(self) -> None:
        self._interpolator.stop()

    @property
    def feed(self) -> float:
        return self._feed

    @property
    def stopped(self) -> bool:
        return self._interpolator.stopped

    @property
    def can_be_held(self) -> bool:
        return not self._interpolator.ends_by_itself

    def time_to_go(self, velocity: float, distance: float) -> float:
        return self._interpolator.time_to_go

    def part_to_go(self, distance: float) -> float:
        return distance / self._element.length if self._element.length > 0.0 else 0.0

    def rest(self, position: tuple[float, ...]) -> tuple[float, ...]:
        return tuple([state[0] for state in self._evaluate(self._interpolator.end, 0.0, 0.0, 0.0)])

    def end(self, position: tuple[float, ...]) -> tuple[float, ...]:
        return self._element.target if self._interpolator.done else position


class TappingMotion(ElementMotion):
    """An element with a spindle as its last coordinate (deg)."""

    def __init__(self, interpolator: PathInterpolator, cycle_time: float, plan: Plan, spindle: str) -> None:
        """`spindle`: its node. Raises as `ElementMotion`."""
        super().__init__(interpolator, cycle_time, plan)
        self._start = thread_place(spindle, plan.element.start, plan.element.target)

    def follow(self, count: int) -> list[PathPoint]:
        points = super().follow(count)
        start, axis = self._start, self._start.axis
        self.spindle_states = [states[-1] for states, _, _ in points]
        self.places = [start._replace(position=states[axis][0]) for states, _, _ in points]
        return [(states[:-1], velocity, distance) for states, velocity, distance in points]

    def rest(self, position: tuple[float, ...]) -> tuple[float, ...]:
        return super().rest(position)[:-1]

    def end(self, position: tuple[float, ...]) -> tuple[float, ...]:
        if not self._interpolator.done:
            return position
        *target, angle = self._element.target
        self.spindle_states = list(standing([angle]))
        return tuple(target)


class DwellMotion(ActiveMotion):
    """The axes rest for some seconds."""

    def __init__(self, interpolator: PathInterpolator, cycle_time: float, seconds: float, states: AxisStates) -> None:
        """Starts it; `states` of the axes, at rest. Raises CncError 22110, 22112; then nothing is started."""
        super().__init__()
        self._interpolator, self._cycle_time = interpolator, cycle_time
        self._seconds, self._states = seconds, states
        interpolator.dwell(seconds)

    def follow(self, count: int) -> list[PathPoint]:
        return [(self._states, 0.0, 0.0)] * len(self._interpolator.step(count, self._cycle_time))

    @property
    def on_path(self) -> bool:
        return False

    @property
    def stopped(self) -> bool:
        return self._interpolator.stopped

    def held_by(self, override: float) -> bool:
        return False

    def time_to_go(self, velocity: float, distance: float) -> float:
        return self._interpolator.time_to_go

    def part_to_go(self, distance: float) -> float:
        return max(0.0, self._interpolator.time_to_go) / self._seconds if self._seconds > 0.0 else 0.0


def thread_place(spindle: str, start: Sequence[float], target: Sequence[float]) -> ThreadPlace:
    """The start of a tapping motion, whose last coordinate is the spindle."""
    *ways, turned = [end - begin for begin, end in zip(start, target, strict=True)]
    axis = max(range(len(ways)), key=lambda place: abs(ways[place]))
    lead = TURN * ways[axis] / turned if turned != 0.0 else 0.0
    return ThreadPlace(spindle, axis, start[axis], lead)


def evaluation(element: Line | Arc, *, steps: bool) -> Evaluation:
    """States of the axes on an element; without a limit of the jerk none is fed forward (P-AXIS-00337).

    On a line the axes then have none anyway.
    """
    if not steps or isinstance(element, Line):
        return element.evaluate

    def stepping_states(s: float, v: float, a: float, j: float) -> AxisStates:
        return without_jerk(element.evaluate(s, v, a, j))

    return stepping_states
