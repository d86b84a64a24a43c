"""Notices about a machine file: accepted values that may not do what their author expects. None stops a node."""

from collections.abc import Iterator

from cnc_ptp.parameters.check.control_notices import control_notices, delays, monitoring_type, position_delay
from cnc_ptp.parameters.check.friction_notices import friction_notices
from cnc_ptp.parameters.check.spindle_checks import above_control_limit
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.parameters.read.messages import OWN_UNIT, Notice, notice
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.axis_view import is_facing, is_modulo
from cnc_ptp.parameters.view.channel_members import Sets, axis_entries, spindle_entries
from cnc_ptp.parameters.view.encoder import CORRECTED, uses_feed_constant
from cnc_ptp.parameters.view.gears import active_gear
from cnc_ptp.parameters.view.spindle_view import curve_view, has_position
from cnc_ptp.parameters.view.telegram import DriveType

UNIT_LISTS = {"channel": ids.CHANNELS, "axis": ids.AXES, "spindle": ids.SPINDLES}
HOMED_BY_THE_NC = (DriveType.CONVENTIONAL, DriveType.LIGHTBUS, DriveType.TERMINAL)
"""Drive types of what TF5200 spindle 2.3 calls analogue spindles: conventional, Lightbus, terminal (P-AXIS-00156)."""
UNAVAILABLE_SLOPES = {3: "HSC"}
UPPER_END = ids.GETRIEBE_MODULOO
GEAR_RATIO = (ids.GETRIEBE_GEAR_FACT_NUM, ids.GETRIEBE_GEAR_FACT_DENOM)
SMALL_STEP = 0.001
"""Fraction of the constant acceleration."""


def machine_notices(machine: ParameterSet, sets: Sets) -> Iterator[Notice]:
    """All notices of a machine, each with file and line."""
    cycle_time = machine.kernel(ids.CYCLE_TIME_US)
    yield from units_without_section(machine, sets)
    for parameters in sets.values():
        yield from without_effect(parameters)
        if parameters.kind == "channel":
            yield from slope_not_available(parameters)
            yield from tools_without_limit(parameters)
            yield from couplings_without_effect(parameters)
            yield from ranges_above_the_spindle(parameters, sets)
            yield from diameters_without_facing_axis(parameters, sets)
        else:
            yield from control_notices(parameters, cycle_time)
            yield from friction_notices(parameters)
            yield from corrected_resolution(parameters)
            yield from gear_ratio_without_effect(parameters)
            yield from range_of_a_conveyor(parameters)
            yield from spindle_notices(parameters)


def notices_without_view(parameters: ParameterSet, cycle_time: float) -> Iterator[Notice]:
    """Those of a unit that has problems, too: each is about a value alone."""
    yield from without_effect(parameters)
    if parameters.kind != "channel":
        yield from delays(parameters, cycle_time)
        yield from position_delay(parameters)
        yield from monitoring_type(parameters)
        yield from corrected_resolution(parameters)


def units_without_section(machine: ParameterSet, sets: Sets) -> Iterator[Notice]:
    """Units that /machine lists without a section of their own; the loader gives them the place of /machine."""
    for name, parameters in sets.items():
        if parameters.place == machine.place:
            text = f"{parameters.kind} /{name} has no section in the file, all its parameters have their defaults"
            yield notice(machine, UNIT_LISTS[parameters.kind], (), text)


def without_effect(parameters: ParameterSet) -> Iterator[Notice]:
    for ros_name in parameters.given:
        declaration, indexes, _ = parameters.find(ros_name)
        if not declaration.effective_for(parameters.axis_type):
            yield notice(parameters, declaration.id, indexes, "accepted, but without effect in this version")


def slope_not_available(channel: ParameterSet) -> Iterator[Notice]:
    value = channel.number(ids.SLOPE_PROFILE)
    if value in UNAVAILABLE_SLOPES:
        text = f"value {value}, {UNAVAILABLE_SLOPES[int(value)]}, is not available; 1 (TRAPEZ) is used"
        yield notice(channel, ids.SLOPE_PROFILE, (), text)


def tools_without_limit(parameters: ParameterSet) -> Iterator[Notice]:
    """A tool whose limits the file leaves out; their defaults of 1 would bring its spindle to a standstill."""
    for tool in parameters.used_indexes("wz"):
        if not parameters.number(ids.WZ_LOG_AX_NR_SPDL, tool):
            continue
        for number in (ids.WZ_VB_MAX, ids.WZ_A_MAX):
            if not parameters.is_given(number, tool):
                yield notice(parameters, number, (tool,), f"not given, tool {tool} has no such limit")


def couplings_without_effect(parameters: ParameterSet) -> Iterator[Notice]:
    """Coupled pairs that no command can enable: path axes, and groups other than 0."""
    for group in parameters.used_indexes("synchro_data.koppel_gruppe"):
        for pair in parameters.used_indexes(f"synchro_data.koppel_gruppe.{group}.paar"):
            if group:
                text = "only coupling group 0 is used"
                yield notice(parameters, ids.PAAR_LOG_ACHS_NR_SLAVE, (group, pair), text)
            elif not parameters.number(ids.PAAR_MODE, group, pair):
                yield notice(parameters, ids.PAAR_MODE, (group, pair), "a pair of path axes is not coupled")


def ranges_above_the_spindle(channel: ParameterSet, sets: Sets) -> Iterator[Notice]:
    """Speeds of a gear stage that its spindle refuses in motion (24001)."""
    if not channel.number(ids.MAIN_SPINDLE_GEAR_CHANGE):
        return
    for entry in spindle_entries(channel, sets):
        if entry.node is None or not entry.indexes:
            continue
        for gear in channel.used_indexes(f"spindel.{entry.indexes[0]}.range_table"):
            top = channel.number(ids.RANGE_TABLE_MAX_SPEED, *entry.indexes, gear)
            most = sets[entry.node].kernel(ids.DYNAMIK_VB_MAX, gear) / DEG_S_PER_RPM
            if top > most:
                text = f"value {top} (rpm) is above P-AXIS-00212 getriebe[{gear}].vb_max of /{entry.node}, {most:g} rpm"
                yield notice(channel, ids.RANGE_TABLE_MAX_SPEED, (*entry.indexes, gear), text)


def diameters_without_facing_axis(channel: ParameterSet, sets: Sets) -> Iterator[Notice]:
    """Offsets in diameters are those of a facing axis."""
    axes = [sets[entry.node] for entry in axis_entries(channel, sets) if entry.node is not None]
    if channel.number(ids.VERSCH_IM_DURCHM) and not any(is_facing(axis) for axis in axes):
        text = "without effect, the channel has no facing axis (P-AXIS-00015 0x40)"
        yield notice(channel, ids.VERSCH_IM_DURCHM, (), text)


def corrected_resolution(parameters: ParameterSet) -> Iterator[Notice]:
    for gear in parameters.used_indexes("getriebe"):
        for number, warning in CORRECTED.items():
            if parameters.number(number, gear) == 0:
                values = (("corrected", 1.0, OWN_UNIT),)
                yield notice(parameters, number, (gear,), "value 0 is corrected to 1", error_id=warning, values=values)


def gear_ratio_without_effect(parameters: ParameterSet) -> Iterator[Notice]:
    """A gear ratio belongs to the feed constant; without it wegaufz and wegaufn alone give the resolution."""
    if uses_feed_constant(parameters):
        return
    for gear in parameters.used_indexes("getriebe"):
        given = [number for number in GEAR_RATIO if parameters.is_given(number, gear)]
        if given and parameters.number(GEAR_RATIO[0], gear) != parameters.number(GEAR_RATIO[1], gear):
            text = (
                "without effect, there is no feed constant (P-AXIS-00362 and P-AXIS-00363 are 1); the resolution is "
                "P-AXIS-00234/00233"
            )
            yield notice(parameters, given[0], (gear,), text)


def spindle_notices(parameters: ParameterSet) -> Iterator[Notice]:
    if parameters.kind == "spindle":
        yield from homing_mode(parameters)
        yield from rapid_traverse(parameters)
        yield from step_in_the_curve(parameters)


def homing_mode(parameters: ParameterSet) -> Iterator[Notice]:
    """Some drives home automatically, others are homed by the NC (TF5200 spindle 2.3)."""
    drive, no_automatic = parameters.number(ids.KENNGR_ANTR_TYP), int(parameters.number(ids.KENNGR_ACHS_MODE)) & 0x100
    if drive == DriveType.SERCOS and not no_automatic:
        text = "automatic homing is not possible with drive type 2 SERCOS, 0x100 should be set"
        yield notice(parameters, ids.KENNGR_ACHS_MODE, (), text)
    elif drive in HOMED_BY_THE_NC and no_automatic:
        text = f"0x100 (no automatic homing) should not be set for {drive_type(parameters)}, which the NC homes"
        yield notice(parameters, ids.KENNGR_ACHS_MODE, (), text)
    if drive in HOMED_BY_THE_NC and has_position(parameters) and not parameters.number(ids.KENNGR_REF_OHNE_NOCKEN):
        text = f"should be 1 for a spindle with {drive_type(parameters)}; it is homed without a cam"
        yield notice(parameters, ids.KENNGR_REF_OHNE_NOCKEN, (), text)


def drive_type(parameters: ParameterSet) -> str:
    """Drive type 6 (+-10 V terminal)."""
    number = int(parameters.number(ids.KENNGR_ANTR_TYP))
    return f"drive type {number} ({parameters.catalogue.by_id[ids.KENNGR_ANTR_TYP].choices[number]})"


def rapid_traverse(parameters: ParameterSet) -> Iterator[Notice]:
    """Positioning needs the measuring system, which fails above the control limit."""
    for gear in parameters.used_indexes("getriebe"):
        text = above_control_limit(parameters, ids.GETRIEBE_VB_EILGANG, gear)
        if text:
            yield notice(parameters, ids.GETRIEBE_VB_EILGANG, (gear,), f"{text}; positionings are that much slower")


def step_in_the_curve(parameters: ParameterSet) -> Iterator[Notice]:
    """A hyperbola that does not start with the constant acceleration."""
    for gear in parameters.used_indexes("getriebe"):
        curve = curve_view(parameters, gear)
        if curve is None or curve.kind != "hyperbola":
            continue
        start = curve.b1 / (1.0 + curve.b2 * (1.0 + curve.b3) or 1.0)
        if abs(start - curve.constant) > SMALL_STEP * curve.constant:
            steps = f"starts with {start:g} °/s², P-AXIS-00007 is {curve.constant:g} °/s²"
            text = f"the hyperbola {steps}: a step in the curve"
            yield notice(parameters, ids.BESCHL_KENNLINIE_B1, (gear,), text)


def range_of_a_conveyor(parameters: ParameterSet) -> Iterator[Notice]:
    """The default suits a turntable, hardly a conveyor."""
    if parameters.axis_type != "T" or not is_modulo(parameters):
        return
    gear = active_gear(parameters)
    if not parameters.is_given(UPPER_END, gear):
        end = parameters.kernel(UPPER_END, gear)
        yield notice(parameters, UPPER_END, (gear,), f"not given, the modulo range of the axis ends at {end:g} mm")
