"""A tunnel between two namespaces: a client at its far end commands the machine, a third namespace reaches nothing."""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from graph_support import Running, one_axis_machine
from network_support import (
    FOREIGN,
    LOOK,
    NEAR,
    NOBODY,
    PATIENT,
    foreign,
    other_computer,
    why_no_namespaces,
    wide_open,
)

from cnc_ptp.recording.reader import read_recording

PAIR = Path(__file__).parents[2] / "tools" / "tunnel" / "pair.sh"
A, B = "10.81.0.1", "10.81.0.2"


def why_no_tunnel():
    """Why this computer makes no tunnel; empty if it does."""
    missing = [name for name in ("ip", "wg") if shutil.which(name) is None]
    if missing:
        return f"{' and '.join(missing)} not installed: apt-get install wireguard-tools iproute2"
    if reason := why_no_namespaces():
        return reason
    made = subprocess.run(["ip", "link", "add", "wg-try", "type", "wireguard"], capture_output=True, check=False)
    if made.returncode == 0:
        subprocess.run(["ip", "link", "delete", "wg-try"], check=True)
        return ""
    return "" if shutil.which("wireguard-go") else "the kernel has no WireGuard: apt-get install wireguard-go"


pytestmark = pytest.mark.skipif(bool(why_no_tunnel()), reason=why_no_tunnel())


@pytest.fixture
def tunnel():
    """Two namespaces, which reach each other and nothing else."""
    names = [f"{name}{os.getpid() % 100000}" for name in ("cella", "cellb")]
    subprocess.run([PAIR, "up", *names, "51830", "51831"], check=True)
    try:
        yield names
    finally:
        subprocess.run([PAIR, "down", *names], check=True)


def reaching(peer):
    """The environment of docs/security.md at one end of the tunnel."""
    return wide_open(ROS_STATIC_PEERS=peer, FASTDDS_BUILTIN_TRANSPORTS="UDPv4")


def inside(namespace):
    return ("ip", "netns", "exec", namespace)


def running(a, folder):
    """A machine in A, recorded in run.mcap."""
    machine, recording = one_axis_machine(folder), folder / "run.mcap"
    words = [*inside(a), sys.executable, "-m", "cnc_ptp", "run", machine, "--composed", "--stay", "--record", recording]
    run = Running.__new__(Running)
    run.process = subprocess.Popen(
        list(map(str, words)), env=reaching(B), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    return run


@pytest.mark.long
def test_two_ends_and_a_stranger(tunnel, tmp_path):
    a, b = tunnel
    recording = tmp_path / "run.mcap"
    run = running(a, tmp_path)
    try:
        run.wait_until_recorded(recording, 1)
        with other_computer() as stranger:
            for peer in (NEAR, A):
                assert foreign(LOOK, inside=inside(stranger), environment=reaching(peer)) == NOBODY
        assert foreign(LOOK, environment=reaching(A)) == NOBODY  # the computer itself, outside of both ends
        far = subprocess.run(
            [*inside(b), sys.executable, str(FOREIGN), str(PATIENT)],
            env=reaching(A),
            capture_output=True,
            text=True,
            timeout=180,
            check=True,
        )
        found = json.loads(far.stdout.splitlines()[-1])
        assert found["setpoints"] > 0
        assert found["accepted"] is not None
        run.process.send_signal(2)
        run.finish(0)
    finally:
        run.end()
    commands = [record.command for record in read_recording(recording).commands if record.target == "x"]
    assert commands.count("move_absolute") == 1


JOGS = """
import sys, rclpy
from rclpy.executors import SingleThreadedExecutor
from cnc_ptp import msg
from cnc_ptp.nodes.topics import BLOCKS, PLC_INPUT
rclpy.init()
node = rclpy.create_node("far", enable_rosout=False)
jog = node.create_publisher(msg.Jog, "x/jog", PLC_INPUT)
node.create_subscription(msg.AxisBlock, "x/block", lambda b: b.set_velocity[-1] == 5.0 and print("moves", flush=True), BLOCKS)
node.create_timer(0.04, lambda: jog.publish(msg.Jog(valid=True, velocity=5.0)))
executor = SingleThreadedExecutor()
executor.add_node(node)
executor.spin()
"""


@pytest.mark.long
def test_a_tunnel_that_is_cut_ends_a_jog_and_nothing_else(tunnel, tmp_path):
    a, b = tunnel
    run = running(a, tmp_path)
    words = [*inside(b), sys.executable, "-c", JOGS]
    try:
        run.wait_until_recorded(tmp_path / "run.mcap", 1)
        with subprocess.Popen(words, env=reaching(A), stdout=subprocess.PIPE, text=True) as far:
            assert far.stdout.readline() == "moves\n"
            subprocess.run(["ip", "-n", b, "link", "set", f"wg-{b[:12]}", "down"], check=True)
            time.sleep(3.0)
            far.kill()
        assert run.process.poll() is None
        run.process.send_signal(2)
        run.finish(0)
    finally:
        run.end()
    recorded = read_recording(tmp_path / "run.mcap")
    assert [event.error_id for event in recorded.events if event.error_id] == [26134]
    rows = recorded.states["/x/state"]
    assert rows["set_velocity"].max() == 5.0 and rows["set_velocity"][-1] == 0.0
    assert not rows["error_id"].any()


def test_the_ends_are_gone_afterwards():
    names = [f"{name}{os.getpid() % 100000}" for name in ("gonea", "goneb")]
    subprocess.run([PAIR, "up", *names, "51832", "51833"], check=True)
    subprocess.run([PAIR, "down", *names], check=True)
    known = subprocess.run(["ip", "netns", "list"], capture_output=True, text=True, check=True).stdout
    links = subprocess.run(["ip", "-brief", "link"], capture_output=True, text=True, check=True).stdout
    assert not [name for name in names if name in known or name in links]


@pytest.mark.parametrize("words", [(), ("up", "cell"), ("down",), ("sideways", "a", "b")])
def test_a_wrong_call_says_how_it_is_meant(words):
    done = subprocess.run([PAIR.with_name("end.sh"), *words], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("end.sh up NAMESPACE OWN_ADDRESS OWN_PORT KEY_FILE PEER_ADDRESS PEER_PUBLIC_KEY")
