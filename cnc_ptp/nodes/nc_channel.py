"""`nc_channel MACHINE.yaml NAME`: the node of one NC channel with its path interpolator."""

from __future__ import annotations

import sys
from typing import Any

from cnc_ptp import msg
from cnc_ptp.machine.blocks import Block, ChannelBlock
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import arguments, convert, process
from cnc_ptp.nodes.topics import EVENTS, handshake_topic
from cnc_ptp.nodes.unit_node import UnitNode, consumers_of
from cnc_ptp.parameters import MachineParameters, read_machine


class ChannelNode(UnitNode):
    """UnitNode of a channel; also publishes /<channel>/handshake (HandshakeRequest) for M, S, T and D functions."""

    def __init__(self, machine: MachineParameters, name: str, **options: Any) -> None:
        arguments.require_unit(machine, name, ["channel"])
        super().__init__(machine, build_unit(machine, name), **options)
        self._handshake_publisher = self.create_publisher(msg.HandshakeRequest, handshake_topic(name), EVENTS)

    def after_block(self, block: Block) -> None:
        if isinstance(block, ChannelBlock):
            for request in block.requests:
                self._handshake_publisher.publish(convert.request_to_message(request, self.stamp(request.cycle)))


@arguments.unit_command
def command(machine: str, name: str, free_run: bool, recorders: int) -> None:
    """Runs the NC channel NAME of MACHINE as a ROS node."""

    def make() -> ChannelNode:
        parameters = read_machine(machine)
        consumers = consumers_of(parameters, name, recorders=recorders)
        return ChannelNode(parameters, name, consumers=consumers, free_run=free_run)

    sys.exit(process.run_node(make))


def main() -> None:
    arguments.call(command)


if __name__ == "__main__":
    main()
