"""Runs that are stored on their way, and continued in new units from what was stored."""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from machine_support import ROOT

from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.machine.plc_file import read_plc
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import PlcBlock
from cnc_ptp.protocol.unit import PLC, Unit
from cnc_ptp.state.machine_state import StateStore


class Run(NamedTuple):
    """A machine and its job, and how long it is followed (s); 0: to its end."""

    machine: str
    program: str = ""
    scenario: str = ""
    dialect: str | None = None
    seconds: float = 0.0
    plc: str = ""

    @property
    def name(self) -> str:
        parts = (self.machine, self.plc, self.program, self.scenario)
        return "-".join(part.rpartition("/")[2] for part in parts if part)

    def parameters(self) -> MachineParameters:
        return read_machine(ROOT / self.machine)

    def entries(self, machine: MachineParameters) -> list[Entry]:
        program = str(ROOT / self.program) if self.program else None
        scenario = str(ROOT / self.scenario) if self.scenario else None
        return read_entries(machine, program=program, scenario=scenario, dialect=self.dialect)

    def units(self, machine: MachineParameters) -> Mapping[str, Unit]:
        plc_file = read_plc(str(ROOT / self.plc)) if self.plc else None
        return build_units(machine, scenario=self.entries(machine), plc_file=plc_file)


def texts(outputs: Outputs) -> list[str]:
    """All that the units say in a block: repr shows every bit of a float."""
    return [repr((name, each.block, each.events, each.records)) for name, each in outputs.items()]


def outputs_of(machine: MachineParameters, entries: Iterable[Entry], seconds: float) -> tuple[OfflineMachine, int]:
    """The machine at its beginning, and the number of blocks of its run."""
    offline = OfflineMachine(machine, build_units(machine, scenario=list(entries)))
    blocks = 0
    most = round((seconds or 60.0) * 1e6 / machine.cycle_time_us / machine.block_cycles)
    while blocks < most:
        blocks += 1
        plc = offline.tick()[PLC].block
        if isinstance(plc, PlcBlock) and plc.run_done:
            break
    return OfflineMachine(machine, build_units(machine, scenario=list(entries))), blocks


def require_same_continuation(
    machine: MachineParameters, entries: Sequence[Entry], *, seed: str, places: int = 5, follow: int = 60,
    seconds: float = 0.0,
) -> list[int]:  # fmt: skip
    """Stores a run at random blocks; each state must continue as the run did. Returns the sizes of the states."""
    offline, blocks = outputs_of(machine, entries, seconds)
    chosen = sorted(random.Random(seed).sample(range(blocks), min(places, blocks)))
    store, states, said = StateStore(machine), {}, []
    for block in range(max(chosen) + follow):
        if block in chosen:
            states[block] = store.encode(offline, with_plc=True)
        said.append(texts(offline.tick()))
    for block, state in states.items():
        again = StateStore(machine)
        again.texts.update(store.texts)
        restored = again.restore(state)
        fresh = OfflineMachine(machine, build_units(machine))
        fresh.go_on_from(*restored)
        for number in range(block, block + follow):
            assert texts(fresh.tick()) == said[number], f"stored before block {block}, differs in block {number}"
    return [len(state) for state in states.values()]
