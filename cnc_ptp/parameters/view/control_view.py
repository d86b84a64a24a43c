"""Parameters of position controller, feedforward, friction compensation and drive in one gear, in kernel units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view import telegram
from cnc_ptp.parameters.view.encoder import encoder_increment, increment, resolution, uses_feed_constant
from cnc_ptp.parameters.view.fields import given_fields
from cnc_ptp.parameters.view.sercos_view import SercosParameters

VEL, ACC, JERK = 0x001, 0x002, 0x004
ADD_VEL, ADD_ACC, ADD_JERK = 0x100, 0x200, 0x800
DELAY_CYCLES = 6
"""A feedforward delay must be shorter than this number of cycles (P-AXIS-00389, 00390)."""
DEFAULT_JERK_DENOMINATOR = 100
DEFAULT_TABLE_SIZE = 20
MONITORING_TYPES = ESTIMATED, LINEAR, FIXED = 1, 2, 4
"""P-AXIS-00172; 0 is off."""
TIME_BASES = {0: 60.0, 1: 1.0}


@dataclass(frozen=True, slots=True)
class LagMonitoring:
    """Monitoring of the following error (P-AXIS-00172: 0 off, 1 estimated, 2 linear, 4 fixed). mm, deg, s."""

    kind: Annotated[int, ids.GETRIEBE_SLEP_UEBERW_TYP]
    moving_limit: Annotated[float, ids.GETRIEBE_SLEP_MAX]
    standstill_limit: Annotated[float, ids.GETRIEBE_SLEP_MIN]
    dynamic: Annotated[int, ids.GETRIEBE_SLEP_DYN]
    """In 1/1024."""
    filter_time: Annotated[float, ids.LR_PARAM_POSITION_LAG_FILTER_TIME]


@dataclass(frozen=True, slots=True)
class DriveScaling:
    """Drive formats: one mm, mm/s (deg, deg/s) and Nm (N) on the bus."""

    position: float
    """Increments per mm (deg)."""
    velocity: float
    """Digits per mm/s (deg/s)."""
    torque: float
    """Digits per Nm (N); 0.0 if no torque can be output (110465)."""
    analogue: float
    """Bits of a DA word per mm/s (deg/s), P-AXIS-00129 / P-AXIS-00128."""
    torque_per_acceleration: float
    """Nm (N) for 1 mm/s² (deg/s²): J · 2π · i / h, or m / 1000."""


@dataclass(frozen=True, slots=True)
class DriveParameters:
    """The drive and the contents of its telegram."""

    kind: Annotated[int, ids.KENNGR_ANTR_TYP]
    interface: str
    """Commanded quantity: velocity, position, lag (DSC), torque, or none (virtual axis)."""
    commands: frozenset[str]
    """Quantities in the command telegram: velocity, additive_torque …"""
    feedback: frozenset[str]
    analogue: bool
    """The command is a DA word of 16 bits."""
    ideal: bool
    """No format between NC and drive: nothing is rounded (simulated and virtual drives)."""
    reverse: bool
    velocity_gain: Annotated[float, ids.LR_PARAM_VELOCITY_GAIN]
    velocity_integral_time: Annotated[float, ids.LR_PARAM_VELOCITY_INTEGRAL_TIME]
    command_bits: Mapping[str, int] = field(default_factory=telegram.default_bits)
    """Length of each quantity in the command telegram."""
    feedback_bits: Mapping[str, int] = field(default_factory=telegram.default_bits)


@dataclass(frozen=True, slots=True)
class FeedforwardParameters:
    """Feedforward (P-AXIS-00223 …). Weights are dimensionless, times in s."""

    mode: int
    weight: float
    """Global weight P-AXIS-00228 / P-AXIS-00229."""
    velocity_weight: float
    time_constant: float
    """Ta of the conventional acceleration part, s."""
    torque_weight: float
    """Weight of the additive torque, P-AXIS-00225 / P-AXIS-00226."""
    jerk_weight: float
    velocity_delay: float
    acceleration_delay: float
    lead_cycles: int
    """Number of cycles by which the feedforward is output before its setpoint (PROFIdrive)."""
    prefilter_cycles: Annotated[int, ids.VORSTEUER_PREFILTER_CYCLES]
    always_active: Annotated[bool, ids.VORSTEUER_DEFAULT_ACTIVE]


@dataclass(frozen=True, slots=True)
class FrictionParameters:
    """Friction compensation: table over |velocity| (mm/s, deg/s) in drive digits, already scaled."""

    permitted: bool
    active: bool
    """P-AXIS-00522 and P-COMP-00041 are set."""
    velocities: tuple[float, ...]
    currents: tuple[float, ...]
    position_delay: Annotated[float, ids.FRICT_COMP_POSITION_DELAY]
    reversal_lookahead: Annotated[int, ids.FRICT_COMP_REVERSAL_LOOKAHEAD]
    delay_cycles: Annotated[int, ids.FRICT_COMP_DELAY_CYCLES]


@dataclass(frozen=True, slots=True)
class PlantParameters:
    """The simulated drive and mechanics (P-SIM-…). Torques in Nm (N), times in s."""

    cascaded: bool
    time_constant: Annotated[float, ids.SIMULATION_DRIVE_TIME_CONSTANT]
    torque_per_acceleration: float
    velocity_gain: Annotated[float, ids.SIMULATION_VELOCITY_GAIN]
    velocity_integral_time: Annotated[float, ids.SIMULATION_VELOCITY_INTEGRAL_TIME]
    current_time_constant: Annotated[float, ids.SIMULATION_CURRENT_TIME_CONSTANT]
    torque_limit: float
    coulomb: float
    static: float
    stribeck_velocity: Annotated[float, ids.FRICTION_STRIBECK_VELOCITY]
    viscous: float
    """Nm (N) per mm/s (deg/s)."""
    backlash: Annotated[float, ids.SIMULATION_BACKLASH]
    encoder_at_load: bool
    bus_delay_cycles: Annotated[int, ids.SIMULATION_BUS_DELAY_CYCLES]
    kv: float
    encoder_increment: float
    start_position: Annotated[float, ids.SIMULATION_START_POSITION]


@dataclass(frozen=True, slots=True)
class ModuloError:
    """Encoder increments that are missing in a modulo turn (P-AXIS-00124 / P-AXIS-00125); 0 = no compensation."""

    turn: float
    """Modulo range, deg."""
    increment: float
    """deg per increment."""
    increments_per_turn: float


@dataclass(frozen=True, slots=True)
class ControlParameters:
    """Everything below the setpoint of an axis or spindle in one gear."""

    kv: Annotated[float, ids.GETRIEBE_KV]
    monitoring: LagMonitoring
    drive: DriveParameters
    scaling: DriveScaling
    feedforward: FeedforwardParameters
    friction: FrictionParameters
    modulo_error: ModuloError
    plant: PlantParameters
    sercos: SercosParameters | None = None
    """Of the SERCOS drive of an axis."""
    path_delay_cycles: int = 0
    """Delay that other axes of the same path need, and this one therefore keeps too."""

    @property
    def delay_cycles(self) -> int:
        """Cycles by which the position controller works behind the setpoint, so that others can look ahead."""
        lead = self.feedforward.lead_cycles if self.feedforward.mode else 0
        return max(lead, self.friction.reversal_lookahead if self.friction.permitted else 0, self.path_delay_cycles)


def control_view(parameters: ParameterSet, gear: int, cycle_time: float) -> ControlParameters:
    """The parameters of record `gear` (0 …); `cycle_time` in s."""
    return ControlParameters(
        monitoring=LagMonitoring(**given_fields(LagMonitoring, parameters, gear)),
        drive=drive_parameters(parameters, gear),
        scaling=drive_scaling(parameters, gear, cycle_time),
        feedforward=feedforward_parameters(parameters, cycle_time),
        friction=friction_parameters(parameters),
        modulo_error=modulo_error(parameters, gear),
        plant=plant_parameters(parameters, gear),
        **given_fields(ControlParameters, parameters, gear),
    )


def drive_parameters(parameters: ParameterSet, gear: int) -> DriveParameters:
    kind = parameters.number(ids.KENNGR_ANTR_TYP)
    return DriveParameters(
        interface=telegram.interface(parameters),
        commands=telegram.commands(parameters),
        feedback=telegram.feedback(parameters),
        analogue=kind in telegram.ANALOGUE,
        ideal=kind in telegram.WITHOUT_FORMAT,
        reverse=parameters.axis_type == "S" and bool(parameters.number(ids.GETRIEBE_REVERSE, gear)),
        command_bits=telegram.command_bits(parameters),
        feedback_bits=telegram.feedback_bits(parameters),
        **given_fields(DriveParameters, parameters, gear),
    )


def drive_scaling(parameters: ParameterSet, gear: int, cycle_time: float) -> DriveScaling:
    """Source: TF5200 feedforward 4.1, 4.2; spindle P-AXIS-00129 (bits at 1 m/min or 1000 °/min)."""
    return DriveScaling(
        position=float(10_000 * resolution(parameters, gear)),
        velocity=velocity_scale(parameters, cycle_time),
        torque=torque_scale(parameters),
        analogue=analogue_scale(parameters, gear, cycle_time),
        torque_per_acceleration=torque_per_acceleration(parameters, gear, parameters.number(ids.GETRIEBE_LOAD, gear)),
    )


def analogue_scale(parameters: ParameterSet, gear: int, cycle_time: float) -> float:
    """Bits of a DA word per mm/s (deg/s): P-AXIS-00129 / P-AXIS-00128 bits at 1 m/min (1000 °/min).

    The speed of an axis with an open position loop (P-AXIS-00320) is scaled by P-AXIS-00205 to 00207 (spindle 2.2.4).
    """
    if telegram.is_open_loop(parameters):
        return velocity_scale(parameters, cycle_time)
    return quotient(parameters, ids.GETRIEBE_MULTI_GAIN_Z, ids.GETRIEBE_MULTI_GAIN_N, gear) * 60.0 / 1000.0


def velocity_scale(parameters: ParameterSet, cycle_time: float) -> float:
    """Digits per mm/s (deg/s): v_reso_num digits are v_reso_denom µm (0.001°) in the time base."""
    base = TIME_BASES.get(int(parameters.number(ids.ANTR_V_TIME_BASE)), cycle_time)
    return parameters.number(ids.ANTR_V_RESO_NUM) * base / parameters.kernel(ids.ANTR_V_RESO_DENOM)


def torque_scale(parameters: ParameterSet) -> float:
    """Digits per Nm (N): P-AXIS-00325 / P-AXIS-00326 digits are P-AXIS-00392; 0.0 with a zero denominator (110465)."""
    reference = parameters.number(ids.ANTR_ACC_REFERENCE_VALUE)
    if not reference or not parameters.number(ids.ANTR_TORQUE_SCALE_DENOM):
        return 0.0
    return quotient(parameters, ids.ANTR_TORQUE_SCALE_NUM, ids.ANTR_TORQUE_SCALE_DENOM) / reference


def torque_per_acceleration(parameters: ParameterSet, gear: int, load: float) -> float:
    """Nm (N) for 1 mm/s² (deg/s²) with `load` in kg·m² at the motor shaft (kg on a linear axis without feed constant).

    M = J · 2π · i / h · a, h the feed constant and i the gear ratio (TF5200 feedforward 4.2).
    """
    if uses_feed_constant(parameters):
        turn = quotient(parameters, ids.ANTR_FEED_CONST_NUM, ids.ANTR_FEED_CONST_DENOM) / 10_000.0
        gear_ratio = quotient(parameters, ids.GETRIEBE_GEAR_FACT_NUM, ids.GETRIEBE_GEAR_FACT_DENOM, gear)
        return load * 2.0 * math.pi * gear_ratio / turn
    return load / 1000.0 if parameters.axis_type == "T" else load * math.pi / 180.0


def feedforward_parameters(parameters: ParameterSet, cycle_time: float) -> FeedforwardParameters:
    acceleration_factor = quotient(parameters, ids.VORSTEUER_VS_A_FAKTOR, ids.VORSTEUER_VS_A_NENNER)
    jerk_denominator = parameters.number(ids.VORSTEUER_JERK_FACT_DENOM) or DEFAULT_JERK_DENOMINATOR
    profidrive = parameters.number(ids.KENNGR_ANTR_TYP) == telegram.DriveType.PROFIDRIVE
    return FeedforwardParameters(
        mode=feedforward_mode(parameters),
        weight=quotient(parameters, ids.VORSTEUER_VS_V_FAKTOR, ids.VORSTEUER_VS_V_NENNER),
        velocity_weight=velocity_weight(parameters),
        time_constant=acceleration_factor / 1e6,
        torque_weight=acceleration_factor,
        jerk_weight=parameters.number(ids.VORSTEUER_JERK_FACT_NUM) / jerk_denominator,
        velocity_delay=permitted_delay(parameters, ids.VORSTEUER_VELOCITY_DELAY_TIME, cycle_time),
        acceleration_delay=permitted_delay(parameters, ids.VORSTEUER_ACCELERATION_DELAY_TIME, cycle_time),
        lead_cycles=int(parameters.number(ids.VORSTEUER_SHIFT_TIME)) if profidrive else 0,
        **given_fields(FeedforwardParameters, parameters),
    )


def quotient(parameters: ParameterSet, numerator: str, denominator: str, *gear: int) -> float:
    return parameters.number(numerator, *gear) / parameters.number(denominator, *gear)


def velocity_weight(parameters: ParameterSet) -> float:
    """P-AXIS-00514 / P-AXIS-00515, in addition to the global weight."""
    return quotient(parameters, ids.VORSTEUER_FEEDFORWARD_V_ADD_NUM, ids.VORSTEUER_FEEDFORWARD_V_ADD_DENOM)


def feedforward_mode(parameters: ParameterSet) -> int:
    """The bits of P-AXIS-00223."""
    return flag_bits(parameters, ids.VORSTEUER_VORSTEUERUNG)


def flag_bits(parameters: ParameterSet, number: str) -> int:
    choices = parameters.catalogue.by_id[number].choices
    bits = 0
    for name in parameters.text(number).split(" | "):
        bits |= choices[name] if name in choices else int(name, 0)
    return bits


def permitted_delay(parameters: ParameterSet, number: str, cycle_time: float) -> float:
    """A delay in s; 0 if it is not below six cycles (70348, 70349)."""
    delay = parameters.kernel(number)
    return delay if delay < DELAY_CYCLES * cycle_time * (1.0 - 1e-12) else 0.0


def friction_parameters(parameters: ParameterSet) -> FrictionParameters:
    """Source: TF5200 friction 2.2. Values are scaled by P-COMP-00045 / 1000."""
    scale = parameters.kernel(ids.FRICT_COMP_SCALING_FACTOR)
    entries = range(int(parameters.number(ids.FRICT_COMP_TABLE_ENTRIES)))
    permitted = friction_permitted(parameters)
    return FrictionParameters(
        permitted=permitted,
        active=permitted and parameters.number(ids.FRICT_COMP_MODE) != 0,
        velocities=tuple(parameters.kernel(ids.TABLE_IN, index) for index in entries),
        currents=tuple(parameters.number(ids.TABLE_OUT, index) * scale for index in entries),
        **given_fields(FrictionParameters, parameters),
    )


def friction_permitted(parameters: ParameterSet) -> bool:
    """P-AXIS-00522; spindles have no friction compensation."""
    return parameters.axis_type != "S" and bool(parameters.number(ids.LR_PARAM_FRICT_COMP))


def friction_table_size(parameters: ParameterSet) -> int:
    """Largest number of entries of the friction table, P-COMP-00062; 0 counts as 20."""
    return int(parameters.number(ids.FRICT_COMP_MAX_POINTS)) or DEFAULT_TABLE_SIZE


def modulo_error(parameters: ParameterSet, gear: int) -> ModuloError:
    """P-AXIS-00124 increments in P-AXIS-00125 turns, if P-AXIS-00120 switches the compensation on."""
    turns = parameters.number(ids.GETRIEBE_MODULO_UMDREH, gear) if parameters.axis_type != "T" else 0
    if not turns or not parameters.number(ids.LR_PARAM_MOD_KOMP):
        return ModuloError(0.0, 0.0, 0.0)
    turn = parameters.kernel(ids.GETRIEBE_MODULOO, gear) - parameters.kernel(ids.GETRIEBE_MODULOU, gear)
    return ModuloError(turn, increment(parameters, gear), parameters.number(ids.GETRIEBE_MODULO_FEHLER, gear) / turns)


def plant_parameters(parameters: ParameterSet, gear: int) -> PlantParameters:
    load = parameters.number(ids.SIMULATION_INERTIA) or parameters.number(ids.GETRIEBE_LOAD, gear)
    coulomb = parameters.number(ids.FRICTION_COULOMB)
    return PlantParameters(
        cascaded=parameters.text(ids.SIMULATION_MODEL) == "CASCADED",
        torque_per_acceleration=torque_per_acceleration(parameters, gear, load),
        torque_limit=parameters.number(ids.SIMULATION_TORQUE_LIMIT) or math.inf,
        coulomb=coulomb,
        static=max(coulomb, parameters.number(ids.FRICTION_STATIC)),
        viscous=parameters.number(ids.FRICTION_VISCOUS) / 1000.0,
        encoder_at_load=parameters.text(ids.SIMULATION_ENCODER_AT) == "LOAD",
        kv=parameters.kernel(ids.SIMULATION_DRIVE_KV) or parameters.kernel(ids.GETRIEBE_KV, gear),
        encoder_increment=encoder_increment(parameters, gear),
        **given_fields(PlantParameters, parameters, gear),
    )
