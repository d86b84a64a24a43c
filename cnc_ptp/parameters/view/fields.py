"""Fields of a view that are parameters. Each has the id of its parameter in the annotation:

max_velocity: Annotated[float, ids.DYNAMIK_VB_MAX]
"""

from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints

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


View = TypeVar("View")


def with_changes(view: View, before: Any, after: Any) -> View:
    """A view with what differs between two others of its class: a change of the list they were made of."""
    changes: dict[str, Any] = {}
    for name in (field.name for field in fields(view)):  # type: ignore[arg-type]
        own, old, new = (getattr(each, name) for each in (view, before, after))
        if old != new:
            nested = is_dataclass(own) and type(own) is type(old) is type(new) and name != "raw"
            changes[name] = with_changes(own, old, new) if nested else new
    return replace(view, **changes)  # type: ignore[type-var]


@cache
def parameter_fields(view: type) -> tuple[tuple[str, type, str], ...]:
    """Name, type and parameter id of the fields of a class that are parameters."""
    hints = get_type_hints(view, include_extras=True).items()
    return tuple((name, *get_args(hint)) for name, hint in hints if get_origin(hint) is Annotated)
