"""Look-ahead: runs parts of a path one after the other without a stop between them.

Parts are appended while the path moves. The velocity is planned over all that are known, to rest at the end of the last
one, and planned again from a knot ahead as the path gets on: what is appended can only make it faster. Override, feed
hold and stop are plans with another feed, which counts from the first cell from which it can be kept.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import inf, nextafter, sqrt
from typing import Final

from cnc_ptp.motion import stopping_distance
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.path.lookahead.parts import CELL_TIME, PathPart, UndividedPart, division_of, whole_cell
from cnc_ptp.path.lookahead.path_cell import PathCell
from cnc_ptp.path.lookahead.path_profile import BETWEEN, PathPiece, PathProfile, pieces_of
from cnc_ptp.path.lookahead.velocity_plan import MovingStart, VelocityPlan, earliest, plan_velocity, stop_soon

AT_REST: Final = 1e-6
"""Override below which the path stops."""
MOST_CELLS: Final = 4000
"""Cells that are known at once."""
FEWEST_CELLS: Final = 3
CELLS_AHEAD: Final = 64
"""Cells that are known at least where parts are long, and by which they are divided."""
MOST_OF_LONG: Final = 500
"""Cells at which no more of a long part are made: 2 s at its velocity."""
WINDOW: Final = 4.0
"""What is planned at once, in stopping distances on a straight path."""
RENEWAL: Final = 0.5
"""Part of the planned path after which it is planned again."""
BRAKES: Final = 0.8
"""The path brakes for its end when the distance in which it could stop is this part of what is ahead."""


class LookAhead:
    """The path from one stop to the next.

    override    factor on the feed; 0 is feed hold
    end         u of the end of the last part
    closed      no part follows
    done        the end has been reached
    halted      the path is at rest at the place for which `halt` was called
    remaining_time  s from the end to the cycle in which it was reached
    """

    def __init__(self, override: float, offset: float, cell_time: float = CELL_TIME) -> None:
        """`offset`: s by which the first cycle is behind the start (0 or less); `cell_time`: s of the longest cell."""
        self._cell_time = cell_time
        self.override = override
        self.end = 0.0
        self.closed = False
        self.done = False
        self.halted = False
        self.remaining_time = 0.0
        self.state: MotionState = (0.0, 0.0, 0.0, 0.0)
        self._time = offset
        self._parts: deque[tuple[float, PathPart]] = deque()
        self._undivided: deque[UndividedPart] = deque()
        """Parts behind the cells that are known."""
        self._halt = inf
        """u at which the path halts."""
        self._split = False
        """A stretch was divided for that."""
        self._stretches: deque[list[PathCell]] = deque([[]])
        """Cells from one exact stop to the next; of the first one from the last rest or knot on."""
        self._profile: PathProfile | None = None
        self._planned_end = 0.0
        self._renew = 0.0
        self._reach = 0.0
        self._deceleration = self._jerk = 1.0
        """Of the last part, along the path."""
        self._stopping = False
        self._before = override
        """The last override above 0 with which was planned."""

    # what is ahead

    @property
    def _cells(self) -> list[PathCell]:
        """Those up to the next exact stop."""
        return self._stretches[0]

    @property
    def wants(self) -> bool:
        """The next part should be appended: less than a window is ahead."""
        if self.closed or self._stopping or self._undivided or sum(map(len, self._stretches)) >= MOST_CELLS:
            return False
        return self.end - self.state[0] < WINDOW * self._reach or len(self._stretches[-1]) < FEWEST_CELLS

    @property
    def _stretch_known(self) -> bool:
        """All cells up to the next exact stop are known, or to the end of the parts."""
        if len(self._stretches) > 1 or not self._undivided:
            return True
        waiting = self._undivided[0]
        return not waiting.begun and (waiting.part.entry <= 0.0 or waiting.origin == self._halt)

    @property
    def begun(self) -> bool:
        """There is a part."""
        return bool(self._parts)

    @property
    def known(self) -> float:
        """Length that is ahead."""
        return self.end - self.state[0]

    @property
    def runs_out(self) -> bool:
        """The path brakes, or stands, because nothing more of it is known."""
        u, v, a, _ = self.state
        if not self.wants or len(self._stretches) > 1 or self._halt < inf or u <= 0.0 or self._factor <= AT_REST:
            return False
        return stopping_distance(v, max(0.0, a), self._deceleration, self._jerk) >= BRAKES * self.known

    def append(self, part: PathPart) -> None:
        """The path continues with `part`: with the direction and curvature of the last one, or after an exact stop."""
        self._parts.append((self.end, part))
        whole = whole_cell(part)
        begins = self.end == 0.0 or part.entry <= 0.0
        division = division_of(part, whole, FEWEST_CELLS if begins else 1, self._cell_time)
        self._undivided.append(UndividedPart(part, self.end, division))
        self.end += part.length
        speed = sqrt(min(whole.limit, whole.feed))
        self._reach = max(self._reach, stopping_distance(speed, 0.0, whole.down, whole.jerk))
        self._deceleration, self._jerk = whole.down, whole.jerk
        self._divide()

    def _divide(self) -> None:
        """Cells for a window ahead."""
        while self._undivided and self._lacks_cells():
            waiting = self._undivided[0]
            stops = waiting.part.entry <= 0.0
            if (stops or waiting.origin == self._halt) and not waiting.begun and self._stretches[-1]:
                self._stretches.append([])
                self._split = self._split or not stops
            self._stretches[-1].extend(waiting.take(CELLS_AHEAD))
            if waiting.empty:
                self._undivided.popleft()

    def _lacks_cells(self) -> bool:
        last, count = self._stretches[-1], sum(map(len, self._stretches))
        if len(last) < CELLS_AHEAD and count < CELLS_AHEAD:
            return True
        if count >= MOST_OF_LONG and self._undivided[0].cells > CELLS_AHEAD:
            return False
        return not last or last[-1].end - self.state[0] < WINDOW * self._reach

    def locate(self, u: float) -> tuple[float, PathPart]:
        """Where the part begins that has u, and the part; parts before it are forgotten."""
        while len(self._parts) > 1 and u >= self._parts[1][0]:
            self._parts.popleft()
        return self._parts[0]

    # motion

    def step(self, count: int, cycle_time: float) -> list[MotionState]:
        """(u, u', u'', u''') of the next cycles; fewer when the path ends before (`done`)."""
        rows: list[MotionState] = []
        if not self.done:
            self._renew_plan(cycle_time)
        while len(rows) < count and not self.done and not self.halted:
            time = self._time + cycle_time
            while self._profile is not None and time >= self._profile.duration:
                time -= self._profile.duration
                self._finish(time)  # the next plan may be shorter than what is left of the cycle
            if self.done:
                break
            self._time = time
            if self._profile is not None:
                self.state = self._in_part(self._profile.state_at(time))
            rows.append(self.state)
        return rows

    def _in_part(self, state: MotionState) -> MotionState:
        """Within a microsecond before a stop u may be rounded to its place, where the next part begins."""
        if state[0] < self._planned_end:
            return state
        return (nextafter(self._planned_end, 0.0), state[1], state[2], state[3])

    def set_override(self, override: float) -> None:
        """Acts from the next knot of the plan on."""
        if override != self.override:
            self.override = override
            self._plan_from_knot()

    def stop(self) -> None:
        """Ramps down as soon as possible; the path then rests where it is."""
        if not self._stopping:
            self._stopping = True
            self._plan_from_knot()

    @property
    def stopped(self) -> bool:
        """`stop` was called and the path is at rest."""
        return self._stopping and self._profile is None

    @property
    def brakes_for_end(self) -> bool:
        """The override no longer acts: the path is at its end or in the last piece of its plan before it."""
        if self.done or self._stopping:
            return True
        if self._profile is None or not self._stretch_known or self._planned_end < self._cells[-1].end:
            return False
        return self._profile.piece_and_next(self._time)[1] is None

    # halt

    def halt(self, places: Sequence[float]) -> None:
        """Stops at the first of the places (u of ends of parts) at which the axes permit it, until `resume`."""
        for place in places:
            if place > self.state[0] and self._can_rest_at(place):
                self._halt = place
                return

    def resume(self) -> None:
        """Continues where the path has halted; one that has not yet no longer stops there."""
        if self.halted:
            self.state = (self._halt, 0.0, 0.0, 0.0)
        elif self._split:
            self._join()
        self.halted = self._split = False
        self._halt = inf

    def _join(self) -> None:
        """The stretches before and behind the place of the halt are one again, which is planned anew."""
        for index in range(1, len(self._stretches)):
            behind = self._stretches[index]
            if behind and behind[0].middle > self._halt:
                self._stretches[index - 1] += behind
                del self._stretches[index]
                self._renew = 0.0
                return

    def _can_rest_at(self, place: float) -> bool:
        """Plans to rest there if that is possible; a place behind the cells that are known is."""
        for index, stretch in enumerate(self._stretches):
            if not stretch or stretch[-1].end < place:
                continue
            cells = [cell for cell in stretch if cell.middle < place]
            behind = stretch[len(cells) :]
            if index > 0 or self._profile is None or place >= self._planned_end:
                self._stretches[index] = cells
            elif not self._rests_at_end(cells):
                return False
            if behind:
                self._stretches.insert(index + 1, behind)
                self._split = True
            return True
        return True

    def _rests_at_end(self, stretch: list[PathCell]) -> bool:
        """A plan from the next knot to the end of the stretch; False if there is none."""
        knot = self._knot()
        if knot is None or self._factor <= AT_REST:
            return False
        piece, following = knot
        start, cells = self._from_knot(following, stretch)
        if len(cells) < FEWEST_CELLS:
            return False
        plan = plan_velocity(cells, start, self._factor)
        plan = plan or plan_velocity(cells, start, self._factor, len(cells), self._before)
        if plan is None:
            return False
        self._take(plan, [piece, *pieces_of(plan, start, following.begin)], cells[1:])
        return True

    @property
    def _factor(self) -> float:
        return 0.0 if self._stopping else self.override

    def _finish(self, surplus: float) -> None:
        """The plan has come to rest: at the end of the path, or it continues from here when it can."""
        self.state = (self._planned_end, 0.0, 0.0, 0.0)
        self._profile = None
        if self._planned_end >= self.end and self.closed:
            self.done = True
            self.remaining_time = surplus
            return
        self._stretches[0] = [cell for cell in self._cells if cell.middle > self._planned_end]
        if not self._cells and len(self._stretches) > 1:
            self._stretches.popleft()
        self._divide()
        if self._planned_end >= self._halt:
            self.halted = True
            self.state = (nextafter(self._halt, 0.0), 0.0, 0.0, 0.0)  # still in the part that ends there
        self._plan_from_rest()

    def _renew_plan(self, cycle_time: float) -> None:
        """Plans over what was appended, before the end of the last plan makes the path brake."""
        if self._profile is None and self.closed and not self.halted and self._planned_end >= self.end:
            self.done = True  # it has halted there
            self.remaining_time = cycle_time
        elif self._profile is None:
            self._time = min(self._time, 0.0)
            self._plan_from_rest()
        elif self.state[0] >= self._renew and self._factor > AT_REST:
            self._divide()
            if self._planned_end < self._cells[-1].end:
                self._renew += 0.5 * (self._planned_end - self._renew)  # if there is no plan from here, again later
                self._plan_from_knot()

    def _plan_from_rest(self) -> None:
        if self._factor <= AT_REST or not self._cells or self.halted:
            return
        self._stretches[0] = enough(self._cells)
        start = MovingStart(self._cells[0].begin)
        plan = plan_velocity(self._cells, start, self._factor)
        assert plan is not None
        self._take(plan, pieces_of(plan, start, 0.0), self._cells)

    def _plan_from_knot(self) -> None:
        """A new plan from the end of the active piece; the old one stays if there is none that the axes permit."""
        knot = self._knot()
        if knot is None:
            return
        piece, following = knot
        start, cells = self._from_knot(following, self._cells)
        if len(cells) < FEWEST_CELLS:
            return
        plan = self._slow_down(cells, start) if self._factor > AT_REST else stop_soon(cells, start, self._before)
        if plan is not None:
            self._take(plan, [piece, *pieces_of(plan, start, following.begin)], cells[1:])

    def _knot(self) -> tuple[PathPiece, PathPiece] | None:
        """The active piece and the next one; None at rest and where a plan comes to rest."""
        if self._profile is None:
            return None
        piece, following = self._profile.piece_and_next(self._time)
        return None if following is None or following.kind != BETWEEN else (piece, following)

    def _from_knot(self, following: PathPiece, cells: list[PathCell]) -> tuple[MovingStart, list[PathCell]]:
        """The state at the start of a piece, and the cells from there on, of which the first has no length."""
        start = MovingStart(following.u, following.velocity * following.velocity, 2.0 * following.acceleration)
        ahead = [cell for cell in cells if cell.middle > following.u]
        return start, [cell.part(following.u, following.u) for cell in ahead[:1]] + ahead

    def _slow_down(self, cells: list[PathCell], start: MovingStart) -> VelocityPlan | None:
        plan = plan_velocity(cells, start, self._factor)
        if plan is not None:
            return plan
        return earliest(len(cells), lambda delay: plan_velocity(cells, start, self._factor, delay, self._before))

    def _take(self, plan: VelocityPlan, pieces: list[PathPiece], cells: list[PathCell]) -> None:
        self._profile = PathProfile(pieces)
        if self._factor > AT_REST:
            self._before = self._factor
        begin, self._planned_end = plan.cells[0].begin, plan.cells[-1].end
        self._stretches[0] = cells
        for cell in cells:
            cell.planned = 0.0
        for cell, square in zip(plan.cells, plan.squares, strict=True):
            cell.planned = square
        self._renew = begin + RENEWAL * (self._planned_end - begin)


def enough(cells: list[PathCell]) -> list[PathCell]:
    """The cells, the last one divided if they are too few for a plan."""
    missing = FEWEST_CELLS - len(cells)
    if missing <= 0:
        return cells
    last = cells[-1]
    ends = [last.begin + last.length * (index + 1) / (missing + 1) for index in range(missing)] + [last.end]
    parts = [last.part(begin, end) for begin, end in zip([last.begin, *ends], ends, strict=False)]
    return cells[:-1] + parts
