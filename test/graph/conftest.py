"""Gives every test module a ROS domain of its own."""

import os
from itertools import count

import pytest

from campaign.graph import free_domain
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
    number = free_domain(next(WISHES), first=1, count=90)
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
