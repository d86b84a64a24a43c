"""#MACHINE DATA: a parameter of an axis gets another value in a program; the path stops for it."""

from __future__ import annotations

import pytest
from machine_support import MILL, MachineBench
from replay_support import bits, replay

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.parameters import read_machine

PROGRAM = """\
%P
N10 G01 X60 F3000
N20 #MACHINE DATA [AX=X P-AXIS-00099.0=4000]
N30 X120
N40 #MACHINE DATA SYN [AXNR=1 AXPARAM="getriebe[0].kv 2500" WAIT]
N50 X0
N60 M30
"""


def lags(bench: MachineBench) -> list[float]:
    """Following error of x at the constant path velocity 50 mm/s of each block, mm."""
    found: dict[int, float] = {}
    for number, velocity, lag in zip(
        bench.column("channel", "block_number"),
        bench.column("x", "set_velocity"),
        bench.column("x", "following_error"),
        strict=True,
    ):
        if abs(abs(velocity) - 50.0) < 1e-9:
            found[number] = abs(lag)
    return [round(lag, 3) for lag in found.values()]


def test_the_gain_changes_between_the_blocks() -> None:
    """Without feedforward the lag is v / Kv: Kv 50, 40 and 25 1/s."""
    bench = MachineBench(PROGRAM).run()
    assert bench.errors() == []
    assert lags(bench) == [1.0, 1.25, 2.0]


def test_the_path_stands_while_it_changes() -> None:
    bench = MachineBench(PROGRAM.replace("X60 F3000", "X60 F3000 G261")).run()
    first = bench.column("channel", "block_number").index(30)
    assert bench.column("x", "set_velocity")[first] == 0.0
    assert bench.column("x", "set_position")[first] == 60.0


def test_a_replay_has_it_to_the_bit() -> None:
    bench = MachineBench(PROGRAM).run()
    written = [record for record in bench.records if record.command == "write_parameter"]
    assert [record.arguments_json for record in written] == [
        '{"by_path": true, "parameter": "P-AXIS-00099.0", "value": 4000.0}',
        '{"by_path": true, "parameter": "getriebe[0].kv", "value": 2500.0}',
    ]
    assert replay(MILL, bench.records, len(bench.blocks["x"]))["x"] == bits(bench)["x"]


def test_a_start_behind_it_has_it() -> None:
    bench = MachineBench(PROGRAM, start=False, end_when_idle=False).run(0.05)
    assert bench.give("channel", "start", line=6).accepted
    bench.run(4.0)
    assert [round(lag, 3) for lag in lags(bench)] == [2.0]


def test_it_stays_behind_the_program() -> None:
    bench = MachineBench(PROGRAM, end_when_idle=False).run(8.0)
    assert bench.give("channel", "mdi", text="G01 X50 F3000").accepted
    before = len(bench.column("x", "set_position"))
    bench.run(1.0)
    assert round(max(bench.column("x", "following_error")[before:]), 3) == 2.0


def errors(line: str) -> list[str]:
    check = ProgramCheck.of_first_channel(MILL, "p.nc")
    return [f"{error.number} {error.column} {error.reason}" for error in check.errors(f"%P\n{line}\nM30\n", "p.nc")]


SYNTAX = '#MACHINE DATA is written [AX=X P-AXIS-00099.0=5000] or [AX=X AXPARAM="getriebe[0].kv 5000"]'


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("#MACHINE DATA", f"21076 1 {SYNTAX}"),
        ("#MACHINE DATA []", f"21076 1 {SYNTAX}"),
        ("#MACHINE DATA [AX=X]", f"21076 1 {SYNTAX}"),
        ("#MACHINE DATA [P-AXIS-00099=5000]", f"21076 1 {SYNTAX}"),
        ("#MACHINE DATA [AX=X P-AXIS-99=5000]", f"21076 1 {SYNTAX}"),
        ("#MACHINE DATA [AX=X P-AXIS-00099.0=fast]", f"21076 1 {SYNTAX}"),
        ('#MACHINE DATA [AX=X AXPARAM="getriebe[0].kv"]', f"21076 1 {SYNTAX}"),
        ("#MACHINE DATA [AX=X P-AXIS-00099.0=5000 WAIT]", "21413 41 #MACHINE DATA: WAIT needs SYN"),
        ("#MACHINE DATA [AX=X P-AXIS-00099.0=5000] X10", "21075 42 #MACHINE DATA must be alone in its block, not with 'X10'"),
        ("#MACHINE DATA [AX=A P-AXIS-00099.0=5000]", "20797 18 axis A is not in the machine; axes of this channel: X, Y, Z"),
        ("#MACHINE DATA [AXNR=9 P-AXIS-00099.0=5000]", "20797 20 axis 9 is not in the machine; axes of this channel: 1 (X), 2 (Y), 3 (Z)"),
        ("#MACHINE DATA [AX=X P-AXIS-00099.0=0]", "23096 21 axis X: P-AXIS-00099 getriebe[0].kv: value 0 is not above 0 (0.01/s)"),
        ("#MACHINE DATA [AX=X P-AXIS-00099.9=5]", "23095 21 axis X: P-AXIS-00099 getriebe[9].kv: index 9 is outside 0 to 5"),
        ("#MACHINE DATA [AX=X P-AXIS-00020=2]", "23095 21 axis X: P-AXIS-00020 (kenngr.antr_typ) cannot be written at run time, it is taken over at start-up only, as the manual has it"),
        ("#MACHINE DATA [AX=X P-AXIS-00178=5]", "23100 21 axis X: P-AXIS-00178 (kenngr.swe_pos) cannot be written at run time, the channel has it, too"),
        ('#MACHINE DATA [AX=X AXPARAM="frict_comp.max_points 5"]', "110641 30 axis X: P-COMP-00062 (frict_comp.max_points) cannot be written at run time, it is taken over at start-up only, as the manual has it"),
        ('#MACHINE DATA [AX=X AXPARAM="getriebe[0].kvv 5"]', "23095 30 axis X: axis x has no parameter 'getriebe.0.kvv'; did you mean getriebe[i].kv (P-AXIS-00099)?"),
    ],
)  # fmt: skip
def test_errors_before_anything_moves(line: str, error: str) -> None:
    assert errors(line) == [error]


def test_what_the_axis_refuses_when_the_path_gets_there() -> None:
    """Against other values only the axis can judge: it keeps what it has and says so; the program goes on."""
    program = PROGRAM.replace("P-AXIS-00099.0=4000", "P-AXIS-00229=0")
    bench = MachineBench(program).run()
    texts = [event.text for event in bench.events if event.error_id == 23096]
    assert texts == [
        "axis x: write_parameter refused: axis list, P-AXIS-00229 vorsteuer.vs_v_nenner of /x: value 0 is not a valid "
        "denominator; nothing was changed"
    ]
    assert lags(bench) == [1.0, 1.0, 2.0]


def test_axes_of_a_lathe() -> None:
    lathe = read_machine("config/lathe.yaml")
    check = ProgramCheck.of_first_channel(lathe, "p.nc")
    assert check.errors("%P\n#MACHINE DATA [AXNR=2 P-AXIS-00099=4000]\nM30\n", "p.nc") == []
