"""Makes graph_support importable and gives every test module a ROS domain of its own."""

import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

FROM_OUTSIDE = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTDDS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS")


@pytest.fixture(scope="module", autouse=True)
def ros_domain(request):
    """One of 90 domains by module and process, so that runs beside each other do not meet."""
    before = dict(os.environ)
    for name in FROM_OUTSIDE:
        os.environ.pop(name, None)
    number = 1 + (hash_of(request.module.__name__) + os.getpid()) % 90
    os.environ["ROS_DOMAIN_ID"] = str(number)
    yield number
    os.environ.clear()
    os.environ.update(before)


def hash_of(text):
    return sum(ord(character) * (index + 1) for index, character in enumerate(text))
