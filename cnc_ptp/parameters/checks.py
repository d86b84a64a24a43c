"""What no single value shows: parameters against each other, channels against axes and spindles.

Each check yields Problems. Only `check_machine` is for others.
"""

from collections.abc import Callable, Iterator, Mapping

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.channel_checks import CHANNEL_CHECKS
from cnc_ptp.parameters.channels import axis_entries
from cnc_ptp.parameters.control_checks import control_checks
from cnc_ptp.parameters.declarations import Declaration, Limit
from cnc_ptp.parameters.encoder import uses_feed_constant
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.modulo import soft_limits_of_a_conveyor
from cnc_ptp.parameters.parameter_set import Parameter, ParameterSet, parameter_limits
from cnc_ptp.parameters.problems import problem
from cnc_ptp.parameters.spindle_checks import spindle_problems
from cnc_ptp.parameters.values import shown, violates_lower, violates_upper, with_unit

Sets = Mapping[str, ParameterSet]


def check_machine(sets: Sets) -> list[Problem]:
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
    return problems


# ---------------------------------------------------------------- inside one node


def parameter_against_parameter(parameters: ParameterSet) -> Iterator[Problem]:
    """Limits that are other parameters. A pair that limits itself both ways gives one problem."""
    reported: set[frozenset[tuple[str, tuple[int, ...]]]] = set()
    for parameter in parameters.parameters():
        declaration, indexes, value = parameter
        if parameter.ros_name not in parameters.given or value == declaration.unset:
            continue
        for limit, upper in parameter_limits(declaration):
            other = limiting_parameter(parameters, limit, indexes)
            if other is None:
                continue
            pair = frozenset([(declaration.id, indexes), (other.declaration.id, other.indexes)])
            text = violation(parameters, parameter, limit, upper, other)
            if text and pair not in reported:
                reported.add(pair)
                yield problem(parameters, errors.CONTRADICTION, declaration.id, indexes, text)


def limiting_parameter(parameters: ParameterSet, limit: Limit, indexes: tuple[int, ...]) -> Parameter | None:
    """The parameter that is the limit; None where the node does not have it or its value was refused."""
    declaration = parameters.catalogue.by_id[str(limit.value)]
    own_indexes = indexes[: declaration.index_count]
    name = declaration.ros_name(own_indexes)
    letter = parameters.axis_type
    if name in parameters.invalid or (letter and letter not in declaration.axes):
        return None
    return Parameter(declaration, own_indexes, parameters.value(declaration.id, *own_indexes))


def violation(parameters: ParameterSet, parameter: Parameter, limit: Limit, upper: bool, other: Parameter) -> str:
    """Text of the violation, empty when the value keeps the limit."""
    value = parameters.number(parameter.declaration.id, *parameter.indexes)
    bound = parameters.number(other.declaration.id, *other.indexes)
    if not (violates_upper if upper else violates_lower)(value, limit, bound):
        return ""
    words = {
        (True, True): "is above the maximum",
        (True, False): "is not below",
        (False, True): "is below the minimum",
        (False, False): "is not above",
    }[upper, limit.inclusive]
    name = other_name(parameters, other.declaration, other.indexes)
    return f"value {shown(value)} {words} {with_unit(shown(bound), parameters.unit(other.declaration.id))} of {name}"


def other_name(parameters: ParameterSet, declaration: Declaration, indexes: tuple[int, ...]) -> str:
    place = parameters.given.get(declaration.ros_name(indexes))
    origin = f"in line {place.place.line}" if place else "by default"
    return f"{declaration.id} {declaration.list_style_name(indexes)} {origin}"


def emergency_ramp(parameters: ParameterSet) -> Iterator[Problem]:
    """P-AXIS-00003 is at most twice P-AXIS-00008."""
    for gear in parameters.used_indexes("getriebe"):
        value, limit = parameters.number("P-AXIS-00003", gear), 2 * parameters.number("P-AXIS-00008", gear)
        if value > limit:
            name = other_name(parameters, parameters.catalogue.by_id["P-AXIS-00008"], (gear,))
            text = f"value {value} is above the maximum {limit} {parameters.unit('P-AXIS-00003')}, twice {name}"
            yield problem(parameters, errors.CONTRADICTION, "P-AXIS-00003", (gear,), text)


def encoder_resolution(parameters: ParameterSet) -> Iterator[Problem]:
    """The resolution must not be zero, nor given by both methods."""
    if not uses_feed_constant(parameters):
        return
    for gear in sorted({0, *parameters.used_indexes("getriebe")}):
        if parameters.number("P-AXIS-00092", gear) == 0:
            text = "value 0 makes the encoder resolution zero, P-AXIS-00362 and P-AXIS-00363 (feed constant) are in use"
            yield problem(parameters, errors.RESOLUTION, "P-AXIS-00092", (gear,), text)
        for number in ("P-AXIS-00234", "P-AXIS-00233"):
            value = parameters.number(number, gear)
            if value != 1:
                text = f"value {value} must be 1, P-AXIS-00362 and P-AXIS-00363 (feed constant) give the resolution"
                yield problem(parameters, errors.RESOLUTION, number, (gear,), text)


def axis_type_fits(parameters: ParameterSet) -> Iterator[Problem]:
    """Path axes under `axes`, spindles under `spindles`."""
    spindle = parameters.axis_type == "S"
    if spindle != (parameters.kind == "spindle"):
        value = parameters.text("P-AXIS-00018")
        listed, belongs = ("axes", "spindles") if spindle else ("spindles", "axes")
        text = f"value {value} does not fit, /machine has /{parameters.node} under {listed}, it belongs under {belongs}"
        yield problem(parameters, errors.AXIS_TYPE, "P-AXIS-00018", (), text)


def duplicate_numbers(sets: Sets) -> Iterator[Problem]:
    owners: dict[int, ParameterSet] = {}
    for parameters in sets.values():
        if parameters.kind == "channel" or parameters.is_invalid("P-AXIS-00016"):
            continue
        number = int(parameters.number("P-AXIS-00016"))
        owner = owners.setdefault(number, parameters)
        if owner is not parameters:
            text = f"value {number} is the logical axis number of /{owner.node} already"
            yield problem(parameters, errors.DUPLICATE_NUMBER, "P-AXIS-00016", (), text)


def axes_in_two_channels(sets: Sets) -> Iterator[Problem]:
    """A path axis belongs to one channel; spindles may serve several."""
    owners: dict[str, str] = {}
    for channel in sets.values():
        if channel.kind != "channel":
            continue
        for entry in axis_entries(channel, sets):
            if entry.node and owners.setdefault(entry.node, channel.node) != channel.node:
                text = f"channel /{channel.node}: axis /{entry.node} belongs to channel /{owners[entry.node]} already"
                place = channel.where("P-CHAN-00035", *entry.indexes) if entry.indexes else channel.place
                yield Problem(errors.DUPLICATE_NUMBER, place, text)


NODE_CHECKS: dict[str, tuple[Callable[[ParameterSet], Iterator[Problem]], ...]] = {
    "machine": (),
    "channel": (parameter_against_parameter,),
    "axis": (
        parameter_against_parameter,
        emergency_ramp,
        encoder_resolution,
        axis_type_fits,
        soft_limits_of_a_conveyor,
        control_checks,
    ),
    "spindle": (
        parameter_against_parameter,
        emergency_ramp,
        encoder_resolution,
        axis_type_fits,
        control_checks,
        spindle_problems,
    ),
}
