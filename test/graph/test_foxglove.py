"""The live stream for Foxglove, seen by a client of another library (websockets) that speaks its protocol."""

import json
import socket
import subprocess
import sys
import time

import pytest
from graph_support import run, verified
from long_support import long
from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory
from recording_support import smooth_blocks

from cnc_ptp.errors import CncError
from cnc_ptp.nodes import live_stream
from cnc_ptp.nodes.live_stream import LiveServer, require_foxglove

foxglove = pytest.importorskip("foxglove")
connect = pytest.importorskip("websockets.sync.client").connect
PROTOCOL = "foxglove.sdk.v1"
MESSAGE_DATA = 1
HEAD = 13
"""Bytes before the message: opcode, subscription, log time."""


@pytest.fixture
def port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Client:
    """Keeps the channels that the server has announced."""

    def __init__(self, port, patience=20.0):
        end = time.monotonic() + patience
        while True:
            try:
                self.socket = connect(f"ws://127.0.0.1:{port}", subprotocols=[PROTOCOL])
                break
            except OSError:
                assert time.monotonic() < end, "the server does not listen"
                time.sleep(0.1)
        self.channels = {}

    def until(self, wanted, patience=20.0):
        """Takes what comes until `wanted` of it is true."""
        end = time.monotonic() + patience
        while time.monotonic() < end:
            received = self.socket.recv(timeout=patience)
            if isinstance(received, str):
                message = json.loads(received)
                if message["op"] == "advertise":
                    self.channels |= {channel["topic"]: channel for channel in message["channels"]}
            if wanted(received):
                return received
        raise AssertionError(f"nothing of it came; channels {sorted(self.channels)}")

    def channel(self, topic):
        if topic not in self.channels:
            self.until(lambda _: topic in self.channels)
        return self.channels[topic]

    def subscribe(self, topic):
        subscription = {"id": 7, "channelId": self.channel(topic)["id"]}
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": [subscription]}))

    def message(self):
        """Log time in ns, bytes of the next one."""
        data = self.until(lambda received: isinstance(received, bytes) and received[0] == MESSAGE_DATA)
        return int.from_bytes(data[5:HEAD], "little"), data[HEAD:]


def decoded(channel, data):
    schema = Schema(1, channel["schema"].encode(), channel["schemaEncoding"], channel["schemaName"])
    return DecoderFactory().decoder_for("cdr", schema)(data)


def test_a_client_sees_channels_and_messages(port):
    server = LiveServer(port, "machine")
    stream = live_stream.live_stream(server, 1_000_000_000, 1_000_000)
    client = Client(port)
    blocks = smooth_blocks(0.2)
    try:
        for name, block in blocks[:6]:
            stream.block(name, block)
        stream.flush()
        client.subscribe("/x/state")
        deadline = time.monotonic() + 10.0
        while not server._channels[stream._topics["/x/state"].channel_id].has_sinks():
            assert time.monotonic() < deadline
            time.sleep(0.01)
        for name, block in blocks[6:12]:
            stream.block(name, block)
        stream.flush()
        channel = client.channel("/x/state")
        assert (channel["encoding"], channel["schemaName"]) == ("cdr", "cnc_ptp/msg/AxisState")
        assert channel["schemaEncoding"] == "ros2msg"
        for cycle in range(10, 20):
            log_time, data = client.message()
            state = decoded(channel, data)
            assert (log_time, state.cycle) == (1_000_000_000 + 1_000_000 * cycle, cycle)
            position = next(block for name, block in blocks[6:12] if name == "x").set_position[cycle - 10]
            assert state.set_position == position
    finally:
        stream.close()


def test_a_port_that_is_taken(port):
    with socket.socket() as other:
        other.bind(("127.0.0.1", port))
        other.listen()
        with pytest.raises(CncError) as caught:
            LiveServer(port, "machine")
    assert str(caught.value) == (
        f"P-ERR-26024 --foxglove: port {port}: another program listens there; nothing was started, "
        "give another one: --foxglove PORT"
    )


def test_a_server_that_does_not_start(port, monkeypatch):
    def fails(**_options):
        raise RuntimeError("no runtime")

    monkeypatch.setattr(foxglove, "start_server", fails)
    with pytest.raises(CncError, match=f"P-ERR-26024 --foxglove: port {port}: no runtime; nothing was started"):
        LiveServer(port, "machine")


def test_without_the_package(port, monkeypatch):
    monkeypatch.setattr(live_stream.importlib.util, "find_spec", lambda _name: None)
    with pytest.raises(CncError) as caught:
        require_foxglove(port)
    assert str(caught.value) == (
        "P-ERR-26023 --foxglove: foxglove-sdk is not installed; nothing was started, install it with: "
        "pip install 'cnc_ptp[foxglove]'"
    )


@pytest.mark.parametrize("composed", [[], *long([["--composed"]])], ids=["graph", "composed"])
def test_a_running_machine_streams_what_it_records(port, tmp_path, composed):
    record = ["--record", str(tmp_path / "run.mcap")] if composed else []
    command = [sys.executable, "-m", "cnc_ptp", "run", "config/ptp.yaml", "--duration", "8", *composed, *record]
    process = subprocess.Popen([*command, "--foxglove", str(port)], stdout=subprocess.PIPE)
    try:
        client = Client(port)
        client.subscribe("/x/state")
        _, data = client.message()
        first = decoded(client.channel("/x/state"), data).cycle
        _, data = client.message()
        assert decoded(client.channel("/x/state"), data).cycle == first + 1
        assert {"/clock/tick", "/plc/block", "/x/block"} <= client.channels.keys()
    finally:
        process.wait(timeout=60)
    assert process.returncode == 0, process.stdout.read()


@pytest.mark.long
def test_a_stream_beside_parts_and_the_last_seconds(port, tmp_path):
    """All of the recorder at once: parts, the last seconds, the live stream."""
    folder = tmp_path / "run"
    words = ["run", "config/ptp.yaml", "--duration", "20", "--record", str(folder), "--split", "5s", "--keep", "3"]
    process = subprocess.Popen(
        [sys.executable, "-m", "cnc_ptp", *words, "--foxglove", str(port)], stdout=subprocess.PIPE
    )
    try:
        client = Client(port, patience=90.0)
        client.subscribe("/x/state")
        streamed = [decoded(client.channel("/x/state"), client.message()[1]) for _ in range(200)]
        done = run("do", "recorder", "snapshot", tmp_path / "last.mcap", "seconds=1")
        assert "begins with cycle" in done.stdout
    finally:
        process.wait(timeout=120)
    assert process.returncode == 0, process.stdout.read()
    assert len([*folder.glob("run_*.mcap")]) == 4
    rows = verified(folder).states["/x/state"]
    assert verified(tmp_path / "last.mcap").last_cycle <= 19_999
    assert rows["cycle"].tolist() == list(range(20_000))
    for state in streamed:
        assert rows["set_position"][state.cycle] == state.set_position
    assert [state.cycle for state in streamed] == list(range(streamed[0].cycle, streamed[0].cycle + 200))
