"""`cnc_ptp format` and `cnc_ptp check --canonical`: the meaning of every line stays, and a second time changes nothing."""

from pathlib import Path

import pytest
from click.testing import CliRunner
from nc_support import HERE, channel_of

from cnc_ptp.cli import main
from cnc_ptp.commands.language.format import format_text
from cnc_ptp.machine.program_files import called_programs
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program

GOOD = sorted((HERE / "golden").glob("*.nc"))


def stream(text: str, name: str) -> list[str]:
    channel = channel_of(text)
    files = called_programs(text, [str(HERE / "library")])
    program = parse_program(text, name, files=files, vocabulary=channel.vocabulary)
    return [format_block(block) for block in interpret(program, (0.0,) * len(channel.axes), channel)]


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_a_formatted_program_has_the_same_stream(path: Path) -> None:
    formatted = format_text(path.read_text())
    assert stream(formatted, path.name) == path.with_suffix(".txt").read_text().splitlines()
    assert format_text(formatted) == formatted


EVERY = sorted(
    [*GOOD, *(HERE / "bad").glob("*.nc"), *(HERE / "library").glob("*"), *(HERE.parents[1] / "examples").rglob("*.n*c")]
)


@pytest.mark.parametrize("path", EVERY, ids=lambda path: path.stem)
def test_a_second_time_changes_nothing(path: Path) -> None:
    formatted = format_text(path.read_text())
    assert format_text(formatted) == formatted
    assert not any(line != line.rstrip() for line in formatted.splitlines())


@pytest.mark.parametrize(
    ("line", "formatted"),
    [
        ("x1(a)  (b)y2", "X1 (a) (b) Y2"),
        ("x1;a", "X1 ;a"),
        ("n10 #  main  spindle [ 30 ]", "N10 #MAIN SPINDLE [30]"),
        ("x[ p1 + [ 2 * p2 ] ] s2[ m3 rev100 ]", "X[P1 + [2 * P2]] S2[M3 REV100]"),
        ("l  Drill.nc", "L Drill.nc"),
        ("x1 ll Pocket_a", "X1 LL Pocket_a"),
        ("l cycle [ name = Hole.nc @p1=5 ]", "L CYCLE [NAME = Hole.nc @P1=5]"),
        ('#msg ["A  b"  , p1]', '#MSG ["A  b" , P1]'),
        ("%\ng0 x1\n%\nnot Read  here", "%\nG0 X1\n%\nnot Read  here"),
    ],
)
def test_spacing(line: str, formatted: str) -> None:
    assert format_text(line) == formatted + "\n"
    assert format_text(formatted) == formatted + "\n"


UGLY = """%L up
g1x1y2f100
m29
%main  ( Main )
 n10  $if   p1==1   ; Why (not)
g00   x[ p1+1 ]( left ( inner ) )y3
$else
$for p2=1,2,1
    x1 \\
 y2
$endfor
$endif
#var
v.p.text="Not Changed"
#endvar
#comment begin
   keep  THIS
#comment end
$if p1 $goto n5
n5:m30
"""
PRETTY = """%L up
G1 X1 Y2 F100
M29
%main  ( Main )
N10 $IF P1==1 ; Why (not)
  G00 X[P1+1] ( left ( inner ) ) Y3
$ELSE
  $FOR P2=1,2,1
    X1 \\
      Y2
  $ENDFOR
$ENDIF
#VAR
  V.P.TEXT="Not Changed"
#ENDVAR
#comment begin
   keep  THIS
#comment end
$IF P1 $GOTO N5
N5:M30
"""


def test_the_style() -> None:
    assert format_text(UGLY.replace("\\\\", "\\")) == PRETTY.replace("\\\\", "\\")


def test_the_commands(tmp_path: Path) -> None:
    file = tmp_path / "part.nc"
    file.write_text("g1x1f600\nm30\n")
    run = CliRunner()
    assert run.invoke(main, ["format", "--check", str(file)]).output == f"{file} would change\n"
    assert run.invoke(main, ["format", str(file)]).output == "G1 X1 F600\nM30\n"
    assert run.invoke(main, ["format", "--in-place", str(file)]).exit_code == 0
    assert file.read_text() == "G1 X1 F600\nM30\n"
    assert run.invoke(main, ["format", "--check", str(file)]).exit_code == 0
    assert run.invoke(main, ["check", "--canonical", str(file)]).output == "1:N0 | line (1, 0, 0) feed 10\n2:N0 | end\n"
    file.write_text("g1x1q\nm30\n")
    done = run.invoke(main, ["format", str(file)])
    assert done.exit_code == 2 and file.read_text() == "g1x1q\nm30\n"
