"""A PLC in a file in the graph: equal to the offline run; a PLC that raises or takes too long stops the machine."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from graph_support import MILL, PTP, run, states_equal, verified
from long_support import long, long_but

from cnc_ptp.recording.reader import read_recording

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
JOBS = {
    "tool changer": (
        MILL, "--plc", EXAMPLES / "plc_tool_changer.py", "--program", EXAMPLES / "plc_tool_changer.nc",
        "--scenario", EXAMPLES / "plc_tool_changer.yaml",
    ),
    "generator": (PTP, "--plc", EXAMPLES / "plc_setpoint_generator.py"),
    "homing": (PTP, "--plc", EXAMPLES / "plc_homing.py"),
    "homing by the drive": (EXAMPLES / "sercos.yaml", "--plc", EXAMPLES / "plc_sercos_homing.py"),
    "axis": (PTP, "--plc", EXAMPLES / "plc_move_axis.py"),
}  # fmt: skip

MOVES = """
from cnc_ptp.plc.plcopen import MC_GearIn, MC_GearOut, MC_MoveAbsolute, MC_MoveRelative, MC_Stop


class Plc:
    def __init__(self, io):
        x, y = io.axis("x"), io.axis("y")
        self.gear, self.out, self.move = MC_GearIn(y), MC_GearOut(y), MC_MoveAbsolute(x)
        self.stop, self.back = MC_Stop(x), MC_MoveRelative(x)

    def cycle(self, io):
        self.gear(True, master="x", ratio_numerator=-1, ratio_denominator=2)
        self.move(self.gear.in_gear or self.move.execute, position=500.0, velocity=700.0)
        self.stop(0.4 < io.time < 1.1)
        self.back(io.time > 1.2, distance=-io.axis("x").actual_position)
        self.out(self.back.done)
        io.done(self.out.done)
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Recordings of the jobs offline, and what `simulate` has printed."""
    folder = tmp_path_factory.mktemp("plc")
    (folder / "moves.py").write_text(MOVES)
    for name, job in {**JOBS, "moves": (PTP, "--plc", folder / "moves.py")}.items():
        told = run("simulate", *job, "--record", folder / f"{name}.mcap").stdout
        (folder / f"{name}.txt").write_text(told)
    return folder


@pytest.mark.parametrize("options", [*long([[]]), ["--free-run"], *long([["--composed"]])], ids=str)
@pytest.mark.parametrize("name", long_but([*JOBS, "moves"], ["tool changer", "axis"]))
def test_a_plc_in_the_graph_equals_the_offline_run(folder, name, options):
    job = {**JOBS, "moves": (PTP, "--plc", folder / "moves.py")}[name]
    recording = folder / "graph.mcap"
    output = run("run", *job, *options, "--record", recording).stdout
    assert "lost 0, computed twice 0" in output and "refused" not in output
    assert states_equal(folder / f"{name}.mcap", recording) == []
    verified(recording)
    events = [
        [(event.cycle, event.text) for event in read_recording(path).events if event.source == "plc"]
        for path in (folder / f"{name}.mcap", recording)
    ]
    assert events[0] == events[1]
    messages = messages_in(output)
    assert messages == messages_in((folder / f"{name}.txt").read_text())
    assert ("message: plc plc: the door is open" in messages) == (name == "tool changer")


def messages_in(output):
    return [line for line in output.splitlines() if line.startswith("message: ")]


TRIGGERS = {
    "plc_setpoint_generator.py": ("x.set_position > 100", lambda x: x["set_position"][:10].max() > 100.0, 200),
    "plc_move_axis.py": ("x.set_velocity != 0", lambda x: x["set_velocity"][:10].any(), 0),
}
"""PLC file -> condition, whether it holds in the first block, cycle before which it cannot (TX1250 4.3: the start)."""


@pytest.mark.parametrize("options", [[], *long([["--composed"]])], ids=str)
@pytest.mark.parametrize("name", long_but(TRIGGERS, ["plc_move_axis.py"]))
def test_a_recording_with_a_trigger_begins_with_the_same_block(folder, name, options):
    condition, holds, before = TRIGGERS[name]
    job = (PTP, "--plc", EXAMPLES / name, "--record-when", condition)
    run("simulate", *job, "--record", folder / "a.mcap")
    run("run", *job, "--free-run", *options, "--record", folder / "b.mcap")
    assert states_equal(folder / "a.mcap", folder / "b.mcap") == []
    states = verified(folder / "b.mcap").states
    assert {int(rows["cycle"][0]) for rows in states.values()} == {int(states["/x/state"]["cycle"][0])}
    assert holds(states["/x/state"]) and states["/x/state"]["cycle"][0] > before


FAULT = """
from cnc_ptp.plc.plcopen import MC_MoveAbsolute


class Plc:
    def __init__(self, io):
        self.moves = [MC_MoveAbsolute(io.axis(name)) for name in ("x", "y")]

    def cycle(self, io):
        for move in self.moves:
            move(True, position=1000.0, velocity=300.0)
        if io.cycle == 600:
            {fault}
"""
FAULTS = {
    "raise ValueError('no tool')": (22161, "ValueError: no tool"),
    "while True: pass": (22162, "the PLC cycle takes longer than 200 ms (P-MACH watchdog_ms)"),
    "__import__('time').sleep(3.0)": (22162, "the PLC cycle takes longer than 200 ms (P-MACH watchdog_ms)"),
}


@pytest.mark.parametrize("options", [[], *long([["--composed"]])], ids=str)
@pytest.mark.parametrize("fault", FAULTS)
def test_a_plc_that_fails_stops_the_machine_on_its_ramps(tmp_path, fault, options):
    file, recording = tmp_path / "plc.py", tmp_path / "run.mcap"
    file.write_text(FAULT.format(fault=fault))
    output = run("run", PTP, "--plc", file, *options, "--record", recording, expect=1)
    recorded = verified(recording)
    (error,) = [event for event in recorded.events if event.severity == 2]
    assert (error.cycle, error.line) == (600, 13)
    number, reason = FAULTS[fault]
    assert error.error_id == number
    assert error.text == (f"plc plc: plc.py:13 '{fault}': {reason}; everything is stopped and the run ends")
    assert error.text in output.stderr
    x, y = (recorded.states[f"/{axis}/state"] for axis in ("x", "y"))
    assert x["set_velocity"][-1] == 0.0 and np.array_equal(x["set_position"], y["set_position"])
    assert x["set_position"][-1] < 1000.0 and not x["error_id"].any()


SWALLOWED = """
import time

from cnc_ptp.plc.plcopen import MC_MoveAbsolute


class Plc:
    def __init__(self, io):
        self.move = MC_MoveAbsolute(io.axis("x"))

    def cycle(self, io):
        self.move(True, position=1000.0, velocity=300.0)
        end = time.monotonic() + {seconds}
        while io.cycle == 600 and time.monotonic() < end:
            try:
                time.sleep(0.01)
            except BaseException:
                pass
"""


@pytest.mark.parametrize(("seconds", "others"), [(0.35, 0), pytest.param(4.0, 26101, marks=pytest.mark.long)])
def test_a_plc_that_catches_the_end_of_its_cycle_is_a_fault(tmp_path, seconds, others):
    """After 2 s without a block the axes have stopped on their own; the run ends nevertheless."""
    file, recording = tmp_path / "plc.py", tmp_path / "run.mcap"
    file.write_text(SWALLOWED.format(seconds=seconds))
    output = run("run", PTP, "--plc", file, "--record", recording, expect=1)
    recorded = verified(recording, whole=not others)  # axes that have lost the PLC end on their own
    (error,) = [event for event in recorded.events if event.error_id == 22162]
    assert error.cycle == 600 and error.line in range(14, 18)
    assert "the PLC cycle takes longer than 200 ms (P-MACH watchdog_ms); everything is stopped" in error.text
    assert error.text in output.stderr
    x = recorded.states["/x/state"]
    assert x["set_velocity"][-1] == 0.0 and x["set_position"][-1] < 1000.0 and x["error_id"][-1] == others


BEHIND = """
import time

from cnc_ptp.plc.plcopen import MC_MoveAbsolute


class Plc:
    def __init__(self, io):
        self.move = MC_MoveAbsolute(io.axis("x"))

    def cycle(self, io):
        self.move(True, position=1000.0, velocity=300.0)
        if 600 <= io.cycle < 900:
            time.sleep(0.05)
        io.done(self.move.done)
"""


@pytest.mark.long
def test_a_plc_whose_cycles_keep_taking_too_long_stops_the_machine(tmp_path):
    """40 ms behind with each cycle: the sixth one is above 200 ms at the latest. In a free run it only takes longer."""
    file, recording = tmp_path / "plc.py", tmp_path / "run.mcap"
    file.write_text(BEHIND)
    output = run("run", PTP, "--plc", file, "--record", recording, expect=1)
    recorded = verified(recording)
    (error,) = [event for event in recorded.events if event.severity == 2]
    assert 600 < error.cycle <= 650
    reason = "its cycles keep taking longer than the 10 ms of a block, it is more than 200 ms behind"
    effect = "everything is stopped and the run ends"
    assert (error.error_id, error.text) == (22163, f"plc plc: plc.py: {reason} (P-MACH watchdog_ms); {effect}")
    assert error.text in output.stderr
    x = recorded.states["/x/state"]
    assert x["set_velocity"][-1] == 0.0 and x["set_position"][-1] < 1000.0 and not x["error_id"].any()
    run("run", PTP, "--plc", file, "--free-run", expect=0)


def test_a_plc_that_cannot_be_broken_off_is_a_silent_one(tmp_path):
    """It holds the interpreter itself: no signal is handled, no heartbeat sent."""
    file = tmp_path / "plc.py"
    hang = "sum(range(200_000_000))"  # seconds in C, which no signal ends
    file.write_text(FAULT.format(fault=hang))
    output = run("run", PTP, "--plc", file, expect=1)
    assert "P-ERR-26101 axis x: no block of 'plc' came within the watchdog time" in output.stderr


def test_a_file_that_cannot_be_used_starts_no_node(tmp_path):
    file = tmp_path / "plc.py"
    file.write_text(
        "class Plc:\n    def __init__(self, io):\n        io.axis('q')\n    def cycle(self, io):\n        pass\n"
    )
    output = run("run", PTP, "--plc", file, expect=2)
    assert "P-ERR-25104 PLC file" in output.stderr and "the machine has no axis 'q'" in output.stderr
