"""Flying saw: a slave at a standstill runs up to a moving master and is synchronous from a position on.

The run-up is a jerk-limited ramp over the distance of the master: its table is planned for the velocity v0 of the
master, and read at the time τ = (pm - pm0)/v0, so that the slave meets its position whatever the master does meanwhile.
With r = dτ/dt = vm/v0:  v = v'(τ)·r,  a = a'(τ)·r² + v'(τ)·r',  j = j'·r³ + 3·a'·r·r' + v'·r''. While the slave still
waits, the run-up is replanned when the velocity of the master changes.
"""

from __future__ import annotations

from math import copysign

from cnc_ptp.axis.coupling import Coupling, LinearCoupling
from cnc_ptp.axis.faults import SAW_TOO_LATE
from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits, Profile, plan_to_velocity
from cnc_ptp.motion.limits import rounding
from cnc_ptp.motion.setpoints import MotionState, Setpoints

ROUNDING = 1e-12
"""s; tolerance for a run-up that is late or long, as it can be replanned in the very cycle in which it starts.

The rounding of the positions comes in addition, which amounts to seconds if the axes are slow.
"""


class FlyingSaw(Coupling):
    """Runs up, then is a linear coupling through the two synchronous positions."""

    def __init__(
        self,
        master: str,
        factor: float,
        *,
        master_position: float,
        slave_position: float,
        limits: Limits,
        unit: str,
    ) -> None:
        """Synchronous from `master_position` and `slave_position` (in `unit`) on; `limits` of the run-up."""
        super().__init__(master, factor)
        self._master_position = master_position
        self._slave_position = slave_position
        self._limits = limits
        self._unit = unit
        self._linear = LinearCoupling(master, factor)
        self._linear.offset = slave_position - factor * master_position
        self._table: Profile | None = None
        self._start = 0.0
        self._speed = 1.0
        self._wait = 0.0
        self._waits = True
        self.synchronous = False

    def follow(self, position: float, master: Setpoints) -> Setpoints:
        """Raises CncError 23051 before the start of the slave if no time or distance is left to synchronise."""
        if self._table is None:
            if master.velocities[0] == 0.0:
                raise CncError(SAW_TOO_LATE, "the master is at a standstill; a flying saw needs a moving master")
            self._plan(position, master.at(0))
        return Setpoints.of([self._next(position, state) for state in master.states()])

    def _next(self, position: float, master: MotionState) -> MotionState:
        assert self._table is not None
        moment = (master[0] - self._start) / self._speed
        if moment > self._wait:
            self._waits = False
        elif self._waits and master[1] not in (0.0, self._speed):
            moment = self._plan(position, master)
        if moment >= self._table.duration:
            self.synchronous = True
        return self._linear.place(master) if self.synchronous else self._run_up(moment, master)

    def _plan(self, position: float, master: MotionState) -> float:
        """Wait, ramp up to factor · v0, and on at that velocity so that the two positions are met together.

        Returns the moment 0.0 at which the table starts.
        """
        self._start, self._speed = master[0], master[1]
        velocity, unit = self.ratio * self._speed, self._unit
        if abs(velocity) > self._limits.velocity:
            limit = f"its velocity is limited to {self._limits.velocity:g} {unit}/s"
            reason = f"it would have to run at {abs(velocity):g} {unit}/s, {limit}"
            raise CncError(SAW_TOO_LATE, reason, velocity=abs(velocity), limit=self._limits.velocity)
        ramp = plan_to_velocity(position, 0.0, 0.0, velocity, self._limits)
        meeting = (self._master_position - self._start) / self._speed
        cruise = (self._slave_position - ramp.end[0]) / velocity
        self._wait = meeting - ramp.duration - cruise
        if cruise < -ROUNDING - rounding(position, self._slave_position) / abs(velocity):
            distance = (self._slave_position - position) * copysign(1.0, velocity)
            where = f"{distance:g} {unit} away" if distance >= 0.0 else f"{-distance:g} {unit} behind the axis"
            needed = abs(ramp.end[0] - position)
            reason = f"the run-up takes {needed:g} {unit}, the synchronous position is {where}"
            raise CncError(SAW_TOO_LATE, reason, run_up=needed, distance=distance)
        if self._wait < -ROUNDING - rounding(self._start, self._master_position) / abs(self._speed):
            when = f"is there in {meeting:g} s" if meeting >= 0.0 else f"was there {-meeting:g} s ago"
            needed = ramp.duration + cruise
            reason = f"the run-up takes {needed:g} s, the master {when}"
            raise CncError(SAW_TOO_LATE, reason, duration=needed, time=meeting)
        self._wait = max(0.0, self._wait)
        rows = [(self._wait + t, p, v, a, j) for t, p, v, a, j in ramp.rows]
        self._table = Profile([(0.0, position, 0.0, 0.0, 0.0), *rows])
        return 0.0

    def _run_up(self, moment: float, master: MotionState) -> MotionState:
        assert self._table is not None
        p, v, a, j = self._table.state_at(moment)
        r, dr, ddr = master[1] / self._speed, master[2] / self._speed, master[3] / self._speed
        return p, v * r, a * r * r + v * dr, j * r**3 + 3.0 * a * r * dr + v * ddr

    def shift(self, distance: float) -> None:
        """The slave's coordinates are shifted: all positions are greater by `distance` from now on."""
        assert self._linear.offset is not None
        self._slave_position += distance
        self._linear.offset += distance
        if self._table is not None:
            self._table = Profile([(t, p + distance, v, a, j) for t, p, v, a, j in self._table.rows])

    def change_source(self, before: float, now: float) -> None:
        self._start += now - before
        self._master_position += now - before
        self._linear.change_source(before, now)
