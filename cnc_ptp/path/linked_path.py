"""A path of several blocks that is run through without a stop: what the channel sees of the look-ahead."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from math import sqrt
from typing import Final, Protocol

from cnc_ptp.errors import CncError
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.nc.canonical import CircularMove, LinearMove, led_by_spindle
from cnc_ptp.path.active_motion import ActiveMotion, PathPoint
from cnc_ptp.path.interpolator import PathInterpolator
from cnc_ptp.path.lookahead.look_ahead import LookAhead
from cnc_ptp.path.lookahead.parts import PathPart
from cnc_ptp.path.lookahead.path_builder import LinkedMotion, PathBuilder
from cnc_ptp.path.shape import AxisStates, standing, without_jerk

Path = LinearMove | CircularMove


class MotionSource(Protocol):
    """The motions that follow the active one without a reason to stop between them."""

    @property
    def busy(self) -> bool:
        """The next one is not known yet."""

    def peek(self) -> Path | None:
        """The next motion; None if the path has to stop before what comes next, or while it is not known."""

    def accept(self) -> None:
        """The motion that `peek` has shown belongs to the path now."""


Maker = Callable[[tuple[float, ...], Path, int], LinkedMotion]
"""Makes an element of the position at which a motion begins, the motion and the number of its block."""


LONG_CYCLE: Final = 0.01
"""s from one look at the path to the next where only its time counts."""


def can_follow(motion: Path, following: Path) -> bool:
    """Nothing in the two motions asks for a stop between them."""
    if led_by_spindle(motion) or led_by_spindle(following):
        return False
    alike = motion.full_override == following.full_override and motion.slope == following.slope
    blended = motion.transition.contour is not None or is_rapid(motion) == is_rapid(following)
    alike = alike and motion.kinematics == following.kinematics
    return alike and blended and not motion.transition.stops and not taps(following) and turns_alike(motion, following)


def turns_alike(motion: Path, following: Path) -> bool:
    """Both have a feed per turn of the same spindle, or none has."""
    first, second = motion.per_turn, following.per_turn
    return first is second or (first is not None and second is not None and first.spindle == second.spindle)


def taps(motion: Path) -> bool:
    """A spindle turns with the motion (G63)."""
    return isinstance(motion, LinearMove) and motion.tap is not None


def is_rapid(motion: Path) -> bool:
    """G00."""
    return isinstance(motion, LinearMove) and motion.rapid


def path_velocity(states: AxisStates, axes: Sequence[int]) -> float:
    """Velocity of the given axes together."""
    square = 0.0
    for axis in axes:
        velocity = states[axis][1]
        square += velocity * velocity
    return sqrt(square)


class LinkedPath(ActiveMotion):
    """Runs linked motions.

    block   number of the active block within the path, from 0
    """

    def __init__(
        self,
        look_ahead: LookAhead,
        builder: PathBuilder,
        source: MotionSource,
        make: Maker,
        cycle_time: float,
        *,
        steps: bool,
    ) -> None:
        """`steps`: the acceleration of the path may step, so no jerk is fed forward (P-AXIS-00337)."""
        super().__init__()
        self.look_ahead = look_ahead
        self._cycle_time = cycle_time
        self._steps = steps
        self._builder, self._source, self._make = builder, source, make
        self.block = 0
        self._blocks = 1
        """Number of blocks that belong to the path."""
        self._ends: deque[float] = deque([0.0])
        """u at the ends of the active block and of those behind it, as far as they are known."""
        self._begin = 0.0
        """u at which the active block begins."""
        self._feeds: deque[float] = deque()
        self._rows: deque[MotionState] = deque()

    def begin(self, first: LinkedMotion, motion: Path, following: Path | None, position: Sequence[float]) -> bool:
        """Links the first two motions; False if they cannot be linked. `position` of the axes at the start.

        With kinematics the first one may be the only one.
        """
        self._last = motion
        self._at_start = standing(position)
        """Of the axes, while too little of the path is known for its first part."""
        self._feeds.append(first.shown)
        self._builder.begin()
        self._append(self._builder.add(first))
        if following is not None and self._extend(following):
            return True
        if first.kinematics is None:
            return False
        self._append(self._builder.finish())
        self.look_ahead.closed = True
        return True

    @property
    def feed(self) -> float:
        return self._feeds[0]

    @property
    def target(self) -> tuple[float, ...]:
        """End of the last block, for the axes of the machine."""
        return self._last.target if self._last.kinematics is None else self._builder.reached

    @property
    def done(self) -> bool:
        """All blocks are finished."""
        return self.look_ahead.done and not self._rows and self.block == self._blocks - 1

    def end(self, position: tuple[float, ...]) -> tuple[float, ...]:
        return self.target if self.done else position

    def hand_over(self, interpolator: PathInterpolator) -> None:
        interpolator.go_on(self.look_ahead.remaining_time - self._cycle_time if self.done else 0.0)

    @property
    def runs_through(self) -> bool:
        return True

    @property
    def stopped(self) -> bool:
        return self.look_ahead.stopped

    def stop(self) -> None:
        self.look_ahead.stop()

    def set_override(self, override: float) -> None:
        self.look_ahead.set_override(override)

    @property
    def can_be_held(self) -> bool:
        return not self.look_ahead.brakes_for_end

    def time_to_go(self, velocity: float, distance: float) -> float:
        """At the present velocity, because the path runs through."""
        return distance / velocity if velocity > 0.0 else -1.0

    def length_known(self, distance: float) -> float:
        return self.look_ahead.known

    @property
    def runs_out(self) -> float:
        return self.look_ahead.known if self.look_ahead.runs_out else -1.0

    @property
    def passes(self) -> bool:
        return self._block_ahead() > self.block

    def part_to_go(self, distance: float) -> float:
        length = self._ends[0] - self._begin
        return min(1.0, distance / length) if length > 0.0 else 0.0

    def pass_block(self) -> None:
        self.block += 1
        self._begin = self._ends.popleft()
        self._feeds.popleft()

    @property
    def halted(self) -> bool:
        return self.look_ahead.halted and not self._rows

    def halt(self) -> None:
        kept = self._builder.kept - self.block
        self.look_ahead.halt([end for block, end in enumerate(self._ends) if end > 0.0 and block < kept])

    def resume(self) -> None:
        self.look_ahead.resume()

    def follow(self, count: int) -> list[PathPoint]:
        points: list[PathPoint] = []
        while len(points) < count:
            if not self._rows:
                self._fill()
                self._rows.extend(self.look_ahead.step(count - len(points), self._cycle_time))
                if not self._rows:
                    break
            if self.passes:
                break
            u, v, a, j = self._rows.popleft()
            if not self.look_ahead.begun:
                points.append((self._at_start, 0.0, 0.0))
                continue
            begin, part = self.look_ahead.locate(u)
            states = part.geometry.evaluate(u - begin, v, a, j)
            if part.transformed:
                velocity = v * (part.geometry.speed(u - begin, part.path_axes) or 1.0)
            else:
                velocity = path_velocity(states, part.path_axes) or v  # other axes alone have a path of their own
            if self._steps:
                states = without_jerk(states)
            points.append((states, velocity, max(0.0, self._ends[0] - u)))
        return points

    def durations(self) -> list[float]:
        """Seconds that each block takes; the path is run through for that, without giving out its states."""
        ends: list[float] = []
        time = before = 0.0
        while not self.look_ahead.done:
            self._fill()
            rows = self.look_ahead.step(1, LONG_CYCLE)
            step = LONG_CYCLE if rows else LONG_CYCLE - self.look_ahead.remaining_time
            u = rows[0][0] if rows else self.look_ahead.end
            block = self.look_ahead.locate(u)[1].block if rows else self._blocks - 1
            while self.block < block:
                part = (self._ends[0] - before) / (u - before) if u > before else 1.0
                ends.append(time + step * min(1.0, max(0.0, part)))
                self.pass_block()
            time, before = time + step, u
        ends.append(time)
        return [max(0.0, end - begin) for begin, end in zip([0.0, *ends], ends, strict=False)]

    def _block_ahead(self) -> int:
        if self._rows and self.look_ahead.begun:
            return self.look_ahead.locate(self._rows[0][0])[1].block
        return self._blocks - 1 if self.look_ahead.done else self.block

    def _fill(self) -> None:
        """Appends motions until the window is full."""
        while self.look_ahead.wants:
            motion = self._source.peek()
            if motion is None and self._source.busy:
                return
            if motion is None or not self._extend(motion):
                self._append(self._builder.finish())
                self.look_ahead.closed = True

    def _extend(self, motion: Path) -> bool:
        """Links the next motion; False if the path has to stop before it."""
        last = self._last
        if not can_follow(last, motion):
            return False
        try:
            linked = self._make(last.target, motion, self._blocks)
        except CncError:
            return False  # reported when the path gets there
        if not self._builder.passes(linked):
            return False
        parts = self._builder.add(linked)
        self._source.accept()
        self._blocks += 1
        self._last = motion
        self._feeds.append(linked.shown)
        self._ends.append(0.0)
        self._append(parts)
        return True

    def _append(self, parts: list[PathPart]) -> None:
        for part in parts:
            self.look_ahead.append(part)
            self._ends[part.block - self.block] = self.look_ahead.end
