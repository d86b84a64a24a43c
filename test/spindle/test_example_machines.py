"""The configuration examples of the manual (TF5200 spindle 2.2 to 2.8.5) run and do what it says of them."""

from __future__ import annotations

from itertools import pairwise
from math import sqrt
from pathlib import Path

import pytest
from channel_spindle_support import moves, requests, told, told_at
from example_support import CYCLE_TIME, EXAMPLES, ExampleRun, example, first
from machine_support import MachineBench
from scipy.integrate import quad

from cnc_ptp.errors import CncError
from cnc_ptp.machine.run_entries import check_program
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

UP = 18_000.0
"""°/s², up and down, of the example spindles."""
TURNS = S.CONTINUOUS_MOTION
MOVES = (S.CONTINUOUS_MOTION, S.STOPPING, S.STANDSTILL, S.DISCRETE_MOTION)


def fault_of(machine: str, program: str) -> str:
    """Why a program is refused before anything starts."""
    with pytest.raises(CncError) as caught:
        check_program(read_machine(EXAMPLES / machine), program, "test.nc")
    return str(caught.value)


def clean(bench: MachineBench) -> MachineBench:
    assert bench.errors() == [] and bench.refusals() == [] and not bench.failed
    return bench


# 2.2.1 NC spindle


NC_PROGRAM = [
    ("start", {"direction": "cw", "speed_rpm": 1000.0}),
    ("start", {"direction": "ccw", "speed_rpm": 1000.0}),
    ("stop", {}),
    ("orient", {"position_deg": 100.0, "speed_rpm": 200.0}),
]


def test_nc_spindle_turns_both_ways_stops_and_positions() -> None:
    bench = clean(example("nc_spindle.yaml", "din.nc"))
    assert told(bench, "s1") == NC_PROGRAM
    speeds = bench.column("s1", "set_speed_rpm")
    assert (max(speeds), min(speeds)) == (1000.0, -1000.0)
    assert bench.column("s1", "actual_position_deg")[-1] % 360.0 == pytest.approx(100.0, abs=1e-3)
    assert bench.states("s1") == [S.STANDSTILL, *MOVES, S.STANDSTILL]


def test_nc_spindle_holds_the_path_until_its_speed_is_reached() -> None:
    """Z100 begins after M04 has reached 90 % of -1000 rpm: from +1000 rpm that are 1900 rpm at 3000 rpm/s."""
    bench = example("nc_spindle.yaml", "din.nc")
    began = told_at(bench, "start", "s1") + 340
    reached = first(bench.column("s1", "speed_reached"), True, began + 20)
    actual = bench.column("s1", "actual_speed_rpm")
    assert actual[reached] <= -900.0 < actual[reached - 1]
    (begin, end), *rest = moves(bench)
    assert not rest and reached < begin <= reached + 20
    assert told(bench, "s1")[2] == ("stop", {})
    assert next(r.cycle for r in bench.records if r.command == "stop") >= end


def test_both_syntaxes_command_the_same() -> None:
    din, brackets = (example("nc_spindle.yaml", f"{name}.nc") for name in ("din", "brackets"))
    for column in ("set_position_deg", "set_speed_rpm", "state"):
        assert din.column("s1", column) == brackets.column("s1", column)
    assert din.column("z", "set_position") == brackets.column("z", "set_position")


def test_plc_commands_an_nc_spindle_in_order_of_arrival() -> None:
    bench = clean(example("nc_spindle.yaml", scenario="external.yaml"))
    assert bench.states("s1") == [TURNS, S.DISCRETE_MOTION, S.STANDSTILL, TURNS, S.HOMING, S.STANDSTILL]
    last = bench.last("s1")
    assert (last.plc_commands, last.plc_acknowledged) == (4, 4)
    done = [block.plc_acknowledged for block in bench.blocks["s1"]]
    assert sorted(set(done)) == [0, 1, 2, 3, 4] and done == sorted(done)


# 2.2.2 PLC spindles


@pytest.mark.parametrize(("machine", "spindle"), [("plc_spindle.yaml", "s1"), ("channel_plc_spindle.yaml", "S1")])
@pytest.mark.parametrize("program", ["din.nc", "brackets.nc"])
def test_plc_spindle_gets_its_commands_and_acknowledges_by_itself(machine: str, spindle: str, program: str) -> None:
    bench = clean(example(machine, program, "plc.yaml"))
    handed = [(r.kind, r.number, r.value, r.position, r.spindle, r.acknowledge_needed) for r in requests(bench)]
    assert handed == [
        ("M", 3, 1000.0, 0.0, spindle, True),
        ("M", 4, 1000.0, 0.0, spindle, True),
        ("M", 5, 0.0, 0.0, spindle, True),
        ("M", 19, 200.0, 100.0, spindle, True),
    ]
    assert [request.cycle for request in requests(bench)][1] == 1010
    ((begin, end),) = moves(bench)
    assert 2000 < begin <= 2020 and end < 2540
    state = bench.column("channel", "state")
    assert {C(value) for value in state[20:1000]} == {C.WAITING}
    assert {C(value) for value in state[3020:4000]} == {C.WAITING}


def test_nc_waits_for_the_plc_alone_with_a_plc_spindle() -> None:
    """The reports of the spindle do not count: the PLC acknowledges M05 before it is at a standstill."""
    bench = clean(example("plc_spindle.yaml", "din.nc"))
    stop = told_at(bench, "stop", "s1")
    assert bench.column("s1", "speed_zero").index(True, stop + 1) > told_at(bench, "orient", "s1")


def test_plc_spindle_of_the_channel_has_no_unit() -> None:
    assert list(example("channel_plc_spindle.yaml", "din.nc").units) == ["plc", "channel", "z"]


def test_plc_spindle_of_the_channel_knows_speed_position_and_four_m_functions() -> None:
    assert fault_of("channel_plc_spindle.yaml", "%P\nS[G74]\nM30").startswith("P-ERR-21202")


# 2.2.4 controlled spindle


def held(bench: ExampleRun, column: str) -> list[int]:
    """The values that a column has for 100 cycles and more, in their order."""
    values = bench.column("s1", column)
    ends = [0, *(i for i, (a, b) in enumerate(pairwise(values), start=1) if a != b), len(values)]
    return [values[begin] for begin, end in pairwise(ends) if end - begin >= 100]


def test_sensorless_spindle_puts_out_32767_digits_at_3000_rpm() -> None:
    """10 V; 1500 rpm are 16383.5 and -1000 rpm -10922.3 digits, rounded."""
    bench = clean(example("sensorless.yaml", "open_loop.nc"))
    assert held(bench, "drive_output") == [32767, 16384, -10922, 0]


def test_drive_in_rpm_gets_digits_as_programmed() -> None:
    for machine in ("speed_feedback.yaml", "position_feedback.yaml"):
        assert held(clean(example(machine, "open_loop.nc")), "drive_output") == [3000, 1500, -1000, 0]


def test_speed_is_acknowledged_by_what_the_drive_sends() -> None:
    """2700 rpm of 3000 rpm at 3000 rpm/s: 0.9 s by the setpoint; the speed of the drive lags by a cycle; of positions
    in steps of 0.1° come speeds in steps of 16.7 rpm, 5.6 ms.
    """
    begin = 10
    reached = {
        name: first(example(f"{name}.yaml", "open_loop.nc").column("s1", "speed_reached"), True, begin + 1)
        for name in ("sensorless", "speed_feedback", "position_feedback")
    }
    assert reached["sensorless"] == begin + 900
    assert reached["speed_feedback"] == begin + 901
    assert reached["position_feedback"] == pytest.approx(begin + 901, abs=6)


def test_sensorless_spindle_cannot_be_positioned() -> None:
    text = (EXAMPLES / "positioning.nc").read_text(encoding="utf-8")
    assert fault_of("sensorless.yaml", text) == (
        "P-ERR-70252 test.nc line 2 column 1 'N10 M19 S60 S.POS90': spindle S has no actual position (P-AXIS-00320, "
        "P-SIM-00050) and cannot be positioned"
    )
    assert fault_of("speed_feedback.yaml", text).startswith("P-ERR-70252")


def test_encoder_positions_a_spindle_of_the_open_loop() -> None:
    bench = clean(example("position_feedback.yaml", "positioning.nc"))
    assert bench.column("s1", "actual_position_deg")[-1] == pytest.approx(90.0, abs=0.1)


# 2.2.5 several spindles


def test_three_spindles_one_channel() -> None:
    """S is the one with number 6; the others have their own names; #MAIN SPINDLE makes S2 the main spindle."""
    bench = clean(example("three_spindles.yaml", "three_spindles.nc"))
    handed = [(request.spindle, request.kind, request.number, request.value) for request in requests(bench)]
    assert handed == [
        ("s1", "M", 3, 1000.0),
        ("s2", "M", 4, 500.0),
        ("s3", "M", 19, 60.0),
        ("s2", "S", 0, 300.0),
        ("s1", "M", 5, 0.0),
        ("s2", "M", 5, 0.0),
    ]


def test_main_spindle_has_no_other_name_meanwhile() -> None:
    assert fault_of("three_spindles.yaml", "%P\nS1[M03 REV100]\nM30").startswith("P-ERR-21081")


def test_two_channels_command_three_spindles() -> None:
    bench = clean(example("two_channels.yaml", "channel1.nc", "two_channels_start.yaml"))
    by_source = {
        (record.target, record.command, '"channel1"' in record.arguments_json)
        for record in bench.records
        if record.target in ("s1", "s2", "s3") and "source" in record.arguments_json
    }
    assert by_source == {
        ("s1", "start", False),
        ("s1", "orient", False),
        ("s2", "start", True),
        ("s2", "stop", True),
        ("s2", "start", False),
        ("s2", "stop", False),
        ("s3", "start", True),
        ("s3", "stop", True),
    }
    speeds = bench.column("s2", "set_speed_rpm")
    assert max(speeds[:2000]) == 1000.0 and max(speeds[2000:]) == pytest.approx(500.0)
    assert bench.column("s1", "actual_position_deg")[-1] % 360.0 == pytest.approx(90.0, abs=1e-3)


def test_third_spindle_is_unknown_to_the_second_channel() -> None:
    bench = ExampleRun("two_channels.yaml", scenario="two_channels_start.yaml")
    text = (EXAMPLES / "channel2_unknown.nc").read_text(encoding="utf-8")
    assert bench.give("channel2", "load", program="channel2_unknown.nc", text=text).accepted
    message = bench.refused("channel2", "start")
    assert message == (
        "P-ERR-20180 channel2_unknown.nc line 2 column 5 'N10 S3[M03 REV100]': spindle S3 does not belong to this channel; "
        "its spindles are: S, S1; nothing was started"
    )


def test_spindle_at_work_refuses_the_other_channel() -> None:
    """channel2_at_once.nc comes while S2 runs up."""
    bench = example("two_channels.yaml", "channel1.nc", "two_channels_at_once.yaml")
    assert bench.errors()[0].startswith("P-ERR-22018 channel channel2: s2 has refused a command, P-ERR-24012")
    assert max(bench.column("s2", "set_speed_rpm")) == 1000.0
    assert not moves(bench, "channel2") and bench.states("channel1")[-1] != C.ERROR


# 2.4.1 override


def test_override_acts_except_with_g167() -> None:
    bench = clean(example("synchronous.yaml", "override.nc", "override.yaml"))
    speeds = bench.column("s2", "set_speed_rpm")
    at = {name: told_at(bench, name, "s2") for name in ("suppress_override", "set_speed")}
    end = next(record.cycle for record in bench.records if record.command == "stop")
    assert (speeds[at["suppress_override"]], speeds[at["set_speed"]], speeds[end]) == (500.0, 1000.0, 1500.0)


# 2.5.2 synchronisation


def test_path_goes_at_once_where_m3_is_not_synchronised() -> None:
    bench = clean(example("synchronisation.yaml", "not_synchronised.nc"))
    assert moves(bench) == [(1, 4600)]
    assert told_at(bench, "start", "s1") == 10


@pytest.mark.parametrize(("number", "speed"), [(0, 500.0), (1, 100.0)])
def test_path_goes_in_the_block_after_the_speed_where_s_is_synchronised(number: int, speed: float) -> None:
    bench = clean(example("synchronisation.yaml", "synchronised.nc"))
    given = [r.cycle for r in bench.records if r.command == "set_speed"][number]
    reached = first(bench.column("s1", "speed_reached"), True, given + 1)
    assert abs(bench.column("s1", "actual_speed_rpm")[reached] - speed) <= 0.1 * speed
    block_after = 10 * (reached // 10) + 10
    x = bench.column("x", "set_position")
    assert x[block_after] == x[given] and x[block_after + 1] != x[given]
    assert bench.path_begin(number) == block_after + 1


# 2.8.2 gear change


def stages(bench: MachineBench) -> list[int]:
    return [words["stage"] for command, words in told(bench, "s1") if command == "select_gear"]


def test_automatic_gears_as_the_ranges_say() -> None:
    """S650 M41, S950 M42 (S750 before and after it stays), S500 M40 (S350 stays), M41 S750."""
    bench = clean(example("gears.yaml", "gears.nc", "gears_plc.yaml"))
    assert stages(bench) == [2, 3, 1, 2]
    gear = bench.column("s1", "gear")
    assert [gear[0], *(new for old, new in pairwise(gear) if new != old)] == [1, 2, 3, 1, 2]


def test_gear_changes_at_the_position_of_the_old_gear_in_rapid_traverse() -> None:
    """30, 60, 90 and 30°; at 30 rpm from standstill, and the PLC has changed when it says so."""
    bench = example("gears.yaml", "gears.nc", "gears_plc.yaml")
    changed = [record.cycle for record in bench.records if record.command == "gear_changed"]
    assert changed == [750, 3320, 6300, 7530]
    actual, gear = bench.column("s1", "actual_position_deg"), bench.column("s1", "gear")
    at = [actual[cycle - 1] % 360.0 for cycle in changed]
    assert at == pytest.approx([30.0, 60.0, 90.0, 30.0], abs=0.1)
    assert [gear[cycle] for cycle in changed] == [2, 3, 1, 2]
    assert max(bench.column("s1", "set_speed_rpm")[: changed[0]]) == pytest.approx(30.0)
    assert {bench.last("s1").gear_request} == {0}


def test_encoder_on_the_motor_has_a_resolution_a_gear() -> None:
    """0.56 increments per 0.0001° in M41 and 0.128 in M42 (P-AXIS-00234/00233)."""
    bench = example("gears.yaml", "gears.nc", "gears_plc.yaml")
    actual = bench.column("s1", "actual_position_deg")
    for begin, end, resolution in ((800, 1000, 0.56), (3400, 3600, 0.128)):
        steps = [1e4 * resolution * (b - a) for a, b in pairwise(actual[begin:end])]
        assert len(set(map(round, steps))) > 20
        assert steps == pytest.approx([round(step) for step in steps], abs=1e-5)


def test_encoder_on_the_spindle_has_dynamics_a_gear() -> None:
    """Lag n/Kv and digits at 1000 °/min (P-AXIS-00099, 00129) at 750 rpm in M41 and 1050 rpm in M42."""
    bench = example("gears_programmed.yaml", "gears_programmed.nc")
    lag, digits = bench.column("s1", "following_error_deg"), bench.column("s1", "drive_output")
    speeds = bench.column("s1", "set_speed_rpm")
    ends = [r.cycle - 1 for r in bench.records if r.command in ("set_speed", "select_gear") and r.target == "s1"]
    for last, rpm, kv, gain in ((ends[1], 650.0, 40.0, 110), (ends[4], 1050.0, 50.0, 27)):
        assert speeds[last] == pytest.approx(rpm, rel=0.02)
        assert lag[last] == pytest.approx(6.0 * speeds[last] / kv, rel=0.1)
        assert digits[last] == pytest.approx(lag[last] * kv * 60.0 / 1000.0 * gain, abs=0.51)


def test_programmed_gears() -> None:
    bench = clean(example("gears_programmed.yaml", "gears_programmed.nc"))
    assert stages(bench) == [2, 3, 2]


@pytest.mark.parametrize(
    ("machine", "line", "number"),
    [
        ("gears.yaml", "S8000 M3", 21069),
        ("gears.yaml", "M40 S750", 21070),
        ("gears_programmed.yaml", "M41 S200 M3", 21070),
        ("gears_programmed.yaml", "S950 M3", 21071),
        ("gears_programmed.yaml", "M44 S4000 M3", 21072),
    ],
)
def test_speeds_that_no_gear_has(machine: str, line: str, number: int) -> None:
    assert fault_of(machine, f"%P\n{line}\nM30").startswith(f"P-ERR-{number} test.nc line 2")


# 2.8.3 synchronous operation


def test_slave_does_what_its_master_is_told() -> None:
    bench = clean(example("synchronous.yaml", "synchronous.nc"))
    assert [command for command, _ in told(bench, "s1")] == ["start", "orient", "start", "stop"]
    own = [name for name, _ in told(bench, "s2") if name not in ("couple", "coupling_answer", "decouple")]
    assert own == ["start", "stop"]
    decoupled = told_at(bench, "decouple", "s2")
    position = bench.column("s2", "actual_position_deg")
    assert position[decoupled] % 360.0 == pytest.approx(90.0, abs=0.05)
    speeds = bench.column("s2", "set_speed_rpm")
    assert (max(speeds), min(speeds)) == (1000.0, pytest.approx(-600.0)) and speeds[4200] == pytest.approx(300.0)


def test_path_waits_for_the_slower_slave() -> None:
    """S2 has half the acceleration of S: 90 % of 1000 rpm after 0.6 s instead of 0.3 s."""
    bench = example("synchronous.yaml", "synchronous.nc")
    began = told_at(bench, "start", "s1")
    reached = [first(bench.column(node, "speed_reached"), True, began + 1) for node in ("s1", "s2")]
    assert reached[0] == pytest.approx(began + 300, abs=30) and reached[1] == pytest.approx(began + 600, abs=30)
    assert reached[1] < bench.path_begin(0) <= reached[1] + 20


# 2.8.4 acceleration curves


def hyperbola(n: float) -> float:
    x = n / 12_000.0
    return max(1400.0, 16_000.0 if x < 1.0 else 2.285714e4 / (1.0 + 4.166666e-1 * x**2 * (1.0 + 2.857142e-2 * x**2)))


def polynomial(n: float) -> float:
    d = n - 12_000.0
    cubic = 16_000.0 - 0.88888888 * d + 2.08333333e-5 * d**2 - 1.92901234e-10 * d**3
    return max(2000.0, 16_000.0 if d < 0.0 else cubic)


def asynchronous(n: float) -> float:
    if n < 10_000.0:
        return 16_000.0
    return max(4000.0, 16_000.0 * 10_000.0 / n * min(1.0, 20_000.0 / n))


@pytest.mark.parametrize(("node", "curve"), [("s1", hyperbola), ("s2", polynomial), ("s3", asynchronous)])
def test_spindle_speeds_up_along_its_curve(node: str, curve: object) -> None:
    """Time to n is the integral of dn/a(n); 48000 °/s are reached by all and left as they came."""
    assert callable(curve)
    bench = clean(example("curves.yaml", "curves.nc"))
    speeds = [6.0 * rpm for rpm in bench.column(node, "set_speed_rpm")]
    begin = told_at(bench, "start", node)
    for cycle in (begin + 500, begin + 1500, begin + 4000, begin + 7000):
        corners = [n for n in (10_000.0, 12_000.0, 20_000.0) if n < speeds[cycle]]
        time = quad(lambda n: 1.0 / curve(n), 0.0, speeds[cycle], points=corners or None, epsrel=1e-11, limit=200)[0]
        assert (cycle - begin) * CYCLE_TIME == pytest.approx(time, rel=1e-9)
    stop = told_at(bench, "stop", node)
    assert speeds[stop + 1234] == pytest.approx(speeds[top(speeds) - 1234], rel=1e-2)
    assert max(speeds) == pytest.approx(48_000.0)


def top(speeds: list[float]) -> int:
    """The first cycle at the largest speed."""
    almost = max(speeds) * (1.0 - 1e-12)
    return next(cycle for cycle, speed in enumerate(speeds) if speed >= almost)


# 2.8.5 limits of tools


def test_tool_limits_speed_and_acceleration() -> None:
    """500 rpm at 3000 °/s² are 1 s, not 333 ms to 1000 rpm; S5 becomes 10 rpm."""
    bench = clean(example("tools.yaml", "tools.nc"))
    speeds = bench.column("s1", "set_speed_rpm")
    begin = told_at(bench, "start", "s1")
    assert first(speeds, pytest.approx(500.0), begin) == begin + 1000
    slow = told_at(bench, "set_speed", "s1")
    assert speeds[slow + 1100] == pytest.approx(10.0)
    warnings = [record.message for record in bench.records if record.message]
    assert warnings == [
        "P-WARN-24029 spindle s1: speed 1000.0 rpm is above the maximum of the tool, 500 rpm is used",
        "P-WARN-24029 spindle s1: speed 5.0 rpm is below the minimum of the tool, 10 rpm is used",
        "P-WARN-24029 spindle s1: speed 1000.0 rpm is above the maximum of the tool, 500 rpm is used",
    ]


def test_tool_without_spindle_leaves_the_limits_until_they_are_reset() -> None:
    bench = example("tools.yaml", "tools.nc")
    names = [name for name, _ in told(bench, "s1")]
    assert names.count("set_limits") == 1 and names.index("reset_limits") == 6
    reset = told_at(bench, "reset_limits", "s1")
    speeds = bench.column("s1", "set_speed_rpm")
    assert max(speeds[:reset]) == pytest.approx(500.0) and max(speeds[reset:]) == pytest.approx(1000.0)
    accelerations = bench.column("s1", "set_acceleration_deg_s2")
    assert max(accelerations[:reset]) == 3000.0 and max(accelerations) == UP


def test_stop_takes_the_way_of_its_deceleration() -> None:
    """The stopping distance from 1000 rpm is n²/(2a): 1000 °."""
    bench = example("nc_spindle.yaml", "din.nc")
    stop = told_at(bench, "stop", "s1")
    position, speed = bench.column("s1", "set_position_deg"), bench.column("s1", "set_speed_rpm")
    stood = first(speed, 0.0, stop)
    assert abs(position[stood] - position[stop]) == pytest.approx(6000.0**2 / (2.0 * UP))
    assert (stood - stop) * CYCLE_TIME == pytest.approx(sqrt(2.0 * 1000.0 / UP), abs=CYCLE_TIME)


def test_machine_files_of_the_examples_warn_of_nothing() -> None:
    machines = [file for file in EXAMPLES.iterdir() if "/machine:" in file.read_text(encoding="utf-8")]
    assert len(machines) == 16
    assert {warning for file in machines for warning in read_machine(file).warnings} == set()


def test_every_example_is_run() -> None:
    here = Path(__file__)
    texts = [file.read_text(encoding="utf-8") for file in (here, *(here.parents[1] / "figures").glob("*spindle*.py"))]
    assert [file.name for file in EXAMPLES.iterdir() if not any(file.stem in text for text in texts)] == []
