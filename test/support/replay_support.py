"""A run computed again from its recorded commands, and all its blocks as text."""

from __future__ import annotations

import json
from collections import defaultdict
from dataclasses import replace

from machine_support import MachineBench

from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import Command, CommandRecord, CycleBlock, PlcBlock
from cnc_ptp.recording.computed_again import may_be_refused_by_plc


def bits(bench: MachineBench) -> dict[str, list[str]]:
    """All blocks as text: repr shows every bit of a float and tells 0.0 from -0.0."""
    return {name: [text_of(block) for block in blocks] for name, blocks in bench.blocks.items()}


def text_of(block: CycleBlock) -> str:
    """Without the answers to the PLC, which a replay does not have."""
    return repr(block if isinstance(block, PlcBlock) else replace(block, answers=[]))


def replay(machine: MachineParameters, records: list[CommandRecord], blocks: int) -> dict[str, list[str]]:
    """A run of fresh units that get the recorded commands, converted back from JSON, at their cycles."""
    offline = OfflineMachine(machine, build_units(machine, end_when_idle=False))
    by_cycle: dict[int, dict[str, list[Command]]] = defaultdict(lambda: defaultdict(list))
    for record in records:
        arguments = json.loads(record.arguments_json)
        if not may_be_refused_by_plc(record, machine):
            by_cycle[record.cycle][record.target].append(Command(record.target, record.command, arguments))
    texts: dict[str, list[str]] = defaultdict(list)
    for number in range(blocks):
        for name, output in offline.replay_tick(by_cycle.get(number * machine.block_cycles, {})).items():
            texts[name].append(text_of(output.block))
    return texts
