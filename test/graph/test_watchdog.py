"""The watchdog of a node, with instants of our own."""

from __future__ import annotations

import pytest

from cnc_ptp.nodes import watchdog
from cnc_ptp.nodes.process import START_PATIENCE
from cnc_ptp.nodes.watchdog import Watchdog


@pytest.fixture
def clock(monkeypatch):
    """A list whose last number is the time."""
    times = [100.0]
    monkeypatch.setattr(watchdog.time, "monotonic", lambda: times[-1])
    return times


def test_who_is_not_heard_for_longer_than_the_time_is_silent(clock):
    dog = Watchdog(("x", "y"), seconds=0.5)
    clock.append(100.3)
    assert dog.heard("x") and not dog.heard("z")
    clock.append(100.5)
    assert dog.silent(("x", "y"), begun=True) == []
    clock.append(100.51)
    assert dog.silent(("x", "y"), begun=True) == ["y"] and dog.silent(("x",), begun=True) == []
    dog.watch("z")
    clock.append(100.9)
    assert dog.silent(("x", "y", "z"), begun=True) == ["x", "y"]
    dog.restart()
    assert dog.silent(("x", "y", "z"), begun=True) == []


def test_before_the_run_has_begun_they_have_longer(clock):
    dog = Watchdog(("x",), seconds=0.5)
    clock.append(100.0 + START_PATIENCE)
    assert dog.silent(("x",), begun=False) == [] and dog.silent(("x",), begun=True) == ["x"]
    clock.append(100.1 + START_PATIENCE)
    assert dog.silent(("x",), begun=False) == ["x"]


def test_a_process_that_was_suspended_notices_it(clock):
    dog = Watchdog((), seconds=0.5)
    for now, suspended in ((100.1, False), (100.35, False), (100.61, True), (100.7, False)):
        clock.append(now)
        assert dog.was_suspended() is suspended
