"""Couplings of a slave axis to its master: slave setpoints computed from master setpoints (TX1250 3.2, 3.3).

All work cycle by cycle on the states of the master; the position of the slave in the first cycle gives the offset.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import copysign

from cnc_ptp.motion.setpoints import MotionState, Setpoints

ROUNDING = 1e-9
"""Part of an acceleration limit that counts as rounding: a velocity is rounded, its change in a cycle even more so."""


class Coupling(ABC):
    """A coupling to the axis `master`; `ratio` is slave velocity over master velocity if that is constant."""

    def __init__(self, master: str, ratio: float) -> None:
        self.master = master
        self.ratio = ratio
        self.keeps_pair = False
        """In an error of the group the slave keeps following its master, which stops on its ramp: a ramp of its own
        would tear the two apart."""

    @abstractmethod
    def follow(self, position: float, master: Setpoints) -> Setpoints:
        """Setpoints of the slave in the cycles of these of its master; `position` is its own in the first of them."""

    @abstractmethod
    def change_source(self, before: float, now: float) -> None:
        """The master's position is counted otherwise from now on (`now` was `before`); the slave must not jump."""


class LinearCoupling(Coupling):
    """Slave position = factor · master position + offset; a new factor keeps the position continuous."""

    def __init__(self, master: str, factor: float, *, difference_limit: float | None = None) -> None:
        """With a `difference_limit` (mm, deg) of the actual positions the two are a gantry pair."""
        super().__init__(master, factor)
        self.difference_limit = difference_limit
        self.keeps_pair = difference_limit is not None
        self.offset: float | None = None
        self._new_factor: float | None = None

    def set_factor(self, factor: float) -> None:
        """Counts from the next cycle that is computed."""
        self._new_factor = factor

    def follow(self, position: float, master: Setpoints) -> Setpoints:
        """p = f·pm + offset, v = f·vm, a = f·am, j = f·jm."""
        begin = master.positions[0]
        if self.offset is None:
            self.offset = position - self.ratio * begin
        if self._new_factor is not None:
            self.offset += (self.ratio - self._new_factor) * begin
            self.ratio, self._new_factor = self._new_factor, None
        f, offset = self.ratio, self.offset
        return Setpoints(
            [f * p + offset for p in master.positions],
            [f * v for v in master.velocities],
            [f * a for a in master.accelerations],
            [f * j for j in master.jerks],
        )

    def place(self, master: MotionState) -> MotionState:
        """`follow` for one cycle of a coupling that has begun."""
        assert self.offset is not None
        f = self.ratio
        return f * master[0] + self.offset, f * master[1], f * master[2], f * master[3]

    def change_source(self, before: float, now: float) -> None:
        if self.offset is not None:
            self.offset += self.ratio * (before - now)


class CyclicCoupling(Coupling):
    """The factor comes cyclically from the PLC and is smoothed: the slave's acceleration stays within AccBound B.

    Its velocity goes towards factor · vm by at most B·T per cycle. Once it is there, the slave is a linear one
    (p = f·pm + offset) as long as the factor is unchanged and B is kept. Stable where B >= max|factor| · max(A+, A-) of
    the master, else it lags behind its factor. Source: TX1250 3.3.
    """

    def __init__(self, master: str, acc_bound: float, *, cycle_time: float) -> None:
        """`acc_bound` in mm/s² (deg/s²), `cycle_time` in s; the factor is 0 until one is set."""
        super().__init__(master, 0.0)
        self.acc_bound = acc_bound
        self._cycle_time = cycle_time
        self._slave: MotionState | None = None
        self._reached: float | None = None
        """The factor that is held exactly, with its offset; None while it changes to another."""
        self._offset = 0.0

    def set_factor(self, factor: float) -> None:
        """Counts from the next cycle that is computed."""
        self.ratio = factor

    def follow(self, position: float, master: Setpoints) -> Setpoints:
        slave = (position, 0.0, 0.0, 0.0) if self._slave is None else self._slave
        slaves = []
        for state in master.states():
            slave = self._next(slave, state)
            slaves.append(slave)
        self._slave = slave
        return Setpoints.of(slaves)

    def _next(self, slave: MotionState, master: MotionState) -> MotionState:
        """The slave one cycle after `slave`."""
        f, bound, t = self.ratio, self.acc_bound, self._cycle_time
        p, v, a, j = master
        position, velocity, _, _ = slave
        change = f * v - velocity
        if self._reached == f and abs(f * a) <= bound and abs(change) <= bound * t * (1.0 + ROUNDING):
            return f * p + self._offset, f * v, f * a, f * j
        if abs(change) <= bound * t:
            reached, self._reached = f * v, f
        else:
            change = copysign(bound * t, change)
            reached, self._reached = velocity + change, None
        position += 0.5 * t * (velocity + reached)
        self._offset = position - f * p
        return position, reached, change / t, 0.0

    def change_source(self, before: float, now: float) -> None:
        if self._reached is not None:
            self._offset += self._reached * (before - now)
