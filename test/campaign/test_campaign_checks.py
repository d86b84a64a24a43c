"""The checks of the campaign find what they are to find, in recordings that were made for it."""

import json
import subprocess
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest
from click.testing import CliRunner
from lateness_support import write_lateness
from recording_support import Blocks

from bench.fuzzing.kinds import KINDS
from campaign import __main__ as command
from campaign import disks, kills, load, motion, witness
from campaign.cases import Link
from campaign.conditions import conditions
from campaign.graph import Graph, size_of
from campaign.kills import HOLD, KILL, TERM, Fault, Row
from campaign.load import case_of
from campaign.table import summary, table
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import Event, Severity
from cnc_ptp.recording.node_figures import LATENESS_MAX, LOST_BLOCKS
from cnc_ptp.recording.reader import Diagnostic, DriveStop, Recorded

MACHINE = read_machine(str(Path(__file__).parents[2] / "config" / "gantry.yaml"))
CYCLE = 1e-3
BRAKING = 5000.0
"""mm/s²"""


def ramp(velocity=100.0, cycles=200):
    """Velocities of a stop in the last cycles."""
    return np.maximum(0.0, np.minimum(velocity, BRAKING * CYCLE * np.arange(cycles - 1, -1, -1.0)))


def rows(velocities, first=0):
    names = ("set_position", "set_velocity", "actual_position", "actual_velocity")
    states = np.zeros(len(velocities), dtype=[("cycle", np.uint64), *((name, float) for name in names)])
    states["cycle"] = first + np.arange(len(velocities))
    states["set_velocity"] = states["actual_velocity"] = velocities
    states["set_position"] = states["actual_position"] = np.cumsum(velocities) * CYCLE
    return states


def recorded(x, y=None, stops=()):
    made = Recorded(Path("made"), complete=True)
    made.states = {"/x/state": x, "/y/state": rows(ramp()) if y is None else y}
    made.drive_stops = list(stops)
    return made


def found(made, *, ended=True):
    return list(motion.problems(made, MACHINE, ended=ended))


def test_a_stop_on_a_ramp_is_in_order():
    assert found(recorded(rows(ramp()))) == []


def test_what_still_moves_at_the_end_is_found():
    moving = rows(np.full(100, 50.0))
    assert found(recorded(moving)) == ["x: still moves at the end with 50.000"]
    assert found(recorded(moving), ended=False) == []


def test_a_drive_that_has_braked_on_its_own_goes_on_from_the_last_block():
    moving = rows(np.full(100, 50.0))
    velocities = ramp(50.0, 10)
    positions = moving["actual_position"][-1] + np.cumsum(velocities) * CYCLE
    assert found(recorded(moving, stops=[DriveStop("x", 100, positions, velocities)])) == []
    late = DriveStop("x", 110, positions + 5.0, velocities + 1.0)
    assert found(recorded(moving, stops=[late])) == [
        "x: the drive stops in cycle 110, the last setpoint is of 99",
        "x: its drive still moves at the end",
    ]


def test_a_process_that_was_held_up_may_have_sent_a_block_that_its_drive_has_not_got():
    """Seed 38, number 210: the recorder got it."""
    moving = rows(np.full(110, 50.0))
    velocities = ramp(50.0, 10)
    stop = DriveStop("x", 100, moving["actual_position"][99] + np.cumsum(velocities) * CYCLE, velocities)
    made = recorded(moving, stops=[stop])
    text = "x: the drive stops in cycle 100, the last setpoint is of 109"
    assert found(made) == [text]
    assert list(motion.problems(made, MACHINE, ended=True, stopped_in={"x"})) == []
    two_blocks = recorded(rows(np.full(111, 50.0)), stops=[stop])
    assert "the last setpoint is of 110" in next(motion.problems(two_blocks, MACHINE, ended=True, stopped_in={"x"}))


def test_steps_jumps_and_gaps_are_found():
    step = ramp()
    step[100] = 300.0
    assert [text.partition(" above")[0] for text in found(recorded(rows(step)))] == [
        "x: set acceleration 200000.0",
        "x: actual acceleration 200000.0",
    ]
    jump = rows(ramp())
    jump["actual_position"][50:] += 20.0
    assert found(recorded(jump)) == ["x: its position jumps (20100.0 per second at 49)"]
    gap = rows(ramp())
    assert found(recorded(gap[gap["cycle"] != 30])) == ["x: cycles are missing"]


def test_a_pair_that_comes_apart_is_measured():
    """Two blocks and a cycle of 100 mm/s are 2.1 mm."""
    together, apart = rows(ramp()), rows(ramp())
    assert motion.torn(recorded(together, apart), Link("x", "y", 1.0), MACHINE) == (0.0, pytest.approx(2.1))
    short = together[:150]
    stop = DriveStop("x", 150, np.full(3, short["actual_position"][-1]), np.zeros(3))
    distance, permitted = motion.torn(recorded(short, apart, [stop]), Link("x", "y", 1.0), MACHINE)
    assert distance == pytest.approx(apart["actual_position"][-1] - short["actual_position"][-1])
    assert distance > permitted == pytest.approx(2.1)


def test_of_a_cut_recording_a_pair_is_judged_as_far_as_both_are_recorded():
    """Seed 44, number 185: the killed recorder had written 303 cycles more of one axis than of the other."""
    made = recorded(rows(ramp())[:100], rows(ramp()))
    apart, permitted = motion.torn(made, Link("x", "y", 1.0), MACHINE)
    assert apart > permitted
    made.complete = False
    apart, _ = motion.torn(made, Link("x", "y", 1.0), MACHINE)
    assert apart == 0.0
    for name in ("set_position", "actual_position"):
        made.states["/y/state"][name][90:] += 5.0
    apart, permitted = motion.torn(made, Link("x", "y", 1.0), MACHINE)
    assert apart == pytest.approx(5.0) and apart > permitted


def test_a_drive_that_brakes_on_its_own_does_not_catch_up():
    """Seed 38, number 339: the master makes up for what it was behind, 3 mm here; the drive of the slave does not."""
    stop = DriveStop("y", 200, np.full(3, ramp().sum() * CYCLE), np.zeros(3))
    made = recorded(rows(ramp()), rows(ramp()), [stop])
    made.states["/x/state"]["actual_position"][:150] -= 3.0
    _, permitted = motion.torn(made, Link("x", "y", 1.0), MACHINE)
    assert permitted == pytest.approx(2.1 + 3.0)


def test_units_that_live_may_not_come_apart_either():
    """What they are behind is measured at their own setpoints, not at the distance that is to be judged."""
    made = recorded(rows(ramp()), rows(np.minimum(ramp(), 50.0)))
    distance, permitted = motion.torn(made, Link("x", "y", 1.0), MACHINE)
    assert distance > 8.0 > 6.0 > permitted


MILL = read_machine(str(Path(__file__).parents[2] / "config" / "mill.yaml"))


def tapped(*, late=0):
    """z follows s with 1.25 mm per turn; s brakes from 400 rpm, z some cycles later."""
    states = np.zeros(300, [("cycle", np.uint64), *((name, float) for name in witness.COLUMNS["spindle"])])
    speed = np.full(300, 400.0)
    speed[200:] = np.maximum(0.0, 400.0 - 12.0 * np.arange(100.0))
    states["cycle"] = np.arange(300)
    states["set_speed_rpm"] = states["actual_speed_rpm"] = speed
    states["set_position_deg"] = states["actual_position_deg"] = np.cumsum(speed) * 6.0 * CYCLE
    z = rows(np.roll(speed, late) * -1.25 / 60.0)
    made = Recorded(Path("made"))
    made.states = {"/s/state": states, "/z/state": z}
    return made


def test_an_axis_that_taps_and_its_spindle_are_a_link():
    """400 rpm are 25/3 mm/s, 0.175 mm in 21 cycles; z, which has a jerk, needs more than the 40 deg of s to stop."""
    (link,) = case_of("tapping").links
    apart, permitted = motion.torn(tapped(), link, MILL)
    z, velocity = MILL.axes["z"], 25.0 / 3.0
    stop = 0.5 * velocity**2 / z.deceleration + 0.5 * velocity * z.deceleration / z.jerk
    assert apart < 1e-9 and stop > 40.0 * 1.25 / 360.0
    assert permitted == pytest.approx(0.175 + stop, rel=1e-6)
    assert list(motion.out_of_step(tapped(), [link], MILL)) == []
    apart, permitted = motion.torn(tapped(late=99), link, MILL)
    assert apart > permitted
    (text,) = motion.out_of_step(tapped(late=99), [link], MILL)
    assert text.endswith(" deg out of step with its spindle, 0.010 permitted")


@pytest.mark.parametrize(("error", "told", "permitted"), [(0.02, 300, 0.01), (0.02, 100, None), (51.0, 100, 50.41)])
def test_a_thread_that_leaves_its_spindle_is_found(error, told, permitted):
    """From cycle 200 on; `told`: the cycle of the first event of an error."""
    made = tapped()
    phase = np.zeros(300, [("cycle", np.uint64), ("spindle", np.uint32), ("set_phase_error_deg", float)])
    phase["cycle"], phase["spindle"] = np.arange(300), MILL.spindles["s"].number
    phase["set_phase_error_deg"][:50] = np.nan
    phase["set_phase_error_deg"][200:] = error
    made.threads = {"channel": phase}
    made.events = [Event(told, "x", Severity.ERROR, 26101, "a fault")]
    end = "deg out of step with its spindle"
    texts = [f"thread: {error:.3f} {end}, {permitted:.3f} permitted"] if permitted else []
    assert list(motion.out_of_step(made, (), MILL)) == texts


def test_a_witness_that_has_seen_nothing_is_a_problem(tmp_path):
    made = witness.Witness.__new__(witness.Witness)
    made._file, made._process = tmp_path / "seen.npz", SimpleNamespace(communicate=lambda timeout: None)
    found = sorted(motion.seen_problems(made.seen(), MILL))
    assert found == ["s: nothing", "x: nothing", "y: nothing", "z: nothing"]


def test_a_witness_tells_what_it_has_seen(tmp_path):
    blocks = Blocks(1)
    axis, spindle = (blocks.axis(0), blocks.axis(10)), (blocks.spindle(0),)
    stop = SimpleNamespace(first_cycle=20, actual_position=[1.0, 2.0], actual_velocity=[3.0, 0.0])
    made = witness.Witness.__new__(witness.Witness)
    made._file, made._process = tmp_path / "seen.npz", SimpleNamespace(communicate=lambda timeout: None)
    states = {"x": witness.rows_of("axis", axis), "s": witness.rows_of("spindle", spindle)}
    np.savez(made._file, **states, **{f"{witness.STOP}x": witness.stop_rows(stop)})
    seen = made.seen()
    assert seen.states["/x/state"]["cycle"].tolist() == [*range(20)]
    for unit, name, told in (("x", "actual_position", axis[1]), ("s", "set_speed_rpm", spindle[0])):
        assert np.array_equal(seen.states[f"/{unit}/state"][name][-10:], getattr(told, name), equal_nan=True)
    (stopped,) = seen.drive_stops
    assert (stopped.unit, stopped.first_cycle) == ("x", 20)
    assert (stopped.actual_position.tolist(), stopped.actual_velocity.tolist()) == ([1.0, 2.0], [3.0, 0.0])


def test_blocks_that_were_recorded_after_the_stop_of_a_drive_count_for_nothing():
    """The master's drive has done what its blocks say, and the slave's too: nothing changes."""
    link, stops = Link("x", "y", 1.0), []
    made = recorded(rows(ramp()), rows(ramp()))
    before = motion.torn(made, link, MACHINE)
    for unit in ("x", "y"):
        states = made.states[f"/{unit}/state"]
        stops.append(DriveStop(unit, 100, states["actual_position"][100:190], states["actual_velocity"][100:190]))
    made.drive_stops = stops
    apart, permitted = motion.torn(made, link, MACHINE)
    assert (apart, permitted) == (before[0], pytest.approx(before[1]))


def test_what_a_run_has_told_of_itself(tmp_path):
    """Seed 38, number 217: 3.4 s late, and held up for 4.7 s; number 228: 3.1 s late by itself."""
    graph = Graph.__new__(Graph)
    graph._log = tmp_path / "run.log"
    graph._log.write_text("machine time 7.220 s\nblock lateness p50 2005.8 ms, p99 3125.1 ms, largest 3145.6 ms\n")
    assert graph.summed_up and graph.lateness == pytest.approx(3.1456)
    assert kills.lateness_before(Fault("thread", "clock", KILL, 0.0, 11.0), graph.lateness) == graph.lateness
    assert kills.lateness_before(Fault("program", "channel", HOLD, 4.665, 11.1), 3.39) == 0.0
    graph._log.write_text("machine time 7.220 s\nfailed: P-ERR-26104 node 'x'\n")
    assert not graph.summed_up and graph.lateness == 0.0


def test_the_lateness_of_a_run_whose_supervisor_is_dead(tmp_path):
    """Seed 44, number 354: the recording ended 4.9 s before the moment of the fault, and nobody said how late it was."""
    told = [
        Diagnostic(n, unit, {LATENESS_MAX: text}) for n, (unit, text) in enumerate([("x", "12.5"), ("s", "4903.1")])
    ]
    recorded = replace(Recorded(tmp_path), diagnostics=[*told, Diagnostic(3, "clock", {})])
    assert kills.recorded_lateness(recorded) == pytest.approx(4.9031)
    assert kills.recorded_lateness(Recorded(tmp_path)) == 0.0


def test_shared_memory_that_another_program_takes_away_is_not_left_behind(monkeypatch):
    """Seed 44, numbers 140 and 141: semaphores of process pools of tests that were about to end."""
    graph = Graph.__new__(Graph)
    graph._shared, graph.domain = {"/dev/shm/before"}, 199
    there = [{"/dev/shm/before", "/dev/shm/sem.mp-pool"}, {"/dev/shm/before"}]
    monkeypatch.setattr("campaign.graph.shared_memory", lambda: there.pop(0) if len(there) > 1 else there[0])
    assert graph.leftovers() == []
    there[:] = [{"/dev/shm/fastdds_1"}]
    assert graph.leftovers(0.1) == ["/dev/shm/fastdds_1"]


def test_a_file_that_is_only_asked_for_is_no_start(tmp_path):
    """Seed 38, number 216: the recorder was killed before the first cycle."""
    file = tmp_path / "run.mcap"
    assert size_of(file) == 0
    file.touch()
    assert size_of(file) == 0
    file.write_bytes(b"begun")
    assert size_of(file) == 5


def test_a_master_may_come_to_rest_on_the_ramp_of_its_own_master():
    """Seed 38, number 2: y does so. A ramp from 400 mm/s takes 36 mm, one from 100 mm/s 6 mm: v²/2d + vd/2j."""
    made, link = recorded(rows(ramp(400.0)), rows(ramp(100.0))), Link("y", "x", 0.5)
    _, alone = motion.torn(made, link, MACHINE)
    _, led = motion.torn(made, link, MACHINE, above=Link("x", "y", 4.0))
    assert led - alone == pytest.approx(abs(0.5 * 4.0 * 36.0 - 36.0) - abs(0.5 * 6.0 - 36.0))


def test_a_retract_that_did_not_take_place_is_found():
    made = recorded(rows(ramp()))
    text = (
        "channel channel: no block of 's' came within the watchdog time; axis X retracts by 5 mm while the path follows"
    )
    made.events = [Event(100, "channel", Severity.ERROR, 26101, f"{text} spindle s")]
    way = made.states["/x/state"]["set_position"][-1] - made.states["/x/state"]["set_position"][100]
    assert list(kills.not_retracted(made)) == [f"X has retracted by {way:.3f} mm instead of 5 mm"]
    made.states["/x/state"]["set_position"][101:] = made.states["/x/state"]["set_position"][100] + 5.0
    assert list(kills.not_retracted(made)) == []


def thread_recording(lost=300, begin=100, z_end=150.0):
    """A thread is cut from cycle `begin` on; spindle and z have come to cycle `lost`."""
    made = tapped()
    for name in ("/s/state", "/z/state"):
        made.states[name] = made.states[name][:lost]
    made.states["/z/state"]["set_position"][-1] = z_end
    phase = np.zeros(300, [("cycle", np.uint64), ("set_phase_error_deg", float)])
    phase["cycle"] = np.arange(300)
    phase["set_phase_error_deg"][:begin] = np.nan
    made.threads = {"channel": phase}
    return made


@pytest.mark.parametrize(
    ("node", "signal", "made", "silent"),
    [
        ("s", KILL, thread_recording(), True),
        ("z", KILL, thread_recording(200), True),
        ("z", KILL, thread_recording(115, begin=100), False),
        ("z", KILL, thread_recording(z_end=20.5), False),
        ("x", KILL, thread_recording(), False),
        ("s", TERM, thread_recording(), False),
    ],
)
def test_a_thread_that_was_cut_is_broken_off_by_a_retract(node, signal, made, silent):
    fault = Fault("thread", node, signal, 0.0, 3.0)
    cycle = len(made.states["/z/state"])
    text = f"nobody says that the tool leaves the thread that it cut in cycle {cycle}"
    assert list(kills.silent_retract(fault, made, MILL)) == ([text] if silent else [])
    assert list(kills.silent_retract(replace(fault, case="tapping"), made, MILL)) == []
    told = "no block of 's' came within the watchdog time; axis X retracts by 5 mm while the path follows spindle s"
    made.events = [Event(300, "channel", Severity.ERROR, 26101, told)]
    assert list(kills.silent_retract(fault, made, MILL)) == []


class Blamed:
    """A run that has stopped and has said this."""

    processes: ClassVar[dict] = {"x": SimpleNamespace(pid=7)}
    process = SimpleNamespace(returncode=1)

    def __init__(self, output):
        self.output = output

    def orphans(self):
        return []

    leftovers = orphans


@pytest.mark.parametrize(
    ("node", "signal", "output", "named"),
    [
        ("supervisor", HOLD, "machine time 3 s", False),
        ("supervisor", HOLD, "P-ERR-26101 x: silent", True),
        ("supervisor", TERM, "machine time 3 s", False),
        ("x", KILL, "P-ERR-26104 node 'y' (process 8)", False),
        ("x", KILL, "P-ERR-26104 node 'x' (process 7)", True),
    ],
)
def test_a_run_that_has_stopped_says_who_is_to_blame(node, signal, output, named):
    found = list(kills.left_behind(Blamed(output), Fault("ptp", node, signal, 0.0, 1.0), "stopped"))
    assert found == ([] if named else [f"nobody names {node}: {output}"])


def test_a_killed_supervisor_names_nobody():
    graph = Blamed("")
    graph.process = SimpleNamespace(returncode=-9)
    assert list(kills.left_behind(graph, Fault("ptp", "supervisor", KILL, 0.0, 1.0), "stopped")) == []


class Begun:
    """A run with processes of some names."""

    running, output = True, "begun"

    def __init__(self, *names, starts=True):
        self.processes = dict.fromkeys(names)
        self._starts = starts

    def __call__(self, *_, **__):
        return self

    def wait_for_start(self):
        return self._starts

    def end(self):
        pass


@pytest.mark.parametrize(
    ("graph", "problem"),
    [
        (Begun(starts=False), "the run did not start: begun"),
        (Begun("supervisor", "y"), "there is no process of x, but of supervisor, y"),
        (Begun("supervisor", "x"), "not looked at to the end: AttributeError(\"'NoneType' object has no attribute 'send_signal'\")"),
    ],
)  # fmt: skip
def test_a_fault_that_cannot_be_looked_at_is_a_row(monkeypatch, tmp_path, graph, problem):
    monkeypatch.setattr(kills, "Graph", graph)
    found = kills.run(Fault("ptp", "x", KILL, 0.0, 0.01), tmp_path, domain=199)
    assert (found.outcome, found.problems) == ("", [problem])


def row(signal, outcome, *problems):
    return Row(Fault("ptp", "x", signal, 0.0, 1.0), outcome, [*problems], own_stops={"x": 20})


def test_the_table_counts_what_happened():
    made = [row(KILL, "stopped"), row(KILL, "stopped", "orphans: x"), row(HOLD, "survived"), row(TERM, "over")]
    assert summary(made) == ("3 faults (1 came after the end of their run): 2 stops, 1 runs that continued, 1 problems")
    made_too = [row(KILL, "does not end", "the run had not ended"), row(KILL, "", "the run did not start")]
    assert summary([*made, *made_too]) == (
        "4 faults (1 came after the end of their run): 2 stops, 1 runs that continued, 1 runs that did not end, "
        "1 runs in which there was no fault, 3 problems"
    )
    cells = [list(column.cells) for column in table(made).columns]
    assert cells == [["ptp"], ["1 / 2"], ["0 / 0"], ["1 / 1"], ["3"], ["0.0"]]
    assert made[0].as_json()["good"] and not made[1].as_json()["good"]


def test_in_a_short_soak_only_handles_and_threads_count():
    samples = [
        {"x": (memory, handles, 3)} for memory, handles in ((50.0, 9), (60.0, 10), (60.2, 10), (60.4, 10), (62.0, 10))
    ]
    row = load.LoadRow("soak")
    load.grown(row, samples)
    assert row.problems == [] and row.figures == {"x: MB more": pytest.approx(2.0)}
    load.grown(row, [{"x": (60.0, 10, 3)}, {"x": (60.0, 11, 4)}])
    assert row.problems == ["x has 1 more file handles, 1 more threads"]


def test_a_unit_that_has_died_before_its_first_block_is_torn_from_nobody():
    """Seed 38, number 31 of `python -m campaign`."""
    row, made = Row(Fault("coupled", "x", KILL, 0.0, 0.1)), recorded(rows(ramp()))
    del made.states["/x/state"]
    kills.check_links(row, case_of("coupled"), made)
    assert (row.torn, row.problems) == ({}, [])


class Ended:
    """A graph that ends by itself after its `wait` was asked so often, with this status and these texts."""

    def __init__(self, status, *, waits=0, summed_up=True, output="machine time 3 s"):
        self.process = SimpleNamespace(returncode=status)
        self.output = output
        self.summed_up = summed_up
        self._waits = waits

    def wait(self, _seconds):
        self._waits -= 1
        return self._waits < 0

    def interrupt(self):
        pass


@pytest.mark.parametrize(
    ("name", "node", "graph", "outcome"),
    [
        (TERM, "recorder", Ended(0), "over"),
        (TERM, "recorder", Ended(1), "stopped"),
        (TERM, "x", Ended(0), "stopped"),
        (HOLD, "x", Ended(0), "over"),
        (HOLD, "x", Ended(1), "stopped"),
        (HOLD, "x", Ended(130, waits=1), "survived"),
        (HOLD, "x", Ended(-2, waits=1), "over"),
        (HOLD, "x", Ended(0, waits=1), "over"),
        (HOLD, "x", Ended(0, waits=1, output="P-ERR-26106 interrupted"), "survived"),
        (HOLD, "x", Ended(-2, waits=1, summed_up=False), "survived"),
        (HOLD, "x", Ended(0, waits=2), "does not end"),
        (KILL, "x", Ended(0, waits=1), "does not end"),
    ],
)
def test_what_became_of_a_run(name, node, graph, outcome):
    assert kills.await_end(graph, Fault("ptp", node, name, 0.1, 1.0)) == outcome


class MadeGraph:
    """A run that has come to its end, with a recording that was made."""

    running, output = True, "all is well"

    def __init__(self, folder, left=()):
        self.recording, self.left = folder / "run.mcap", [*left]

    def interrupt(self):
        self.running = False

    def wait(self, _seconds):
        return True

    def orphans(self):
        return self.left


def finished_row(monkeypatch, tmp_path, made, left=()):
    monkeypatch.setattr(load, "read_recording", lambda _path: made)
    monkeypatch.setattr(load, "checked_motion", lambda *_: [])
    row = load.LoadRow("made")
    load.finished(row, MadeGraph(tmp_path, left), "program")
    return row


def test_lost_blocks_errors_and_orphans_are_problems_of_a_load(monkeypatch, tmp_path):
    made = recorded(rows(ramp()))
    node = SimpleNamespace(name="x", values={LOST_BLOCKS: "3", LATENESS_MAX: "12.5"})
    made.diagnostics = [SimpleNamespace(name="x", values={LOST_BLOCKS: "1"}), node]
    made.events = [
        Event(5, "x", Severity.ERROR, 23055, "the pair came apart"),
        Event(6, "supervisor", Severity.ERROR, 26106, "interrupted"),
        Event(7, "y", Severity.WARNING, 26119, "nothing bad"),
    ]
    row = finished_row(monkeypatch, tmp_path, made, left=["y"])
    assert row.problems == ["orphans: ['y']", "the pair came apart", "3 blocks were lost"]
    assert (row.figures["lost blocks"], row.figures["largest lateness [ms]"]) == (3, 12.5)


def test_what_a_soak_may_grow_by():
    row, still = load.LoadRow("soak"), (50.0, 10, 4)
    first_five_minutes = [{"x": (10.0 + n, 4, 4), "y": still, "z": still} for n in range(60)]
    samples = [{"x": (50.0 + 0.3 * n, 10, 4), "y": still, "z": still} for n in range(8)]
    samples[-1]["y"] = (50.9, 11, 5)
    load.grown(row, first_five_minutes + samples)
    assert row.problems == ["x has grown by 2.10 MB", "y has 1 more file handles, 1 more threads"]
    assert row.figures == {"x: MB more": 2.1, "y: MB more": 0.9, "z: MB more": 0.0}


def test_a_soak_without_a_sample_says_so():
    row = load.LoadRow("soak")
    load.grown(row, [])
    assert row.problems == ["no process was looked at"]


@pytest.mark.parametrize(
    ("first", "last", "problems"),
    [
        (2.0, 9.0, []),
        (6.0, 12.0, []),
        (2.0, 15.0, ["p99 of the lateness has grown from 2.1 to 15.1 ms"]),
        (80.0, 2.0, []),
    ],
)
@pytest.mark.motion_unchecked("messages of one topic, of no machine")
def test_the_lateness_of_a_soak_may_not_grow(tmp_path, first, last, problems):
    """Nodes tell what was since their start: that of the last quarter is not hidden by the rest."""
    late = [first] * 4 + [1.0] * 8 + [last] * 4
    write_lateness(tmp_path / "run.mcap", [{"x": 1000.0 * each, "y": 500.0} for each in late])
    row = load.LoadRow("soak")
    load.later(row, tmp_path / "run.mcap", judged=False)
    assert row.problems == []
    load.later(row, tmp_path / "run.mcap")
    assert row.problems == problems
    assert row.figures == {
        "p99 of the first quarter [ms]": pytest.approx(first + 0.1),
        "p99 of the last quarter [ms]": pytest.approx(last + 0.1),
    }


@pytest.mark.motion_unchecked("messages of one topic, of no machine")
def test_a_soak_in_which_nobody_tells_its_lateness(tmp_path):
    write_lateness(tmp_path / "run.mcap", [])
    row = load.LoadRow("soak")
    load.later(row, tmp_path / "run.mcap")
    assert (row.figures, row.problems) == ({}, ["no node has told its lateness"])


def test_a_disk_that_cannot_be_mounted_is_neither_good_nor_bad():
    @load.condition("slow disk")
    def none(_row):
        raise load.NotTriedError("mount -t: only root can do that")

    row = none()
    assert (row.name, row.good) == ("slow disk", None)
    assert row.as_json()["untried"] == "mount -t: only root can do that"


FAILURES = [
    RuntimeError("the run did not start: …"),
    subprocess.TimeoutExpired("python", 120),
    CncError(26003, "recording run.mcap: corrupt", "nothing was read"),
    PermissionError(1, "clock_settime"),
]


@pytest.mark.parametrize("error", FAILURES, ids=repr)
def test_a_condition_that_fails_is_a_row_and_the_next_one_comes(monkeypatch, tmp_path, error):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(load, "started", fail)
    monkeypatch.setattr(load, "Graph", fail)
    monkeypatch.setattr(disks, "mounted", fail)
    monkeypatch.setattr(disks, "call", lambda *_: None)
    rows = [*conditions(tmp_path, minutes=1.0, sets_clock=True)]
    assert len({row.name for row in rows}) == 13
    assert all(each.problems == [f"not looked at to the end: {error!r}"] and each.good is False for each in rows)


def test_an_error_does_not_lose_what_was_found_before_it():
    @load.condition("made")
    def made(row, text):
        row.problems.append(text)
        raise OSError("gone")

    assert made("x: still moves").problems == ["x: still moves", "not looked at to the end: OSError('gone')"]


def test_a_motion_that_cannot_be_checked_is_a_problem(monkeypatch, tmp_path):
    def refuse(_path):
        raise CncError(number, "recording run.mcap: refused", "no motion was checked")

    monkeypatch.setattr(motion, "check_recording", refuse)
    number = motion.NO_SETPOINTS
    assert motion.violations(tmp_path) == []
    number = 26264
    text = "the motion cannot be checked: P-ERR-26264 recording run.mcap: refused; no motion was checked"
    assert motion.violations(tmp_path) == [text]


@pytest.mark.parametrize("good", [True, False])
def test_all_parts_are_run_and_their_rows_written(good, monkeypatch, tmp_path):
    row = Row(Fault("program", "y", KILL, 0.0, 1.0), "stopped", problems=[] if good else ["x: still moves"])
    monkeypatch.setattr(kills, "campaign", lambda *_, **__: iter([row]))
    tried = [load.LoadRow("busy", {"cycles": 1.0}), load.LoadRow("slow disk", untried="no root")]
    monkeypatch.setattr(command, "conditions", lambda *_, **__: iter(tried))
    kinds = {"users": KINDS["users"]}
    monkeypatch.setattr(command, "KINDS", kinds)
    file = tmp_path / "rows.jsonl"
    result = CliRunner().invoke(command.main, ["--minutes", "0.001", "--json", str(file), "--keep", str(tmp_path)])
    assert result.exit_code == int(not good), result.output
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    assert all(line["date"][:2] == "20" and "processors" in line["machine"] for line in lines)
    assert [line.get("seed") for line in lines] == [1, None, None, 1, 1]
    names = [line.get("name", "fault") for line in lines]
    assert names == ["fault", "busy", "slow disk", "random commands", "inputs: users"]
    assert [line["good"] for line in lines] == [good, True, None, True, True]
    assert "slow disk: not tried, no root" in result.output
    assert "busy: cycles 1" in result.output and "random commands: " in result.output


def test_a_part_can_be_chosen(tmp_path):
    result = CliRunner().invoke(command.main, ["commands", "--minutes", "0.001", "--seed", "3"])
    assert result.exit_code == 0, result.output
    assert "; 0 with a violation" in result.output and "faults" not in result.output
