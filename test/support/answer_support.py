"""Every command in every state: units brought into each state by commands, and their answers as tables.

`python test/support/answer_support.py` writes the tables of docs/answers.md as the units answer now.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from axis_states_support import path_block
from machine_support import CYCLE_TIME, MILL, MachineBench, UnitBench, axis_parameters, spindle_parameters
from sercos_support import sercos_axis
from spindle_support import bench_of, two_gears

from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.parameters import AxisParameters, MachineParameters, SpindleParameters, read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import AxisBlock
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.spindle.spindle_unit import SpindleUnit

S, C = AxisStateCode, ChannelStateCode
PAGE = Path(__file__).parents[2] / "docs" / "answers.md"
HEADLINES = {"axis": "Axis", "spindle": "Spindle", "channel": "Channel"}
Give = Callable[..., Any]
"""Gives a command and returns its record."""


@dataclass
class Situation:
    """A unit in one of its states: its column in the table, the state, and how it gets there.

    The state is that inside: a unit that MC_Stop holds reports Stopping instead of Standstill.
    """

    column: str
    state: AxisStateCode | ChannelStateCode
    prepare: Callable[[], tuple[Give, Callable[[], int]]]
    """What gives a command to the unit, and what shows its state."""


# ---------------------------------------------------------------- axis

FAST = {"velocity": 100.0, "acceleration": 5000.0, "deceleration": 5000.0, "jerk": 50_000.0}
COUPLED = {"master": "y", "above": [], "master_stands": True, "master_lost": False}
"""With what the PLC fills in."""
POINTS = [[0.0, 0.0], [100.0, 50.0], [200.0, 0.0]]

AXIS_ROWS: dict[str, tuple[str, dict[str, Any]]] = {
    "power on": ("power", {"enabled": True}),
    "power off": ("power", {"enabled": False}),
    "reset": ("reset", {}),
    "set_feed_release": ("set_feed_release", {"forward": True, "backward": True}),
    **{
        " ".join(filter(None, (command, mode))): (
            command,
            {argument: 50.0, **FAST, **({"buffer_mode": mode} if mode else {})},
        )
        for command, argument in (
            ("move_absolute", "target"),
            ("move_relative", "distance"),
            ("move_modulo", "position"),
            ("move_additive", "distance"),
            ("move_velocity", "velocity"),
        )
        for mode in ("", "aborting", "buffered", "blending_next")
    },
    "move_velocity 0 aborting": ("move_velocity", {"velocity": 0.0, "buffer_mode": "aborting"}),
    "move_superimposed": ("move_superimposed", {"distance": 5.0, "velocity_difference": 10.0}),
    "halt_superimposed": ("halt_superimposed", {}),
    "set_position": ("set_position", {"position": 3.0, "relative": True}),
    "set_override": ("set_override", {"percent": 80.0}),
    "set_override_type": ("set_override_type", {"type": 2}),
    "stop": ("stop", {}),
    "hold_stop": ("hold_stop", {"enabled": True}),
    "halt": ("halt", {}),
    "emergency_stop": ("emergency_stop", {"deceleration": 20_000.0, "jerk": 500_000.0}),
    "jog": ("jog", {"velocity": 30.0}),
    "jog 0": ("jog", {"velocity": 0.0}),
    "home": ("home", {}),
    "set_homing_override": ("set_homing_override", {"percent": 50.0}),
    "new_target": ("new_target", {"target": 60.0}),
    "new_velocity_and_target": (
        "new_velocity_and_target",
        {"velocity": 50.0, "target": 60.0, "activation_position": 30.0},
    ),
    "compensation_start": (
        "compensation_start",
        {"length": 20.0, "difference": 1.0, "process_velocity": 50.0, "velocity_increase": 20.0},
    ),
    "compensation_stop": ("compensation_stop", {}),
    "external_enable absolute": ("external_enable", {"mode": "absolute"}),
    "external_enable relative": ("external_enable", {"mode": "relative"}),
    "external_disable": ("external_disable", {}),
    "external_setpoints": ("external_setpoints", {"setpoints": [[10**6, 0.0, 0.0, 0.0, 1]]}),
    "couple": ("couple", {"factor": 1.0, **COUPLED}),
    "couple_gantry": ("couple_gantry", {"difference_limit": 1.0, **COUPLED}),
    "couple_cyclic": ("couple_cyclic", {"acc_bound": 50_000.0, **COUPLED}),
    "couple_flying_saw": (
        "couple_flying_saw",
        {"factor": 1.0, "master_position": 500.0, "slave_position": 500.0, **FAST, **COUPLED},
    ),
    "couple_cam": ("couple_cam", {"table": POINTS, **COUPLED}),
    "change_cam": ("change_cam", {"table": POINTS}),
    "set_coupling_factor": ("set_coupling_factor", {"factor": 2.0}),
    "set_cyclic_factor": ("set_cyclic_factor", {"factor": 2.0}),
    "decouple": ("decouple", {}),
    "set_feedforward": ("set_feedforward", {"enabled": True}),
    "reset_feedforward": ("reset_feedforward", {}),
    "set_friction_compensation": ("set_friction_compensation", {"enabled": False}),
    "begin_trajectory": ("begin_trajectory", {"points": [[0.5, 5.0, 0.0]]}),
    "lead": ("lead", {"slave": "z", "enabled": True}),
    "group_error": ("group_error", {"source": "y", "error": 23010}),
    "feed_hold": ("feed_hold", {"enabled": True}),
    "write_parameter": ("write_parameter", {"parameter": "P-AXIS-00236", "value": 1000.0}),
    "read_drive_parameter": ("read_drive_parameter", {"idn": "S-0-0403"}),
    "write_drive_parameter": ("write_drive_parameter", {"idn": "S-0-0148", "value": 3}),
    "overlay": ("overlay", {"control_unit": "feed_hold", "enabled": True, "value": 1.0, "holder": "p"}),
    "set_emergency_stop": ("set_emergency_stop", {"enabled": True}),
    "upstream_lost": ("upstream_lost", {"source": "plc"}),
}


class AxisBench(UnitBench):
    """An axis that counts modulo, beside a standing axis y that may be its master."""

    def __init__(self, x: AxisParameters | None = None) -> None:
        x = x or axis_parameters(modulo=True, modulo_high=360.0)
        others = {name: axis_parameters(name=name) for name in ("y", "z")}
        super().__init__(AxisUnit(x, cycle_time=CYCLE_TIME, axes={"x": x, **others}))
        self.sources: Callable[[], dict[str, Any]] = dict

    def run(self, cycles: int, inputs: Any = None) -> None:
        end = self.cycle + cycles
        while self.cycle < end:
            super().run(10, inputs or self.sources())

    def path(self) -> dict[str, Any]:
        """A channel whose path has the axis and stands."""
        return {"channel": path_block(self.cycle, [0.0] * 10)}

    def master(self) -> dict[str, Any]:
        """The standing y."""
        rows = {name: [0.0] * 10 for name in ("set_position", "set_velocity", "set_acceleration", "set_jerk")}
        actual = {name: [0.0] * 10 for name in ("actual_position", "actual_velocity")}
        return {
            "y": AxisBlock(self.cycle, 10, **rows, **actual, state=[1] * 10, status_bits=[0] * 10, error_id=[0] * 10)
        }


def axis_situation(
    steps: Callable[[AxisBench], None], make: Callable[[], AxisBench] = AxisBench
) -> tuple[Give, Callable[[], int]]:
    bench = make()
    bench.run(10)
    steps(bench)
    return bench.give, lambda: int(bench.unit._axis.state)  # type: ignore[attr-defined]


def after(command: str, cycles: int = 0, /, **arguments: Any) -> Callable[[AxisBench], None]:
    """A command, and some cycles."""

    def steps(bench: AxisBench) -> None:
        bench.accepted(command, **arguments)
        bench.run(cycles)

    return steps


def on_path(bench: AxisBench) -> None:
    bench.sources = bench.path
    bench.run(20)


def slave(bench: AxisBench, command: str = "couple", **arguments: Any) -> None:
    bench.sources = bench.master
    bench.accepted(command, **(arguments or {"factor": 1.0}), **COUPLED)
    bench.run(20)


def sercos() -> AxisBench:
    """An axis whose drive has a service channel, and homes it on its own."""
    drive = sercos_axis(at=0.0)
    x = axis_parameters(modulo=True, modulo_high=360.0, control=drive.control, homing=drive.homing)
    return AxisBench(replace(x, referenced_at_start=True))


def halting(bench: AxisBench, command: str = "halt") -> None:
    after("move_absolute", 100, target=300.0, **FAST | {"jerk": 5000.0})(bench)
    after(command, 10)(bench)


def buffering(bench: AxisBench) -> None:
    after("move_absolute", 100, target=300.0, **FAST)(bench)
    after("move_absolute", 10, target=350.0, buffer_mode="buffered", **FAST)(bench)


def error_stop(bench: AxisBench) -> None:
    after("upstream_lost", 100, source="plc")(bench)
    bench.unit.lost.clear()


AXIS = [
    Situation(column, state, partial(axis_situation, steps))
    for column, state, steps in (
        ("Disabled", S.DISABLED, after("power", 10, enabled=False)),
        ("Standstill", S.STANDSTILL, lambda bench: None),
        ("Homing", S.HOMING, after("home", 5)),
        ("DiscreteMotion", S.DISCRETE_MOTION, after("move_absolute", 100, target=300.0, **FAST)),
        ("DiscreteMotion: halt", S.DISCRETE_MOTION, halting),
        (
            "DiscreteMotion: trajectory",
            S.DISCRETE_MOTION,
            after("begin_trajectory", 50, points=[[0.5, 20.0, 0.0]]),
        ),
        ("DiscreteMotion: superimposed", S.DISCRETE_MOTION, after("move_superimposed", 50, distance=30.0)),
        ("DiscreteMotion: another waits", S.DISCRETE_MOTION, buffering),
        ("ContinuousMotion", S.CONTINUOUS_MOTION, after("move_velocity", 100, velocity=50.0)),
        ("ContinuousMotion: velocity 0", S.CONTINUOUS_MOTION, after("move_velocity", 100, velocity=0.0)),
        ("ContinuousMotion: jog", S.CONTINUOUS_MOTION, after("jog", 100, velocity=50.0)),
        ("ContinuousMotion: external", S.CONTINUOUS_MOTION, after("external_enable", 10, mode="absolute")),
        ("SynchronizedMotion: path", S.SYNCHRONIZED_MOTION, on_path),
        ("SynchronizedMotion: slave", S.SYNCHRONIZED_MOTION, slave),
        ("SynchronizedMotion: cam", S.SYNCHRONIZED_MOTION, partial(slave, command="couple_cam", table=POINTS)),
        ("SynchronizedMotion: cyclic", S.SYNCHRONIZED_MOTION, partial(slave, command="couple_cyclic", acc_bound=5e4)),
        ("Stopping", S.STOPPING, partial(halting, command="stop")),
        ("Stopping: MC_Stop held", S.STANDSTILL, after("hold_stop", 10, enabled=True)),
        ("ErrorStop", S.ERROR_STOP, error_stop),
    )
]
AXIS += [
    Situation("Standstill: SERCOS", S.STANDSTILL, partial(axis_situation, lambda bench: None, sercos)),
    Situation("Homing: by the drive", S.HOMING, partial(axis_situation, after("home", 5), sercos)),
]

# ---------------------------------------------------------------- spindle

SPINDLE_ROWS: dict[str, tuple[str, dict[str, Any]]] = {
    "power on": ("power", {"enabled": True}),
    "power off": ("power", {"enabled": False}),
    "start": ("start", {"direction": "cw", "speed_rpm": 500.0}),
    "set_speed": ("set_speed", {"speed_rpm": 800.0}),
    "stop": ("stop", {}),
    "hold_stop": ("hold_stop", {"enabled": True}),
    "orient": ("orient", {"position_deg": 90.0}),
    "home": ("home", {}),
    "set_override": ("set_override", {"percent": 80.0}),
    "suppress_override": ("suppress_override", {"enabled": True}),
    "select_gear": ("select_gear", {"stage": 1}),
    "gear_changed": ("gear_changed", {}),
    "set_limits": ("set_limits", {"max_speed_rpm": 3000.0}),
    "reset_limits": ("reset_limits", {}),
    "stop_at_program_end": ("stop_at_program_end", {"enabled": True}),
    "couple": ("couple", {"master": "t"}),
    "coupling_answer": ("coupling_answer", {"granted": True, "reason": ""}),
    "decouple": ("decouple", {}),
    "follow_path": ("follow_path", {"source": "channel"}),
    "leave_path": ("leave_path", {"source": "channel"}),
    "set_feedforward": ("set_feedforward", {"enabled": True}),
    "reset_feedforward": ("reset_feedforward", {}),
    "reset": ("reset", {}),
    "feed_hold": ("feed_hold", {"enabled": True}),
    "overlay": ("overlay", {"control_unit": "feed_hold", "enabled": True, "value": 1.0, "holder": "p"}),
    "set_emergency_stop": ("set_emergency_stop", {"enabled": True}),
    "upstream_lost": ("upstream_lost", {"source": "plc"}),
}


def spindle_situation(
    *steps: tuple[str, dict[str, Any], int], make: Callable[[], SpindleParameters] = spindle_parameters
) -> tuple[Give, Callable[[], int]]:
    bench = bench_of(make(), spindles=("s", "t"))
    bench.run(10)
    for command, arguments, cycles in steps:
        bench.accepted(command, **arguments)
        bench.run(cycles)
    unit = bench.unit
    assert isinstance(unit, SpindleUnit)
    unit.lost.clear()
    return bench.give, lambda: int(unit.spindle.state)


START = ("start", {"direction": "cw", "speed_rpm": 1000.0}, 400)
SPINDLE = [
    Situation(column, state, partial(spindle_situation, *steps))
    for column, state, steps in (
        ("Disabled", S.DISABLED, [("power", {"enabled": False}, 10)]),
        ("Standstill", S.STANDSTILL, []),
        ("Homing", S.HOMING, [("home", {}, 20)]),
        ("DiscreteMotion", S.DISCRETE_MOTION, [("orient", {"position_deg": 90.0}, 10)]),
        ("ContinuousMotion", S.CONTINUOUS_MOTION, [START]),
        ("SynchronizedMotion", S.SYNCHRONIZED_MOTION, [("follow_path", {"source": "channel"}, 0)]),
        ("Stopping", S.STOPPING, [START, ("stop", {}, 10)]),
        ("Stopping: MC_Stop held", S.STANDSTILL, [("hold_stop", {"enabled": True}, 10)]),
        ("ErrorStop", S.ERROR_STOP, [("upstream_lost", {"source": "plc"}, 10)]),
    )
]

SLAVE = ("couple", {"master": "t"}, 0), ("coupling_answer", {"granted": True, "reason": ""}, 10)
GEAR_CHANGE = ("select_gear", {"stage": 2}, 300)
SPINDLE += [
    Situation("Standstill: slave", S.STANDSTILL, partial(spindle_situation, *SLAVE)),
    Situation("Standstill: gear change", S.STANDSTILL, partial(spindle_situation, GEAR_CHANGE, make=two_gears)),
]

# ---------------------------------------------------------------- channel

CHANNEL_ROWS: dict[str, tuple[str, dict[str, Any]]] = {
    "load": ("load", {"program": "other.nc", "text": "%P\nM30"}),
    "start": ("start", {}),
    "start line": ("start", {"line": 2}),
    "feed_hold on": ("feed_hold", {"enabled": True}),
    "feed_hold off": ("feed_hold", {"enabled": False}),
    "set_override": ("set_override", {"percent": 80.0}),
    "single_block": ("single_block", {"enabled": False}),
    "optional_stop": ("optional_stop", {"enabled": False}),
    "block_skip": ("block_skip", {"enabled": False}),
    "reset": ("reset", {}),
    "mdi": ("mdi", {"text": "G01 X1 F1000"}),
    "acknowledge": ("acknowledge", {"id": 1}),
    "measuring_event": ("measuring_event", {}),
    "set_zero_offset": ("set_zero_offset", {"index": 1, "axis": "X", "value": 1.0}),
    "teach_zero_offset": ("teach_zero_offset", {"index": 1}),
    "set_clamp_position": ("set_clamp_position", {"index": 0}),
    "overlay": ("overlay", {"control_unit": "feed_hold", "enabled": True, "value": 1.0, "holder": "p"}),
    "set_emergency_stop": ("set_emergency_stop", {"enabled": True}),
    "upstream_lost": ("upstream_lost", {"source": "plc"}),
}

MOVE, WAIT, STOP = "%P\nG01 X100 F6000\nM30", "%P\nM08\nG01 X20 F3000\nM30", "%P\nM00\nG01 X20 F3000\nM30"

MEASURE, PROBE = "%P\nG100 X60 F600\nM30", read_machine(PAGE.parents[1] / "examples" / "probe.yaml")


def channel_situation(
    program: str | None,
    *steps: tuple[str, str, dict[str, Any], float],
    start: bool = True,
    seconds: float = 0.1,
    machine: MachineParameters = MILL,
) -> tuple[Give, Callable[[], int]]:
    """A channel with a program, then commands to units, each followed by some seconds."""
    bench = MachineBench(program, machine=machine, start=start, end_when_idle=False).run(seconds)
    for unit, command, arguments, time in steps:
        assert bench.give(unit, command, **arguments).accepted
        bench.run(time)
    return partial(bench.give, "channel"), lambda: int(bench.last("channel").state[-1])


CHANNEL = [
    Situation("Idle", C.IDLE, partial(channel_situation, None)),
    Situation("Ready", C.READY, partial(channel_situation, MOVE, start=False)),
    Situation("Running", C.RUNNING, partial(channel_situation, MOVE)),
    Situation("Running: G100", C.RUNNING, partial(channel_situation, MEASURE, machine=PROBE)),
    Situation("Hold", C.HOLD, partial(channel_situation, MOVE, ("channel", "feed_hold", {"enabled": True}, 0.2))),
    Situation(
        "Waiting",
        C.WAITING,
        partial(
            channel_situation,
            WAIT,
            ("plc", "auto_acknowledge", {"enabled": False}, 0.02),
            ("channel", "start", {}, 0.1),
            start=False,
        ),
    ),
    Situation("Stopped", C.STOPPED, partial(channel_situation, STOP)),
    Situation("Stopping", C.STOPPING, partial(channel_situation, MOVE, ("channel", "reset", {}, 0.02))),
    Situation("Error", C.ERROR, partial(channel_situation, MOVE, ("x", "upstream_lost", {"source": "plc"}, 0.5))),
]

ROWS = {"axis": AXIS_ROWS, "spindle": SPINDLE_ROWS, "channel": CHANNEL_ROWS}
SITUATIONS = {"axis": AXIS, "spindle": SPINDLE, "channel": CHANNEL}

# ---------------------------------------------------------------- tables


def answers(kind: str, situation: Situation) -> Iterator[tuple[str, str]]:
    """Row and answer of each command: `ok`, or the number of the refusal.

    A refused command changes nothing, so that the same unit is asked until it has accepted one.
    """
    give: Give | None = None
    for row, (command, arguments) in ROWS[kind].items():
        if give is None:
            give, state = situation.prepare()
            assert state() == situation.state, f"{situation.column}: {state()}"
        record = give(command, **arguments)
        yield row, "ok" if record.accepted else str(record.error_id)
        give = None if record.accepted else give


def read_tables() -> dict[str, dict[str, dict[str, str]]]:
    """The tables of docs/answers.md: kind of unit -> column -> row -> answer."""
    tables: dict[str, dict[str, dict[str, str]]] = {}
    text = PAGE.read_text(encoding="utf-8")
    for kind, headline in HEADLINES.items():
        section = text.split(f"\n## {headline}\n")[1].split("\n## ")[0]
        table = f"\n{section}".split("\n| command | ", 1)[1].split("\n\n")[0]
        lines = [line.strip("| ").split(" | ") for line in f"| command | {table}".splitlines() if line.startswith("| ")]
        columns = lines[0][1:]
        tables[kind] = {column: {} for column in columns}
        for row, *cells in lines[1:]:
            for column, cell in zip(columns, cells, strict=True):
                tables[kind][column][row.strip("`")] = cell
    return tables


def written(kind: str) -> Iterator[str]:
    """The table of a kind as its units answer now, in the form of the page."""
    columns = [situation.column for situation in SITUATIONS[kind]]
    found = {situation.column: dict(answers(kind, situation)) for situation in SITUATIONS[kind]}
    yield f"| command | {' | '.join(columns)} |"
    yield "|---" * (len(columns) + 1) + "|"
    for row in ROWS[kind]:
        yield f"| `{row}` | {' | '.join(found[column][row] for column in columns)} |"


def write_page() -> None:
    """Exchanges the tables of the page."""
    text = PAGE.read_text(encoding="utf-8")
    for kind, headline in HEADLINES.items():
        before, section = text.split(f"\n## {headline}\n")
        begin = section.index("| command | ")
        end = section.index("\n\n", begin)
        text = f"{before}\n## {headline}\n{section[:begin]}" + "\n".join(written(kind)) + section[end:]
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write_page()
