"""The simulated drive with its mechanics: velocity controller, current loop, inertia, static friction, backlash."""

from __future__ import annotations

from math import copysign, exp, inf

from mypy_extensions import mypyc_attr

from cnc_ptp.control.drives.drive import Drive
from cnc_ptp.control.drives.exact_steps import transition
from cnc_ptp.parameters.view.control_view import PlantParameters

FINEST = 6
"""Maximum number of times that a cycle is halved when friction or the torque limit changes its state."""
UNEVEN = 0.02
"""A step may remove at most this part of the Stribeck friction; a longer one is halved."""
BEND = 0.1
"""Stribeck velocities by which the velocity may leave the tangent of its start in a step near zero."""
FAR = 5.5
"""Stribeck velocities above which the Stribeck part is 0 (e^-30) and zero is not near."""
NEGLIGIBLE = 1e-12
"""mm/s or deg/s; a smaller velocity is 0."""
STRONGEST = 1e12
"""mm/s² or deg/s²; bounds an unstable loop without torque limit before numbers overflow."""


@mypyc_attr(allow_interpreted_subclasses=True)
class CascadedDrive(Drive):
    """Velocity command -> first-order filter -> PI controller -> current loop with limit -> inertia with friction.

    w' = (u - w) / Tf; torque = k (Kp (w + u_add - v + 1/Tn ∫(w + u_add - v) dt)) + M_add, limited, behind a lag Ti;
    k v' = torque - friction. Friction is (C + (S - C) e^(-(v/vs)²)) against the motion plus a viscous part; a standing
    axis stands until the torque exceeds S. The integral is frozen while the torque is limited. The load follows the
    motor with a play.

    A cycle is one exact step of the linear part under held inputs (parameters/view/plant_model.py); the Stribeck part
    counts with the mean of its values at start and end. If it changes much in a step, if the velocity passes zero, if
    the axis breaks away or the torque limit begins or ends, the cycle is halved, again and again to 1/64.
    `torque` is the mean over the cycle, as FirstOrderDrive has it: within a cycle the torque swings by the step of the
    command, so its value at the end of one is not meaningful. Source: TF5200 feedforward, figure 2; friction, figure 1.
    """

    __slots__ = (
        "_additive_velocity",
        "_bend",
        "_coulomb",
        "_current_lag",
        "_cycle_time",
        "_direction",
        "_dry",
        "_edge",
        "_encoder_at_load",
        "_encoder_increment",
        "_far",
        "_filter_rate",
        "_filtered",
        "_gain",
        "_half_play",
        "_impulse",
        "_integral",
        "_integral_rate",
        "_lagging",
        "_limit",
        "_motor",
        "_motor_position",
        "_per_acceleration",
        "_per_stribeck_velocity",
        "_setpoint",
        "_static",
        "_stribeck",
        "_transitions",
        "_uneven",
        "_viscous",
        "_wanted",
        "load_position",
    )

    def __init__(self, plant: PlantParameters, *, cycle_time: float) -> None:
        """`cycle_time` in s; inertia must not be 0 (ValueError)."""
        if plant.torque_per_acceleration <= 0.0:
            raise ValueError("a cascaded drive needs an inertia above 0 (P-SIM-00007, P-AXIS-00391)")
        super().__init__(position=plant.start_position, has_torque=True)
        self._set_controller(plant, plant.velocity_gain, cycle_time)
        self._set_mechanics(plant)
        self._setpoint = self._wanted = self._integral = self._motor = 0.0
        self._impulse = 0.0
        """Torque summed up over the cycle."""
        self._direction = 0.0 if self._dry else 1.0
        """+1, -1: the motor slides, 0: friction holds it."""
        self._motor_position = self.load_position = plant.start_position
        """Positions of motor and load, mm (deg), without the resolution of the encoder."""
        self.step(0.0)  # stands; shows the position as the encoder does

    def _set_controller(self, plant: PlantParameters, gain: float, cycle_time: float) -> None:
        self._gain = gain
        self._cycle_time = cycle_time
        self._filtered = plant.time_constant > 0.0
        self._filter_rate = 1.0 / plant.time_constant if self._filtered else 0.0
        self._current_lag = plant.current_time_constant
        self._lagging = self._current_lag > 0.0
        self._integral_rate = gain / plant.velocity_integral_time if plant.velocity_integral_time > 0.0 else 0.0
        self._limit = min(STRONGEST, plant.torque_limit / plant.torque_per_acceleration)
        self._edge = self._limit * (1.0 - 1e-9)
        self._transitions = tuple(
            transition(plant, gain=gain, duration=cycle_time / 2**level) for level in range(FINEST + 1)
        )

    def _set_mechanics(self, plant: PlantParameters) -> None:
        """Torques are divided by the inertia, so that they are accelerations."""
        k = self._per_acceleration = plant.torque_per_acceleration
        self._coulomb, self._static = plant.coulomb / k, plant.static / k
        self._stribeck = self._static - self._coulomb
        self._dry = self._static > 0.0
        self._uneven, self._bend = UNEVEN * self._stribeck, BEND * plant.stribeck_velocity
        self._per_stribeck_velocity = 1.0 / plant.stribeck_velocity
        self._far = FAR * plant.stribeck_velocity if self._dry else -inf
        self._viscous = plant.viscous / k
        self._half_play = plant.backlash / 2.0
        self._encoder_at_load = plant.encoder_at_load
        self._encoder_increment = plant.encoder_increment

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """Holds velocities `command` and `additive_velocity` (mm/s, deg/s) and `additive_torque` (Nm, N) for a cycle.

        The additive values act behind the filter of the command.
        """
        additive = additive_torque / self._per_acceleration
        self._wanted = wanted = command + additive_velocity
        self._setpoint = self._setpoint + additive_velocity if self._filtered else wanted
        self._integral += additive
        self._impulse = 0.0
        if not (self._slide(0) if self._direction else self._stand(0)):
            self._halve(1)
        self._setpoint -= additive_velocity
        self._integral -= additive
        if not self._dry and -NEGLIGIBLE < self.velocity < NEGLIGIBLE:
            self._come_to_rest()
        mean = self._impulse / self._cycle_time
        self.torque = max(-self._limit, min(self._limit, mean)) * self._per_acceleration
        if self._half_play:
            self._take_load()
            position = self.load_position if self._encoder_at_load else self._motor_position
        else:
            position = self.load_position = self._motor_position
        increment = self._encoder_increment
        self.position = round(position / increment) * increment if increment else position

    def _come_to_rest(self) -> None:
        """Without friction a decay never ends; values too small to be seen become 0."""
        if abs(self._setpoint) < NEGLIGIBLE and abs(self._integral) + abs(self._motor) < NEGLIGIBLE * self._gain:
            self.velocity = self._setpoint = self._integral = self._motor = 0.0

    def _take_load(self) -> None:
        """The motor takes the load along when the play is used up."""
        motor, play = self._motor_position, self._half_play
        if self.load_position < motor - play:
            self.load_position = motor - play
        elif self.load_position > motor + play:
            self.load_position = motor + play

    def _halve(self, level: int) -> None:
        """Two steps of 1/2^level cycle each, halved again if needed."""
        for _ in range(2):
            if not (self._slide(level) if self._direction else self._stand(level)):
                self._halve(level + 1)

    def _slide(self, level: int) -> bool:
        """One step in motion; False, with nothing changed, when it has to be halved."""
        duration, decay, ip, ir, slide, slide_lag, _ = self._transitions[level]
        edge, gain, far, direction = self._edge, self._gain, self._far, self._direction
        v, integral = self.velocity, self._integral
        p, r = self._setpoint - v, self._wanted - v
        dry = self._dry_friction(v) if -far < v < far else self._coulomb
        friction = direction * dry + self._viscous * v
        asked = gain * p + integral
        side = 0 if -edge < asked < edge else 1 if asked > 0.0 else -1
        q = n = (side * self._limit if side else asked) - friction
        yp, yr, yq, xp, xr, xq, yf, xf = slide[side]
        y = yp * p + yr * r + yq * q
        x = xp * p + xr * r + xq * q
        motor = mf = 0.0
        if self._lagging:
            mp, mr, mq, mn, yn, xn, mf = slide_lag[side]
            motor = self._motor
            n = motor - friction
            motor += mp * p + mr * r + mq * q + mn * n
            y += yn * n
            x += xn * n
        crosses, dry_mean = False, direction * dry
        if v * direction < far or (v + y) * direction < far:
            change = self._friction_change(level, v, y, dry, n * duration)
            if change is None:
                return False
            motor += mf * change
            y += yf * change
            x += xf * change
            dry_mean += change
            crosses = (v + y) * direction < 0.0
            if crosses and level < FINEST:
                return False
        new_p = (p - r) * decay + r - y
        new_integral = integral if side else integral + ip * p + ir * r - self._integral_rate * x
        asked = gain * new_p + new_integral
        if side or not -edge < asked < edge:
            held = self._integral_at_limit(level, side, p, new_p, new_integral)
            if held is None:
                return False
            new_integral = held
            asked = max(-self._limit, min(self._limit, gain * new_p + new_integral))
        self._integral = new_integral
        self._setpoint = new_p + v + y
        self._motor = motor if self._lagging else asked
        self._impulse += y + dry_mean * duration + self._viscous * (v * duration + x)
        if crosses:
            self._pass_zero(v, v + y, duration)
        else:
            self.velocity = v + y
            self._motor_position += v * duration + x
        return True

    def _friction_change(self, level: int, v: float, y: float, dry: float, tangent: float) -> float | None:
        """How much the mean friction of a step from v to v + y is above that at v; None when the step is too long.

        `dry` is the friction at v, `tangent` what y would be if the acceleration at v stayed.
        """
        direction, new_v = self._direction, v + y
        change = (self._dry_friction(new_v) if new_v * direction > 0.0 else self._static) - dry
        if level < FINEST:
            bend = tangent - y
            if not (-self._uneven <= change <= self._uneven and -self._bend <= bend <= self._bend):
                return None
        return 0.5 * direction * change

    def _pass_zero(self, v: float, new_v: float, duration: float) -> None:
        """The velocity has changed its sign in one of the shortest steps: the axis stops, or reverses immediately."""
        share = v / (v - new_v)
        self._motor_position += 0.5 * v * share * duration
        self._take_load()
        if -self._static <= self._motor <= self._static:
            self._direction = self.velocity = 0.0
            return
        self._direction = -self._direction
        rest = (1.0 - share) * duration
        new_v -= 2.0 * self._direction * self._static * rest  # friction has changed its sign for the rest of the step
        self.velocity = new_v if new_v * self._direction > 0.0 else 0.0
        self._motor_position += 0.5 * self.velocity * rest

    def _stand(self, level: int) -> bool:
        """One step at rest; the axis breaks away at the end of a shortest step."""
        duration, decay, ip, ir, _, _, stand_lag = self._transitions[level]
        edge, gain, static = self._edge, self._gain, self._static
        w, u, integral, motor = self._setpoint, self._wanted, self._integral, self._motor
        asked = gain * w + integral
        side = 0 if -edge < asked < edge else 1 if asked > 0.0 else -1
        pushed = side * self._limit if side else integral
        start = motor if self._lagging else pushed if side else asked
        if not -static <= start <= static:
            self._direction = copysign(1.0, start)
            return self._slide(level)
        if self._lagging:
            mw, mu, mi, mm = stand_lag[side]
            motor += mw * w + mu * u + mi * pushed + mm * motor
        new_w = (w - u) * decay + u
        new_integral = integral if side else integral + ip * w + ir * u
        asked = gain * new_w + new_integral
        if side or not -edge < asked < edge:
            held = self._integral_at_limit(level, side, w, new_w, new_integral)
            if held is None:
                return False
            new_integral = held
            asked = max(-self._limit, min(self._limit, gain * new_w + new_integral))
        motor = motor if self._lagging else asked
        holds = -static <= motor <= static
        if level < FINEST and not holds:
            return False
        self._impulse += self._impulse_at_rest(side, duration, (w, integral), (new_w, new_integral))
        if self._lagging:
            self._impulse -= self._current_lag * (motor - start)
        self._setpoint, self._integral, self._motor = new_w, new_integral, motor
        if not holds:
            self._direction = copysign(1.0, motor)
        return True

    def _impulse_at_rest(
        self, side: int, duration: float, start: tuple[float, float], end: tuple[float, float]
    ) -> float:
        """Integral of the torque demand over a step at rest, from values and slopes at both ends.

        `start`, `end`: set velocity and integral. A current loop outputs it later: Ti m' = demand - m.
        """
        if side:
            return side * self._limit * duration
        values = [self._gain * w + integral for w, integral in (start, end)]
        slopes = [
            self._gain * (self._wanted - w) * self._filter_rate + self._integral_rate * w for w, _ in (start, end)
        ]
        return 0.5 * duration * sum(values) + duration * duration / 12.0 * (slopes[0] - slopes[1])

    def _integral_at_limit(self, level: int, side: int, p: float, new_p: float, free: float) -> float | None:
        """The integral after a step that begins at the torque limit `side` or, from 0, ends at one.

        Beyond the limit it is frozen, at the limit it grows no further than to hold it. p and new_p are the velocity
        deviations at start and end, `free` is the integral without a limit. None when the step has to be halved.
        """
        gain, limit, before = self._gain, self._limit, self._integral
        if not side:
            if level < FINEST:
                return None
            start, end = gain * p + before, gain * new_p + free
            return before + min(1.0, (copysign(limit, end) - start) / (end - start)) * (free - before)
        missing = limit - side * (gain * new_p + before)
        if missing <= 0.0:
            return before
        rate = side * self._integral_rate * self._transitions[level].duration
        growth = 0.5 * rate * (p + new_p)
        leaves = growth < missing or rate * new_p < side * gain * (p - new_p)
        if leaves and level < FINEST:
            return None
        return before + side * max(0.0, min(missing, growth))

    def _dry_friction(self, v: float) -> float:
        """Magnitude of Coulomb and Stribeck friction at a velocity, as acceleration."""
        ratio = v * self._per_stribeck_velocity
        return self._coulomb + self._stribeck * exp(-ratio * ratio)


@mypyc_attr(allow_interpreted_subclasses=True)
class TorqueCommandedDrive(CascadedDrive):
    """The same mechanics behind a torque command: filter and velocity controller of the drive are switched off."""

    __slots__ = ()

    def __init__(self, plant: PlantParameters, *, cycle_time: float) -> None:
        super().__init__(plant, cycle_time=cycle_time)
        self._set_controller(plant, 0.0, cycle_time)

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """Holds the torques `command` and `additive_torque` (Nm, N) for a cycle; an additive velocity has no effect."""
        self._integral = command / self._per_acceleration
        super().step(0.0, 0.0, additive_torque)
