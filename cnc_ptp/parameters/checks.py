"""What no single value shows: parameters against each other, channels against axes and spindles.

Each check yields Problems. Only `check_machine` is for others.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.channels import ChannelAxisEntry, axis_entries, is_path_axis, spindle_entries
from cnc_ptp.parameters.control_checks import control_checks
from cnc_ptp.parameters.declarations import Declaration, Limit
from cnc_ptp.parameters.encoder import uses_feed_constant
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.parameter_set import Parameter, ParameterSet, parameter_limits
from cnc_ptp.parameters.problems import problem
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


# ---------------------------------------------------------------- a channel against axes and spindles


def channel_axes(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """Each listed axis exists, is a path axis, is listed once, has a name of its own."""
    yield from listed_units(channel, axis_entries(channel, sets), "P-CHAN-00035", "P-CHAN-00006", sets)


def channel_spindles(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """The same for spindles."""
    yield from listed_units(channel, spindle_entries(channel, sets), "P-CHAN-00036", "P-CHAN-00007", sets)


def listed_units(
    channel: ParameterSet, entries: Sequence[ChannelAxisEntry], number: str, name: str, sets: Sets
) -> Iterator[Problem]:
    wants_spindle = number == "P-CHAN-00036"
    names: dict[str, ChannelAxisEntry] = {}
    numbers: dict[int, ChannelAxisEntry] = {}
    for entry in entries:
        if entry.indexes and not channel.is_invalid(number, *entry.indexes):
            text, error_id = unit_trouble(entry, wants_spindle, sets, numbers)
            if text:
                yield problem(channel, error_id, number, entry.indexes, text)
        yield from name_trouble(channel, entry, name, names)


def unit_trouble(
    entry: ChannelAxisEntry, wants_spindle: bool, sets: Sets, numbers: dict[int, ChannelAxisEntry]
) -> tuple[str, int]:
    if entry.number == 0:
        return "no logical axis number is given", errors.NO_SUCH_AXIS
    if entry.node is None:
        known = ", ".join(
            f"{int(unit.number('P-AXIS-00016'))} /{unit.node}" for unit in sets.values() if unit.kind != "channel"
        )
        return f"value {entry.number} is no logical axis number of the machine ({known or 'none'})", errors.NO_SUCH_AXIS
    unit = sets[entry.node]
    if is_path_axis(unit) == wants_spindle:
        kinds = ("a path axis", "a spindle") if wants_spindle else ("a spindle", "a path axis")
        return f"value {entry.number} is /{entry.node}, {kinds[0]} cannot be {kinds[1]}", errors.AXIS_TYPE
    if numbers.setdefault(entry.number, entry) is not entry:
        return f"value {entry.number} is listed twice in the channel", errors.DUPLICATE_NUMBER
    return "", 0


def name_trouble(
    channel: ParameterSet, entry: ChannelAxisEntry, name: str, names: dict[str, ChannelAxisEntry]
) -> Iterator[Problem]:
    """A program name has the right first letter (a name made of the node name may not) and is used once."""
    letters, listed_as = ("S", "spindel[i]") if name == "P-CHAN-00007" else ("ABCUVWXYZQ", "gruppe[i].achse[j]")
    if not entry.name:
        return
    if entry.name[0] not in letters:
        rule = f"the first letter must be one of {', '.join(letters)}: give {listed_as}.bezeichnung"
        text = f"/{entry.node} would be called {entry.name}, {rule}"
    elif names.setdefault(entry.name, entry) is not entry:
        text = f"program name {entry.name} is used twice"
    else:
        return
    place = channel.where(name, *entry.indexes) if entry.indexes else channel.place
    yield Problem(errors.UNIT_NAME, place, f"channel /{channel.node}: {text}")


def axis_count(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    for group in channel.used_indexes("gruppe"):
        count = len(channel.used_indexes(f"gruppe.{group}.achse"))
        value = channel.number("P-CHAN-00003", group)
        if channel.is_given("P-CHAN-00003", group) and value != count:
            text = f"value {value}, but {count} axes are listed (achse[j])"
            yield problem(channel, errors.COUNT, "P-CHAN-00003", (group,), text)


def spindle_count(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    count = len(channel.used_indexes("spindel"))
    value = channel.number("P-CHAN-00082")
    if value != count and not channel.is_invalid("P-CHAN-00082") and (count or channel.is_given("P-CHAN-00082")):
        text = f"value {value}, but {count} spindles are listed (spindel[i])"
        yield problem(channel, errors.COUNT, "P-CHAN-00082", (), text)


def main_spindle(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    listed = [int(channel.number("P-CHAN-00036", index)) for index in channel.used_indexes("spindel")]
    number = int(channel.number("P-CHAN-00051"))
    if number in listed or channel.is_invalid("P-CHAN-00051") or not (listed or number):
        return
    numbers = ", ".join(map(str, listed)) or "none"
    given = f"value {number} is" if number else "no value is given, it must be"
    text = f"{given} {'none' if number else 'one'} of the channel's spindles ({numbers})"
    yield problem(channel, errors.MAIN_SPINDLE, "P-CHAN-00051", (), text)


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
    "axis": (parameter_against_parameter, emergency_ramp, encoder_resolution, axis_type_fits, control_checks),
    "spindle": (parameter_against_parameter, emergency_ramp, encoder_resolution, axis_type_fits, control_checks),
}
CHANNEL_CHECKS = (channel_axes, channel_spindles, axis_count, spindle_count, main_spindle)
