"""`spindle MACHINE.yaml NAME`: the node of one spindle."""

from __future__ import annotations

import sys
from typing import Any

from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import arguments, process
from cnc_ptp.nodes.unit_node import UnitNode, consumers_of
from cnc_ptp.parameters import MachineParameters, read_machine


class SpindleNode(UnitNode):
    """UnitNode of a spindle."""

    def __init__(self, machine: MachineParameters, name: str, **options: Any) -> None:
        arguments.require_unit(machine, name, ["spindle"])
        super().__init__(machine, build_unit(machine, name), **options)


@arguments.unit_command
def command(machine: str, name: str, free_run: bool, recorders: int) -> None:
    """Runs the spindle NAME of MACHINE as a ROS node."""

    def make() -> SpindleNode:
        parameters = read_machine(machine)
        consumers = consumers_of(parameters, name, recorders=recorders)
        return SpindleNode(parameters, name, consumers=consumers, free_run=free_run)

    sys.exit(process.run_node(make))


def main() -> None:
    arguments.call(command)


if __name__ == "__main__":
    main()
