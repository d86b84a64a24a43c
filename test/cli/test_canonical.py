"""`cnc_ptp check --canonical`: the whole stream, or a numbered reason where it ends."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner
from machine_support import ROOT

from cnc_ptp.cli import main

MILL, LATHE = str(ROOT / "config" / "mill.yaml"), str(ROOT / "config" / "lathe.yaml")
GOES_ON = "where axes are behind it is known only while the program runs; the stream continues with the named positions"
ENDS_THERE = "what follows is known only while the program runs; the stream ends here"


def canonical(file: Path, text: str, *options: str) -> tuple[int, list[str], str]:
    """Exit status, lines of the stream, standard error."""
    file.write_text(text)
    done = CliRunner().invoke(main, ["check", str(file), "--canonical", *options])
    return done.exit_code, done.stdout.splitlines(), done.stderr


C_AXIS = """G00 X100 Z310
#CAX [S, C]
G01 C90 F2000
#FACE [X, C]
G01 X20 C10 F500
G03 X10 C20 R10
#FACE OFF
#CAX OFF
M03 S500
G01 Z300 F100
M30
"""


def test_the_stream_goes_on_behind_the_c_axis(tmp_path):
    file = tmp_path / "a.nc"
    status, lines, told = canonical(file, C_AXIS, "--machine", LATHE)
    assert status == 0
    assert lines == [
        "1:N0 | rapid (100, 310, 0)",
        "2:N0 | S[axis of the path]",
        "3:N0 | line (100, 310, 90) feed 33.333333",
        "4:N0 | positions of #FACE [X, C]",
        "5:N0 | line (20, 310, 10) feed 8.333333 #FACE [X, C]",
        "6:N0 | arc (10, 310, 20) plane 02 center (10, 10) radius 10 sweep 90 feed 8.333333 #FACE [X, C]",
        "7:N0 | positions of the axes",
        "8:N0 | S[spindle]",
        "9:N0 | S[M3 REV500]",
        "10:N0 | line (22.36068, 300, 63.434949) feed 1.666667",
        "11:N0 | end",
    ]
    assert told == f"warning: P-WARN-21438 {file} line 2 '#CAX [S, C]': {GOES_ON}\n"


@pytest.mark.parametrize(
    ("line", "shown"),
    [("G74 Z1", "home Z"), ("G100 Z-5 F100", "measure (1, 0, -5) feed 1.666667 exact stop")],
)
def test_it_goes_on_behind_homing_and_measuring(tmp_path, line, shown):
    file = tmp_path / "a.nc"
    status, lines, told = canonical(file, f"G00 X1\n{line}\nX2 Z1\n{line}\nX3\nM30\n")
    assert (status, lines[1], lines[-2].split()[0]) == (0, f"2:N0 | {shown}", "5:N0")
    assert told == f"warning: P-WARN-21438 {file} line 2 '{line}': {GOES_ON}\n"


@pytest.mark.parametrize("machine", [(), ("--machine", MILL)])
def test_it_ends_before_a_line_that_reads_the_run(tmp_path, machine):
    file = tmp_path / "a.nc"
    text = "%L A\nX[V.A.ACT_POS.Y]\nM29\n%MAIN\nG00 X1\nLL A\nM30\n"
    status, lines, told = canonical(file, text, *machine)
    assert (status, lines) == (0, ["5:N0 | rapid (1, 0, 0)", "2:N0 | wait for the path"])
    where = f"{file} line 2 'X[V.A.ACT_POS.Y]', called in {file} line 6"
    assert told.splitlines()[-1] == f"warning: P-WARN-21438 {where}: {ENDS_THERE}"


def test_it_ends_at_an_error(tmp_path):
    file = tmp_path / "a.nc"
    status, lines, told = canonical(file, "G00 X1\nG01 X2\nX3\nM30\n", "--machine", MILL)
    assert (status, lines) == (2, ["1:N0 | rapid (1, 0, 0)"])
    assert told.startswith(f"P-ERR-20008 {file} line 2 column 1 'G01 X2': ")


def test_what_the_check_leaves_out_behind_a_homing_is_an_error_of_the_stream(tmp_path):
    """A check looks for no soft limits behind G74; where the stream goes on, they count."""
    file = tmp_path / "a.nc"
    status, lines, told = canonical(file, "G74 X1\nG00 X5000\nM30\n", "--machine", MILL)
    assert (status, lines) == (2, ["1:N0 | home X"])
    assert "P-ERR-120002" in told and "axis X: 5000 mm lies beyond the positive soft limit" in told
