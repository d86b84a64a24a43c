"""An axis as the kernel uses it, in the gear after start-up."""

import math
from dataclasses import dataclass, field, replace
from typing import Annotated

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.control_view import ControlParameters, control_view
from cnc_ptp.parameters.view.encoder import encoder_increment
from cnc_ptp.parameters.view.fields import given_fields
from cnc_ptp.parameters.view.gears import active_gear, emergency_deceleration
from cnc_ptp.parameters.view.homing_view import HomingParameters, homing_view
from cnc_ptp.parameters.view.probe_view import ProbeParameters, probe_view
from cnc_ptp.parameters.view.sercos_view import sercos_view
from cnc_ptp.parameters.view.telegram import DriveType

MODULO, MODULO_LINEAR = 0x4, 0x400
"""Bits of P-AXIS-00015; the second one is for linear axes."""
FACING = 0x40
"""Bit of P-AXIS-00015."""
SOFT_LIMITS = (ids.KENNGR_SWE_NEG, ids.KENNGR_SWE_POS)


@dataclass(frozen=True, slots=True)
class AxisParameters:
    """A linear (mm) or rotary (°) axis. Velocities per second, accelerations per s², jerk per s³, times in s."""

    name: str
    number: Annotated[int, ids.KOPF_ACHS_NR]
    rotary: bool
    modulo: bool
    """A turntable or conveyor: its position is counted without end, and also from modulo_low to modulo_high, mm (°).

    Then the soft limits are infinite.
    """
    facing: bool
    """The facing axis of a lathe (P-AXIS-00015 0x40) …"""
    diameter_absolute: Annotated[bool, ids.KENNGR_DURCHM_PROG_ABS]
    """… whose words are diameters with G51 and G90 …"""
    diameter_relative: Annotated[bool, ids.KENNGR_DURCHM_PROG_REL]
    """… and with G51 and G91."""
    modulo_low: float
    modulo_high: float
    virtual: bool
    """Has no drive (P-AXIS-00020 = 16)."""
    max_velocity: Annotated[float, ids.DYNAMIK_VB_MAX]
    rapid_velocity: Annotated[float, ids.GETRIEBE_VB_EILGANG]
    reference_velocity: float
    """A PTP start with a larger velocity is refused."""
    max_acceleration: Annotated[float, ids.DYNAMIK_A_MAX]
    acceleration: Annotated[float, ids.SLOPE_PROFIL_A_BESCHL]
    deceleration: Annotated[float, ids.SLOPE_PROFIL_A_BREMS]
    emergency_deceleration: float
    jerk: float
    soft_limit_negative: float
    soft_limit_positive: float
    position_window: Annotated[float, ids.GETRIEBE_WINDOW]
    encoder_increment: float
    """mm or ° per increment; 0.0 is an ideal measuring system."""
    override_type: Annotated[int, ids.PTP_OVERRIDE_TYPE]
    """PTP override: 1 reduced, 2 original, 3 and 4 the same iterated."""
    override_steps: Annotated[int, ids.PTP_OVERRIDE_STEPS]
    """Override filter: steps from 0 to 100 %, 0 = no filter …"""
    override_interval: Annotated[float, ids.PTP_OVERRIDE_INTERVAL_MS]
    """… and the least time between two of them."""
    max_override_percent: float
    external_dead_time: Annotated[float, ids.PTP_EXTERNAL_DEAD_TIME]
    external_timeout: Annotated[float, ids.PTP_EXTERNAL_TIMEOUT_MS]
    """Longest silence of external setpoints in motion."""
    target_time: Annotated[float, ids.PTP_TARGET_TIME_MS]
    """Time within which the actual position must be in the position window; 0 = not monitored."""
    error_propagation_delayed: Annotated[bool, ids.COUPLING_ERROR_PROPAGATION_MODE]
    """An error reaches the other axes of the master/slave group only after error_propagation_delay."""
    error_propagation_delay: Annotated[float, ids.COUPLING_ERROR_PROPAGATION_DELAY_MS]
    couple_to_actual: Annotated[bool, ids.COUPLING_COUPLE_TO_ACTUAL]
    """Slaves follow the actual values of this axis while it has no enable or a delayed error."""
    velocity_window: Annotated[float, ids.COUPLING_VELOCITY_WINDOW]
    """An actual velocity below it is 0 for slaves."""
    velocity_filter_time: Annotated[float, ids.COUPLING_VELOCITY_FILTER_TIME]
    powered_at_start: Annotated[bool, ids.SIMULATION_POWERED_AT_START]
    referenced_at_start: Annotated[bool, ids.SIMULATION_REFERENCED_AT_START]
    start_position: float
    """As the axis counts it: 0 for one that is not referenced."""
    homing: HomingParameters
    probe: ProbeParameters
    control: ControlParameters
    channel: str = ""
    """The channel whose path has the axis; empty: only the PLC moves it."""
    raw: ParameterSet | None = field(default=None, repr=False, compare=False)
    """All parameters of the axis in list units, of which the others are made."""


def axis_view(parameters: ParameterSet, cycle_time: float) -> AxisParameters:
    """`cycle_time` in s."""
    gear = active_gear(parameters)
    modulo = is_modulo(parameters)
    ends = (ids.GETRIEBE_MODULOU, ids.GETRIEBE_MODULOO) if modulo else SOFT_LIMITS
    low, high = parameters.kernel(ends[0], gear), parameters.kernel(ends[1], gear)
    homing = homing_view(parameters, gear, high - low)
    return AxisParameters(
        name=parameters.node,
        rotary=parameters.axis_type == "R",
        modulo=modulo,
        facing=is_facing(parameters),
        modulo_low=low if modulo else 0.0,
        modulo_high=high if modulo else 0.0,
        virtual=parameters.number(ids.KENNGR_ANTR_TYP) == DriveType.VIRTUAL,
        reference_velocity=parameters.kernel(ids.PTP_REFERENCE_VELOCITY) or parameters.kernel(ids.DYNAMIK_VB_MAX, gear),
        emergency_deceleration=emergency_deceleration(parameters, gear),
        jerk=jerk(parameters, gear),
        soft_limit_negative=-math.inf if modulo else low,
        soft_limit_positive=math.inf if modulo else high,
        encoder_increment=encoder_increment(parameters, gear),
        max_override_percent=parameters.percent(ids.KENNGR_MAX_VB_OVERRIDE),
        start_position=start_position(parameters),
        homing=homing,
        probe=probe_view(parameters),
        control=control_of_axis(parameters, homing, gear, cycle_time),
        raw=parameters,
        **given_fields(AxisParameters, parameters, gear),
    )


def control_of_axis(
    parameters: ParameterSet, homing: HomingParameters, gear: int, cycle_time: float
) -> ControlParameters:
    """With what a SERCOS drive knows of its axis."""
    control = control_view(parameters, gear, cycle_time)
    if parameters.number(ids.KENNGR_ANTR_TYP) != DriveType.SERCOS:
        return control
    of_drive = sercos_view(
        parameters,
        homing,
        acceleration=parameters.kernel(ids.SLOPE_PROFIL_A_BESCHL, gear),
        jerk=jerk(parameters, gear),
        position_window=parameters.kernel(ids.GETRIEBE_WINDOW, gear),
    )
    return replace(control, sercos=of_drive)


def start_position(parameters: ParameterSet) -> float:
    """P-SIM-00003; an encoder that is not absolute counts from 0 (P-SIM-00005)."""
    referenced = parameters.number(ids.SIMULATION_REFERENCED_AT_START)
    return parameters.kernel(ids.SIMULATION_START_POSITION) if referenced else 0.0


def jerk(parameters: ParameterSet, gear: int) -> float:
    """J = a_beschl / tr_beschl_zu, in mm/s³ or °/s³."""
    ramp_time_us = parameters.number(ids.SLOPE_PROFIL_TR_BESCHL_ZU, gear)
    return parameters.number(ids.SLOPE_PROFIL_A_BESCHL, gear) * 1_000_000 / ramp_time_us


def is_facing(parameters: ParameterSet) -> bool:
    """The facing axis of a lathe (P-AXIS-00015)."""
    return bool(int(parameters.number(ids.KENNGR_ACHS_MODE)) & FACING)


def is_modulo(parameters: ParameterSet) -> bool:
    """A turntable or a conveyor (P-AXIS-00015)."""
    bits = MODULO | MODULO_LINEAR if parameters.axis_type == "T" else MODULO
    return bool(int(parameters.number(ids.KENNGR_ACHS_MODE)) & bits)
