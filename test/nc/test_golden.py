"""Good programs against their golden canonical streams, bad ones against the exact error text in their first line."""

import pytest
from nc_support import HERE, channel_of, files_of

from cnc_ptp.nc import c_axis_faults, faults, spindle_faults, thread_faults, turning_faults
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.nc.check import check
from cnc_ptp.nc.coordinates import coordinate_faults
from cnc_ptp.nc.expressions import expression_faults
from cnc_ptp.nc.faults import Fault, ProgramError
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.iso import iso_faults
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.radius import radius_faults
from cnc_ptp.nc.tools import tool_faults

GOOD = sorted((HERE / "golden").glob("*.nc"))
BAD = sorted((HERE / "bad").glob("*.nc"))


def faults_of(part) -> list[Fault]:
    """All faults of a module, also those in its tables."""
    values = [value for value in vars(part).values() if isinstance(value, Fault)]
    tables = [value for value in vars(part).values() if isinstance(value, dict)]
    return values + [fault for table in tables for fault in table.values() if isinstance(fault, Fault)]


PARTS = (
    iso_faults,
    faults,
    spindle_faults,
    c_axis_faults,
    thread_faults,
    turning_faults,
    expression_faults,
    flow_faults,
    coordinate_faults,
    tool_faults,
    radius_faults,
)
FAULTS = [fault for part in PARTS for fault in faults_of(part)]


def stream(text: str, file: str) -> list[str]:
    channel = channel_of(text)
    program = parse_program(text, file, files=files_of(text), vocabulary=channel.vocabulary)
    blocks = interpret(program, (0.0,) * len(channel.axes), channel)
    return [format_block(block) for block in blocks]


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_canonical_stream_is_the_golden_one(path):
    expected = path.with_suffix(".txt").read_text().splitlines()
    assert stream(path.read_text(), path.name) == expected


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_check_finds_nothing_in_good_programs(path):
    text = path.read_text()
    found = check(text, path.name, channel_of(text), files=files_of(text))
    assert [error for error in found if error.number != faults.ORDERED.number] == []


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
    found = [str(error) for error in check(text, path.name, channel_of(text), files=files_of(text))]
    assert text.split("\n")[0].removeprefix("; ") in found


def test_every_fault_has_a_bad_program():
    known = {fault.number for fault in FAULTS}
    shown = {int(path.read_text().split()[1].removeprefix("P-ERR-")) for path in BAD}
    assert known == shown | {
        faults.ORDERED.number,
        faults.M_NOT_THERE.number,
        flow_faults.LOOP_LIMIT.number,
        flow_faults.CYCLE_FILE.number,
        expression_faults.ONLY_WHILE_RUNNING.number,
        coordinate_faults.SCALE_ROTARY.number,
    }


def test_fault_numbers_are_unique():
    numbers = [fault.number for fault in FAULTS]
    assert len(numbers) == len(set(numbers))
