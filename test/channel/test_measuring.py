"""G100 in programs: what is measured, where the path stops, faults, holds and aborts; the same again in a replay."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from long_support import long
from machine_support import MachineBench, assert_axis_smooth
from replay_support import bits, replay

from cnc_ptp.channel.measuring import Measuring
from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.errors import CncError
from cnc_ptp.nc.canonical import LinearMove
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.blocks import AxisBlock
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

EXAMPLES = Path(__file__).parents[2] / "examples"
PROBE = read_machine(EXAMPLES / "probe.yaml")
BELOW, ABOVE, TOP = -12.3, 27.7, -20.0
ENCODER = 2e-4
"""Increments of the encoders, mm."""
KV, A, JERK = 50.0, 1500.0, 30000.0
STOPS = "the path stops on its ramp and the program is aborted"


def probe(signal_required: bool = True, **axes: Any) -> MachineParameters:
    """The machine of the example; `axes`: changes of the probes."""
    changed = {
        name: replace(axis, probe=replace(axis.probe, **axes.get(name, {}))) for name, axis in PROBE.axes.items()
    }
    channels = {"channel": replace(PROBE.channels["channel"], signal_required=signal_required)}
    return replace(PROBE, axes=changed, channels=channels)


def run(program: str, scenario: str = "", **changes: Any) -> MachineBench:
    return MachineBench(program, scenario, machine=probe(**changes)).run()


def numbers(bench: MachineBench) -> list[float]:
    """Of all #MSG in their order."""
    texts = [event.text for event in bench.events_of("channel") if event.error_id == 22028]
    return [float(word) for text in texts for word in text.split()]


def messages(bench: MachineBench) -> list[str]:
    """Of #MSG and of measuring runs, in their order."""
    return [event.text for event in bench.events_of("channel") if event.error_id in (22028, 22050)]


def stopping_distance(v: float) -> float:
    """From a constant velocity to rest with the dynamics of the example."""
    return v * math.sqrt(v / JERK) if v * JERK < A * A else 0.5 * v * (v / A + A / JERK)


def signal(bench: MachineBench, axis: str) -> AxisBlock:
    """The block in which the probe of an axis has switched first."""
    return next(block for block in bench.blocks[axis] if block.probe_switched)


def assert_clean(bench: MachineBench) -> None:
    assert bench.errors() == bench.refusals() == []


# what is measured


def test_the_example_measures_bore_and_part() -> None:
    bench = run((EXAMPLES / "probe.nc").read_text())
    assert_clean(bench)
    assert messages(bench) == [
        "measured: X 27.7 mm",
        "measured: X -12.3 mm",
        "bore 40.000000 mm, its centre at X 7.700000",
        "measured: Z -20 mm",
    ]
    assert [bench.position(axis) for axis in "xyz"] == pytest.approx([7.7, 0.0, TOP + 5.0], abs=1e-9)
    (event, *_) = [event for event in bench.events_of("channel") if event.error_id == 22050]
    assert [(value.name, value.value, value.unit) for value in event.values] == [("X", ABOVE, "mm")]
    assert event.line == 4 and event.severity == 0


@pytest.mark.parametrize("feed", [600.0, 2000.0, *long([60.0, 1200.0])])
def test_the_signal_comes_where_a_constant_feed_takes_the_axis(feed: float) -> None:
    """A first-order axis follows at the distance v/Kv, so the setpoint is that far ahead at the crossing."""
    bench = run(f"G100 X60 F{feed}\nM30")
    assert_clean(bench)
    v, block = feed / 60.0, signal(bench, "x")
    cycle = math.floor(block.first_cycle + block.probe_cycle)
    share = block.first_cycle + block.probe_cycle - cycle
    setpoint = bench.column("x", "set_position")[cycle] + share * 0.001 * v
    lag = bench.column("x", "following_error")[cycle]
    assert setpoint - lag == pytest.approx(ABOVE, abs=ENCODER) and lag == pytest.approx(v / KV, rel=0.05)
    assert block.probe_position == ABOVE


def test_all_axes_are_measured_at_the_same_instant() -> None:
    """On a straight line of equal axes each is at the same part of its way."""
    bench = run('G100 X60 Y30 Z-12 F900\n#MSG ["%f %f", V.A.MESS.Y, V.A.MESS.Z]\nM30', z={"below": -100.0})
    assert_clean(bench)
    part = ABOVE / 60.0
    assert numbers(bench) == pytest.approx([30.0 * part, -12.0 * part], abs=ENCODER)


def test_the_first_of_several_probes_counts() -> None:
    bench = run("G100 X60 Y30 F900\nP1 = V.A.MESS.X\nX[P1] F900\nM30", y={"above": 10.0})
    assert_clean(bench)
    assert bench.position("x") == pytest.approx(20.0, abs=ENCODER)


def test_values_of_the_program() -> None:
    """With offsets and in another system of coordinates; axes that did not take part keep theirs."""
    bench = run(
        "G92 X5\nP1 = V.A.MERF.X\nP2 = V.A.MESS.X\nG100 X60 F600\n"
        '#MSG ["%f %f %f %f %d", V.A.MESS.X, V.A.MEAS.ACS.VALUE.X, V.A.MEAS.PCS.VALUE.X, V.A.MOFFS.X,'
        " V.A.MERF.X]\n"
        '#MSG ["%d %f %d %f", P1, P2, V.A.MERF.Y, V.A.MESS.Y]\n'
        "G00 X0\nG92 X0\nG00 X0 Y0\n#ROTATION ON [ANGLE=90]\nG100 Y-60 F600\n"
        '#MSG ["%f %f %f", V.A.MESS.X, V.A.MEAS.PCS.VALUE.X, V.A.MEAS.PCS.VALUE.Y]\n'
        '#ROTATION OFF\nG70\n#MSG ["%f %f", V.A.MESS.X, V.A.MEAS.PCS.VALUE.Y]\nG71\nM30'
    )
    assert_clean(bench)
    first = [ABOVE, ABOVE, ABOVE - 5.0, ABOVE - 65.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    turned = [ABOVE, 0.0, -ABOVE, ABOVE / 25.4, -ABOVE / 25.4]
    assert numbers(bench) == pytest.approx(first + turned, abs=1e-5)


# where the path stops, and how it continues


@pytest.mark.parametrize("feed", [1500.0, 5000.0, *long([300.0, 3000.0])])
def test_the_path_stops_on_its_ramp_and_continues_from_there(feed: float) -> None:
    bench = run(f"G100 X200 F{feed}\nG91 X1\nY2\nM30", x={"stroke": 0.0})
    assert_clean(bench)
    begins = signal(bench, "x").first_cycle + 10
    ahead = bench.column("x", "set_position")[begins]
    stop = ahead + stopping_distance(feed / 60.0)
    positions = bench.column("x", "set_position")
    assert min(abs(position - stop) for position in positions) < 1e-9
    assert bench.position("x") == pytest.approx(stop + 1.0, abs=1e-9) and bench.position("y") == 2.0
    assert_axis_smooth(bench.blocks["x"], acceleration=A, jerk=JERK)


def test_no_signal_is_an_error_at_the_end() -> None:
    bench = run("N10 G100 X20 Y5 F600\nN20 Z5\nM30")
    text = "the measuring run has ended at X 20, Y 5 without a signal of the probe (P-CHAN-00176)"
    (error,) = bench.errors()
    assert error == f"P-ERR-22051 channel channel: {text} in test.nc line 1 'N10 G100 X20 Y5 F600'; {STOPS}"
    assert [bench.position(axis) for axis in "xyz"] == [20.0, 5.0, 0.0]


def test_without_that_rule_the_program_continues() -> None:
    program = 'G100 X60 F600\nG0 X0\nG100 X20 F600\n#MSG ["%d %f", V.A.MERF.X, V.A.MESS.X]\nG91 X1\nM30'
    bench = run(program, signal_required=False)
    assert_clean(bench)
    assert messages(bench)[0] == "measured: X 27.7 mm" and numbers(bench) == [0.0, 27.7]
    assert bench.position("x") == 21.0


@pytest.mark.parametrize("behind", [1e-6, 0.003, 0.02])
def test_a_signal_counts_while_the_axis_still_follows_the_path(behind: float) -> None:
    """The setpoint is at the end already when the axis reaches the surface just before it."""
    bench = run("G100 X10 F6000\nG91 X1\nM30", x={"above": 10.0 - behind, "stroke": 1.0})
    assert_clean(bench)
    block = signal(bench, "x")
    assert block.set_position[0] == 10.0 and bench.position("x") == 11.0


def test_a_probe_that_is_on_before_is_an_error_and_nothing_moves() -> None:
    bench = run("N10 G0 X30\nG04 1\nN20 G100 X60 F600\nM30")
    text = "the probe of axis X is on already, at 30 mm, before the measuring run"
    assert bench.errors() == [f"P-ERR-50052 channel channel: {text} in test.nc line 3 'N20 G100 X60 F600'; {STOPS}"]
    assert bench.position("x") == 30.0
    first = run("G100 X60 F600\nM30", x={"below": 5.0})
    assert "P-ERR-50052" in first.errors()[0] and set(first.column("x", "set_position")) == {0.0}


def test_the_stroke_of_the_probe() -> None:
    """The way behind the measured point: following error, cycles until the signal is seen, ramp."""
    feed = 3000.0
    free = run(f"G100 X200 F{feed}\nM30", x={"stroke": 0.0})
    way = free.position("x") - ABOVE
    v = feed / 60.0
    assert v / KV + stopping_distance(v) < way < v * (1.0 / KV + 0.011) + stopping_distance(v)
    assert run(f"G100 X200 F{feed}\nM30", x={"stroke": way + 1e-3}).errors() == []
    bench = run(f"G100 X200 F{feed}\nY9\nM30", x={"stroke": 1.5})
    text = f"axis X comes to rest {way:.4f} mm behind the measured point, the stroke of its probe is 1.5 mm"
    line = f"in test.nc line 1 'G100 X200 F{feed}'"
    assert bench.errors() == [f"P-ERR-22052 channel channel: {text} (P-AXIS-00086) {line}; {STOPS}"]
    assert bench.position("x") == pytest.approx(free.position("x"), abs=1e-9) and bench.position("y") == 0.0
    assert messages(bench) == ["measured: X 27.7 mm"]
    (warning,) = [event for event in bench.events if event.error_id == 22053]
    assert warning.text == (
        f"channel channel: axis X brakes within {stopping_distance(v):.4f} mm, the stroke of its probe is 1.5 mm"
        " (P-AXIS-00086); the feed is too high for the probe"
    )


# the signal of the PLC, functions


def test_the_signal_of_the_plc() -> None:
    scenario = "- {at: 1.0, to: channel, do: measuring_event}\n"
    bench = run('G100 Y60 F600\n#MSG ["%f", V.A.MESS.Y]\nM30', scenario)
    assert_clean(bench)
    (record,) = [record for record in bench.records if record.command == "measuring_event"]
    assert numbers(bench) == pytest.approx([bench.column("y", "actual_position")[record.cycle - 1]], abs=1e-6)
    v = bench.column("y", "set_velocity")[record.cycle]
    assert bench.position("y") == pytest.approx(
        bench.column("y", "set_position")[record.cycle] + stopping_distance(v), abs=1e-9
    )


def test_a_stroke_too_short_for_the_signal_of_the_plc() -> None:
    bench = run("G100 Y60 F6000\nM30", "- {at: 0.5, to: channel, do: measuring_event}", y={"stroke": 0.1})
    assert "P-ERR-22052" in bench.errors()[0] and bench.refusals() == []
    assert 0.0 < bench.position("y") < 60.0


def test_nothing_waits_for_the_signal() -> None:
    scenario = "".join(f"- {{at: {at}, to: channel, do: measuring_event}}\n" for at in (0.2, 1.0, 1.05))
    bench = run("G04 0.5\nG100 Y60 F600\nM30", scenario)
    assert bench.errors() == []
    reason = "measuring_event refused: nothing in the running block waits for one; nothing was changed"
    assert bench.refusals() == [f"P-ERR-22020 channel channel: {reason}"] * 2


@pytest.mark.parametrize("scenario", ["", "- {at: 0.5, to: channel, do: measuring_event}"])
def test_functions_of_type_mne_sns_go_out_with_the_signal(scenario: str) -> None:
    bench = run("G100 X60 F1800 M97\nM30", scenario)
    assert_clean(bench)
    (request,) = [request for block in bench.blocks["channel"] for request in block.requests]
    begins = signal(bench, "x").first_cycle + 10 if not scenario else 500
    assert request.number == 97 and request.cycle == begins
    assert bench.column("channel", "path_velocity")[begins] > 20.0
    ordinary = run("G01 X20 F600 M97\nM30", scenario)
    assert ordinary.position("x") == 20.0 and ordinary.errors() == []


def test_such_functions_do_not_go_out_when_the_signal_is_missing() -> None:
    bench = run("G100 X20 F1800 M97\nM30")
    assert "P-ERR-22051" in bench.errors()[0]
    assert [request for block in bench.blocks["channel"] for request in block.requests] == []
    late = run("G100 X20 F1800 M97\nM30", signal_required=False)
    assert [event.error_id for event in late.events] == [22017]


# holds, aborts, faults


@pytest.mark.parametrize(
    ("stop", "go"),
    [
        ("feed_hold, enabled: true", "feed_hold, enabled: false"),
        ("set_override, percent: 0", "set_override, percent: 60"),
    ],
)
def test_a_hold_in_the_run(stop: str, go: str) -> None:
    scenario = f"- {{at: 1.0, to: channel, do: {stop}}}\n- {{at: 2.0, to: channel, do: {go}}}\n"
    bench = run('G100 X60 F600\n#MSG ["%f", V.A.MESS.X]\nG91 X-1\nM30', scenario)
    assert_clean(bench)
    assert C.HOLD in bench.states("channel") and numbers(bench) == [ABOVE]
    assert_axis_smooth(bench.blocks["x"], acceleration=A, jerk=JERK)


def test_the_signal_while_the_path_is_held_ends_the_run() -> None:
    scenario = """
- {at: 1.0, to: channel, do: feed_hold, enabled: true}
- {at: 1.5, to: channel, do: measuring_event}
- {at: 2.0, to: channel, do: feed_hold, enabled: false}
"""
    bench = run("G100 X60 F600\nG91 Y1\nM30", scenario)
    assert_clean(bench)
    held = bench.column("x", "set_position")[1600]
    assert bench.position("x") == held and bench.position("y") == 1.0
    assert len(messages(bench)) == 1


def test_the_hold_while_it_brakes_changes_nothing() -> None:
    plain = run("G100 X60 F3000\nM30", x={"stroke": 0.0})
    at = (signal(plain, "x").first_cycle + 20) / 1000.0
    scenario = f"""
- {{at: {at}, to: channel, do: set_override, percent: 0}}
- {{at: {at + 0.5}, to: channel, do: set_override, percent: 100}}
"""
    bench = run("G100 X60 F3000\nM30", scenario, x={"stroke": 0.0})
    assert_clean(bench)
    assert bench.position("x") == plain.position("x")


@pytest.mark.parametrize("at", [2.8, *long([1.0])])
def test_reset_in_the_run(at: float) -> None:
    scenario = f"- {{at: {at}, to: channel, do: reset}}\n- {{at: 4, to: channel, do: mdi, text: G0 X0}}\n"
    bench = run("G100 X60 F600\nY5\nM30", scenario)
    assert_clean(bench)
    assert [bench.position(axis) for axis in "xy"] == [0.0, 0.0]
    assert_axis_smooth(bench.blocks["x"], acceleration=A, jerk=JERK)


def test_a_surface_behind_a_reset_is_not_measured() -> None:
    bench = run(
        "G100 X60 F600\nM30", "- {at: 1, to: channel, do: reset}\n- {at: 2, to: channel, do: mdi, text: G0 X50}"
    )
    assert_clean(bench)
    assert messages(bench) == [] and bench.position("x") == 50.0


def test_a_fault_of_an_axis_in_the_run() -> None:
    scenario = "- {at: 1.0, to: 'y', do: power, enabled: false}\n"
    bench = MachineBench("G100 X60 Y20 F600\nM30", scenario, machine=probe()).run(4.0)
    assert bench.errors() and messages(bench) == []
    assert 5.0 < bench.position("x") < ABOVE and bench.last("x").set_velocity[-1] == 0.0
    assert_axis_smooth(bench.blocks["x"], acceleration=A, jerk=JERK)


def test_the_blocks_around_it_end_in_an_exact_stop() -> None:
    bench = run(
        "#HSC ON [BSPLINE PATH_DEV=0.1]\nG01 X5 F3000\nX10\nG100 X60\nX20\nX10\n#HSC OFF\nM30", x={"stroke": 0.0}
    )
    assert_clean(bench)
    lines, velocity = bench.column("channel", "line"), bench.column("channel", "path_velocity")
    assert velocity[lines.index(4)] == 0.0 and velocity[lines.index(5) - 1] < 1e-9
    assert bench.column("x", "set_position")[lines.index(4)] == 10.0


def test_single_block_stops_behind_it() -> None:
    scenario = """
- {at: 0, to: channel, do: single_block, enabled: true}
- {at: 6, to: channel, do: start}
- {at: 7, to: channel, do: start}
"""
    bench = run("G100 X60 F600\nG91 Y1\nM30", scenario)
    assert_clean(bench)
    assert C.STOPPED in bench.states("channel") and bench.column("y", "set_position")[5900] == 0.0


# manual blocks, the start of programs, replay


def test_manual_blocks_know_what_the_ones_before_have_measured() -> None:
    scenario = """
- {at: 0, to: channel, do: mdi, text: "G100 X60 F600"}
- {at: 5, to: channel, do: mdi, text: "G1 X[V.A.MESS.X - 7] F900"}
"""
    bench = MachineBench(None, scenario, machine=probe()).run()
    assert_clean(bench)
    assert bench.position("x") == pytest.approx(ABOVE - 7.0, abs=1e-9)


def test_a_new_program_knows_nothing_of_it() -> None:
    scenario = '- {at: 0, to: channel, do: mdi, text: "G100 X60 F600"}\n- {at: 5, to: channel, do: start}\n'
    bench = MachineBench("G1 X[V.A.MESS.X + 1] F900\nM30", scenario, machine=probe(), start=False).run()
    assert_clean(bench)
    assert bench.position("x") == 1.0


def test_a_program_does_not_start_behind_a_measuring_run() -> None:
    scenario = "- {at: 0, to: channel, do: start, line: 2}"
    bench = MachineBench("N10 G100 X60 F600\nN20 X5\nM30", scenario, machine=probe(), start=False).run(0.5)
    reason = "line 1 'N10 G100 X60 F600' measures, and it is before line 2; nothing was started"
    assert bench.refusals() == [f"P-ERR-50718 test.nc: {reason}"]
    at_it = "- {at: 0, to: channel, do: start, line: 2}"
    bench = MachineBench("N10 X5 F600\nN20 G100 X60 F600\nM30", at_it, machine=probe(), start=False).run()
    assert_clean(bench)
    assert messages(bench)[-1] == "measured: X 27.7 mm"


def test_an_axis_that_cannot_measure() -> None:
    bench = run("N10 G91 G100 X5 Y1 F600\nM30", y={"measures": False})
    place = "test.nc line 1 column 17 'N10 G91 G100 X5 Y1 F600'"
    text = "axis Y cannot measure (P-AXIS-00118); axes that can: X, Z"
    assert bench.refusals() == [f"P-ERR-50059 {place}: {text}; nothing was started"]
    turned = run("#ROTATION ON [ANGLE=45]\nG100 X5 F600\nM30", **{axis: {"measures": False} for axis in "xyz"})
    assert "axis X cannot measure (P-AXIS-00118); axes that can: none" in turned.refusals()[0]


@pytest.mark.long
def test_a_replay_gives_the_same_bits() -> None:
    text = (EXAMPLES / "probe.nc").read_text()
    bench = run(text, "- {at: 2.005, to: channel, do: measuring_event}")
    assert bench.errors() == []
    again = replay(probe(), bench.records, len(bench.blocks["plc"]))
    assert {name: again[name] for name in ("channel", "x", "y", "z")} == {
        n: t for n, t in bits(bench).items() if n != "plc"
    }
    assert bits(run(text, "- {at: 2.005, to: channel, do: measuring_event}")) == bits(bench)


def test_the_vocabulary_iso_skips() -> None:
    scenario = (
        '- {at: 0, to: channel, do: load, program: a.ngc, text: "%T%", dialect: iso}\n- {at: 0, to: channel, do: start}'
    )
    scenario = scenario.replace("%T%", "G21 G31 X60. F600.\\nG91 G1 X-2.\\nM30\\n")
    bench = MachineBench(None, scenario, machine=probe()).run()
    assert_clean(bench)
    assert messages(bench) == ["measured: X 27.7 mm"]
    assert ABOVE - 2.0 < bench.position("x") < ABOVE


def test_steps_of_the_acceleration() -> None:
    bench = run("#SLOPE [TYPE=STEP]\nG100 X200 F3000\nM30", x={"stroke": 0.0})
    assert_clean(bench)
    ahead = bench.column("x", "set_position")[signal(bench, "x").first_cycle + 10]
    assert bench.position("x") == pytest.approx(ahead + 50.0**2 / (2.0 * A), abs=1e-9)


def test_reset_while_the_axis_follows_to_the_end() -> None:
    plain = run("G100 X10 F6000\nM30")
    assert "P-ERR-22051" in plain.errors()[0]
    at_end = plain.column("x", "set_position").index(10.0)
    scenario = f"- {{at: {(at_end + 20) / 1000.0}, to: channel, do: reset}}\n"
    bench = run("G100 X10 F6000\nM30", scenario)
    assert_clean(bench)
    assert bench.position("x") == 10.0


# check before the start


def errors(text: str, **changes: Any) -> list[str]:
    machine = probe(**changes)
    return [str(error) for error in ProgramCheck.of_first_channel(machine, "a.nc").errors(text, "a.nc")]


def test_check_continues_from_the_programmed_end() -> None:
    """Also with what only the machine knows: measuring axes, M functions, soft limits."""
    assert errors("G100 X60 F300\nG91 X-1\nG02 X10 I5\nM30") == []
    assert errors("G100 X60 F300\nX0\nG100 Y5\nM30", y={"measures": False}) == [
        "P-ERR-50059 a.nc line 3 column 6 'G100 Y5': axis Y cannot measure (P-AXIS-00118); axes that can: X, Z"
    ]
    assert "P-ERR-22011" in errors("G100 X60 F300\nM55\nM30")[0]
    assert "P-ERR-120002" in errors("G100 X60 F300\nG91 X245\nM30")[0]
    assert errors("G100 X60 F300\nX[V.A.MESS.X + 1000]\nM55\nM30") == []


# an axis that does not come to rest


@pytest.mark.parametrize("required", [True, False])
def test_an_axis_that_never_rests_is_waited_for_a_second(required: bool) -> None:
    measuring = Measuring(["X"], [PROBE.axes["x"]], 0.001, required=required)
    blocks = [AxisBlock(0, 10, actual_position=[9.9 + 0.01 * ((n + 1) // 2 % 2)] * 10) for n in range(200)]
    measuring.begin(LinearMove((10.0,), False, 5.0, measures=(0,)), {"x": blocks[0]})
    waited = 0
    try:
        while not measuring.settled({"x": blocks[waited]}, 10):
            waited += 1
    except CncError as error:
        assert required and error.number == 22051
    assert waited == 99 and not measuring.awaits


def test_an_axis_that_rests_is_not_waited_for() -> None:
    measuring = Measuring(["X"], [PROBE.axes["x"]], 0.001, required=False)
    block = AxisBlock(0, 10, actual_position=[10.0] * 10)
    measuring.begin(LinearMove((10.0,), False, 5.0, measures=(0,)), {"x": block})
    assert [measuring.settled({"x": block}, 10) for _ in range(2)] == [False, True]


# properties


@pytest.mark.parametrize("cycles", [3, *long([1, 25])])
def test_what_is_measured_does_not_depend_on_the_length_of_blocks(cycles: int) -> None:
    machine = replace(probe(), block_cycles=cycles)
    bench = MachineBench('G100 X60 Y30 F900\n#MSG ["%f %f", V.A.MESS.X, V.A.MESS.Y]\nM30', machine=machine).run()
    assert_clean(bench)
    assert numbers(bench) == pytest.approx([ABOVE, ABOVE / 2.0], abs=ENCODER)


@pytest.mark.parametrize("seed", [*range(4), *long(range(4, 12))])
def test_random_runs_measure_the_surface_within_the_limits(seed: int) -> None:
    """Feed, place, direction, override and a hold at random: exact position, limits, and it stops behind the surface."""
    dice = random.Random(seed)
    place, feed = round(dice.uniform(3.0, 40.0), 4), dice.uniform(200.0, 6000.0)
    sign, at = dice.choice([1, -1]), dice.uniform(0.1, 1.0)
    surface = {"above": place, "below": -100.0} if sign > 0 else {"above": 100.0, "below": -place}
    scenario = f"""
- {{at: {at}, to: channel, do: set_override, percent: {dice.uniform(5, 100)}}}
- {{at: {at + 0.2}, to: channel, do: feed_hold, enabled: true}}
- {{at: {at + 0.5}, to: channel, do: feed_hold, enabled: false}}
"""
    program = f'G100 X{sign * 60} F{feed:.3f}\n#MSG ["%f", V.A.MESS.X]\nG91 X{-sign} F500\nM30'
    bench = run(program, scenario, x={**surface, "stroke": 0.0})
    assert_clean(bench)
    assert numbers(bench) == pytest.approx([sign * place], abs=1e-6)
    assert max(sign * p for p in bench.column("x", "set_position")) == pytest.approx(
        sign * bench.position("x") + 1.0, abs=1e-9
    )
    assert sign * bench.position("x") + 1.0 >= place
    assert_axis_smooth(bench.blocks["x"], acceleration=A, jerk=JERK)
