"""What is corrected in, or questionable about, feedforward, friction compensation, monitoring and gain. Lines."""

from __future__ import annotations

from collections.abc import Iterator

from cnc_ptp.parameters.control_view import (
    ADD_ACC,
    ADD_JERK,
    DEFAULT_JERK_DENOMINATOR,
    DELAY_CYCLES,
    PlantParameters,
    control_view,
    feedforward_mode,
    friction_parameters,
    permitted_delay,
)
from cnc_ptp.parameters.lines import line
from cnc_ptp.parameters.parameter_set import ParameterSet
from cnc_ptp.parameters.telegram import ANALOGUE

MANUAL_POSITION_DELAY = 10
MONITORING_TYPES = (1, 2, 4)
DELAYS = {"P-AXIS-00389": 70349, "P-AXIS-00390": 70348}


def control_notices(parameters: ParameterSet, cycle_time: float) -> Iterator[str]:
    """All lines of one axis or spindle; `cycle_time` in s."""
    yield from delays(parameters, cycle_time)
    yield from denominators(parameters)
    yield from weight(parameters)
    yield from position_delay(parameters)
    yield from following_error(parameters)
    yield from open_loop(parameters)
    yield from velocity_range(parameters, cycle_time)
    yield from gain(parameters, cycle_time)


def delays(parameters: ParameterSet, cycle_time: float) -> Iterator[str]:
    for number, error_id in DELAYS.items():
        if parameters.number(number) and not permitted_delay(parameters, number, cycle_time):
            limit = f"{DELAY_CYCLES} interpolator cycles ({DELAY_CYCLES * cycle_time * 1e6:g} µs)"
            text = f"P-ERR-{error_id}: delay {parameters.number(number)} µs is not below {limit}, 0 is used"
            yield line(parameters, number, (), text)


def denominators(parameters: ParameterSet) -> Iterator[str]:
    if parameters.number("P-AXIS-00326") == 0:
        text = "P-ERR-110465: value 0 is no denominator, no additive torque is put out"
        yield line(parameters, "P-AXIS-00326", (), text)
    if parameters.number("P-AXIS-00392") == 0 and puts_out_torque(parameters):
        text = "P-ERR-110465: value 0 is no reference of the torque scaling, no additive torque is put out"
        yield line(parameters, "P-AXIS-00392", (), text)
    if parameters.number("P-AXIS-00338") == 0:
        text = f"P-ERR-110473: value 0 is no denominator, {DEFAULT_JERK_DENOMINATOR} is used"
        yield line(parameters, "P-AXIS-00338", (), text)


def puts_out_torque(parameters: ParameterSet) -> bool:
    """Additive torque is configured, of the feedforward or of the friction compensation."""
    return bool(feedforward_mode(parameters) & (ADD_ACC | ADD_JERK)) or friction_parameters(parameters).active


def weight(parameters: ParameterSet) -> Iterator[str]:
    value, denominator = parameters.number("P-AXIS-00228"), parameters.number("P-AXIS-00229")
    if value > denominator:
        text = f"weight {value / denominator:g} of the feedforward is above 1, the axis leads its setpoint"
        yield line(parameters, "P-AXIS-00228", (), text)


def position_delay(parameters: ParameterSet) -> Iterator[str]:
    value = parameters.number("P-COMP-00043")
    if value > MANUAL_POSITION_DELAY:
        text = f"value {value} is above the {MANUAL_POSITION_DELAY} of the manual, accepted"
        yield line(parameters, "P-COMP-00043", (), text)


def following_error(parameters: ParameterSet) -> Iterator[str]:
    """Monitoring that would trip in plain motion: vb_max / kv above slep_max, where the limit is a fixed one."""
    gear = (int(parameters.number("P-AXIS-00079")) - 1,)
    if parameters.number("P-AXIS-00172", *gear) not in MONITORING_TYPES or parameters.kind != "axis":
        return
    expected = parameters.kernel("P-AXIS-00212", *gear) / parameters.kernel("P-AXIS-00099", *gear)
    limit = parameters.kernel("P-AXIS-00168", *gear)
    if expected >= limit and parameters.number("P-AXIS-00172", *gear) != 2:  # the linear one grows with the velocity
        unit = "mm" if parameters.axis_type == "T" else "°"
        text = f"limit {limit:g} {unit} is not above vb_max / kv, the {expected:g} {unit} that P-AXIS-00212 brings"
        yield line(parameters, "P-AXIS-00168", gear, text)


def open_loop(parameters: ParameterSet) -> Iterator[str]:
    """The open position loop is for spindles (TF5200 spindle 2.2.4)."""
    mode = parameters.text("P-AXIS-00320")
    if mode.startswith("OPEN_POSITION_LOOP") and parameters.kind != "spindle":
        yield line(parameters, "P-AXIS-00320", (), f"mode {mode} is accepted, but the position loop stays closed")


def used_gears(parameters: ParameterSet) -> list[int]:
    """Records that can be in work: of an axis the one after start-up, of a spindle all that there are."""
    start = int(parameters.number("P-AXIS-00079")) - 1
    return sorted({start, *parameters.used_indexes("getriebe")}) if parameters.kind == "spindle" else [start]


def velocity_range(parameters: ParameterSet, cycle_time: float) -> Iterator[str]:
    """A velocity command that is too short for the largest velocity; a DA word has a scale in each gear."""
    gears = used_gears(parameters)
    if int(parameters.number("P-AXIS-00020")) not in ANALOGUE:
        gears = [max(gears, key=lambda gear: parameters.kernel("P-AXIS-00212", gear))]
    for gear in gears:
        yield from velocity_range_of(parameters, gear, cycle_time)


def velocity_range_of(parameters: ParameterSet, gear: int, cycle_time: float) -> Iterator[str]:
    control = control_view(parameters, gear, cycle_time)
    drive, scaling = control.drive, control.scaling
    if drive.ideal or drive.interface != "velocity":
        return
    scale, number = (scaling.analogue, "P-AXIS-00129") if drive.analogue else (scaling.velocity, "P-AXIS-00206")
    bits = drive.command_bits["velocity"]
    limit = largest_digit(bits) / scale if scale else 0.0
    largest = parameters.kernel("P-AXIS-00212", gear)
    if largest > limit:
        unit = "mm/s" if parameters.axis_type == "T" else "°/s"
        text = (
            f"the {bits} bits of the command carry {limit:g} {unit}, less than the {largest:g} {unit} of P-AXIS-00212"
        )
        yield line(parameters, number, (gear,) if drive.analogue else (), text)


def largest_digit(bits: int) -> int:
    return 2 ** (bits - 1) - 1


def gain(parameters: ParameterSet, cycle_time: float) -> Iterator[str]:
    """Unstable position loops; a gain of the drive (P-SIM-00019) is told once."""
    lines = (text for gear in used_gears(parameters) for text in gain_of(parameters, gear, cycle_time))
    yield from dict.fromkeys(lines)


def gain_of(parameters: ParameterSet, gear: int, cycle_time: float) -> Iterator[str]:
    """An unstable position loop, of the NC or of the drive (P-SIM-00019)."""
    control = control_view(parameters, gear, cycle_time)
    interface = control.drive.interface
    in_drive = interface in ("position", "lag")
    kv = control.plant.kv if in_drive else control.kv
    well_damped = interface != "torque" and 2.0 * kv * small_times(control.plant, cycle_time) <= 1.0
    if interface == "none" or well_damped:
        return
    from cnc_ptp.parameters.stability import position_loop  # here, as numpy takes its time

    loop = position_loop(control, cycle_time)
    if loop.is_stable(kv):
        return
    limit = loop.limit(cycle_time)
    text = f"gain {kv:g} 1/s makes the position loop unstable, with this drive the limit is {limit:.4g} 1/s"
    if in_drive and parameters.number("P-SIM-00019"):
        yield line(parameters, "P-SIM-00019", (), text)
    else:
        yield line(parameters, "P-AXIS-00099", (gear,), text)


def small_times(plant: PlantParameters, cycle_time: float) -> float:
    """Sum of the delays in the loop, s: a gain up to half its reciprocal is damped well (0.71), whatever they are."""
    velocity_loop = 2.0 / plant.velocity_gain + plant.current_time_constant if plant.cascaded else 0.0
    return plant.time_constant + velocity_loop + (plant.bus_delay_cycles + 0.5) * cycle_time
