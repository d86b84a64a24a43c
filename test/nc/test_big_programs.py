"""Programs that are read line by line from a file, and lines that are not kept."""

from pathlib import Path

import pytest
from long_support import long
from nc_support import HERE, channel_of, vocabulary_of

from cnc_ptp.commands.look import check as check_module
from cnc_ptp.errors import CncError
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
    channel = channel_of(text)
    return [format_block(block) for block in interpret(program, (0.0,) * len(channel.axes), channel)]


@pytest.mark.parametrize("ending", ["\r\n", *long(["\n"])])
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
    monkeypatch.setattr(ProgramFile, "kept", kept)
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
    file.write_text("G1 X1 F100\n" * (ProgramFile.kept + 5) + "X1 Q\nM30\n")
    with file.open("rb") as opened:
        _, errors = parse_text(ProgramFile(opened), "long.nc")
    assert [(error.line, error.column) for error in errors] == [(ProgramFile.kept + 6, 4)]


def test_a_file_beyond_the_limit_is_checked_line_by_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With the errors, callers and called programs of one that is read as a whole."""
    (tmp_path / "hole.nc").write_text("G01 Z[1/0]\nM29\n")
    good, bad = tmp_path / "good.nc", tmp_path / "bad.nc"
    good.write_text("F100\nG81[-1, \\\n 2]\nL deep.nc\nM30\n")
    (tmp_path / "deep.nc").write_text("G01 Z1\nM29\n")
    bad.write_text("F100\nL HOLE.nc\nG01 X10 F-1\nL nowhere.nc\nM30\n")
    told = []
    for limit in (10_000_000, 10):
        monkeypatch.setattr(check_module, "CHECKED_TEXT", limit)
        status = [check_module.check(str(path), None) for path in (good, bad)]
        told.append((status, *capsys.readouterr()))
    assert told[0] == told[1]
    assert told[0][:2] == ([0, 2], "good.nc: no errors in 5 lines\n")
    assert f"called in {bad} line 2" in told[0][2]


def test_a_file_beyond_the_limit_must_be_utf_8(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(check_module, "CHECKED_TEXT", 1)
    for data, reason in (
        (b"X1 ; \xe4\nM30\n", "it is not UTF-8 text; save it as UTF-8"),
        ("X1\nM30\n".encode("utf-16-le"), "it is UTF-16 text; save it as UTF-8"),
    ):
        (tmp_path / "a.nc").write_bytes(data)
        with pytest.raises(CncError) as caught:
            check_module.check(str(tmp_path / "a.nc"), None)
        assert (
            str(caught.value)
            == f"P-ERR-26110 NC program {tmp_path / 'a.nc'} cannot be read: {reason}; nothing was started"
        )
