"""Good programs against their golden canonical streams, bad ones against the exact error text in their first line."""

import pytest
from canonical_text import format_block
from nc_support import HERE, machine

from cnc_ptp.nc import faults, interpreter, spindle_faults
from cnc_ptp.nc.faults import Fault, ProgramError
from cnc_ptp.nc.interpreter import check, interpret
from cnc_ptp.nc.parser import parse_program

GOOD = sorted((HERE / "golden").glob("*.nc"))
BAD = sorted((HERE / "bad").glob("*.nc"))
FAULTS = [fault for part in (faults, spindle_faults) for fault in vars(part).values() if isinstance(fault, Fault)]


def stream(text: str, file: str) -> list[str]:
    axes, spindles = machine(text)
    program = parse_program(text, file)
    return [format_block(block) for block in interpret(program, (0.0,) * len(axes), axes, spindles)]


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_canonical_stream_is_the_golden_one(path):
    expected = path.with_suffix(".txt").read_text().splitlines()
    assert stream(path.read_text(), path.name) == expected


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_check_finds_nothing_in_good_programs(path):
    text = path.read_text()
    axes, spindles = machine(text)
    assert check(text, path.name, axes, spindles) == []


def test_example_bracket_gives_its_golden_stream():
    path = HERE.parents[1] / "examples" / "bracket.nc"
    expected = (HERE / "golden" / "bracket.txt").read_text().splitlines()
    assert stream(path.read_text(), path.name) == expected


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.stem)
def test_bad_program_raises_the_text_of_its_first_line(path):
    text = path.read_text()
    with pytest.raises(ProgramError) as caught:
        stream(text, path.name)
    assert str(caught.value) == text.split("\n")[0].removeprefix("; ")


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.stem)
def test_check_finds_the_same_error(path):
    text = path.read_text()
    axes, spindles = machine(text)
    found = [str(error) for error in check(text, path.name, axes, spindles)]
    assert text.split("\n")[0].removeprefix("; ") in found


def test_every_fault_has_a_bad_program():
    known = {fault.number for fault in FAULTS}
    shown = {int(path.read_text().split()[1].removeprefix("P-ERR-")) for path in BAD}
    assert known == shown | {faults.TOO_MANY_BLOCKS.number}


@pytest.mark.interpreted
def test_a_program_that_never_seems_to_end_is_refused(monkeypatch):
    monkeypatch.setattr(interpreter, "BLOCK_LIMIT", 50)
    text = "%L TEN\n" + "G91 G00 X1\n" * 10 + "M29\n%P\n" + "LL TEN\n" * 5 + "M30\n"
    with pytest.raises(ProgramError) as caught:
        stream(text, "long.nc")
    reason = "the program executes more than 50 blocks, calls counted each time"
    assert str(caught.value) == f"P-ERR-21043 long.nc line 3 column 1 'G91 G00 X1': {reason}"


def test_fault_numbers_are_unique():
    numbers = [fault.number for fault in FAULTS]
    assert len(numbers) == len(set(numbers))
