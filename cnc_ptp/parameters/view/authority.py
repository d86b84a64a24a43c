"""Command authority: for which sources of commands the machine file closes a unit."""

from collections.abc import Iterable, Mapping
from typing import Final

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet

OF_PLC: Final = "the PLC"
"""Scenario, PLC in a file, HLI, and the program that is given at the start."""
OF_CHANNELS: Final = "channels"
OF_TOPICS: Final = "topics"
OF_SERVICES: Final = "services"
"""Services, actions and parameters of ROS: the command line, clients, and pages among them."""
OF_PAGES: Final = "pages"
"""The web face."""
CLOSED_TO: Final[dict[str, str]] = {
    OF_PLC: ids.CLOSED_TO_PLC,
    OF_CHANNELS: ids.CLOSED_TO_CHANNELS,
    OF_TOPICS: ids.CLOSED_TO_TOPICS,
    OF_SERVICES: ids.CLOSED_TO_SERVICES,
    OF_PAGES: ids.CLOSED_TO_PAGES,
}
"""Source of commands -> the parameter of the machine with the units that it does not command."""


def closed_units(machine: ParameterSet, units: Iterable[str]) -> Mapping[str, tuple[str, ...]]:
    """Unit -> the sources that do not command it, of those that are closed to any."""
    lists = {source: machine.names(number) for source, number in CLOSED_TO.items()}
    closed = {unit: tuple(source for source, names in lists.items() if unit in names) for unit in units}
    return {unit: sources for unit, sources in closed.items() if sources}
