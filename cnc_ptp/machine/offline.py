"""The offline harness: all units in one process, as fast as possible, no transport in between."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import Inputs, wiring
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.plc_unit import PlcUnit, at_rest
from cnc_ptp.protocol.blocks import Command, CommandRecord, CycleBlock, CycleTick, Event, PlcBlock
from cnc_ptp.protocol.unit import PLC, Unit

STUCK_TIME = 10.0
"""Seconds without any motion after which a program that waits is aborted: nobody will help it."""
PLC_TIME = 60.0
"""The same while a PLC in a file runs and commands nothing: it may be waiting for a time."""


class Output:
    """The output of a unit for one tick: its block, and the events and command records that led to it."""

    __slots__ = ("block", "events", "name", "records")

    def __init__(self, unit: Unit, block: CycleBlock) -> None:
        self.name = unit.name
        self.block = block
        self.events: list[Event] = unit.take_events()
        self.records: list[CommandRecord] = unit.take_records()


Outputs = dict[str, Output]


class OfflineMachine:
    """Units wired together; `tick` computes one block of every unit in the order of the data flow."""

    def __init__(self, machine: MachineParameters, units: Mapping[str, Unit]) -> None:
        """`units` in the order of computation (wiring.build_units)."""
        self._count = machine.block_cycles
        watchdog_cycles = machine.watchdog_ms * 1000 // machine.cycle_time_us
        self._wiring: Mapping[str, Inputs] = wiring(machine)
        self._runners = {
            name: UnitRunner(unit, watchdog_cycles=watchdog_cycles, closed=machine.closed.get(name, ()))
            for name, unit in units.items()
        }
        self._blocks: dict[str, CycleBlock] = {}
        self._first_cycle = 0
        self._cycle_time = machine.cycle_time_us * 1e-6
        self._stuck_cycles = 0

    @property
    def next_cycle(self) -> int:
        """First cycle of the next block."""
        return self._first_cycle

    def runner(self, name: str) -> UnitRunner:
        """The unit `name`, for commands between blocks."""
        return self._runners[name]

    @property
    def parts(self) -> tuple[dict[str, UnitRunner], dict[str, CycleBlock]]:
        """The units and their last blocks, as they are between two blocks."""
        return self._runners, self._blocks

    def go_on_from(self, next_cycle: int, runners: Mapping[str, UnitRunner], blocks: Mapping[str, CycleBlock]) -> None:
        """Takes units with the state that they had before `next_cycle`, and what was published before it."""
        self._first_cycle = next_cycle
        self._runners |= runners
        self._blocks |= blocks

    def tick(self) -> Outputs:
        """Computes the next block of all units."""
        return self._compute(with_commands=True)

    def replay_tick(self, commands: Mapping[str, Iterable[Command]]) -> Outputs:
        """Computes the next block of all units with the commands of a recording, by unit."""
        for name, of_unit in commands.items():
            for command in of_unit:
                self._runners[name].command(command)
        return self._compute(with_commands=False)

    def _compute(self, *, with_commands: bool) -> Outputs:
        """One block of every unit. A coupled axis comes after its master, whatever the order of the machine is."""
        tick = CycleTick(self._first_cycle, self._count)
        before, self._blocks = self._blocks, {}
        waiting: dict[str, Mapping[str, CycleBlock]] = {}
        for name, runner in self._runners.items():
            needs = self._wiring[name]
            inputs = {unit: self._blocks[unit] for unit in needs.upstream if unit in self._blocks}
            inputs |= {unit: before[unit] for unit in needs.feedback if unit in before}
            if with_commands:
                runner.apply(tick, inputs)
            if runner.master is None:
                self._blocks[name] = runner.compute(tick, inputs)
            else:
                waiting[name] = inputs
        for name in waiting:
            self._compute_slave(tick, name, waiting)
        self._first_cycle += self._count
        return {name: Output(runner.unit, self._blocks[name]) for name, runner in self._runners.items()}

    def _compute_slave(self, tick: CycleTick, name: str, waiting: Mapping[str, Mapping[str, CycleBlock]]) -> None:
        """After its master. Couplings never form a circle: the PLC gives each the masters above its master."""
        master = self._runners[name].master
        if name in self._blocks or master is None:
            return
        if master not in self._blocks:
            self._compute_slave(tick, master, waiting)
        inputs = {**waiting[name], master: self._blocks[master]}
        self._blocks[name] = self._runners[name].compute(tick, inputs)

    def run(self, *, cycles: int | None = None) -> Iterator[Outputs]:
        """Ticks until the PLC ends the run, or for `cycles` cycles (rounded up to whole blocks).

        Without `cycles`, a run that can no longer continue (the scenario is finished, a program waits for a start or
        an acknowledgement) is aborted: nobody is there to help it.
        """
        while cycles is None or self._first_cycle < cycles:
            outputs = self.tick()
            yield outputs
            plc = outputs[PLC].block
            if cycles is None and isinstance(plc, PlcBlock):
                if plc.run_done:
                    return
                self._watch_progress(plc, outputs)

    def stop(self) -> None:
        """Everything stops on its ramps; the PLC ends the run when all is at a standstill."""
        self._runners[PLC].command(Command(PLC, "stop_all", {}))

    def _watch_progress(self, plc: PlcBlock, outputs: Outputs) -> None:
        unit = self._runners[PLC].unit
        with_program = isinstance(unit, PlcUnit) and unit.program_runs
        obeyed = any(record.accepted for output in outputs.values() for record in output.records)
        waits = self.waits(outputs) if plc.scenario_done and not obeyed else None
        if with_program and waits == []:
            waits = ["everything is at a standstill"]  # the PLC in a file has not said that the run may end
        reason = "; ".join(waits or ())
        self._stuck_cycles = self._stuck_cycles + plc.count if reason else 0
        if self._stuck_cycles >= round((PLC_TIME if with_program else STUCK_TIME) / self._cycle_time):
            self._stuck_cycles = 0
            but = f"no command was accepted for {PLC_TIME:g} s" if with_program else "the scenario is finished"
            self._runners[PLC].command(Command(PLC, "abort", {"reason": f"{reason}, but {but}"}))

    def waits(self, outputs: Outputs) -> list[str] | None:
        """What the units wait for, nothing for those at rest; None while anything moves.

        Channel or master answer for their axes.
        """
        reasons = []
        for output in outputs.values():
            unit = self._runners[output.name].unit
            if reason := unit.waits_for():
                reasons.append(reason)
            elif not unit.led and not at_rest(output.block):
                return None
        return reasons
