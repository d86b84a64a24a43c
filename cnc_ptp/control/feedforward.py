"""Feedforward: commands from velocity, acceleration and jerk of the setpoint, before a following error arises.

The command is held for a cycle, so each value is the mean over the cycle that it is held: v + aT/2 + jT²/6 and
a + jT/2 (of a drive under torque command v itself, which the NC's velocity controller compares).
Sources: TF5200 feedforward 2, 5; spindle 2.8.1 (prefilter, soft coupling).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from dataclasses import dataclass
from math import copysign, exp, floor, sqrt
from typing import NamedTuple

from cnc_ptp.control.history import SetpointHistory
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.parameters.view.control_view import ACC, ADD_ACC, ADD_JERK, ADD_VEL, JERK, VEL, FeedforwardParameters

ROUNDING = 1e-9
"""A factor nearer to its target than this has reached it."""
EXCESS = 0.03
"""Part by which feedforward and motion may exceed the axis' acceleration while feedforward is coupled in or out."""
NO_ROOM = 0.01
"""Part of the axis' acceleration; if less is left for the push, near the largest velocity, there is no room …"""
WAITED = 0.5
"""… and seconds of constant velocity without room after which that is worth a warning."""
DECAYED = 3.0
"""Time constants after which a lag that was made up no longer counts: e^3 · EXCESS > 1."""


class Feedforward:
    """Values of one axis: `update` once per cycle, then the three outputs hold.

    velocity             conventional part, added to the output of the position controller, mm/s (deg/s)
    additive_velocity    additive velocity command of the drive, mm/s (deg/s)
    additive_torque      additive torque command of the drive, Nm (N)
    """

    __slots__ = (
        "_acceleration_at",
        "_always_active",
        "_coupling",
        "_depth",
        "_jerk_at",
        "_means",
        "_parts",
        "_prefilter",
        "_velocity_at",
        "_velocity_of_torque",
        "additive_torque",
        "additive_velocity",
        "mode",
        "velocity",
    )

    def __init__(
        self,
        parameters: FeedforwardParameters,
        *,
        cycle_time: float,
        kv: float,
        torque_per_acceleration: float,
        limits: CouplingLimits,
        delay_cycles: int,
        samples_velocity: bool = False,
    ) -> None:
        """`delay_cycles`: by how many cycles the position controller works behind the newest setpoint.

        `torque_per_acceleration` in Nm (N) for 1 mm/s² (deg/s²), `kv` in 1/s, `cycle_time` in s. `samples_velocity`:
        the velocity is not held by a drive, but compared by the NC with the actual velocity at the start of the cycle.
        """
        self.mode = parameters.mode
        behind = float(delay_cycles - parameters.lead_cycles)
        mode = parameters.mode
        velocity_delay = parameters.velocity_delay / cycle_time if mode & ADD_VEL else 0.0
        torque_delay = parameters.acceleration_delay / cycle_time
        at = behind + velocity_delay
        self._velocity_at: VelocityValue = (
            MomentaryVelocity(at, cycle_time) if samples_velocity else MeanValue(at, cycle_time)
        )
        self._acceleration_at = MeanValue(behind + (torque_delay if mode & ADD_ACC else 0.0), cycle_time)
        self._jerk_at = MeanValue(behind + (torque_delay if mode & ADD_JERK else 0.0), cycle_time)
        oldest = max(self._velocity_at.oldest, self._acceleration_at.oldest, self._jerk_at.oldest)
        self._depth = max(1, 1 + oldest)  # without feedforward there may be no delay line for the lead
        self._parts = _parts(parameters, kv, torque_per_acceleration)
        self._velocity_of_torque = 1.0 / (torque_per_acceleration * kv) if torque_per_acceleration else 0.0
        self._prefilter: deque[tuple[float, float, float]] = deque(maxlen=parameters.prefilter_cycles)
        self._means = parameters.prefilter_cycles > 1
        self._coupling = SoftCoupling(limits, cycle_time=cycle_time, kv=kv)
        self._always_active = parameters.always_active
        self.velocity = self.additive_velocity = self.additive_torque = 0.0
        self.select(parameters.always_active, 100.0)
        self._coupling.settle()

    @property
    def active(self) -> bool:
        """True while it outputs anything, also while it is being coupled out."""
        return self.mode != 0 and self._coupling.active

    @property
    def percent(self) -> float:
        """Weight with which it acts now, also while it is coupled in or out; 0 = off."""
        return 100.0 * self._coupling.factor if self.mode else 0.0

    @property
    def velocity_part(self) -> float:
        """Part of a constant velocity that is output besides the position controller."""
        parts = self._parts
        return self._coupling.factor * (parts.velocity + parts.additive_velocity) if self.mode else 0.0

    def select(self, on: bool, weight_percent: float) -> None:
        """G135 or G137 with the weight of G136; P-AXIS-00255 keeps it on. It is coupled in or out softly."""
        self._coupling.target = weight_percent / 100.0 if on or self._always_active else 0.0

    def settle(self) -> None:
        """The selection takes effect immediately: at a standstill nothing can step."""
        self._coupling.settle()

    def take_wait(self) -> float | None:
        """The axis' largest velocity if the selection waits in vain for room up to it; reported once."""
        return self._coupling.take_wait()

    def at_rest(self, history: SetpointHistory) -> bool:
        """True if all setpoints in use are at a standstill; `history` ends with the cycle before."""
        seen = range(self._depth if history.filled else 0)
        if any(history.velocity(back) != 0.0 or history.acceleration(back) != 0.0 for back in seen):
            return False
        return not any(map(any, self._prefilter))

    def forget(self) -> None:
        """The loop is open: nothing is output, the selection takes effect in the next closed cycle."""
        self.velocity = self.additive_velocity = self.additive_torque = 0.0
        self._prefilter.clear()
        self._coupling.forget()

    def update(self, history: SetpointHistory, feedback: float) -> None:
        """The values of this cycle, whose setpoint `history` has.

        `feedback` is the output of the position controller in this cycle, mm/s (deg/s).
        """
        mean_velocity = self._velocity_at.velocity(history)
        mean_acceleration = self._acceleration_at.acceleration(history)
        mean_jerk = self._jerk_at.jerk(history)
        if self._means:
            self._prefilter.append((mean_velocity, mean_acceleration, mean_jerk))
            count = len(self._prefilter)
            mean_velocity, mean_acceleration, mean_jerk = (
                sum(values) / count for values in zip(*self._prefilter, strict=True)
            )
        p = self._parts
        velocity = p.velocity * mean_velocity + p.acceleration * mean_acceleration + p.jerk * mean_jerk
        additive = p.additive_velocity * mean_velocity
        torque = p.torque * mean_acceleration + p.jerk_torque * mean_jerk
        coupling = self._coupling
        if coupling.factor != coupling.target:
            coupling.step(feedback, velocity + additive, torque * self._velocity_of_torque, history.at(0))
        factor = coupling.factor
        self.velocity = factor * velocity
        self.additive_velocity = factor * additive
        self.additive_torque = factor * torque
        if coupling.active:
            coupling.note(feedback + factor * (velocity + additive))
        else:
            self.forget()


@dataclass(frozen=True, slots=True)
class Parts:
    """Factors of mean velocity, acceleration and jerk in the three outputs."""

    velocity: float
    acceleration: float
    jerk: float
    additive_velocity: float
    torque: float
    jerk_torque: float


def _parts(parameters: FeedforwardParameters, kv: float, torque_per_acceleration: float) -> Parts:
    """Conventional: v, Ta · a, (jerk_fact) · Ta/Kv · j; additive: v, J · a, J · jerk_fact · j (jerk_fact in s)."""
    mode, weight = parameters.mode, parameters.weight
    velocity = weight * parameters.velocity_weight if mode & VEL else 0.0
    acceleration = weight if mode & ACC else 0.0
    jerk = weight * parameters.jerk_weight if mode & JERK else 0.0
    return Parts(
        velocity=0.0 if mode & ADD_VEL else velocity,
        acceleration=0.0 if mode & ADD_ACC else acceleration * parameters.time_constant,
        jerk=0.0 if mode & ADD_JERK else jerk * parameters.time_constant / kv,
        additive_velocity=velocity if mode & ADD_VEL else 0.0,
        torque=acceleration * parameters.torque_weight * torque_per_acceleration if mode & ADD_ACC else 0.0,
        jerk_torque=jerk * torque_per_acceleration if mode & ADD_JERK else 0.0,
    )


def _split(behind: float) -> tuple[int, float]:
    """Whole cycles and fraction of a cycle; a whole number but for rounding has none."""
    whole = floor(behind + 1e-9)
    fraction = behind - whole
    return whole, fraction if fraction > 1e-9 else 0.0


class VelocityValue(ABC):
    """A velocity out of the history; `oldest`: how far back it looks, in cycles."""

    __slots__ = ("oldest",)

    def __init__(self, oldest: int) -> None:
        self.oldest = oldest

    @abstractmethod
    def velocity(self, history: SetpointHistory) -> float:
        """In mm/s (deg/s)."""


class MeanValue(VelocityValue):
    """Mean of velocity, acceleration or jerk over the cycle that began `behind` cycles before the newest setpoint.

    A fraction of a cycle takes the end of one setpoint's cycle and the start of the next one's. Exact for a jerk that
    is constant in each cycle.
    """

    __slots__ = ("_first", "_index", "_second", "_split")

    def __init__(self, behind: float, cycle_time: float) -> None:
        """`behind` >= 0 in cycles, `cycle_time` in s."""
        whole, fraction = _split(behind)
        super().__init__(whole + 1 if fraction else whole)
        self._index = whole
        self._split = fraction > 0.0
        t, s = cycle_time, (1.0 - fraction) * cycle_time
        self._second = (s / t, s * s / (2.0 * t), s**3 / (6.0 * t))
        self._first = ((t - s) / t, (t * t - s * s) / (2.0 * t), (t**3 - s**3) / (6.0 * t))

    def velocity(self, history: SetpointHistory) -> float:
        index = self._index
        p, q, r = self._second
        mean = p * history.velocity(index) + q * history.acceleration(index) + r * history.jerk(index)
        if self._split:
            p, q, r = self._first
            index += 1
            mean += p * history.velocity(index) + q * history.acceleration(index) + r * history.jerk(index)
        return mean

    def acceleration(self, history: SetpointHistory) -> float:
        index = self._index
        mean = self._second[0] * history.acceleration(index) + self._second[1] * history.jerk(index)
        if self._split:
            index += 1
            mean += self._first[0] * history.acceleration(index) + self._first[1] * history.jerk(index)
        return mean

    def jerk(self, history: SetpointHistory) -> float:
        mean = self._second[0] * history.jerk(self._index)
        return mean + self._first[0] * history.jerk(self._index + 1) if self._split else mean


class MomentaryVelocity(VelocityValue):
    """Velocity `behind` cycles before the newest setpoint."""

    __slots__ = ("_time",)

    def __init__(self, behind: float, cycle_time: float) -> None:
        """`behind` >= 0 in cycles, `cycle_time` in s."""
        whole, fraction = _split(behind)
        super().__init__(whole + 1 if fraction else whole)
        self._time = (1.0 - fraction) * cycle_time if fraction else 0.0

    def velocity(self, history: SetpointHistory) -> float:
        back, t = self.oldest, self._time
        return history.velocity(back) + t * (history.acceleration(back) + 0.5 * t * history.jerk(back))


class CouplingLimits(NamedTuple):
    """Limits of the axis: velocity in mm/s (deg/s), acceleration, jerk; an infinite jerk is no limit."""

    velocity: float
    acceleration: float
    jerk: float


class SoftCoupling:
    """Factor of a feedforward that is coupled in and out softly.

    A change of the factor pushes the velocity command: that is the change of the command besides the motion. The push
    changes by the axis' jerk, comes down to 0 in time, and command and push together stay within the axis' acceleration
    - and with them the acceleration of a first-order drive. As a lag is made up, the axis is faster than its setpoint
    by about push/Kv; its velocity must have room for that. With no room left the factor waits.

    An additive torque M counts as a velocity M/(k·Kv), for a velocity controller is faster than a position controller.
    """

    __slots__ = (
        "_cycle_time",
        "_kv",
        "_last_command",
        "_limits",
        "_push",
        "_quantum",
        "_reserve",
        "_waited",
        "_warned",
        "factor",
        "target",
    )

    def __init__(self, limits: CouplingLimits, *, cycle_time: float, kv: float) -> None:
        self._limits, self._cycle_time, self._kv = limits, cycle_time, kv
        self._quantum = limits.jerk * cycle_time
        self._reserve = kv / limits.jerk
        self._push = 0.0
        self._last_command: float | None = None
        self._waited, self._warned = 0, False
        self.factor = self.target = 0.0

    @property
    def active(self) -> bool:
        return self.factor != 0.0 or self.target != 0.0

    def settle(self) -> None:
        """True when the factor is the selected one."""
        self.factor, self._push = self.target, 0.0
        self._waited, self._warned = 0, False

    def take_wait(self) -> float | None:
        """See Feedforward.take_wait; the next one is reported after the selection has taken effect."""
        if self._warned or self._waited * self._cycle_time < WAITED:
            return None
        self._warned = True
        return self._limits.velocity

    def _note_room(self, velocity_room: float, acceleration: float) -> None:
        waits = acceleration == 0.0 and velocity_room < NO_ROOM * self._limits.acceleration
        self._waited = self._waited + 1 if waits else 0

    def forget(self) -> None:
        """The loop is open or nothing is output: the selection takes effect immediately, nothing moves."""
        self.settle()
        self._last_command = None

    def note(self, command: float) -> None:
        """The complete velocity command of this cycle, mm/s (deg/s)."""
        self._last_command = command

    def step(self, feedback: float, velocity: float, torque_velocity: float, setpoint: MotionState) -> None:
        """One cycle nearer to the target.

        `feedback` of the position controller; `velocity` of the feedforward and its torque as a velocity, both at
        factor 1; all in mm/s (deg/s).
        """
        size, t = abs(velocity) + abs(torque_velocity), self._cycle_time
        missing = (self.target - self.factor) * size
        if missing == 0.0:
            self.settle()
            return
        direction = copysign(1.0, velocity or torque_velocity)
        push = self._smooth(missing, self._push * direction)
        last_command = feedback + self.factor * velocity if self._last_command is None else self._last_command
        drift = (feedback + self.factor * velocity - last_command) / t
        most = self._room(push * velocity, push * torque_velocity, drift, setpoint)
        push = max(-most, min(most, push))
        if push * t / missing >= 1.0 - ROUNDING and abs(push) <= 2.0 * self._quantum:
            self.settle()
            return
        before = self.factor
        self.factor = max(0.0, min(1.0, before + push * t / size))
        self._push = (self.factor - before) * size / t * direction

    def _smooth(self, missing: float, last: float) -> float:
        """A push that differs by at most one quantum (jerk · T) from the last one and comes down to 0 in such steps.

        Coming down from n quanta takes a velocity of n (n + 1) / 2 quanta · T.
        """
        quantum = self._quantum
        double_missing = 2.0 * abs(missing) / self._cycle_time
        push = copysign(double_missing / (0.5 + sqrt(0.25 + double_missing / quantum)), missing)
        return max(last - quantum, min(last + quantum, push))

    def _room(self, by_velocity: float, by_torque: float, drift: float, setpoint: MotionState) -> float:
        """The largest push, mm/s² (deg/s²); without it, the velocity command changes by `drift`.

        A lag that has been made up persists for 1/Kv, and the setpoint may accelerate meanwhile: a jerk J takes it to
        the axis' limit in room/J; by then e^(-Kv·room/J) of the push is left.
        """
        limit, velocity, command = self._limits.acceleration, setpoint[1], self._last_command or 0.0
        room = max(0.0, limit - abs(setpoint[2]))
        decays = room * self._reserve
        if self._reserve > 0.0 and decays < DECAYED:
            room = min(room, EXCESS * limit * exp(decays))
        if by_velocity > 0.0 or by_torque > 0.0:
            room = min(room, limit - drift)
        if by_velocity < 0.0 or by_torque < 0.0:
            room = min(room, limit + drift)
        if by_velocity * velocity > 0.0 or by_torque * velocity > 0.0:
            velocity_room = self._kv * (self._limits.velocity - max(abs(velocity), abs(command)))
            self._note_room(velocity_room, setpoint[2])
            room = min(room, velocity_room)
        return max(0.0, room)
