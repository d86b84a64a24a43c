"""Gives every test module a ROS domain of its own."""

import os
import socket

import pytest

FROM_OUTSIDE = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTDDS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS")


@pytest.fixture(scope="module", autouse=True)
def ros_domain(request):
    """One of 90 domains by module and process, so that runs beside each other do not meet."""
    before = dict(os.environ)
    for name in FROM_OUTSIDE:
        os.environ.pop(name, None)
    number = free_domain(hash_of(request.module.__name__) + os.getpid())
    os.environ["ROS_DOMAIN_ID"] = str(number)
    yield number
    os.environ.clear()
    os.environ.update(before)


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


def hash_of(text):
    return sum(ord(character) * (index + 1) for index, character in enumerate(text))
