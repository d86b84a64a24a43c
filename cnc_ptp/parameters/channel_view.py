"""A channel as the kernel uses it: its axes and spindles by program name, synchronisation of functions, path limits."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from cnc_ptp.parameters.channels import axis_entries, main_spindle_number, spindle_entries
from cnc_ptp.parameters.parameter_set import ParameterSet
from cnc_ptp.parameters.synchronisation import Synchronisation, synchronisation

INTERNAL_M_FUNCTIONS = (0, 1, 2, 3, 4, 5, 17, 19, 29, 30)


class ChannelAxis(NamedTuple):
    """An axis of a channel: what programs call it ("X") and its node ("x")."""

    name: str
    node: str


class ChannelSpindle(NamedTuple):
    """A spindle of a channel with the synchronisation of its functions."""

    name: str
    node: str
    m3: Synchronisation
    m4: Synchronisation
    m5: Synchronisation
    m19: Synchronisation
    s: Synchronisation


@dataclass(frozen=True, slots=True)
class ChannelParameters:
    """An NC channel."""

    name: str
    axes: tuple[ChannelAxis, ...]
    spindles: tuple[ChannelSpindle, ...]
    main_spindle: str
    """Program name of the main spindle, empty when the channel has no spindle."""
    m_functions: Mapping[int, Synchronisation]
    """Synchronisation by M number; an M function that is missing here does not exist on the machine."""
    max_override_percent: float
    circle_center_tolerance: float
    """Largest shift of an arc's centre in mm …"""
    circle_center_ratio: float
    """… and as a part of its radius."""


def channel_view(channel: ParameterSet, sets: Mapping[str, ParameterSet]) -> ChannelParameters:
    spindles = spindle_entries(channel, sets)
    main = main_spindle_number(channel, spindles)
    return ChannelParameters(
        name=channel.node,
        axes=tuple(ChannelAxis(entry.name, str(entry.node)) for entry in axis_entries(channel, sets)),
        spindles=tuple(channel_spindle(channel, entry.name, str(entry.node), entry.indexes) for entry in spindles),
        main_spindle=next((entry.name for entry in spindles if entry.number == main), ""),
        m_functions=m_functions(channel),
        max_override_percent=channel.percent("P-CHAN-00056"),
        circle_center_tolerance=channel.kernel("P-CHAN-00059"),
        circle_center_ratio=channel.kernel("P-CHAN-00060"),
    )


def channel_spindle(channel: ParameterSet, name: str, node: str, indexes: tuple[int, ...]) -> ChannelSpindle:
    numbers = ("P-CHAN-00045", "P-CHAN-00047", "P-CHAN-00049", "P-CHAN-00043", "P-CHAN-00081")
    m3, m4, m5, m19, s = (synchronisation(channel.text(number, *indexes)) for number in numbers)
    return ChannelSpindle(name, node, m3, m4, m5, m19, s)


def m_functions(channel: ParameterSet) -> dict[int, Synchronisation]:
    functions = dict.fromkeys(INTERNAL_M_FUNCTIONS, Synchronisation.NO_SYNCH)
    for number in channel.used_indexes("m_synch"):
        constants = channel.text("P-CHAN-00041", number)
        if constants != "NOT_VALID":
            functions[number] = synchronisation(constants)
    return dict(sorted(functions.items()))
