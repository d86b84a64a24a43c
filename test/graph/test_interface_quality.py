"""docs/interfaces.md gives the quality of service of each topic as the nodes create it."""

import re
from pathlib import Path

import pytest
from graph_support import MILL
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSHistoryPolicy, QoSReliabilityPolicy
from ros_support import ros

from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes.clock import ClockNode
from cnc_ptp.nodes.composed import unit_nodes
from cnc_ptp.nodes.supervisor import RunOptions
from cnc_ptp.parameters import read_machine

DOCUMENT = (Path(__file__).parents[2] / "docs" / "interfaces.md").read_text(encoding="utf-8")
RELIABILITY = {QoSReliabilityPolicy.RELIABLE: "reliable", QoSReliabilityPolicy.BEST_EFFORT: "best effort"}
DURABILITY = {
    QoSDurabilityPolicy.VOLATILE: "volatile",
    QoSDurabilityPolicy.SYSTEM_DEFAULT: "volatile",
    QoSDurabilityPolicy.TRANSIENT_LOCAL: "transient local",
}


def table(begin: str) -> list[list[str]]:
    """Cells of the rows of the table that begins with this header."""
    text = DOCUMENT.partition(begin)[2].partition("\n\n")[0]
    return [line.strip("| ").split(" | ") for line in text.splitlines()[2:]]


def settings_of(quality) -> str:
    assert quality.history == QoSHistoryPolicy.KEEP_LAST
    text = f"{RELIABILITY[quality.reliability]}, keep last {quality.depth}, {DURABILITY[quality.durability]}"
    seconds = quality.lifespan.nanoseconds // 10**9
    return f"{text}, {seconds} s" if 0 < seconds < 10**9 else text  # otherwise without an end


NAMED = {name: settings for name, settings, _ in table("| quality of service | settings | why |")}
NAMED["as rcl"] = "reliable, keep last 1000, transient local, 10 s"


def documented(cell: str) -> str:
    """Settings of a cell: a name of the first table, or the settings themselves."""
    return NAMED.get(cell.partition(":")[0], cell)


def topics_of(cell: str) -> list[str]:
    """Topics of the mill that are in a cell: `/<axis>/block` is three."""
    kinds = unit_kinds(read_machine(str(MILL)))
    found = []
    for topic in re.findall(r"`(/.*?)`", cell):
        kind = (re.findall(r"<(\w+)>", topic) or [""])[0]
        units = [unit for unit, of in kinds.items() if of == kind or (kind == "unit" and of != "plc")]
        found += [re.sub("<.*>", unit, topic) for unit in units] if kind else [topic]
    return found


@pytest.fixture(scope="module")
def created(ros_domain):
    """What the nodes of the mill create: (publish or subscribe, node) and topic -> settings."""
    found = {}

    def noted(word, create):
        def call(node, message_type, topic, *others, **options):
            quality = next(each for each in (*others, *options.values()) if hasattr(each, "durability"))
            found.setdefault((word, node.get_name(), f"/{topic.removeprefix('/')}"), set()).add(settings_of(quality))
            return create(node, message_type, topic, *others, **options)

        return call

    machine = read_machine(str(MILL))
    with pytest.MonkeyPatch.context() as patch, ros():
        for word in ("create_publisher", "create_subscription"):
            patch.setattr(Node, word, noted(word, getattr(Node, word)))
        nodes = [*unit_nodes(machine, RunOptions(str(MILL))), ClockNode(machine, wait_for=(), free_run=True)]
        for node in nodes:
            node.destroy_node()
    return found


def test_topics_that_nodes_publish(created):
    expected = {
        topic: {documented(quality)}
        for topics, _, _, quality, _ in table("| topic | type | rate | QoS | from |")
        for topic in topics_of(topics)
    }
    made = {}
    for (word, _, topic), settings in created.items():
        if word == "create_publisher" and topic != "/parameter_events":
            made.setdefault(topic, set()).update(settings)
    assert made == expected


def test_topics_that_the_plc_writes(created):
    expected = {
        topic: {documented(next(iter(re.findall(r"QoS (\w+)", effect)), "PLC input"))}
        for topics, _, effect, *_ in table("| topic | type | effect | no more messages | `valid: false` |")
        for topic in topics_of(topics)
    }
    published = {topic for word, _, topic in created if word == "create_publisher"}
    heard = {
        topic: settings
        for (word, node, topic), settings in created.items()
        if word == "create_subscription" and node == "plc" and topic not in published
    }
    assert heard == expected
