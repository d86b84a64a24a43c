"""An independent checker of runs along a path: programmed geometry against sampled setpoints. It imports no planner.

Limits are checked twice. The reported states (velocity, acceleration, jerk of each cycle) show peaks within a cycle.
The differences of the positions show whether the states are true: Δp/T, Δ²p/T², Δ³p/T³ are weighted means of velocity,
acceleration and jerk over one to three cycles (B-spline weights), so that they never exceed a limit which is kept at
every instant, and they contain every step between two cycles, which no state shows.

The path is met if the samples can be assigned to the programmed segments in their order such that each is within the
tolerance of its segment, and if the ends of the segments are passed in their order within their tolerance. Where the
path stops, the place of rest between two cycles follows from the state of a cycle: p ∓ j·t³/6 with t = |a/j|.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import inf

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
CYCLE = 0.001
RELATIVE = 1e-6
EXACT = 1e-9
"""mm."""
ROUNDING = 2e-8
"""mm; programmed numbers have nine digits behind the point, an arc may miss its target by their rounding."""
SHORTEST = 2e-3
"""mm; a stop between two shorter segments may lie between cycles of which neither belongs to its ramps."""
NEAR = 1e-2
"""mm; where no cycle before or behind a stop is nearer there is none."""
RESOLUTION = 1e-14
"""mm of a path length below 64 mm; an axis that moves far on a short path has the more of it in its position."""
WINDOW, POINTS = 32, 512
"""Segments and samples that are compared at once."""


@dataclass(frozen=True, slots=True)
class Axis:
    """Limits: velocity in feed and in rapid traverse, acceleration of growing and of falling |v|, jerk."""

    velocity: float
    rapid: float
    acceleration: float
    deceleration: float
    jerk: float


@dataclass(slots=True)
class Segment:
    """A programmed line, arc or helix.

    start, end   positions of all axes
    center       of an arc in its `plane` (two axes); `sweep` in rad with its sign
    feed         mm/s, inf in rapid traverse
    deviation    how far the path axes may leave the path at the end (and in the whole segment: `everywhere`)
    track        the same for each other axis
    stop         the path stops exactly at the end
    """

    start: Array
    end: Array
    feed: float
    center: tuple[float, float] = (0.0, 0.0)
    plane: tuple[int, int] = (0, 1)
    sweep: float = 0.0
    deviation: float = 0.0
    track: float = 0.0
    everywhere: float = 0.0
    track_everywhere: float = 0.0
    stop: bool = False

    @property
    def length(self) -> float:
        """About: at least the largest way of an axis."""
        return float(np.abs(self.end - self.start).max()) + (SHORTEST if self.arc else 0.0)

    @property
    def arc(self) -> bool:
        return self.sweep != 0.0

    def radius(self, point: Array) -> float:
        """Distance to the centre."""
        first, second = self.plane
        return float(np.hypot(point[first] - self.center[0], point[second] - self.center[1]))

    @property
    def curvature(self) -> float:
        """Of the circle, 1/mm."""
        return 1.0 / self.radius(self.start) if self.arc else 0.0

    @property
    def rounding(self) -> float:
        """mm by which the numbers of the program may miss the path.

        The centre of an arc is moved to the same distance from both ends (P-CHAN-00059): the further, the closer they are.
        """
        if not self.arc:
            return ROUNDING
        first, second = self.plane
        chord = float(np.hypot(self.end[first] - self.start[first], self.end[second] - self.start[second]))
        if chord == 0.0:
            return ROUNDING
        radius = self.radius(self.start)
        return ROUNDING + 2.0 * abs(self.radius(self.end) - radius) * radius / chord


@dataclass(slots=True)
class Run:
    """Sampled setpoints (cycles, axes) and the override of each cycle."""

    position: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    override: float = 1.0
    """The largest during the run."""


@dataclass(slots=True)
class Findings:
    """What is wrong; empty if nothing is."""

    texts: list[str] = field(default_factory=list)

    def above(self, what: str, values: Array, limit: Array | float, slack: float = 0.0) -> None:
        """Values above the limit by more than 1e-6 of it."""
        over = values - np.asarray(limit) * (1.0 + RELATIVE) - slack
        if over.size and over.max() > 0.0:
            worst = int(np.argmax(over))
            bound = np.broadcast_to(limit, values.shape).flat[worst]
            self.texts.append(f"{what} {values.flat[worst]:.9g} > {bound:.9g} in cycle {worst} ({(over > 0).sum()}x)")


class PathChecker:
    """Checks runs of one program. `path_axes`: those of the feed; `steps`: the acceleration may step (#SLOPE)."""

    def __init__(
        self, segments: Sequence[Segment], axes: Sequence[Axis], path_axes: Sequence[int] = (0, 1, 2), *, steps: bool
    ) -> None:
        self.segments, self.axes, self.steps = list(segments), axes, steps
        self.path = list(path_axes)
        self.others = [n for n in range(len(axes)) if n not in path_axes]
        before = [Segment(s.start, s.start, s.feed) for s in self.segments[:1]] + self.segments[:-1]
        self.tolerance = np.array(
            [s.everywhere + max(s.deviation, b.deviation) for b, s in zip(before, self.segments, strict=True)]
        )
        self.track = np.array(
            [s.track_everywhere + max(s.track, b.track) for b, s in zip(before, self.segments, strict=True)]
        )
        self.feed = np.array([s.feed for s in self.segments])
        self.along = [bool(np.abs(s.end - s.start)[self.path].max() > 0.0 or s.arc) for s in self.segments]

    def check(self, run: Run, *, complete: bool = True) -> Findings:
        """`complete`: the run reaches the end of the program; else it may stop anywhere."""
        found = Findings()
        self.limits(run, found)
        first, last = self._assigned(run, found, complete=complete)
        if first is not None and last is not None:
            self._feeds(run, first, last, found)
        if complete:
            self._ends(run, found)
        return found

    # limits

    def limits(self, run: Run, found: Findings) -> None:
        """Velocity, acceleration and jerk of each axis."""
        longest = float(np.linalg.norm(np.diff(run.position[:, self.path], axis=0), axis=1).sum())
        for n, axis in enumerate(self.axes):
            p, v, a, j = (each[:, n] for each in (run.position, run.velocity, run.acceleration, run.jerk))
            name, strongest = f"axis {n}", max(axis.acceleration, axis.deceleration)
            largest = max(axis.velocity, axis.rapid) if np.isinf(self.feed).any() else axis.velocity
            found.above(f"{name} v", np.abs(v), largest)
            found.above(f"{name} Δp/T", np.abs(np.diff(p)) / CYCLE, largest, 1e-9)
            growing = a * v > 0.0
            found.above(f"{name} a", np.where(growing, np.abs(a), 0.0), axis.acceleration)
            found.above(f"{name} a-", np.where(growing, 0.0, np.abs(a)), strongest if self.steps else axis.deceleration)
            found.above(
                f"{name} Δ²p/T²", np.abs(np.diff(p, 2)) / CYCLE**2, strongest, 1e-6 + self._unsure(n, 2, longest)
            )
            if not self.steps:
                found.above(f"{name} j", np.abs(j), axis.jerk)
                found.above(
                    f"{name} Δ³p/T³", np.abs(np.diff(p, 3)) / CYCLE**3, axis.jerk, 1e-3 + self._unsure(n, 3, longest)
                )
                mean = 0.5 * CYCLE * (v[1:] + v[:-1]) - CYCLE**2 * (a[1:] - a[:-1]) / 12.0
                kink = 0.5 * axis.jerk * CYCLE**3
                found.above(f"{name} states and positions", np.abs(np.diff(p) - mean), kink, 1e-9)

    def _unsure(self, axis: int, order: int, longest: float) -> float:
        """Of a difference, by the resolution of a path length of `longest` mm on the segment where the axis is fastest."""
        ways = [(abs(s.end[axis] - s.start[axis]), np.linalg.norm((s.end - s.start)[self.path])) for s in self.segments]
        steepest = max((way / length for way, length in ways if length > EXACT), default=0.0)
        return float(2.0**order * max(RESOLUTION, np.spacing(longest)) * steepest / CYCLE**order)

    # path

    def _assigned(self, run: Run, found: Findings, *, complete: bool) -> tuple[Array | None, Array | None]:
        """For each sample the first segment to which it can belong, and the last one."""
        order = np.arange(len(self.segments))
        first, bad = self._greedy(run.position, order)
        if first is None:
            near = self._nearest(run.position[bad])
            found.texts.append(f"path left in cycle {bad} at {run.position[bad]}: {near}")
            return None, None
        if not complete:
            return first, first + WINDOW
        last, bad = self._greedy(run.position[::-1], order[::-1])
        if last is None:
            found.texts.append(f"path backwards left in cycle {len(run.position) - 1 - bad}")
            return None, None
        return first, last[::-1]

    def _greedy(self, points: Array, order: Array) -> tuple[Array | None, int]:
        """The first possible segment for each point along `order`; or None and the first point without one."""
        found = np.zeros(len(points))
        place, begin, width = 0, 0, WINDOW
        while begin < len(points):
            chunk = points[begin : begin + POINTS]
            window = order[place : place + width]
            inside = np.column_stack([self._inside(int(k), chunk) for k in window])
            low, done = 0, len(chunk)
            for index, row in enumerate(inside):
                hits = np.nonzero(row[low:])[0]
                if not len(hits):
                    done = index
                    break
                low += int(hits[0])
                found[begin + index] = window[low]
            place += low
            begin += done
            if done == 0:
                if width >= len(order):
                    return None, begin
                width *= 8
            elif done == len(chunk):
                width = WINDOW
        return found, 0

    def _inside(self, k: int, points: Array, factor: float = 1.0) -> NDArray[np.bool_]:
        distance, track = self.distance(self.segments[k], points, factor * self.tolerance[k])
        slack = self.segments[k].rounding + 1e-9 * self.tolerance[k]
        return (distance <= factor * self.tolerance[k] + slack) & (track <= factor * self.track[k] + slack)

    def distance(self, s: Segment, points: Array, reach: float) -> tuple[Array, Array]:
        """Of the path axes to a segment; of the others to their values within `reach` of the nearest place."""
        places, length = self._project(s, points)
        nearest = np.min([distance for _, distance in places], axis=0)
        if not self.others:
            return nearest, np.zeros(len(points))
        best, track = np.full(len(points), inf), np.full(len(points), inf)
        for along, distance in places:  # both ends of a full circle are one place, where the others have two values
            apart = self._apart(s, points, along, distance, length, reach)
            better = (distance <= np.maximum(nearest, reach) + ROUNDING) & (apart < track)
            best, track = np.where(better, distance, best), np.where(better, apart, track)
        return best, track

    def _apart(self, s: Segment, points: Array, along: Array, distance: Array, length: float, reach: float) -> Array:
        """How far the other axes are from their values near a place."""
        room = np.sqrt(np.maximum(reach * reach - distance * distance, 0.0)) + ROUNDING
        low, high = (np.clip((along * length + side * room) / (length or 1.0), 0.0, 1.0) for side in (-1.0, 1.0))
        if length == 0.0:
            low, high = np.zeros(len(points)), np.ones(len(points))
        worst = np.zeros(len(points))
        for n in self.others:
            ends = [s.start[n] + part * (s.end[n] - s.start[n]) for part in (low, high)]
            lowest, highest = np.minimum(*ends), np.maximum(*ends)
            worst = np.maximum(worst, np.maximum(lowest - points[:, n], points[:, n] - highest))
        return np.maximum(worst, 0.0)

    def _project(self, s: Segment, points: Array) -> tuple[list[tuple[Array, Array]], float]:
        """Parts of the segment (0 … 1) near each point, with their distances; length; over the path axes."""
        if s.arc:
            return self._project_arc(s, points)
        line = (s.end - s.start)[self.path]
        length = float(np.linalg.norm(line))
        apart = points[:, self.path] - s.start[self.path]
        part = np.clip(apart @ line / (length * length), 0.0, 1.0) if length > 0.0 else np.zeros(len(points))
        return [(part, np.linalg.norm(apart - part[:, None] * line, axis=1))], length

    def _project_arc(self, s: Segment, points: Array) -> tuple[list[tuple[Array, Array]], float]:
        """Near the nearest of many places, and near both ends (which may be one place); by Newton's method."""
        coarse = np.linspace(0.0, 1.0, 17 + int(abs(s.sweep) * 12))
        places = self._arc(s, coarse)[0]
        nearest = coarse[np.argmin(np.linalg.norm(points[:, None, self.path] - places[None], axis=2), axis=1)]
        length = float(np.linalg.norm(self._arc(s, nearest[:1])[1][0]))
        return [self._newton(s, points, start) for start in (nearest, 0.0 * nearest, 0.0 * nearest + 1.0)], length

    def _newton(self, s: Segment, points: Array, part: Array) -> tuple[Array, Array]:
        for _ in range(6):
            q, q1, q2 = self._arc(s, part)
            apart = q - points[:, self.path]
            slope = (apart * q1).sum(axis=1)
            bend = (q1 * q1).sum(axis=1) + (apart * q2).sum(axis=1)
            part = np.clip(part - slope / np.where(bend > 0.0, bend, np.inf), 0.0, 1.0)
        return part, np.linalg.norm(self._arc(s, part)[0] - points[:, self.path], axis=1)

    def _arc(self, s: Segment, part: Array) -> tuple[Array, Array, Array]:
        """q, q1, q2 of the path axes by the part of an arc."""
        rest = (s.end - s.start)[None, :]
        q, q1, q2 = s.start + part[:, None] * rest, np.repeat(rest, len(part), axis=0), np.zeros((len(part), rest.size))
        first, second = s.plane
        x, y = s.start[first] - s.center[0], s.start[second] - s.center[1]
        cos, sin = np.cos(s.sweep * part), np.sin(s.sweep * part)
        along, across = x * cos - y * sin, x * sin + y * cos
        for n, middle, value, slope in ((first, s.center[0], along, -across), (second, s.center[1], across, along)):
            q[:, n], q1[:, n], q2[:, n] = middle + value, s.sweep * slope, -s.sweep * s.sweep * value
        return q[:, self.path], q1[:, self.path], q2[:, self.path]

    def _nearest(self, point: Array) -> str:
        """For the message."""
        rows = [
            (self.distance(s, point[None], t), n)
            for n, (s, t) in enumerate(zip(self.segments, self.tolerance, strict=True))
        ]
        parts = sorted((float(d[0]), float(t[0]), n) for (d, t), n in rows)[:3]
        return "; ".join(
            f"segment {n}: {d:.9g} of {self.tolerance[n]:g}, others {t:.9g} of {self.track[n]:g}" for d, t, n in parts
        )

    # feed

    def _feeds(self, run: Run, first: Array, last: Array, found: Findings) -> None:
        """Near a corner the feeds of both segments count."""
        speed = np.linalg.norm(run.velocity[:, self.path], axis=1)
        whole = np.linalg.norm(run.velocity, axis=1)
        allowed = np.zeros(len(speed))
        for begin in range(0, len(speed), POINTS):
            part = slice(begin, begin + POINTS)
            low = max(int(first[part].min()) - 1, 0)
            high = min(int(last[part].max()) + 2, len(self.segments))
            for k in range(low, high):
                near = self._inside(k, run.position[part], 3.0)
                near &= (first[part] - 1 <= k) & (k <= last[part] + 1)
                allowed[part] = np.where(near, np.maximum(allowed[part], self.feed[k]), allowed[part])
                if not self.along[k]:
                    speed[part] = np.where(near & (speed[part] == 0.0), whole[part], speed[part])
        known = (allowed > 0.0) & np.isfinite(allowed)
        found.above("feed", np.where(known, speed, 0.0), np.where(known, allowed * run.override, inf), 1e-9)

    # ends

    def _ends(self, run: Run, found: Findings) -> None:
        """The ends are passed in their order; stops are exact."""
        p = run.position
        if np.abs(p[-1] - self.segments[-1].end).max() > EXACT or np.abs(run.velocity[-1]).max() > 0.0:
            found.texts.append(f"ends at {p[-1]} instead of {self.segments[-1].end}")
        speed = np.linalg.norm(run.velocity[:, self.path], axis=1)
        step = np.concatenate((speed, [0.0])) + np.concatenate(([0.0], speed))
        step = np.maximum(step[1:], step[:-1]) * CYCLE
        begin = 0
        for k, (s, following) in enumerate(pairwise([*self.segments, self.segments[-1]])):
            reach = s.deviation + max(s.everywhere, following.everywhere) + ROUNDING
            begin = self._pass(k, s, following, reach, run, step, begin, found)

    def _pass(
        self, k: int, s: Segment, following: Segment, reach: float, run: Run, step: Array, begin: int, found: Findings
    ) -> int:
        at, bend = begin, max(s.curvature, following.curvature)
        while at < len(step):
            part = slice(at, at + 4 * WINDOW)
            apart = np.linalg.norm((run.position[part] - s.end)[:, self.path], axis=1)
            near = apart <= reach * (1.0 + 1e-9) + step[part] * 1.01
            if s.stop and max(s.length, following.length) > SHORTEST:
                near[near] = [self._rests(run, at + int(n), s.end, bend) for n in np.nonzero(near)[0]]
            if near.any():
                return at + int(np.argmax(near))
            at += 4 * WINDOW
        what = "stop" if s.stop else "end"
        found.texts.append(f"{what} of segment {k} at {s.end} was not met behind cycle {begin}")
        return begin

    def _rests(self, run: Run, n: int, place: Array, bend: float) -> bool:
        """The place of rest before or behind a cycle is this one; on an arc of curvature `bend` (1/mm) nearly so."""
        p, v, a, j = (each[n] for each in (run.position, run.velocity, run.acceleration, run.jerk))
        if np.abs(p - place).max() > NEAR:
            return False
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.steps:  # the acceleration steps, or rises within a part of a cycle; no jerk is reported
                ways = [np.where(a != 0.0, v * v / (part * a), 0.0) for part in (2.0, 1.5)]
            else:
                ways = [np.where(j != 0.0, a * a * a / (6.0 * j * j), 0.0)]
        return any(bool(np.abs(p - way - place).max() <= EXACT + bend * float(way @ way)) for way in ways)
