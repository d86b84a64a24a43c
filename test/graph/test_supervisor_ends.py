"""How the supervisor ends a run: the stop reaches the PLC, and a recording that is not whole is no success."""

from __future__ import annotations

import signal
from types import SimpleNamespace

import pytest

from cnc_ptp.nodes.process import FAILED, SIGNALLED
from cnc_ptp.nodes.supervisor import Supervisor
from cnc_ptp.nodes.topics import RECORDER


def supervisor(**attributes) -> Supervisor:
    """Without processes."""
    made = Supervisor.__new__(Supervisor)
    made._dead, made.failures, made._stop_is_due = set(), [], False
    made._monitor = SimpleNamespace(
        cycle=1000, on_demand="", take_polled=lambda: None, watch_standstill=lambda units: None
    )
    made._show = lambda monitor: None
    for name, value in attributes.items():
        setattr(made, name, value)
    return made


def test_a_stop_is_given_when_the_service_of_the_plc_is_found() -> None:
    """It may be sought still when Ctrl-C comes with the first cycles; a request would be lost."""
    found, given = [False], []
    client = SimpleNamespace(service_is_ready=lambda: found[0], call_async=given.append)
    run = supervisor(_stop_all=client, _machine=SimpleNamespace(watchdog_ms=50), _moving_units=["x"])
    run._stop_everything()
    run._look()
    assert given == []
    found[0] = True
    for _ in range(3):
        run._look()
    assert len(given) == 1


def test_a_dead_plc_is_not_told() -> None:
    given = []
    client = SimpleNamespace(service_is_ready=lambda: True, call_async=given.append)
    run = supervisor(_stop_all=client, _machine=SimpleNamespace(watchdog_ms=50), _moving_units=["x"])
    run._dead = {"plc"}
    run._stop_everything()
    run._look()
    assert given == []


@pytest.mark.parametrize(
    ("status", "how"),
    [(0, ""), (SIGNALLED + signal.SIGTERM, ""), (FAILED, "ended with exit status 1"), (-9, "was ended by SIGKILL")],
)
def test_a_recorder_that_does_not_end_well_is_a_failure(status: int, how: str) -> None:
    recorder = SimpleNamespace(exitcode=status, pid=77)
    run = supervisor(_processes={RECORDER: recorder}, _options=SimpleNamespace(record=None))
    run._close_recordings()
    end = "at the end of the run; its recording goes as far as it was written"
    assert run.failures == ([f"P-ERR-26104 node 'recorder' (process 77) {how} {end}"] if how else [])


def test_one_that_has_died_during_the_run_is_told_once() -> None:
    recorder = SimpleNamespace(exitcode=-9, pid=77)
    run = supervisor(_processes={RECORDER: recorder}, _options=SimpleNamespace(record=None), _dead={RECORDER})
    run._close_recordings()
    assert run.failures == []
