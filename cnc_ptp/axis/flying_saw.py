"""Flying saw: a standing slave runs up to a moving master and is synchronous from a position on.

The run-up is a jerk-limited ramp over the way of the master: its table is planned with the velocity v0 that the master
has at the start and read at the time τ = (pm - pm0)/v0, so that the slave meets its place whatever the master does
meanwhile. With r = dτ/dt = vm/v0:  v = v'(τ)·r,  a = a'(τ)·r² + v'(τ)·r',  j = j'·r³ + 3·a'·r·r' + v'·r''.
"""

from __future__ import annotations

from collections.abc import Sequence

from cnc_ptp.axis.coupling import Coupling, LinearCoupling
from cnc_ptp.axis.faults import SAW_TOO_LATE
from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits, Profile, plan_to_velocity
from cnc_ptp.motion.profile import State


class FlyingSaw(Coupling):
    """Runs up, then is a linear coupling through the two synchronous positions."""

    def __init__(
        self, master: str, factor: float, *, master_position: float, slave_position: float, limits: Limits
    ) -> None:
        """Synchronous from `master_position` and `slave_position` (mm, deg) on; `limits` of the run-up."""
        super().__init__(master, factor)
        self._master_position = master_position
        self._slave_position = slave_position
        self._limits = limits
        self._linear = LinearCoupling(master, factor)
        self._linear.offset = slave_position - factor * master_position
        self._table: Profile | None = None
        self._begin = 0.0
        self._speed = 1.0
        self.synchronous = False

    def follow(self, position: float, states: Sequence[State]) -> list[State]:
        """Raises CncError 23051 in the first block when there is no time or way left to synchronise."""
        if self._table is None:
            self._begin, self._speed = states[0][:2]
            self._table = self._plan(position)
        slaves = []
        for state in states:
            moment = (state[0] - self._begin) / self._speed
            self.synchronous = self.synchronous or moment >= self._table.duration
            slaves.append(self._linear.follow(0.0, [state])[0] if self.synchronous else self._run_up(moment, state))
        return slaves

    def _plan(self, position: float) -> Profile:
        """Wait, ramp up to factor · v0, and on at that velocity so that the two positions are met together."""
        if self._speed == 0.0:
            raise CncError(SAW_TOO_LATE, "the master stands; a flying saw needs a moving master")
        velocity = self.ratio * self._speed
        ramp = plan_to_velocity(position, 0.0, 0.0, velocity, self._limits)
        meeting = (self._master_position - self._begin) / self._speed
        cruise = (self._slave_position - ramp.end[0]) / velocity
        wait = meeting - ramp.duration - cruise
        if cruise < 0.0:
            way = abs(ramp.end[0] - position)
            reason = f"the run-up takes {way:g}, the synchronous position is {self._slave_position - position:g} away"
            raise CncError(SAW_TOO_LATE, reason)
        if wait < 0.0:
            reason = f"the run-up takes {ramp.duration + cruise:g} s, the master is there in {meeting:g} s"
            raise CncError(SAW_TOO_LATE, reason)
        rows = [(wait + t, p, v, a, j) for t, p, v, a, j in ramp.rows]
        return Profile([(0.0, position, 0.0, 0.0, 0.0), *rows] if wait > 0.0 else rows)

    def _run_up(self, moment: float, master: State) -> State:
        assert self._table is not None
        p, v, a, j = self._table.state_at(moment)
        r, dr, ddr = (value / self._speed for value in master[1:])
        return p, v * r, a * r * r + v * dr, j * r**3 + 3.0 * a * r * dr + v * ddr

    def change_source(self, before: float, now: float) -> None:
        self._begin += now - before
        self._linear.change_source(before, now)
