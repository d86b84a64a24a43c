"""Programs on a whole machine: exact instants, geometry, program times, dwell, positions where programs begin."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise, permutations

import pytest
from long_support import long_but
from machine_support import (
    CYCLE_TIME,
    MILL,
    ROOT,
    MachineBench,
    assert_axis_smooth,
    machine,
    position_after,
    seven_phases,
)

from cnc_ptp.parameters import ChannelAxis
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

AXES = ("x", "y", "z")


def line_limits(way: tuple[float, ...], *, rapid: bool = False) -> tuple[float, float, float, float]:
    """V, A+, A-, J of a straight path: the weakest axis by its share of the way."""
    length = math.dist(way, (0.0, 0.0, 0.0))
    shares = [(MILL.axes[name], abs(part) / length) for name, part in zip(AXES, way, strict=True) if part]
    return (
        min((a.rapid_velocity if rapid else a.max_velocity) / k for a, k in shares),
        min(a.acceleration / k for a, k in shares),
        min(a.deceleration / k for a, k in shares),
        min(a.jerk / k for a, k in shares),
    )


def line_phases(way: tuple[float, ...], feed: float | None) -> list[tuple[float, float]]:
    v, up, down, j = line_limits(way, rapid=feed is None)
    return seven_phases(math.dist(way, (0.0, 0.0, 0.0)), v if feed is None else min(v, feed / 60.0), up, down, j)


def duration(phases: list[tuple[float, float]]) -> float:
    return sum(d for d, _ in phases)


MOVES: list[tuple[tuple[float, float, float], float | None]] = [
    ((40.0, 0.0, 0.0), 2400.0),
    ((0.0, 30.0, 0.0), 1234.5),
    ((-17.0, 23.5, 4.25), 3000.0),
    ((60.0, 45.0, -20.0), None),
    ((0.0, 0.0, -7.5), 500.0),
    ((150.0, -150.0, 0.0), None),
    ((-233.0, 51.5, 23.25), 30_000.0),
]


def program_of(moves: list[tuple[tuple[float, float, float], float | None]]) -> str:
    lines = ["%P", "G91"]
    for way, feed in moves:
        words = " ".join(f"{axis.upper()}{value}" for axis, value in zip(AXES, way, strict=True))
        lines.append(f"G00 {words}" if feed is None else f"G01 {words} F{feed}")
    return "\n".join([*lines, "M30"])


def test_a_sequence_of_lines_is_the_sum_of_its_profiles_in_every_cycle() -> None:
    """Blocks begin at the exact end of the one before, inside a cycle; nothing is rounded up."""
    bench = MachineBench(program_of(MOVES)).run()
    positions = {axis: bench.column("channel", "set_position") for axis in AXES}
    count = len(bench.column("channel", "line"))
    blocks = bench.blocks["channel"]
    begins, begin, corner = [], 0.0, (0.0, 0.0, 0.0)
    for way, feed in MOVES:
        phases = line_phases(way, feed)
        begins.append((begin, corner, way, phases))
        begin += duration(phases)
        corner = tuple(a + b for a, b in zip(corner, way, strict=True))
    for cycle in range(count):
        t = cycle * CYCLE_TIME
        started, corner_of, way, phases = next(b for b in reversed(begins) if b[0] <= t + 1e-12)
        s, v, a = position_after(phases, t - started)
        block, row = blocks[cycle // 10], cycle % 10
        length = math.dist(way, (0.0, 0.0, 0.0))
        for index in range(3):
            k = way[index] / length
            assert block.set_position[index * 10 + row] == pytest.approx(corner_of[index] + k * s, abs=1e-8)
            assert block.set_velocity[index * 10 + row] == pytest.approx(k * v, abs=1e-6)
            assert block.set_acceleration[index * 10 + row] == pytest.approx(k * a, abs=1e-4)
        if t < begin and abs(t - started) > 1e-9:
            assert block.path_velocity[row] == pytest.approx(v, abs=1e-6)
            assert block.distance_to_go[row] == pytest.approx(length - s, abs=1e-8)
            assert block.line[row] == 3 + begins.index((started, corner_of, way, phases))
    assert bench.program_cycles() == pytest.approx(begin / CYCLE_TIME, abs=1.01)
    assert positions and not bench.failed
    for name, value in zip(AXES, corner, strict=True):
        assert bench.position(name) == pytest.approx(value, abs=1e-9)


def test_axes_follow_the_channel_without_a_cycle_of_delay() -> None:
    bench = MachineBench(program_of(MOVES)).run()
    for channel, *axes in zip(bench.blocks["channel"], *(bench.blocks[name] for name in AXES), strict=True):
        if channel.path_active:
            for index, axis in enumerate(axes):
                part = slice(index * 10, index * 10 + 10)
                assert axis.first_cycle == channel.first_cycle
                assert axis.set_position == channel.set_position[part]
                assert axis.set_velocity == channel.set_velocity[part]
                assert axis.set_acceleration == channel.set_acceleration[part]
                assert axis.set_jerk == channel.set_jerk[part]
                assert set(axis.state) == {S.SYNCHRONIZED_MOTION}
    for name in AXES:
        assert bench.states(name) == [S.SYNCHRONIZED_MOTION, S.STANDSTILL]
        assert_axis_smooth(bench.blocks[name], acceleration=2400.0, jerk=50_000.0)
    assert bench.states("channel") == [C.RUNNING, C.READY]


LENGTHS = [3.0 + 0.173 * n for n in range(25)]


@pytest.mark.parametrize("length", long_but(LENGTHS, LENGTHS[::3]))
def test_programs_of_any_length_end_without_a_fault(length: float) -> None:
    """The end may fall on any place of a block, also between its last cycle and the next block."""
    bench = MachineBench(f"%P\nG01 X{length:.4f} F3000\nM30").run()
    assert bench.errors() == [] and not bench.failed
    assert bench.position("x") == round(length, 4)
    phases = line_phases((round(length, 4), 0.0, 0.0), 3000.0) if length > 4.0 else None
    if phases:
        assert bench.program_cycles() == pytest.approx(duration(phases) / CYCLE_TIME, abs=1.01)
    assert_axis_smooth(bench.blocks["x"], acceleration=2400.0, jerk=50_000.0)


def test_rapid_axes_reach_their_rapid_velocity_and_feed_stays_the_programmed_one() -> None:
    bench = MachineBench("%P\nG00 X250\nG01 X0 F6000\nM30").run()
    velocity, feed, line = (bench.column("channel", name) for name in ("path_velocity", "programmed_feed", "line"))
    assert max(v for v, n in zip(velocity, line, strict=True) if n == 2) == pytest.approx(300.0)
    assert max(v for v, n in zip(velocity, line, strict=True) if n == 3) == pytest.approx(100.0)
    assert {f for f, n in zip(feed, line, strict=True) if n == 2} == {300.0}
    assert {f for f, n in zip(feed, line, strict=True) if n == 3} == {100.0}


# ---------------------------------------------------------------- arcs


def circle_points(bench: MachineBench, line: int) -> list[tuple[float, ...]]:
    """Set positions (x, y, z, vx, vy, vz, path velocity) of the cycles of a program line."""
    points = []
    for block in bench.blocks["channel"]:
        for row in range(block.count):
            if block.line[row] == line and block.state[row] == C.RUNNING:
                parts = [block.set_position[i * 10 + row] for i in range(3)]
                parts += [block.set_velocity[i * 10 + row] for i in range(3)]
                points.append((*parts, block.path_velocity[row]))
    return points


@pytest.mark.parametrize(("code", "sign"), [("G02", -1.0), ("G03", 1.0)])
def test_an_arc_lies_on_its_circle(code: str, sign: float) -> None:
    """A three-quarter circle around (20, 0), radius 20."""
    end = 20.0 * sign
    bench = MachineBench(f"%P\nG17 {code} X20 Y{end} I20 J0 F3000\nM30").run()
    assert bench.errors() == []
    points = circle_points(bench, 2)
    angles = []
    for x, y, z, vx, vy, vz, v in points:
        assert math.hypot(x - 20.0, y) == pytest.approx(20.0, abs=1e-9) and z == vz == 0.0
        assert math.hypot(vx, vy) == pytest.approx(v, abs=1e-9)
        assert (x - 20.0) * vx + y * vy == pytest.approx(0.0, abs=1e-7)
        assert ((x - 20.0) * vy - y * vx) * sign >= -1e-9
        angles.append(math.degrees(math.atan2(y, x - 20.0)) % 360.0)
    swept = sum(abs((b - a + 180.0) % 360.0 - 180.0) for a, b in pairwise(angles))
    assert swept == pytest.approx(270.0, abs=0.5)
    assert bench.position("x") == 20.0 and bench.position("y") == end
    assert max(p[-1] for p in points) == pytest.approx(50.0)


def test_a_full_circle_and_a_helix() -> None:
    bench = MachineBench("%P\nG00 X60 Y40 Z5\nG03 I-6 J0 F1500\nG02 X60 Y40 Z-3 I-6 J0\nM30").run()
    assert bench.errors() == []
    full, helix = circle_points(bench, 3), circle_points(bench, 4)
    for x, y, *_ in [*full, *helix]:
        assert math.hypot(x - 54.0, y - 40.0) == pytest.approx(6.0, abs=1e-9)
    assert {z for _, _, z, *_ in full} == {5.0}
    unwrapped = 0.0
    for before, after in pairwise(helix):
        turn = math.atan2(before[1] - 40.0, before[0] - 54.0) - math.atan2(after[1] - 40.0, after[0] - 54.0)
        unwrapped += math.remainder(turn, 2.0 * math.pi)
        assert after[2] == pytest.approx(5.0 - 8.0 * unwrapped / (2.0 * math.pi), abs=0.02)
    assert (bench.position("x"), bench.position("y"), bench.position("z")) == (60.0, 40.0, -3.0)
    lengths = 2.0 * math.pi * 6.0, math.hypot(2.0 * math.pi * 6.0, 8.0)
    for points, length in zip((full, helix), lengths, strict=True):
        way = sum(0.5 * (a[-1] + b[-1]) * CYCLE_TIME for a, b in pairwise(points))
        assert way == pytest.approx(length, rel=1e-3)


@pytest.mark.parametrize(("plane", "program"), [("zx", "G18 G02 X10 Z10 I10 K0"), ("yz", "G19 G03 Y10 Z10 J0 K10")])
def test_arcs_in_the_other_planes(plane: str, program: str) -> None:
    bench = MachineBench(f"%P\n{program} F2000\nM30").run()
    assert bench.errors() == []
    for point in circle_points(bench, 2):
        x, y, z = point[:3]
        radius = math.hypot(x - 10.0, z) if plane == "zx" else math.hypot(y, z - 10.0)
        assert radius == pytest.approx(10.0, abs=1e-9)


@pytest.mark.long
def test_no_axis_exceeds_its_limits_in_the_example_program(bracket: str) -> None:
    bench = MachineBench(bracket).run()
    assert bench.errors() == []
    for name in AXES:
        p = MILL.axes[name]
        assert max(map(abs, bench.column(name, "set_velocity"))) <= p.max_velocity * (1 + 1e-9)
        assert max(map(abs, bench.column(name, "set_acceleration"))) <= max(p.acceleration, p.deceleration) * (1 + 1e-6)
        assert max(map(abs, bench.column(name, "set_jerk"))) <= p.jerk * (1 + 1e-6)
        largest = max(p.acceleration, p.deceleration)
        assert_axis_smooth(bench.blocks[name], acceleration=largest, jerk=p.jerk * (1 + 1e-6), kinks=True)
    block = bench.last("channel")
    assert block.blocks_done == block.blocks_total > 60


@pytest.fixture
def bracket() -> str:
    return (ROOT / "examples" / "bracket.nc").read_text(encoding="utf-8")


# ---------------------------------------------------------------- dwell


@pytest.mark.parametrize("seconds", [0.05, 0.1234, 0.0005])
def test_a_dwell_takes_exactly_its_time(seconds: float) -> None:
    bench = MachineBench(f"%P\nG01 X20 F3000\nG04 {seconds}\nG01 X40\nM30").run()
    phases = line_phases((20.0, 0.0, 0.0), 3000.0)
    expected = 2.0 * duration(phases) + seconds
    assert bench.program_cycles() == pytest.approx(expected / CYCLE_TIME, abs=1.01)
    for cycle, x in enumerate(bench.column("x", "set_position")):
        t = cycle * CYCLE_TIME
        first = position_after(phases, t)[0]
        second = position_after(phases, max(0.0, t - duration(phases) - seconds))[0]
        assert x == pytest.approx(first + second, abs=1e-8)


def test_a_dwell_as_first_block_and_alone() -> None:
    bench = MachineBench("%P\nG04 0.25\nG01 X5 F3000\nG04 0.1\nM30").run()
    x = bench.column("x", "set_position")
    assert x[250] == 0.0 < x[252] and bench.position("x") == 5.0
    assert bench.states("channel") == [C.RUNNING, C.WAITING, C.RUNNING, C.WAITING, C.READY]
    alone = MachineBench("%P\nG04 0.3\nM30").run()
    assert alone.column("channel", "state").count(C.WAITING) == pytest.approx(300, abs=1)


def test_a_program_without_motion_ends_at_once() -> None:
    bench = MachineBench("%P\nG90 G17\nM30").run()
    assert bench.errors() == [] and bench.states("channel")[-1] == C.READY
    assert bench.program_cycles() <= 1


# ---------------------------------------------------------------- where programs begin


def test_a_program_after_ptp_moves_starts_at_the_right_position() -> None:
    bench = MachineBench(
        "%P\nG91 G01 X10 Y5 F3000\nM30",
        "- {at: 0, to: x, do: move_absolute, target: 33.25, velocity: 100}\n"
        "- {at: 0, to: z, do: move_absolute, target: -12.5, velocity: 100}\n"
        "- {at: 2, to: channel, do: start}\n",
        start=False,
    ).run()
    assert bench.errors() == [] and bench.refusals() == []
    assert [bench.position(name) for name in AXES] == [43.25, 5.0, -12.5]
    assert bench.states("x") == [S.DISCRETE_MOTION, S.STANDSTILL, S.SYNCHRONIZED_MOTION, S.STANDSTILL]


def test_start_positions_of_the_machine() -> None:
    moved = machine(x={"start_position": 12.5}, z={"start_position": -3.0})
    bench = MachineBench("%P\nG91 G01 X1 Y1 F3000\nM30", machine=moved).run()
    assert [bench.position(name) for name in AXES] == [13.5, 1.0, -3.0] and bench.errors() == []
    assert bench.column("x", "set_position")[0] == 12.5


def test_one_program_after_the_other_at_any_distance() -> None:
    """A start in the very block after the end, or later, takes over axes and positions without a gap."""
    for pause in (0.0, 0.01, 0.02, 0.03, 0.05):
        bench = MachineBench("%P\nG91 G01 X5 F3000\nM30", end_when_idle=False)
        for _ in range(3):
            while not bench.blocks["channel"] or not bench.last("channel").done:
                bench.run(0.01)
            bench.run(pause)
            assert bench.give("channel", "start").accepted
            bench.run(0.01)
        bench.run(1.0)
        assert bench.errors() == [] and bench.position("x") == pytest.approx(20.0, abs=1e-9)
        assert_axis_smooth(bench.blocks["x"], acceleration=2400.0, jerk=50_000.0)


def test_mdi_blocks_carry_their_modal_state_on() -> None:
    bench = MachineBench(end_when_idle=False)
    bench.run(0.05)
    for text in ("G91 G01 X10 F3000", "X5", "G90 Y7", "G00 X0", "Y0"):
        assert bench.give("channel", "mdi", text=text).accepted, bench.records
        bench.run(1.0)
    assert bench.errors() == [] and bench.refusals() == []
    assert (bench.position("x"), bench.position("y")) == (0.0, 0.0)
    assert max(bench.column("x", "set_position")) == 15.0
    assert bench.states("channel") == [C.IDLE, *[C.RUNNING, C.IDLE] * 5]
    refused = bench.refused("channel", "mdi", text="G91 G01 X5 F-1")
    assert refused.startswith("P-ERR-21022 ")
    bench.give("channel", "mdi", text="X20 F3000")  # G90 G00 still hold: the refused line has changed nothing
    bench.run(1.0)
    assert bench.position("x") == 20.0


def test_mdi_after_a_program_begins_with_the_initial_state() -> None:
    bench = MachineBench("%P\nG91 G01 X10 F3000\nM30", end_when_idle=False).run(1.0)
    bench.give("channel", "mdi", text="X15")
    bench.run(1.0)
    assert bench.position("x") == 15.0
    bench.give("channel", "mdi", text="G91")
    bench.run(0.1)
    assert bench.states("channel")[-1] == C.READY
    bench.give("channel", "start")  # and so does a program after MDI
    bench.run(1.0)
    assert bench.position("x") == 25.0
    bench.give("channel", "mdi", text="X30")
    bench.run(1.0)
    assert bench.position("x") == 30.0


def test_mdi_knows_nothing_of_blocks_that_were_not_executed() -> None:
    """The program is aborted in its first block: the G91 and F of the second one never were."""
    bench = MachineBench("%P\nG90 G01 X50 F600\nG91 G01 X1 F60000\nM30", end_when_idle=False).run(0.5)
    bench.give("channel", "reset")
    bench.run(0.5)
    bench.give("channel", "mdi", text="G1 X10 F3000")
    bench.run(1.0)
    assert bench.position("x") == 10.0


@pytest.mark.parametrize("name", ["C", "A"])
def test_machines_of_other_axes(name: str) -> None:
    """A channel without X, Y, Z moves along the path of all its axes."""
    channel = replace(MILL.channels["channel"], axes=(ChannelAxis(name, "x"), ChannelAxis("B", "y")))
    changed = replace(MILL, channels={"channel": channel})
    bench = MachineBench(f"%P\nG01 {name}30 B40 F3000\nM30", machine=changed).run()
    assert bench.errors() == [] and (bench.position("x"), bench.position("y")) == (30.0, 40.0)
    assert max(bench.column("channel", "path_velocity")) == pytest.approx(50.0)


def test_the_feed_is_that_of_x_y_z_and_other_axes_travel_along() -> None:
    channel = replace(
        MILL.channels["channel"], axes=(ChannelAxis("X", "x"), ChannelAxis("Y", "y"), ChannelAxis("A", "z"))
    )
    bench = MachineBench(
        "%P\nG01 X30 Y40 A20 F3000\nA0\nM30", machine=replace(MILL, channels={"channel": channel})
    ).run()
    assert bench.errors() == []
    line, velocity = bench.column("channel", "line"), bench.column("channel", "path_velocity")
    to_go, z = bench.column("channel", "distance_to_go"), bench.column("z", "set_velocity")
    assert to_go[1] == pytest.approx(50.0, abs=1e-3)
    assert max(v for v, n in zip(velocity, line, strict=True) if n == 2) == pytest.approx(50.0)
    assert max(z) == pytest.approx(50.0 * 20.0 / 50.0)
    assert min(z) == pytest.approx(-50.0)  # alone it has the feed


@pytest.mark.parametrize(
    "order", long_but(permutations("CXYZ"), [tuple(axes) for axes in ("XYZC", "CZYX", "ZXCY", "YCXZ")]), ids="".join
)
def test_the_feed_is_that_of_x_y_z_in_every_order_of_the_axes(order: tuple[str, ...]) -> None:
    """Line, helix and a turn of C alone: the Cartesian velocity is F, wherever the axes stand in the channel."""
    nodes = {"X": "x", "Y": "y", "Z": "z", "C": "c"}
    channel = replace(MILL.channels["channel"], axes=tuple(ChannelAxis(name, nodes[name]) for name in order))
    axes = {**MILL.axes, "c": replace(MILL.axes["x"], name="c", max_velocity=1000.0)}
    program = "%P\nG01 X10 Z10 F900\nG17 G02 X20 Y0 Z15 I5 C40\nG01 C0\nM30"
    bench = MachineBench(program, machine=replace(MILL, axes=axes, channels={"channel": channel})).run()
    assert bench.errors() == []
    speeds = {name: bench.column(node, "set_velocity") for name, node in nodes.items()}
    line = bench.column("channel", "line")
    for number, path in ((2, "XYZ"), (3, "XYZ"), (4, "C")):
        rows = zip(line, *(speeds[name] for name in path), strict=True)
        fastest = max(math.hypot(*row[1:]) for row in rows if row[0] == number)
        assert fastest == pytest.approx(15.0, rel=1e-9), (order, number)
