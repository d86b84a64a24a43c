"""Live states on /<unit>/state, for rqt and PlotJuggler: single states instead of blocks."""

from __future__ import annotations

from rclpy.node import Node

from cnc_ptp.nodes.topics import BLOCKS, STATE_TYPES, state_topic
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.recording.blocks import StateBlock, state_messages
from cnc_ptp.wire.stamps import Stamps


def period_cycles(machine: MachineParameters, rate_hz: float | None) -> int:
    """Cycles between two states; 0 = none. `rate_hz`: None = as the machine file says; not more than every cycle."""
    rate = machine.state_rate_hz if rate_hz is None else rate_hz
    return max(1, round(1e6 / (rate * machine.cycle_time_us))) if rate > 0.0 else 0


class LiveState:
    """Publishes the state of every `period`-th cycle, the last one of each period, while somebody subscribes.

    The messages are made as the recorder makes them.
    """

    def __init__(self, node: Node, unit: str, kind: str, period: int) -> None:
        self._period = period
        self._publisher = node.create_publisher(STATE_TYPES[kind], state_topic(unit), BLOCKS)

    def publish(self, block: StateBlock, stamps: Stamps) -> None:
        first = -(block.first_cycle + 1) % self._period
        if first < block.count and self._publisher.get_subscription_count():
            for message in state_messages(block, stamps, slice(first, None, self._period)):
                self._publisher.publish(message)
