"""A spindle as the kernel uses it: what all gears share, and one record a gear stage."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.control_view import ControlParameters, control_view

NO_AUTOMATIC_HOMING = 0x100
EXTERNALLY_CONTROLLED = 0x40000
CONTROL_LIMIT_DRIVES = (1, 3, 4, 5, 6)
"""Drive types (P-AXIS-00020) for which P-AXIS-00220 exists; the others watch their measuring system themselves."""
OPEN_LOOP_FEEDBACK = {
    "OPEN_POSITION_LOOP_POS_FEEDBACK": "POSITION",
    "OPEN_POSITION_LOOP_VEL_FEEDBACK": "SPEED",
    "OPEN_POSITION_LOOP_NO_FEEDBACK": "NONE",
}
COEFFICIENTS = (ids.BESCHL_KENNLINIE_B1, ids.BESCHL_KENNLINIE_B2, ids.BESCHL_KENNLINIE_B3)
"""Of a hyperbola or polynomial: b1, b2, b3."""
CURVE_TYPES = {1: "hyperbola", 2: "polynomial", 3: "asynchronous"}


class CurveParameters(NamedTuple):
    """An acceleration curve a(n), n in °/s, a in °/s² (TF5200 spindle 2.8.4)."""

    kind: str
    """hyperbola, polynomial or asynchronous."""
    minimum: float
    """Floor of the whole curve."""
    limit_speed: float
    """Below it hyperbola and polynomial have constant acceleration."""
    constant: float
    b1: float
    b2: float
    b3: float
    maximum: float
    """Acceleration of an asynchronous drive below n1."""
    n1: float
    n2: float


@dataclass(frozen=True, slots=True)
class GearParameters:
    """What depends on the gear stage. Positions in °, speeds in °/s, accelerations in °/s²."""

    stage: int
    max_speed: float
    positioning_speed: float
    """Rapid traverse: M19 without a speed, and the way to the change position."""
    max_acceleration: float
    acceleration: float
    deceleration: float
    emergency_deceleration: float
    curve: CurveParameters | None
    """In place of acceleration and deceleration in endless rotation."""
    zero_speed: float
    """Below this actual speed the spindle stands."""
    control_limit: float
    """Above it the measuring system fails; infinite where there is no such limit."""
    change_position: float
    reference_position: float
    """Of the zero pulse."""
    homing_speed: float
    modulo_low: float
    modulo_high: float
    position_window: float
    control: ControlParameters
    """Position control and drive."""


@dataclass(frozen=True, slots=True)
class SpindleParameters:
    """A spindle. Speeds in °/s, times in s."""

    name: str
    number: int
    drive_type: int
    plc_controlled: bool
    """The PLC controls it; the NC gets nothing but acknowledgements (P-AXIS-00015 0x40000)."""
    automatic_homing: bool
    """Homes by itself before M19; otherwise M19 without reference is an error (P-AXIS-00015 0x100)."""
    open_loop: bool
    """Under position control for positioning and homing only, if at all (P-AXIS-00320)."""
    feedback: str
    """What the drive sends: POSITION, SPEED or NONE."""
    speed_reached_band: float
    """Speed reached within (1 ± band) times the commanded speed."""
    preferred_direction: int
    """+1 or -1 where only that direction is permitted (P-AXIS-00224), 0 otherwise."""
    velocity_control_on: float
    """A speed command above it switches the drive to velocity control …"""
    velocity_control_off: float
    """… and this is the actual speed at which it is switched back."""
    gear: int
    """Gear stage at start, from 1."""
    gears: Mapping[int, GearParameters]
    """By stage: those the machine file describes, and the one at start."""
    stops_at_reset: bool
    target_time: float
    """In which the actual position must have come into the window after M19; 0 = not monitored."""
    settling_time: float
    """For which position and speed must have been in their windows before M19 is reached."""
    speed_time: float
    """The same for the speed of endless rotation."""
    gear_change_time: float
    """In which the PLC must have acknowledged a gear change; 0 = for ever."""
    zero_pulse: float
    max_override_percent: float
    powered_at_start: bool
    referenced_at_start: bool
    start_position: float

    @property
    def max_speed_deg_s(self) -> float:
        """The largest speed of all gears."""
        return max(gear.max_speed for gear in self.gears.values())

    @property
    def has_position(self) -> bool:
        """False: it can be neither homed nor positioned."""
        return self.feedback == "POSITION"


def spindle_view(parameters: ParameterSet, cycle_time: float) -> SpindleParameters:
    """`cycle_time` in s."""
    mode = int(parameters.number(ids.KENNGR_ACHS_MODE))
    stage = int(parameters.number(ids.KENNGR_GETRIEBE_STUFE))
    stages = sorted({stage, *(index + 1 for index in parameters.used_indexes("getriebe"))})
    return SpindleParameters(
        name=parameters.node,
        number=int(parameters.number(ids.KOPF_ACHS_NR)),
        drive_type=int(parameters.number(ids.KENNGR_ANTR_TYP)),
        plc_controlled=bool(mode & EXTERNALLY_CONTROLLED),
        automatic_homing=not mode & NO_AUTOMATIC_HOMING,
        open_loop=is_open_loop(parameters),
        feedback=feedback(parameters),
        speed_reached_band=parameters.kernel(ids.KENNGR_VB_PROZENT),
        preferred_direction=preferred_direction(parameters),
        velocity_control_on=parameters.kernel(ids.ANTR_VELOCITY_POSITION_CONTROL_ON),
        velocity_control_off=parameters.kernel(ids.ANTR_VELOCITY_POSITION_CONTROL_OFF),
        gear=stage,
        gears={stage: gear_view(parameters, stage - 1, cycle_time) for stage in stages},
        stops_at_reset=not parameters.number(ids.KENNGR_NO_STOP_BY_CHANNEL_RESET),
        target_time=parameters.number(ids.PTP_TARGET_TIME_MS) / 1000.0,
        settling_time=parameters.number(ids.MONITORING_SETTLING_TIME_MS) / 1000.0,
        speed_time=parameters.number(ids.MONITORING_SPEED_TIME_MS) / 1000.0,
        gear_change_time=parameters.number(ids.GEAR_CHANGE_TIME_MS) / 1000.0,
        zero_pulse=parameters.kernel(ids.SIMULATION_ZERO_PULSE),
        max_override_percent=parameters.percent(ids.KENNGR_MAX_VB_OVERRIDE),
        powered_at_start=bool(parameters.number(ids.SIMULATION_POWERED_AT_START)),
        referenced_at_start=bool(parameters.number(ids.SIMULATION_REFERENCED_AT_START))
        and feedback(parameters) == "POSITION",
        start_position=parameters.kernel(ids.SIMULATION_START_POSITION),
    )


def gear_view(parameters: ParameterSet, gear: int, cycle_time: float) -> GearParameters:
    """The record getriebe[gear]; `cycle_time` in s."""
    return GearParameters(
        stage=gear + 1,
        max_speed=parameters.kernel(ids.DYNAMIK_VB_MAX, gear),
        positioning_speed=parameters.kernel(ids.GETRIEBE_VB_EILGANG, gear),
        max_acceleration=parameters.kernel(ids.DYNAMIK_A_MAX, gear),
        acceleration=parameters.kernel(ids.SLOPE_PROFIL_A_BESCHL, gear),
        deceleration=parameters.kernel(ids.SLOPE_PROFIL_A_BREMS, gear),
        emergency_deceleration=parameters.kernel(ids.DYNAMIK_A_EMERGENCY, gear)
        or parameters.kernel(ids.DYNAMIK_A_MAX, gear),
        curve=curve_view(parameters, gear),
        zero_speed=parameters.kernel(ids.GETRIEBE_VB_MIN_NULL, gear),
        control_limit=control_limit(parameters, gear),
        change_position=parameters.kernel(ids.GETRIEBE_GETR_SCHALT_POS, gear),
        reference_position=parameters.kernel(ids.GETRIEBE_POS_REFPKT, gear),
        homing_speed=parameters.kernel(ids.GETRIEBE_VB_REFLOW, gear),
        modulo_low=parameters.kernel(ids.GETRIEBE_MODULOU, gear),
        modulo_high=parameters.kernel(ids.GETRIEBE_MODULOO, gear),
        position_window=parameters.kernel(ids.GETRIEBE_WINDOW, gear),
        control=control_view(parameters, gear, cycle_time),
    )


def curve_view(parameters: ParameterSet, gear: int) -> CurveParameters | None:
    kind = int(parameters.number(ids.BESCHL_KENNLINIE_TYP, gear))
    if kind not in CURVE_TYPES:
        return None
    numbers = ("00010", "00130", "00007", "00026", "00027", "00028", "00240", "00241", "00242")
    return CurveParameters(CURVE_TYPES[kind], *(parameters.kernel(f"P-AXIS-{number}", gear) for number in numbers))


def control_limit(parameters: ParameterSet, gear: int) -> float:
    """P-AXIS-00220 where the drive type has it, infinity for 0 and the other types."""
    if parameters.number(ids.KENNGR_ANTR_TYP) not in CONTROL_LIMIT_DRIVES:
        return math.inf
    return parameters.kernel(ids.GETRIEBE_VB_REGELGRENZE, gear) or math.inf


def is_open_loop(parameters: ParameterSet) -> bool:
    return parameters.text(ids.ANTR_OPERATION_MODE).startswith("OPEN_POSITION_LOOP")


def feedback(parameters: ParameterSet) -> str:
    """POSITION, SPEED or NONE: what the operation mode says itself, else the telegram of the drive."""
    return OPEN_LOOP_FEEDBACK.get(parameters.text(ids.ANTR_OPERATION_MODE), parameters.text(ids.SIMULATION_TELEGRAM))


def preferred_direction(parameters: ParameterSet) -> int:
    if not parameters.number(ids.KENNGR_VORZ_RICHTUNG):
        return 0
    return 1 if parameters.number(ids.KENNGR_BEWEG_RICHT) else -1
