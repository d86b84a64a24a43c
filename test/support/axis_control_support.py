"""Axes with feedforward, friction compensation and any drive: 500 mm/s, 4 m/s², 50 m/s³, Kv 50/s."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from loop_support import A_MAX, ACC, ADD_ACC, ADD_VEL, INERTIA, J_MAX, NO_FRICTION, PLANT, V_MAX, control, feedforward
from machine_support import CYCLE_TIME, UnitBench, axis_parameters

from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.control.drives import Drive
from cnc_ptp.parameters import AxisParameters
from cnc_ptp.parameters.view.control_view import ControlParameters, PlantParameters

MECHANICS = replace(PLANT, cascaded=True, coulomb=0.3, static=0.5, stribeck_velocity=2.0, viscous=1e-3)
COMPENSATED = replace(
    NO_FRICTION,
    permitted=True,
    active=True,
    velocities=(0.0, 2.0, 100.0),
    currents=(0.5, 0.35, 0.4),
    position_delay=0.002,
    reversal_lookahead=2,
)
BOTH = ADD_VEL | ADD_ACC
MOVE = {"velocity": 200.0, "acceleration": 2000.0, "deceleration": 2000.0, "jerk": 40_000.0}


def control_of(interface: str = "velocity", plant: PlantParameters | None = None, **changes: Any) -> ControlParameters:
    """By default everything at once: additive feedforward, friction compensation, the mechanics with friction."""
    changes = {"of_feedforward": feedforward(BOTH), "friction": COMPENSATED} | changes
    parameters = control(interface=interface, plant=plant or MECHANICS, **changes)
    return replace(parameters, drive=replace(parameters.drive, velocity_integral_time=0.02))


def parameters_of(control: ControlParameters, **changes: Any) -> AxisParameters:
    dynamics = {"max_velocity": V_MAX, "max_acceleration": A_MAX, "jerk": J_MAX, "deceleration": 3000.0}
    return replace(axis_parameters(**dynamics), control=control, **changes)


def control_bench(
    control: ControlParameters | None = None, *, count: int = 10, drive: Drive | None = None, **changes: Any
) -> UnitBench:
    parameters = parameters_of(control or control_of(), **changes)
    return UnitBench(AxisUnit(parameters, cycle_time=CYCLE_TIME, drive=drive), count=count)


def plain_control(mode: int = 0, **changes: Any) -> ControlParameters:
    """A first-order drive without friction, conventional feedforward."""
    return control_of(plant=PLANT, of_feedforward=feedforward(mode), friction=NO_FRICTION, **changes)


def move(bench: UnitBench, target: float, **dynamics: float) -> None:
    assert bench.accepted("move_absolute", target=target, **{**MOVE, **dynamics}) == ""


CONVENTIONAL = 0x1 | ACC
TORQUE_OF = INERTIA
"""Nm for 1 mm/s²."""
NO_LIMIT = math.inf
