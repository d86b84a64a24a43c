"""Notices about feedforward, friction compensation, monitoring, drive formats and gain: corrected or doubtful."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.messages import OWN_UNIT, Notice, notice
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.control_view import (
    ACC,
    ADD_ACC,
    ADD_JERK,
    ADD_VEL,
    DEFAULT_JERK_DENOMINATOR,
    DELAY_CYCLES,
    ESTIMATED,
    FIXED,
    JERK,
    MONITORING_TYPES,
    VEL,
    ControlParameters,
    PlantParameters,
    control_view,
    feedforward_mode,
    friction_parameters,
    permitted_delay,
    torque_per_acceleration,
    velocity_weight,
)
from cnc_ptp.parameters.view.encoder import uses_feed_constant
from cnc_ptp.parameters.view.gears import active_gear, gear_records
from cnc_ptp.parameters.view.telegram import ANALOGUE, is_open_loop

MANUAL_POSITION_DELAY = 10
PARTS = ((VEL, ADD_VEL), (ACC, ADD_ACC), (JERK, ADD_JERK))
"""Bits of P-AXIS-00223: a part, and the same part as an additive command."""
ADDITIVE = "a_max and the friction table"
NO_TORQUE_SCALE = 110465
NO_JERK_DENOMINATOR = 110473
DELAYS = {ids.VORSTEUER_VELOCITY_DELAY_TIME: 70349, ids.VORSTEUER_ACCELERATION_DELAY_TIME: 70348}


def control_notices(parameters: ParameterSet, cycle_time: float) -> Iterator[Notice]:
    """All notices of one axis or spindle; `cycle_time` in s."""
    yield from delays(parameters, cycle_time)
    yield from denominators(parameters)
    yield from weight(parameters)
    yield from position_delay(parameters)
    yield from monitoring_type(parameters)
    yield from following_error(parameters)
    yield from open_loop(parameters)
    yield from velocity_range(parameters, cycle_time)
    yield from torque_range(parameters, cycle_time)
    yield from drive_gain(parameters, cycle_time)
    yield from gain(parameters, cycle_time)


def delays(parameters: ParameterSet, cycle_time: float) -> Iterator[Notice]:
    for number, error_id in DELAYS.items():
        if parameters.number(number) and not permitted_delay(parameters, number, cycle_time):
            delay, cycles, limit = parameters.number(number), DELAY_CYCLES, DELAY_CYCLES * cycle_time * 1e6
            text = f"delay {delay} µs is not below {cycles} interpolator cycles ({limit:g} µs), 0 is used"
            values = (("limit", limit, "µs"), ("corrected", 0.0, "µs"))
            yield notice(parameters, number, (), text, error_id=error_id, values=values)


def denominators(parameters: ParameterSet) -> Iterator[Notice]:
    if parameters.number(ids.ANTR_TORQUE_SCALE_DENOM) == 0:
        text = "value 0 is not a valid denominator, no additive torque is output"
        yield notice(parameters, ids.ANTR_TORQUE_SCALE_DENOM, (), text, error_id=NO_TORQUE_SCALE)
    if parameters.number(ids.ANTR_ACC_REFERENCE_VALUE) == 0 and outputs_torque(parameters):
        text = "value 0 is not a valid reference of the torque scaling, no additive torque is output"
        yield notice(parameters, ids.ANTR_ACC_REFERENCE_VALUE, (), text, error_id=NO_TORQUE_SCALE)
    if parameters.number(ids.VORSTEUER_JERK_FACT_DENOM) == 0:
        text = f"value 0 is not a valid denominator, {DEFAULT_JERK_DENOMINATOR} is used"
        corrected = (("corrected", float(DEFAULT_JERK_DENOMINATOR), OWN_UNIT),)
        yield notice(
            parameters,
            ids.VORSTEUER_JERK_FACT_DENOM,
            (),
            text,
            error_id=NO_JERK_DENOMINATOR,
            values=corrected,
        )


def outputs_torque(parameters: ParameterSet) -> bool:
    """Additive torque is configured, for feedforward or friction compensation."""
    return bool(feedforward_mode(parameters) & (ADD_ACC | ADD_JERK)) or friction_parameters(parameters).active


def weight(parameters: ParameterSet) -> Iterator[Notice]:
    value, denominator = parameters.number(ids.VORSTEUER_VS_V_FAKTOR), parameters.number(ids.VORSTEUER_VS_V_NENNER)
    if value > denominator:
        text = f"weight {value / denominator:g} of the feedforward is above 1, the axis leads its setpoint"
        yield notice(parameters, ids.VORSTEUER_VS_V_FAKTOR, (), text)
    own = velocity_weight(parameters)
    if own > 1 and own * value > denominator:
        text = (
            f"weight {own * value / denominator:g} of the velocity feedforward is above 1, the axis leads its setpoint"
        )
        yield notice(parameters, ids.VORSTEUER_FEEDFORWARD_V_ADD_NUM, (), text)


def position_delay(parameters: ParameterSet) -> Iterator[Notice]:
    value = parameters.number(ids.FRICT_COMP_POSITION_DELAY)
    if value > MANUAL_POSITION_DELAY:
        text = f"value {value} is above the {MANUAL_POSITION_DELAY} of the manual, accepted"
        yield notice(parameters, ids.FRICT_COMP_POSITION_DELAY, (), text)


def monitoring_type(parameters: ParameterSet) -> Iterator[Notice]:
    """A type of monitoring that does not exist and is not 0 (off) either."""
    for gear in used_gears(parameters):
        kind = parameters.number(ids.GETRIEBE_SLEP_UEBERW_TYP, gear)
        if kind not in (0, *MONITORING_TYPES):
            known = ", ".join(map(str, MONITORING_TYPES))
            text = f"type {kind} is none of {known}, the following error is not monitored"
            yield notice(parameters, ids.GETRIEBE_SLEP_UEBERW_TYP, (gear,), text)


def following_error(parameters: ParameterSet) -> Iterator[Notice]:
    """Monitoring that would trip in normal motion: vb_max / kv above slep_max, if the limit is fixed."""
    gear = active_gear(parameters)
    if parameters.kind != "axis" or parameters.number(ids.GETRIEBE_SLEP_UEBERW_TYP, gear) not in (ESTIMATED, FIXED):
        return
    expected = parameters.kernel(ids.DYNAMIK_VB_MAX, gear) / parameters.kernel(ids.GETRIEBE_KV, gear)
    limit = parameters.kernel(ids.GETRIEBE_SLEP_MAX, gear)
    if expected >= limit:
        unit = "mm" if parameters.axis_type == "T" else "deg"
        text = f"limit {limit:g} {unit} is not above vb_max / kv, the {expected:g} {unit} expected at P-AXIS-00212"
        yield notice(parameters, ids.GETRIEBE_SLEP_MAX, (gear,), text)


def open_loop(parameters: ParameterSet) -> Iterator[Notice]:
    """The open position loop is for spindles (TF5200 spindle 2.2.4)."""
    if is_open_loop(parameters) and parameters.kind != "spindle":
        text = f"mode {parameters.text(ids.ANTR_OPERATION_MODE)} is accepted, but the position loop stays closed"
        yield notice(parameters, ids.ANTR_OPERATION_MODE, (), text)


def used_gears(parameters: ParameterSet) -> list[int]:
    """Records that can be active: of an axis the one after start-up, of a spindle all."""
    return gear_records(parameters) if parameters.kind == "spindle" else [active_gear(parameters)]


def velocity_range(parameters: ParameterSet, cycle_time: float) -> Iterator[Notice]:
    """A velocity command with too few bits for the largest velocity; a DA word is scaled in each gear."""
    gears = used_gears(parameters)
    if int(parameters.number(ids.KENNGR_ANTR_TYP)) not in ANALOGUE:
        gears = [max(gears, key=lambda gear: parameters.kernel(ids.DYNAMIK_VB_MAX, gear))]
    for gear in gears:
        yield from velocity_range_of(parameters, gear, cycle_time)


def velocity_range_of(parameters: ParameterSet, gear: int, cycle_time: float) -> Iterator[Notice]:
    control = control_view(parameters, gear, cycle_time)
    drive, scaling = control.drive, control.scaling
    if drive.ideal or drive.interface != "velocity":
        return
    scale = scaling.analogue if drive.analogue else scaling.velocity
    bits = drive.command_bits["velocity"]
    limit = largest_digit(bits) / scale if scale else 0.0
    largest = parameters.kernel(ids.DYNAMIK_VB_MAX, gear)
    if largest > limit:
        unit = "mm/s" if parameters.axis_type == "T" else "deg/s"
        text = (
            f"the {bits} bits of the command carry {limit:g} {unit}, less than the {largest:g} {unit} of P-AXIS-00212"
        )
        number, indexes = (ids.GETRIEBE_MULTI_GAIN_Z, (gear,)) if drive.analogue else (ids.ANTR_V_RESO_NUM, ())
        yield notice(parameters, number, indexes, text)


def torque_range(parameters: ParameterSet, cycle_time: float) -> Iterator[Notice]:
    """Torque words of a telegram with too few bits for the largest torque."""
    control = control_view(parameters, used_gears(parameters)[0], cycle_time)
    drive, scale = control.drive, control.scaling.torque
    if drive.ideal or not scale:
        return
    commands, feedback = drive.command_bits, drive.feedback_bits
    additive, any_torque = additive_torque(parameters, control), largest_torque(parameters, control)
    unit = "N" if parameters.axis_type == "T" and not uses_feed_constant(parameters) else "Nm"
    for word, is_used, bits, (needed, cause) in (
        ("additive torque command", "additive_torque" in drive.commands, commands["additive_torque"], additive),
        ("torque command", drive.interface == "torque", commands["torque"], any_torque),
        ("actual torque", "torque" in drive.feedback, feedback["torque"], any_torque),
    ):
        limit = largest_digit(bits) / scale
        if is_used and needed > limit:
            carries = f"the {bits} bits of the {word} carry {limit:g} {unit}"
            text = f"{carries}, less than the {needed:g} {unit} of {cause}; more is cut off"
            yield notice(parameters, ids.ANTR_TORQUE_SCALE_NUM, (), text)


def additive_torque(parameters: ParameterSet, control: ControlParameters) -> tuple[float, str]:
    """The largest output of feedforward and friction compensation, Nm (N), and its causes."""
    feedforward = control.feedforward
    weight = feedforward.weight * feedforward.torque_weight if feedforward.mode & ADD_ACC else 0.0
    return weight * accelerating_torque(parameters) + friction_torque(control), ADDITIVE


def largest_torque(parameters: ParameterSet, control: ControlParameters) -> tuple[float, str]:
    """The largest torque of the drive, Nm (N), or, if it has no limit, of the motion; and its cause."""
    if math.isfinite(control.plant.torque_limit):
        return control.plant.torque_limit, "the torque limit P-SIM-00011"
    return accelerating_torque(parameters) + friction_torque(control), ADDITIVE


def accelerating_torque(parameters: ParameterSet) -> float:
    """For the largest acceleration (P-AXIS-00008) in the gear that needs the most, Nm (N)."""
    return max(
        torque_per_acceleration(parameters, gear, parameters.number(ids.GETRIEBE_LOAD, gear))
        * parameters.kernel(ids.DYNAMIK_A_MAX, gear)
        for gear in used_gears(parameters)
    )


def friction_torque(control: ControlParameters) -> float:
    """The largest active entry of the friction table, Nm (N)."""
    return max(map(abs, control.friction.currents), default=0.0) / control.scaling.torque * control.friction.active


def drive_gain(parameters: ParameterSet, cycle_time: float) -> Iterator[Notice]:
    """Conventional feedforward reaches a position loop in the drive as a position v/Kv, with the Kv of the NC."""
    for gear in used_gears(parameters):
        control = control_view(parameters, gear, cycle_time)
        conventional = any(control.feedforward.mode & (own | additive) == own for own, additive in PARTS)
        if conventional and control.drive.interface in ("position", "lag") and control.plant.kv != control.kv:
            text = (
                f"gain {control.plant.kv:g} 1/s of the drive is not the {control.kv:g} 1/s of P-AXIS-00099 with which "
                "feedforward becomes a position; a lag remains"
            )
            yield notice(parameters, ids.SIMULATION_DRIVE_KV, (), text)


def largest_digit(bits: int) -> int:
    return (1 << (bits - 1)) - 1


def gain(parameters: ParameterSet, cycle_time: float) -> Iterator[Notice]:
    """Unstable position loops; a gain of the drive (P-SIM-00019) is reported once."""
    lines = (text for gear in used_gears(parameters) for text in gain_of(parameters, gear, cycle_time))
    yield from dict.fromkeys(lines)


def gain_of(parameters: ParameterSet, gear: int, cycle_time: float) -> Iterator[Notice]:
    """An unstable position loop, of the NC or of the drive (P-SIM-00019)."""
    control = control_view(parameters, gear, cycle_time)
    interface = control.drive.interface
    in_drive = interface in ("position", "lag")
    kv = control.plant.kv if in_drive else control.kv
    well_damped = interface != "torque" and 2.0 * kv * small_times(control.plant, cycle_time) <= 1.0
    if interface == "none" or well_damped:
        return
    from cnc_ptp.parameters.check.stability import position_loop  # here, as numpy is slow to import

    loop = position_loop(control, cycle_time)
    if loop.is_stable(kv):
        return
    limit = loop.limit(cycle_time)
    text = f"gain {kv:g} 1/s makes the position loop unstable, with this drive the limit is {limit:.4g} 1/s"
    if in_drive and parameters.number(ids.SIMULATION_DRIVE_KV):
        yield notice(parameters, ids.SIMULATION_DRIVE_KV, (), text)
    else:
        yield notice(parameters, ids.GETRIEBE_KV, (gear,), text)


def small_times(plant: PlantParameters, cycle_time: float) -> float:
    """Sum of the delays in the loop, s: up to half its reciprocal a gain is well damped (0.71) in any case."""
    velocity_loop = 2.0 / plant.velocity_gain + plant.current_time_constant if plant.cascaded else 0.0
    return plant.time_constant + velocity_loop + (plant.bus_delay_cycles + 0.5) * cycle_time
