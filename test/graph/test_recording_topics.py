"""Topics besides the blocks: recorded in the graph, and published again with their quality of service."""

import re
import subprocess
import sys
import time

import pytest
from client_support import Client, connected
from graph_support import MILL, SHORT_PROGRAM, Running, command, one_axis_machine, run, verified
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, qos_profile_rosout_default
from rclpy.serialization import deserialize_message
from ros_support import ros

from cnc_ptp import msg
from cnc_ptp.nodes import player, process
from cnc_ptp.nodes.observed_topics import observed_topics, type_name
from cnc_ptp.nodes.topics import BLOCK_TYPES, BLOCKS, EVENTS, PLC_EDGES, PLC_INPUT, REMEMBERED_BLOCKS
from cnc_ptp.parameters import read_machine
from cnc_ptp.recording import qos
from cnc_ptp.recording.reader import TopicInfo, iter_messages, read_recording


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A run of one axis to which a PLC writes."""
    folder = tmp_path_factory.mktemp("topics")
    machine = one_axis_machine(folder)
    path = folder / "run.mcap"
    both = 2  # plc and recorder
    with Running(machine, "--duration", "600", "--record", path) as graph:
        with connected(Client, machine) as client:
            client.wait_blocks("plc", 3)
            client.write("/x/override", msg.Override, readers=both, percent=70.0, valid=True, sequence=1)
            client.write("/x/jog", msg.Jog, readers=both, velocity=0.0, valid=True)
            for counter in range(3):
                client.write("/plc/life_sign", msg.LifeSign, readers=both, counter=counter)
            client.wait_blocks("plc", 20)
        graph.process.terminate()
        graph.finish(expect=1)
    return path


def recorded_messages(path, topic, message_type):
    return [deserialize_message(found.cdr, message_type) for found in iter_messages(path, topics=[topic])]


def test_plc_topics_and_joint_states_are_recorded(recording):
    recorded = verified(recording)
    [override] = recorded_messages(recording, "/x/override", msg.Override)
    assert (override.percent, override.valid, override.sequence) == (70.0, True, 1)
    assert [sign.counter for sign in recorded_messages(recording, "/plc/life_sign", msg.LifeSign)] == [0, 1, 2]
    assert recorded.topics["/x/jog"].count == 1
    assert recorded.topics["/joint_states"].count > 5
    commands = [record.cycle for record in recorded.commands if record.command == "set_override"]
    [heard] = iter_messages(recording, topics=["/x/override"])
    acted = recorded.start_ns + commands[-1] * recorded.cycle_time_ns
    assert abs(acted - heard.log_time_ns) * 1e-9 < 0.5


def test_handshakes_are_recorded_alike_offline_and_in_the_graph(tmp_path):
    (tmp_path / "short.nc").write_text(SHORT_PROGRAM)
    requests = {}
    for name, options in (("simulate", []), ("run", ["--composed", "--free-run"])):
        path = tmp_path / f"{name}.mcap"
        run(name, MILL, "--program", tmp_path / "short.nc", "--record", path, *options)
        found = recorded_messages(path, "/channel/handshake", msg.HandshakeRequest)
        requests[name] = [(one.cycle, one.id, one.kind, one.number, one.line) for one in found]
        assert read_recording(path).topics["/channel/handshake"].qos == qos.profiles_text(qos.REMEMBERED)
    assert requests["run"] == requests["simulate"]
    assert [kind + str(number) for _, _, kind, number, _ in requests["run"]][:2] == ["T1", "D1"]


def test_qualities_of_the_recording_are_those_of_the_nodes():
    """recording.qos knows no ROS, nodes.topics does: they say the same."""
    for quality, known in (
        (BLOCKS, qos.BLOCKS),
        (EVENTS, qos.REMEMBERED),
        (PLC_INPUT, qos.INPUT),
        (PLC_EDGES, qos.EDGES),
    ):
        assert quality == player.qos_of(TopicInfo("/t", "a/msg/B", qos=qos.profiles_text(known)))
    for kind, message_type in BLOCK_TYPES.items():
        published = REMEMBERED_BLOCKS if kind in ("axis", "spindle") else BLOCKS
        assert player.qos_of(TopicInfo("/t", type_name(message_type))) == published
    for topic, message_type, quality in observed_topics(read_machine(str(MILL))):
        assert player.qos_of(TopicInfo("/t", type_name(message_type))) == quality, topic
    assert player.qos_of(TopicInfo("/rosout", "rcl_interfaces/msg/Log")) == qos_profile_rosout_default


@pytest.fixture(scope="module")
def published(recording):
    """What `replay --publish` prints, the durability that it offers by topic, and the overrides that a reader gets.

    A busy machine can need longer to match a reader than the player waits for it: then it is played again.
    """
    for _ in range(3):
        output, offered, overrides = publish(recording)
        if overrides:
            break
    return output, offered, overrides


def publish(recording):
    heard, offered = [], {}
    words = command("replay", recording, "--publish", "--inputs", "--rate", "0.5")
    with ros():
        node = Node("test_reader", enable_rosout=False)
        node.create_subscription(msg.Override, "/x/override", heard.append, PLC_INPUT)
        executor = process.EventsExecutor()
        executor.add_node(node)
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as publishing:
            while publishing.poll() is None:
                executor.spin_once(timeout_sec=0.05)
                for topic in ("/x/block", "/events", "/x/override", "/x/state"):
                    for info in node.get_publishers_info_by_topic(topic):
                        offered[topic] = info.qos_profile.durability
            output = publishing.stdout.read()
        node.destroy_node()
    return output, offered, [message.percent for message in heard]


def test_replay_publishes_with_the_recorded_quality_and_says_so(recording, published):
    total = sum(1 for _ in iter_messages(recording))
    topics = len(read_recording(recording).topics)
    output, offered, overrides = published
    first, last = output.splitlines()
    assert re.fullmatch(
        rf"publishing {re.escape(str(recording))} on ROS domain \d+: {topics} topics, {total} messages, "
        r"(\d+\.\d) s at rate 0\.5, so (\d+\.\d) s; Ctrl-C ends it",
        first,
    )
    assert last == f"published {total} of {total} messages on {topics} topics"
    remembered = {topic for topic, durability in offered.items() if durability == QoSDurabilityPolicy.TRANSIENT_LOCAL}
    assert (remembered, len(offered)) == ({"/x/block", "/events"}, 4)
    assert overrides == [70.0]


def test_plc_inputs_are_left_out_unless_asked_for(recording):
    written = {"/x/jog", "/x/override", "/plc/life_sign"}
    with ros():
        for inputs in (False, True):
            node = player.PlayerNode(str(recording), rate=1.0, inputs=inputs)
            assert written.isdisjoint(publisher.topic_name for publisher in node.publishers) is not inputs
            assert set(node.inputs_left_out) == (set() if inputs else written)
            node.destroy_node()


def test_interrupted_replay_says_how_far_it_came(recording):
    publishing = subprocess.Popen(
        command("replay", recording, "--publish", "--rate", "0.05"), stdout=subprocess.PIPE, text=True
    )
    assert publishing.stdout.readline().startswith("publishing ")
    time.sleep(1.5)
    refused = subprocess.run(
        [sys.executable, "-m", "cnc_ptp.nodes.player", str(recording)], capture_output=True, text=True, check=False
    )
    assert refused.returncode == 2
    assert "P-ERR-26107 a run is under way on ROS domain " in refused.stderr
    publishing.terminate()
    output = publishing.communicate(timeout=20.0)[0]
    assert re.fullmatch(r"published \d+ of \d+ messages on \d+ topics, up to \d+\.\d s of \d+\.\d s\n", output)


def test_offsets_are_recorded_alike_offline_and_in_the_graph(tmp_path):
    """A topic of the channel, in the recording from the cycle on in which they count."""
    program = tmp_path / "offsets.nc"
    program.write_text("V.G.NP[1].V.X = 5\nG00 X1\nG54 X1\n#ROTATION ON [ANGLE=30]\nG92 Y1\nX2\nM30\n")
    shown = []
    for name, options in (("simulate", []), ("run", ["--composed", "--free-run"]), ("run", ["--free-run"])):
        path = tmp_path / f"{name}{len(options)}.mcap"
        run(name, MILL, "--program", program, "--record", path, *options)
        found = recorded_messages(path, "/channel/offsets", msg.ChannelOffsets)
        shown.append([(each.cycle, each.line, each.zero_index, each.rotated, list(each.matrix)) for each in found])
        assert [each.zero_index for each in found] == [0, 1, 1, 0]
        assert read_recording(path).topics["/channel/offsets"].qos == qos.profiles_text(qos.REMEMBERED)
    assert shown[0] == shown[1] == shown[2]
