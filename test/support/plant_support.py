"""Plants for tests, and an independent solution of their differential equations: solve_ivp with events."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp

from cnc_ptp.parameters.view.control_view import PlantParameters

T = 0.001
PLANT = PlantParameters(
    cascaded=True,
    time_constant=0.003,
    torque_per_acceleration=6.0e-4,
    velocity_gain=500.0,
    velocity_integral_time=0.004,
    current_time_constant=0.0,
    torque_limit=math.inf,
    coulomb=0.3,
    static=0.5,
    stribeck_velocity=2.0,
    viscous=1.0e-3,
    backlash=0.0,
    encoder_at_load=True,
    bus_delay_cycles=0,
    kv=50.0,
    encoder_increment=0.0,
    start_position=0.0,
)
"""A feed axis in mm and Nm: 0.0006 Nm for 1 mm/s², breaks away at 0.5 Nm, slides at 0.3 Nm and more."""


def plant(**changes: float | bool) -> PlantParameters:
    return replace(PLANT, **changes)  # type: ignore[arg-type]


def frictionless(**changes: float | bool) -> PlantParameters:
    return plant(coulomb=0.0, static=0.0, viscous=0.0, **changes)


def friction_torque(of: PlantParameters, velocity: float) -> float:
    """The friction curve at a velocity other than 0, Nm (N)."""
    stribeck = (of.static - of.coulomb) * math.exp(-((velocity / of.stribeck_velocity) ** 2))
    return math.copysign(of.coulomb + stribeck, velocity) + of.viscous * velocity


@dataclass(frozen=True)
class Point:
    """What the solver found at the end of a cycle; the torque is its mean over the cycle."""

    position: float
    velocity: float
    torque: float


class Reference:
    """The plant's equations in torques, integrated piece by piece between the instants where friction changes its kind.

    The state is (w, z, m, v, x, i): z the integral of the velocity deviation in mm (deg), m the motor's torque in Nm
    behind its lag, i the integral of the torque over the cycle.
    """

    def __init__(self, of: PlantParameters) -> None:
        self.plant = of
        self.state = np.array([0.0, 0.0, 0.0, 0.0, of.start_position, 0.0])
        self.direction = 0.0 if of.static > 0.0 else 1.0

    def asked(self, s: np.ndarray, u: float, add_v: float, add_m: float) -> float:
        of = self.plant
        error = (s[0] if of.time_constant else u) + add_v - s[3]
        integral = s[1] / of.velocity_integral_time if of.velocity_integral_time else 0.0
        return of.torque_per_acceleration * of.velocity_gain * (error + integral) + add_m

    def motor(self, s: np.ndarray, u: float, add_v: float, add_m: float) -> float:
        if self.plant.current_time_constant:
            return float(s[2])
        limit = self.plant.torque_limit
        return float(min(limit, max(-limit, self.asked(s, u, add_v, add_m))))

    def slopes(self, s: np.ndarray, u: float, add_v: float, add_m: float) -> list[float]:
        of = self.plant
        asked, limit = self.asked(s, u, add_v, add_m), of.torque_limit
        error = (s[0] if of.time_constant else u) + add_v - s[3]
        friction = 0.0
        if of.static:
            friction = self.direction * abs(friction_torque(of, s[3])) if s[3] else self.direction * of.static
        friction = friction if of.static else of.viscous * s[3]
        return [
            (u - s[0]) / of.time_constant if of.time_constant else 0.0,
            error if abs(asked) <= limit else 0.0,
            (min(limit, max(-limit, asked)) - s[2]) / of.current_time_constant if of.current_time_constant else 0.0,
            (self.motor(s, u, add_v, add_m) - friction) / of.torque_per_acceleration if self.direction else 0.0,
            s[3] if self.direction else 0.0,
            self.motor(s, u, add_v, add_m),
        ]

    def cycle(self, u: float, add_v: float = 0.0, add_m: float = 0.0) -> Point:
        """One NC cycle under held inputs."""
        inputs = (u, add_v, add_m)
        time = self.state[5] = 0.0
        while time < T:
            if not self.direction and abs(self.motor(self.state, *inputs)) > self.plant.static:
                self.direction = math.copysign(1.0, self.motor(self.state, *inputs))
            time = self.piece(time, inputs)
        return Point(self.state[4], self.state[3], self.state[5] / T)

    def piece(self, start: float, inputs: tuple[float, float, float]) -> float:
        """On to the end of the cycle or to the next zero of the velocity, breakaway or end of the torque limit."""

        def stops(_: float, s: np.ndarray, *args: float) -> float:
            if not self.plant.static:
                return 1.0
            if self.direction:
                return float(s[3] * self.direction)
            return self.plant.static - abs(self.motor(s, *args))

        def limits(_: float, s: np.ndarray, *args: float) -> float:
            return (
                self.plant.torque_limit - abs(self.asked(s, *args)) if math.isfinite(self.plant.torque_limit) else 1.0
            )

        stops.terminal, stops.direction = True, -1.0  # type: ignore[attr-defined]
        limits.terminal = True  # type: ignore[attr-defined]
        run = solve_ivp(
            lambda _, s, *args: self.slopes(s, *args),
            (start, T),
            self.state,
            args=inputs,
            events=(stops, limits),
            method="DOP853",
            rtol=1e-11,
            atol=1e-13,
        )
        self.state = run.y[:, -1]
        stopped, limited = (bool(len(times)) for times in run.t_events)
        if stopped:
            self.change_kind(inputs)
        elif limited:  # step over the border, so that the same event does not end the next piece at once
            self.state = self.state + 1e-9 * np.array(self.slopes(self.state, *inputs))
            return float(run.t[-1] + 1e-9)
        return float(run.t[-1])

    def change_kind(self, inputs: tuple[float, float, float]) -> None:
        motor = self.motor(self.state, *inputs)
        if not self.direction:
            self.direction = math.copysign(1.0, motor)
            return
        self.state[3] = 0.0
        self.direction = math.copysign(1.0, motor) if abs(motor) > self.plant.static else 0.0


def reference_run(of: PlantParameters, inputs: Iterable[tuple[float, float, float]]) -> list[Point]:
    reference = Reference(of)
    return [reference.cycle(*each) for each in inputs]
