"""Machines side by side on one ROS domain, each in its namespace; topics, services, claims and recordings."""

import subprocess
import time

import pytest
from graph_support import LAST_WORDS, Running, command, one_axis_machine, run, states_equal, verified
from rclpy.node import Node
from ros_support import ros

from cnc_ptp import msg, srv
from cnc_ptp.nodes import process
from cnc_ptp.nodes.topics import BLOCKS, EVENTS
from cnc_ptp.protocol.blocks import Severity
from cnc_ptp.recording.reader import read_recording

MOVES = {
    "left": "- {at: 0.0, to: x, do: move_absolute, target: 80.0, velocity: 100.0}\n"
    "- {at: 0.3, to: x, do: set_override, percent: 40}\n- {at: 0.35, to: x, do: move_absolute, target: 5000}\n",
    "right": "- {at: 0.05, to: x, do: move_absolute, target: -90.0, velocity: 100.0}\n"
    "- {at: 0.5, to: x, do: new_target, target: 10}\n",
}
TOPICS = {"/x/block", "/x/state", "/plc/block", "/clock/tick", "/events", "/commands", "/diagnostics"}
TOPICS |= {"/lateness", "/joint_states", "/rosout"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A machine, two scenarios and their offline recordings."""
    folder = tmp_path_factory.mktemp("namespaces")
    one_axis_machine(folder)
    for name, scenario in MOVES.items():
        (folder / f"{name}.yaml").write_text(scenario)
        run("simulate", *job(folder, name), "--record", folder / f"{name}_offline.mcap")
    return folder


def job(folder, scenario):
    return folder / "one.yaml", "--scenario", folder / f"{scenario}.yaml"


class InNamespace(Node):
    """A client in the namespace of a machine, with relative names as everybody else there."""

    def __init__(self, namespace):
        super().__init__("client", namespace=namespace, enable_rosout=False)
        self.blocks, self.events = [], []
        self.create_subscription(msg.AxisBlock, "x/block", self.blocks.append, BLOCKS)
        self.create_subscription(msg.Event, "events", self.events.append, EVENTS)
        self.executor_of_test = process.EventsExecutor()
        self.executor_of_test.add_node(self)

    def spin_until(self, condition):
        deadline = time.monotonic() + 60.0
        while not condition():
            assert time.monotonic() < deadline, "it did not come"
            self.executor_of_test.spin_once(timeout_sec=0.02)


@pytest.fixture
def client():
    nodes = []

    def make(namespace):
        nodes.append(InNamespace(namespace))
        return nodes[-1]

    with ros():
        yield make
        for node in nodes:
            node.destroy_node()


def finished(folder, name, graph):
    """The recording of a run that has ended, equal to the offline run, with the names of the contract."""
    output = graph.finish(expect=0)
    assert "lost 0, computed twice 0" in output
    recording = folder / f"{name}.mcap"
    assert states_equal(folder / f"{name}_offline.mcap", recording) == []
    recorded = verified(recording)
    told = any(event.severity > Severity.INFO for event in recorded.events)
    assert recorded.topics.keys() == (TOPICS if told else TOPICS - {"/rosout"})  # nothing of the other machine
    offline = read_recording(folder / f"{name}_offline.mcap")
    assert [(event.cycle, event.text) for event in recorded.events] == [(e.cycle, e.text) for e in offline.events]
    return output


def test_two_machines_in_one_process_each(folder):
    remapped = ("--ros-args", "-r", "__ns:=/plant/right")
    with (
        Running(*job(folder, "left"), "--composed", "--record", folder / "left.mcap", "--namespace", "left") as left,
        Running(*job(folder, "right"), "--composed", "--record", folder / "right.mcap", *remapped) as right,
    ):
        assert "refused: P-ERR-" in finished(folder, "left", left)
        assert "refused: P-ERR-" not in finished(folder, "right", right)


def test_processes_in_a_namespace_beside_a_machine_without(folder):
    """They begin at about the same time and find their own readers, not those of the other machine."""
    with (
        Running(*job(folder, "left"), "--record", folder / "left.mcap", "--namespace", "/left/") as left,
        Running(*job(folder, "right"), "--composed", "--record", folder / "right.mcap") as right,
    ):
        finished(folder, "left", left)
        finished(folder, "right", right)


def test_a_client_in_the_namespace(folder, client, ros_domain):
    """Topics and services are relative; a second run is refused in the same namespace only."""
    remapped = ("--ros-args", "-r", "__ns:=/cell")
    with Running(folder / "one.yaml", "--duration", "600", "--composed", *remapped) as graph:
        inside, outside = client("/cell"), client("/other")
        inside.spin_until(lambda: inside.blocks)
        mover = inside.create_client(srv.MoveAbsolute, "x/move_absolute")
        inside.spin_until(mover.service_is_ready)
        answer = mover.call_async(srv.MoveAbsolute.Request(target=20.0, velocity=100.0))
        inside.spin_until(answer.done)
        assert answer.result().accepted
        inside.spin_until(lambda: inside.blocks[-1].set_position[-1] == 20.0)
        topics = {name for name, _ in inside.get_topic_names_and_types()}
        assert {
            "/cell/x/block",
            "/cell/plc/block",
            "/cell/clock/tick",
            "/cell/heartbeat",
            "/cell/joint_states",
        } <= topics
        assert {name for name in topics if not name.startswith(("/cell/", "/other/"))} <= {
            "/parameter_events",
            "/rosout",
        }
        names = {(name, namespace) for name, namespace in inside.get_node_names_and_namespaces()}
        assert {("x", "/cell"), ("plc", "/cell"), ("clock", "/cell"), ("run_monitor", "/cell")} <= names
        outside.executor_of_test.spin_once(timeout_sec=0.1)
        assert outside.blocks == []
        error = run("run", folder / "one.yaml", "--duration", "1", "--namespace", "cell", expect=2).stderr
        assert error == (
            f"P-ERR-26107 a run is under way on ROS domain {ros_domain} in namespace /cell of this machine; nothing was "
            "started. Wait for its end, choose another --namespace, or set ROS_DOMAIN_ID to another number\n"
        )
        graph.process.terminate()
        graph.process.communicate(timeout=LAST_WORDS)


def test_a_reader_of_the_same_name_elsewhere_is_none_of_ours(client):
    """ros2 topic echo is no reader of ours, nor is a node of another machine that looks at this topic."""
    node = client("/cell")
    publisher = node.create_publisher(msg.AxisBlock, "x/block", BLOCKS)
    foreign, own = (
        Node("plc", namespace="/other", enable_rosout=False),
        Node("plc", namespace="/cell", enable_rosout=False),
    )
    foreign.create_subscription(msg.AxisBlock, "/cell/x/block", print, BLOCKS)
    node.spin_until(lambda: publisher.get_subscription_count() >= 2)  # the client reads it as well
    assert not process.is_read(node, publisher, {"plc"})
    own.create_subscription(msg.AxisBlock, "x/block", print, BLOCKS)
    node.spin_until(lambda: process.is_read(node, publisher, {"plc"}))
    foreign.destroy_node()
    own.destroy_node()


def test_recordings_are_published_in_a_namespace(folder, client):
    """As they were recorded: cnc_ptp replay with its option, the node player with the rule."""
    recording = folder / "left_offline.mcap"
    offline = read_recording(recording)
    for words in (["replay", recording, "--publish", "--namespace", "again", "--rate", "4"], None):
        node = client("/again")
        if words is None:
            rules = ["--ros-args", "-r", "__ns:=/again", "-r", "__node:=my_player"]
            player = subprocess.Popen([*command()[:2], "cnc_ptp.nodes.player", str(recording), "--rate", "4", *rules])
        else:
            player = subprocess.Popen(command(*words))
        try:
            node.spin_until(
                lambda node=node: (
                    node.blocks and node.blocks[-1].first_cycle + node.blocks[-1].count > offline.last_cycle
                )
            )
            assert node.blocks[-1].set_position[-1] == offline.states["/x/state"]["set_position"][-1]
            assert [event.text for event in node.events] == [event.text for event in offline.events]
            assert player.wait(20.0) == 0
        finally:
            player.kill()
            player.wait()
