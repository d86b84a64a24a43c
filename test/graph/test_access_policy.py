"""The access policy for SROS2: as it is shipped, as docs/interfaces.md says, and as nodes that run use it."""

import time
from pathlib import Path
from xml.etree import ElementTree

import pytest
from graph_support import LAST_WORDS, Running, one_axis_machine, small_machine
from rclpy.node import Node
from ros_support import ros

from cnc_ptp.nodes.access_policy import CLIENT, ROSOUT, machine_access, policy_text
from cnc_ptp.nodes.topics import DRIVE_STOPS, EVENT, MONITOR, RECORDER, block_topic
from cnc_ptp.parameters import read_machine

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "tools" / "sros2" / "policy.xml"
PARTS = ("/_action/feedback", "/_action/status", "/_action/send_goal", "/_action/cancel_goal", "/_action/get_result")
"""Of an action: an action in a policy stands for all of them."""
OF_EVERY_NODE = {"get_type_description"}
"""Services that rclpy adds; the policy leaves them out, as no node of ours calls them."""


def test_the_shipped_policy_is_that_of_the_mill():
    """After a change: .venv/bin/python -m cnc_ptp.nodes.access_policy config/mill.yaml > tools/sros2/policy.xml"""
    assert SHIPPED.read_text() == policy_text(read_machine(ROOT / "config" / "mill.yaml"))


def test_every_topic_that_is_read_has_a_writer_and_blocks_and_services_have_one_owner():
    machine = read_machine(ROOT / "config" / "mill.yaml")
    nodes = machine_access(machine)
    published = {topic for node in nodes for topic in node.publish}
    read = {topic for node in nodes for topic in node.subscribe}
    assert read <= published
    assert all("*" not in element.text for element in ElementTree.fromstring(policy_text(machine)).iter("topic"))
    for unit in ("x", "s", "channel", "plc"):
        owners = [node.name for node in nodes if block_topic(unit) in node.publish]
        assert owners == [unit]
    replies = [service for node in nodes for service in node.reply]
    assert len(replies) == len(set(replies))
    client = next(node for node in nodes if node.name == CLIENT)
    assert client.request <= set(replies)


class Looker(Node):
    """Somebody who asks what each node of a machine has."""

    def __init__(self):
        super().__init__("looker", enable_rosout=False)

    def names_of(self, node):
        """Topics and services of a node, by the rule that permits them."""
        found = {
            "publish": self.get_publisher_names_and_types_by_node(node, "/"),
            "subscribe": self.get_subscriber_names_and_types_by_node(node, "/"),
            "reply": self.get_service_names_and_types_by_node(node, "/"),
            "request": self.get_client_names_and_types_by_node(node, "/"),
        }
        return {rule: {name for name, _ in names} for rule, names in found.items()}


def split_actions(names):
    """Names that are no parts of actions; actions."""
    actions = {name.removesuffix(part) for name in names for part in PARTS if name.endswith(part)}
    plain = {name for name in names if not name.endswith(PARTS)}
    return {name for name in plain if name.rpartition("/")[2] not in OF_EVERY_NODE}, actions


def absolute(names):
    return {name if name.startswith("/") else f"/{name}" for name in names}


@pytest.fixture(params=[(one_axis_machine, ("--composed",)), (small_machine, ())], ids=["composed", "processes"])
def running(request, tmp_path):
    """A machine that runs, and somebody who looks at it."""
    make, options = request.param
    file = make(tmp_path)
    with Running(file, *options, "--stay", "--record", tmp_path / "run.mcap") as graph:
        with ros():
            looker = Looker()
            graph.wait_until_recorded(tmp_path / "run.mcap", 1)
            yield read_machine(file), looker, bool(options)
            looker.destroy_node()
        graph.process.terminate()
        graph.process.communicate(timeout=LAST_WORDS)


def complete(looker, access):
    """What a node has, once discovery has told of all that the policy names, or nothing has come for 5 s."""
    deadline = time.monotonic() + 5.0
    while True:
        try:
            found = looker.names_of(access.name)
        except Exception:  # rclpy has an exception of its own for a node that is not known yet
            found = {}
        if found and absolute(access.reply) <= found["reply"] and absolute(access.publish) <= {*found["publish"]}:
            return found
        if time.monotonic() > deadline:
            return found
        time.sleep(0.1)


def test_what_nodes_have_is_what_they_may(running):
    """In one process blocks are handed over: fewer topics are read, none more; and nobody watches processes and drives."""
    machine, looker, composed = running
    nodes = {access.name: access for access in machine_access(machine)}
    others = {block_topic(unit) for unit in (*machine.axes, *machine.spindles)}
    for name in (*machine.sets, "plc", "clock", RECORDER, MONITOR):
        if name == "machine":
            continue
        access, found = nodes[name], complete(looker, nodes[name])
        published, executed = split_actions(found["publish"])
        replied, served = split_actions(found["reply"])
        subscribed, _ = split_actions(found["subscribe"])
        unwatched = absolute({EVENT, DRIVE_STOPS, ROSOUT}) if composed and name == "clock" else set()
        if composed and name == MONITOR:
            assert published <= absolute(access.publish)
        else:
            assert published - unwatched == absolute(access.publish) - unwatched, name
        assert executed == served == absolute(access.execute), name
        assert replied == absolute(access.reply), name
        assert composed or found["request"] == absolute(access.request), name
        assert subscribed <= absolute(access.subscribe), name
        if not composed and name != MONITOR:
            assert absolute(access.subscribe - others) <= subscribed, name
