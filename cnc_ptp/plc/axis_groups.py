"""Master/slave groups as the PLC sees them: what couplings need to know, and how errors spread (TX1250 3.1)."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping

from cnc_ptp.parameters import AxisParameters
from cnc_ptp.protocol.axis_states import REST_STATES, AxisStateCode, StatusBit
from cnc_ptp.protocol.blocks import AxisBlock, Command, CycleBlock
from cnc_ptp.protocol.commands import COUPLINGS

STARTS = frozenset(
    {
        "move_absolute",
        "move_relative",
        "move_modulo",
        "move_additive",
        "move_velocity",
        "move_superimposed",
        "jog",
        "begin_trajectory",
        "external_enable",
    }
)
CHANGES_OF_COUPLINGS = COUPLINGS | {"decouple", "set_coupling_factor", "set_cyclic_factor", "change_cam"}


class AxisGroups:
    """Who is whose master, from the axes' reports for the previous block and the commands of this one.

    An error of an axis reaches the others of its group by `group_error`: immediately, or after the delay of the axis,
    and then those that are still in the group.
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
        """Axes in error -> cycle at which the others are notified, None when they have been."""

    def report(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> Iterator[Command]:
        """Takes the blocks of the cycles before `first_cycle`; gives the commands that follow from them."""
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
        """None for the slave of a gantry pair, which in error continues with its master until that stops."""
        parameters = self._axes[name]
        waits = self._blocks[name].state[-1] == AxisStateCode.SYNCHRONIZED_MOTION
        if waits or not parameters.error_propagation_delayed:
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

    def complete(self, commands: Iterable[Command], lost: Container[str]) -> tuple[list[Command], list[Command]]:
        """The commands of a block, and those that have to wait for the next one.

        Couplings get what their axis needs to know; masters are notified of their slaves.
        """
        block = CommandsOfBlock(self._masters)
        for command in commands:
            if command.target in self._spindles:  # couples otherwise (spindle_answers.py)
                block.completed.append(command)
            elif not block.must_wait(command):
                master = master_in(command)
                if master is not None:
                    above = block.above(master)
                    command.arguments = {
                        **command.arguments,
                        "above": above,
                        "master_stands": self._stands(master),
                        "master_start": block.start_of(master, *above),
                        "master_lost": master in lost,
                    }
                block.add(command)
        self._masters = block.masters
        return block.completed + list(self._lead_commands()), block.waiting

    def _stands(self, name: str) -> bool:
        block = self._blocks.get(name)
        if block is None:
            return True
        slave = bool(block.master) and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION
        still = block.set_velocity[-1] == 0.0 and block.set_acceleration[-1] == 0.0
        still = still and not block.status_bits[-1] & StatusBit.HAS_JOB  # held by override 0, or in its first cycle
        return still and (slave or block.state[-1] in REST_STATES)

    def _lead_commands(self) -> Iterator[Command]:
        """Notifies masters of the slaves that they have got and lost."""
        now = {slave: master for slave, master in self._masters.items() if master in self._axes}
        for slave, master in self._leads.items():
            if now.get(slave) != master:
                yield Command(master, "lead", {"slave": slave, "enabled": False})
        for slave, master in now.items():
            if self._leads.get(slave) != master:
                yield Command(master, "lead", {"slave": slave, "enabled": True})
        self._leads = now


class CommandsOfBlock:
    """The commands of one block in their order. Whether their axes carry them out is seen in the next block only."""

    def __init__(self, masters: Mapping[str, str]) -> None:
        """`masters`: slave -> master, as the axes have reported."""
        self.masters = dict(masters)
        """The same when all of these commands are carried out."""
        self._started: dict[str, str] = {}
        """Axes that may start in this block -> by which command."""
        self.completed: list[Command] = []
        self.waiting: list[Command] = []
        self._waiting_axes: set[str] = set()
        """Axes of the couplings that wait."""
        self._certain = {slave: [master] for slave, master in masters.items()}
        self._possible = {slave: [*above] for slave, above in self._certain.items()}

    def above(self, master: str) -> list[str]:
        """All masters above `master` when each coupling that there was, or may come, holds."""
        return reachable(self._possible, master)

    def start_of(self, *axes: str) -> str:
        """The command that may start one of these axes, as text; empty without one."""
        return next((f"{self._started[axis]} of {axis}" for axis in axes if axis in self._started), "")

    def must_wait(self, command: Command) -> bool:
        """Keeps back a coupling that runs in a circle only if others of this block are carried out, or refused.

        Starts of these axes and changes of their couplings wait behind it, so that the order is kept. All else goes out
        immediately, stops above all, unless a start of the same axis waits.
        """
        axis, master = command.target, master_in(command)
        waits = self._is_behind(command)
        if master is not None:
            undecided = axis in self.above(master) and axis not in reachable(self._certain, master)
            waits = waits or undecided or bool({axis, master} & self._waiting_axes)
        elif starts(command):
            waits = waits or axis in self._waiting_axes
        if waits:
            self.waiting.append(command)
            self._waiting_axes |= set() if master is None else {axis, master, *self.above(master)}
        return waits

    def _is_behind(self, command: Command) -> bool:
        """Something for the same axis waits that it must not overtake."""
        ordered = starts(command) or command.command in CHANGES_OF_COUPLINGS
        return any(before.target == command.target and (ordered or starts(before)) for before in self.waiting)

    def add(self, command: Command) -> None:
        """A command that goes out with this block."""
        axis, master = command.target, master_in(command)
        self.completed.append(command)
        if starts(command):
            self._started.setdefault(axis, command.command)
        elif master is not None and axis != master and axis not in self.above(master):
            self._possible.setdefault(axis, []).append(master)
            self.masters[axis] = master
        elif command.command == "decouple":
            self.masters.pop(axis, None)
            self._certain.pop(axis, None)
            if not command.arguments:  # what has arguments may be refused for them
                self._possible.pop(axis, None)


def starts(command: Command) -> bool:
    """It may move an axis at a standstill; a jog with velocity 0 ends one."""
    ends_jog = command.command == "jog" and command.arguments.get("velocity") == 0.0
    return command.command in STARTS and not ends_jog


def master_in(command: Command) -> str | None:
    """The master that a command asks for, None when it is no coupling."""
    master = command.arguments.get("master")
    return master if command.command in COUPLINGS and isinstance(master, str) else None


def reachable(edges: Mapping[str, Iterable[str]], name: str) -> list[str]:
    """All masters above an axis. An axis may have two, where one replaces the other only if it is carried out."""
    found: list[str] = []
    for master in edges.get(name, ()):
        found += [each for each in (master, *reachable(edges, master)) if each not in found]
    return found
