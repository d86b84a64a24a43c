"""An axis as the kernel uses it, in the gear after start-up."""

import math
from dataclasses import dataclass

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.control_view import ControlParameters, control_view
from cnc_ptp.parameters.view.encoder import encoder_increment

VIRTUAL_AXIS = 16
MODULO, MODULO_LINEAR = 0x4, 0x400
"""Bits of P-AXIS-00015; the second one is for linear axes."""
SOFT_LIMITS = (ids.KENNGR_SWE_NEG, ids.KENNGR_SWE_POS)


@dataclass(frozen=True, slots=True)
class AxisParameters:
    """A linear (mm) or rotary (°) axis. Velocities per second, accelerations per s², jerk per s³, times in s."""

    name: str
    number: int
    rotary: bool
    modulo: bool
    """A turntable or a conveyor: it counts on without an end, also from modulo_low to modulo_high, mm (°).

    Then the soft limits are infinite.
    """
    modulo_low: float
    modulo_high: float
    virtual: bool
    """Has no drive (P-AXIS-00020 = 16)."""
    max_velocity: float
    rapid_velocity: float
    reference_velocity: float
    """A PTP start with more is refused."""
    max_acceleration: float
    acceleration: float
    deceleration: float
    emergency_deceleration: float
    jerk: float
    soft_limit_negative: float
    soft_limit_positive: float
    position_window: float
    encoder_increment: float
    """mm or ° an increment; 0.0 is an ideal measuring system."""
    override_type: int
    """PTP override: 1 reduced, 2 original, 3 and 4 the same iterated."""
    override_steps: int
    """Override filter: steps from 0 to 100 %, 0 = no filter …"""
    override_interval: float
    """… and the least time between two of them."""
    max_override_percent: float
    external_dead_time: float
    external_timeout: float
    """Longest silence of external setpoints in motion."""
    target_time: float
    """In which the actual position must have come into the position window; 0 = not monitored."""
    error_propagation_delayed: bool
    """An error reaches the other axes of the master/slave group only after error_propagation_delay."""
    error_propagation_delay: float
    couple_to_actual: bool
    """Slaves follow the actual values of this axis while it has no enable or a delayed error."""
    velocity_window: float
    """An actual velocity below it is 0 for slaves."""
    velocity_filter_time: float
    powered_at_start: bool
    referenced_at_start: bool
    start_position: float
    control: ControlParameters


def axis_view(parameters: ParameterSet, cycle_time: float) -> AxisParameters:
    gear = active_gear(parameters)
    rotary = parameters.axis_type == "R"
    modulo = is_modulo(parameters)
    max_velocity = parameters.kernel(ids.DYNAMIK_VB_MAX, gear)
    return AxisParameters(
        name=parameters.node,
        number=int(parameters.number(ids.KOPF_ACHS_NR)),
        rotary=rotary,
        modulo=modulo,
        modulo_low=parameters.kernel(ids.GETRIEBE_MODULOU, gear) if modulo else 0.0,
        modulo_high=parameters.kernel(ids.GETRIEBE_MODULOO, gear) if modulo else 0.0,
        virtual=int(parameters.number(ids.KENNGR_ANTR_TYP)) == VIRTUAL_AXIS,
        max_velocity=max_velocity,
        rapid_velocity=parameters.kernel(ids.GETRIEBE_VB_EILGANG, gear),
        reference_velocity=parameters.kernel(ids.PTP_REFERENCE_VELOCITY) or max_velocity,
        max_acceleration=parameters.kernel(ids.DYNAMIK_A_MAX, gear),
        acceleration=parameters.kernel(ids.SLOPE_PROFIL_A_BESCHL, gear),
        deceleration=parameters.kernel(ids.SLOPE_PROFIL_A_BREMS, gear),
        emergency_deceleration=emergency_deceleration(parameters, gear),
        jerk=jerk(parameters, gear),
        soft_limit_negative=-math.inf if modulo else parameters.kernel(ids.KENNGR_SWE_NEG),
        soft_limit_positive=math.inf if modulo else parameters.kernel(ids.KENNGR_SWE_POS),
        position_window=parameters.kernel(ids.GETRIEBE_WINDOW, gear),
        encoder_increment=encoder_increment(parameters, gear),
        override_type=int(parameters.number(ids.PTP_OVERRIDE_TYPE)),
        override_steps=int(parameters.number(ids.PTP_OVERRIDE_STEPS)),
        override_interval=parameters.number(ids.PTP_OVERRIDE_INTERVAL_MS) / 1000.0,
        max_override_percent=parameters.percent(ids.KENNGR_MAX_VB_OVERRIDE),
        external_dead_time=parameters.kernel(ids.PTP_EXTERNAL_DEAD_TIME),
        external_timeout=parameters.number(ids.PTP_EXTERNAL_TIMEOUT_MS) / 1000.0,
        target_time=parameters.number(ids.PTP_TARGET_TIME_MS) / 1000.0,
        error_propagation_delayed=bool(parameters.number(ids.COUPLING_ERROR_PROPAGATION_MODE)),
        error_propagation_delay=parameters.number(ids.COUPLING_ERROR_PROPAGATION_DELAY_MS) / 1000.0,
        couple_to_actual=bool(parameters.number(ids.COUPLING_COUPLE_TO_ACTUAL)),
        velocity_window=parameters.kernel(ids.COUPLING_VELOCITY_WINDOW),
        velocity_filter_time=parameters.kernel(ids.COUPLING_VELOCITY_FILTER_TIME),
        powered_at_start=bool(parameters.number(ids.SIMULATION_POWERED_AT_START)),
        referenced_at_start=bool(parameters.number(ids.SIMULATION_REFERENCED_AT_START)),
        start_position=parameters.kernel(ids.SIMULATION_START_POSITION),
        control=control_view(parameters, gear, cycle_time),
    )


def active_gear(parameters: ParameterSet) -> int:
    """Index of the gear record in use after start-up."""
    return int(parameters.number(ids.KENNGR_GETRIEBE_STUFE)) - 1


def jerk(parameters: ParameterSet, gear: int) -> float:
    """J = a_beschl / tr_beschl_zu, in mm/s³ or °/s³."""
    return (
        parameters.number(ids.SLOPE_PROFIL_A_BESCHL, gear)
        * 1_000_000
        / parameters.number(ids.SLOPE_PROFIL_TR_BESCHL_ZU, gear)
    )


def emergency_deceleration(parameters: ParameterSet, gear: int) -> float:
    return parameters.kernel(ids.DYNAMIK_A_EMERGENCY, gear) or parameters.kernel(ids.DYNAMIK_A_MAX, gear)


def is_modulo(parameters: ParameterSet) -> bool:
    bits = MODULO | MODULO_LINEAR if parameters.axis_type == "T" else MODULO
    return bool(int(parameters.number(ids.KENNGR_ACHS_MODE)) & bits)
