"""Control loops on the bench: parameters, setpoints of constant jerk in closed form, runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cnc_ptp.control.control_loop import ControlCycle, ControlLoop
from cnc_ptp.control.drives import Drive, FirstOrderDrive
from cnc_ptp.control.feedforward import CouplingLimits
from cnc_ptp.parameters.view.control_view import (
    ControlParameters,
    DriveParameters,
    DriveScaling,
    FeedforwardParameters,
    FrictionParameters,
    LagMonitoring,
    ModuloError,
    PlantParameters,
)

T, TA, KV = 0.001, 0.003, 50.0
V_MAX, A_MAX, J_MAX = 500.0, 4000.0, 50_000.0
LIMITS = CouplingLimits(V_MAX, A_MAX, J_MAX)
INERTIA = 6.0e-4
"""Nm for 1 mm/s²."""
VEL, ACC, JERK, ADD_VEL, ADD_ACC, ADD_JERK = 0x001, 0x002, 0x004, 0x101, 0x202, 0x804
"""Values of P-AXIS-00223 as the manual has them."""

MotionState = tuple[float, float, float, float]
Phase = tuple[int, float]
"""Cycles, jerk."""

EVERYTHING = frozenset({"velocity", "position", "torque", "lag", "additive_velocity", "additive_torque"})
OFF = FeedforwardParameters(
    mode=0,
    weight=1.0,
    velocity_weight=1.0,
    time_constant=TA,
    torque_weight=1.0,
    jerk_weight=0.01,
    velocity_delay=0.0,
    acceleration_delay=0.0,
    lead_cycles=0,
    prefilter_cycles=1,
    always_active=False,
)
NO_FRICTION = FrictionParameters(
    permitted=False,
    active=False,
    velocities=(),
    currents=(),
    position_delay=0.0,
    reversal_lookahead=0,
    delay_cycles=0,
)
NO_MONITORING = LagMonitoring(kind=0, moving_limit=10.0, standstill_limit=2.0, dynamic=1000, filter_time=0.0)
PLANT = PlantParameters(
    cascaded=False,
    time_constant=TA,
    torque_per_acceleration=INERTIA,
    velocity_gain=500.0,
    velocity_integral_time=0.004,
    current_time_constant=0.0,
    torque_limit=float("inf"),
    coulomb=0.0,
    static=0.0,
    stribeck_velocity=1.0,
    viscous=0.0,
    backlash=0.0,
    encoder_at_load=True,
    bus_delay_cycles=0,
    kv=KV,
    encoder_increment=0.0,
    start_position=0.0,
)


class BlockedDrive(Drive):
    """A drive that does not move, whatever it is commanded."""

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        pass


def feedforward(mode: int, **changes: Any) -> FeedforwardParameters:
    return replace(OFF, mode=mode, **changes)


def control(
    *,
    kv: float = KV,
    interface: str = "velocity",
    of_feedforward: FeedforwardParameters = OFF,
    friction: FrictionParameters = NO_FRICTION,
    monitoring: LagMonitoring = NO_MONITORING,
    modulo_error: ModuloError | None = None,
    plant: PlantParameters = PLANT,
    torque_scale: float = 1.0,
) -> ControlParameters:
    return ControlParameters(
        kv=kv,
        monitoring=monitoring,
        drive=DriveParameters(
            kind=4,
            interface=interface,
            commands=EVERYTHING,
            feedback=frozenset({"position", "velocity", "torque"}),
            analogue=False,
            ideal=True,
            reverse=False,
            velocity_gain=300.0,
            velocity_integral_time=0.0,
        ),
        scaling=DriveScaling(
            position=10_000.0,
            velocity=1.0,
            torque=torque_scale,
            analogue=1.0,
            torque_per_acceleration=INERTIA,
        ),
        feedforward=of_feedforward,
        friction=friction,
        modulo_error=modulo_error or ModuloError(0.0, 0.0, 0.0),
        plant=plant,
    )


def first_order(time_constant: float = TA, start: float = 0.0) -> FirstOrderDrive:
    return FirstOrderDrive(
        cycle_time=T,
        time_constant=time_constant,
        encoder_increment=0.0,
        start_position=start,
        torque_per_acceleration=INERTIA,
    )


def make_loop(
    parameters: ControlParameters, drive: Drive | None = None, limits: CouplingLimits = LIMITS
) -> ControlLoop:
    return ControlLoop(parameters, cycle_time=T, limits=limits, drive=drive or first_order())


def loop_with(mode: int, *, on: bool = True, time_constant: float = TA, **changes: Any) -> ControlLoop:
    """A loop around a first-order drive with a feedforward that is in full effect from the start."""
    of_loop = {name: changes.pop(name) for name in ("kv", "interface", "friction") if name in changes}
    parameters = control(of_feedforward=feedforward(mode, always_active=on, **changes), **of_loop)
    return make_loop(parameters, first_order(time_constant))


def motion(phases: Iterable[Phase], start: float = 0.0) -> list[MotionState]:
    """Setpoints of phases of constant jerk, each state in closed form from the start of its phase."""
    states: list[MotionState] = []
    x, v, a = start, 0.0, 0.0
    for cycles, j in phases:
        for t in (n * T for n in range(cycles)):
            states.append((x + v * t + a * t**2 / 2 + j * t**3 / 6, v + a * t + j * t**2 / 2, a + j * t, j))
        t = cycles * T
        x, v, a = x + v * t + a * t**2 / 2 + j * t**3 / 6, v + a * t + j * t**2 / 2, a + j * t
        v, a = (0.0 if abs(value) < 1e-9 else value for value in (v, a))
    return states


def trapezoid(jerk: float, rise: int, hold: int, cruise: int, rest: int = 300, sign: float = 1.0) -> list[Phase]:
    """Acceleration `jerk`·`rise` for `hold` cycles, cruise, the same back to rest; all in cycles."""
    j = sign * jerk
    return [(rise, j), (hold, 0.0), (rise, -j), (cruise, 0.0), (rise, -j), (hold, 0.0), (rise, j), (rest, 0.0)]


def run(loop: ControlLoop, setpoints: Sequence[MotionState], *, closed: bool = True) -> list[ControlCycle]:
    return [loop.step(setpoint, closed) for setpoint in setpoints]


def lags(cycles: Sequence[ControlCycle]) -> NDArray[np.float64]:
    return np.array([cycle.following_error for cycle in cycles])


def column(cycles: Sequence[ControlCycle], name: str) -> NDArray[np.float64]:
    return np.array([getattr(cycle, name) for cycle in cycles])
