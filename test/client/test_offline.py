"""The client with an offline machine: time passes only in waits, and what it records replays to the bit."""

from __future__ import annotations

import asyncio
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from math import inf, nan
from pathlib import Path

import numpy as np
import pytest
from client_stories import BLOCKS_EXPECTED, EXPECTED, block_story, refusal, story
from graph_support import verified
from machine_support import ROOT

from cnc_ptp.client import (
    AxisStateCode,
    ChannelStateCode,
    CncError,
    Event,
    JobStatus,
    Machine,
    MC_GearIn,
    MC_MoveAbsolute,
    MC_MoveVelocity,
    MC_Power,
    MC_Stop,
    UnknownUnit,
)
from cnc_ptp.recording.reader import read_recording

MILL = ROOT / "config" / "mill.yaml"
PTP = ROOT / "config" / "ptp.yaml"


@pytest.fixture
def m():
    with Machine.offline(MILL) as machine:
        yield machine


@pytest.fixture
def ptp():
    with Machine.offline(PTP) as machine:
        yield machine


def test_the_story_is_recorded_and_replays_to_the_bit(tmp_path: Path) -> None:
    with Machine.offline(MILL, record=tmp_path / "a.mcap") as m:
        assert story(m, tmp_path) == EXPECTED
    recorded = verified(tmp_path / "a.mcap")
    assert recorded.complete and recorded.states["/x/state"]["set_velocity"][-1] == 0.0
    refused = next(record for record in recorded.commands if record.command == "move_absolute" and record.error_id)
    assert refused.values == {"target": 100000.0, "limit": 300.0} and refused.job == 0
    assert [record.job for record in recorded.commands if record.command == "start" and record.target == "s"] == [1]


def test_function_blocks_in_plc_cycles_replay_to_the_bit(tmp_path: Path) -> None:
    with Machine.offline(MILL, record=tmp_path / "a.mcap") as m:
        assert block_story(m) == BLOCKS_EXPECTED
    verified(tmp_path / "a.mcap")


def test_plc_cycles_are_the_blocks(m: Machine) -> None:
    assert [*m.plc_cycles(duration=0.03)] == [10, 20, 30] and m.cycle == 40
    for cycle in m.plc_cycles():
        if cycle == 60:
            break
    assert m.cycle == 60

    async def three() -> list[int]:
        return [cycle async for cycle in m.plc_cycles(0.03)]

    assert asyncio.run(three()) == [60, 70, 80]
    number, text, _ = refusal(lambda: [*m.plc_cycles()])
    assert (number, text) == (
        26174,
        "plc_cycles: no end: nothing has moved for 10 s of machine time, and nothing will; it ends",
    )


def test_a_function_block_of_a_unit_that_does_not_have_its_command(m: Machine) -> None:
    move = MC_MoveAbsolute(m.s)
    for _ in m.plc_cycles(0.02):
        move(True, position=1.0)
    assert move.error and move.error_id == 22002
    assert move.error_text.startswith(
        "spindle s: unknown command 'move_absolute'; it is a command of axes; nothing was changed. Known: couple, "
    )


@pytest.mark.parametrize("inputs", [{}, {"master": None}, {"master": 5}])
def test_a_coupling_without_a_master(m: Machine, inputs: dict[str, object]) -> None:
    gear = MC_GearIn(m.x)
    for _ in m.plc_cycles(0.02):
        gear(True, **inputs)
    assert (gear.error, gear.busy, gear.error_id) == (True, False, 22001)
    assert gear.error_text == "axis x: MC_GearIn refused: master is not given; nothing was changed"


def nested(levels: int) -> list[object]:
    value: list[object] = []
    for _ in range(levels):
        value = [value]
    return value


def test_inputs_of_function_blocks_that_are_no_numbers(m: Machine) -> None:
    """bench.fuzz function-block seed 420 numbers 21499, 25969 and 57237."""
    turn, gear, move = MC_MoveVelocity(m.s), MC_GearIn(m.x), MC_MoveVelocity(m.y)
    for _ in m.plc_cycles(0.02):
        turn(True, velocity="fast")
        gear(True, master=m.y, ratio_numerator=None)
        move(True, velocity=1.0, buffer_mode=nested(5000))
    assert turn.error_text == "spindle s: start refused: speed_rpm = 'fast' is not a number; nothing was changed"
    assert (
        gear.error_text
        == "axis x: MC_GearIn refused: ratio_numerator = None is not a finite number; nothing was changed"
    )
    assert move.error_id == 22001 and move.error


def test_numbers_of_numpy_are_numbers(m: Machine) -> None:
    m.x.move_absolute(np.int64(10), velocity=np.float32(50.0)).wait()
    assert m.x.state.set_position == 10.0
    m.follow(["x", "y"], [(np.float64(1.0), np.array([15.0, 5.0]), np.array([0.0, 0.0]))]).wait()
    assert (m.x.state.set_position, m.y.state.set_position) == (15.0, 5.0)
    assert m.x.power(np.bool_(True)).warning == "axis x: power is on already"


def test_resets_may_follow_the_release_of_an_emergency_stop(m: Machine) -> None:
    move = m.x.move_absolute(100)
    m.run_for(0.3)
    m.plc.emergency_stop(True)
    m.run_for(1.0)
    assert refusal(m.x.reset)[0] == 26169 and move.status is JobStatus.FAILED
    m.plc.emergency_stop(False)
    m.x.reset()
    m.run_for(0.01)
    assert m.x.state.error_id == 0


def test_no_time_passes_in_a_plc_cycle_that_releases_an_emergency_stop(m: Machine) -> None:
    m.plc.emergency_stop(True)
    cycles = []
    for cycle in m.plc_cycles(0.03):
        m.plc.emergency_stop(False)
        cycles.append((cycle, m.cycle))
    assert cycles == [(10, 10), (20, 20), (30, 30)]


@pytest.mark.parametrize("make", [MC_MoveAbsolute, MC_Power])
def test_the_plc_is_no_unit_of_a_function_block(m: Machine, make: Callable[[object], object]) -> None:
    number, text, _ = refusal(lambda: make(m.plc))
    assert number == 22001 and text.startswith(f"{make.__name__}: unit = <plc plc> is no axis, spindle or channel")


def test_a_job_whose_end_is_not_seen_is_an_error_of_its_block(m: Machine) -> None:
    move = MC_MoveAbsolute(m.x)
    for cycle in m.plc_cycles():
        move(True, position=50.0)
        if cycle >= 50:
            break
    seen = m._session.link.seen
    seen.take_block("x", replace(seen.blocks["x"], first_cycle=5000, job=0, job_events=[]))
    move(True)
    assert (move.error, move.error_id) == (True, 26175)


def test_no_function_block_after_the_end() -> None:
    with Machine.offline(MILL) as m:
        move = MC_MoveAbsolute(m.x)
    number, text, _ = refusal(lambda: move(True, position=1.0))
    assert (number, text) == (26172, "axis x: move_absolute: the machine was closed; nothing was sent")


def test_two_runs_are_equal_to_the_bit(tmp_path: Path) -> None:
    files = []
    for _ in range(2):
        with Machine.offline(MILL, record=tmp_path / "a.mcap") as m:
            m.x.move_absolute(30).wait()
            m.s.start(300)
            m.run_for(0.5)
        files.append((tmp_path / "a.mcap").read_bytes())
    assert files[0] == files[1]


def test_time_passes_only_while_the_program_waits(m: Machine) -> None:
    assert (m.cycle, m.time, m.cycle_time) == (10, 0.01, 0.001)
    job = m.x.move_absolute(10)
    assert (m.cycle, job.cycle, job.status, job.done) == (10, 10, None, False)
    m.run_for(0.005)
    assert (m.cycle, job.status) == (20, JobStatus.ACTIVE)
    m.run_for(1.0)
    assert (m.cycle, job.status, job.done, job.ended) == (1020, JobStatus.DONE, True, True)
    assert repr(job) == "<job 1 of x: move_absolute, done>"


def test_states_are_those_of_the_recording(tmp_path: Path) -> None:
    with Machine.offline(PTP, record=tmp_path / "a.mcap") as m:
        m.c.move_modulo(-450.0)
        states = [*m.c.states(duration=0.3)]
        channel = m["c"].state
    rows = read_recording(tmp_path / "a.mcap").states["/c/state"]
    assert [state.cycle for state in states] == [*range(10, 310)] and channel == states[-1]
    for state in states:
        row = rows[rows["cycle"] == state.cycle][0]
        assert state._asdict() == {name: row[name] for name in state._fields}
    assert {state.set_direction for state in states} == {0, -1}
    assert states[-1].set_position_modulo != states[-1].set_position


def test_states_of_spindle_and_channel(m: Machine, tmp_path: Path) -> None:
    m.s.start(300, direction="ccw").wait()
    state = m.s.state
    assert state.set_speed_rpm == -300.0 and state.speed_reached is True and state.gear == 1
    assert m.channel.state.state is ChannelStateCode.IDLE and m.channel.state.override_percent == 100.0
    assert m.x.state.state is AxisStateCode.STANDSTILL
    assert [state.cycle for state in m.channels["channel"].states(0.02)] == [*range(m.cycle - 20, m.cycle)]


def test_a_refusal_has_number_text_and_values(m: Machine) -> None:
    number, text, values = refusal(lambda: m.x.move_absolute(20, velocity=501.0))
    assert number == 23004 and values["limit"] == 500.0
    assert text == (
        "axis x: move_absolute refused: velocity 501.0 mm/s is above the maximum 500.0 mm/s (P-AXIS-00212); "
        "nothing was changed"
    )


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda m: m.x.move_absolute("far"), "22001 axis x: move_absolute refused: target = 'far' is not a number; nothing was changed"),
        (lambda m: m.x.move_absolute(float("nan")), "22001 axis x: move_absolute refused: target = nan is not finite; nothing was changed"),
        (lambda m: m.x.move_absolute(1, velocity=0), "22001 axis x: move_absolute refused: velocity = 0 must be greater than 0; nothing was sent"),
        (lambda m: m.plc.acknowledge(-1), "22001 plc plc: acknowledge refused: id = -1 is not within 0 ... 18446744073709551615; nothing was sent"),
        (lambda m: m.x.set_override_type(258), "22001 axis x: set_override_type refused: type = 258 is not within 0 ... 255; nothing was sent"),
        (lambda m: m.s.start(100, direction="up"), "22001 spindle s: start refused: direction = 'up' is not cw or ccw; nothing was changed"),
        (lambda m: m.y.couple_cam(master="x"), "22001 axis y: couple_cam refused: argument 'table' is missing; nothing was changed"),
        (
            lambda m: m.y.couple_cam("x", [[0, 0], [1, 1, 1]]),
            "22001 axis y: couple_cam refused: point 2 of the table, [1, 1, 1], is no pair of numbers (master, slave); nothing was sent",
        ),
        (
            lambda m: m.y.couple_cam(file="/nowhere.csv", master="x"),
            "26110 cam file /nowhere.csv cannot be read: No such file or directory; nothing was started",
        ),
        (
            lambda m: m.x.external_setpoints([[0, 0.0, 0.0, 0.0, 2]]),
            "22001 axis x: external_setpoints refused: setpoint of cycle 0: direction = 2 is not one of -1, 0, 1; nothing was changed",
        ),
        (lambda m: m.plc.acknowledge(7), "22013 plc plc: acknowledge refused: no request 7 waits; nothing was changed. Waiting: none"),
        (lambda m: m.xx, "26111 the machine has no unit 'xx'; did you mean x?; nothing was sent. Known: plc, channel, s, x, y, z"),
        (lambda m: m["q"], "26111 the machine has no unit 'q'; nothing was sent. Known: plc, channel, s, x, y, z"),
        (lambda m: m.axes["s"], "26111 the machine has no axis 's'; nothing was sent. Known: x, y, z"),
    ],
)  # fmt: skip
def test_what_cannot_be_asked(m: Machine, call, text: str) -> None:
    number, message, _ = refusal(lambda: call(m))
    assert f"{number} {message}" == text
    assert m.cycle == 10


def test_an_unknown_unit_is_what_python_expects(ptp: Machine) -> None:
    assert not hasattr(ptp, "q") and not hasattr(ptp, "_repr_html_")
    with pytest.raises(KeyError):
        ptp["q"]
    with pytest.raises(UnknownUnit, match="the machine has no unit 'channel'"):
        ptp.channel  # noqa: B018
    assert {"x", "y", "plc", "run_for"} <= {*dir(ptp)}


def test_a_wait_has_a_timeout_of_machine_time(m: Machine) -> None:
    job = m.x.move_absolute(100, velocity=10)
    number, text, _ = refusal(lambda: job.wait(0.5))
    assert (number, text) == (26170, "axis x: move_absolute is not done after 0.5 s of machine time; it continues")
    assert m.cycle == 510 and job.status is JobStatus.ACTIVE
    job.wait()


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda m: m.run_for(inf), "run_for refused: seconds = inf is not finite; no time has passed"),
        (
            lambda m: m.run_for(10**400),
            "run_for refused: seconds = 100000000000000000...0000000000000000000 is not finite; no time has passed",
        ),
        (lambda m: m.run_for(nan), "run_for refused: seconds = nan is not finite; no time has passed"),
        (
            lambda m: m.wait_until(lambda: False, timeout=nan),
            "wait_until refused: timeout = nan is not a number; no time has passed",
        ),
        (lambda m: m.run_for(-1), "run_for refused: seconds = -1 is below 0; no time has passed"),
        (
            lambda m: m.x.move_absolute(100).wait(timeout=nan),
            "axis x: move_absolute: wait refused: timeout = nan is not a number; it continues",
        ),
        (lambda m: m.run_for("a"), "run_for refused: seconds = 'a' is not a number; no time has passed"),
        (lambda m: m.wait_until("now"), "wait_until refused: condition = 'now' is no function; no time has passed"),
        (
            lambda m: m.plc.on_handshake("yes"),
            "plc: on_handshake refused: callback = 'yes' is no function; nothing was changed",
        ),
        (
            lambda m: MC_MoveAbsolute("x"),
            "MC_MoveAbsolute: unit = 'x' is no axis, spindle or channel of a machine; nothing was made",
        ),
        (
            lambda m: MC_Power(None),
            "MC_Power: unit = None is no axis, spindle or channel of a machine; nothing was made",
        ),
        (lambda m: m.x.states(nan), "stream refused: duration = nan is not a number; nothing was read"),
        (lambda m: m.events(nan), "stream refused: duration = nan is not a number; nothing was read"),
        (
            lambda m: Machine.start("none.yaml", timeout=inf),
            "start refused: timeout = inf is not finite; nothing was started",
        ),
        (
            lambda m: Machine.connect(timeout=nan),
            "connect refused: timeout = nan is not finite; no machine was looked for",
        ),
    ],
)
def test_what_a_client_gets_wrong_is_refused_before_anything_happens(
    m: Machine, call: Callable[[Machine], object], text: str
) -> None:
    before = m.cycle
    assert refusal(lambda: call(m))[:2] == (22001, text)
    assert m.cycle == before


def test_waits_without_an_end_may_be_written_as_infinite(m: Machine) -> None:
    assert m.x.move_absolute(1).wait(timeout=inf).done
    m.wait_until(lambda: m.x.state.set_position == 1.0, timeout=inf)


def test_what_a_client_gets_wrong_is_refused_before_anything_happens_in_an_event_loop(m: Machine) -> None:
    with pytest.raises(CncError, match="timeout = nan is not a number"):
        asyncio.run(m.wait_until_async(lambda: False, timeout=nan))
    with pytest.raises(CncError, match="seconds = inf is not finite"):
        asyncio.run(m.run_for_async(inf))


def test_a_job_that_another_one_replaces_is_aborted(m: Machine) -> None:
    job = m.x.move_absolute(100)
    m.run_for(0.1)
    new = m.x.new_target(50)
    assert refusal(job.wait)[:2] == (
        26173,
        "axis x: move_absolute was aborted at cycle 110; another command, or a loss of power, has ended it",
    )
    assert new.wait() is new and m.x.state.set_position == 50.0


def test_a_job_that_fails_raises_the_fault_of_its_unit(m: Machine, tmp_path: Path) -> None:
    job = m.channel.run("part.nc", text="N10 G1 X10 F6000\nN20 G1 X=V.A.ACT_POS.X*100\nM30\n")
    with pytest.raises(CncError, match="line 2 ") as failed:
        job.wait()
    assert failed.value.number == m.channel.state.error_id > 0 and job.status is JobStatus.FAILED


def test_a_wait_without_a_timeout_ends_where_nothing_will_move(m: Machine) -> None:
    m.x.set_override(0)
    job = m.x.move_absolute(100)
    assert refusal(job.wait)[:2] == (
        26174,
        "axis x: move_absolute is not done: nothing has moved for 10 s of machine time, and nothing will; it continues",
    )
    m.x.set_override(100)
    job.wait()
    program = m.channel.run("part.nc", text="G1 Y1 F6000\nM0\nG1 Y2\nM30\n")
    assert refusal(program.wait)[1] == (
        "channel channel: start is not done: nothing has moved for 10 s of machine time (channel channel waits in line 2 "
        "for start), and nothing will; it continues"
    )
    assert m.channel.start().number == program.number
    assert program.wait().done and (program.progress, program.time_left) == (1.0, 0.0)


def test_a_program_tells_where_it_is(m: Machine) -> None:
    job = m.channel.run("part.nc", text="N10 G1 X100 F6000\nM30\n")
    m.run_for(0.5)
    assert job.line == 1 and 0.3 < job.progress < 0.6 and job.time_left == pytest.approx(0.54, abs=0.1)
    assert job.cancel().wait().done and job.status is JobStatus.ABORTED
    m.x.move_absolute(0).wait()


def test_endless_jobs_are_waited_for_until_they_do_what_was_commanded(ptp: Machine) -> None:
    jog = ptp.x.jog(100).wait()
    assert ptp.x.state.set_velocity == 100.0 and jog.reached and not jog.ended
    saw = ptp.y.couple_flying_saw("x", 1.0, 400.0, 100.0).wait()
    assert ptp.y.state.set_position == pytest.approx(100.0 + ptp.x.state.set_position - 400.0, abs=1e-9)
    assert saw.reached and ptp.y.state.set_velocity == pytest.approx(100.0)
    ptp.x.jog(0).wait()
    assert jog.status is JobStatus.ABORTED and not jog.reached
    assert ptp.x.jog(0).wait().done
    leaves = ptp.y.decouple().wait()
    assert leaves.ended


def test_external_setpoints_as_a_series(ptp: Machine, tmp_path: Path) -> None:
    series = [[cycle, 1e-5 * cycle * cycle, 0.02 * cycle, 20.0, 1] for cycle in range(1, 101)]
    series.append([101, 0.1, 0.0, 0.0, 0])
    ptp.x.external_enable("relative").wait()
    begin = ptp.cycle
    ptp.x.external_setpoints(series)
    states = {state.cycle - begin: state for state in ptp.x.states(0.2)}
    assert states[50].set_position == pytest.approx(0.025) and states[101].set_position == pytest.approx(0.1)
    ptp.x.external_disable().wait()


def test_tables_are_points_or_files(ptp: Machine, tmp_path: Path) -> None:
    points = [[0, 0], [50, 10], [100, 0]]
    (tmp_path / "cam.csv").write_text("master,slave\n0,0\n50,10\n100,0\n")
    ptp.y.couple_cam("x", points).wait()
    ptp.x.move_absolute(50).wait()
    assert ptp.y.state.set_position == pytest.approx(10.0)
    ptp.y.change_cam(file=str(tmp_path / "cam.csv"))
    ptp.x.move_absolute(250).wait()
    assert ptp.y.state.set_position == pytest.approx(10.0)


def test_events_come_as_they_happen(m: Machine) -> None:
    events = m.events(duration=1.0)
    m.x.move_absolute(10)
    assert [event.text for event in events] == ["x: Standstill -> DiscreteMotion", "x: DiscreteMotion -> Standstill"]
    m.y.move_absolute(10)
    first = next(iter(m.events()))
    assert (first.source, first.cycle) == ("y", m.cycle - 10)


def test_an_iterator_without_an_end_ends_where_nothing_will_come(m: Machine) -> None:
    assert refusal(lambda: [*m.events()])[:2] == (
        26174,
        "no new event: nothing has moved for 10 s of machine time, and nothing will; it continues",
    )


def test_handshakes_by_hand(m: Machine) -> None:
    waiting = []
    m.plc.on_handshake(waiting.append)
    job = m.channel.run("part.nc", text="M8\nG1 X10 F6000\nM30\n")
    m.run_for(1.0)
    (request,) = waiting
    assert (request.kind, request.number, request.acknowledge_needed, job.ended) == ("M", 8, True, False)
    m.plc.acknowledge(request.id)
    job.wait()
    m.plc.on_handshake(None)
    m.channel.run("part.nc", text="M8\nM30\n").wait()
    assert len(waiting) == 1


def test_a_callback_that_raises_ends_the_wait(m: Machine) -> None:
    def broken(request):
        raise ValueError("no coolant")

    m.plc.on_handshake(broken)
    with pytest.raises(ValueError, match="no coolant"):
        m.channel.run("part.nc", text="M8\nM30\n").wait()


def test_the_end_stops_everything_on_its_ramps(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), Machine.offline(MILL, record=tmp_path / "a.mcap") as m:
        m.x.move_absolute(250, velocity=100)
        m.s.start(600)
        m.run_for(0.5)
        1 / 0  # noqa: B018
    rows = verified(tmp_path / "a.mcap").states
    assert rows["/x/state"]["set_velocity"][-1] == 0.0 and rows["/s/state"]["set_speed_rpm"][-1] == 0.0
    assert 0.0 < rows["/x/state"]["set_position"][-1] < 250.0
    assert abs(rows["/x/state"]["set_jerk"]).max() <= 50_000.0


def test_nothing_works_after_the_end() -> None:
    with Machine.offline(MILL) as m:
        job = m.x.move_absolute(10)
    assert refusal(job.wait)[0] == 26173
    for call in (m.x.halt, lambda: m.run_for(1.0), lambda: [*m.events(1.0)]):
        assert refusal(call)[0] == 26172
    assert refusal(m.x.halt)[:2] == (26172, "axis x: halt: the machine was closed; nothing was sent")
    m.close()
    assert repr(m).endswith("closed>")


def test_a_run_that_the_plc_has_ended_is_over(m: Machine) -> None:
    m.x.move_absolute(100)
    m.plc.stop_all()
    assert refusal(lambda: m.run_for(10.0))[:2] == (26171, "the machine has ended: its run has ended; its units stand")
    assert refusal(m.x.halt)[:2] == (26115, "axis x: halt refused: the run has ended; nothing was changed")


def test_the_recording_must_not_be_an_input(tmp_path: Path) -> None:
    machine = tmp_path / "mill.yaml"
    machine.write_text(MILL.read_text())
    text = f"recording {machine} would overwrite the machine file {machine}; nothing was started"
    assert refusal(lambda: Machine.offline(machine, record=machine))[:2] == (26117, text)


def test_several_wait_in_an_event_loop(m: Machine) -> None:
    async def motion(axis, targets):
        return [((await axis.move_absolute(target)).number, m.cycle) for target in targets]

    async def watch():
        return [state.cycle async for state in m.x.states(0.1)]

    async def all_of_it():
        moves = asyncio.gather(motion(m.x, [50, 0]), motion(m.y, [10, 20, 30]))
        states = await watch()
        await m.run_for_async(0.1)
        await m.wait_until_async(lambda: m.y.state.set_position > 25.0, timeout=10.0)
        results = await moves
        with pytest.raises(CncError, match="26170"):
            await m.x.move_absolute(50).wait_async(0.05)
        return results, states

    (x, y), states = asyncio.run(all_of_it())
    assert states == [*range(10, 110)]
    assert [number for number, _ in y] == [1, 2, 3] and x[0][1] < x[1][1]


def test_motions_in_an_event_loop_are_those_of_one_after_the_other() -> None:
    async def both(m):
        await asyncio.gather(*(axis.move_absolute(50) for axis in (m.x, m.y)))

    with Machine.offline(MILL) as m:
        asyncio.run(both(m))
        together = m.cycle
    with Machine.offline(MILL) as m:
        jobs = [m.x.move_absolute(50), m.y.move_absolute(50)]
        for job in jobs:
            job.wait()
        assert m.cycle == together


def test_a_signal_acts_between_two_blocks(m: Machine, request: pytest.FixtureRequest) -> None:
    """Ctrl-C in a long wait; the machine is whole, and can go on."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # other tests of this process may leave theirs
    request.addfinalizer(lambda: signal.signal(signal.SIGINT, before))
    job = m.x.move_absolute(300, velocity=0.05)
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        job.wait()
    blocks = {block.first_cycle for block in m._session.link.seen.blocks.values()}
    assert len(blocks) == 1 and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    job.cancel().wait()


def test_offline_loads_no_ros() -> None:
    code = (
        "import sys; from cnc_ptp.client import Machine\n"
        f"with Machine.offline({str(MILL)!r}) as m: m.x.move_absolute(1).wait()\n"
        "assert not any(name.split('.')[0] in ('rclpy', 'asyncio_') for name in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=240)


def test_time_is_that_of_the_machine(m: Machine) -> None:
    begin = time.monotonic()
    m.run_for(2.0)
    assert m.time == pytest.approx(2.01) and time.monotonic() - begin < 300.0


# ---------------------------------------------------------------- trajectories, MC_Stop


TOGETHER = [(0.5, [20.0, -10.0], [0.0, 0.0])]


def test_a_trajectory_is_one_job(ptp: Machine) -> None:
    job = ptp.follow([ptp.x, "y"], TOGETHER)
    assert (job.status, job.ended, job.reached, repr(job)) == (
        None,
        False,
        False,
        "<follow_trajectory of x, y: not begun>",
    )
    asyncio.run(job.wait_async(10.0))
    assert repr(job) == "<follow_trajectory of x, y: done>" and {*job.jobs} == {"x", "y"} and job.done
    assert (ptp.x.state.set_position, ptp.y.state.set_position) == (20.0, -10.0)
    assert refusal(lambda: job.wait(nan))[1] == (
        "plc plc: follow_trajectory: wait refused: timeout = nan is not a number; it continues"
    )


def test_a_trajectory_is_halted_as_a_whole(ptp: Machine) -> None:
    job = ptp.follow(["x", "y"], [(5.0, [200.0, 100.0], [0.0, 0.0])])
    ptp.run_for(1.0)
    halt = job.cancel()
    assert repr(halt) == "<halt of x, y: active>" and halt.cancel() is halt and not halt.reached
    halt.wait(5.0)
    assert halt.done and job.status is JobStatus.ABORTED and 0.0 < ptp.y.state.set_position < 100.0
    ptp.follow(["y", "x"], [(1.0, [0.0, 0.0], [0.0, 0.0])]).wait(10.0)


def test_what_goes_wrong_on_the_way_is_what_a_trajectory_raises(ptp: Machine) -> None:
    """An emergency stop of y: x was stopped for it, and the error of y counts."""
    job = ptp.follow(["x", "y"], [(5.0, [200.0, 100.0], [0.0, 0.0])])
    ptp.run_for(1.0)
    ptp.plc.emergency_stop(True)
    number, text, _ = refusal(lambda: job.wait(10.0))
    assert (number, text) == (26168, "axis x: emergency stop; the axis stops on its emergency ramp (ErrorStop)")


def test_a_trajectory_whose_answer_is_not_seen(ptp: Machine) -> None:
    seen = ptp._session.link.seen
    seen.take_record = lambda record: None  # type: ignore[method-assign]
    job = ptp.follow(["x", "y"], TOGETHER)
    ptp.run_for(0.1)
    seen._gaps["y"] = job.cycle + 10
    assert refusal(lambda: job.wait(1.0))[:2] == (
        26175,
        "axis y: follow_trajectory was answered in blocks that this client has not got; how it has ended is not known",
    )


def test_a_machine_that_is_closed_lets_go_what_mc_stop_holds(tmp_path: Path) -> None:
    with Machine.offline(PTP, record=tmp_path / "a.mcap") as m:
        stop = MC_Stop(m.x)
        for _ in m.plc_cycles():
            stop(True)
            if stop.done:
                break
    given = [(record.command, record.arguments_json) for record in verified(tmp_path / "a.mcap").commands]
    assert [each for each in given if each[0] == "hold_stop"] == [
        ("hold_stop", '{"enabled": true}'),
        ("hold_stop", '{"enabled": false}'),
    ]


PLC_OF_Y = """
from cnc_ptp.plc.plcopen import MC_MoveAbsolute


class Plc:
    def __init__(self, io):
        self.move = MC_MoveAbsolute(io.axis("y"))

    def cycle(self, io):
        self.move(io.axis("x").actual_position > 20.0, position=30.0)
"""


def test_a_plc_in_a_file_and_a_scenario_beside_the_client(tmp_path: Path) -> None:
    """The PLC reacts to what the client moves; the scenario gives the override; the recording has them and replays."""
    plc, scenario, path = tmp_path / "plc.py", tmp_path / "scenario.yaml", tmp_path / "a.mcap"
    plc.write_text(PLC_OF_Y)
    scenario.write_text("- {at: 0.05, to: x, do: set_override, percent: 50}\n")
    with Machine.offline(PTP, record=path, scenario=scenario, plc=plc) as m:
        m.x.move_absolute(40.0).wait()
        m.wait_until(lambda: m.y.state.set_position == 30.0, timeout=10.0)
        assert m.x.state.override_percent == 50.0
    recorded = verified(path)
    assert recorded.attachments["plc/plc.py"] == PLC_OF_Y and "set_override" in recorded.attachments["scenario.yaml"]
    assert {(each.target, each.command) for each in recorded.commands} >= {
        ("x", "set_override"),
        ("x", "move_absolute"),
        ("y", "move_absolute"),
    }


def test_a_plc_or_a_scenario_that_cannot_be_used_starts_nothing(tmp_path: Path) -> None:
    missing = tmp_path / "none"
    text = f"PLC file {missing} cannot be read: No such file or directory; nothing was started"
    assert refusal(lambda: Machine.offline(PTP, plc=missing))[:2] == (26110, text)
    assert refusal(lambda: Machine.start(PTP, plc=missing))[:2] == (26110, text)
    wrong = tmp_path / "plc.py"
    wrong.write_text("x = 1\n")
    assert refusal(lambda: Machine.offline(PTP, plc=wrong))[0] == 25104
    text = f"scenario {missing} cannot be read: No such file or directory; nothing was started"
    assert refusal(lambda: Machine.offline(PTP, scenario=missing))[:2] == (26110, text)
    assert refusal(lambda: Machine.offline(PTP, record=wrong, plc=wrong))[0] == 26117


def test_a_plc_in_a_file_that_fails_stops_the_machine_of_the_client(tmp_path: Path) -> None:
    plc = tmp_path / "plc.py"
    plc.write_text(
        "class Plc:\n    def cycle(self, io):\n        if io.time > 0.5:\n            raise ValueError('no tool')\n"
    )
    with Machine.offline(PTP, plc=plc) as m:
        told: list[Event] = []
        events, job = m.events(), m.x.move_absolute(2000.0)
        with pytest.raises(CncError):
            job.wait()
        with pytest.raises(CncError, match="the machine has ended: its run has ended; its units stand"):
            told.extend(iter(events))
        assert m.x.state.set_velocity == 0.0
        assert 500.0 < m.x.state.set_position < 1500.0
        assert 22161 in [event.error_id for event in told]
