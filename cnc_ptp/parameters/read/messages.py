"""Messages about one parameter of a machine file: a problem stops the node, a notice goes to the log."""

from typing import NamedTuple

from cnc_ptp.parameters.errors import Place, Problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet

GENERAL = 26120
"""Number of notices without a number of their own."""


OWN_UNIT = "="
"""In place of the unit of a value: that of the parameter."""


class Notice(NamedTuple):
    """A value that is corrected, or has an effect that its author may not expect: one line for the log.

    As text: place, number, name and node of the parameter, then the message.
    """

    place: Place
    parameter: str
    """P-AXIS-00389 vorsteuer.velocity_delay_time of /x"""
    text: str
    error_id: int
    values: tuple[tuple[str, float, str], ...]
    """The numbers of the text: name, value, unit."""

    def __str__(self) -> str:
        return f"{self.place}: {self.parameter}: {self.text}"


def problem(parameters: ParameterSet, error_id: int, number: str, indexes: tuple[int, ...], text: str) -> Problem:
    """A problem with one parameter of a node."""
    subject = parameters.catalogue.by_id[number].subject(indexes, parameters.node)
    return Problem(error_id, parameters.where(number, *indexes), f"{subject}: {text}")


def notice(
    parameters: ParameterSet,
    number: str,
    indexes: tuple[int, ...],
    text: str,
    *,
    error_id: int = GENERAL,
    values: tuple[tuple[str, float, str], ...] = (),
) -> Notice:
    """The notice about a parameter; `error_id` is the vendor's number if there is one."""
    declaration = parameters.catalogue.by_id[number]
    value = parameters.number(number, *indexes) if declaration.type in ("int", "float") else None
    unit = declaration.unit_for(parameters.axis_type or "T")
    own = () if value is None else ((number, float(value), unit),)
    values = tuple((name, amount, unit if of == OWN_UNIT else of) for name, amount, of in values)
    subject = f"{number} {declaration.list_style_name(indexes)} of /{parameters.node}"
    return Notice(parameters.where(number, *indexes), subject, text, error_id, (*own, *values))
