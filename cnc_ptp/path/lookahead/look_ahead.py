"""Look-ahead: runs parts of a path one after the other without a stop between them.

Parts are appended while the path moves. The velocity is planned over all that are known, to rest at the end of the last
one, and planned again from a knot ahead as the path gets on: what is appended can only make it faster. Override, feed
hold and stop are plans with another feed, which counts from the first cell from which it can be kept.
"""

from __future__ import annotations

from collections import deque
from math import sqrt
from typing import Final

from cnc_ptp.motion import stopping_distance
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.path.lookahead.parts import PathPart, cells_of, whole_cell
from cnc_ptp.path.lookahead.path_cell import PathCell
from cnc_ptp.path.lookahead.path_profile import BETWEEN, PathPiece, PathProfile, pieces_of
from cnc_ptp.path.lookahead.velocity_plan import MovingStart, VelocityPlan, earliest, plan_velocity, stop_soon

AT_REST: Final = 1e-6
"""Override below which the path stops."""
MOST_CELLS: Final = 4000
"""Cells that are planned at once."""
FEWEST_CELLS: Final = 3
WINDOW: Final = 4.0
"""What is planned at once, in stopping distances on a straight path."""
RENEWAL: Final = 0.5
"""Part of the planned path after which it is planned again."""


class LookAhead:
    """The path from one stop to the next.

    override    factor on the feed; 0 is feed hold
    end         u of the end of the last part
    closed      no part follows
    done        the end has been reached
    remaining_time  s from the end to the cycle in which it was reached
    """

    def __init__(self, override: float, offset: float) -> None:
        """`offset`: s by which the first cycle is behind the start (0 or less)."""
        self.override = override
        self.end = 0.0
        self.closed = False
        self.done = False
        self.remaining_time = 0.0
        self.state: MotionState = (0.0, 0.0, 0.0, 0.0)
        self._time = offset
        self._parts: deque[tuple[float, PathPart]] = deque()
        self._stretches: deque[list[PathCell]] = deque([[]])
        """Cells from one exact stop to the next; of the first one from the last rest or knot on."""
        self._profile: PathProfile | None = None
        self._planned_end = 0.0
        self._renew = 0.0
        self._reach = 0.0
        self._stopping = False

    # what is ahead

    @property
    def _cells(self) -> list[PathCell]:
        """Those up to the next exact stop."""
        return self._stretches[0]

    @property
    def wants(self) -> bool:
        """The next part should be appended: less than a window is ahead."""
        if self.closed or self._stopping or sum(map(len, self._stretches)) >= MOST_CELLS:
            return False
        return self.end - self.state[0] < WINDOW * self._reach or len(self._stretches[-1]) < FEWEST_CELLS

    def append(self, part: PathPart) -> None:
        """The path continues with `part`: with the direction and curvature of the last one, or after an exact stop."""
        self._parts.append((self.end, part))
        if part.entry <= 0.0 and self._stretches[-1]:
            self._stretches.append([])
        stretch, whole = self._stretches[-1], whole_cell(part)
        stretch += cells_of(part, whole, self.end, FEWEST_CELLS if not stretch else 1)
        self.end += part.length
        speed = sqrt(min(whole.limit, whole.feed))
        self._reach = max(self._reach, stopping_distance(speed, 0.0, whole.down, whole.jerk))

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
            self._renew_plan()
        while len(rows) < count and not self.done:
            time = self._time + cycle_time
            profile = self._profile
            if profile is not None and time >= profile.duration:
                time -= profile.duration
                self._finish(time)
                profile = self._profile
                if self.done:
                    break
            self._time = time
            if profile is not None:
                self.state = profile.state_at(time)
            rows.append(self.state)
        return rows

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
        if self._profile is None or self._planned_end < self._cells[-1].end:
            return False
        return self._profile.piece_and_next(self._time)[1] is None

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
        self._plan_from_rest()

    def _renew_plan(self) -> None:
        """Plans over what was appended, before the end of the last plan makes the path brake."""
        if self._profile is None:
            self._time = min(self._time, 0.0)
            self._plan_from_rest()
        elif self.state[0] >= self._renew and self._planned_end < self._cells[-1].end and self._factor > AT_REST:
            self._plan_from_knot()

    def _plan_from_rest(self) -> None:
        if self._factor <= AT_REST or not self._cells:
            return
        self._stretches[0] = enough(self._cells)
        start = MovingStart(self._cells[0].begin)
        plan = plan_velocity(self._cells, start, self._factor)
        assert plan is not None
        self._take(plan, pieces_of(plan, start, 0.0), self._cells)

    def _plan_from_knot(self) -> None:
        """A new plan from the end of the active piece; the old one stays if there is none that the axes permit."""
        profile = self._profile
        if profile is None:
            return
        piece, following = profile.piece_and_next(self._time)
        if following is None or following.kind != BETWEEN:
            return
        start = MovingStart(following.u, following.velocity * following.velocity, 2.0 * following.acceleration)
        ahead = [cell for cell in self._cells if cell.middle > following.u]
        cells = [ahead[0].part(following.u, following.u), *ahead]
        if len(cells) < FEWEST_CELLS:
            return
        plan = self._slow_down(cells, start) if self._factor > AT_REST else stop_soon(cells, start)
        if plan is None:
            return
        self._take(plan, [piece, *pieces_of(plan, start, following.begin)], ahead)

    def _slow_down(self, cells: list[PathCell], start: MovingStart) -> VelocityPlan | None:
        plan = plan_velocity(cells, start, self._factor)
        if plan is not None:
            return plan
        return earliest(len(cells), lambda delay: plan_velocity(cells, start, self._factor, delay))

    def _take(self, plan: VelocityPlan, pieces: list[PathPiece], cells: list[PathCell]) -> None:
        self._profile = PathProfile(pieces)
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
