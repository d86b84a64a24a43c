"""Feedforward and friction compensation of a program: what the channel sends, to whom, in which block; the checks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from machine_support import MILL, ROOT, MachineBench

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.parameters import ChannelSpindle, MachineParameters, Synchronisation, load_machine

RESETS = [(unit, "reset_feedforward", {}) for unit in ("x", "y", "z", "s")]
Sent = tuple[str, str, dict[str, object]]


def permitting(*names: str) -> MachineParameters:
    """The mill with P-AXIS-00522 set on these axes alone."""

    def permit(name: str) -> object:
        axis = MILL.axes[name]
        friction = replace(axis.control.friction, permitted=name in names)
        return replace(axis, control=replace(axis.control, friction=friction))

    return replace(MILL, axes={name: permit(name) for name in MILL.axes})


def with_two_spindles() -> MachineParameters:
    mos, channel = Synchronisation.MOS, MILL.channels["channel"]
    channel = replace(channel, spindles=(*channel.spindles, ChannelSpindle("S2", "t", mos, mos, mos, mos, mos)))
    spindles = {**MILL.spindles, "t": replace(MILL.spindles["s"], name="t")}
    return replace(MILL, spindles=spindles, channels={"channel": channel})


def sent(bench: MachineBench) -> list[tuple[int, Sent]]:
    """Commands of the channel to axes and spindles with the block in which they went out."""
    blocks = enumerate(bench.blocks["channel"])
    return [(n, (c.target, c.command, c.arguments)) for n, block in blocks for c in block.commands]


def run(program: str, machine: MachineParameters = MILL) -> MachineBench:
    return MachineBench(program, machine=machine).run()


def test_program_start_resets_all_axes_and_the_rest_goes_out_with_the_next_block() -> None:
    bench = run("%P\nG135\nG136 X80 Y95 Z0\nG01 X1 F3000\nG137\nM30")
    assert bench.errors() == [] and bench.refusals() == []
    by_block = sent(bench)
    assert [command for block, command in by_block if block == 0] == RESETS
    assert [command for block, command in by_block if block == 1] == [
        ("x", "set_feedforward", {"enabled": True}),
        ("y", "set_feedforward", {"enabled": True}),
        ("z", "set_feedforward", {"enabled": True}),
        ("x", "set_feedforward", {"weight_percent": 80.0}),
        ("y", "set_feedforward", {"weight_percent": 95.0}),
        ("z", "set_feedforward", {"weight_percent": 0.0}),
    ]
    last = [(block, command) for block, command in by_block if block > 1]
    assert [command for _, command in last] == [(axis, "set_feedforward", {"enabled": False}) for axis in "xyz"]
    assert bench.position("x") == 1.0 and bench.position("y") == 0.0


def first_motion(bench: MachineBench) -> int:
    """The cycle at which the path is at rest for the last time before its first motion."""
    return int(np.flatnonzero(bench.column("channel", "path_velocity"))[0]) - 1


def test_a_motion_begins_with_the_feedforward_before_it() -> None:
    """The path waits for the block with which the commands go out, 10 cycles; what is left of z's lag is < 0.0003 mm."""
    bench = run("%P\nG135 X[COMP OFF FRICT]\nG136 Y50\nG00 Z-100\nM30")
    assert {record.cycle for record in bench.records if record.command == "set_feedforward"} == {10}
    assert first_motion(bench) == 10
    assert np.abs(bench.column("z", "following_error")).max() < 3e-4


@pytest.mark.parametrize(
    ("program", "begin"),
    [
        ("G01 Z-1 F3000", 0),
        ("S[G135]\nG01 Z-1 F3000", 0),
        ("G135\nG04 0.1\nG01 Z-1 F3000", 110),
        ("G04 0.1\nG01 Z-1 F3000", 100),
        ("G04 0.005\nX[COMP OFF FRICT]\nG01 Z-1 F3000", 10),
        ("G04 0.005\nX[COMP OFF FRICT]\nG136 X50\nG137\nG01 Z-1 F3000", 10),
    ],
)
def test_only_feedforward_and_compensations_of_axes_hold_the_next_motion(program: str, begin: int) -> None:
    assert first_motion(run(f"%P\n{program}\nM30")) == begin


def test_a_program_does_not_wait_after_its_last_motion() -> None:
    """M30 comes as soon as without G137, and the next program is not held by it."""
    ends = [run(f"%P\nG01 Z-1 F3000\n{last}M30").blocks["channel"] for last in ("", "G137\n")]
    assert len(ends[0]) == len(ends[1])


def test_a_look_ahead_of_one_axis_does_not_bend_the_path() -> None:
    """P-COMP-00044 = 4 on x alone: both axes are 4 cycles late, the circle stays round."""
    text = (ROOT / "config" / "mill.yaml").read_text(encoding="utf-8")
    text = text.replace("frict_comp:\n      mode: 3", "frict_comp:\n      reversal_lookahead: 4\n      mode: 3", 1)
    program = "%P\nG135\nG04 0.1\nG02 X0 Y0 I25 J0 F2000\nM30"
    bench = run(program, load_machine(text, "mill.yaml"))
    x, y = (np.array(bench.column(axis, "actual_position")) for axis in "xy")
    assert np.ptp(np.hypot(x - 25.0, y)) < 2e-3
    late = np.array(bench.column("x", "following_error"))
    assert np.abs(late).max() == pytest.approx(2000.0 / 60.0 * 0.004, rel=0.02)


def test_selection_and_weights_of_one_block_are_one_command_an_axis() -> None:
    commands = [command for block, command in sent(run("%P\nG135 G136 Y50\nM30")) if block]
    assert commands == [
        ("x", "set_feedforward", {"enabled": True}),
        ("y", "set_feedforward", {"enabled": True, "weight_percent": 50.0}),
        ("z", "set_feedforward", {"enabled": True}),
    ]


def test_functions_of_a_block_with_a_motion_go_out_before_it() -> None:
    """They come up in the block of cycles in which the motion begins, and go out with the next one."""
    bench = run("%P\nG01 X10 F600\nX20 G135 Y[COMP ON FRICT]\nM30", permitting("y"))
    begin = bench.column("channel", "line").index(3) // 10
    on = [block for block, command in sent(bench) if command[2] == {"enabled": True}]
    assert on == [begin + 1] * 4


def test_compensation_by_axis_names_of_the_channel() -> None:
    program = "%P\nN15 X[COMP ON FRICT]\nN25 Y[COMP OFF FRICT]\nN35 G0 X2 Y3 Z4\nN45 X[COMP OFF FRICT]\nN55 M30"
    bench = run(program, permitting("x"))
    assert bench.errors() == [] and bench.refusals() == []
    assert [command for _, command in sent(bench) if command not in RESETS] == [
        ("x", "set_friction_compensation", {"enabled": True}),
        ("y", "set_friction_compensation", {"enabled": False}),
        ("x", "set_friction_compensation", {"enabled": False}),
    ]


def test_compensation_stays_after_program_end_and_start() -> None:
    bench = MachineBench("%P\nX[COMP ON FRICT]\nM30", machine=permitting("x"), end_when_idle=False).run(0.1)
    bench.give("channel", "start")
    bench.run(0.1)
    assert [c for _, c in sent(bench) if c[1] == "set_friction_compensation"] == [
        ("x", "set_friction_compensation", {"enabled": True})
    ] * 2
    assert [c for _, c in sent(bench) if c[1] == "reset_feedforward"] == RESETS * 2


def test_spindles_by_their_names_one_command_each() -> None:
    """The example of TF5200 feedforward 3."""
    words = ["S[G135]", "S[G136=80]", "S[G137]", "S2[G135 G136=90]", "S2[G136=0]"]
    bench = run("%P\n" + "\n".join(words) + "\nM30", with_two_spindles())
    assert [command for _, command in sent(bench) if command[1] == "set_feedforward"] == [
        ("s", "set_feedforward", {"enabled": True}),
        ("s", "set_feedforward", {"weight_percent": 80.0}),
        ("s", "set_feedforward", {"enabled": False}),
        ("t", "set_feedforward", {"enabled": True, "weight_percent": 90.0}),
        ("t", "set_feedforward", {"weight_percent": 0.0}),
    ]


def test_mdi_resets_nothing() -> None:
    bench = MachineBench(end_when_idle=False)
    assert bench.give("channel", "mdi", text="G135 G136 X50").accepted
    bench.run(0.1)
    assert bench.give("channel", "mdi", text="G01 X1 F600").accepted
    bench.run(0.5)
    assert [command for _, command in sent(bench)] == [
        ("x", "set_feedforward", {"enabled": True, "weight_percent": 50.0}),
        ("y", "set_feedforward", {"enabled": True}),
        ("z", "set_feedforward", {"enabled": True}),
    ]


def test_going_on_after_m00_resets_nothing() -> None:
    bench = MachineBench("%P\nG135\nM00\nG01 X1 F600\nM30", end_when_idle=False).run(0.1)
    assert bench.give("channel", "start").accepted
    bench.run(0.5)
    assert [c for _, c in sent(bench) if c[1] == "reset_feedforward"] == RESETS


# ---------------------------------------------------------------- errors


NOT_PERMITTED = "axis Y: friction compensation is not activated (P-AXIS-00522 lr_param.frict_comp = 0)"


def test_compensation_that_is_not_permitted_is_found_by_the_check() -> None:
    text = "%P\nX[COMP ON FRICT]\nN20 X1 F600 G01 Y[COMP ON FRICT]\nM30"
    check = ProgramCheck.of_first_channel(permitting("x"), "part.nc")
    where = "part.nc line 3 column 17 'N20 X1 F600 G01 Y[COMP ON FRICT]'"
    assert [str(error) for error in check.errors(text, "part.nc")] == [f"P-ERR-70495 {where}: {NOT_PERMITTED}"]
    with pytest.raises(ProgramError) as caught:
        check.blocks(parse_program(text, "part.nc"), check.start)
    assert str(caught.value) == f"P-ERR-70495 {where}: {NOT_PERMITTED}"


def test_a_start_with_compensation_that_is_not_permitted_is_refused_and_nothing_moves() -> None:
    bench = run("%P\nX1 F600 G01\nY[COMP ON FRICT]\nM30", permitting("x"))
    where = "test.nc line 3 column 1 'Y[COMP ON FRICT]'"
    assert bench.refusals() == [f"P-ERR-70495 {where}: {NOT_PERMITTED}; nothing was started"]
    assert bench.position("x") == 0.0 and sent(bench) == []


def test_mdi_with_compensation_that_is_not_permitted_is_refused() -> None:
    bench = MachineBench(end_when_idle=False, machine=permitting())
    where = "mdi line 1 column 1 'Y[COMP ON FRICT]'"
    assert bench.refused("channel", "mdi", text="Y[COMP ON FRICT]") == (
        f"P-ERR-70495 {where}: {NOT_PERMITTED}; nothing was executed"
    )


def test_switching_off_is_permitted_on_every_axis() -> None:
    check = ProgramCheck.of_first_channel(permitting(), "part.nc")
    assert check.errors("%P\nX[COMP OFF FRICT] Y[COMP OFF FRICT]\nM30", "part.nc") == []
