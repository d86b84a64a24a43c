"""What a client does with a machine, offline and in the graph alike; and what its recording must have in common."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cnc_ptp.client import (
    CncError,
    JobStatus,
    Machine,
    MC_GearIn,
    MC_GearOut,
    MC_Halt,
    MC_MoveAbsolute,
    MC_MoveRelative,
    MC_MoveVelocity,
    MC_OrientSpindle,
    MC_Power,
    MC_ReadParameter,
    MC_Stop,
    MC_WriteParameter,
)
from cnc_ptp.recording.reader import Recorded, read_recording

PART = "%part\nN10 G90 G17 G54\nN20 G0 X10 Y5\nN30 G1 X40 F6000\nN40 M8\nN50 G2 X50 Y15 I0 J10\nN60 M9\nN70 M30\n"
REFUSED = (
    120002,
    "axis x: move_absolute refused: target 100000.0 mm lies beyond the positive soft limit 300.0 mm (P-AXIS-00178); "
    "nothing was changed",
    {"target": 100000.0, "limit": 300.0},
)


REFUSED_TRAJECTORY = (
    120002,
    "axis x: begin_trajectory refused: position 400 mm at 30 s is beyond the positive soft limit 300.0 mm (P-AXIS-00178); "
    "nothing was changed",
)


def refusal(call) -> tuple[int, str, dict]:
    """Number, text and values of what a call raises."""
    try:
        call()
    except CncError as error:
        return error.number, error.message, dict(error.values)
    raise AssertionError("nothing was raised")


def story(m: Machine, folder: Path) -> list[object]:
    """Motions, a spindle, a program with handshakes, a coupling, refusals; what the program has seen of them."""
    seen: list[object] = []
    m.x.power(True)
    m.x.move_absolute(100).wait(30)
    seen.append(m.x.state.set_position)
    job = m.y.move_relative(60, velocity=40)
    m.wait_until(lambda: m.y.state.set_velocity >= 40.0, timeout=30)
    job.cancel().wait(30)
    seen += [job.status, refusal(lambda: job.wait(1))[0], m.y.state.set_velocity]
    m.y.move_absolute(0).wait(30)
    m.x.move_absolute(20.0).wait(30)
    turning = m.s.start(600).wait(30)
    seen += [turning.status, turning.reached, m.s.state.set_speed_rpm]
    m.s.stop().wait(30)
    requests = []

    def acknowledged(request) -> bool:
        requests.append((request.kind, request.number, request.line))
        return True

    m.plc.on_handshake(acknowledged)
    (folder / "part.nc").write_text(PART)
    job = m.channel.run(str(folder / "part.nc")).wait(60)
    m.plc.on_handshake(None)
    seen += [requests, job.done, job.progress, m.x.state.set_position, m.y.state.set_position]
    m.channel.run("sent.nc", text="L sub.nc\nM30\n", files={"sub.nc": "G1 X45 F3000\nM17\n"}).wait(60)
    m.channel.mdi("G1 Y0 F6000").wait(30)
    seen += [m.x.state.set_position, m.y.state.set_position]
    m.y.couple("x", 0.5).wait(30)
    m.x.move_relative(-20).wait(30)
    m.y.decouple()
    seen.append(m.y.state.set_position)
    there = [m.x.state.set_position, m.y.state.set_position]
    together = m.follow([m.x, "y"], [(0.5, [p + 10.0 for p in there], [0.0, 0.0])], path_tolerance=[50, 50]).wait(30)
    seen += [together.status, [*together.jobs], m.x.state.set_position - there[0], m.y.state.set_position - there[1]]
    together = m.follow(["y", "x"], [(5.0, [*reversed(there)], [0.0, 0.0])])
    m.wait_until(lambda: together.status is JobStatus.ACTIVE and m.x.state.set_velocity < -1.0, timeout=30)
    seen.append(together.cancel().wait(30).status)
    seen += [together.status, refusal(lambda: together.wait(1))[0]]
    seen.append(refusal(lambda: m.follow(["x", "y"], [(30.0, [400.0, 0.0], [0.0, 0.0])]).wait(30))[:2])
    seen.append(refusal(lambda: m.follow(["x", "q"], [(1.0, [0.0, 0.0])]))[0])
    resting = m.x.move_velocity(30).wait(30)
    seen += [m.x.state.set_velocity, m.x.move_velocity(0, buffer_mode="aborting").wait(30).reached, resting.status]
    m.x.halt().wait(30)
    seen.append(refusal(lambda: m.x.move_absolute(1e5)))
    seen.append(refusal(lambda: m.y.couple("x", 0.0)))
    seen.append(refusal(lambda: m.channel.load(str(folder / "none.nc")))[0])
    seen.append(refusal(lambda: m.s.set_limits()))
    seen.append(refusal(lambda: m.plc.acknowledge(-1)))
    return seen


EXPECTED = [
    100.0, JobStatus.ABORTED, 26173, 0.0,
    JobStatus.ACTIVE, True, 600.0,
    [("M", 8, 5), ("M", 9, 7)], True, 1.0, 50.0, 15.0,
    45.0, 0.0,
    -10.0,
    JobStatus.DONE, ["x", "y"], 10.0, 10.0,
    JobStatus.DONE, JobStatus.ABORTED, 26173,
    REFUSED_TRAJECTORY,
    23064,
    30.0, True, JobStatus.ABORTED,
    REFUSED,
    (23043, "axis y: couple refused: factor = 0 must be different from 0; nothing was changed", {"argument": "factor", "value": 0.0}),
    26110,
    (22001, "spindle s: set_limits refused: nothing is given; reset_limits takes the limits away; nothing was changed", {}),
    (22001, "plc plc: acknowledge refused: id = -1 is not within 0 ... 18446744073709551615; nothing was sent", {}),
]  # fmt: skip


def block_story(m: Machine) -> list[object]:
    """Function blocks in PLC cycles: a motion, one that another aborts, a coupling, refusals, a spindle, parameters."""
    seen: list[object] = []
    power, first, second, halt = MC_Power(m.x), MC_MoveAbsolute(m.x), MC_MoveAbsolute(m.x), MC_Halt(m.x)
    for _ in m.plc_cycles():
        power(True)
        first(power.status, position=60.0, velocity=100.0)
        if first.done:
            break
    seen += [power.valid, outputs(first), m.x.state.set_position]
    first(False)
    rows: list[tuple[str, str]] = []
    for _ in m.plc_cycles():
        first(not rows, position=200.0, velocity=20.0)
        second(first.active or second.busy, position=0.0, velocity=100.0)
        rows.append((outputs(first), outputs(second)))
        if second.done:
            break
    seen += [[*dict.fromkeys(rows)], m.x.state.set_position]
    gear, move, out = MC_GearIn(m.y), MC_MoveRelative(m.x), MC_GearOut(m.y)
    for _ in m.plc_cycles():
        gear(True, master=m.x, ratio_numerator=1.0, ratio_denominator=2.0)
        move(gear.in_gear, distance=20.0)
        out(move.done or out.execute)
        if gear.command_aborted:
            break
    seen += [outputs(gear), outputs(out), m.y.state.set_position]
    for inputs in ({"position": 1e5}, {"position": float("nan")}, {"position": 1.0, "buffer_mode": "later"}):
        first(False)
        for _ in m.plc_cycles():
            first(True, **inputs)
            if not first.busy:
                break
        seen.append((first.error, first.error_id, first.error_text))
    turn, orient, stop = MC_MoveVelocity(m.s), MC_OrientSpindle(m.s), MC_Stop(m.s)
    for _ in m.plc_cycles():
        turn(True, velocity=-300.0)
        orient(turn.in_velocity or orient.busy or orient.done, position=90.0)
        stop(orient.done)
        halt(False)
        if stop.done:
            break
    seen += [outputs(turn), outputs(orient), m.s.stops]
    stop(False)
    read, write, bad = MC_ReadParameter(m.x), MC_WriteParameter(m.x), MC_ReadParameter(m.x)
    read(True, "P-AXIS-00236")
    seen.append(read.value)
    for _ in m.plc_cycles():
        write(True, parameter="P-AXIS-00236", value=77.0)
        read(True, "P-AXIS-00236")
        if write.done and read.value == 77.0:
            break
    bad(True, "P-AXIS-99999")
    return [*seen, m.s.stops, (bad.error_id, bad.error_text)]


def outputs(block) -> str:
    names = ("busy", "active", "done", "command_aborted", "error")
    return " ".join(name for name in names if getattr(block, name))


BLOCKS_EXPECTED = [
    True, "done", 60.0,
    [
        ("busy", ""),
        ("busy active", "busy"),
        ("command_aborted", "busy active"),
        ("", "busy active"),
        ("", "done"),
    ], 0.0,
    "command_aborted", "done", 10.0,
    (True, 120002, "axis x: move_absolute refused: target 100000.0 mm lies beyond the positive soft limit 300.0 mm (P-AXIS-00178); nothing was changed"),
    (True, 22001, "axis x: move_absolute refused: target = nan is not finite; nothing was changed"),
    (True, 22001, "axis x: move_absolute refused: buffer_mode = 'later' is not aborting, buffered, blending_low, blending_previous, blending_next or blending_high; nothing was changed"),
    "command_aborted", "done", 1,
    500, 0, (22169, "axis x has no parameter 'P-AXIS-99999'; nothing was read"),
]  # fmt: skip
COMPARED = {
    "x": ("set_position", "set_velocity", "set_acceleration", "set_jerk"),
    "y": ("set_position", "set_velocity", "set_acceleration", "set_jerk"),
    "s": ("set_speed_rpm", "set_acceleration_deg_s2", "set_position_deg"),
}
"""Setpoints by unit."""


def setpoints(path: Path) -> dict[str, list[bytes]]:
    """The setpoints of units from the cycles of the commands that move them on, each to the standstill, to the bit.

    When a command arrives is the affair of the graph; what it does from its cycle on is not.
    """
    recorded = read_recording(path)
    found: dict[str, list[bytes]] = {}
    for command in recorded.commands:
        for unit in moved_by(command.target, command.command):
            if command.accepted:
                found.setdefault(f"{unit} by {command.command}", []).append(motion(recorded, unit, command.cycle))
    return found


def moved_by(target: str, command: str) -> tuple[str, ...]:
    """Units whose motion is compared: not y alone, which is stopped on its way, whenever that may be."""
    if target == "channel":
        return ("x", "y") if command in ("start", "mdi") else ()
    moves = {"x": ("move_absolute",), "s": ("start",)}
    return (target,) if command in moves.get(target, ()) else ()


def motion(recorded: Recorded, unit: str, cycle: int) -> bytes:
    """All its setpoints from a cycle on, to the first standstill behind its first motion."""
    rows = recorded.states[f"/{unit}/state"]
    rows = rows[rows["cycle"] >= cycle]
    moves = rows["set_velocity" if unit != "s" else "set_acceleration_deg_s2"] != 0.0
    begin = int(moves.argmax())
    end = begin + int(np.argmin(moves[begin:])) if moves.any() else 0
    return b"".join(np.ascontiguousarray(rows[name][begin : end + 1]).tobytes() for name in COMPARED[unit])
