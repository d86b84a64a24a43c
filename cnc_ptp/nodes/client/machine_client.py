"""A client of a running machine: finds its units, gives commands, reads blocks."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from itertools import count
from typing import Any

import rclpy
from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy.client import Client
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.parameter import parameter_value_to_python

from cnc_ptp.errors import CncError, nearest_name
from cnc_ptp.machine.wiring import UNKNOWN_UNIT
from cnc_ptp.nodes import process
from cnc_ptp.nodes.bridge.coupling_services import PATIENCE as COUPLING_PATIENCE
from cnc_ptp.nodes.client.latest_blocks import LatestBlocks
from cnc_ptp.nodes.client.requests import request_of
from cnc_ptp.nodes.polling_node import PollingNode
from cnc_ptp.nodes.topics import COUPLING_SERVICES, RECORDER, RECORDER_SERVICES, SERIES_SERVICES, SERVICES
from cnc_ptp.protocol.commands import COMMANDS, FILE_CONTENTS, OPTIONAL_NUMBER, TEXT, UNKNOWN_COMMAND, Arguments
from cnc_ptp.protocol.unit import PLC

NO_MACHINE = 26135
NO_ANSWER = 26136
PATIENCE = 5.0
"""Seconds for the machine to be found (DDS announces itself every 3 s at the latest), and for an answer."""
RECORDER_PATIENCE = 60.0
"""Seconds for a snapshot to be written."""
MARGIN = 1.0
"""Seconds that a call waits longer than the PLC does, which withdraws a coupling that no axis answers (26143)."""
UNITS = {"channels": "channel", "axes": "axis", "spindles": "spindle"}
CYCLE_TIME = "cycle_time_us"
AXIS_TYPE = "kenngr.achs_typ"
ROTARY = ("ACHSTYP_ROTATOR", 2)
NUMBERS = count(1)
"""Of clients in contexts of their own, for their names."""


class MachineClient(PollingNode):
    """Services used: /plc/get_parameters, /<axis>/get_parameters, /<unit>/<command>; all in its namespace."""

    def __init__(self, *, context: Context | None = None, name: str = "") -> None:
        """`context`: of ROS, None = the default one. `name` of the node; without one it is made of the process."""
        own = f"cnc_ptp_client_{os.getpid()}_{next(NUMBERS)}" if context else f"cnc_ptp_client_{os.getpid()}"
        super().__init__(name or own, context=context, enable_rosout=False, start_parameter_services=False)
        self._executor_of_client = EventsExecutor(context=context)
        self._executor_of_client.add_node(self)
        self._askers: dict[tuple[str, str], Client[Any, Any]] = {}
        self.cycle_time = 0.0
        """Seconds; of a machine that was found."""
        self.kinds: dict[str, str] = {}
        """Unit -> kind, in the order of the machine."""
        self.rotary: set[str] = set()
        """Axes in degrees."""

    def spin_until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """False when the condition has not come true in time."""
        deadline = time.monotonic() + seconds
        while not condition():
            if time.monotonic() >= deadline:
                return False
            self._executor_of_client.spin_once(timeout_sec=min(0.05, seconds))
        return True

    def end(self) -> None:
        """The end of the node; no message is delivered after it."""
        self._executor_of_client.shutdown()
        self.destroy_node()

    def spin_for(self, seconds: float) -> None:
        self.spin_until(lambda: False, seconds)

    # units

    def find_machine(self, patience: float = PATIENCE) -> None:
        """Learns the units from the PLC node. Raises CncError 26135 when there is none."""
        answer = self._parameters_of(PLC, [*UNITS, CYCLE_TIME], patience)
        if answer is None:
            where = f"ROS domain {self.context.get_domain_id()}"
            where += "" if self.get_namespace() == "/" else f" in namespace {self.get_namespace()}"
            raise CncError(NO_MACHINE, f"no machine is running on {where}", "nothing was sent")
        *units, cycle_time = answer
        for kind, value in zip(UNITS.values(), units, strict=True):
            self.kinds |= dict.fromkeys(value.string_array_value, kind)
        self.kinds[PLC] = "plc"
        self.cycle_time = cycle_time.integer_value * 1e-6

    def learn_axis_types(self, units: Iterable[str]) -> None:
        """The axes in degrees; an axis that does not answer is taken to be in mm."""
        for unit in units:
            answer = self._parameters_of(unit, [AXIS_TYPE]) if self.kinds[unit] == "axis" else None
            if answer and (answer[0].string_value in ROTARY or answer[0].integer_value in ROTARY):
                self.rotary.add(unit)

    def _parameters_of(self, node: str, names: list[str], patience: float = PATIENCE) -> Any:
        """Values; None when the node does not answer."""
        client: Client[Any, Any] = self.create_client(GetParameters, f"{node}/get_parameters")
        answer = self._answer(client, GetParameters.Request(names=names), patience)
        self.destroy_client(client)
        return None if answer is None else answer.values

    def parameters_of(self, unit: str) -> dict[str, Any]:
        """All parameters of a unit by ROS name, as the machine file has them. Raises CncError 26136."""
        client: Client[Any, Any] = self.create_client(ListParameters, f"{unit}/list_parameters")
        listed = self._answer(client, ListParameters.Request(), PATIENCE)
        self.destroy_client(client)
        names = [] if listed is None else [*listed.result.names]
        values = self._parameters_of(unit, names) if listed is not None else None
        if values is None:
            text = f"{self.kinds[unit]} {unit}: its parameters: no answer within {PATIENCE:g} s"
            raise CncError(NO_ANSWER, text, "nothing was read")
        return dict(zip(names, map(parameter_value_to_python, values), strict=True))

    def require_unit(self, unit: str, kinds: Iterable[str] = ()) -> str:
        """Its kind. Raises CncError 26111 when the machine has no such unit."""
        wanted = tuple(kinds) or ("channel", "axis", "spindle", "plc")
        if self.kinds.get(unit) not in wanted:
            known = ", ".join(name for name, kind in self.kinds.items() if kind in wanted) or "none"
            what = " or ".join(wanted) if kinds else "unit"
            raise CncError(UNKNOWN_UNIT, f"the machine has no {what} '{unit}'", f"nothing was sent. Known: {known}")
        return self.kinds[unit]

    def look_at(self, units: Iterable[str]) -> LatestBlocks:
        """The newest blocks of units, from now on."""
        units = list(units)
        self.learn_axis_types(units)
        return LatestBlocks(self, {unit: self.kinds[unit] for unit in units}, rotary=self.rotary)

    # commands

    def ask(self, unit: str, command: str, arguments: Mapping[str, Any]) -> Any:
        """The response to a command. Raises CncError 26136 when none comes in time; `arguments`: check_sendable."""
        service = services_of(self.kinds[unit])[command]
        patience = COUPLING_PATIENCE + MARGIN if command in COUPLING_SERVICES else PATIENCE
        if (unit, command) not in self._askers:
            self._askers[unit, command] = self.create_client(service, f"{unit}/{command}")
        answer = self._answer(self._askers[unit, command], request_of(service, arguments), patience)
        if answer is None:
            text = f"{self.kinds[unit]} {unit}: {command}: no answer within {patience:g} s"
            raise CncError(NO_ANSWER, text, "whether it was carried out is not known, see `cnc_ptp status`")
        return answer

    def ask_recorder(self, command: str, arguments: Mapping[str, Any]) -> Any:
        """The response of the recorder. Raises CncError 26136 when none comes in time."""
        service = RECORDER_SERVICES[command]
        client: Client[Any, Any] = self.create_client(service, f"{RECORDER}/{command}")
        answer = None
        if self.spin_until(client.service_is_ready, PATIENCE):
            answer = self._answer(client, request_of(service, arguments), RECORDER_PATIENCE)
        self.destroy_client(client)
        if answer is None:
            text = f"{RECORDER}: {command}: no answer"
            raise CncError(NO_ANSWER, text, "`cnc_ptp run` has a recorder with --record, --recorder or --keep")
        return answer

    def _answer(self, client: Client[Any, Any], request: Any, patience: float = PATIENCE) -> Any:
        """None when the service does not answer in time."""
        if not self.spin_until(client.service_is_ready, patience):
            return None
        future = client.call_async(request)
        return future.result() if self.spin_until(future.done, patience) else None


@contextmanager
def connected(*, patience: float = PATIENCE) -> Iterator[MachineClient]:
    """A client of the machine that runs on this ROS domain, which may take `patience` seconds to be found.

    Raises CncError 26108 and 26135.
    """
    process.initialise()
    try:
        client = MachineClient()
        try:
            client.find_machine(patience)
            yield client
        finally:
            client.end()
    finally:
        rclpy.try_shutdown()


def services_of(kind: str) -> dict[str, Any]:
    """Command -> service type."""
    if kind == RECORDER:
        return RECORDER_SERVICES
    return SERVICES[kind] | ({**COUPLING_SERVICES, **SERIES_SERVICES} if kind == "axis" else {})


RECORDER_COMMANDS: dict[str, Arguments] = {
    "start": {"file": TEXT},
    "stop": {},
    "snapshot": {"file": TEXT, "seconds": OPTIONAL_NUMBER, "until": OPTIONAL_NUMBER},
}
"""What the recorder can be told: it is no unit."""
FIELDS = {"master_points": "table"}
"""Fields of services that hold an argument of another name."""


def arguments_of(kind: str, unit: str, command: str) -> Arguments:
    """The arguments that the service of a command takes; rows may also be in a file.

    Raises CncError 22002 when there is none.
    """
    if kind == RECORDER and command in RECORDER_COMMANDS:
        return RECORDER_COMMANDS[command]
    service = services_of(kind).get(command)
    if service is None:
        where = f"{kind} {unit}".rstrip()
        known = sorted(services_of(kind))
        if command == "jog" and kind == "axis":
            raise CncError(UNKNOWN_COMMAND, f"jog has no service, use: cnc_ptp jog {unit} + --speed ...", where=where)
        text = f"unknown command '{command}'{nearest_name(command, known)}"
        raise CncError(UNKNOWN_COMMAND, text, f"nothing was sent. Known: {', '.join(known)}", where=where)
    fields = {FIELDS.get(name, name) for name in service.Request.get_fields_and_field_types()}
    arguments = {name: argument for name, argument in COMMANDS[kind][command].items() if name in fields}
    rows = {name: replace(arguments[name], required=False) for name in arguments if name in FILE_CONTENTS}
    return arguments | rows
