"""The data flow between units: which blocks each needs, in offline run, composed run and graph alike."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import count

from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.program.plc_program import PlcFile
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import EventValue, Severity
from cnc_ptp.protocol.commands import sources_of
from cnc_ptp.protocol.event_values import role_of
from cnc_ptp.protocol.unit import PLC, Unit
from cnc_ptp.spindle.spindle_unit import SpindleUnit

UNKNOWN_UNIT = 26111


@dataclass(frozen=True, slots=True)
class Inputs:
    """The blocks that a unit waits for before it computes block n."""

    upstream: tuple[str, ...]
    """Units whose block n is needed: they act in the same cycles."""
    feedback: tuple[str, ...]
    """Units whose block n - 1 is needed: they report back."""


def unit_kinds(machine: MachineParameters) -> dict[str, str]:
    """Unit name -> plc, channel, spindle or axis, in the order in which the blocks of one tick are computed."""
    kinds = {PLC: "plc"}
    kinds |= dict.fromkeys(machine.channels, "channel")
    kinds |= dict.fromkeys(machine.spindles, "spindle")
    return kinds | dict.fromkeys(machine.axes, "axis")


def wiring(machine: MachineParameters) -> dict[str, Inputs]:
    """Inputs of every unit: PLC -> channel -> axes, spindles; their reports reach PLC and channel a block later."""
    members = {
        name: [axis.node for axis in channel.axes] + [s.node for s in channel.spindles if not s.plc_control]
        for name, channel in machine.channels.items()
    }
    inputs = {PLC: Inputs((), tuple(name for name in unit_kinds(machine) if name != PLC))}
    inputs |= {name: Inputs((PLC,), tuple(units)) for name, units in members.items()}
    for unit in [*machine.spindles, *machine.axes]:
        channels = tuple(name for name, units in members.items() if unit in units)
        inputs[unit] = Inputs((PLC, *channels), ())
    return inputs


def build_unit(
    machine: MachineParameters,
    name: str,
    *,
    scenario: Iterable[Entry] = (),
    end_when_idle: bool = True,
    plc_file: PlcFile | None = None,
) -> Unit:
    """The unit `name` of the machine, at position 0, at a standstill.

    `scenario`, `end_when_idle` and `plc_file` are for the PLC, whose parameters are those of /machine; it publishes
    the warnings of the whole machine file. Raises CncError 25104 for a PLC file.
    """
    cycle_time = machine.cycle_time_us * 1e-6
    kinds = unit_kinds(machine)
    if kinds[name] == "axis":
        return AxisUnit(machine.axes[name], cycle_time=cycle_time, axes=machine.axes, spindles=machine.spindles)
    if kinds[name] == "spindle":
        names = tuple(machine.spindles)
        spindle = SpindleUnit(machine.spindles[name], cycle_time=cycle_time, spindles=names, axes=machine.axes)
        spindle.sources = sources_of(kinds)
        return spindle
    if kinds[name] == "channel":
        return ChannelUnit(
            machine.channels[name],
            axes=machine.axes,
            spindles=machine.spindles,
            cycle_time=cycle_time,
            request_numbers=count(1 + list(machine.channels).index(name), len(machine.channels)),
            handshake_timeout=machine.handshake_timeout_ms / 1000.0,
        )
    plc = PlcUnit(
        name,
        kinds=kinds,
        axes=machine.axes,
        scenario=scenario,
        cycle_time=cycle_time,
        end_when_idle=end_when_idle,
    )
    if plc_file is not None:
        plc.take_program(plc_file, machine.sets)
    for notice in machine.warnings:
        values = [EventValue(*value, role_of(value[0])) for value in notice.values]
        plc.event(0, Severity.WARNING, notice.error_id, str(notice), values=values)
    return plc


def build_units(
    machine: MachineParameters,
    *,
    scenario: Iterable[Entry] = (),
    end_when_idle: bool = True,
    plc_file: PlcFile | None = None,
) -> Mapping[str, Unit]:
    """All units, in the order in which the blocks of one tick are computed. Raises CncError 25104 for a PLC file."""
    return {
        name: build_unit(machine, name, scenario=scenario, end_when_idle=end_when_idle, plc_file=plc_file)
        for name in unit_kinds(machine)
    }
