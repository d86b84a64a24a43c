"""Checkpoints of a run of the graph: each unit publishes its state after the same block, for the recorder.

What travels from one unit to another between two blocks is in the blocks themselves, so that the states of all units
after a block, and the blocks, are a state of the machine: nobody waits for it.
"""

from __future__ import annotations

import json

from rclpy.node import Node

from cnc_ptp import msg
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.nodes import convert
from cnc_ptp.nodes.topics import CHECKPOINTS, STATES_OF_UNITS
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import CycleBlock
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.state.machine_state import StateStore, kernel_digest
from cnc_ptp.wire.stamps import Stamps


class UnitCheckpoints:
    """Publishes the state of a unit whenever its time has come and somebody records."""

    def __init__(self, node: Node, machine: MachineParameters, seconds: float) -> None:
        """`seconds` of machine time from one to the next."""
        self._store = StateStore(machine)
        kernel_digest()  # takes its time: now
        self._cycles = max(1, round(seconds * 1e6 / machine.cycle_time_us))
        self._next = self._cycles
        self._told: set[str] = set()
        self._publisher = node.create_publisher(msg.UnitCheckpoint, CHECKPOINTS, STATES_OF_UNITS)

    def is_due(self, next_cycle: int) -> bool:
        """The unit has computed and published all blocks before a cycle."""
        return next_cycle >= self._next

    def publish(self, runner: UnitRunner, block: CycleBlock, stamps: Stamps) -> None:
        """The state of the unit after a block. Raises CncError 26150 where it cannot be stored."""
        self._next = runner.next_cycle + self._cycles
        if not self._publisher.get_subscription_count():
            return
        name = runner.unit.name
        units = {} if name == PLC else {name: runner}  # a recording has the commands of the PLC
        state = self._store.encode_units(runner.next_cycle, units, {name: block})
        texts = [text for digest, text in self._store.texts.items() if digest not in self._told]
        self._told |= self._store.texts.keys()
        self._store.texts.clear()  # the recorder has them
        message = msg.UnitCheckpoint(next_cycle=runner.next_cycle, unit=name, state=state, texts_json=json.dumps(texts))
        message.header.stamp = convert.time_message(stamps.at(runner.next_cycle))
        self._publisher.publish(message)
