"""Gives every test module a ROS domain of its own."""

import os
import socket
from itertools import count

import pytest

from cnc_ptp.client import graph_link
from cnc_ptp.commands.client import jog, status
from cnc_ptp.nodes.client import machine_client

FROM_OUTSIDE = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTDDS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS")
PATIENT = 30.0
"""Seconds for an answer."""
WISHES = count(os.getpid() * 47)


@pytest.fixture(scope="module", autouse=True)
def ros_domain():
    """The next of 90 domains: neither modules of a session nor sessions beside each other meet."""
    before = dict(os.environ)
    for name in FROM_OUTSIDE:
        os.environ.pop(name, None)
    number = free_domain(next(WISHES))
    os.environ["ROS_DOMAIN_ID"] = str(number)
    yield number
    os.environ.clear()
    os.environ.update(before)


@pytest.fixture(scope="module", autouse=True)
def patient_clients():
    """Clients in the process of a test wait longer than users do: what else runs on the machine fails no test."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (machine_client, graph_link, jog, status):
            patch.setattr(module, "PATIENCE", PATIENT)
        yield


def free_domain(wish):
    """A domain on which no run is under way, 1 … 90."""
    for number in range(wish, wish + 90):
        domain = 1 + number % 90
        with socket.socket(socket.AF_UNIX) as claim:
            try:
                claim.bind(f"\0cnc_ptp/domain/{domain}")
            except OSError:
                continue
            return domain
    raise AssertionError("90 runs at once")
