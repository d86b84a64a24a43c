"""Limits that are other parameters of the same node."""

from collections.abc import Iterator

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare.declarations import Declaration, Limit
from cnc_ptp.parameters.errors import AT_RUN_TIME, Place, Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import Parameter, ParameterSet, parameter_limits
from cnc_ptp.parameters.read.values import shown, violates_lower, violates_upper, with_unit


def parameter_against_parameter(parameters: ParameterSet) -> Iterator[Problem]:
    """Limits that are other parameters. Two parameters that limit each other give one problem."""
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
    """The parameter that is the limit; None if the node does not have it or its value was refused."""
    declaration = parameters.catalogue.by_id[str(limit.value)]
    own_indexes = indexes[: declaration.index_count]
    name = declaration.ros_name(own_indexes)
    letter = parameters.axis_type
    if name in parameters.invalid or (letter and letter not in declaration.axes):
        return None
    return Parameter(declaration, own_indexes, parameters.value(declaration.id, *own_indexes))


def violation(parameters: ParameterSet, parameter: Parameter, limit: Limit, upper: bool, other: Parameter) -> str:
    """Text of the violation, empty if the value is within the limit."""
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
    """Of the parameter that a value is compared with, and where it has its own from."""
    given = parameters.given.get(declaration.ros_name(indexes))
    place = given.place if given else None
    return f"{declaration.id} {declaration.list_style_name(indexes)} {place_text(place, parameters.place.file)}"


def place_text(place: Place | None, file: str) -> str:
    if place is None:
        return "by default"
    if place == AT_RUN_TIME:
        return "as written at run time"
    return f"in line {place.line}" if place.file == file else f"in {place.file}, line {place.line}"
