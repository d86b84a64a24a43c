"""Helper modules (test/support), the packages `bench` and `figures`; property tests are seeded and never fail on time."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "support"), str(HERE.parent)]

settings.register_profile("project", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("project")


@pytest.fixture
def blocks() -> Any:
    """Blocks of a machine as test data."""
    from recording_support import Blocks

    return Blocks(seed=2)


@pytest.fixture(autouse=True, scope="session")
def only_transitions_of_the_table() -> Iterator[None]:
    """No test of this process takes an axis or a spindle from a state to another by a transition that is not in the tables."""
    from cnc_ptp.protocol import transitions

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(transitions, "strict", True)
        yield


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that put something else in place of a part of the kernel need the interpreted one."""
    from cnc_ptp import KERNEL

    if not KERNEL.interpreted_because:
        skip = pytest.mark.skip(reason="needs the interpreted kernel: CNC_PTP_PURE=1 pytest -m interpreted")
        for item in items:
            if "interpreted" in item.keywords:
                item.add_marker(skip)


def pytest_report_header() -> str:
    from cnc_ptp import KERNEL

    return str(KERNEL)
