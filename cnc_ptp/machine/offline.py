"""The offline harness: all units in one process, as fast as possible, no transport in between."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from cnc_ptp.machine.blocks import Block, Command, CommandRecord, CycleTick, Event, PlcBlock
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.unit import Unit
from cnc_ptp.machine.wiring import PLC, Inputs, wiring
from cnc_ptp.parameters import MachineParameters


class Output:
    """What a unit gives for one tick: its block, and the events and command records that led to it."""

    __slots__ = ("block", "events", "name", "records")

    def __init__(self, unit: Unit, block: Block) -> None:
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
        self._runners = {name: UnitRunner(unit, watchdog_cycles=watchdog_cycles) for name, unit in units.items()}
        self._blocks: dict[str, Block] = {}
        self._first_cycle = 0

    def tick(self) -> Outputs:
        """Computes the next block of all units."""
        return self._compute(UnitRunner.run)

    def replay_tick(self, commands: Mapping[str, Iterable[Command]]) -> Outputs:
        """Computes the next block of all units with the commands of a recording, by unit."""
        for name, of_unit in commands.items():
            for command in of_unit:
                self._runners[name].command(command)
        return self._compute(UnitRunner.replay)

    def _compute(self, run: Callable[[UnitRunner, CycleTick, Mapping[str, Block]], Block]) -> Outputs:
        tick = CycleTick(self._first_cycle, self._count)
        before, self._blocks = self._blocks, {}
        outputs: Outputs = {}
        for name, runner in self._runners.items():
            needs = self._wiring[name]
            inputs = {unit: self._blocks[unit] for unit in needs.upstream if unit in self._blocks}
            inputs |= {unit: before[unit] for unit in needs.feedback if unit in before}
            block = run(runner, tick, inputs)
            self._blocks[name] = block
            outputs[name] = Output(runner.unit, block)
        self._first_cycle += self._count
        return outputs

    def run(self, *, cycles: int | None = None) -> Iterator[Outputs]:
        """Ticks until the PLC ends the run, or for `cycles` cycles (rounded up to whole blocks)."""
        while cycles is None or self._first_cycle < cycles:
            outputs = self.tick()
            yield outputs
            plc = outputs[PLC].block
            if cycles is None and isinstance(plc, PlcBlock) and plc.run_done:
                return
