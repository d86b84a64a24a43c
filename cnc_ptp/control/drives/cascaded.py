"""The simulated drive with its mechanics: velocity controller, current loop, inertia, friction that holds, backlash."""

from __future__ import annotations

from math import copysign, exp

from cnc_ptp.control.drives.transitions import transition
from cnc_ptp.parameters.control_view import PlantParameters

FINEST = 6
"""A cycle is halved at most so often where friction or the torque limit changes its kind."""
UNEVEN = 0.02
"""A step may carry at most this part of the Stribeck friction away; a longer one is halved."""
FAR = 6.0
"""Stribeck velocities above which the Stribeck part is none (e^-36)."""
NEGLIGIBLE = 1e-12


class CascadedDrive:
    """Velocity command -> first-order filter -> PI controller -> current loop with limit -> inertia with friction.

    w' = (u - w) / Tf; torque = k (Kp (w + u_add - v + 1/Tn ∫(w + u_add - v) dt)) + M_add, limited, behind a lag Ti;
    k v' = torque - friction. Friction is (C + (S - C) e^(-(v/vs)²)) against the motion plus a viscous part; a standing
    axis stands until the torque exceeds S. The integral stands still while the torque is limited. The load follows the
    motor behind a play.

    A cycle is one exact step of the linear part under held inputs (parameters/plant_model.py); the Stribeck part counts
    with the mean of its values at begin and end. Where it changes much in a step, where the velocity passes zero, where
    the axis breaks away or the torque limit begins or ends, the cycle is halved, again and again down to 1/64.
    `torque` is that at the end of the cycle. Source: TF5200 feedforward, figure 2; friction, figure 1.
    """

    __slots__ = (
        "_additive_velocity",
        "_backlash",
        "_coulomb",
        "_direction",
        "_dry",
        "_encoder_at_load",
        "_encoder_increment",
        "_far",
        "_filtered",
        "_gain",
        "_integral",
        "_lagging",
        "_limit",
        "_load_position",
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
        "has_torque",
        "position",
        "torque",
        "velocity",
    )

    def __init__(self, plant: PlantParameters, *, cycle_time: float) -> None:
        """`cycle_time` in s; inertia must not be 0 (ValueError)."""
        if plant.torque_per_acceleration <= 0.0:
            raise ValueError("a cascaded drive needs an inertia above 0 (P-SIM-00007, P-AXIS-00391)")
        self.has_torque = True
        self._set_controller(plant, plant.velocity_gain, cycle_time)
        self._set_mechanics(plant)
        self.velocity = self.torque = 0.0
        self._setpoint = self._wanted = self._integral = self._motor = 0.0
        self._direction = 0.0 if self._dry else 1.0
        """+1, -1: the motor slides, 0: friction holds it."""
        self._motor_position = self._load_position = plant.start_position
        self.position = 0.0
        self._show()

    def _set_controller(self, plant: PlantParameters, gain: float, cycle_time: float) -> None:
        self._gain = gain
        self._filtered = plant.time_constant > 0.0
        self._lagging = plant.current_time_constant > 0.0
        self._limit = plant.torque_limit / plant.torque_per_acceleration
        self._transitions = tuple(
            transition(plant, gain=gain, duration=cycle_time / 2**level) for level in range(FINEST + 1)
        )

    def _set_mechanics(self, plant: PlantParameters) -> None:
        """Torques are divided by the inertia, so that they are accelerations."""
        k = self._per_acceleration = plant.torque_per_acceleration
        self._coulomb, self._static = plant.coulomb / k, plant.static / k
        self._stribeck = self._static - self._coulomb
        self._dry = self._static > 0.0
        self._uneven = UNEVEN * self._stribeck
        self._per_stribeck_velocity = 1.0 / plant.stribeck_velocity
        self._far = FAR * plant.stribeck_velocity if self._stribeck else 0.0
        self._viscous = plant.viscous / k
        self._backlash = plant.backlash / 2.0
        self._encoder_at_load = plant.encoder_at_load
        self._encoder_increment = plant.encoder_increment

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """Holds velocities `command` and `additive_velocity` (mm/s, deg/s) and `additive_torque` (Nm, N) for a cycle.

        The additive values act behind the filter of the command.
        """
        additive = additive_torque / self._per_acceleration
        self._wanted = command + additive_velocity
        self._setpoint = self._setpoint + additive_velocity if self._filtered else self._wanted
        self._integral += additive
        self._advance(0)
        self._setpoint -= additive_velocity
        self._integral -= additive
        if not self._dry and -NEGLIGIBLE < self.velocity < NEGLIGIBLE:
            self._come_to_rest()
        self.torque = self._motor * self._per_acceleration
        self._show()

    def _come_to_rest(self) -> None:
        """Without friction everything dies away for ever; what cannot be seen any more is over."""
        if abs(self._setpoint) < NEGLIGIBLE and abs(self._integral) + abs(self._motor) < NEGLIGIBLE * self._gain:
            self.velocity = self._setpoint = self._integral = self._motor = 0.0

    def _show(self) -> None:
        position = self._load_position if self._encoder_at_load else self._motor_position
        increment = self._encoder_increment
        self.position = round(position / increment) * increment if increment else position

    def _advance(self, level: int) -> None:
        """A step of 1/2^level cycle, in halves where it must be."""
        done = self._slide(level) if self._direction else self._stand(level)
        if not done:
            self._advance(level + 1)
            self._advance(level + 1)

    def _slide(self, level: int) -> bool:
        """One step in motion; False, and nothing has happened, when its halves have to be looked at."""
        duration, decay, sliding, held, _, _ = self._transitions[level]
        limit, gain, direction = self._limit, self._gain, self._direction
        v = self.velocity
        integral, motor = self._integral, self._motor
        r = self._wanted - v
        p = self._setpoint - v
        dry = self._dry_friction(v)
        friction = direction * dry + self._viscous * v
        asked = gain * p + integral
        side = self._limited(asked)
        if not side:
            ip, ir, ii, im, jf, mp, mr, mi, mm, mf, vp, vr, vi, vm, vf, xp, xr, xi, xm, xf = sliding
            new_integral = integral + ip * p + ir * r + ii * integral + im * motor + jf * friction
            new_motor = motor + mp * p + mr * r + mi * integral + mm * motor + mf * friction
            y = vp * p + vr * r + vi * integral + vm * motor + vf * friction
            x = xp * p + xr * r + xi * integral + xm * motor + xf * friction
        else:
            mi, mm, mf, vi, vm, vf, xi, xm, xf = held
            asked = side * limit
            jf = 0.0
            new_integral = integral
            new_motor = motor + mi * asked + mm * motor + mf * friction
            y = vi * asked + vm * motor + vf * friction
            x = xi * asked + xm * motor + xf * friction
        new_v = v + y
        crosses = self._dry and new_v * direction < 0.0
        if not crosses and self._stribeck and (v * direction < self._far or new_v * direction < self._far):
            change = self._dry_friction(new_v) - dry
            if not -self._uneven <= change <= self._uneven and level < FINEST:
                return False
            change *= 0.5 * direction
            new_integral += jf * change
            new_motor += mf * change
            y += vf * change
            x += xf * change
            new_v = v + y
            crosses = new_v * direction < 0.0
        new_p = (p - r) * decay + r - y
        new_asked = gain * new_p + new_integral
        if level < FINEST and (crosses or self._limited(new_asked) != side):
            return False
        if not self._lagging:
            new_motor = limit if new_asked > limit else -limit if new_asked < -limit else new_asked
        self._setpoint, self._integral, self._motor = new_p + new_v, new_integral, new_motor
        if crosses:
            self._pass_zero(v, new_v, duration)
        else:
            self.velocity = new_v
            self._motor_position += v * duration + x
        self._take_load()
        return True

    def _pass_zero(self, v: float, new_v: float, duration: float) -> None:
        """The velocity has changed its sign in one of the shortest steps: the axis stands, or turns back at once."""
        share = v / (v - new_v)
        self._motor_position += 0.5 * v * share * duration
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
        _, decay, _, _, standing, held = self._transitions[level]
        limit, gain = self._limit, self._gain
        w, u, integral, motor = self._setpoint, self._wanted, self._integral, self._motor
        asked = gain * w + integral
        side = self._limited(asked)
        if not side:
            iw, iu, ii, im, mw, mu, mi, mm = standing
            new_integral = integral + iw * w + iu * u + ii * integral + im * motor
            new_motor = motor + mw * w + mu * u + mi * integral + mm * motor
        else:
            new_integral = integral
            new_motor = motor + held[0] * side * limit + held[1] * motor
        new_w = (w - u) * decay + u
        new_asked = gain * new_w + new_integral
        if not self._lagging:
            new_motor = limit if new_asked > limit else -limit if new_asked < -limit else new_asked
        holds = -self._static <= new_motor <= self._static
        if level < FINEST and (not holds or self._limited(new_asked) != side):
            return False
        self._setpoint, self._integral, self._motor = new_w, new_integral, new_motor
        if not holds:
            self._direction = copysign(1.0, new_motor)
        return True

    def _limited(self, asked: float) -> int:
        return 1 if asked > self._limit else -1 if asked < -self._limit else 0

    def _dry_friction(self, v: float) -> float:
        """Amount of Coulomb and Stribeck friction at a velocity, as acceleration."""
        far = self._far
        if -far < v < far:
            ratio = v * self._per_stribeck_velocity
            return self._coulomb + self._stribeck * exp(-ratio * ratio)
        return self._coulomb

    def _take_load(self) -> None:
        """The motor takes the load along where the play is used up."""
        motor, play = self._motor_position, self._backlash
        if self._load_position < motor - play:
            self._load_position = motor - play
        elif self._load_position > motor + play:
            self._load_position = motor + play


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
