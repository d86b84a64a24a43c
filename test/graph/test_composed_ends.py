"""How a composed run ends: what is told of a recorder that has failed, and what becomes of its recording."""

from __future__ import annotations

import signal
from types import SimpleNamespace

import pytest
from machine_support import PTP, ROOT
from mcap.writer import MCAP0_MAGIC
from recording_support import MACHINE, Blocks

from cnc_ptp.errors import CncError
from cnc_ptp.nodes import composed
from cnc_ptp.nodes.supervisor import RunOptions
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.writer import Recording

FULL = "recording run.mcap: cannot be written: No space left on device"


def not_written() -> CncError:
    return CncError(26007, FULL, "its end is missing")


def axis_failed() -> CncError:
    return CncError(26267, "x: its drive has stopped on its own", "the node ends")


@pytest.fixture
def cut(tmp_path):
    """A recording without its end."""
    path = tmp_path / "run.mcap"
    with Recording(path, MACHINE) as recording:
        recording.block("x", Blocks(1).axis(0))
        recording.flush()
        size = path.stat().st_size
    path.write_bytes(path.read_bytes()[:size])
    return path


@pytest.fixture
def run(cut, monkeypatch):
    """Runs without nodes; `raised` ends it, the recorder has `failure` by then."""

    def run(raised: Exception, failure: CncError | None, *, has_begun: bool = True) -> list[str]:
        recorder = SimpleNamespace(failure=failure, has_begun=has_begun)
        clock = SimpleNamespace(done=False, wait_time=None)
        monitor = SimpleNamespace(cycle=10, on_demand="")

        def spin(*_nodes, **_calls):
            raise raised

        for name, made in (("RecorderNode", recorder), ("ClockNode", clock), ("RunMonitor", monitor)):
            monkeypatch.setattr(composed, name, lambda *_words, made=made, **_options: made)
        monkeypatch.setattr(composed, "unit_nodes", lambda *_words, **_options: [])
        monkeypatch.setattr(composed.process, "spin", spin)
        options = RunOptions(str(ROOT / "config" / "ptp.yaml"), record=str(cut))
        return composed._run(PTP, options, lambda monitor: None)[1]

    return run


def test_a_recorder_that_fails_after_another_node_is_told_as_well(run, cut):
    assert run(axis_failed(), not_written()) == [
        "P-ERR-26267 x: its drive has stopped on its own; the node ends; the run ends",
        f"P-ERR-26007 {FULL}; its end is missing",
    ]
    assert "without having been closed" in read_recording(cut).missing
    assert cut.read_bytes().endswith(MCAP0_MAGIC)


def test_one_that_ends_the_run_is_told_once(run):
    failure = not_written()
    assert run(failure, failure) == [f"P-ERR-26007 {FULL}; its end is missing; the run ends"]


def test_the_recording_of_an_earlier_run_stays_as_it_is(run, cut):
    """The recorder has failed before it wrote anything; units have computed the first block."""
    before = cut.read_bytes()
    failure = not_written()
    assert len(run(failure, failure, has_begun=False)) == 1
    assert cut.read_bytes() == before


def test_signals_are_those_of_before_also_after_a_mistake_of_ours(run):
    before = signal.getsignal(signal.SIGINT)
    try:
        with pytest.raises(ZeroDivisionError):
            run(ZeroDivisionError(), None)
        assert signal.getsignal(signal.SIGINT) is before
    finally:
        signal.signal(signal.SIGINT, before)
