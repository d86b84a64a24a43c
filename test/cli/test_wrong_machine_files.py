"""A machine file that is wrong: each command without nodes says what it does not do."""

import pytest
from commands_support import ROOT, call, recording_of, served

from cnc_ptp.client import Machine
from cnc_ptp.errors import CncError

REASON = "P-ERR-25001 {}:1:1: a machine file is a mapping of node names; {}"
PROGRAM = ROOT / "examples" / "bracket.nc"
VARIED = ["--vary", "x.getriebe.0.kv=1:2:2", "--goal", "max(following_error.x)"]


@pytest.mark.parametrize(
    ("words", "effect"),
    [
        (["simulate", "{machine}", "--program", PROGRAM], "nothing was started"),
        (["sweep", "{machine}", "--program", PROGRAM, *VARIED, "-o", "{new}.parquet"], "nothing was started"),
        (["circle", "{machine}", "--radius", 10, "--feed", 1000], "nothing was started"),
        (["identify", "friction", "x", "--machine", "{machine}"], "nothing was made"),
        (["identify", "dynamics", "x", "--machine", "{machine}"], "nothing was made"),
        (["check", PROGRAM, "--machine", "{machine}"], "nothing was checked"),
        (["plot", PROGRAM, "--machine", "{machine}", "-o", "{new}.html"], "nothing was drawn"),
        (["layout", "{machine}", "--for", "foxglove", "-o", "{new}.json"], "nothing was written"),
        (["lists", "export", "{machine}", "-o", "{new}"], "nothing was written"),
        (["params", "check", "{machine}"], "no parameters were read"),
        (["params", "--changed", "{machine}"], "no parameters were read"),
    ],
    ids=lambda words: " ".join(map(str, words[:2])) if isinstance(words, list) else "",
)
def test_commands_with_a_machine_file(words, effect, tmp_path):
    machine = tmp_path / "machine.yaml"
    machine.write_text("- a\n")
    result = call(*(str(word).format(machine=machine, new=tmp_path / "new") for word in words))
    assert (result.exit_code, result.stderr) == (2, REASON.format(machine, effect) + "\n")
    assert [*tmp_path.iterdir()] == [machine]


@pytest.mark.parametrize(
    ("words", "effect"),
    [
        (["replay", "{path}"], "nothing was computed"),
        (["replay", "{path}", "--from", 0], "nothing was computed"),
        (["replay", "{path}", "--checkpoints", 1], "nothing was computed"),
        (["diff", "{path}", "{path}"], "nothing was compared"),
        (["identify", "friction", "x", "--recording", "{path}"], "nothing was made"),
    ],
    ids=lambda words: " ".join(map(str, words)) if isinstance(words, list) else "",
)
def test_commands_with_a_recording(words, effect, tmp_path):
    path = recording_of(tmp_path / "run.mcap", "x", {"set_position": [0.0] * 100}, machine="- a\n")
    result = call(*(str(word).format(path=path) for word in words))
    assert (result.exit_code, result.stderr) == (2, REASON.format(f"{path}:machine.yaml", effect) + "\n")


def test_a_recording_for_browsers(tmp_path):
    path = recording_of(tmp_path / "run.mcap", "x", {"set_position": [0.0] * 100}, machine="- a\n")
    result = served(path)
    assert (result.returncode, result.stderr) == (2, REASON.format(path, "nothing was served") + "\n")


def test_a_program_that_makes_a_machine(tmp_path):
    machine = tmp_path / "machine.yaml"
    machine.write_text("- a\n")
    with pytest.raises(CncError) as error:
        Machine.offline(str(machine))
    assert str(error.value) == REASON.format(machine, "nothing was started")


def test_every_problem_says_it(tmp_path):
    text = (ROOT / "config" / "mill.yaml").read_text().replace("slep_max: 150000", "slepp_max: 150000")
    machine = tmp_path / "machine.yaml"
    machine.write_text(text)
    lines = call("simulate", machine).stderr.splitlines()
    assert len(lines) > 1 and all(line.endswith("; nothing was started") for line in lines)
