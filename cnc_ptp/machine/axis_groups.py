"""Master/slave groups as the PLC sees them: what couplings need to know, and how errors spread (TX1250 3.1)."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping

from cnc_ptp.axis.faults import GANTRY_DIFFERENCE
from cnc_ptp.machine.blocks import AxisBlock, AxisStateCode, Block, Command, StatusBit
from cnc_ptp.machine.commands import COUPLINGS
from cnc_ptp.parameters import AxisParameters

STANDING = (AxisStateCode.DISABLED, AxisStateCode.STANDSTILL, AxisStateCode.ERROR_STOP)
STARTS = frozenset({"move_absolute", "move_relative", "move_modulo", "external_enable"})


class AxisGroups:
    """Who is whose master, from what the axes reported for the block before and from the commands of this one.

    An error of an axis reaches the others of its group by `group_error`: at once, or after the delay of the axis, and
    then those that are still in the group.
    """

    def __init__(self, axes: Mapping[str, AxisParameters], *, cycle_time: float, spindles: Container[str] = ()) -> None:
        """`axes` and `spindles` of the machine by name, `cycle_time` in s."""
        self._axes = axes
        self._spindles = spindles
        self._cycle_time = cycle_time
        self._masters: dict[str, str] = {}
        self._leads: dict[str, str] = {}
        self._blocks: dict[str, AxisBlock] = {}
        self._errors: dict[str, int | None] = {}
        """Axes in error -> cycle at which the others are told, None when they have been."""

    def report(self, first_cycle: int, inputs: Mapping[str, Block]) -> Iterator[Command]:
        """Takes the blocks before `first_cycle`; gives the commands that follow from them."""
        self._blocks = {name: block for name, block in inputs.items() if isinstance(block, AxisBlock)}
        self._masters = {name: block.master for name, block in self._blocks.items() if block.master}
        for name, block in self._blocks.items():
            if not block.error_id[-1]:
                self._errors.pop(name, None)
            elif name not in self._errors:
                self._errors[name] = first_cycle + self._delay(name)
        for name, due in list(self._errors.items()):
            if due is not None and first_cycle >= due:
                self._errors[name] = None
                yield from self._spread(name)

    def _delay(self, name: str) -> int:
        parameters = self._axes[name]
        torn = self._blocks[name].error_id[-1] == GANTRY_DIFFERENCE
        if torn or not parameters.error_propagation_delayed:
            return 0
        return round(parameters.error_propagation_delay / self._cycle_time)

    def _spread(self, name: str) -> Iterator[Command]:
        error = self._blocks[name].error_id[-1]
        for member in self._axes:
            if member != name and member not in self._errors and self._root(member) == self._root(name):
                self._errors[member] = None
                yield Command(member, "group_error", {"source": name, "error": error})

    def _root(self, name: str) -> str:
        return ([name, *self.above(name)])[-1]

    def above(self, name: str) -> list[str]:
        """The masters of an axis, the nearest first."""
        chain: list[str] = []
        while name in self._masters and self._masters[name] not in chain:
            name = self._masters[name]
            chain.append(name)
        return chain

    def complete(self, commands: Iterable[Command], lost: Container[str]) -> list[Command]:
        """The commands of a block, couplings with what their axis needs to know; masters are told of their slaves."""
        started: set[str] = set()
        completed = []
        edges = {slave: [master] for slave, master in self._masters.items()}
        for command in commands:
            master = command.arguments.get("master")
            if command.target in self._spindles:
                pass  # couples otherwise (spindle_groups.py)
            elif command.command in COUPLINGS and isinstance(master, str):
                above = reachable(edges, master)
                stands = self._stands(master) and not started & {master, *above}
                group = {"above": above, "master_stands": stands, "master_lost": master in lost}
                command.arguments = {**command.arguments, **group}
                if command.target not in (master, *above):
                    edges.setdefault(command.target, []).append(master)
                    self._masters[command.target] = master
            elif command.command in STARTS:
                started.add(command.target)
            elif command.command == "decouple":
                self._masters.pop(command.target, None)
                if not command.arguments:  # what has arguments may be refused for them
                    edges.pop(command.target, None)
            completed.append(command)
        return completed + list(self._lead_commands())

    def _stands(self, name: str) -> bool:
        block = self._blocks.get(name)
        if block is None:
            return True
        slave = bool(block.master) and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION
        still = block.set_velocity[-1] == 0.0 and block.set_acceleration[-1] == 0.0
        still = still and not block.status_bits[-1] & StatusBit.HAS_JOB  # held by override 0, or in its first cycle
        return still and (slave or block.state[-1] in STANDING)

    def _lead_commands(self) -> Iterator[Command]:
        """Tells masters whom they have got and lost."""
        now = {slave: master for slave, master in self._masters.items() if master in self._axes}
        for slave, master in self._leads.items():
            if now.get(slave) != master:
                yield Command(master, "lead", {"slave": slave, "on": False})
        for slave, master in now.items():
            if self._leads.get(slave) != master:
                yield Command(master, "lead", {"slave": slave, "on": True})
        self._leads = now


def reachable(edges: Mapping[str, Iterable[str]], name: str) -> list[str]:
    """All masters above an axis when each coupling that there was, or may come, in this block holds.

    An axis may refuse a `couple`, and a `decouple` with arguments: whatever it says, no circle can come about.
    """
    found: list[str] = []
    for master in edges.get(name, ()):
        found += [each for each in (master, *reachable(edges, master)) if each not in found]
    return found
