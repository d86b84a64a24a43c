"""Cam table slave: slave position over master position, as a cubic spline with continuous acceleration."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from math import floor

import numpy as np
from numpy.typing import NDArray

from cnc_ptp.axis.coupling import Coupling
from cnc_ptp.axis.faults import BAD_CAM_TABLE, CAM_POSITION
from cnc_ptp.errors import CncError
from cnc_ptp.motion.limits import LARGEST_STATE
from cnc_ptp.motion.setpoints import MotionState, Setpoints

SMALLEST_TABLE = 3
SMALLEST_STEP = 1e-6
"""mm or deg, of the master."""
ASCEND = f"a cam table must ascend by {SMALLEST_STEP:g} or more"
BEGIN_TOLERANCE = 1e-6
"""Largest distance (mm, deg) between a slave and its place by a table with a slave offset."""

Floats = NDArray[np.float64]


class CamTable:
    """y(x) through the points of a table, and its derivatives.

    `cyclic`: the table repeats after its end with the same slopes and curvatures, raised by the difference between its
    end and its start. Otherwise it holds its first and last value outside, and begins and ends with slope and curvature
    0.
    """

    def __init__(self, points: Sequence[Sequence[float]], *, cyclic: bool) -> None:
        """`points`: (master, slave) in mm or deg, master ascending. Raises CncError 23052."""
        self.cyclic = cyclic
        x, y = _columns(points)
        self.first, self.last = float(x[0]), float(x[-1])
        self.length = self.last - self.first
        self.lift = float(y[-1] - y[0])
        starts, coefficients = _cyclic_pieces(x, y) if cyclic else _single_pieces(x, y)
        self._starts: list[float] = starts.tolist()
        self._pieces: list[list[float]] = coefficients.T.tolist()
        self._start, self._end = float(y[0]), float(y[-1])

    def turn(self, x: float) -> int:
        """The repetition of a cyclic table in which x is; 0 is the table itself."""
        return floor((x - self.first) / self.length) if self.cyclic else 0

    def at(self, x: float) -> tuple[float, float, float, float]:
        """y, dy/dx, d²y/dx², d³y/dx³."""
        turns = self.turn(x)
        x -= turns * self.length
        if not self.cyclic and x < self.first:
            return self._start, 0.0, 0.0, 0.0
        if not self.cyclic and x >= self.last:
            return self._end, 0.0, 0.0, 0.0
        index = max(0, bisect_right(self._starts, x) - 1)
        c3, c2, c1, c0 = self._pieces[index]
        d = x - self._starts[index]
        y = c0 + d * (c1 + d * (c2 + d * c3)) + turns * self.lift
        return y, c1 + d * (2.0 * c2 + 3.0 * d * c3), 2.0 * c2 + 6.0 * d * c3, 6.0 * c3


def _cyclic_pieces(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Where the pieces begin (n,) and their coefficients (4, n), cubic first.

    The deviation from the mean slope is periodic.
    """
    from scipy.interpolate import CubicSpline  # takes longer to load than all else, and few need it

    slope = (y[-1] - y[0]) / (x[-1] - x[0])
    rest = y - y[0] - slope * (x - x[0])
    rest[-1] = rest[0]
    coefficients = CubicSpline(x, rest, bc_type="periodic").c.copy()
    coefficients[2] += slope
    coefficients[3] += y[0] + slope * (x[:-1] - x[0])
    return x[:-1], coefficients


def _single_pieces(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """The same for a table that is run through once.

    Slope and curvature 0 at both ends are two conditions more than a cubic spline can meet; an additional knot in the
    middle of the first and of the last interval makes room for them.
    """
    from scipy.interpolate import PPoly, make_interp_spline  # takes longer to load than all else, and few need it

    middles = 0.5 * (x[[0, -2]] + x[[1, -1]])
    knots = np.concatenate([[x[0]] * 4, np.sort(np.concatenate([x[1:-1], middles])), [x[-1]] * 4])
    ends = [(1, 0.0), (2, 0.0)]
    spline = PPoly.from_spline(make_interp_spline(x, y, k=3, t=knots, bc_type=(ends, ends)))
    inside = np.diff(spline.x) > 0.0
    return spline.x[:-1][inside], spline.c[:, inside]


def _columns(points: Sequence[Sequence[float]]) -> tuple[np.ndarray, np.ndarray]:
    if len(points) < SMALLEST_TABLE:
        reason = f"a cam table needs {SMALLEST_TABLE} points or more, it has {len(points)}"
        raise CncError(BAD_CAM_TABLE, reason, points=len(points))
    try:
        table = np.array(points, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        table = np.empty(0)
    if table.shape != (len(points), 2) or not np.isfinite(table).all():
        raise CncError(BAD_CAM_TABLE, "each point of a cam table needs two finite numbers, master and slave")
    if np.abs(table).max() > LARGEST_STATE:
        limit = LARGEST_STATE
        raise CncError(BAD_CAM_TABLE, f"the points of a cam table must lie within ±{limit:g}", limit=limit)
    steps = np.flatnonzero(np.diff(table[:, 0]) < SMALLEST_STEP)
    if len(steps):
        before, position = float(table[steps[0], 0]), float(table[steps[0] + 1, 0])
        reason = f"master position {position:g} comes after {before:g}; {ASCEND}"
        raise CncError(BAD_CAM_TABLE, reason, position=position, before=before)
    return table[:, 0], table[:, 1]


class CamCoupling(Coupling):
    """Slave position = slave scaling · y((master position - master offset) / master scaling) + slave offset."""

    def __init__(
        self,
        master: str,
        table: CamTable,
        *,
        master_offset: float,
        master_scaling: float,
        slave_scaling: float,
        slave_offset: float | None,
    ) -> None:
        """Without `slave_offset` (mm, deg) it results from the positions in which the axes are coupled."""
        super().__init__(master, slave_scaling / master_scaling)
        self.table = table
        self._next: CamTable | None = None
        self._turn: int | None = None
        self._master_offset = master_offset
        self._master_scaling = master_scaling
        self._slave_scaling = slave_scaling
        self._slave_offset = slave_offset

    def change_table(self, table: CamTable) -> None:
        """The new table comes in when the master passes the seam of the active cyclic table."""
        self._next = table

    def _x(self, master_position: float) -> float:
        return (master_position - self._master_offset) / self._master_scaling

    def follow(self, position: float, master: Setpoints) -> Setpoints:
        """Raises CncError 23053 in the first block when the slave is not where the slave offset puts it."""
        if self._turn is None:
            self._begin(position, self._x(master.positions[0]))
        return Setpoints.of([self._state(state) for state in master.states()])

    def _begin(self, position: float, x: float) -> None:
        height = self._slave_scaling * self.table.at(x)[0]
        if self._slave_offset is None:
            self._slave_offset = position - height
        place = height + self._slave_offset
        if abs(place - position) > BEGIN_TOLERANCE:
            reason = f"the cam table puts the slave at {place:g} with its slave_offset, the axis is at {position:g}"
            raise CncError(CAM_POSITION, reason, place=float(place), position=position)
        self._turn = self.table.turn(x)

    def _state(self, master: MotionState) -> MotionState:
        x = self._x(master[0])
        turn = self.table.turn(x)
        if turn != self._turn:
            self._pass_seam(x, turn)
            x = self._x(master[0])
        y, dy, ddy, dddy = self.table.at(x)
        assert self._slave_offset is not None
        s, scaling = self._slave_scaling, self._master_scaling
        v, a, j = master[1] / scaling, master[2] / scaling, master[3] / scaling
        acceleration = s * (ddy * v * v + dy * a)
        return s * y + self._slave_offset, s * dy * v, acceleration, s * (dddy * v**3 + 3.0 * ddy * v * a + dy * j)

    def _pass_seam(self, x: float, turn: int) -> None:
        """A waiting table begins where the old one has its seam, at the same height."""
        if self._next is None:
            self._turn = turn
            return
        forward = self._turn is not None and turn > self._turn
        seam = self.table.first + (turn if forward else turn + 1) * self.table.length
        height = self.table.at(seam)[0]
        new, self._next = self._next, None
        self._master_offset += self._master_scaling * (seam - (new.first if forward else new.last))
        start = new.at(new.first)[0] + (0.0 if forward else new.lift)
        assert self._slave_offset is not None
        self._slave_offset += self._slave_scaling * (height - start)
        self.table, self._turn = new, 0

    def change_source(self, before: float, now: float) -> None:
        self._master_offset += now - before
