"""A notice about one parameter of a machine file: what is corrected, or what its author may not expect."""

from typing import NamedTuple

from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.parameter_set import ParameterSet

GENERAL = 26120
"""Number of notices that have none of their own."""


class Notice(NamedTuple):
    """One line for the log; as text: place, number, name and node of the parameter, then what there is to say."""

    place: Place
    parameter: str
    """P-AXIS-00389 vorsteuer.velocity_delay_time of /x"""
    text: str
    error_id: int
    values: tuple[tuple[str, float, str], ...]
    """The numbers of the text: name, value, unit."""

    def __str__(self) -> str:
        return f"{self.place}: {self.parameter}: {self.text}"


def line(
    parameters: ParameterSet,
    number: str,
    indexes: tuple[int, ...],
    text: str,
    *,
    error_id: int = GENERAL,
    values: tuple[tuple[str, float, str], ...] = (),
) -> Notice:
    """The notice about a parameter; `error_id` is the vendor's number where there is one."""
    declaration = parameters.catalogue.by_id[number]
    value = parameters.number(number, *indexes) if declaration.type in ("int", "float") else None
    own = () if value is None else ((number, float(value), declaration.unit_for(parameters.axis_type or "T")),)
    subject = f"{number} {declaration.list_style_name(indexes)} of /{parameters.node}"
    return Notice(parameters.where(number, *indexes), subject, text, error_id, (*own, *values))
