"""The example PLCs: what they promise, in runs of them; motions against closed forms."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from figure_support import cycles, ramp_time
from machine_support import MILL, PTP, ROOT

from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.plc_file import read_plc
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Event

EXAMPLES = ROOT / "examples"


class Run:
    """A run of an example, with the cycles of its units and the switched values of its PLC after each block."""

    def __init__(self, name: str, machine: Any, *, program: str | None = None, scenario: str | None = None) -> None:
        entries = read_entries(machine, program=program, scenario=scenario)
        units = build_units(machine, scenario=entries, plc_file=read_plc(str(EXAMPLES / f"{name}.py")))
        self.blocks: dict[str, list[Any]] = {unit: [] for unit in units}
        self.events: list[Event] = []
        self.samples: list[dict[str, Any]] = []
        plc = units["plc"].program.plc  # type: ignore[attr-defined]
        for outputs in OfflineMachine(machine, units).run():
            for unit, output in outputs.items():
                self.blocks[unit].append(output.block)
                self.events += output.events
            if hasattr(plc, "magazine"):
                self.samples.append({"pocket": plc.magazine.pocket, "arm": plc.arm_moves, "closed": plc.door.closed})

    def column(self, unit: str, field: str) -> Any:
        return np.array([value for block in self.blocks[unit] for value in getattr(block, field)])

    def texts(self) -> list[tuple[int, str]]:
        return [(event.cycle, event.text) for event in self.events if event.source == "plc"]


@cache
def tool_changer() -> Run:
    files = {
        name: str(EXAMPLES / f"plc_tool_changer.{ending}") for name, ending in (("program", "nc"), ("scenario", "yaml"))
    }
    return Run("plc_tool_changer", MILL, **files)


def test_tools_are_changed_in_their_time() -> None:
    """T2: two pockets of 0.4 s; T5 from 2: three. The arm takes 0.6 s behind magazine and spindle."""
    run = tool_changer()
    told = [cycle for cycle, text in run.texts() if "is in the spindle" in text]
    assert [text for _, text in run.texts() if "pocket" in text] == [
        "plc plc: tool of pocket 2 is in the spindle", "plc plc: tool of pocket 5 is in the spindle",
    ]  # fmt: skip
    requests = [request for block in run.blocks["channel"] for request in block.requests]
    sent = {(request.kind, request.number): request.cycle for request in requests}
    magazine_there = sent["T", 2] + 10 + 800
    assert 0 <= told[0] - (magazine_there + 600) <= 20
    assert run.blocks["plc"][-1].run_failed is False


def test_the_spindle_stands_at_its_change_position_while_the_arm_moves() -> None:
    run = tool_changer()
    position, speed = run.column("s", "actual_position_deg"), run.column("s", "actual_speed_rpm")
    arm = np.repeat([sample["arm"] for sample in run.samples], 10)
    assert 1100 < arm.sum() < 1300  # two changes of 0.6 s
    assert np.abs((position[arm] - 90.0 + 180.0) % 360.0 - 180.0).max() < 0.1 and np.abs(speed[arm]).max() < 0.1


def test_with_an_open_door_the_path_stands_and_the_spindle_does_not_turn() -> None:
    run = tool_changer()
    opened = np.repeat([not sample["closed"] for sample in run.samples], 10)
    starts = np.flatnonzero(np.diff(opened.astype(int)) == 1) + 1
    assert [int(cycle) for cycle in starts] == [1000, 5000]
    velocity, speed = run.column("x", "set_velocity"), run.column("s", "set_speed_rpm")
    for begin, end in ((1000, 3000), (5000, 6500)):
        braked = slice(begin + 300, end)  # ramps: 2000 mm/s² from 50 mm/s, 36000 °/s² from 1200 rpm
        assert not velocity[braked].any() and not speed[braked].any()
    assert np.abs(velocity[4500:5000]).max() == pytest.approx(50.0) and speed[4999] == pytest.approx(1200.0)
    assert np.abs(velocity[6600:7000]).max() == pytest.approx(50.0)


def test_m3_waits_for_the_door() -> None:
    run = tool_changer()
    speed = run.column("s", "set_speed_rpm")
    state = run.column("s", "state")
    commanded = int(np.flatnonzero(state == S.CONTINUOUS_MOTION)[0])
    assert commanded < 3000 and not speed[commanded:3000].any() and speed[3300] == pytest.approx(1200.0)
    assert any(event.error_id == 22024 for event in run.events)


def test_the_generator_makes_three_phases_in_each_direction() -> None:
    """600 mm at 1000 mm/s, 4000 mm/s²: ramps of 0.25 s and 125 mm, 0.35 s between them."""
    run = Run("plc_setpoint_generator", PTP)
    position, velocity, acceleration = (
        run.column("x", f"set_{what}") for what in ("position", "velocity", "acceleration")
    )
    begin = int(np.flatnonzero(acceleration)[0])
    t = np.arange(900) * 0.001
    forward = np.piecewise(
        t,
        [t < 0.25, (t >= 0.25) & (t < 0.6), (t >= 0.6) & (t < 0.85), t >= 0.85],
        [
            lambda t: 2000.0 * t**2,
            lambda t: 125.0 + 1000.0 * (t - 0.25),
            lambda t: 600.0 - 2000.0 * (0.85 - t) ** 2,
            600.0,
        ],
    )
    assert np.abs(position[begin : begin + 860] - forward[:860]).max() < 1e-9
    back = begin + int(np.flatnonzero(velocity[begin:] < 0.0)[0]) - 1
    assert np.abs(position[back : back + 900] - (600.0 - forward)).max() < 1e-9
    assert set(np.unique(acceleration)) == {-4000.0, 0.0, 4000.0} and position[-1] == 0.0
    assert velocity.max() == 1000.0 and velocity.min() == -1000.0


def test_the_axis_goes_forward_and_backward_twice() -> None:
    run = Run("plc_move_axis", PTP)
    position, state = run.column("x", "set_position"), run.column("x", "state")
    ramp = ramp_time(2000.0, 5000.0, 50000.0)
    seconds = 2.0 * ramp + (2000.0 - 2000.0 * ramp) / 2000.0
    moving = np.flatnonzero(np.diff(state == S.DISCRETE_MOTION, prepend=False, append=False)).reshape(-1, 2)
    assert [position[begin + cycles(seconds)] for begin, _ in moving] == pytest.approx([2000.0, 0.0] * 2, abs=1e-9)
    assert [abs(position[begin + cycles(seconds) - 1] - position[end]) > 1e-9 for begin, end in moving] == [True] * 4
    assert [float(position[end]) for _, end in moving] == [2000.0, 0.0, 2000.0, 0.0]
    assert moving[0][0] == 210  # 0.2 s of waiting, one PLC cycle for the edge


def test_the_axis_is_homed_by_cam_and_zero_pulse() -> None:
    """The cam begins at 0, its zero pulse is 0.001 mm behind that in the negative direction, and is called 100 mm."""
    run = Run("plc_homing", PTP)
    position, velocity = run.column("x", "set_position"), run.column("x", "set_velocity")
    state = [S(value) for value in run.column("x", "state")]
    order = [each for each, before in zip(state, [None, *state], strict=False) if each != before]
    motion = [S.DISCRETE_MOTION, S.STANDSTILL]
    assert order == [S.STANDSTILL, *motion, S.HOMING, S.STANDSTILL, *motion]
    assert position[state.index(S.HOMING)] == 30.0 and position[-1] == 150.0
    (shifted,) = np.flatnonzero(np.abs(np.diff(position)) > 5.0)
    moved = velocity[shifted] * 0.001
    assert position[shifted + 1] - position[shifted] - moved == pytest.approx(100.001, abs=1e-3)
    assert abs(velocity[shifted]) == pytest.approx(16.666) and velocity.min() == -83.333
    (told,) = run.texts()
    assert told[1] == "plc plc: x is homed, its zero pulse is at 100 mm"
