"""`spindle MACHINE.yaml NAME`: the node of one spindle."""

from __future__ import annotations

from typing import Any

from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import arguments
from cnc_ptp.nodes.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters


class SpindleNode(UnitNode):
    """UnitNode of a spindle."""

    def __init__(self, machine: MachineParameters, name: str, **options: Any) -> None:
        arguments.require_unit(machine, name, ["spindle"])
        super().__init__(machine, build_unit(machine, name), **options)


main = arguments.unit_main(SpindleNode, "spindle")

if __name__ == "__main__":
    main()
