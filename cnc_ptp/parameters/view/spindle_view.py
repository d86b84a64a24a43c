"""A spindle as the kernel uses it: parameters that all gears share, and one record per gear stage."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, NamedTuple

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.control_view import ControlParameters, control_view
from cnc_ptp.parameters.view.fields import given_fields
from cnc_ptp.parameters.view.gears import active_gear, emergency_deceleration, gear_records
from cnc_ptp.parameters.view.telegram import DriveType, is_open_loop

NO_AUTOMATIC_HOMING = 0x100
EXTERNALLY_CONTROLLED = 0x40000
CONTROL_LIMIT_DRIVES = (
    DriveType.CONVENTIONAL,
    DriveType.PROFIDRIVE,
    DriveType.SIMULATION,
    DriveType.LIGHTBUS,
    DriveType.TERMINAL,
)
"""Drive types (P-AXIS-00020) for which P-AXIS-00220 exists; the others monitor their measuring system themselves."""
OPEN_LOOP_FEEDBACK = {
    "OPEN_POSITION_LOOP_POS_FEEDBACK": "POSITION",
    "OPEN_POSITION_LOOP_VEL_FEEDBACK": "SPEED",
    "OPEN_POSITION_LOOP_NO_FEEDBACK": "NONE",
}
CURVE_TYPES = {1: "hyperbola", 2: "polynomial", 3: "asynchronous"}


class CurveParameters(NamedTuple):
    """An acceleration curve a(n), n in °/s, a in °/s² (TF5200 spindle 2.8.4)."""

    kind: str
    """hyperbola, polynomial or asynchronous."""
    minimum: Annotated[float, ids.BESCHL_KENNLINIE_A_MIN]
    """Floor of the whole curve."""
    limit_speed: Annotated[float, ids.BESCHL_KENNLINIE_N_GRENZ]
    """Below it hyperbola and polynomial have constant acceleration."""
    constant: Annotated[float, ids.BESCHL_KENNLINIE_A_KONST]
    b1: Annotated[float, ids.BESCHL_KENNLINIE_B1]
    b2: Annotated[float, ids.BESCHL_KENNLINIE_B2]
    b3: Annotated[float, ids.BESCHL_KENNLINIE_B3]
    maximum: Annotated[float, ids.BESCHL_KENNLINIE_A_MAX]
    """Acceleration of an asynchronous drive below n1."""
    n1: Annotated[float, ids.BESCHL_KENNLINIE_N1]
    n2: Annotated[float, ids.BESCHL_KENNLINIE_N2]


@dataclass(frozen=True, slots=True)
class GearParameters:
    """Parameters of a gear stage. Positions in °, speeds in °/s, accelerations in °/s²."""

    stage: int
    max_speed: Annotated[float, ids.DYNAMIK_VB_MAX]
    positioning_speed: Annotated[float, ids.GETRIEBE_VB_EILGANG]
    """Rapid traverse: M19 without a speed, and the motion to the change position."""
    max_acceleration: Annotated[float, ids.DYNAMIK_A_MAX]
    acceleration: Annotated[float, ids.SLOPE_PROFIL_A_BESCHL]
    deceleration: Annotated[float, ids.SLOPE_PROFIL_A_BREMS]
    emergency_deceleration: float
    curve: CurveParameters | None
    """In place of acceleration and deceleration in endless rotation."""
    zero_speed: Annotated[float, ids.GETRIEBE_VB_MIN_NULL]
    """Below this actual speed the spindle is at a standstill."""
    control_limit: float
    """Above it the measuring system fails; infinite if there is no such limit."""
    change_position: Annotated[float, ids.GETRIEBE_GETR_SCHALT_POS]
    reference_position: Annotated[float, ids.GETRIEBE_POS_REFPKT]
    """Of the zero pulse."""
    homing_speed: Annotated[float, ids.GETRIEBE_VB_REFLOW]
    modulo_low: Annotated[float, ids.GETRIEBE_MODULOU]
    modulo_high: Annotated[float, ids.GETRIEBE_MODULOO]
    position_window: Annotated[float, ids.GETRIEBE_WINDOW]
    control: ControlParameters
    """Position control and drive."""


@dataclass(frozen=True, slots=True)
class SpindleParameters:
    """A spindle. Speeds in °/s, times in s."""

    name: str
    number: Annotated[int, ids.KOPF_ACHS_NR]
    drive_type: Annotated[int, ids.KENNGR_ANTR_TYP]
    plc_controlled: bool
    """The PLC controls it; the NC gets only acknowledgements (P-AXIS-00015 0x40000)."""
    automatic_homing: bool
    """Homes automatically before M19; otherwise M19 without reference is an error (P-AXIS-00015 0x100)."""
    open_loop: bool
    """Under position control for positioning and homing only, if at all (P-AXIS-00320)."""
    feedback: str
    """Actual value that the drive sends: POSITION, SPEED or NONE."""
    path_gear: Annotated[int, ids.KENNGR_CAX_GEAR_STAGE]
    """Gear stage as an axis of the path; 0: any."""
    speed_reached_band: Annotated[float, ids.KENNGR_VB_PROZENT]
    """Speed reached within (1 ± band) times the commanded speed."""
    preferred_direction: int
    """+1 or -1 where only that direction is permitted (P-AXIS-00224), 0 otherwise."""
    velocity_control_on: Annotated[float, ids.ANTR_VELOCITY_POSITION_CONTROL_ON]
    """A speed command above it switches the drive to velocity control …"""
    velocity_control_off: Annotated[float, ids.ANTR_VELOCITY_POSITION_CONTROL_OFF]
    """… and this is the actual speed at which it is switched back."""
    gear: int
    """Gear stage at start, from 1."""
    gears: Mapping[int, GearParameters]
    """By stage: those in the machine file, and the one at start."""
    stops_at_reset: bool
    target_time: Annotated[float, ids.PTP_TARGET_TIME_MS]
    """Time within which the actual position must be in the window after M19; 0 = not monitored."""
    settling_time: Annotated[float, ids.MONITORING_SETTLING_TIME_MS]
    """Time for which position and speed must be in their windows before M19 is finished."""
    speed_time: Annotated[float, ids.MONITORING_SPEED_TIME_MS]
    """Time within which the actual speed must be in its band in endless rotation; 0 = not monitored."""
    gear_change_time: Annotated[float, ids.GEAR_CHANGE_TIME_MS]
    """Time within which the PLC must acknowledge a gear change; 0 = no limit."""
    zero_pulse: Annotated[float, ids.SIMULATION_ZERO_PULSE]
    max_override_percent: float
    powered_at_start: Annotated[bool, ids.SIMULATION_POWERED_AT_START]
    referenced_at_start: bool
    start_position: Annotated[float, ids.SIMULATION_START_POSITION]

    @property
    def has_position(self) -> bool:
        """False: it can be neither homed nor positioned."""
        return self.feedback == "POSITION"


def spindle_view(parameters: ParameterSet, cycle_time: float) -> SpindleParameters:
    """`cycle_time` in s."""
    mode = int(parameters.number(ids.KENNGR_ACHS_MODE))
    return SpindleParameters(
        name=parameters.node,
        plc_controlled=bool(mode & EXTERNALLY_CONTROLLED),
        automatic_homing=not mode & NO_AUTOMATIC_HOMING,
        open_loop=is_open_loop(parameters),
        feedback=feedback(parameters),
        preferred_direction=preferred_direction(parameters),
        gear=active_gear(parameters) + 1,
        gears={gear + 1: gear_view(parameters, gear, cycle_time) for gear in gear_records(parameters)},
        stops_at_reset=not parameters.number(ids.KENNGR_NO_STOP_BY_CHANNEL_RESET),
        max_override_percent=parameters.percent(ids.KENNGR_MAX_VB_OVERRIDE),
        referenced_at_start=has_position(parameters) and bool(parameters.number(ids.SIMULATION_REFERENCED_AT_START)),
        **given_fields(SpindleParameters, parameters),
    )


def gear_view(parameters: ParameterSet, gear: int, cycle_time: float) -> GearParameters:
    """The record getriebe[gear]; `cycle_time` in s."""
    return GearParameters(
        stage=gear + 1,
        emergency_deceleration=emergency_deceleration(parameters, gear),
        curve=curve_view(parameters, gear),
        control_limit=control_limit(parameters, gear),
        control=control_view(parameters, gear, cycle_time),
        **given_fields(GearParameters, parameters, gear),
    )


def curve_view(parameters: ParameterSet, gear: int) -> CurveParameters | None:
    kind = int(parameters.number(ids.BESCHL_KENNLINIE_TYP, gear))
    if kind not in CURVE_TYPES:
        return None
    return CurveParameters(kind=CURVE_TYPES[kind], **given_fields(CurveParameters, parameters, gear))


def control_limit(parameters: ParameterSet, gear: int) -> float:
    """P-AXIS-00220 if the drive type has it, infinity for 0 and the other types."""
    if parameters.number(ids.KENNGR_ANTR_TYP) not in CONTROL_LIMIT_DRIVES:
        return math.inf
    return parameters.kernel(ids.GETRIEBE_VB_REGELGRENZE, gear) or math.inf


def feedback(parameters: ParameterSet) -> str:
    """POSITION, SPEED or NONE: from the operation mode, else from the telegram of the drive."""
    return OPEN_LOOP_FEEDBACK.get(parameters.text(ids.ANTR_OPERATION_MODE), parameters.text(ids.SIMULATION_TELEGRAM))


def has_position(parameters: ParameterSet) -> bool:
    """False: the spindle can be neither homed nor positioned."""
    return feedback(parameters) == "POSITION"


def preferred_direction(parameters: ParameterSet) -> int:
    if not parameters.number(ids.KENNGR_VORZ_RICHTUNG):
        return 0
    return 1 if parameters.number(ids.KENNGR_BEWEG_RICHT) else -1
