"""What a client does with a machine, offline and in the graph alike; and what its recording must have in common."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cnc_ptp.client import CncError, JobStatus, Machine
from cnc_ptp.recording.reader import Recorded, read_recording

PART = "%part\nN10 G90 G17 G54\nN20 G0 X10 Y5\nN30 G1 X40 F6000\nN40 M8\nN50 G2 X50 Y15 I0 J10\nN60 M9\nN70 M30\n"
REFUSED = (
    120002,
    "axis x: move_absolute refused: target 100000.0 mm lies beyond the positive soft limit 300.0 mm (P-AXIS-00178); "
    "nothing was changed",
    {"target": 100000.0, "limit": 300.0},
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
    seen.append(refusal(lambda: m.x.move_absolute(1e5)))
    seen.append(refusal(lambda: m.y.couple("x", 0.0)))
    seen.append(refusal(lambda: m.channel.load(str(folder / "none.nc")))[0])
    seen.append(refusal(lambda: m.s.set_limits()))
    return seen


EXPECTED = [
    100.0, JobStatus.ABORTED, 26173, 0.0,
    JobStatus.ACTIVE, True, 600.0,
    [("M", 8, 5), ("M", 9, 7)], True, 1.0, 50.0, 15.0,
    45.0, 0.0,
    -10.0,
    REFUSED,
    (23043, "axis y: couple refused: factor = 0 must be different from 0; nothing was changed", {"argument": "factor", "value": 0.0}),
    26110,
    (22001, "spindle s: set_limits refused: nothing is given; reset_limits takes the limits away; nothing was changed", {}),
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
