"""The commands of a recording, by the cycles in which a machine that computes the run again takes them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator

from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.authority import NOT_AUTHORISED
from cnc_ptp.protocol.blocks import Command, CommandRecord
from cnc_ptp.protocol.commands import THROUGH_PLC
from cnc_ptp.protocol.unit import PLC

ByCycle = dict[int, list[CommandRecord]]


def no_progress(_outputs: Outputs) -> None:
    """For runs that nobody watches."""


def commands_by_cycle(records: Iterable[CommandRecord], machine: MachineParameters) -> ByCycle:
    """Those to channels, spindles and axes; what the PLC made of its own are among them."""
    by_cycle: ByCycle = defaultdict(list)
    for record in records:
        if record.target != PLC and not may_be_refused_by_plc(record, machine):
            by_cycle[record.cycle].append(record)
    return by_cycle


def may_be_refused_by_plc(record: CommandRecord, machine: MachineParameters) -> bool:
    """It changed nothing, and the PLC's reason is not recorded: fed in again, it might be carried out."""
    return not record.accepted and record.command in THROUGH_PLC and record.target in machine.axes


def by_unit(commands: Iterable[Command]) -> dict[str, list[Command]]:
    units: dict[str, list[Command]] = defaultdict(list)
    for command in commands:
        units[command.target].append(command)
    return units


def fresh_machine(machine: MachineParameters) -> OfflineMachine:
    """Units that do not end on their own."""
    return OfflineMachine(machine, build_units(machine, end_when_idle=False))


def computed_again(offline: OfflineMachine, commands: ByCycle, end: int) -> Iterator[Outputs]:
    """The blocks up to the cycle `end`, as they were recorded."""
    while offline.next_cycle < end:
        given = refused_again(offline, commands.get(offline.next_cycle, ()))
        yield offline.replay_tick(by_unit(Command.from_record(record) for record in given))


def refused_again(offline: OfflineMachine, records: Iterable[CommandRecord]) -> list[CommandRecord]:
    """Those whose source had no authority are refused as they were; the others are returned.

    Who gave a command is not recorded: fed in again, they might be carried out.
    """
    others = []
    for record in records:
        if record.error_id == NOT_AUTHORISED:
            offline.runner(record.target).refuse_again(record)
        else:
            others.append(record)
    return others
