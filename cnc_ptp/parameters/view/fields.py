"""Fields of a view that are parameters. Each has the id of its parameter in the annotation:

max_velocity: Annotated[float, ids.DYNAMIK_VB_MAX]
"""

from collections.abc import Callable
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.synchronisation import Synchronisation, synchronisation

READERS: dict[type, Callable[..., Any]] = {
    float: ParameterSet.kernel,
    int: lambda parameters, number, *indexes: int(parameters.number(number, *indexes)),
    bool: lambda parameters, number, *indexes: bool(parameters.number(number, *indexes)),
    Synchronisation: lambda parameters, number, *indexes: synchronisation(parameters.text(number, *indexes)),
}


def given_fields(view: type, parameters: ParameterSet, *indexes: int) -> dict[str, Any]:
    """Field -> value of those fields of a class that are parameters: floats in kernel units, the others as in the list.

    `indexes` are those of the record (the gear, the spindle of a channel …); a parameter takes as many as it needs.
    """
    return {name: READERS[kind](parameters, number, *indexes) for name, kind, number in parameter_fields(view)}


@cache
def parameter_fields(view: type) -> tuple[tuple[str, type, str], ...]:
    """Name, type and parameter id of the fields of a class that are parameters."""
    hints = get_type_hints(view, include_extras=True).items()
    return tuple((name, *get_args(hint)) for name, hint in hints if get_origin(hint) is Annotated)
