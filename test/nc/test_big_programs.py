"""Programs that are read line by line from a file, and lines that are not kept."""

from pathlib import Path

import pytest
from nc_support import HERE, machine, tools, vocabulary_of

from cnc_ptp.machine.program_files import called_programs
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.nc.flow import sections
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program, parse_text
from cnc_ptp.nc.program_text import ProgramFile

GOOD = sorted((HERE / "golden").glob("*.nc"))
LOOPS = """%L UP
G91 X1
M29
%MAIN
P1 = 0
$WHILE P1 < 3
P1 = P1 + 1
LL UP
$IF P1 == 2
Y5
$ELSE
Y[P1]
$ENDIF
$ENDWHILE
N9: P1 = P1 - 1
#VAR
V.P.A[2] = [1, 2]
#ENDVAR
#DELETE V.P.A
#COMMENT BEGIN
X1000
#COMMENT END
Z[P1] \\
 F500
$IF P1 > 0 $GOTO N9
M30
"""


def stream(program, text: str) -> list[str]:
    axes, spindles = machine(text)
    return [format_block(block) for block in interpret(program, (0.0,) * len(axes), axes, spindles, tools=tools(text))]


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_a_file_gives_what_its_text_gives(path: Path, ending: str, tmp_path: Path) -> None:
    text = path.read_text()
    file = tmp_path / path.name
    file.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", ending).encode())
    with file.open("rb") as opened:
        files = called_programs(text, [str(HERE / "library")])
        program, errors = parse_text(ProgramFile(opened), path.name, files=files, vocabulary=vocabulary_of(text))
        assert errors == []
        assert stream(program, text) == path.with_suffix(".txt").read_text().splitlines()


@pytest.mark.interpreted
@pytest.mark.parametrize(("kept", "later"), [(200, 100), (5, 100), (0, 3), (0, 0)])
def test_lines_that_are_not_kept_are_read_again(
    kept: int, later: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = stream(parse_program(LOOPS, "loops.nc"), LOOPS)
    monkeypatch.setattr(sections, "KEPT", kept)
    monkeypatch.setattr(sections, "KEPT_LATER", later)
    file = tmp_path / "loops.nc"
    file.write_text(LOOPS)
    with file.open("rb") as opened:
        program, errors = parse_text(ProgramFile(opened), "loops.nc")
        assert errors == []
        assert len(program.kept) <= max(1, kept + 1)
        assert stream(program, LOOPS) == expected
    assert len(expected) == 9


def test_an_error_behind_the_lines_that_are_kept_has_its_line(tmp_path: Path) -> None:
    file = tmp_path / "long.nc"
    file.write_text("G1 X1 F100\n" * (sections.KEPT + 5) + "X1 Q\nM30\n")
    with file.open("rb") as opened:
        _, errors = parse_text(ProgramFile(opened), "long.nc")
    assert [(error.line, error.column) for error in errors] == [(sections.KEPT + 6, 4)]
