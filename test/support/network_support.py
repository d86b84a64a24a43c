"""Network namespaces for tests: a second computer, as far as the network goes."""

import json
import os
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

FOREIGN = Path(__file__).with_name("foreign_participant.py")
NOBODY = {"topics": [], "setpoints": 0, "readers": 0, "accepted": None}
"""What a participant finds that reaches nothing."""
LOOK = 8.0
"""Seconds for which one looks that is to find nothing; where it may find something, it does within 2 s."""
PATIENT = 60.0
NEAR, FAR = "10.82.0.1", "10.82.0.2"
"""Addresses of this computer and of the other one on the cable between them."""
CHOSEN = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTDDS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS")


def why_no_namespaces():
    """Why this process cannot make network namespaces; empty if it can."""
    if os.geteuid():
        return "network namespaces with a cable between them take root"
    tried = subprocess.run(["ip", "netns", "exec", "none", "true"], capture_output=True, text=True, check=False)
    tried = tried if "No such file" not in tried.stderr else subprocess.run(["unshare", "--net", "true"], check=False)
    return "" if tried.returncode == 0 else "the system permits no network namespaces"


def ip(*words):
    subprocess.run(["ip", *map(str, words)], check=True)


@contextmanager
def other_computer():
    """A namespace that a cable joins to this one; its name."""
    number = os.getpid() % 100000
    name, here, there = f"other{number}", f"near{number}", f"far{number}"
    ip("netns", "add", name)
    try:
        ip("link", "add", here, "type", "veth", "peer", "name", there, "netns", name)
        ip("address", "add", f"{NEAR}/24", "dev", here)
        ip("link", "set", here, "up")
        ip("-n", name, "address", "add", f"{FAR}/24", "dev", there)
        ip("-n", name, "link", "set", there, "up")
        ip("-n", name, "link", "set", "lo", "up")
        yield name
    finally:
        ip("netns", "delete", name)


def wide_open(**more):
    """An environment in which ROS reaches whatever can be reached: all networks, shared memory, known addresses."""
    environment = {name: value for name, value in os.environ.items() if name not in CHOSEN}
    return environment | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"} | more


def foreign(seconds, *, inside=(), environment=None):
    """What a foreign participant finds and does; `inside`: words before its command line."""
    words = [*inside, sys.executable, str(FOREIGN), str(seconds)]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=180, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def udp_addresses(processes):
    """Local addresses (hexadecimal, as /proc has them) of the UDP sockets of processes."""
    inodes = set()
    for process in processes:
        for link in Path(f"/proc/{process}/fd").iterdir():
            try:
                inodes.add(os.readlink(link))
            except OSError:
                continue
    rows = [
        line.split() for table in ("udp", "udp6") for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]
    ]
    return {row[1].rpartition(":")[0] for row in rows if f"socket:[{row[9]}]" in inodes}
