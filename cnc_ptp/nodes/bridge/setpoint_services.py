"""Services that take external setpoints as a series: the PLC node has them, and sends each with its block."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any

from cnc_ptp import srv
from cnc_ptp.axis.external_commands import SETPOINTS
from cnc_ptp.errors import CncError
from cnc_ptp.machine.command_files import with_table
from cnc_ptp.nodes.bridge.coupling_services import answered
from cnc_ptp.nodes.unit.requests import RUN_OVER
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters.view.authority import OF_SERVICES
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.protocol.blocks import Command, json_of

ROWS = "setpoints"


class SetpointServices:
    """/<axis>/external_setpoints: answered when the series is in order; what the axis refuses of it is recorded."""

    def __init__(self, node: UnitNode, plc: PlcUnit, axes: Iterable[str]) -> None:
        self._node = node
        self._plc = plc
        for axis in axes:
            node.create_service(srv.GiveExternalSetpoints, f"{axis}/{SETPOINTS}", partial(self._take, axis))

    def _take(self, axis: str, request: Any, response: Any) -> Any:
        if self._node.is_over:
            text = f"axis {axis}: {SETPOINTS} refused: the run has ended; nothing was changed"
            return answered(response, RUN_OVER, text)
        if error := self._node.why_closed(Command(axis, SETPOINTS), OF_SERVICES):
            return answered(response, error.number, error.message)
        response.cycle = self._node.next_cycle
        rows = [[row.cycle, row.position, row.velocity, row.acceleration, row.direction] for row in request.setpoints]
        try:
            given = with_table({ROWS: rows} if rows else {"file": request.file}, ROWS)
            self._plc.give_setpoints(axis, given[ROWS], response.cycle)
        except CncError as error:
            return answered(response, error.number, error.message, json_of(error.values))
        return answered(response, 0, "")
