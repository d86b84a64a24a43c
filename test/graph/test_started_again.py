"""A start that does not come about is given up; the nodes are started again, and the run is as if there had been one."""

import os
import signal
import time

import pytest
from graph_support import alive, one_axis_machine, states_equal, verified

from cnc_ptp.commands.run.run import print_summary
from cnc_ptp.nodes import forked, supervisor
from cnc_ptp.nodes.supervisor import RunOptions, Supervisor
from cnc_ptp.parameters import read_machine
from cnc_ptp.recording.reader import read_recording

NOBODY = "nobody"
"""A node that does not exist: a clock that waits for it never begins."""
SOON = 1.5
"""Seconds instead of 20; nodes come one soon after the other."""
SCENARIO = "- {at: 0.0, to: x, do: move_absolute, target: 20.0}\n"


def again(timeout, next_try, absent="none"):
    return (
        f"warning: P-WARN-26146 the nodes did not find each other within {timeout:g} s (not there: {absent}); "
        f"they are started again ({next_try} of 3)"
    )


class Runs:
    """Runs of one axis whose first starts do not come about."""

    def __init__(self, folder, monkeypatch):
        self.machine = str(one_axis_machine(folder))
        self.started = []
        self.failing = 0
        (folder / "move.yaml").write_text(SCENARIO)
        self.scenario = str(folder / "move.yaml")
        start_node, observers_of = supervisor.start_node, supervisor.observers_of
        tries = iter(range(100))

        def noting(*arguments):
            self.started.append(start_node(*arguments))
            return self.started[-1]

        def waiting(options):
            return [*observers_of(options), *([NOBODY] if next(tries) < self.failing else [])]

        monkeypatch.setattr(supervisor, "start_node", noting)
        monkeypatch.setattr(supervisor, "observers_of", waiting)

    def run(self, *, failing, record=None):
        """The monitor and the failures of a run of which so many starts fail."""
        self.failing = failing
        options = RunOptions(self.machine, scenario=self.scenario, record=record)
        run = Supervisor(read_machine(self.machine), options, show=lambda monitor: None)
        monitor = run.run()
        assert not any(alive(process.pid) for process in self.started), "no orphan"
        return monitor, run.failures


@pytest.fixture
def runs(tmp_path, monkeypatch):
    return Runs(tmp_path, monkeypatch)


def test_the_second_start_is_as_the_first_would_have_been(runs, tmp_path, monkeypatch, capfd):
    (tmp_path / "again").mkdir(), (tmp_path / "once").mkdir()
    again_file, once_file = tmp_path / "again" / "run.mcap", tmp_path / "once" / "run.mcap"
    once, failures = runs.run(failing=0, record=str(once_file))
    assert failures == [] and [*once.notes] == []
    monkeypatch.setattr(supervisor, "START_TIMEOUTS", (SOON, 20.0, 60.0))
    runs.started.clear()
    monitor, failures = runs.run(failing=2, record=str(again_file))
    assert failures == [] and not monitor.run_failed
    assert len(runs.started) == 2 * 4 and monitor.cycle == once.cycle
    assert [str(note) for note in monitor.notes] == [again(SOON, 2)]
    print_summary(read_machine(runs.machine), monitor, failures)
    assert again(SOON, 2) in capfd.readouterr().out
    verified(again_file)
    assert states_equal(once_file, again_file) == []
    first, second = read_recording(once_file), read_recording(again_file)
    assert [event.text for event in second.events] == [event.text for event in first.events]
    assert len(second.commands) == len(first.commands)
    assert sorted(path.name for path in again_file.parent.iterdir()) == ["metadata.yaml", "run.mcap"]


def test_after_the_last_try_the_run_ends(runs, tmp_path, monkeypatch):
    monkeypatch.setattr(supervisor, "START_TIMEOUTS", (SOON, SOON, 4.0 * SOON))
    monitor, failures = runs.run(failing=100, record=str(tmp_path / "run.mcap"))
    assert failures == [
        f"P-ERR-26105 the nodes did not find each other within {4.0 * SOON:g} s (not there: none); the run ends"
    ]
    assert [str(note) for note in monitor.notes] == [again(SOON, 2), again(SOON, 3)]
    assert len(runs.started) == 3 * 4 and monitor.cycle == 0
    assert not (tmp_path / "run.mcap").exists(), "nothing was recorded before the first tick"


def test_nodes_that_are_still_to_come_have_the_time_of_the_last_try(runs, monkeypatch):
    """Here none ever comes."""

    def sleeper(*_):
        process = forked.CONTEXT.Process(target=time.sleep, args=(600.0,))
        with forked.without_main_module():
            process.start()
        runs.started.append(process)
        return process

    monkeypatch.setattr(supervisor, "start_node", sleeper)
    monkeypatch.setattr(supervisor, "START_TIMEOUTS", (20.0, 20.0, 0.25))
    began = time.monotonic()
    monitor, failures = runs.run(failing=0)
    absent = "x, plc, clock"
    assert failures == [
        f"P-ERR-26105 the nodes did not find each other within 0.25 s (not there: {absent}); the run ends"
    ]
    assert [str(note) for note in monitor.notes] == [again(0.25, 2, absent), again(0.25, 3, absent)]
    assert time.monotonic() - began < 20.0


@pytest.mark.parametrize("moment", ["while the first nodes end", "while the nodes start again"])
def test_an_interrupt_ends_everything(runs, monkeypatch, moment):
    monkeypatch.setattr(supervisor, "START_TIMEOUTS", (SOON, 20.0, 60.0))
    end_all, start_all = Supervisor._end_all, Supervisor._start_all

    def ending(self):
        if moment == "while the first nodes end":
            os.kill(os.getpid(), signal.SIGINT)
        end_all(self)

    def starting(self):
        if runs.started and moment == "while the nodes start again":
            os.kill(os.getpid(), signal.SIGINT)
        start_all(self)

    monkeypatch.setattr(Supervisor, "_end_all", ending)
    monkeypatch.setattr(Supervisor, "_start_all", starting)
    monitor, failures = runs.run(failing=2)
    assert failures == ["P-ERR-26106 the run was interrupted (SIGINT); nothing has moved yet"]
    assert [str(note) for note in monitor.notes] == [again(SOON, 2)]
    assert len(runs.started) == (3 if moment == "while the first nodes end" else 6) and monitor.cycle == 0
