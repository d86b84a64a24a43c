"""The HLI in a graph: what PLCs write and see, arbitration, functions, emergency stop, messages at 1 kHz.

All tests share one run; its recording, which no script has played, is verified to the bit at the end.
"""

import signal
import time
from pathlib import Path

import pytest
import rclpy
from client_support import Blocks, Client, connected
from graph_support import Running, small_machine, verified
from std_msgs.msg import Bool, Header
from std_srvs.srv import Trigger

from cnc_ptp import msg
from cnc_ptp.nodes.topics import HLI_CONTROL, HLI_STATUS, LATEST, PLC_INPUT
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode

UNHEARD_DURATION = 300


class PlcClient(Client):
    """A client that is a PLC: `say` writes a control message, `status` has the newest one of each unit."""

    def __init__(self, machine):
        super().__init__(machine)
        self.status = {}
        for unit, kind in self.kinds.items():
            if kind in HLI_STATUS:
                self.status[unit] = Blocks(HLI_STATUS[kind])
                topic, received = f"/{unit}/hli/status", self.status[unit].serialised.append
                self.create_subscription(HLI_STATUS[kind], topic, received, PLC_INPUT, raw=True)

    def say(self, unit, plc="p1", *, wait=True, valid=True, **fields):
        of, topic = HLI_CONTROL[self.kinds[unit]], f"/{unit}/hli/control"
        message = of(header=Header(frame_id=plc), valid=valid, **fields)
        if topic not in self._writers:
            writer = self._writers[topic] = self.create_publisher(of, topic, PLC_INPUT)
            self.spin_until(lambda: writer.get_subscription_count() >= 2, f"readers of {topic}")
        self._writers[topic].publish(message)
        if wait:
            self.wait_blocks("plc", 4)

    def sees(self, unit, condition, what):
        """Waits for a status that fulfils a condition; returns it."""
        self.spin_until(lambda: self.status[unit] and condition(self.status[unit][-1]), f"{unit}: {what}")
        return self.status[unit][-1]

    def told(self, error_id):
        return [event.text for event in self.events if event.error_id == error_id]


PATIENT = "watchdog_ms: 1000\n    life_sign_timeout_ms: 4000\n"


def served(value=True):
    of = msg.HliSwitch if isinstance(value, bool) else msg.HliNumber
    return of(enable_w=True, command_w=value)


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    """Its PLC is this process, which may be held up for longer than a PLC is."""
    path = small_machine(tmp_path_factory.mktemp("machine"))
    path.write_text(path.read_text().replace("watchdog_ms: 200\n", PATIENT))
    assert read_machine(str(path)).watchdog_ms == 1000
    return path


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    return tmp_path_factory.mktemp("hli") / "run.mcap"


@pytest.fixture(scope="module")
def graph(ros_domain, machine, recording):
    with Running(machine, "--duration", UNHEARD_DURATION, "--record", recording) as graph:
        graph.wait_for_nodes(7)
        yield graph


@pytest.fixture(scope="module")
def plc(graph, machine):
    with connected(PlcClient, machine) as client:
        client.wait_blocks("x", 1)
        yield client


def test_the_status_counts_blocks_and_shows_both_units(plc):
    status = plc.sees("x", lambda status: status.valid and not status.held, "a status")
    assert status.override.state_r == 100.0 and status.override.state_hli == 1000
    assert status.controller_enable.state_r and status.feed_enable_forward.state_r and not status.emergency_stop.state_r
    plc.spin_until(lambda: has_caught_up(plc.status["x"]), "20 in one time: the machine has caught up with its start")
    statuses = [plc.status["x"][-20 + n] for n in range(20)]
    signs = [status.life_sign for status in statuses]
    cycles = [status.cycle for status in statuses]
    assert [sign - signs[0] for sign in signs] == [(cycle - cycles[0]) // 10 for cycle in cycles]  # once per block
    assert signs == sorted(set(signs))


def has_caught_up(status):
    """The newest 20: while the machine is late, blocks come faster than this process takes them."""
    return len(status) > 20 and status[-1].life_sign - status[-20].life_sign < 30


def test_the_plc_takes_an_override_over_and_gives_it_back(plc):
    plc.say("x", override=served(40.0))
    plc.shows("x", "override_percent", 40.0)
    answer = plc.call("x", "set_override", percent=80.0)
    text = (
        "P-WARN-26160 axis x: set_override waits: the PLC 'p1' serves override and commands 40; what is asked for acts "
        "when it gives override back"
    )
    assert (answer.accepted, answer.message) == (True, text)
    plc.sees(
        "x", lambda s: (s.override.enable_r, s.override.request_r, s.override.state_r) == (True, 80.0, 40.0), "both"
    )
    assert plc.blocks["x"][-1].override_percent[-1] == 40.0
    plc.say("x", valid=False)
    plc.shows("x", "override_percent", 80.0)
    plc.say("x", units=msg.AxisHliControl.HLI, override=served(555.0))
    plc.shows("x", "override_percent", 55.5)
    plc.say("x", valid=False)


def test_a_second_plc_and_a_bad_value(plc):
    plc.say("y", "p1", override=served(40.0), wait=False)
    plc.say("y", "p2", override=served(90.0), wait=False)
    plc.say("y", "p1", override=served(float("nan")), feed_hold=served(True))
    plc.sees("y", lambda status: status.held and status.holder == "p1" and status.feed_hold.state_r, "the feed hold")
    plc.shows("y", "override_percent", 40.0)
    plc.spin_until(lambda: plc.told(26162) and plc.told(26164), "both events")
    assert plc.told(26162) == [
        "plc: HLI of y: 'p2' commands it too and is refused while 'p1' holds it; nothing was changed"
    ]
    assert plc.told(26164) == ["plc: HLI of y: override: command nan is not within 0 ... 100; 40 holds"]
    plc.sees("y", lambda status: not status.held, "the silence of p1")
    silent = "plc: HLI of y: no message of 'p1' for "
    plc.spin_until(lambda: any(text.startswith(silent) for text in plc.told(26165)), "the event")
    plc.say("y", "p2", override=served(90.0))
    plc.sees("y", lambda status: status.holder == "p2" and not status.feed_hold.state_r, "p2")
    plc.say("y", "p2", valid=False)


def test_an_edge_and_an_external_command(plc):
    command = msg.HliAxisCommand(semaphore=True, type=msg.HliAxisCommand.MOVE_ABSOLUTE, position=3.0)
    plc.say("x", reset=served(False), external=command)
    status = plc.sees(
        "x", lambda status: status.external.count_r == 1 and not status.external.command_semaphore, "taken"
    )
    assert status.external.error_id == 0 and status.external.job > 0 and status.reset.enable_r
    refused = plc.refused(
        "x", "reset", 26161,
        "axis x: reset refused: the PLC 'p1' serves reset; it is shown what was asked for; nothing was changed",
    )  # fmt: skip
    assert not refused.accepted
    plc.sees("x", lambda status: status.reset.request_r, "the request")
    plc.say("x", reset=served(True))
    plc.sees("x", lambda status: status.reset.count_r == 1 and not status.reset.request_r, "the reset")
    plc.sees("x", lambda status: not status.moving, "the end of the motion")
    plc.say("x", valid=False)


def test_external_commands_beside_motions(plc):
    """G167 of a spindle, and a coupling by the logical number of a master that there is not."""
    command = msg.HliSpindleCommand(semaphore=True, type=msg.HliSpindleCommand.OVERRIDE_OFF)
    plc.say("s", external=command)
    taken = lambda status: status.external.count_r == 1 and not status.external.command_semaphore  # noqa: E731
    assert plc.sees("s", taken, "taken").external.error_id == 0
    plc.say("s", valid=False)
    before = plc.sees("x", lambda status: not status.external.command_semaphore, "its status").external.count_r
    command = msg.HliAxisCommand(semaphore=True, type=msg.HliAxisCommand.COUPLE, factor=0.5, master=77)
    plc.say("x", external=command)
    status = plc.sees("x", lambda status: status.external.count_r == before + 1, "refused")
    assert status.external.error_id == 26164
    plc.say("x", valid=False)


def test_functions_wait_for_the_plc(plc, tmp_path):
    path = tmp_path / "job.nc"
    path.write_text("%job\nN10 M08\nN20 G01 X10 F3000\nM30\n")
    plc.say("channel", acknowledge=msg.HliAcknowledgement(enable_w=True))
    plc.done("channel", "load", program=str(path))
    plc.done("channel", "start")
    request = plc.sees("channel", lambda status: len(status.requests) == 1, "a request").requests[0]
    assert (request.kind, request.number) == ("M", 8)
    done = msg.HliAcknowledgement(enable_w=True, done_w=[request.id, 0, 0, 0, 0, 0, 0, 0])
    plc.say("channel", acknowledge=done)
    plc.sees("channel", lambda status: status.requests == [] and status.done, "the end of the program")
    assert plc.blocks["x"][-1].set_position[-1] == pytest.approx(10.0)
    plc.say("channel", acknowledge=msg.HliAcknowledgement(enable_w=True))
    plc.say("channel", acknowledge=done)
    text = f"plc plc: acknowledge refused: no request {request.id} waits; nothing was changed. Waiting: none"
    plc.spin_until(lambda: text in plc.told(22013), "the refusal")
    plc.say("channel", valid=False)


def test_the_life_sign_of_the_plc_holds_what_it_serves(plc):
    plc.say("channel", feed_hold=served(False))
    plc.write("/plc/life_sign", msg.LifeSign, counter=1)
    plc.sees("channel", lambda status: status.feed_hold.state_r, "the feed hold")
    told = "feed hold is set on channel, s, x, y"
    plc.spin_until(lambda: any(told in text for text in plc.told(26103)), "its event")
    plc.sees("x", lambda status: status.feed_hold.state_r and not status.feed_hold.enable_r, "that of an axis")
    for unit in ("channel", "x", "y", "s"):
        plc.say(unit, feed_hold=served(False))
        plc.sees(unit, lambda status: not status.feed_hold.state_r, "its end")
        plc.say(unit, valid=False)
        plc.sees(unit, lambda status: not (status.feed_hold.enable_r or status.feed_hold.state_r), "no hold behind it")


def test_the_plc_of_ten_lines_of_the_document(plc):
    """As it stands in docs/plc_hli.md, with a door."""
    page = (Path(__file__).parents[2] / "docs" / "plc_hli.md").read_text(encoding="utf-8")
    lines = page.partition("    import rclpy\n")[2].splitlines()
    code = "\n".join(line[4:] for line in lines if not line.startswith(("    rclpy.init", "    rclpy.spin")))
    door = {"open": True}
    names = {"rclpy": rclpy, "door_is_open": lambda: door["open"]}
    exec(compile(code, "docs/plc_hli.md", "exec"), names)
    try:
        for is_open in (True, False):
            door["open"] = is_open
            deadline = time.monotonic() + 30.0
            while plc.status["channel"][-1].feed_hold.state_r != is_open and time.monotonic() < deadline:
                names["cycle"]()
                plc.executor_of_test.spin_once(timeout_sec=0.01)
            assert (plc.status["channel"][-1].holder, plc.status["channel"][-1].feed_hold.state_r) == ("door", is_open)
    finally:
        names["node"].destroy_node()
    plc.sees("channel", lambda status: not status.held, "its silence")
    plc.say("channel", "door", valid=False)


def test_four_topics_at_1_khz_make_one_command_a_block_and_the_newest_value_wins(plc):
    """Of the HLI and with single values; that no block is lost, the recording shows (the last test)."""
    units = ("x", "y")
    last = 50.0 + (999 * 7) % 41
    first = plc.blocks["plc"][-1].first_cycle
    before = [len(plc.commands(unit, name)) for name in ("overlay", "set_override") for unit in units]
    for unit in units:
        plc.say(unit, override=served(50.0), wait=False)
        plc.write(f"/{unit}/override", msg.Override, readers=2, valid=True, percent=50.0)
    begin = time.monotonic()
    for number in range(1000):
        percent = 50.0 + (number * 7) % 41
        for unit in units:
            plc.say(unit, override=served(percent), wait=False)
            plc._writers[f"/{unit}/override"].publish(msg.Override(valid=True, percent=percent))
        plc.executor_of_test.spin_once(timeout_sec=max(0.0, begin + (number + 1) * 0.001 - time.monotonic()))
    for unit in units:
        plc.sees(unit, lambda status: status.override.state_r == last, "the last value")
        plc.sees(unit, lambda status: status.override.request_r == last, "the last value of the topic")
    plc.wait_blocks("plc", 20)
    blocks = (plc.blocks["plc"][-1].first_cycle - first) // 10
    after = [len(plc.commands(unit, name)) for name in ("overlay", "set_override") for unit in units]
    assert all(10 < now - then <= blocks for now, then in zip(after, before, strict=True))
    assert plc.told(26102) == []
    for unit in units:
        plc.say(unit, valid=False)


def test_the_emergency_stop(plc):
    shown = []
    plc.create_subscription(Bool, "/emergency_stop/active", lambda message: shown.append(message.data), LATEST)
    plc.done("y", "move_absolute", target=200.0, velocity=20.0)
    plc.write("/emergency_stop", Bool, data=True)
    for unit in ("x", "y", "s"):
        plc.shows(unit, "state", AxisStateCode.ERROR_STOP)
        plc.sees(unit, lambda status: status.emergency_stop.state_r and status.error_id == 26168, "the emergency stop")
    plc.wait_last("y", lambda block: block.set_velocity[-1] == 0.0, "standstill")
    plc.spin_until(lambda: shown and shown[-1], "the lamp")
    holds = "refused: the emergency stop holds; release it first; nothing was changed"
    plc.refused("y", "reset", 26169, f"axis y: reset {holds}")
    answer = plc.ask(Trigger, "/emergency_stop/reset")
    assert (answer.success, answer.message) == (False, f"plc plc: reset {holds}")
    plc.write("/emergency_stop", Bool, data=False)
    plc.spin_until(lambda: not shown[-1], "the lamp off")
    assert plc.blocks["y"][-1].state[-1] == AxisStateCode.ERROR_STOP
    assert plc.ask(Trigger, "/emergency_stop/reset").success
    for unit in ("x", "y", "s"):
        plc.shows(unit, "state", AxisStateCode.STANDSTILL)
    other = plc.create_publisher(Bool, "/emergency_stop", PLC_INPUT)  # a second button
    readers = plc._writers["/emergency_stop"].get_subscription_count()
    plc.spin_until(lambda: other.get_subscription_count() == readers > 0, "readers of the second button")
    plc.write("/emergency_stop", Bool, data=True)
    plc.shows("x", "state", AxisStateCode.ERROR_STOP)
    other.publish(Bool(data=False))
    plc.spin_until(lambda: plc.told(26229), "the warning")
    assert [f"P-WARN-26229 {text}" for text in plc.told(26229)] == [
        "P-WARN-26229 plc: /emergency_stop has 2 publishers, and one says false; the emergency stop holds"
        " until /emergency_stop/release is called"
    ]
    assert shown[-1] and plc.ask(Trigger, "/emergency_stop/release").success
    plc.spin_until(lambda: not shown[-1], "the lamp off again")
    plc.destroy_publisher(other)
    assert plc.ask(Trigger, "/emergency_stop/reset").success
    assert plc.ask(Trigger, "/emergency_stop/press").success and plc.ask(Trigger, "/emergency_stop/release").success
    assert plc.ask(Trigger, "/emergency_stop/reset").success
    plc.sees("channel", lambda status: status.error_id == 0, "the channel")


def test_the_recording_is_computed_again(graph, plc, recording):
    plc.wait_blocks("plc", 10)
    graph.process.send_signal(signal.SIGINT)
    graph.finish(expect=1)
    recorded = verified(recording)
    assert sum(record.command == "overlay" for record in recorded.commands) > 20
