"""Helper modules (test/support), the packages `bench` and `figures`; property tests are seeded and never fail on time."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "support"), str(HERE.parent)]

settings.register_profile("project", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("project")


def strict(take):
    """`take` of an axis or a spindle, only from the states that its table of transitions names."""

    def checked(self, transition):
        assert self.state in transition.sources, (
            f"{self.name}: no transition '{transition.cause}' from {self.state.name}"
        )
        take(self, transition)

    return checked


@pytest.fixture(autouse=True, scope="session")
def only_transitions_of_the_table() -> Iterator[None]:
    """No test of this process takes an axis or a spindle from a state to another by a transition that is not in the tables."""
    from cnc_ptp.axis.axis import Axis
    from cnc_ptp.spindle.spindle import Spindle

    with pytest.MonkeyPatch.context() as patch:
        for unit in (Axis, Spindle):
            patch.setattr(unit, "take", strict(unit.take))
        yield
