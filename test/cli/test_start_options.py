"""Options that start a program at a line or block: what they print, and which of them contradict each other."""

import pytest
from click.testing import CliRunner
from machine_support import ROOT

from cnc_ptp.cli import main
from cnc_ptp.nc.block_search import StartPoint
from cnc_ptp.start_options import start_words

MILL = str(ROOT / "config" / "mill.yaml")
PART = "%L SIDE\nG01 Y5 F500\nM29\n%P\nN10 T5 M6\nN20 M3 S1000\nN30 G00 X10\nLL SIDE\nN40 G01 X20\nM30\n"


@pytest.fixture
def part(tmp_path):
    path = tmp_path / "part.nc"
    path.write_text(PART)
    return str(path)


def called(*words):
    result = CliRunner().invoke(main, [str(word) for word in words])
    return result.exit_code, result.output + (result.stderr if result.stderr not in result.output else "")


@pytest.mark.parametrize("machine", [(), ("--machine", MILL)])
def test_check_prints_what_a_start_does(part, machine):
    status, output = called("check", part, *machine, "--start-block", 40)
    assert (status, output) == (
        0,
        "1. line 5: T5 M6\n2. line 6: S[M3 REV1000]\n3. G00: X 0 to 10, Y 0 to 5\n4. continues with line 9 'N40 G01 X20'\n",
    )


def test_check_prints_the_blocks_from_there_on(part):
    status, output = called("check", part, "--start-line", 2, "--canonical")
    assert status == 0 and output.splitlines()[-6:] == [
        "5:N10 | T5 | M6",
        "6:N20 | S[M3 REV1000]",
        "2:N0 | rapid (10, 0, 0)",
        "2:N0 | line (10, 5, 0) feed 8.333333",
        "9:N40 | line (20, 5, 0) feed 8.333333",
        "10:N0 | end",
    ]


@pytest.mark.parametrize("command", [("check",), ("simulate", MILL, "--program")])
def test_a_place_that_does_not_exist_is_wrong_input(part, command):
    status, output = called(*command, part, "--start-line", 12)
    text = f"P-ERR-22040 {part}: there is no line 12: the last one is 10; nothing was started"
    assert status == 2 and text in output.replace("\n", " ")


def test_simulate_starts_there(part):
    status, output = called("simulate", MILL, "--program", part, "--start-line", 9)
    assert status == 0 and "message: continues with line 9 'N40 G01 X20'" in output


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (("--start-pass", 2), "--start-in and --start-pass need --start-line or --start-block"),
        (("--start-in", "a.nc"), "--start-in and --start-pass need --start-line or --start-block"),
        (("--start-line", 2, "--start-block", 40), "--start-line and --start-block exclude each other"),
        (("--start-line", 2), "--start-line and --start-block need --program"),
        (("--plc", "a.py", "--plc", "b.py"), "--plc is given 2 times, and takes one value."),
        (("--duration", 1, "--strict", "--duration=2"), "--duration is given 2 times, and takes one value."),
        (("--start-line", 0), "0 is not in the range x>=1"),
    ],
)
def test_options_that_contradict(options, text):
    status, output = called("simulate", MILL, *options)
    assert status == 2 and text in output


def test_a_start_point_as_options():
    assert [*start_words(None)] == []
    assert [*start_words(StartPoint(line=7))] == ["--start-line", "7", "--start-pass", "1"]
    words = ["--start-block", "40", "--start-in", "side.nc", "--start-pass", "3"]
    assert [*start_words(StartPoint(0, 40, "side.nc", 3))] == words


def test_a_value_given_twice_to_a_command_of_a_group():
    status, output = called("users", "add", "otto", "--role", "viewer", "--role", "operator", "--users", "u.yaml")
    assert status == 2 and "--role is given 2 times, and takes one value." in output
    status, output = called("lists", "export", MILL, "-o", "a", "-o", "b")
    assert status == 2 and "is given 2 times, and takes one value." in output
