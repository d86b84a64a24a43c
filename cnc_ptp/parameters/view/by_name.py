"""A parameter of a unit by P number or name, as function blocks ask for it."""

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import AXIS_LETTERS, dotted
from cnc_ptp.parameters.read.parameter_set import Parameter, ParameterSet
from cnc_ptp.parameters.read.sections import unknown_name
from cnc_ptp.parameters.view.gears import active_gear

UNKNOWN_PARAMETER = 22169


def parameter_by_name(own: ParameterSet, name: str) -> Parameter:
    """P-AXIS-00236, P-AXIS-00236.0, getriebe[0].window or getriebe.0.window.

    A P number without index means, of a gear, that after start-up.

    Raises CncError 22169 when the unit does not have it.
    """
    number, *indexes = name.split(".")
    declaration = own.catalogue.by_id.get(number)
    given = tuple(int(index) for index in indexes if index.isdecimal() and index.isascii())
    of_gear = declaration is not None and declaration.key.startswith("getriebe.*") and declaration.index_count == 1
    if of_gear and not indexes:
        given = (active_gear(own),)
    if declaration is not None and len(given) == declaration.index_count and len(given) >= len(indexes):
        ros_name = declaration.ros_name(given)
    else:
        ros_name = dotted(name if declaration is None else declaration.list_style_name((0,) * declaration.index_count))
    try:
        found = own.find(ros_name)
    except KeyError:
        found = None
    if declaration is not None and len(given) < declaration.index_count and declaration.belongs_to(own.kind):
        zeros = (0,) * declaration.index_count
        example = f"{number}{'.0' * len(zeros)} is {declaration.list_style_name(zeros)}"
        reason = f"{number} ({declaration.name}) has an index: {example}"
        raise CncError(UNKNOWN_PARAMETER, reason, "nothing was read")
    if found is None:
        raise CncError(UNKNOWN_PARAMETER, unknown_name(ros_name, own.node, own.kind), "nothing was read")
    if reason := not_had(own, found):
        raise CncError(UNKNOWN_PARAMETER, reason, "nothing was read")
    return found


def not_had(own: ParameterSet, parameter: Parameter) -> str:
    """Why a unit does not have a parameter of its lists: an index outside of its array, another type of axis."""
    declaration, indexes, _ = parameter
    name = f"{declaration.id} {declaration.list_style_name(indexes)}"
    for index, array in zip(indexes, own.catalogue.sizes(declaration), strict=True):
        if index >= array.size:
            return f"{name}: index {index} is outside 0 to {array.size - 1}"
    letter = own.axis_type
    if letter and letter not in declaration.axes:
        fitting = " and ".join(AXIS_LETTERS[axis] for axis in declaration.axes)
        return f"{name}: only {fitting} have this parameter, {own.node} is one of the {AXIS_LETTERS[letter]}"
    return ""
