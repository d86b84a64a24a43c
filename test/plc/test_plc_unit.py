"""The PLC: end of a run, stop of everything, life sign, watchdog, abort of runs that cannot continue."""

from __future__ import annotations

from dataclasses import replace

import pytest
from long_support import long
from machine_support import MILL, PTP, MachineBench, assert_axis_smooth, machine

from cnc_ptp.machine.runner import UnitRunner, commands_for
from cnc_ptp.machine.wiring import Inputs, build_unit, build_units, unit_kinds, wiring
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Command, CycleTick, PlcBlock
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

KINDS = unit_kinds(MILL)


def assert_all_smooth(bench: MachineBench) -> None:
    for name in ("x", "y", "z"):
        p = MILL.axes[name]
        assert_axis_smooth(bench.blocks[name], acceleration=max(p.acceleration, p.deceleration), jerk=p.jerk)


# ---------------------------------------------------------------- end of a run


def test_a_run_without_anything_to_do_ends_after_the_settling_time() -> None:
    """The first report comes with block 1; then 0.2 s of rest."""
    bench = MachineBench().run()
    assert len(bench.blocks["plc"]) == 21 and not bench.failed
    assert [block.run_done for block in bench.blocks["plc"]] == [False] * 20 + [True]
    assert all(block.scenario_done for block in bench.blocks["plc"])


def test_a_run_ends_when_program_scenario_and_axes_are_through() -> None:
    bench = MachineBench(
        "%P\nG01 X5 F3000\nM30", "- {at: 1.0, to: y, do: move_absolute, target: 20, velocity: 10}"
    ).run()
    standing = bench.column("y", "state").index(S.STANDSTILL, 1010)
    assert standing > 3000 and len(bench.column("y", "state")) == pytest.approx(standing + 220, abs=20)
    assert bench.position("y") == 20.0
    assert [b.scenario_done for b in bench.blocks["plc"]].index(True) == 100


def test_the_drives_have_come_to_rest_at_the_end() -> None:
    bench = MachineBench("%P\nG00 X100\nM30").run()
    assert abs(bench.last("x").following_error[-1]) < 2e-3 and abs(bench.last("x").actual_velocity[-1]) < 0.05


def test_a_job_held_by_override_0_does_not_keep_the_run_from_ending() -> None:
    scenario = (
        "- {at: 0, to: x, do: set_override, percent: 0.00001}\n- {at: 0, to: x, do: move_absolute, target: 50}\n"
        "- {at: 0, to: y, do: move_absolute, target: 50, velocity: 20}\n- {at: 0.5, to: y, do: set_override, "
        "percent: 0}"
    )
    bench = MachineBench(None, scenario).run()
    assert not bench.failed and bench.last("x").state[-1] == bench.last("y").state[-1] == S.DISCRETE_MOTION


def test_spindles_are_stopped_before_the_end() -> None:
    bench = MachineBench(None, "- {at: 0, to: s, do: start, direction: ccw, speed_rpm: 600}").run()
    assert [r.command for r in bench.records] == ["start", "stop"]
    assert bench.last("s").set_speed_rpm[-1] == 0.0 and bench.last("s").speed_zero[-1]
    assert bench.records[1].cycle == pytest.approx(100 + 200, abs=20)


def test_run_failed_is_an_error_that_is_there_at_the_end() -> None:
    fault = "- {at: 0, to: x, do: power, enabled: off}"
    program = "%P\nG01 X50 F3000\nM30"
    late = MachineBench(program, fault.replace("at: 0", "at: 0.3")).run()
    assert late.failed and late.last("plc").run_done
    mended = MachineBench(
        program,
        "- {at: 0.3, to: x, do: power, enabled: off}\n- {at: 1, to: x, do: reset}\n- {at: 1, to: channel, do: reset}",
    ).run()
    assert not mended.failed and mended.errors()


def test_without_end_when_idle_the_run_goes_on() -> None:
    bench = MachineBench(end_when_idle=False).run(3.0)
    assert not any(block.run_done for block in bench.blocks["plc"])


def test_a_run_of_fixed_duration() -> None:
    bench = MachineBench("%P\nG01 X100 F300\nM30")
    blocks = list(bench.offline.run(cycles=1234))
    assert len(blocks) == 124 and 0.0 < blocks[-1]["x"].block.set_position[-1] < 100.0
    assert list(bench.offline.run(cycles=1240)) == []


# ---------------------------------------------------------------- runs that cannot go on


@pytest.mark.parametrize(
    ("program", "scenario", "reason"),
    [
        ("%P\nG01 X5 F3000\nM00\nM30", "", "in line 3 for start"),
        ("%P\nG01 X50 F3000\nM30", "- {at: 0.3, to: channel, do: feed_hold, enabled: on}",
         "in line 2 for an override above 0, the end of the feed hold or a feed release"),
        ("%P\nM08\nG01 X5 F3000\nM30", "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}",
         "in line 2 for the acknowledgement of request 1"),
        ("%P\nM03 S500\nG01 X5 F3000\nM30", "- {at: 0, to: s, do: set_override, percent: 0}",
         "in line 2 for the speed of spindle s"),
        ("%P\nM07 M08\nG01 X5 F3000\nM30", "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}",
         "in line 2 for the acknowledgement of request 1 and the acknowledgement of request 2"),
    ],
)  # fmt: skip
def test_a_program_that_nobody_will_help_is_aborted(program: str, scenario: str, reason: str) -> None:
    bench = MachineBench(program, scenario).run()
    text = f"channel channel waits {reason}, but the scenario is finished"
    assert bench.errors() == [f"P-ERR-22014 plc plc: {text}; everything is stopped and the run ends"]
    assert bench.failed and bench.last("channel").done and bench.last("channel").state[-1] == C.READY
    assert 10_000 < len(bench.column("x", "state")) < 12_000
    assert_all_smooth(bench)


@pytest.mark.parametrize(
    ("override", "command", "reason"),
    [
        (0, "start, direction: cw, speed_rpm: 500", "1 of the PLC's commands to carry out: it is held by override 0"),
        (0, "orient, position_deg: 90", "1 of the PLC's commands to carry out: it is held by override 0"),
        (
            100,
            "start, direction: cw, speed_rpm: 123.4567, source: plc}\n- {at: 0.1, to: s, do: orient, position_deg: 90",
            "2 of the PLC's commands to carry out: its speed is not reached",
        ),
    ],
)
def test_a_run_with_open_commands_of_the_plc_is_no_success(override: int, command: str, reason: str) -> None:
    spindle = replace(MILL.spindles["s"], speed_reached_band=0.0, speed_time=0.0, feedback="SPEED", open_loop=True)
    machine = replace(MILL, spindles={"s": spindle if override else MILL.spindles["s"]})
    percent = f"- {{at: 0, to: s, do: set_override, percent: {override}}}"
    scenario = f"{percent}\n- {{at: 0.1, to: s, do: {command}, source: plc}}"
    bench = MachineBench(None, scenario, machine=machine).run()
    text = (
        f"plc plc: spindle s still has {reason}, but the scenario is finished; everything is stopped and the run ends"
    )
    assert bench.errors() == [f"P-ERR-22014 {text}"] and bench.failed
    assert bench.last("s").set_speed_rpm[-1] == 0.0


def test_the_end_of_a_run_comes_after_the_commands_of_the_plc() -> None:
    scenario = "- {at: 0, to: s, do: start, direction: cw, speed_rpm: 500, source: plc}\n"
    bench = MachineBench(None, f"{scenario}- {{at: 0, to: s, do: orient, position_deg: 100, source: plc}}").run()
    assert not bench.failed and bench.errors() == []
    assert bench.last("s").plc_acknowledged == 2 and bench.last("s").in_position[-1]


@pytest.mark.parametrize(
    ("program", "scenario"),
    [
        ("%P\nG04 25\nG01 X5 F3000\nM30", ""),
        ("%P\nM00\nG01 X5 F3000\nM30", "- {at: 20, to: channel, do: start}"),
    ],
)  # fmt: skip
def test_long_waits_that_end_are_not_aborted(program: str, scenario: str) -> None:
    bench = MachineBench(program, scenario).run()
    assert bench.errors() == [] and bench.position("x") == 5.0 and not bench.failed


# ---------------------------------------------------------------- stop of everything, watchdogs


def moving_everything(seconds: float, scenario: str = "") -> MachineBench:
    """x and y on a path, z in PTP motion in a machine whose channel has only x and y, the spindle turning."""
    channel = MILL.channels["channel"]
    two = replace(MILL, channels={"channel": replace(channel, axes=channel.axes[:2])})
    move = "- {at: 0, to: z, do: move_absolute, target: 140, velocity: 50}\n"
    return MachineBench("%P\nM03 S600\nG01 X100 Y100 F6000\nM30", move + scenario, machine=two).run(seconds)


def test_stop_all_brings_everything_to_rest_and_ends_the_run() -> None:
    bench = moving_everything(
        0.6, "- {at: 0.6, to: plc, do: stop_all}\n- {at: 0.7, to: z, do: move_absolute, target: 0}"
    )
    assert all(abs(bench.last(name).set_velocity[-1]) > 1.0 for name in ("x", "y", "z"))
    bench.run()
    assert bench.refusals() == [] and bench.errors() == [] and not bench.failed
    sent = [(r.target, r.command) for r in bench.records if r.cycle == 600]
    assert sent == [("plc", "stop_all"), ("channel", "reset"), ("s", "stop"), ("z", "stop")]
    assert [bench.last(n).state[-1] for n in ("x", "y", "z", "s")] == [S.STANDSTILL] * 4
    assert bench.last("plc").scenario_done
    assert len(bench.blocks["plc"]) < 120
    assert_all_smooth(bench)


def test_stop_all_also_stops_what_began_to_move_in_the_same_block() -> None:
    scenario = "- {at: 0.1, to: x, do: move_absolute, target: 50}\n- {at: 0.1, to: plc, do: stop_all}"
    bench = MachineBench(None, scenario).run()
    assert bench.position("x") == 0.0


COUPLED = "- {at: 0, to: y, do: couple, master: x, factor: 0.5}\n- {at: 0.1, to: x, do: move_velocity, velocity: 40}\n"


@pytest.mark.parametrize("by_service", [True, False], ids=["by a service", "by the PLC"])
def test_stop_all_stops_a_slave_that_is_let_go_at_that_moment(by_service: bool) -> None:
    """It would move on for ever: bench.random_commands seeds 200254 and 200525."""
    scenario = "" if by_service else "- {at: 0.5, to: y, do: decouple}\n- {at: 0.5, to: plc, do: stop_all}"
    bench = MachineBench(None, COUPLED + scenario).run(0.5)
    assert bench.last("y").set_velocity[-1] == 20.0 and bench.last("y").master == "x"
    if by_service:
        bench.give("y", "decouple")
        bench.give("plc", "stop_all")
    bench.run(2.0)
    assert [bench.last(axis).set_velocity[-1] for axis in ("x", "y")] == [0.0, 0.0]
    assert bench.last("y").master == "" and bench.last("plc").run_done
    assert_all_smooth(bench)


@pytest.mark.parametrize("later", [0.02, *long([0.01, 0.05])])
def test_stop_all_stops_a_slave_that_is_let_go_while_it_brakes(later: float) -> None:
    bench = MachineBench(None, COUPLED).run(0.5)
    bench.give("plc", "stop_all")
    bench.run(later)
    bench.give("y", "decouple")
    bench.run(2.0)
    assert [bench.last(axis).set_velocity[-1] for axis in ("x", "y")] == [0.0, 0.0]
    assert bench.last("y").master == "" and bench.last("plc").run_done
    assert_all_smooth(bench)


def test_stop_all_leaves_alone_what_a_later_command_moves() -> None:
    bench = MachineBench(None, COUPLED, end_when_idle=False).run(0.5)
    bench.give("plc", "stop_all")
    bench.run(1.0)
    bench.give("y", "decouple")
    bench.run(0.1)
    bench.give("y", "move_absolute", target=-10.0)
    bench.run(2.0)
    assert bench.position("y") == -10.0


def test_stop_all_ends_what_is_superimposed_on_a_slave() -> None:
    """40 mm at 4 mm/s would take 10 s: bench.random_commands seed 200775."""
    scenario = COUPLED + "- {at: 0.2, to: y, do: move_superimposed, distance: 40, velocity_difference: 4}\n"
    bench = MachineBench(None, scenario + "- {at: 0.5, to: plc, do: stop_all}").run(2.0)
    sent = [(r.target, r.command) for r in bench.records if r.cycle == 500]
    expected = [("channel", "reset"), ("s", "stop"), ("x", "stop"), ("y", "halt_superimposed"), ("z", "stop")]
    assert sent == [("plc", "stop_all"), *expected]
    assert [bench.last(axis).set_velocity[-1] for axis in ("x", "y")] == [0.0, 0.0]
    assert bench.last("plc").run_done


def test_without_life_sign_everything_stops_after_the_watchdog_time() -> None:
    bench = moving_everything(0.5, "- {at: 0.5, to: plc, do: set_life_sign, enabled: off}")
    bench.run(1.5)
    lost = [(r.cycle, r.target, r.arguments_json) for r in bench.records if r.command == "upstream_lost"]
    assert lost == [(690, name, '{"source": "plc"}') for name in ("channel", "s", "x", "y", "z")]
    for name in ("s", "x", "y", "z"):
        assert bench.last(name).state[-1] == S.ERROR_STOP and bench.last(name).error_id[-1] == 26101
    assert bench.last("channel").state[-1] == C.ERROR and bench.last("s").set_speed_rpm[-1] == 0.0
    assert bench.failed
    assert_all_smooth(bench)


def test_the_life_sign_may_come_back() -> None:
    scenario = (
        "- {at: 0, to: plc, do: set_life_sign, enabled: off}\n- {at: 0.5, to: plc, do: set_life_sign, enabled: on}\n"
        "- {at: 0.6, to: x, do: reset}\n- {at: 0.6, to: x, do: move_absolute, target: 5}\n"
        "- {at: 1.6, to: plc, do: set_life_sign, enabled: off}"
    )
    bench = MachineBench(None, scenario, end_when_idle=False).run(2.5)
    assert [r.cycle for r in bench.records if r.target == "x" and r.command == "upstream_lost"] == [200, 1790]
    assert bench.position("x") == 5.0


def test_a_short_pause_of_the_life_sign_is_none() -> None:
    scenario = (
        "- {at: 0.1, to: plc, do: set_life_sign, enabled: off}\n- {at: 0.29, to: plc, do: set_life_sign, enabled: on}"
    )
    bench = MachineBench(None, scenario, end_when_idle=False).run(0.6)
    assert bench.errors() == []


def test_a_lost_unit_fails_and_ends_the_run() -> None:
    bench = moving_everything(0.6)
    bench.give("plc", "upstream_lost", source="y")
    bench.run()
    assert bench.errors()[0] == (
        "P-ERR-26101 plc plc: no block of 'y' came within the watchdog time; everything is stopped and the run ends"
    )
    assert bench.failed and "y" not in [r.target for r in bench.records if r.command == "stop"]
    assert_all_smooth(bench)


def test_abort_in_a_stay_run_ends_it() -> None:
    bench = MachineBench(end_when_idle=False).run(0.5)
    bench.give("plc", "abort", reason="the operator has had enough")
    bench.run(0.5)
    assert bench.errors() == [
        "P-ERR-22014 plc plc: the operator has had enough; everything is stopped and the run ends"
    ]
    assert bench.failed and bench.last("plc").run_done


def test_stop_all_leaves_the_error_of_a_channel_for_the_end_of_the_run() -> None:
    bench = MachineBench("%P\nG01 X100 F3000\nM30", "- {at: 0.5, to: y, do: power, enabled: off}").run(1.0)
    bench.give("plc", "stop_all")
    bench.run()
    assert bench.failed and bench.last("channel").error_id[-1] == 22012


# ---------------------------------------------------------------- commands from outside


def test_input_goes_out_with_the_next_block_in_order_with_numbers() -> None:
    plc = PlcUnit("plc", kinds=KINDS, cycle_time=0.001, end_when_idle=False)
    for percent in (10.0, 20.0):
        plc.input(Command("x", "set_override", {"percent": percent}))
    first, second = plc.step(CycleTick(0, 10), {}), plc.step(CycleTick(10, 10), {})
    assert isinstance(first, PlcBlock)
    assert [(c.id, c.target, c.arguments) for c in first.commands] == [
        (1, "x", {"percent": 10.0}),
        (2, "x", {"percent": 20.0}),
    ]
    assert second.commands == [] and (first.life_sign, second.life_sign) == (1, 2)
    assert (
        list(commands_for("x", {"plc": first})) == [("plc", command) for command in first.commands]
        and list(commands_for("y", {"plc": first})) == []
    )


def test_a_runner_applies_service_commands_first_then_those_of_the_block() -> None:
    runner = UnitRunner(build_unit(MILL, "x"), watchdog_cycles=200)
    runner.command(Command("x", "set_override", {"percent": 10.0}))
    block = PlcBlock(0, 10, life_sign=1, commands=[Command("x", "set_override", {"percent": 20.0})])
    runner.run(CycleTick(0, 10), {"plc": block})
    assert [(r.cycle, r.arguments_json) for r in runner.unit.take_records()] == [
        (0, '{"percent": 10.0}'),
        (0, '{"percent": 20.0}'),
    ]
    assert runner.next_cycle == 10
    assert runner.command(Command("x", "stop")).cycle == 10


def test_a_lost_source_stays_lost_even_if_its_blocks_come_again() -> None:
    """A replay has all blocks; what the run went without must not count there either."""
    bench = MachineBench("%P\nG01 X50 F3000\nM30", end_when_idle=False).run(0.3)
    bench.give("x", "upstream_lost", source="channel")
    bench.run(0.04)
    bench.give("x", "reset")
    bench.run(1.0)
    bench.give("x", "reset")
    bench.run(0.1)
    assert bench.states("x")[-1] == S.STANDSTILL
    assert [e for e in bench.errors() if "P-ERR-23009" in e] == []


# ---------------------------------------------------------------- wiring


def test_wiring_of_the_mill() -> None:
    assert wiring(MILL) == {
        "plc": Inputs((), ("channel", "s", "x", "y", "z")),
        "channel": Inputs(("plc",), ("x", "y", "z", "s")),
        "s": Inputs(("plc", "channel"), ()),
        "x": Inputs(("plc", "channel"), ()),
        "y": Inputs(("plc", "channel"), ()),
        "z": Inputs(("plc", "channel"), ()),
    }


def test_units_come_in_the_order_of_the_data_flow() -> None:
    assert list(build_units(MILL)) == ["plc", "channel", "s", "x", "y", "z"]
    assert [unit.kind for unit in build_units(MILL).values()] == ["plc", "channel", "spindle", "axis", "axis", "axis"]
    assert list(build_units(PTP)) == ["plc", "x", "y", "z", "c"]
    order = list(unit_kinds(MILL))
    assert all(order.index(up) < order.index(unit) for unit, needs in wiring(MILL).items() for up in needs.upstream)


def test_a_machine_without_channel_runs_ptp_scenarios() -> None:
    scenario = (
        "- {at: 0, to: x, do: move_absolute, target: 1000, velocity: 2000}\n- {at: 0, to: c, do: "
        "move_relative, distance: -90}"
    )
    bench = MachineBench(None, scenario, machine=PTP).run()
    assert (bench.position("x"), bench.position("c")) == (1000.0, -90.0) and not bench.failed


def test_other_block_sizes_and_cycle_times() -> None:
    for cycles, cycle_time in ((1, 1000), (25, 2000), (10, 500)):
        changed = replace(machine(), block_cycles=cycles, cycle_time_us=cycle_time)
        bench = MachineBench("%P\nM03 S600\nG01 X20 F3000\nM05\nM30", machine=changed).run()
        assert bench.errors() == [] and bench.position("x") == 20.0 and not bench.failed
