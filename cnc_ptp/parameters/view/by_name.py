"""A parameter of a unit by P number or name, as function blocks ask for it."""

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import dotted
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
        ros_name = dotted(name if declaration is None else declaration.name)
    try:
        found = own.find(ros_name)
    except KeyError:
        found = None
    if declaration is not None and len(given) < declaration.index_count and declaration.belongs_to(own.kind):
        zeros = (0,) * declaration.index_count
        example = f"{number}{'.0' * len(zeros)} is {declaration.list_style_name(zeros)}"
        reason = f"{number} ({declaration.name}) has an index: {example}"
        raise CncError(UNKNOWN_PARAMETER, reason, "nothing was read")
    if found is None or not has(own, found):
        raise CncError(UNKNOWN_PARAMETER, unknown_name(ros_name, own.node, own.kind), "nothing was read")
    return found


def has(own: ParameterSet, parameter: Parameter) -> bool:
    """Its indexes are within its arrays, and it is one for this type of axis."""
    declaration = parameter.declaration
    sizes = [array.size for array in own.catalogue.sizes(declaration)]
    within = all(index < size for index, size in zip(parameter.indexes, sizes, strict=True))
    return within and (not own.axis_type or own.axis_type in declaration.axes)
