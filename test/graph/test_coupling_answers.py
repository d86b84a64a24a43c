"""Calls of coupling services: answered by the number of their command, never left without an answer, and for nothing."""

import time
from types import SimpleNamespace

import pytest
import rclpy
from graph_support import PTP
from rclpy.serialization import serialize_message
from ros_support import ros

from cnc_ptp import msg, srv
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import process
from cnc_ptp.nodes.bridge import coupling_services
from cnc_ptp.nodes.bridge.coupling_services import CouplingServices
from cnc_ptp.nodes.plc_bridge import PlcBridgeNode
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import Command, CycleTick


class Bridge:
    """Stands for the PLC node: services without ROS."""

    def __init__(self):
        self.unit = build_unit(read_machine(PTP), "plc")
        self.is_over = False
        self.services = {}
        self.answers = []
        self.couplings = CouplingServices(self, self.unit, ["x", "y"])

    def poll(self, _type, _topic, record, _quality):
        self.record = record

    def create_timer(self, _period, watch, clock):
        self.watch = watch

    def create_service(self, _type, name, callback):
        service = SimpleNamespace(send_response=lambda response, header: self.answers.append((header, response)))
        self.services[name] = service, callback
        return service

    def input(self, command):
        self.unit.input(command)

    def why_closed(self, _command, _source):
        """No unit is closed to anybody."""

    def call(self, name, request, header):
        """What an executor does with a request."""
        service, callback = self.services[name]
        service.send_response(callback(request, srv.Couple.Response()), header)

    def tick(self, cycle):
        return {command.id: command for command in self.unit.step(CycleTick(cycle, 10), {}).commands}

    def carried_out(self, **fields):
        self.record(serialize_message(msg.CommandRecord(**fields)))

    def told(self):
        answers, self.answers = self.answers, []
        return [(header, (each.accepted, each.error_id, each.message, each.cycle)) for header, each in answers]


COUPLE = srv.Couple.Request(master="x", factor=1.0)


def test_the_answer_is_the_record_of_the_own_command():
    """A command of the scenario for the same axis, a second call, and a channel's command of the same number."""
    bridge = Bridge()
    bridge.input(Command("y", "couple", {"master": "x", "factor": 2.0}))
    bridge.call("y/couple", COUPLE, "first")
    bridge.call("y/couple", COUPLE, "second")
    numbers = [number for number, command in bridge.tick(0).items() if command.command == "couple"]
    scenario, first, second = numbers
    record = {"target": "y", "command": "couple", "cycle": 10, "accepted": True}
    bridge.carried_out(id=scenario, **record)
    bridge.carried_out(id=first, **record | {"command": "set_feedforward"})
    bridge.carried_out(id=first, **record | {"target": "x"})
    bridge.carried_out(id=0, **record)
    assert bridge.told() == []
    bridge.carried_out(id=second, **record | {"accepted": False, "error_id": 23046, "message": "refused"})
    assert bridge.told() == [("second", (False, 23046, "refused", 10))]
    bridge.carried_out(id=first, **record)
    assert bridge.told() == [("first", (True, 0, "", 10))]
    bridge.carried_out(id=first, **record)
    assert bridge.told() == []


def test_an_axis_that_is_lost_does_not_answer():
    bridge = Bridge()
    bridge.call("y/couple", COUPLE, "a call")
    bridge.watch()
    assert bridge.told() == []
    bridge.unit.command(Command("plc", "upstream_lost", {"source": "y"}), 0)
    bridge.watch()
    assert bridge.told() == [("a call", (False, 26101, "axis y: couple without an answer: its node is lost", 0))]
    bridge.call("y/couple", COUPLE, "a later one")
    text = "axis y: couple refused: its node is lost; nothing was changed"
    assert bridge.told() == [("a later one", (False, 26101, text, 0))]


def test_the_run_ends():
    bridge = Bridge()
    bridge.call("y/couple", COUPLE, "a call")
    bridge.couplings.end()
    assert bridge.told() == [("a call", (False, 26115, "axis y: couple without an answer: the run has ended", 0))]
    bridge.is_over = True
    bridge.call("y/couple", COUPLE, "a later one")
    text = "axis y: couple refused: the run has ended; nothing was changed"
    assert bridge.told() == [("a later one", (False, 26115, text, 0))]


@pytest.mark.parametrize(
    ("ticks", "follows"),
    [
        (0, "no block has gone out, the command was withdrawn"),
        (1, "the command has gone out and may still be carried out"),
    ],
)
def test_a_deadline(monkeypatch, ticks, follows):
    bridge = Bridge()
    now = time.monotonic()
    bridge.call("y/couple", COUPLE, "a call")
    for number in range(ticks):
        bridge.tick(10 * number)
    monkeypatch.setattr(coupling_services.time, "monotonic", lambda: now + 4.9)
    bridge.watch()
    assert bridge.told() == []
    monkeypatch.setattr(coupling_services.time, "monotonic", lambda: now + 5.1)
    bridge.watch()
    text = f"axis y: couple without an answer for 5 s; {follows}"
    assert bridge.told() == [("a call", (False, 26143, text, 0))]
    assert "couple" not in [command.command for command in bridge.tick(100).values()]


def test_a_fault_in_a_file_is_answered_at_once():
    bridge = Bridge()
    bridge.call("y/couple_cam", srv.CoupleCam.Request(master="x", file="/no/cam.csv"), "a call")
    text = "cam file /no/cam.csv cannot be read: No such file or directory; nothing was started"
    assert bridge.told() == [("a call", (False, 26110, text, 0))]


def test_a_waiting_call_costs_no_processor_time():
    """Without a clock no block goes out: the call waits until its deadline. A polled coroutine took all of a core."""
    with ros():
        plc = PlcBridgeNode(read_machine(PTP))
        plc.setup()
        client = rclpy.create_node("asks", enable_rosout=False)
        executor = process.EventsExecutor()
        try:
            for node in (plc, client):
                executor.add_node(node)
            couple = client.create_client(srv.Couple, "/y/couple")
            until(executor, couple.service_is_ready)
            answer = couple.call_async(COUPLE)
            begun, used = time.monotonic(), time.process_time()
            until(executor, answer.done)
            waited, used = time.monotonic() - begun, time.process_time() - used
            assert waited > 4.0 and used < 0.3 * waited
            text = "axis y: couple without an answer for 5 s; no block has gone out, the command was withdrawn"
            assert (answer.result().error_id, answer.result().message) == (26143, text)
        finally:
            for node in (plc, client):
                node.destroy_node()
            executor.shutdown()


def until(executor, condition):
    deadline = time.monotonic() + 60.0
    while not condition():
        executor.spin_once(timeout_sec=0.1)
        assert time.monotonic() < deadline
