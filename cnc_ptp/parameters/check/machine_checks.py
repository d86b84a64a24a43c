"""All checks of a machine: parameters against each other, channels against axes and spindles.

Each check yields Problems. Only `check_machine` is used by other modules.
"""

from collections.abc import Callable, Iterator

from cnc_ptp.errors import nearest_name
from cnc_ptp.parameters import errors
from cnc_ptp.parameters.check.axis_checks import (
    axis_type_fits,
    emergency_ramp,
    encoder_resolution,
    homing_of_an_axis,
    homing_without_cam,
    soft_limits_of_a_conveyor,
)
from cnc_ptp.parameters.check.channel_checks import CHANNEL_CHECKS
from cnc_ptp.parameters.check.control_checks import control_checks
from cnc_ptp.parameters.check.limit_checks import parameter_against_parameter
from cnc_ptp.parameters.check.spindle_checks import spindle_problems
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.authority import CLOSED_TO
from cnc_ptp.parameters.view.channel_members import Sets, axis_entries
from cnc_ptp.parameters.view.machine_view import PLC


def check_machine(machine: ParameterSet, sets: Sets) -> list[Problem]:
    """All cross-checks; `sets` has channels, axes and spindles by node name."""
    problems: list[Problem] = []
    for parameters in sets.values():
        for check in NODE_CHECKS[parameters.kind]:
            problems += check(parameters)
    problems += duplicate_numbers(sets)
    for parameters in sets.values():
        if parameters.kind == "channel":
            for channel_check in CHANNEL_CHECKS:
                problems += channel_check(parameters, sets)
    problems += axes_in_two_channels(sets)
    problems += unknown_closed_units(machine, sets)
    return problems


def unknown_closed_units(machine: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """The lists of command authority name units of the machine, or its PLC."""
    units = [*sets, PLC]
    for number in CLOSED_TO.values():
        for name in machine.names(number):
            if name not in units:
                near = nearest_name(name, units) or "."
                text = f"'{name}' is no unit{near} There are {', '.join(units)}"
                yield problem(machine, errors.UNIT_NAME, number, (), text)


def duplicate_numbers(sets: Sets) -> Iterator[Problem]:
    owners: dict[int, ParameterSet] = {}
    for parameters in sets.values():
        if parameters.kind == "channel" or parameters.is_invalid(ids.KOPF_ACHS_NR):
            continue
        number = int(parameters.number(ids.KOPF_ACHS_NR))
        owner = owners.setdefault(number, parameters)
        if owner is not parameters:
            text = f"value {number} is the logical axis number of /{owner.node} already"
            yield problem(parameters, errors.DUPLICATE_NUMBER, ids.KOPF_ACHS_NR, (), text)


def axes_in_two_channels(sets: Sets) -> Iterator[Problem]:
    """A path axis belongs to one channel; spindles may serve several."""
    owners: dict[str, str] = {}
    for channel in sets.values():
        if channel.kind != "channel":
            continue
        for entry in axis_entries(channel, sets):
            if entry.node and owners.setdefault(entry.node, channel.node) != channel.node:
                text = f"channel /{channel.node}: axis /{entry.node} belongs to channel /{owners[entry.node]} already"
                place = channel.where(ids.ACHSE_LOG_ACHS_NR, *entry.indexes) if entry.indexes else channel.place
                yield Problem(errors.DUPLICATE_NUMBER, place, text)


NODE_CHECKS: dict[str, tuple[Callable[[ParameterSet], Iterator[Problem]], ...]] = {
    "machine": (),
    "channel": (parameter_against_parameter,),
    "axis": (
        parameter_against_parameter,
        emergency_ramp,
        encoder_resolution,
        axis_type_fits,
        homing_without_cam,
        homing_of_an_axis,
        soft_limits_of_a_conveyor,
        control_checks,
    ),
    "spindle": (
        parameter_against_parameter,
        emergency_ramp,
        encoder_resolution,
        axis_type_fits,
        homing_without_cam,
        control_checks,
        spindle_problems,
    ),
}
