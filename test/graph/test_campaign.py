"""A short campaign: a few faults of each kind, at moments that a seed gives; `make campaign` is the long one."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from long_support import long

from campaign import disks, kills, load
from campaign.cases import CASES
from campaign.kills import HOLD, KILL, TERM, Fault
from campaign.load import LoadRow

FAULTS = (
    Fault("program", "y", KILL, 0.0, 2.345),
    Fault("gantry", "y", HOLD, 0.6, 1.789),
    Fault("ptp", "recorder", KILL, 0.0, 4.0),
)
"""Other kinds are in test_kill.py, test_drive_watch.py and test_slaves.py."""
MORE_FAULTS = (
    Fault("ptp", "c", TERM, 0.0, 1.234),
    Fault("coupled", "x", KILL, 0.0, 2.123),
    Fault("tapping", "supervisor", KILL, 0.0, 2.5),
    Fault("thread", "clock", HOLD, 1.5, 2.5),
)


@pytest.mark.parametrize(
    "fault",
    [*FAULTS, *long(MORE_FAULTS)],
    ids=lambda fault: f"{fault.case}-{fault.node}-{fault.signal}",
)
def test_a_fault(fault: Fault, tmp_path: Path, ros_domain: int) -> None:
    row = kills.run(fault, tmp_path, domain=ros_domain)
    assert row.problems == [] and row.outcome == "stopped"
    assert row.cycles > 500
    assert (tmp_path / "seen.npz").exists() == (fault.node == "recorder")


def test_a_suspended_graph_goes_on(tmp_path: Path, ros_domain: int) -> None:
    row = load.suspended(tmp_path, ros_domain)
    assert row.problems == [] and row.figures["cycles"] > 4000


@pytest.mark.long
def test_floods_of_each_topic_and_service(tmp_path: Path, ros_domain: int) -> None:
    row = load.floods(tmp_path, ros_domain)
    assert row.problems == [] and row.figures["unanswered"] == 0.0
    assert row.figures["messages"] > 3000.0 and row.figures["calls"] > 3000.0


@pytest.mark.long
@pytest.mark.timeout(load.COMING + 120.0)
@pytest.mark.parametrize(
    "condition",
    [
        load.busy_processors,
        *(partial(load.company, what, *numbers) for what, numbers in load.COMPANY_OF.items()),
        load.two_machines,
        partial(load.soak, 0.5),
    ],
    ids=("busy processors", *load.COMPANY_OF, "two machines", "half a minute"),
)
def test_a_condition_that_a_machine_does_not_notice(
    condition: Callable[[Path, int], LoadRow], tmp_path: Path, ros_domain: int
) -> None:
    row = condition(tmp_path, ros_domain)
    assert row.problems == [] and row.figures["cycles"] > 4000.0 and row.figures["lost blocks"] == 0.0


@pytest.mark.long
@pytest.mark.parametrize("condition", [disks.full_disk, disks.slow_disk], ids=lambda each: each.__name__)
def test_a_disk_that_is_full_or_slow(
    condition: Callable[[Path, int], LoadRow], tmp_path: Path, ros_domain: int
) -> None:
    row = condition(tmp_path, ros_domain)
    if row.untried:
        pytest.skip(row.untried)
    assert row.problems == [] and row.figures["cycles"] > 500.0


@pytest.mark.long
def test_a_seed_gives_the_same_faults_of_every_case() -> None:
    first, again, other = (list(zip(range(200), kills.faults(seed), strict=False)) for seed in (5, 5, 6))
    assert first == again != other
    faults = [fault for _, fault in first]
    assert {fault.case for fault in faults} == {case.name for case in CASES}
    assert {fault.signal for fault in faults} == {KILL, TERM, HOLD}
    assert all((fault.hold > 0.0) == (fault.signal == HOLD) and fault.hold <= 10.0 for fault in faults)
