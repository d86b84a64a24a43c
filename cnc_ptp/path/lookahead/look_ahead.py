"""Look-ahead: runs parts of a path one after the other without a stop between them.

Parts are appended while the path moves. The velocity is planned over all that are known, to rest at the end of the last
one, and planned again from a knot ahead as the path gets on: what is appended can only make it faster. Override, feed
hold and stop are plans with another feed, which counts from the first node from which it can be kept.
"""

from __future__ import annotations

from collections import deque
from math import sqrt
from typing import Final

from cnc_ptp.motion import stopping_distance
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.path.lookahead.nodes import PathNode
from cnc_ptp.path.lookahead.parts import HalfCell, PathPart, cells, node_between
from cnc_ptp.path.lookahead.path_profile import BETWEEN, PathPiece, PathProfile, pieces_of
from cnc_ptp.path.lookahead.velocity_plan import MovingStart, VelocityPlan, earliest, plan_velocity, stop_soon

AT_REST: Final = 1e-6
"""Override below which the path stops."""
MOST_NODES: Final = 4000
"""Nodes that are planned at once."""
FEWEST_NODES: Final = 3
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
        self._nodes: list[PathNode] = []
        """Of the window, from the last rest or knot on; without the one at its end."""
        self._behind: HalfCell | None = None
        self._profile: PathProfile | None = None
        self._planned_end = 0.0
        self._renew = 0.0
        self._reach = 0.0
        self._stopping = False

    # what is ahead

    @property
    def wants(self) -> bool:
        """The next part should be appended: less than a window is ahead."""
        if self.closed or len(self._nodes) >= MOST_NODES:
            return False
        return self.end - self.state[0] < WINDOW * self._reach or len(self._nodes) < FEWEST_NODES

    def append(self, part: PathPart) -> None:
        """The path continues with `part`, which begins where the last one ends, with its direction and curvature."""
        begin = self.end
        self._parts.append((begin, part))
        before = 0.0
        for place in cells(part):
            middle = 0.5 * (before + place)
            first = HalfCell(part, before, middle)
            node = node_between(begin + before, self._behind or first, first)
            if before == 0.0:
                node.limit = min(node.limit, part.entry)
            self._nodes.append(node)
            self._behind = HalfCell(part, place, middle)
            before = place
        self.end = begin + part.length
        whole = HalfCell(part, 0.0, part.length)
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
        if self.done:
            return [(self.end, 0.0, 0.0, 0.0)] * count
        self._renew_plan()
        for _ in range(count):
            time = self._time + cycle_time
            profile = self._profile
            if profile is not None and time >= profile.duration:
                time -= profile.duration
                if self._finish(time):
                    break
                profile = self._profile
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
        if self._profile is None or self._planned_end < self.end or not self.closed:
            return False
        return self._profile.piece_and_next(self._time)[1] is None

    @property
    def _factor(self) -> float:
        return 0.0 if self._stopping else self.override

    def _finish(self, surplus: float) -> bool:
        """The plan has come to rest. True at the end of the path; else it goes on from here when it can."""
        self.state = (self._planned_end, 0.0, 0.0, 0.0)
        self._profile = None
        if self._planned_end >= self.end and self.closed:
            self.done = True
            self.remaining_time = surplus
            return True
        self._nodes = [node for node in self._nodes if node.u >= self._planned_end]
        self._plan_from_rest()
        return False

    def _renew_plan(self) -> None:
        """Plans over what was appended, before the end of the last plan makes the path brake."""
        if self._profile is None:
            self._time = min(self._time, 0.0)
            self._plan_from_rest()
        elif self.state[0] >= self._renew and self._planned_end < self.end and self._factor > AT_REST:
            self._plan_from_knot()

    def _plan_from_rest(self) -> None:
        if self._factor <= AT_REST or self._behind is None:
            return
        nodes = [*self._nodes, node_between(self.end, self._behind, self._behind)]
        if len(nodes) < FEWEST_NODES:
            return
        start = MovingStart(nodes[0].u)
        plan = plan_velocity(nodes, start, self._factor)
        assert plan is not None
        self._take(plan, pieces_of(plan, start, 0.0), nodes)

    def _plan_from_knot(self) -> None:
        """A new plan from the end of the active piece; the old one stays if there is none that the axes permit."""
        profile = self._profile
        if profile is None or self._behind is None:
            return
        piece, following = profile.piece_and_next(self._time)
        if following is None or following.kind != BETWEEN:
            return
        start = MovingStart(following.u, following.velocity * following.velocity, 2.0 * following.acceleration)
        ahead = [node for node in self._nodes if node.u > following.u]
        first = self._knot(following.u, ahead[0])
        nodes = [first, *ahead, node_between(self.end, self._behind, self._behind)]
        if len(nodes) < FEWEST_NODES:
            return
        plan = self._slow_down(nodes, start) if self._factor > AT_REST else stop_soon(nodes, start)
        if plan is None:
            return
        self._take(plan, [piece, *pieces_of(plan, start, following.begin)], nodes)

    def _knot(self, u: float, node: PathNode) -> PathNode:
        return PathNode(u, node.limit, node.feed, node.up, node.down, node.jerk, node.loads)

    def _slow_down(self, nodes: list[PathNode], start: MovingStart) -> VelocityPlan | None:
        plan = plan_velocity(nodes, start, self._factor)
        if plan is not None:
            return plan
        return earliest(len(nodes), lambda delay: plan_velocity(nodes, start, self._factor, delay))

    def _take(self, plan: VelocityPlan, pieces: list[PathPiece], nodes: list[PathNode]) -> None:
        self._profile = PathProfile(pieces)
        begin, self._planned_end = plan.nodes[0].u, plan.nodes[-1].u
        self._nodes = nodes[:-1]
        for index, node in enumerate(nodes):
            node.planned = plan.squares[index] if index < len(plan.squares) else 0.0
        self._renew = begin + RENEWAL * (self._planned_end - begin)
